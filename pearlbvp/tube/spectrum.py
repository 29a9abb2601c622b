"""Growth rates of all perturbations of a tube in reduced modes, by symmetry block, at fixed area and volume.

Perturbations displace points in the planes ``x = const``; what counts is the normal part. Rigid motions are exact kernels,
known in closed form: they are removed by projection, and how nearly they are kernels says whether the modes resolve the
solution (``docs/theory/reduced_modes.md``).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, cholesky, eigh, solve_triangular
from scipy.linalg.blas import dtrsv
from scipy.linalg.lapack import dsygst

from pearlbvp.arrays import Array, Complex
from pearlbvp.constrained import restricted
from pearlbvp.errors import SpectrumError
from pearlbvp.held import Held, Quantities, coefficients
from pearlbvp.representation import brief
from pearlbvp.tube.density import areas, gradients, hessians
from pearlbvp.tube.waves import (
    IMAGINARY_DRAGS,
    IMAGINARY_JETS,
    Cell,
    Families,
    MatrixTransform,
    ModeWaves,
    fields_of_jets,
    matrix_transform,
)

KEPT = 8
"""Growth rates that are kept of each block, at least."""

LARGE = 200
"""Size of a block beyond which Lanczos' method finds its leading growth rates in less time than a dense one."""


@dataclass(frozen=True)
class Equilibrium:
    """An equilibrium on the grid of its cell, as its second variation needs it; or any tube, pulled by its multipliers.

    Attributes:
        cell: the grid.
        fields: the ten fields, shape (10, K); for areas, volumes and displacements the first four are enough.
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
        return matrix_transform(self.cell, self._hessian, IMAGINARY_JETS, fields_of_jets(self.kappa))

    @cached_property
    def _moving(self) -> MatrixTransform:
        """What makes of displacements in the plane the square of the normal one, by area."""
        normal = self.outward.T
        weights = normal[:, :, None] * normal[:, None, :] / self.areas[0][:, None, None]
        return matrix_transform(self.cell, weights, (1,))

    @cached_property
    def outward(self) -> Array:
        """The plane part of the outward normal, times the area element: turned as the fields are, shape (2, K)."""
        return np.stack((self.fields[3], -self.fields[2]))

    @cached_property
    def areas(self) -> tuple[Array, Array]:
        """The area element, shape (K,), and its gradient in the first four fields, shape (4, K)."""
        element, slopes = areas(self.fields)
        return element, slopes

    def hessian(self, modes: ModeWaves) -> Array:
        """Matrix of the second variation, shape (N, N)."""
        return modes.waves.bending(self.cell, self._bending, Families.of(modes))[0]

    def mass(self, modes: ModeWaves) -> Array:
        """Matrix of the normal displacement's mean square, shape (N, N)."""
        return modes.waves.moving(self.cell, self._moving, Families.of(modes))[0]

    def stiffness(self, modes: ModeWaves) -> Array:
        """Matrix of the mean ``|grad N|^2`` of the normal displacements ``N = n . delta P``, shape (N, N).

        ``n = -i b/|g|``, so that ``n_x`` is made of ``q = P_xphi`` and ``n_phi`` of ``s = P_phiphi``; the metric is that of the
        tangents ``(1, a)`` and ``(0, b)`` of the surface.
        """
        (element, slopes), z = self.areas, self.fields
        normal = self.outward / element
        rows = np.zeros((2, 6, z.shape[1]))
        for row, along, turned, place in (
            (rows[0], z[4:8], z[6:8], slice(2, 4)),
            (rows[1], z[6:10], z[8:10], slice(4, 6)),
        ):
            row[:2] = (np.stack((turned[1], -turned[0])) - normal * (slopes * along).sum(axis=0)) / element
            row[place] = normal
        a, b = z[:2], z[2:4]
        inverse = np.array([[(b * b).sum(0), -(a * b).sum(0)], [-(a * b).sum(0), 1 + (a * a).sum(0)]]) / element
        weights = np.einsum("iuk,ijk,jvk->kuv", rows, inverse, rows)
        transform = matrix_transform(self.cell, weights, IMAGINARY_DRAGS)
        return modes.waves.spreading(self.cell, transform, Families.of(modes))[0]

    def second_variations(self, *families: ModeWaves) -> list[tuple[Array, Array]]:
        """Matrices of the second variation and of the normal displacement's mean square, shape (N, N), of each family.

        Those of the same waves share nearly all of the work.
        """
        waves, cell, together = families[0].waves, self.cell, Families.of(*families)
        bending, moving = waves.bending(cell, self._bending, together), waves.moving(cell, self._moving, together)
        return list(zip(bending, moving, strict=True))

    @cached_property
    def _gradients(self) -> tuple[Array, Array]:
        """Density of the energy, shape (K,), and its gradient in the fields, shape (10, K)."""
        values, slopes = gradients(self.fields, self.c0)
        return values, slopes

    @cached_property
    def _force(self) -> Array:
        """Gradient of the Lagrangian's density, shape (10, K)."""
        force = self._gradients[1].copy()
        force[:4] += self.lambda1 * self.areas[1]
        force[3] += self.lambda2 * self.fields[3]
        return np.asarray(force)

    @property
    def area(self) -> float:
        """Area by that of the cylinder."""
        return float(self.areas[0].mean())

    @property
    def volume(self) -> float:
        """Volume by the cylinder's area."""
        return float(self.fields[3] @ self.fields[3]) / (2 * self.fields.shape[1])

    @property
    def means(self) -> tuple[float, float, float]:
        """Energy, area and volume by unit area of the cylinder."""
        return float(self._gradients[0].mean()), self.area, self.volume

    @property
    def curvature(self) -> float:
        """Integral of the mean curvature by area of the cylinder: the energy's derivative by ``c0`` is ``2 (c0 A - M)``."""
        return self.c0 * self.area - float(self._by_c0[0].mean()) / 2

    @cached_property
    def _by_c0(self) -> tuple[Array, Array]:
        """Derivatives by ``c0`` of the energy's density, shape (K,), and of its gradient in the fields, shape (10, K).

        It is a polynomial of degree two, with the area as the coefficient of the square, so that differences are exact.
        """
        (ahead, slopes_ahead), (here, slopes) = gradients(self.fields, self.c0 + 1), self._gradients
        element, by_area = self.areas
        change = slopes_ahead - slopes
        change[:4] -= by_area
        return ahead - here - element, change

    def torque(self, places: Array) -> float:
        """``dE/d(twist)`` at fixed area, volume and length: what turns the tube's ends against each other.

        A twist turns the section at ``x`` by ``x`` times its rate, so that the rate adds ``i P`` to ``a = P_x``, ``2 i a`` to
        ``p = P_xx`` and ``i b`` to ``q = P_xphi``.

        Args:
            places: points of the surface in the plane, turned as the fields are, shape (2, K).
        """
        turned = np.zeros_like(self.fields)
        for fields, vector in (
            (slice(0, 2), places),
            (slice(4, 6), 2 * self.fields[:2]),
            (slice(6, 8), self.fields[2:4]),
        ):
            turned[fields] = -vector[1], vector[0]
        return 2 * math.pi * float((self._force * turned).sum(axis=0).mean())

    def force(self, modes: ModeWaves) -> Array:
        """Gradient of energy and constraints with their multipliers in the modes, shape (N,): 0 at an equilibrium."""
        return modes.linear(self.cell, self.cell.transform(self._force))

    @cached_property
    def _slopes(self) -> tuple[Complex, Complex]:
        return self.cell.transform(self.areas[1]), self.cell.transform(self.fields[3:4])

    def constraints(self, modes: ModeWaves) -> tuple[Array, Array]:
        """Gradients of area and volume in the modes, each of shape (N,)."""
        area, volume = self._slopes
        return modes.linear(self.cell, area, range(4)), modes.linear(self.cell, volume, range(3, 4))

    def by_c0(self, modes: ModeWaves) -> Array:
        """Derivative by ``c0`` of the energy's gradient in the modes, shape (N,)."""
        return modes.linear(self.cell, self.cell.transform(self._by_c0[1]))

    def quantities(self, modes: ModeWaves, length: float) -> Quantities:
        """Area, volume and integrated mean curvature of a tube of a length, by the cylinder's area, and by the modes."""
        by_area, by_volume = self.constraints(modes)
        return Quantities(
            np.array([self.area, self.volume, self.curvature]),
            np.array([by_area, by_volume, self.c0 * by_area - self.by_c0(modes) / 2]),
            coefficients(self.lambda1, self.lambda2, self.c0),
            2 * math.pi * length,
        )

    def by_length(self, modes: ModeWaves, length: float) -> tuple[Array, float]:
        """Derivatives by the length of the Lagrangian's gradient in the modes, shape (N,), and of the area's mean.

        The modes keep their numbers of waves, the frame its turns: a field of ``d`` derivatives along the tube is
        proportional to ``length^-d``, in the solution and in the modes.
        """
        order = ORDERS_ALONG[:, None]
        stretched = order * self.fields
        weights = order * self._force + np.einsum("kij,jk->ik", self._hessian, stretched)
        by_area = (self.areas[1] * stretched[:4]).sum(axis=0).mean()
        return -modes.linear(self.cell, self.cell.transform(weights)) / length, -float(by_area) / length


