"""Growth rates of a triangulated tube at fixed area and volume, and how many are positive.

``second variation w = -mu mass w`` on the displacements that keep area and volume and contain no rigid motion. The count
is the inertia of the bordered matrix and owes nothing to iterations; the rates nearest zero come from Lanczos' method on
its inverse. Each checks the other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, eigsh

from pearlbvp.mesh.bordered import Pinned
from pearlbvp.mesh.periodic import Array, Integers

Fixed = Literal["area and volume", "area"]

NEUTRAL = 1e-9
"""Growth rates of this size are zero to the accuracy of the arithmetic."""

SMOOTH = 20.0
"""Growth rates, in size, of displacements that count as smooth."""

NOTHING = 1e-6
"""Mean square below which a unit rigid motion moves the surface along itself, and the gradients of area and volume are
parallel, as they are on the straight tube."""


class MeshBlock(NamedTuple):
    """A symmetry block of perturbations: a mesh has no symmetry, and all are in one."""

    name: str = "all"
    multiplicity: int = 1

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True)
class MeshSpectrum:
    """Growth rates of a triangulated tube.

    Attributes:
        rates: the largest, largest first, rigid motions left out.
        complete: whether the number of positive ones is that of the inertia.
    """

    rates: Mapping[MeshBlock, Array]
    complete: bool = True

    @property
    def n_unstable(self) -> int:
        """Dimension of the unstable space; at a branch point its neutral perturbations are not counted."""
        return sum(block.multiplicity * int((rates > NEUTRAL).sum()) for block, rates in self.rates.items())

    @property
    def critical(self) -> MeshBlock:
        """The block of the largest growth rate."""
        return max(self.rates, key=lambda block: float(self.rates[block][0]))

    @property
    def mu_crit(self) -> float:
        """The largest growth rate."""
        return float(self.rates[self.critical][0])

    @property
    def residual(self) -> float:
        """Error of the rates: not known, for rigid motions that move no vertex along its normal are exact on every mesh."""
        return float("nan")

    def to_tree(self) -> dict[str, Any]:
        """Everything as arrays and numbers, to be saved."""
        return {"rates": self.rates[MeshBlock()], "complete": self.complete}

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> MeshSpectrum:
        """The inverse of ``to_tree``."""
        return cls({MeshBlock(): np.asarray(tree["rates"], dtype=float)}, bool(tree["complete"]))


def independent(rows: Array, second: sparse.csc_matrix, mass: sparse.csc_matrix, pins: Integers) -> Array:
    """Combinations of rows that stand for smooth displacements, unit ones, without those that are none.

    On the straight tube a shift along it moves no point along the normal, and on a mesh all but none; what remains is
    roughness, and no kernel. So rows ``r`` are measured by ``s r (second + s mass)^{-1} r``: the mean square of a kernel,
    and next to nothing of what is rough.

    Args:
        rows: products of displacements with the mass, shape (q, V).
        second: second variation, shape (V, V).
        mass: of normal displacements, shape (V, V).
        pins: vertices for the factorization.

    Returns:
        Shape (rank, V).
    """
    none = np.zeros((0, second.shape[0]))
    smoothed = Pinned.of((second + SMOOTH * mass).tocsc(), pins).bordered(none.T, none, np.zeros((0, 0)))
    gram = SMOOTH * rows @ smoothed.solve(np.ascontiguousarray(rows.T), np.zeros((0, len(rows))), 0)
    squares, vectors = np.linalg.eigh((gram + gram.T) / 2)
    kept = squares > NOTHING * mass.sum()
    return np.asarray((vectors[:, kept] / np.sqrt(squares[kept])).T @ rows)


def leading(
    second: sparse.csc_matrix, mass: sparse.csc_matrix, rows: Array, pins: Integers, count: int
) -> tuple[Array, Array, int]:
    """The growth rates nearest zero and all positive ones, largest first, on what the rows annihilate.

    Args:
        second: second variation, shape (V, V).
        mass: of normal displacements, shape (V, V).
        rows: shape (q, V), independent.
        pins: vertices for the factorization.
        count: how many negative ones are wanted at least.

    Returns:
        The rates, their perturbations as columns, and the number of positive rates by inertia.

    Raises:
        numpy.linalg.LinAlgError: the matrix is singular, or Lanczos' method did not converge.
    """
    pinned = Pinned.of(second, pins)
    unstable = pinned.negative(rows)
    size, zero = second.shape[0], np.zeros((len(rows), 1))
    bordered = pinned.bordered(rows.T, rows, np.zeros((len(rows), len(rows))))

    def inverse(load: Array) -> Array:
        return bordered.solve(load.reshape(-1, 1), zero, 0)[:size, 0]

    operator = LinearOperator((size, size), matvec=inverse, dtype=np.float64)
    start = inverse(mass @ np.random.default_rng(0).standard_normal(size))
    wanted = min(unstable + count, size // 2)
    while True:
        try:
            values, vectors = eigsh(second, wanted, mass, sigma=0.0, OPinv=operator, v0=start, tol=1e-10)
        except sparse.linalg.ArpackNoConvergence as error:
            raise np.linalg.LinAlgError(f"Lanczos' method: {error}") from None
        order = np.argsort(values)
        rates = -values[order]
        if (rates > 0).sum() >= unstable or wanted >= size // 2:
            return rates, vectors[:, order], unstable
        wanted = min(2 * wanted, size // 2)
