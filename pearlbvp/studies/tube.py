"""Branches of rings, coils and buckles in reduced modes, from the straight cylinder on."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

from pearlbvp.continuation.branch import Branch, BranchOptions, BranchPoint, continue_branch, start_point
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options
from pearlbvp.theory.dispersion import Mode
from pearlbvp.tube.problem import Family, TubeProblem, onset
from pearlbvp.tube.spectrum import Fixed

UNRESOLVED = 1e-5
"""Growth rate of a rigid motion, which should be none, beyond which a branch ends rather than count wrongly."""


def tube_branch(
    c0: float,
    length: float,
    family: Family,
    mode: Mode,
    options: BranchOptions | None = None,
    *,
    fixed: Fixed = "area and volume",
) -> Branch[TubeProblem]:
    """The branch of rings, coils or buckles that leaves the cylinder at a mode, with stability on the whole tube.

    Args:
        c0: spontaneous curvature.
        length: axial period of the tube, in radii.
        family: ``ring`` (mode ``0,n``), ``coil`` (``m,1``) or ``buckle`` (``m,n``).
        mode: waves along and around the tube.
        options: where to stop and how to step, from ``studies.branch.branch_options``.
        fixed: what the perturbations keep that stability is judged by.

    Returns:
        The branch; its table has the columns of a branch of pearls.

    Raises:
        InputError: an argument that cannot be used.
    """
    if family not in get_args(Family):
        raise InputError(f"family: {family!r} is none of {', '.join(get_args(Family))}")
    problem, u, direction = onset(Tube(c0, length), family, *mode, fixed=fixed)
    options = replace(options or branch_options(), limit=_limit)
    return continue_branch(start_point(problem, u, direction), options, at_bifurcation=True)


def _limit(point: BranchPoint[TubeProblem]) -> str | None:
    if point.observables["r_min"] <= 0:
        return "a cross-section is no longer star-shaped about its centre, as these modes need it"
    if point.spectrum.kernel > UNRESOLVED:
        size = point.point.problem.size
        return f"rigid motions have growth rates of {point.spectrum.kernel:.0e}: {size} modes do not resolve the shape"
    return None
