"""Growth rates of all perturbations of a tube in reduced modes, by symmetry block, at fixed area and volume.

Perturbations displace points in the planes ``x = const``; what counts is the normal part. Rigid motions are exact kernels,
known in closed form: they are removed by projection, and how nearly they are kernels says whether the modes resolve the
solution (design, §7).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from pearlbvp.collocation.scheme import Array
from pearlbvp.tube.density import gradients, hessians
from pearlbvp.tube.modes import Basis

Fixed = Literal["area and volume", "area"]


class TubeBlock(NamedTuple):
    """A symmetry block of perturbations.

    Attributes:
        name: what it is called in tables.
        multiplicity: how often each of its growth rates occurs.
    """

    name: str
    multiplicity: int = 1

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True)
class TubeSpectrum:
    """Growth rates of a tube.

    Attributes:
        rates: of each block the largest, largest first, rigid motions left out.
        kernel: largest growth rate of a rigid motion: 0 on an exact solution, and the error of all rates.
        complete: whether all unstable perturbations were counted.
    """

    rates: Mapping[TubeBlock, Array]
    kernel: float
    complete: bool = True

    @property
    def residual(self) -> float:
        """Error of the rates, as ``Spectrum`` of pearls has it."""
        return self.kernel

    @property
    def n_unstable(self) -> int:
        """Dimension of the unstable space."""
        return sum(block.multiplicity * int((rates > 0).sum()) for block, rates in self.rates.items())

    @property
    def critical(self) -> TubeBlock:
        """The block of the largest growth rate."""
        return max(self.rates, key=lambda block: self.rates[block][0] if len(self.rates[block]) else -np.inf)

    @property
    def mu_crit(self) -> float:
        """The largest growth rate."""
        return float(self.rates[self.critical][0])


KEPT = 8
"""Growth rates that are kept of each block."""


@dataclass(frozen=True)
class Surface:
    """An equilibrium on a grid, as its second variation needs it.

    Attributes:
        fields: the ten fields, shape (10, K).
        c0, lambda1, lambda2: of the equilibrium.
    """

    fields: Array
    c0: float
    lambda1: float
    lambda2: float

    def second_variation(self, basis: Basis) -> tuple[NDArray[Any], NDArray[Any]]:
        """Matrices of the second variation and of the normal displacement's mean square, shape (N, N)."""
        hessian = hessians(self.fields, self.c0, self.lambda1)
        hessian[:, 3, 3] += self.lambda2  # volume is the mean of sigma^2/2, and sigma is the field b_1
        second = _quadratic(basis.fields, hessian @ basis.fields)
        normal = self.normal(basis)
        g = self.fields[2] ** 2 + self.fields[3] ** 2 + (self._c()) ** 2
        mass = np.conj(normal.T) @ (normal / np.sqrt(g)[:, None]) / len(g)
        return second, mass

    def _c(self) -> Array:
        a0, a1, b0, b1 = self.fields[:4]
        return np.asarray(a0 * b1 - a1 * b0)

    def normal(self, basis: Basis) -> NDArray[Any]:
        """Normal displacement of each mode times ``sqrt(g)``, shape (K, N)."""
        moved, (b0, b1) = basis.displacement(), self.fields[2:4]
        return np.asarray(-moved[:, 0] * b1[:, None] + moved[:, 1] * b0[:, None])

    def constraints(self, basis: Basis) -> NDArray[Any]:
        """Gradients of area and volume in the modes, shape (2, N)."""
        _, slopes = gradients(self.fields, self.c0)
        area = np.einsum("jk,kjn->n", slopes[1], basis.fields)
        volume = self.fields[3] @ basis.fields[:, 3]
        return np.array([area, volume]) / self.fields.shape[1]


def _quadratic(left: NDArray[Any], right: NDArray[Any]) -> NDArray[Any]:
    """Mean over the points of ``left^H right``, both of shape (K, 10, N): shape (N, N)."""
    count, fields, size = left.shape
    product = np.conj(left.reshape(count * fields, size).T) @ right.reshape(count * fields, size)
    return np.asarray(product / count)


def block_rates(
    surface: Surface, basis: Basis, kernels: Sequence[NDArray[Any]], fixed: Fixed, constrained: bool
) -> tuple[Array, float]:
    """Growth rates of a block, largest first, without its rigid motions, and the largest of those of the rigid motions.

    Args:
        surface: the equilibrium.
        basis: the block's modes on the surface's grid.
        kernels: rigid motions in these modes.
        fixed: what perturbations keep.
        constrained: whether perturbations of the block change area and volume at first order.
    """
    second, mass = surface.second_variation(basis)
    second, mass = (matrix.real if np.abs(matrix.imag).max() < 1e-13 else matrix for matrix in (second, mass))
    rows = []
    if constrained:
        area, volume = surface.constraints(basis)
        rows += [area, volume] if fixed == "area and volume" else [area]
    moving = []
    for kernel in kernels:
        weight = (np.conj(kernel) @ mass @ kernel).real
        if weight > 1e-12 * (np.conj(kernel) @ kernel).real:  # else it moves the surface along itself
            moving.append(kernel / np.sqrt(weight))
            rows.append(np.conj(mass @ kernel))
    allowed = _orthogonal(np.array(rows), len(second))
    projected = [np.conj(allowed.T) @ matrix @ allowed for matrix in (second, mass)]
    rates = -eigh(projected[0], projected[1], eigvals_only=True, subset_by_index=[0, min(KEPT, len(projected[0])) - 1])
    return rates, max((_residual(second, mass, kernel, float(rates[0])) for kernel in moving), default=0.0)


def _residual(second: NDArray[Any], mass: NDArray[Any], kernel: NDArray[Any], largest: float) -> float:
    """Size of ``(second + shift mass)^{-1} second kernel``: the error of a unit kernel vector, in units of growth rates."""
    shift = 1 + max(0.0, largest)
    error = np.linalg.solve(second + shift * mass, second @ kernel)
    return float(np.sqrt(abs(np.conj(error) @ mass @ error)))


def _orthogonal(rows: NDArray[Any], size: int) -> NDArray[Any]:
    """A basis of the vectors that all rows annihilate, shape (size, size - rank)."""
    if not len(rows):
        return np.eye(size)
    rows = rows / np.linalg.norm(rows, axis=1)[:, None]
    _, singular, vectors = np.linalg.svd(rows)
    rank = int((singular > 1e-9).sum())
    return np.conj(vectors[rank:].T)
