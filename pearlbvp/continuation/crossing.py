"""Beside a simple branch point: the direction of the branch that crosses there, and a corrector that is blind to it.

The Jacobian bordered by a branch's tangent is singular where another branch crosses, and Newton's method is lost near it:
its corrections run off along the null vector. All other components of them are as good as anywhere.
"""

from __future__ import annotations

import math

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.problem import Problem


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


def correct_beside(problem: Problem, guess: Array, tangent: Array, iterations: int = 3) -> Array:
    """Newton's method from a good guess beside a branch point, each correction without its part along the null vector.

    That part stays as the guess has it (compare W. J. F. Govaerts, Numerical Methods for Bifurcations of Dynamical
    Equilibria (SIAM 2000), on bordered matrices): interpolation between solutions of a smooth branch
    knows it better than a nearly singular matrix does.

    Raises:
        numpy.linalg.LinAlgError: the bordered matrix is singular exactly.
    """
    u = guess
    for _ in range(iterations):
        null = crossing_direction(problem, u, tangent)
        step = problem.solve(u, np.append(problem.residual(u), 0.0), tangent)
        u = u - step + problem.inner(null, step) * null
    return u
