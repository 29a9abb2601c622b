"""Growth rates of all perturbations of a tube in reduced modes, by symmetry block, at fixed area and volume.

Perturbations displace points in the planes ``x = const``; what counts is the normal part. Rigid motions are exact kernels,
known in closed form: they are removed by projection, and how nearly they are kernels says whether the modes resolve the
solution (design, §7).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cholesky, eigh, solve_triangular

from pearlbvp.arrays import Array, Complex
from pearlbvp.constrained import restricted
from pearlbvp.errors import SpectrumError
from pearlbvp.helfrich import Fixed
from pearlbvp.representation import brief
from pearlbvp.tube.density import gradients, hessians
from pearlbvp.tube.waves import (
    IMAGINARY_JETS,
    Cell,
    Forms,
    MatrixTransform,
    ModeWaves,
    Waves,
    fields_of_jets,
    matrix_transform,
)

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
    restricted_second, restricted_mass = restricted(rows, second, mass)
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
                    f"its growth rates have no bound up to {largest:.0e}: the modes do not resolve them; stop before, or "
                    "follow the branch on a mesh (--nodes)"
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
