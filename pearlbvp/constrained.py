"""Symmetric matrices on the vectors that some rows annihilate: constraints and exact kernels, taken out by one projection."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Array


def independent_directions(rows: Sequence[NDArray[Any]], size: int) -> NDArray[Any]:
    """Orthonormal vectors that span some rows, as columns, shape (size, rank); rows that vanish or repeat count for nothing."""
    lengths = [float(np.linalg.norm(row)) for row in rows]
    least = NOTHING * max(lengths, default=0.0)
    unit = [row / length for row, length in zip(rows, lengths, strict=True) if length > least]
    if not unit:
        return np.zeros((size, 0))
    vectors, singular, _ = np.linalg.svd(np.array(unit).T, full_matrices=False)
    return np.asarray(vectors[:, : int((singular > DEPENDENT).sum())])


NOTHING, DEPENDENT = 1e-10, 1e-8
"""Length of rows that vanish, by the longest; singular value of unit rows at which one is a sum of the others, as those of
area and volume are on a surface of constant mean curvature."""


def restricted(rows: Sequence[NDArray[Any]], *matrices: NDArray[Any]) -> list[NDArray[Any]]:
    """Hermitian matrices on the vectors that all rows annihilate, shape (size - rank, size - rank) each.

    Householder reflections turn the rows into the first unit vectors (G. H. Golub, C. F. Van Loan, Matrix Computations
    (Johns Hopkins 2013), §5.1): that costs a few products with vectors, not with matrices.
    """
    reflectors = _reflectors(independent_directions(rows, len(matrices[0])))
    found = [matrix.copy() for matrix in matrices]
    for reflector in reflectors:
        for matrix in found:
            product = matrix @ reflector
            product -= (reflector.conj() @ product) * reflector
            matrix -= np.column_stack((reflector, product)) @ np.vstack((2 * product.conj(), 2 * reflector.conj()))
    return [matrix[len(reflectors) :, len(reflectors) :] for matrix in found]


def leading_eigenvalues(matrix: NDArray[Any], rows: Sequence[NDArray[Any]] = ()) -> Array:
    """Eigenvalues of a Hermitian matrix on the vectors that all rows annihilate, largest first, as far as they are known.

    Where entries are of very different sizes, as on a thin neck beside a belly, the rounding of the largest would drown the
    eigenvalues near zero. The Cholesky factor of ``shift - matrix``, which scaling does not touch, keeps them, so that
    they are known from the inverse's, ``shift - 1/nu`` (J. Demmel, K. Veselic, SIAM J. Matrix Anal. Appl. 13 (1992) 1204).

    Raises:
        LinAlgError: the matrix has entries that are no numbers.
    """
    from scipy.linalg import get_lapack_funcs  # a tenth of a second, which only spectra need

    potrf, potri = get_lapack_funcs(("potrf", "potri"), (matrix,))
    unit, shift, most = np.eye(len(matrix)), 1.0, 8 * float(np.linalg.norm(matrix))
    factor, indefinite = potrf(shift * unit - matrix, lower=True)
    while indefinite and shift < most:
        shift *= 4
        factor, indefinite = potrf(shift * unit - matrix, lower=True)
    if indefinite or not np.isfinite(most):
        raise np.linalg.LinAlgError("the matrix has entries that are no numbers")
    inverse, _ = potri(factor, lower=True)  # its lower half
    kept = independent_directions(rows, len(matrix))
    if kept.size:
        inverse = np.tril(inverse) + np.tril(inverse, -1).conj().T
        taken = inverse @ kept
        inverse -= taken @ np.linalg.solve(kept.conj().T @ taken, taken.conj().T)
    nu = np.linalg.eigvalsh(inverse)[: kept.shape[1] - len(matrix) - 1 : -1]
    return np.asarray(shift - 1 / nu[nu > KNOWN * nu[0]])


KNOWN = 1e-14
"""Eigenvalues of an inverse, by the largest, that its rounding leaves."""


def lifted(rows: Sequence[NDArray[Any]], vectors: Array) -> Array:
    """Vectors of the restricted space, as columns, in the whole one: those that all rows annihilate."""
    reflectors = _reflectors(independent_directions(rows, len(vectors)))
    whole = np.concatenate((np.zeros((len(reflectors), vectors.shape[1])), vectors))
    for reflector in reversed(reflectors):
        whole = whole - 2 * np.outer(reflector, reflector @ whole)
    return whole


def _reflectors(vectors: NDArray[Any]) -> list[NDArray[Any]]:
    """Unit vectors of the reflections that turn orthonormal columns, one after the other, into the first unit vectors."""
    vectors, found = vectors.copy(), []
    for i in range(vectors.shape[1]):
        reflector = vectors[:, i].copy()
        reflector[:i] = 0.0
        phase = reflector[i] / abs(reflector[i]) if reflector[i] else 1.0
        reflector[i] += phase * np.linalg.norm(reflector)
        reflector /= np.linalg.norm(reflector)
        vectors -= 2 * np.outer(reflector, reflector.conj() @ vectors)
        found.append(reflector)
    return found
