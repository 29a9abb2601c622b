"""A boundary-value problem on a mesh: its residual and the bordered solve of its exact Jacobian.

The unknown ``u`` holds the values at all points of the mesh, row by row, then the free parameters. With one free
parameter more than conditions allow, ``residual(u) = 0`` is a curve: what ``continuation`` follows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.collocation.elimination import LinearSystem, solve, solve_signed, transfer_pencil
from pearlbvp.collocation.polynomial import PiecewisePolynomial, all_points, apply_basis
from pearlbvp.collocation.problem import BoundaryValueProblem
from pearlbvp.collocation.scheme import Scheme
from pearlbvp.representation import brief


@dataclass(frozen=True)
class Discretization:
    """Gauss collocation of a problem on a mesh of ``N`` intervals.

    Attributes:
        problem: the boundary-value problem.
        scheme: the collocation scheme (``m`` points an interval).
        mesh: from 0 to 1, shape (N + 1,).
        parameters: all ``k`` parameters; the entries of free ones serve as first guesses only.
        free: names of the parameters that are unknowns.
        weights: of the states and of all parameters in the inner product, shape (n + k,); 1 by default. They make one of what
            differs in size.
    """

    __repr__ = brief

    problem: BoundaryValueProblem
    scheme: Scheme
    mesh: Array
    parameters: Array
    free: tuple[str, ...]
    weights: Array | None = None

    def __post_init__(self) -> None:
        unknown = set(self.free) - set(self.problem.parameters)
        if unknown:
            raise ValueError(f"free: no parameter is called {sorted(unknown)}; there are {self.problem.parameters}")
        if self.mesh[0] != 0 or self.mesh[-1] != 1 or not (np.diff(self.mesh) > 0).all():
            raise ValueError("mesh: it must increase from 0 to 1")

    @cached_property
    def free_index(self) -> NDArray[np.intp]:
        """Places of the free parameters among all parameters."""
        return np.array([self.problem.parameters.index(name) for name in self.free], dtype=np.intp)

    @cached_property
    def h(self) -> Array:
        """Lengths of the intervals, shape (N,)."""
        return np.diff(self.mesh)

    @cached_property
    def gauss_h(self) -> Array:
        """Length of the interval of each collocation point, shape (N*m, 1)."""
        return np.repeat(self.h, self.scheme.m)[:, None]

    @cached_property
    def gauss_points(self) -> Array:
        """All collocation points, shape (N*m,)."""
        points: Array = (self.mesh[:-1, None] + self.h[:, None] * self.scheme.nodes).ravel()
        return points

    @cached_property
    def gauss_weights(self) -> Array:
        """Quadrature weights of the collocation points on [0, 1], shape (N*m,)."""
        weights: Array = (self.h[:, None] * self.scheme.weights).ravel()
        return weights

    @cached_property
    def _no_mass(self) -> Array:
        return np.ones(self.n)

    @property
    def n(self) -> int:
        """Number of states."""
        return len(self.problem.states)

    @property
    def size(self) -> int:
        """Length of ``u``."""
        return (len(self.h) * self.scheme.m + 1) * self.n + len(self.free)

    def pack(self, values: Array, parameters: Array) -> Array:
        """The unknown from values (N*m + 1, n) and all parameters (k,)."""
        return np.concatenate((values.ravel(), parameters[self.free_index]))

    def values(self, u: Array) -> Array:
        """The values at all points, shape (N*m + 1, n)."""
        return u[: u.size - len(self.free)].reshape(-1, len(self.problem.states))

    def all_parameters(self, u: Array) -> Array:
        """All parameters, the free ones from ``u``, shape (k,)."""
        parameters = self.parameters.copy()
        parameters[self.free_index] = u[u.size - len(self.free) :]
        return parameters

    def polynomial(self, u: Array) -> PiecewisePolynomial:
        """The states as a function on [0, 1]."""
        return PiecewisePolynomial(self.mesh, self.values(u))

    def at_gauss_points(self, u: Array) -> Array:
        """The states at the collocation points, shape (N*m, n)."""
        result: Array = apply_basis(self.scheme.values, np.ascontiguousarray(self.values(u)))
        return result

    def residual(self, u: Array) -> Array:
        """Defects ``M y' - f`` at the collocation points, then boundary conditions, then integrals: one row.

        All are linear in a small error of ``u``, and of its size.
        """
        p, values = self.all_parameters(u), self.values(u)
        y = apply_basis(self.scheme.values, values)
        slopes = apply_basis(self.scheme.derivatives, values) / self.gauss_h
        mass, _ = self.problem.mass(p)
        defects = (slopes if mass is None else mass * slopes) - self.problem.rhs(self.gauss_points, y, p)
        return np.concatenate(
            (
                defects.ravel(),
                self.problem.boundary(values[0], values[-1], p),
                self.gauss_weights @ self.problem.integrand(self.gauss_points, y, p),
            )
        )

    def _weighted(self, u: Array) -> Array:
        """Unknowns, shape (..., size), times their weights in the inner product."""
        if self.weights is None:
            return u
        points, of_states = len(self.h) * self.scheme.m + 1, self.weights[: self.n]
        return u * np.concatenate((np.tile(of_states, points), self.weights[self.n + self.free_index]))

    def inner(self, u: Array, v: Array) -> float:
        """``integral of y_u . y_v dt + p_u . p_v``, each product with its weight: independent of the mesh."""
        k, u = len(self.free), self._weighted(u)
        densities = (self.at_gauss_points(u) * self.at_gauss_points(v)).sum(axis=1)
        return float(self.gauss_weights @ densities + u[u.size - k :] @ v[v.size - k :])

    def solve(self, u: Array, rhs: Array, row: Array | None = None) -> Array:
        """Solve with the residual's exact Jacobian at ``u``, bordered below by the row ``inner(row, .)``.

        Args:
            u: where the Jacobian is taken.
            rhs: one or more right-hand sides in the order of ``residual`` (then the border's), shape (size,) or
                (size, s).
            row: the border, or several of them, shape (size,) or (k, size); unknowns must be as many as conditions and
                borders.

        Returns:
            The solutions, in the shape of ``rhs``.

        Raises:
            numpy.linalg.LinAlgError: the bordered matrix is singular to working precision.
        """
        return solve(self.scheme, self._system(u, row), rhs.reshape(self.size, -1)).reshape(rhs.shape)

    def signed_distance(self, u: Array, row: Array) -> float:
        """Zero where the Jacobian, bordered by ``row`` as in ``solve``, is singular; it changes its sign there.

        It has the sign of the determinant, and the size of the smallest singular value where that is small: the inverse of
        the solution's size for a load that is no left null vector of anything but by chance (compare W. J. F. Govaerts,
        Numerical Methods for Bifurcations of Dynamical Equilibria (SIAM 2000), §3.3).
        """
        load = np.random.default_rng(0).standard_normal((self.size, 1))
        try:
            solution, sign = solve_signed(self.scheme, self._system(u, row), load)
        except np.linalg.LinAlgError:
            return 0.0
        solution = solution.ravel()
        return sign / math.sqrt(self.inner(solution, solution))

    def transfer_pencil(self, u: Array) -> tuple[Array, Array]:
        """Matrices with ``A_0 y(0) + A_1 y(1) = 0`` for all solutions of the equations linearised at ``u``, parameters kept."""
        y, p = self.at_gauss_points(u), self.all_parameters(u)
        by_y, _ = self.problem.rhs_jacobian(self.gauss_points, y, p)
        mass, _ = self.problem.mass(p)
        return transfer_pencil(self.scheme, self.h, by_y, mass)

    def _system(self, u: Array, row: Array | None) -> LinearSystem:
        """The linearised equations at ``u`` with their borders."""
        p, values, t = self.all_parameters(u), self.values(u), self.gauss_points
        y = apply_basis(self.scheme.values, values)
        by_y, by_p = self.problem.rhs_jacobian(t, y, p)
        mass, mass_p = self.problem.mass(p)
        if mass_p is not None:
            slopes = apply_basis(self.scheme.derivatives, values) / self.gauss_h
            by_p = by_p - slopes[:, :, None] * mass_p
        return LinearSystem(
            self.h,
            by_y,
            by_p,
            self._no_mass if mass is None else mass,
            *self.problem.boundary_jacobian(values[0], values[-1], p),
            *self.problem.integrand_jacobian(t, y, p),
            self.free_index,
            np.empty((0, u.size)) if row is None else self._weighted(row.reshape(-1, u.size)),
        )

    def on_mesh(self, mesh: Array, *unknowns: Array) -> tuple[Discretization, list[Array]]:
        """The same problem on another mesh, with unknowns interpolated onto it."""
        other = replace(self, mesh=mesh)
        points = all_points(mesh, self.scheme)
        k = len(self.free)
        moved = [np.concatenate((self.polynomial(u)(points).ravel(), u[u.size - k :])) for u in unknowns]
        return other, moved


class Collocated:
    """What problems have in common whose unknowns are those of a discretization.

    Attributes:
        discretization: their collocation.
    """

    discretization: Discretization

    def residual(self, u: Array) -> Array:
        """Defects, boundary conditions and integral conditions at ``u``; see ``Discretization.residual``."""
        return self.discretization.residual(u)

    def solve(self, u: Array, rhs: Array, row: Array | None = None) -> Array:
        """Bordered solve of the residual's Jacobian at ``u``; see ``Discretization.solve``."""
        return self.discretization.solve(u, rhs, row)

    def inner(self, u: Array, v: Array) -> float:
        """Mean of ``y_u . y_v`` plus the product of the free parameters: the same on every mesh."""
        return self.discretization.inner(u, v)
