"""Branches of rings, coils and buckles in reduced modes, from the straight cylinder on."""

from __future__ import annotations

from typing import get_args

from pearlbvp.continuation.branch import Branch, BranchOptions, continue_branch, start_point
from pearlbvp.continuation.switching import switch
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, choice, mode_numbers
from pearlbvp.studies.branch import FIXED, known_options, numbered
from pearlbvp.theory.dispersion import Mode
from pearlbvp.tube.onset import Family, onset
from pearlbvp.tube.problem import TubeProblem
from pearlbvp.tube.spectrum import Fixed


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
        family: ``pearl`` (mode ``m,0``), ``ring`` (``0,n``), ``coil`` (``m,1``) or ``buckle`` (``m,n``). Pearls and rings are
            better followed as what they are (``studies.branch``, ``studies.ring``): through overhangs, to thin necks.
        mode: waves along and around the tube.
        options: where to stop and how to step, from ``studies.branch.branch_options``.
        fixed: what the perturbations keep that stability is judged by.

    Returns:
        The branch; its table has the columns of a branch of pearls.

    Raises:
        InputError: an argument that cannot be used.
    """
    choice("family", family, get_args(Family))
    choice("fixed", fixed, FIXED)
    (m, n), options = mode_numbers("mode", mode), known_options(options)
    problem, u, direction = onset(Tube(c0, length), family, m, n, fixed=fixed)
    start = start_point(problem, u, direction)
    return continue_branch(start, options, at_bifurcation=True)


def tube_switched(
    branch: Branch[TubeProblem], number: int, options: BranchOptions, *, grow: bool = True
) -> Branch[TubeProblem]:
    """The branch that crosses a branch of tubes at its branch point ``number`` (the first is 1).

    Args:
        branch: a branch of coils, buckles, or of what branched off from one.
        number: which of its branch points.
        options: where to stop and how to step.
        grow: follow the half on which the largest new mode grows; on a pitchfork the two are the same shapes.

    Raises:
        InputError: there is no such branch point, or it was not located.
    """
    special, options = numbered(branch, number), known_options(options)
    if special.change == 0:
        raise InputError(
            f"switch: at branch point {number} the branch meets a more symmetric one; follow that from its start"
        )
    return switch(branch, special, options, grow=grow)
