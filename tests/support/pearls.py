"""Pearls for tests: one continuation, cached, and a corrector at a wanted parameter."""

from __future__ import annotations

from functools import cache

import numpy as np

from pearlbvp.continuation import PathOptions, Solution, follow
from pearlbvp.continuation.path import correct
from pearlbvp.helfrich import Tube
from pearlbvp.newton import NewtonOptions
from pearlbvp.shapes.pearling import pearling_onset


@cache
def path(c0, period, v_end, tolerance=1e-9, degree=6):
    problem, u, tangent = pearling_onset(Tube(c0, period), tolerance=tolerance, degree=degree)
    start = Solution(problem, u, tangent)
    followed = follow(start, PathOptions(step=0.1), lambda p: "there" if p.observables["v"] > v_end else None)
    assert followed.complete, followed.reason
    return followed


def at(followed, name, value):
    """The pearl at which a free parameter has a value: problem and unknown."""
    near = min(followed.points[1:], key=lambda p: abs(p.observables[name] - value))
    free = near.problem.discretization.free
    direction = np.zeros_like(near.u)
    place = near.u.size - len(free) + free.index(name)
    direction[place] = 1.0
    result, _ = correct(
        near.problem, near.u, direction, near.u, value - near.u[place], NewtonOptions(max_iterations=20)
    )
    assert result.converged, result.message
    return near.problem, result.u
