"""SUNDIALS IDA on ``residual(q, q_t, multipliers) = 0``, ``c(q) - kept = epsilon multipliers``, with dense or sparse Jacobians.

Dense: IDA factorizes the whole matrix by LAPACK. Sparse: the constraints' rows and columns are dense and stay out of the
factorization. IDA's GMRES is preconditioned by the exact inverse of a bordered matrix, by block elimination (W. Govaerts,
Numerical Methods for Bifurcations of Dynamical Equilibria (SIAM 2000), §3.6), so that one or two iterations suffice.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.sparse import issparse
from scipy.sparse.linalg import splu

# SUNDIALS would print every failed step on standard error; what a failure means is said by the driver.
os.environ.setdefault("SUNLOGGER_ERROR_FILENAME", os.devnull)
from sksundae.ida import IDA, IDAJacTimes, IDAPrecond

from pearlbvp.flow.problem import Array, FlowProblem

IGNORED = 1e8
"""Absolute tolerance of the multipliers, at which IDA's error test ignores them."""

SMALL = 60
"""Number of unknowns up to which IDA's own dense factorization is faster than LAPACK's."""


@dataclass(frozen=True)
class Tolerances:
    """Of IDA: see ``driver.FlowOptions``."""

    rtol: float
    atol: float
    max_order: int
    compliance: float


@dataclass
class Bordered:
    """The matrix of Newton's method with its sparse part factorized: set up by IDA when it wants a new one.

    Attributes:
        problem: the flow.
        compliance: of the constraints.
        size: number of coordinates.
    """

    problem: FlowProblem
    compliance: float
    size: int
    _matrix: Any = field(default=None, repr=False)
    _factors: Any = field(default=None, repr=False)
    _factor: float = 0.0
    _rows: Any = field(default=None, repr=False)
    _columns: Any = field(default=None, repr=False)
    _eliminated: Any = field(default=None, repr=False)
    _corner: Any = field(default=None, repr=False)

    def setup(self, t: float, y: Array, yp: Array, r: Array, factor: float) -> None:
        """Factorize at a state."""
        size = self.size
        q = y[:size]
        with np.errstate(all="ignore"):
            self._matrix, self._factor = self.problem.jacobian(q, yp[:size], y[size:], factor).tocsc(), factor
            self._rows, self._columns = self.problem.constraint_rows(q), self.problem.columns(q)
        try:
            self._factors = splu(self._matrix)
        except RuntimeError:  # singular, or not finite: no correction is finite then, and IDA takes a shorter step
            self._factors = None
            return
        self._eliminated = self._factors.solve(np.ascontiguousarray(self._columns))
        self._corner = -self.compliance * np.eye(len(self._rows)) - self._rows @ self._eliminated

    def solve(self, t: float, y: Array, yp: Array, r: Array, rhs: Array, z: Array, factor: float, delta: float) -> None:
        """``z`` with ``[[A, C], [R, -epsilon]] z = rhs`` at the state of the last set-up."""
        size = self.size
        if self._factors is None:
            z[:] = np.nan
            return
        inner = self._factors.solve(rhs[:size])
        multipliers = np.linalg.solve(self._corner, rhs[size:] - self._rows @ inner)
        z[:size], z[size:] = inner - self._eliminated @ multipliers, multipliers

    def times(self, t: float, y: Array, yp: Array, r: Array, v: Array, result: Array, factor: float) -> None:
        """That matrix times ``v``, for the present step's ``factor`` of the metric: the residual is affine in the rate."""
        size = self.size
        moved, multipliers = v[:size], v[size:]
        result[:size] = self._matrix @ moved + self._columns @ multipliers
        if factor != self._factor:
            with np.errstate(all="ignore"):
                metric = self.problem.residual(y[:size], moved, y[size:]) - self.problem.residual(
                    y[:size], 0 * moved, y[size:]
                )
            result[:size] += (factor - self._factor) * metric
        result[size:] = self._rows @ moved - self.compliance * multipliers


def integrator(
    problem: FlowProblem, t: float, q: Array, rate: Array, multipliers: Array, kept: Array, tolerances: Tolerances
) -> Any:
    """IDA, ready to step from a state."""
    size, k, compliance = len(q), len(kept), tolerances.compliance

    def residual(t: float, y: Array, yp: Array, result: Array) -> None:
        shape, forces = y[:size], y[size:]
        with np.errstate(all="ignore"):  # what is no surface is not finite, and IDA takes a shorter step
            result[:size] = problem.residual(shape, yp[:size], forces)
            result[size:] = problem.constraints(shape) - kept - compliance * forces

    def jacobian(t: float, y: Array, yp: Array, r: Array, factor: float, result: Array) -> None:
        shape = y[:size]
        with np.errstate(all="ignore"):
            result[:size, :size] = problem.jacobian(shape, yp[:size], y[size:], factor)
            result[:size, size:] = problem.columns(shape)
            result[size:, :size] = problem.constraint_rows(shape)
            result[size:, size:] = -compliance * np.eye(k)

    linear: dict[str, Any] = {"linsolver": "lapackdense" if size > SMALL else "dense", "jacfn": jacobian}
    if issparse(problem.jacobian(q, rate, multipliers, 1.0)):
        bordered = Bordered(problem, compliance, size)
        linear = {
            "linsolver": "gmres", "krylov_dim": 10, "precond": IDAPrecond(bordered.setup, bordered.solve),
            "jactimes": IDAJacTimes(None, bordered.times),
        }  # fmt: skip
    solver = IDA(
        residual, algebraic_idx=list(range(size, size + k)), rtol=tolerances.rtol,
        atol=np.append(np.full(size, tolerances.atol), np.full(k, IGNORED)), max_order=tolerances.max_order, **linear,
    )  # fmt: skip
    solver.init_step(t, np.append(q, multipliers), np.append(rate, np.zeros(k)))
    return solver
