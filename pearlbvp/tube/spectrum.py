"""Growth rates of all perturbations of a tube in reduced modes, by symmetry block, at fixed area and volume.

Perturbations displace points in the planes ``x = const``; what counts is the normal part. Rigid motions are exact kernels,
known in closed form: they are removed by projection, and how nearly they are kernels says whether the modes resolve the
solution (design, §7).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from scipy.linalg import cholesky, eigh, solve_triangular

from pearlbvp.collocation.scheme import Array
from pearlbvp.errors import SpectrumError
from pearlbvp.representation import brief
from pearlbvp.stability.spectrum import ROUNDING
from pearlbvp.tube.density import gradients, hessians
from pearlbvp.tube.symmetry import TubeBlock
from pearlbvp.tube.waves import (
    IMAGINARY_JETS,
    Cell,
    Complex,
    Forms,
    MatrixTransform,
    ModeWaves,
    Waves,
    fields_of_jets,
    matrix_transform,
)

Fixed = Literal["area and volume", "area"]

RESOLVED = 1e-7
"""Error of a rigid motion, which should have growth rate 0, up to which a solution is called resolved."""


@dataclass(frozen=True)
class TubeSpectrum:
    """Growth rates of a tube.

    Attributes:
        rates: of each block the largest, all positive ones among them, largest first, rigid motions left out.
        kernel: largest error of a rigid motion as a kernel: 0 on an exact solution, and the error of all rates.
        complete: whether all unstable perturbations were counted.
    """

    __repr__ = brief

    rates: Mapping[TubeBlock, Array]
    kernel: float
    complete: bool = True

    @property
    def resolved(self) -> bool:
        """Whether the modes resolve the solution."""
        return self.kernel <= RESOLVED

    @property
    def residual(self) -> float:
        """Error of the rates, as ``Spectrum`` of pearls has it."""
        return self.kernel

    @property
    def neutral(self) -> float:
        """Growth rates of this size are zero to the accuracy of the spectrum: its kernels', and rounding."""
        largest = max((float(np.abs(rates).max(initial=0.0)) for rates in self.rates.values()), default=0.0)
        return 1e-9 + ROUNDING * largest + 10 * self.kernel

    @property
    def n_unstable(self) -> int:
        """Dimension of the unstable space; at a branch point its neutral perturbation is not counted."""
        zero = self.neutral  # it takes a look at all blocks
        return sum(block.multiplicity * int((rates > zero).sum()) for block, rates in self.rates.items())

    @property
    def critical(self) -> TubeBlock:
        """The block of the largest growth rate."""
        return max(self.rates, key=lambda block: self.rates[block][0] if len(self.rates[block]) else -np.inf)

    @property
    def mu_crit(self) -> float:
        """The largest growth rate."""
        return float(self.rates[self.critical][0])

    def to_tree(self) -> dict[str, Any]:
        """Everything as arrays, numbers and words, to be saved."""
        return {
            "names": ";".join(block.name for block in self.rates),
            "blocks": np.array([block[1:] for block in self.rates], dtype=np.int64),
            "rates": np.concatenate(list(self.rates.values())),
            "sizes": np.array([len(rates) for rates in self.rates.values()], dtype=np.int64),
            "kernel": self.kernel,
            "complete": self.complete,
        }

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> TubeSpectrum:
        """The inverse of ``to_tree``."""
        names = str(tree["names"]).split(";")
        blocks = [TubeBlock(name, *map(int, row)) for name, row in zip(names, tree["blocks"], strict=True)]
        pieces = np.split(np.asarray(tree["rates"], dtype=float), np.cumsum(tree["sizes"])[:-1])
        rates = dict(zip(blocks, pieces, strict=True))
        return cls(rates, float(tree["kernel"]), bool(tree["complete"]))


KEPT = 8
"""Growth rates that are kept of each block, at least."""


