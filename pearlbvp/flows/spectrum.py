"""Growth rates of a semi-discrete flow at an equilibrium: small dense matrices, constraints and rigid motions projected out."""

from __future__ import annotations

from scipy.linalg import eigh

from pearlbvp.arrays import Array
from pearlbvp.constrained import lifted, restricted


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
    kept = [*rows, *(mass @ kernel for kernel in moving)]
    pencil = restricted(kept, second, mass)
    values, vectors = eigh(*pencil, subset_by_index=[0, min(count, len(pencil[0])) - 1])
    return -values, lifted(kept, vectors)