ORDERS_ALONG = np.array([1.0, 1.0, 0.0, 0.0, 2.0, 2.0, 1.0, 1.0, 0.0, 0.0])
"""How often each of the ten fields ``a, b, p, q, s`` (``tube.density``) is differentiated along the tube."""


@dataclass(frozen=True)
class BlockProblem:
    """A block's eigenproblem ``second w = -mu mass w`` on the vectors that some rows annihilate.

    Attributes:
        second, mass: with what is held and changes, besides the modes, as further unknowns.
        rows: of what is held and of rigid motions.
        motions: the rigid motions that move the surface, of unit mass, in the modes.
        matrices: second variation and mass of the modes alone.
    """

    __repr__ = brief

    second: NDArray[Any]
    mass: Array
    rows: list[Array]
    motions: list[Array]
    matrices: tuple[Array, Array]

    @classmethod
    def of(
        cls,
        equilibrium: Equilibrium,
        modes: ModeWaves,
        matrices: tuple[Array, Array],
        kernels: Sequence[Array],
        held: Held,
        length: float,
    ) -> Self:
        """The problem of a block.

        Args:
            equilibrium: what is perturbed.
            modes: of the block.
            matrices: theirs (``Equilibrium.second_variations``).
            kernels: rigid motions in these modes.
            held: what is held.
            length: of the tube.
        """
        second, mass = matrices
        rows: list[Array] = []
        motions: list[Array] = []
        constrained: NDArray[np.inexact[Any]] = second
        whole_mass = mass
        by_volume = equilibrium.constraints(modes)[1]
        if np.abs(by_volume).max() > 1e-9:  # in other blocks than the solution's own nothing changes that may be held
            rows, constrained = held.constrained(second, equilibrium.quantities(modes, length))
            whole_mass = block_diag(mass, np.eye(len(constrained) - len(second)))
        for kernel in kernels:
            weight = kernel @ mass @ kernel
            if weight > 1e-12 * kernel @ kernel:  # else it moves the surface along itself
                motions.append(kernel / np.sqrt(weight))
                rows.append(np.append(mass @ kernel, np.zeros(len(constrained) - len(second))))
        return cls(constrained, whole_mass, rows, motions, matrices)

    def rates(self) -> tuple[Array, float]:
        """Growth rates, largest first, without rigid motions, and the largest error of these."""
        restricted_second, restricted_mass = restricted(self.rows, self.second, self.mass)
        if len(restricted_second) == 0:
            return np.zeros(0), 0.0
        rates = _leading(restricted_second, restricted_mass)
        errors = (_residual(*self.matrices, motion, float(rates[0])) for motion in self.motions)
        return rates, max(errors, default=0.0)


