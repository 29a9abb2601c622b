"""Continuous piecewise polynomials: the form in which collocation keeps a solution."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation.scheme import Scheme, derivative_matrix, gauss_scheme, integration_matrix, lagrange_matrix
from pearlbvp.compiled import compiled
from pearlbvp.representation import brief


@dataclass(frozen=True)
class PiecewisePolynomial:
    """A continuous function on [mesh[0], mesh[-1]], a polynomial of degree ``m`` on each of ``N`` intervals.

    Attributes:
        mesh: the ends of the intervals, increasing, shape (N + 1,).
        values: at the scheme's points of every interval, shape (N*m + 1, n).
    """

    __repr__ = brief

    mesh: Array
    values: Array

    @property
    def scheme(self) -> Scheme:
        """The collocation scheme whose degree the values have."""
        return gauss_scheme((len(self.values) - 1) // (len(self.mesh) - 1))

    @property
    def points(self) -> Array:
        """The points at which ``values`` stand, shape (N*m + 1,)."""
        return all_points(self.mesh, self.scheme)

    def local(self) -> Array:
        """The values interval by interval, ends repeated, shape (N, m + 1, n)."""
        return local_values(self.values, self.scheme.m)

    def __call__(self, t: Array) -> Array:
        """Values at ``t`` (shape (K,), inside the mesh): shape (K, n)."""
        interval = np.clip(np.searchsorted(self.mesh, t, side="right") - 1, 0, len(self.mesh) - 2)
        tau = (t - self.mesh[interval]) / np.diff(self.mesh)[interval]
        basis = lagrange_matrix(self.scheme.points, tau)
        return np.asarray(np.einsum("kj,kjn->kn", basis, self.local()[interval]))

    def derivative(self) -> Array:
        """Derivatives at the points of every interval, from inside it: shape (N, m + 1, n)."""
        by_t = derivative_matrix(self.scheme.points) / np.diff(self.mesh)[:, None, None]
        return np.asarray(by_t @ self.local())

    @property
    def weights(self) -> Array:
        """Of the values in the integral over the whole mesh, shape (N*m + 1,)."""
        pieces = np.outer(np.diff(self.mesh), integration_matrix(self.scheme.points)[-1])
        found = np.zeros(len(self.values))
        found[:-1] = pieces[:, :-1].ravel()
        found[self.scheme.m :: self.scheme.m] += pieces[:, -1]
        return found

    def integral(self) -> Array:
        """Integral from the left end to each of the points, shape (N*m + 1, n)."""
        h = np.diff(self.mesh)[:, None, None]
        pieces = h * (integration_matrix(self.scheme.points)[1:] @ self.local())
        starts = np.concatenate((np.zeros((1, pieces.shape[2])), np.cumsum(pieces[:, -1], axis=0)))
        return np.concatenate((starts[:1], (starts[:-1, None] + pieces).reshape(-1, pieces.shape[2])))


def all_points(mesh: Array, scheme: Scheme) -> Array:
    """The points of every interval in one row, shared ends once: shape (N*m + 1,)."""
    return np.append((mesh[:-1, None] + np.diff(mesh)[:, None] * scheme.points[None, :-1]).ravel(), mesh[-1])


def local_values(values: Array, m: int) -> Array:
    """View values of shape (N*m + 1, n) interval by interval, shape (N, m + 1, n)."""
    inner = values[:-1].reshape((len(values) - 1) // m, m, -1)
    return np.concatenate((inner, values[m::m, None]), axis=1)


def extremes(polynomial: PiecewisePolynomial, component: int) -> tuple[float, float]:
    """Smallest and largest value of a component: of the function, not only at its points."""
    values, m = polynomial.values[:, component], polynomial.scheme.m
    found = []
    for sign, place in ((1.0, int(values.argmin())), (-1.0, int(values.argmax()))):
        best = sign * values[place]
        for interval in {max(place - 1, 0) // m, min(place, len(values) - 2) // m}:
            local = values[interval * m : (interval + 1) * m + 1]
            if 0 < place < len(values) - 1:
                series = sign * (_to_powers(m) @ local)
                turns = np.roots(np.polyder(series))
                inside = turns.real[(np.abs(turns.imag) < 1e-9) & (np.abs(turns.real) < 1)]
                best = min([best, *np.polyval(series, inside)])
        found.append(sign * float(best))
    return found[0], found[1]


@cache
def _to_powers(m: int) -> Array:
    """From values at the points of an interval to coefficients of the powers of ``2 tau - 1``, the highest first."""
    return np.asarray(np.linalg.inv(np.vander(2 * gauss_scheme(m).points - 1)))


@compiled
def apply_basis(basis, values):  # type: ignore[no-untyped-def]
    """Apply a matrix (g, m + 1) to the values of every interval: (N*m + 1, n) to (N*g, n)."""
    at, points = basis.shape
    intervals = (values.shape[0] - 1) // (points - 1)
    result = np.zeros((intervals * at, values.shape[1]))
    for i in range(intervals):
        for g in range(at):
            row = result[i * at + g]
            for j in range(points):
                factor, source = basis[g, j], values[i * (points - 1) + j]
                for column in range(row.size):
                    row[column] += factor * source[column]
    return result
