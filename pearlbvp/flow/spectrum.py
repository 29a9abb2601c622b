"""Growth rates of a semi-discrete flow at an equilibrium: small dense matrices, constraints and rigid motions projected out."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh

from pearlbvp.flow.problem import Array


def allowed(rows: Array, size: int) -> Array:
    """An orthonormal basis of the vectors that all rows annihilate, shape (size, size - rank)."""
    if not len(rows):
        return np.eye(size)
    norms = np.linalg.norm(rows, axis=1)
    rows = rows[norms > 1e-14] / norms[norms > 1e-14, None]
    _, singular, vectors = np.linalg.svd(rows)
    return np.asarray(vectors[int((singular > 1e-9).sum()) :].T)


def growth_rates(second: Array, mass: Array, rows: Array, kernels: Array, count: int) -> tuple[Array, Array]:
    """The largest ``mu`` of ``mass w_t = -second w`` among perturbations that keep what is kept.

    Args:
        second: second variation of ``F``, symmetric, shape (N, N).
        mass: the metric, symmetric and positive.
        rows: gradients of what is kept, shape (k, N).
        kernels: rigid motions, shape (m, N), left out by orthogonality in the metric; those that move nothing are ignored.
        count: how many.

    Returns:
        Rates, largest first, and vectors with unit norm in the metric, shape (N, count).
    """
    moving = [kernel for kernel in kernels if kernel @ mass @ kernel > 1e-16]
    basis = allowed(np.vstack((rows, *(mass @ kernel for kernel in moving))), len(second))
    projected = [basis.T @ matrix @ basis for matrix in (second, mass)]
    values, vectors = eigh(*projected, subset_by_index=[0, min(count, basis.shape[1]) - 1])
    return -values, basis @ vectors
