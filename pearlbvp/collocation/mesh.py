"""Adaptive meshes: the local error of collocation, and meshes that spread it evenly.

On an interval of length ``h`` the error is ``y^(m+1) h^(m+1) K(tau)`` to leading order, much larger than at the mesh
points, where it is of order ``2m``. Source: Ascher, Mattheij, Russell, Numerical Solution of Boundary Value Problems
for ODEs (SIAM 1995), §9.2 and §9.3 (eqs. (9.16) to (9.21)).
"""

from __future__ import annotations

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation.polynomial import PiecewisePolynomial


def derivative_estimate(solution: PiecewisePolynomial) -> Array:
    """Size of ``y^(m+1)`` on each interval, from the jumps of the piecewise constant ``y^(m)``: shape (N,).

    Components are measured relative to one plus their largest value. At the ends the nearest jump stands for the missing
    one; a single interval has its own size instead.
    """
    h = np.diff(solution.mesh)
    sizes = 1.0 + np.abs(solution.values).max(axis=0)
    highest = (solution.scheme.leading @ solution.local()) / (h**solution.scheme.m)[:, None] / sizes
    if len(h) == 1:
        return np.asarray(np.abs(highest).max(axis=1) / h)
    inner = np.abs(np.diff(highest, axis=0)) / ((h[:-1] + h[1:]) / 2)[:, None]
    jumps = np.concatenate((inner[:1], inner, inner[-1:]))
    return np.asarray((jumps[:-1] + jumps[1:]).max(axis=1) / 2)


def error_estimate(solution: PiecewisePolynomial) -> Array:
    """Estimated largest error on each interval, relative to one plus the solution's size: shape (N,)."""
    m = solution.scheme.m
    return np.asarray(
        solution.scheme.error_constant * np.diff(solution.mesh) ** (m + 1) * derivative_estimate(solution)
    )


def equidistribute(solution: PiecewisePolynomial, intervals: int) -> Array:
    """A mesh of ``intervals`` intervals on which the solution's error would be spread evenly, shape (intervals + 1,).

    A floor under the density keeps neighbouring intervals comparable where the solution is almost constant.
    """
    h = np.diff(solution.mesh)
    density = derivative_estimate(solution) ** (1 / (solution.scheme.m + 1))
    mean = float(h @ density)
    density = np.maximum(density, 0.25 * mean) if mean > 0 else np.ones_like(h)
    cumulated = np.concatenate(([0.0], np.cumsum(h * density)))
    mesh = np.interp(np.linspace(0, cumulated[-1], intervals + 1), cumulated, solution.mesh)
    mesh[0], mesh[-1] = solution.mesh[0], solution.mesh[-1]
    return mesh


def intervals_for(solution: PiecewisePolynomial, tolerance: float) -> int:
    """Number of evenly loaded intervals that brings the estimated error to ``tolerance``, with some room."""
    h = np.diff(solution.mesh)
    m = solution.scheme.m
    load = float(h @ derivative_estimate(solution) ** (1 / (m + 1)))
    return max(4, int(np.ceil(1.1 * load * (solution.scheme.error_constant / tolerance) ** (1 / (m + 1)))))
