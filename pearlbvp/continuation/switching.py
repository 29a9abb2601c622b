"""Branch switching: the other branch through a branch point, in the space in which it lives.

A branch that keeps the problem's symmetry crosses in the same space. One that breaks it lives in a larger space: the
problem embeds its solution there, and the null vector found there is the new branch's tangent (design, §6).
"""

from __future__ import annotations

import math
from typing import Any, TypeVar

import numpy as np

from pearlbvp.continuation.branch import Branch, BranchOptions, SpecialPoint, continue_branch, start_point
from pearlbvp.continuation.problem import Array, Problem

P = TypeVar("P", bound=Problem)


def crossing_direction(problem: Problem, u: Array, tangent: Array, seed: int = 0) -> Array:
    """Unit tangent of the branch that crosses the one with ``tangent`` at a simple branch point ``u``.

    There the Jacobian bordered by the tangent is singular (to the accuracy with which ``u`` is known), so its solution
    for any right-hand side points along its null vector: inverse iteration needs one step.

    Raises:
        numpy.linalg.LinAlgError: it is singular exactly, twice with different perturbations of ``u``.
    """
    rng = np.random.default_rng(seed)
    load = rng.standard_normal(u.size)
    try:
        direction = problem.solve(u, load, tangent)
    except np.linalg.LinAlgError:
        direction = problem.solve(u + 1e-12 * tangent, load, tangent)
    direction -= problem.inner(tangent, direction) / problem.inner(tangent, tangent) * tangent
    return direction / math.sqrt(problem.inner(direction, direction))


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
    special: SpecialPoint[Any],
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
        centre: where the new branch is centred, as the problem's ``embed`` takes it.
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
    point = branch.at(special).point
    problem, (u, tangent) = point.problem.embed(special.block, centre, point.u, point.tangent)
    tangent = tangent / math.sqrt(problem.inner(tangent, tangent))
    direction = crossing_direction(problem, u, tangent)
    if problem.grows_at_centre(direction) != grow:
        direction = -direction
    return continue_branch(start_point(problem, u, direction), options, at_bifurcation=True)
