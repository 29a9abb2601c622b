"""Gauss collocation on one interval: the points, the local Lagrange basis, and its values and derivatives.

A solution is a continuous piecewise polynomial of degree ``m``, given on each interval by its values at ``m + 1``
Chebyshev-Lobatto points (both ends among them) and required to satisfy the equation at the ``m`` Gauss points.
Source: U. Ascher, R. Mattheij, R. Russell, Numerical Solution of Boundary Value Problems for ODEs (SIAM 1995), §5.4.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import legendre

from pearlbvp.arrays import Array
from pearlbvp.representation import brief


def barycentric_weights(points: Array) -> Array:
    """Weights of the barycentric form of Lagrange interpolation in distinct ``points``, shape (k,)."""
    differences = points[:, None] - points[None, :]
    np.fill_diagonal(differences, 1.0)
    weights: Array = 1.0 / differences.prod(axis=1)
    return weights


def lagrange_matrix(points: Array, at: Array) -> Array:
    """Values at ``at`` (shape (j,)) of the Lagrange polynomials of ``points`` (shape (k,)): shape (j, k).

    Source: J.-P. Berrut, L. N. Trefethen, SIAM Review 46 (2004), eq. (4.2).
    """
    distances = at[:, None] - points[None, :]
    exact = distances == 0.0
    terms = barycentric_weights(points) / np.where(exact, 1.0, distances)
    values: Array = terms / terms.sum(axis=1, keepdims=True)
    hits = exact.any(axis=1)
    values[hits] = exact[hits]
    return values


def derivative_matrix(points: Array) -> Array:
    """Derivatives at ``points`` of their own Lagrange polynomials, shape (k, k) (Berrut and Trefethen, eq. (9.4))."""
    weights = barycentric_weights(points)
    differences = points[:, None] - points[None, :]
    np.fill_diagonal(differences, 1.0)
    matrix: Array = weights[None, :] / weights[:, None] / differences
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    return matrix


def integration_matrix(points: Array) -> Array:
    """Integrals from the first point to each of ``points`` of their Lagrange polynomials, shape (k, k)."""
    nodes, weights = legendre.leggauss(len(points))
    lengths = (points - points[0])[:, None]
    at = points[0] + lengths * (nodes + 1) / 2
    basis = lagrange_matrix(points, at.ravel()).reshape(*at.shape, len(points))
    result: Array = np.einsum("ij,ijk->ik", lengths * weights / 2, basis)
    return result


@dataclass(frozen=True)
class Scheme:
    """Gauss collocation of degree ``m`` on the interval [0, 1].

    Attributes:
        m: number of collocation points of one interval, the degree of the polynomials.
        nodes: the Gauss points, shape (m,).
        weights: their quadrature weights, shape (m,); exact for degree ``2m - 1``.
        points: where the solution's values are kept, shape (m + 1,), from 0 to 1.
        values: the Lagrange basis of ``points`` at ``nodes``, shape (m, m + 1).
        derivatives: its derivatives there, shape (m, m + 1).
        leading: the coefficient functional of the basis's ``m``-th derivative, shape (m + 1,).
        error_constant: ``max |K|`` with the local error ``y^(m+1) h^(m+1) K(tau)``,
            ``K(tau) = 1/m! * integral from 0 to tau of prod(s - c_j) ds`` (Ascher, Mattheij, Russell, eq. (5.75)).
    """

    __repr__ = brief

    m: int
    nodes: Array
    weights: Array
    points: Array
    values: Array
    derivatives: Array
    leading: Array
    error_constant: float


@cache
def gauss_scheme(m: int) -> Scheme:
    """The collocation scheme with ``m`` Gauss points an interval, of order ``2m`` at the mesh points.

    Raises:
        ValueError: ``m`` is not an integer from 2 to 7.
    """
    if m not in range(2, 8):
        raise ValueError(f"m: collocation takes 2 to 7 Gauss points an interval, not {m!r}")
    nodes, weights = legendre.leggauss(m)
    nodes, weights = (nodes + 1) / 2, weights / 2
    points = (1 - np.cos(np.pi * np.arange(m + 1) / m)) / 2
    values = lagrange_matrix(points, nodes)
    factorial = float(np.prod(np.arange(1, m + 1)))
    # K on a fine grid: the monic Gauss polynomial, integrated from the interval's left end.
    kernel = np.poly1d(np.poly(nodes)).integ()
    error_constant = float(np.abs(kernel(np.linspace(0, 1, 201))).max()) / factorial
    return Scheme(
        m=m,
        nodes=nodes,
        weights=weights,
        points=points,
        values=values,
        derivatives=values @ derivative_matrix(points),
        leading=factorial * barycentric_weights(points),
        error_constant=error_constant,
    )
