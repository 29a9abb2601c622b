"""Shapes that were computed otherwise, as tubes in reduced modes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.path import correct
from pearlbvp.continuation.problem import LiftError
from pearlbvp.newton import NewtonOptions
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.problem import PLANE_TOLERANCE, TubeProblem

DIFFERENCE = 1e-5
"""Step along the tangent for its central differences in modes; Newton's method makes it exact."""

Shape = Callable[[float, int], tuple[Mapping[Mode, float], Mapping[str, float]]]
"""By the step along the tangent and a number of periods or folds: coefficients of the modes, and the free parameters."""


def in_modes(problem: TubeProblem, shape: Shape) -> tuple[TubeProblem, Array, Array]:
    """A solution of another problem and its tangent, on as many modes as it needs.

    Args:
        problem: of the same tubes, on a first number of modes.
        shape: the solution, and its neighbours along its tangent.

    Returns:
        The problem, its solution and the unit tangent there.

    Raises:
        LiftError: too many modes would be needed, or no solution is near.
    """

    def unknown(step: float) -> Array:
        known, parameters = shape(step, max(problem.size) + 1)
        return np.append(problem.packed(known), [parameters[name] for name in problem.free])

    while (finer := problem.remesh(unknown(0.0))) is not None:
        problem = finer[0]
    guess, direction = unknown(0.0), (unknown(DIFFERENCE) - unknown(-DIFFERENCE)) / (2 * DIFFERENCE)
    problem = problem.pinned_at(problem.known(guess))
    if max(last for _, last in problem.tails(guess)) > PLANE_TOLERANCE:
        raise LiftError(f"{max(problem.size)} reduced modes do not resolve the shape")
    result, tangent = correct(problem, guess, direction, guess, 0.0, NewtonOptions(max_iterations=10))
    if not result.converged:
        raise LiftError(f"the shape could not be taken over into reduced modes ({result.message})")
    return problem, result.u, tangent / math.sqrt(problem.inner(tangent, tangent))