def _leading(second: Array, mass: Array) -> Array:
    """The largest growth rates, all positive ones among them, largest first.

    They come from the largest eigenvalues of ``mass`` against ``second + shift mass``. The other way round their error would be
    rounding times the fastest decay over the lightest displacement: on slender coils, where some displacements hardly move the
    surface along its normal, that is more than the rates themselves.

    Raises:
        SpectrumError: displacements that do not move the surface grow, which is a matrix gone wrong.
    """
    factor, shift = _factored(second, mass)
    few = _by_lanczos(second, mass, factor, shift) if len(mass) >= LARGE else None
    return _by_reduction(mass, factor, shift) if few is None or few[-1] >= 0 else few


def _factored(second: Array, mass: Array) -> tuple[Array, float]:
    """A shift above all growth rates, and the lower Cholesky factor of ``second + shift mass``."""
    shift, largest = 1.0, 1e3 * max(16.0, float(np.abs(second).max() / np.abs(np.diag(mass)).max()))
    while True:
        try:
            return cholesky(second + shift * mass, lower=True), shift
        except np.linalg.LinAlgError:
            if shift > largest:
                raise SpectrumError(
                    f"its growth rates have no bound up to {largest:.0e}: the modes do not resolve them; stop before, or "
                    "follow the branch on a mesh (nodes)"
                ) from None
            shift *= 8


