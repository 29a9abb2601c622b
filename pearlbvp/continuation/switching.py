"""Branch switching: the other branch through a branch point, in the space in which it lives.

A branch that keeps the problem's symmetry crosses in the same space. One that breaks it lives in a larger space: the
problem embeds its solution there, and the null vector found there is the new branch's tangent
(``docs/theory/symmetry_and_blocks.md``).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.branch import Branch, SpecialPoint
from pearlbvp.continuation.crossing import crossing_direction
from pearlbvp.continuation.following import BranchOptions, continue_branch
from pearlbvp.continuation.normal_form import normal_form
from pearlbvp.continuation.problem import Problem
from pearlbvp.continuation.solution import Solution


def tangent_along(problem: Problem, u: Array, direction: Array) -> Array:
    """Unit tangent of the curve of solutions through ``u`` that has a positive inner product with ``direction``.

    Raises:
        numpy.linalg.LinAlgError: the curve is perpendicular to the direction there.
    """
    rhs = np.zeros(u.size)
    rhs[-1] = 1.0
    tangent = problem.solve(u, rhs, direction)
    return tangent / math.sqrt(problem.inner(tangent, tangent))


def switch(
    branch: Branch[Any],
    special: SpecialPoint,
    options: BranchOptions,
    *,
    centre: str = "pearl",
    grow: bool = True,
) -> Branch[Any]:
    """Follow the branch that crosses ``branch`` at one of its branch points.

    Args:
        branch: a branch.
        special: one of its special points, of kind ``bp``.
        options: how to follow the new branch.
        centre: where the new branch is centred, as the problem's ``lift`` takes it.
        grow: follow the half on which the solution grows at its centre, else the other. On a pitchfork the two are
            the same shapes, shifted.

    Raises:
        ValueError: the special point is no branch point, was not located, or breaks a symmetry that the problem
            cannot do without.
    """
    if special.kind != "bp" or not special.converged:
        raise ValueError(
            f"special: {special.kind} at point {special.index} is no located branch point; choose one of find('bp')"
        )
    point = branch.at(special)
    return leave(point.problem, point.u, point.tangent, special.block, options, centre=centre, grow=grow)


def leave(
    problem: Problem,
    u: Array,
    tangent: Array,
    block: Any,
    options: BranchOptions,
    *,
    centre: str = "pearl",
    grow: bool = True,
) -> Branch[Any]:
    """Follow the branch that crosses another at a solution where the growth rate of a block is zero.

    Args:
        problem, u, tangent: of the branch that is left, at the branch point.
        block: the block of the neutral perturbation.
        options, centre, grow: as ``switch`` takes them.
    """
    problem, (u, tangent) = problem.lift(block, centre, u, tangent)
    tangent = tangent / math.sqrt(problem.inner(tangent, tangent))
    direction = crossing_direction(problem, u, tangent)
    slope = normal_form(problem, u, tangent, direction, names=()).slope
    if slope:  # no pitchfork: along the crossing branch the solution moves along the first one, too
        direction = direction + slope * tangent
    if problem.is_upper_half(direction) != grow:
        direction = -direction
    return continue_branch(Solution.along(problem, u, direction), options, at_bifurcation=True)
