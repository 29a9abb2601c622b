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

# SUNDIALS would print every failed step on standard error; what a failure means is said by the driver.
os.environ.setdefault("SUNLOGGER_ERROR_FILENAME", os.devnull)
from sksundae.ida import IDA, IDAJacTimes, IDAPrecond

from pearlbvp.arrays import Array
from pearlbvp.bordered import Bordered, Pinned
from pearlbvp.flows.problem import FlowProblem

IGNORED = 1e8
"""Absolute tolerance of the multipliers, at which IDA's error test ignores them."""

NO_PINS = np.zeros(0, dtype=np.int64)
"""The metric in the matrix leaves it no near kernels that it would have to be held against."""

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
class Preconditioner:
    """The inverse of the matrix of Newton's method, its sparse part factorized: set up by IDA when it wants a new one.

    Attributes:
        problem: the flow.
        compliance: of the constraints.
        size: number of coordinates.
    """

    problem: FlowProblem
    compliance: float
    size: int
    _metric: Any = field(default=None, repr=False)
    _factor: float = 0.0
    _bordered: Bordered | None = field(default=None, repr=False)

    def setup(self, t: float, y: Array, yp: Array, r: Array, factor: float) -> None:
        """Factorize at a state."""
        q, rate, multipliers = y[: self.size], yp[: self.size], y[self.size :]
        self._factor, self._metric = factor, self.problem.metric(q)
        columns, rows = self.problem.columns(q), self.problem.constraint_rows(q)
        corner = -self.compliance * np.eye(len(rows))
        try:
            with np.errstate(all="ignore"):
                matrix = self.problem.jacobian(q, rate, multipliers, factor).tocsc()
                self._bordered = Pinned.of(matrix, NO_PINS).bordered(columns, rows, corner)
        except np.linalg.LinAlgError:  # no correction is finite then, and IDA takes a shorter step
            self._bordered = None

    def solve(self, t: float, y: Array, yp: Array, r: Array, rhs: Array, z: Array, factor: float, delta: float) -> None:
        """``z`` with ``[[A, C], [R, -epsilon]] z = rhs`` at the state of the last set-up."""
        if self._bordered is None:
            z[:] = np.nan
            return
        z[:] = self._bordered.solve(rhs[: self.size, None], rhs[self.size :, None], refinements=0)[:, 0]

    def times(self, t: float, y: Array, yp: Array, r: Array, v: Array, result: Array, factor: float) -> None:
        """That matrix times ``v``, for the present step's ``factor`` of the metric."""
        if self._bordered is None:
            result[:] = np.nan
            return
        b, moved, multipliers = self._bordered, v[: self.size], v[self.size :]
        result[: self.size] = b.pinned.matrix @ moved + b.columns @ multipliers
        result[: self.size] += (factor - self._factor) * (self._metric @ moved)
        result[self.size :] = b.rows @ moved + b.corner @ multipliers


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
        inverse = Preconditioner(problem, compliance, size)
        linear = {
            "linsolver": "gmres", "krylov_dim": 10, "precond": IDAPrecond(inverse.setup, inverse.solve),
            "jactimes": IDAJacTimes(None, inverse.times),
        }  # fmt: skip
    solver = IDA(
        residual, algebraic_idx=list(range(size, size + k)), rtol=tolerances.rtol,
        atol=np.append(np.full(size, tolerances.atol), np.full(k, IGNORED)), max_order=tolerances.max_order, **linear,
    )  # fmt: skip
    solver.init_step(t, np.append(q, multipliers), np.append(rate, np.zeros(k)))
    return solver
