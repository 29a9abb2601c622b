"""Factors of sparse symmetric matrices, definite or not, by the library at hand.

With the extra ``pearlbvp[fast]``: PARDISO of Intel's MKL, an LDL^T over nested dissection with Bunch and Kaufman's pivots (O.
Schenk, K. Gärtner, ETNA 23 (2006) 158). Without it SuperLU, an LU over minimum degree with pivots on the diagonal, which costs
three to six times as long. Both tell the inertia: D, or the diagonal of U, has the signs of the eigenvalues (Sylvester).
"""

from __future__ import annotations

import weakref
from dataclasses import dataclass
from hashlib import blake2b
from typing import TYPE_CHECKING, ClassVar, Protocol

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

from pearlbvp.arrays import Array

if TYPE_CHECKING:
    from pymklpardiso import PardisoSolver


class Factors(Protocol):
    """Factors of a symmetric matrix of shape (V, V)."""

    dear: ClassVar[bool]
    """Whether they cost as much as dozens of solutions, so that it pays to keep them for a matrix that is near."""

    @property
    def negative(self) -> int:
        """Number of negative eigenvalues.

        Raises:
            numpy.linalg.LinAlgError: the factors do not tell.
        """

    def solve(self, load: Array) -> Array:
        """Solve for right-hand sides of shape (V,) or (V, s)."""


def factorized(matrix: sparse.csc_matrix) -> Factors:
    """Factors of a sparse symmetric matrix, by PARDISO where it is installed.

    Raises:
        numpy.linalg.LinAlgError: it is singular, or not finite.

    Examples:
        >>> from scipy import sparse
        >>> factors = factorized(sparse.diags([-2.0, 1.0, 4.0], format="csc"))
        >>> factors.negative, factors.solve(np.ones(3)).tolist()
        (1, [-0.5, 1.0, 0.25])
    """
    if not np.isfinite(matrix.data).all():
        raise np.linalg.LinAlgError("a matrix that is not finite")
    try:
        return by_pardiso(matrix)
    except ImportError:
        return by_superlu(matrix)


@dataclass(frozen=True, eq=False)
class LU:
    """SuperLU's."""

    dear: ClassVar[bool] = True
    factors: SuperLU

    @property
    def negative(self) -> int:
        """See ``Factors``: not known where a pivot on the diagonal vanished and another was taken."""
        if not np.array_equal(self.factors.perm_r, self.factors.perm_c):
            raise np.linalg.LinAlgError("a pivot vanished, and the inertia is unknown")
        return int((self.factors.U.diagonal() < 0).sum())

    def solve(self, load: Array) -> Array:
        """See ``Factors``."""
        return np.asarray(self.factors.solve(load))


def by_superlu(matrix: sparse.csc_matrix) -> LU:
    """See ``factorized``. relax=1 keeps SuperLU from padding its columns, which costs it five times as long here."""
    try:
        return LU(
            splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, relax=1, options={"SymmetricMode": True})
        )
    except RuntimeError as error:
        raise np.linalg.LinAlgError(str(error)) from None


SETTINGS = {1: 2, 7: 0, 9: 13, 10: 0, 12: 0, 20: 1}
"""PARDISO's ``iparm``: nested dissection, refinement only of perturbed factors, pivots below 1e-13 perturbed, no scaling, no
matching, Bunch and Kaufman's pivots."""

PERTURBED, NEGATIVE = 13, 22
"""Where it tells the numbers of perturbed pivots and of negative eigenvalues."""

_idle: dict[bytes, PardisoSolver] = {}
"""The solver of the matrix that was factorized last and that nobody solves with any more, by its pattern: its ordering and
symbolic factorization, half of the cost, serve the next matrix of that pattern."""


@dataclass(frozen=True, eq=False)
class LDL:
    """PARDISO's: of a matrix of a known pattern they cost no more than the refinements that they would save."""

    dear: ClassVar[bool] = False
    solver: PardisoSolver

    @property
    def negative(self) -> int:
        """See ``Factors``."""
        return int(self.solver.get_iparm_value(NEGATIVE))

    def solve(self, load: Array) -> Array:
        """See ``Factors``."""
        return np.asarray(self.solver.solve(load))


def by_pardiso(matrix: sparse.csc_matrix) -> LDL:
    """See ``factorized``.

    Raises:
        ImportError: the extra is not installed.
    """
    from pymklpardiso import MTYPE_REAL_SYM_INDEF, PardisoSolver

    lower = sparse.tril(matrix, format="csc")
    lower.sort_indices()
    if not np.array_equal(lower.indices[lower.indptr[:-1]], np.arange(lower.shape[0])):
        raise np.linalg.LinAlgError("a diagonal entry is not stored")
    pattern = blake2b(lower.indptr.tobytes() + lower.indices.tobytes()).digest()
    try:
        solver = _idle.pop(pattern, None)
        if solver is None:
            upper = sparse.csr_matrix((lower.data, lower.indices, lower.indptr), shape=lower.shape)  # the transpose
            solver = PardisoSolver(upper, MTYPE_REAL_SYM_INDEF, SETTINGS)
        else:
            solver.refactor(lower.data)
    except RuntimeError as error:
        raise np.linalg.LinAlgError(f"PARDISO: {error}") from None
    found = LDL(solver)
    weakref.finalize(found, _lay_aside, pattern, solver).atexit = False
    if solver.get_iparm_value(PERTURBED):
        raise np.linalg.LinAlgError("the matrix is singular to working precision")
    return found


def _lay_aside(pattern: bytes, solver: PardisoSolver) -> None:
    _idle.clear()
    _idle[pattern] = solver
