"""Branches of pearls through a shape of least energy: a way to those that are not joined to the straight tube."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.branch import Branch, Status
from pearlbvp.continuation.following import BranchOptions, continue_branch
from pearlbvp.continuation.path import PathEnd
from pearlbvp.continuation.problem import P
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.switching import tangent_along
from pearlbvp.errors import InputError
from pearlbvp.held import Held, known_held
from pearlbvp.helfrich import Tube, finite, positive, whole
from pearlbvp.membrane import checked_tolerance
from pearlbvp.shapes.outline import Outline, StraightEnd, downhill
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.studies.branch import known_options
from pearlbvp.units import Sentence


def shape_branch(
    c0: float,
    length: float,
    v: float,
    cosines: Sequence[float],
    options: BranchOptions | None = None,
    *,
    cells: int = 1,
    tolerance: float | None = None,
    fix: str | Held = "area,volume",
) -> Branch[PearlProblem]:
    """The branch through the shape of least energy that lies downhill from a guess: a way to isolated branches.

    The shape is symmetric about ``x = 0``; the branch leads from it to smaller and to larger volume. ``until`` holds in
    either direction, and the points run from smaller to larger volume at the shape.

    Args:
        c0: spontaneous curvature.
        length: axial period of the shape, in radii.
        v: reduced volume at which the energy is minimised.
        cosines: the guess ``a_1, a_2, ...``: ``r = 1 + sum of a_k cos(2 pi k x / L)``.
        options: where to stop and how to step, from ``branch_options``.
        cells: how many periods the tube has that stability is judged on.
        tolerance: estimated error of the profile at which the mesh is refined.
        fix: what is held while stability is judged: ``area,volume``, or ``tension`` for ``area``; ``pressure`` or ``osmotic=N``
            for ``volume``; ``force`` for ``length``; ``ade=ALPHA`` besides (``held.known_held``).

    Raises:
        InputError: an argument that cannot be used, or a guess from which no equilibrium is reached.
    """
    tube, v, options = Tube(c0, length), positive("volume", v), known_options(options)
    cells, tolerance = whole("cells", cells), checked_tolerance(tolerance, 1e-9)
    held = known_held(fix)
    try:
        guess = np.array([finite("shape", value) for value in cosines])
    except TypeError:
        raise InputError("shape", f"{cosines!r} must be a list of cosines' amplitudes", "give one like [0.1]") from None
    outline = Outline.on(tube, v)
    try:
        problem, u = downhill(outline, outline.of_radius(guess), cells=cells, tolerance=tolerance)
    except StraightEnd:
        raise InputError(
            "shape",
            "downhill from it at this volume lies the straight tube, where branches cross",
            "give other cosines or another volume, or leave it out for the pearls that leave the tube",
        ) from None
    except PathEnd as error:
        raise InputError("shape", str(error.args[0]), "give other cosines or another volume") from None
    problem = replace(problem, held=held)
    held.check(problem.observables(u))
    return both_ways(problem, u, options, options)


def both_ways(problem: P, u: Array, down: BranchOptions, up: BranchOptions) -> Branch[P]:
    """The branch through a solution, from smaller to larger volume there.

    Args:
        problem, u: the solution.
        down, up: where to stop on either side, and how to step; ``up`` sees the progress of the whole.
    """
    upwards = np.zeros_like(u)
    upwards[-1] = 1.0  # v is the last unknown
    tangent = tangent_along(problem, u, upwards)
    below = continue_branch(Solution.along(problem, u, -tangent), down)
    lower = below.reversed()
    both = replace(up, progress=lambda so_far: up.progress(lower.extended(so_far)))
    whole_branch = lower.extended(continue_branch(Solution.along(problem, u, tangent), both))
    if not below.failed:
        return whole_branch
    reason = Sentence.joined("towards smaller volumes ", below.reason, "; towards larger ones ", whole_branch.reason)
    return replace(whole_branch, reason=reason, status=Status.FAILED)