@dataclass(frozen=True)
class Equilibrium:
    """An equilibrium on the grid of its cell, as its second variation needs it.

    Attributes:
        cell: the grid.
        fields: the ten fields, shape (10, K).
        kappa: rate at which the frame turns.
        c0, lambda1, lambda2: of the equilibrium.
    """

    __repr__ = brief

    cell: Cell
    fields: Array
    kappa: float
    c0: float
    lambda1: float
    lambda2: float

    @cached_property
    def _hessian(self) -> Array:
        """Second derivatives of the Lagrangian's density in the fields, shape (K, 10, 10)."""
        hessian: Array = hessians(self.fields, self.c0, self.lambda1)
        hessian[:, 3, 3] += self.lambda2  # volume is the mean of sigma^2/2, and sigma is the field b_1
        return hessian

    @cached_property
    def _bending(self) -> MatrixTransform:
        """Second derivatives of the Lagrangian's density in the jets (``tube.waves``)."""
        jets = fields_of_jets(self.kappa)
        return matrix_transform(self.cell, jets.T @ self._hessian @ jets, IMAGINARY_JETS)

    @cached_property
    def _moving(self) -> MatrixTransform:
        """What makes of displacements in the plane the square of the normal one, by area."""
        a0, a1, b0, b1 = self.fields[:4]
        normal = np.stack((-b1, b0), axis=1)
        root = np.sqrt(b0**2 + b1**2 + (a0 * b1 - a1 * b0) ** 2)
        return matrix_transform(self.cell, normal[:, :, None] * normal[:, None, :] / root[:, None, None], (1,))

    @cached_property
    def _forms(self) -> dict[Waves, tuple[Forms, Forms]]:
        return {}

    def hessian(self, modes: ModeWaves) -> Array:
        """Matrix of the second variation, shape (N, N)."""
        return modes.quadratic(modes.waves.bending_forms(self.cell, self._bending))

    def second_variation(self, modes: ModeWaves) -> tuple[Array, Array]:
        """Matrices of the second variation and of the normal displacement's mean square, shape (N, N).

        Blocks that share their waves share nearly all of the work.
        """
        waves, cell = modes.waves, self.cell
        if waves not in self._forms:
            self._forms[waves] = waves.bending_forms(cell, self._bending), waves.moving_forms(cell, self._moving)
        bending, moving = self._forms[waves]
        return modes.quadratic(bending), modes.quadratic(moving)

    @cached_property
    def _gradients(self) -> tuple[Array, Array]:
        """Densities of energy and area, shape (2, K), and their gradients in the fields, shape (2, 10, K)."""
        values, slopes = gradients(self.fields, self.c0)
        return values, slopes

    @cached_property
    def _by_volume(self) -> Array:
        """Gradient of the volume's density, shape (10, K)."""
        slope = np.zeros_like(self.fields)
        slope[3] = self.fields[3]
        return slope

    @cached_property
    def _force(self) -> Array:
        """Gradient of the Lagrangian's density, shape (10, K)."""
        energy, area = self._gradients[1]
        return np.asarray(energy + self.lambda1 * area + self.lambda2 * self._by_volume)

    @property
    def means(self) -> tuple[float, float, float]:
        """Energy, area and volume by unit area of the cylinder."""
        energy, area = self._gradients[0].mean(axis=1)
        return float(energy), float(area), float((self.fields[3] ** 2).mean()) / 2

    def force(self, modes: ModeWaves) -> Array:
        """Gradient of energy and constraints with their multipliers in the modes, shape (N,): 0 at an equilibrium."""
        return modes.linear(self.cell, self.cell.transform(self._force))

    @cached_property
    def _slopes(self) -> tuple[Complex, Complex]:
        return self.cell.transform(self._gradients[1][1]), self.cell.transform(self._by_volume)

    def constraints(self, modes: ModeWaves) -> tuple[Array, Array]:
        """Gradients of area and volume in the modes, each of shape (N,)."""
        area, volume = self._slopes
        return modes.linear(self.cell, area), modes.linear(self.cell, volume)

    def by_c0(self, modes: ModeWaves) -> Array:
        """Derivative by ``c0`` of the energy's gradient in the modes, shape (N,).

        The energy is a polynomial of degree two in ``c0``, so that its central difference over any step is exact.
        """
        ahead, behind = (gradients(self.fields, self.c0 + step)[1][0] for step in (1.0, -1.0))
        return modes.linear(self.cell, self.cell.transform((ahead - behind) / 2))

    def by_length(self, modes: ModeWaves, length: float) -> tuple[Array, float]:
        """Derivatives by the length of the Lagrangian's gradient in the modes, shape (N,), and of the area's mean.

        The modes keep their numbers of waves, the frame its turns: a field of ``d`` derivatives along the tube is
        proportional to ``length^-d``, in the solution and in the modes.
        """
        order = ORDERS_ALONG[:, None]
        stretched = order * self.fields
        weights = order * self._force + np.einsum("kij,jk->ik", self._hessian, stretched)
        by_area = (self._gradients[1][1] * stretched).sum(axis=0).mean()
        return -modes.linear(self.cell, self.cell.transform(weights)) / length, -float(by_area) / length


ORDERS_ALONG = np.array([1.0, 1.0, 0.0, 0.0, 2.0, 2.0, 1.0, 1.0, 0.0, 0.0])
"""How often each of the ten fields ``a, b, p, q, s`` (``tube.density``) is differentiated along the tube."""