def _by_reduction(mass: Array, factor: Array, shift: float) -> Array:
    """The leading growth rates from all of the matrix, reduced to one that is tridiagonal; see ``_by_lanczos``."""
    inverse, _ = dsygst(mass, factor, lower=1)
    size = len(mass)
    few = eigh(inverse, lower=True, eigvals_only=True, subset_by_index=[max(0, size - KEPT), size - 1])
    rates = np.asarray(shift - 1 / few[::-1])
    if rates[-1] < 0 or len(rates) == size:
        return rates
    # More grow than are kept: all rates cost little more than a few, and many times a few far more.
    rates = np.asarray(shift - 1 / eigh(inverse, lower=True, eigvals_only=True)[::-1])
    return rates[: int((rates > 0).sum()) + 1]


def _by_lanczos(second: Array, mass: Array, factor: Array, shift: float) -> Array | None:
    """The ``KEPT`` largest growth rates by Lanczos' method, none left out for certain; None where that is not known.

    With those that were found taken down below the cut, ``second + cut mass`` is positive definite, and so has a Cholesky
    factor, if and only if no other rate lies above the cut (Sylvester's law of inertia; B. N. Parlett, The Symmetric
    Eigenvalue Problem (SIAM 1998), §3.3).

    Args:
        second, mass: of the block.
        factor: lower Cholesky factor of ``second + shift mass``.
        shift: above all growth rates.
    """
    from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh  # not needed where blocks are small

    def inverse(y: Array) -> Array:
        return np.asarray(dtrsv(factor, mass @ dtrsv(factor, y, lower=1, trans=1), lower=1))

    size = len(mass)
    operator = LinearOperator((size, size), inverse, dtype=np.float64)
    try:
        values, vectors = eigsh(operator, KEPT + 1, which="LA", v0=np.ones(size), ncv=3 * KEPT)
    except ArpackNoConvergence:
        return None
    rates = shift - 1 / values[::-1]
    found, cut = rates[:KEPT], rates[-2:].mean()
    scaled = vectors[:, :0:-1] / np.sqrt(values[:0:-1])  # of unit mass, once the factor is taken off
    moved = mass @ solve_triangular(factor, scaled, lower=True, trans=1)
    try:
        cholesky(second + cut * mass + (moved * (found - cut + 1)) @ moved.T)
    except np.linalg.LinAlgError:
        return None
    return np.asarray(found)


def _residual(second: Array, mass: Array, kernel: Array, largest: float) -> float:
    """Size of ``(second + shift mass)^{-1} second kernel``: the error of a unit kernel vector, in units of growth rates."""
    shift = 1 + max(0.0, largest)
    error = np.linalg.solve(second + shift * mass, second @ kernel)
    return float(np.sqrt(abs(error @ mass @ error)))
