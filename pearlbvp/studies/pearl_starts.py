"""Stable pearls of a period to start from, on branches that do not lead to the straight tube."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from functools import cache

import numpy as np

from pearlbvp.continuation.following import continue_branch
from pearlbvp.continuation.path import PathEnd, correct_at
from pearlbvp.continuation.solution import Solution
from pearlbvp.errors import SpectrumError
from pearlbvp.helfrich import Tube
from pearlbvp.newton import NewtonOptions
from pearlbvp.shapes.outline import Outline, downhill
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.starts import Start, at_rest, computed
from pearlbvp.studies.stretches import NEAR
from pearlbvp.studies.unduloids import beside
from pearlbvp.theory.unduloid import unduloid_of

THIN = 0.03
"""Radius of the neck at which branches end."""

SHORT, LONG = 0.5, 1e3
"""Largest steps: where branches turn sharply, and where multipliers grow without bound, ``lambda1`` above ``LARGE``."""

FAR = 1e3
"""Tension, by the square of the wave number, beyond which a branch has come to an unduloid."""

BELOW, NEARER = 0.1, 0.03
"""By how much the smallest volumes of random shapes and of smooth pearls lie below those of straight tube and unduloid."""

SMOOTH = np.array([0.5, -0.05])
"""Cosines of a pearl's radius to go downhill from."""


def thin_necked(c0: float, period: float) -> Iterator[Solution[PearlProblem]]:
    """Stable pearls of thin necks, which hardly depend on ``c0``: from those of one at which branches lead to them."""
    known = _reference(period)
    if known is None:
        return
    problem, u = known.problem, known.u
    for value in np.linspace(REFERENCE, c0, 2 + int(abs(c0 - REFERENCE) / STEP)).tolist():
        d = problem.discretization
        parameters = d.parameters.copy()
        parameters[d.problem.parameters.index("c0")] = value
        problem = replace(problem, discretization=replace(d, parameters=parameters))
        result, _ = correct_at(problem, u, NewtonOptions())
        if not result.converged:
            return
        u = result.u
    problem, (u,) = problem.plain(u)
    with suppress(SpectrumError, np.linalg.LinAlgError):
        shape = computed(problem, u)
        if not shape.spectrum.n_unstable:
            yield shape


@cache
def _reference(period: float) -> Solution[PearlProblem] | None:
    """Pearls of thin necks, on the branch from the unduloid or, of long ones, from the straight tube."""
    tube, unduloid = Tube(REFERENCE, period), unduloid_of(period)
    options = replace(branch_options({"r_min": NARROW, "cmc": 1}, max_points=400, max_step=LONG), stability=False)
    if unduloid is None:
        branch = family_branch(tube, "pearl", (1, 0), options)
    else:
        shape = beside(tube, 1, unduloid, 1 / FAR)
        if shape is None:
            return None
        branch = continue_branch(shape if shape.slopes["lambda1"] < 0 else shape.turned(), options)
    return branch.points[-1] if abs(branch.points[-1].value("r_min") - NARROW) < NEAR else None


REFERENCE, STEP = 0.48, 0.25
"""Spontaneous curvature at which branches lead to thin necks, and largest steps from there."""

NARROW = 0.06
"""Radius of these necks."""


def stable_downhill(tube: Tube, v: float, starts: int, seed: int) -> Iterator[Solution[PearlProblem]]:
    """Stable pearls downhill from smooth ones, which have others of less energy beside them, and from random shapes.

    Args:
        tube: one period.
        v: volume of the straight tube, or of the unduloid.
        starts: volumes from below that up to that of one sphere a period, the smooth pearls up to the middle of them.
        seed: of the random shapes.
    """
    sphere = math.sqrt(2 * tube.length) / 3
    low, high = min(v, sphere) - BELOW, max(1.0, v, sphere)
    for i in range(starts):
        share = (i + 0.5) / starts
        yield from _stable_equal(at_rest(Start(tube, low + share * (high - low), (seed, i), True)))
        smooth = v - NEARER + share * (max(v, (v + high) / 2) - v + NEARER)
        outline = Outline.on(tube, smooth)
        with suppress(PathEnd, SpectrumError, np.linalg.LinAlgError):
            problem, u = downhill(outline, outline.of_radius(SMOOTH))
            yield from _stable_equal(Solution(problem, u, u).computed())


def _stable_equal(shape: Solution[PearlProblem] | str) -> Iterator[Solution[PearlProblem]]:
    """What a shape came to, where that is stable, one pearl a period, and of no thinner neck than branches end at."""
    if isinstance(shape, str) or shape.spectrum.n_unstable or shape.value("r_min") < THIN:
        return
    if shape.problem.cells == 1 and bellies(shape) == 1:
        yield shape


def bellies(point: Solution[PearlProblem]) -> int:
    """Maxima of the radius of one period."""
    r = point.problem.profile(point.u).outline()[1][:-1]
    return int(((r > np.roll(r, 1)) & (r >= np.roll(r, -1))).sum())