def block_rates(
    equilibrium: Equilibrium, modes: ModeWaves, kernels: Sequence[Array], fixed: Fixed
) -> tuple[Array, float]:
    """Growth rates of a block, largest first, without its rigid motions, and the largest error of the rigid motions.

    Args:
        equilibrium: what is perturbed.
        modes: of the block.
        kernels: rigid motions in these modes.
        fixed: what perturbations keep.
    """
    second, mass = equilibrium.second_variation(modes)
    area, volume = equilibrium.constraints(modes)
    # In other blocks than the solution's own both gradients vanish.
    rows = [row for row in ((area, volume) if fixed == "area and volume" else (area,)) if np.abs(row).max() > 1e-9]
    moving = []
    for kernel in kernels:
        weight = kernel @ mass @ kernel
        if weight > 1e-12 * kernel @ kernel:  # else it moves the surface along itself
            moving.append(kernel / np.sqrt(weight))
            rows.append(mass @ kernel)
    restricted_second, restricted_mass = _restricted(rows, second, mass)
    size = len(restricted_second)
    if size == 0:
        return np.zeros(0), 0.0
    rates = _leading(restricted_second, restricted_mass)
    return rates, max((_residual(second, mass, kernel, float(rates[0])) for kernel in moving), default=0.0)


def _leading(second: Array, mass: Array) -> Array:
    """The largest growth rates, all positive ones among them, largest first.

    They come from the largest eigenvalues of ``mass`` against ``second + shift mass``. The other way round their error would be
    rounding times the fastest decay over the lightest displacement: on slender coils, where some displacements hardly move the
    surface along its normal, that is more than the rates themselves.

    Raises:
        SpectrumError: displacements that do not move the surface grow, which is a matrix gone wrong.
    """
    shift, largest = 16.0, 1e3 * max(16.0, float(np.abs(second).max() / np.abs(np.diag(mass)).max()))
    while True:
        try:
            factor = cholesky(second + shift * mass, lower=True)  # above all growth rates it is positive definite
            break
        except np.linalg.LinAlgError:
            if shift > largest:
                raise SpectrumError(
                    f"its growth rates have no bound up to {largest:.0e}: the modes do not resolve them"
                ) from None
            shift *= 8
    inverse = solve_triangular(factor, solve_triangular(factor, mass, lower=True).T, lower=True)
    size = len(mass)
    few = eigh(inverse, eigvals_only=True, subset_by_index=[max(0, size - KEPT), size - 1])
    rates = np.asarray(shift - 1 / few[::-1])
    if rates[-1] < 0 or len(rates) == size:
        return rates
    # More grow than are kept: all rates cost little more than a few, and many times a few far more.
    rates = np.asarray(shift - 1 / eigh(inverse, eigvals_only=True)[::-1])
    return rates[: int((rates > 0).sum()) + 1]


def _residual(second: Array, mass: Array, kernel: Array, largest: float) -> float:
    """Size of ``(second + shift mass)^{-1} second kernel``: the error of a unit kernel vector, in units of growth rates."""
    shift = 1 + max(0.0, largest)
    error = np.linalg.solve(second + shift * mass, second @ kernel)
    return float(np.sqrt(abs(error @ mass @ error)))


def _restricted(rows: Sequence[Array], *matrices: Array) -> list[Array]:
    """Symmetric matrices on the vectors that all rows annihilate.

    Householder reflections turn the rows into the first unit vectors (G. H. Golub, C. F. Van Loan, Matrix Computations
    (Johns Hopkins 2013), §5.1): that costs a few products with vectors, not with matrices.
    """
    if not rows:
        return list(matrices)
    unit = np.array([row / np.linalg.norm(row) for row in rows])
    vectors, singular, _ = np.linalg.svd(unit.T, full_matrices=False)
    rank = int((singular > 1e-9).sum())
    vectors = vectors[:, :rank]
    found = [matrix.copy() for matrix in matrices]
    for i in range(rank):
        reflector = vectors[:, i].copy()
        reflector[:i] = 0.0
        reflector[i] += np.copysign(np.linalg.norm(reflector), reflector[i])
        reflector /= np.linalg.norm(reflector)
        vectors -= 2 * np.outer(reflector, reflector @ vectors)
        for matrix in found:
            product = matrix @ reflector
            product -= (reflector @ product) * reflector
            matrix -= 2 * (np.outer(reflector, product) + np.outer(product, reflector))
    return [matrix[rank:, rank:] for matrix in found]
