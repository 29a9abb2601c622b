"""Stability of a cylinder over a closed plane curve of ``n`` equal lobes, for every wave number along it.

A normal outward perturbation ``w(s) e^{ikx}`` has ``D = dH = -(w'' - k^2 w + kappa^2 w)/2`` and the growth rate
(``docs/theory/stability.md`` with ``kappa_phi = 0, K = 0``)

    mu w = D'' - k^2 D - 2 kappa w H'' - kappa w' H' - 2 w H'^2 + (6H^2 - a) D + (2 c0 - 2H) k^2 kappa w,

``a = 2(c0^2 + lambda1)``. Multiplied by ``w`` and integrated by parts, with ``f = kappa^2/2 - a``,

    mu |w|^2 = integral of -(w'' + (kappa^2 - k^2) w)^2/2 + f w'^2/2
               + [f (k^2 - kappa^2)/2 - kappa kappa'' - kappa'^2/2 + (2 c0 - kappa) kappa k^2] w^2  ds:

a Hermitian matrix ``M + k^2 S - k^4/2``, so that one pair of matrices serves all ``k``, and nothing grows beyond the ``k`` at
which the largest eigenvalues of ``M`` and ``S`` together fall below ``k^4/2``.

Waves are discretized by Fourier series on equidistant points of one lobe. Those of class ``c`` turn by ``2 pi c/n`` from lobe
to lobe; where that is 0 or pi they are even or odd about the tips. As the lobe is even about its tip, the matrices of their
coefficients are real in every class. The two translations across (class 1) and the rotation (``kappa'``, class 0, odd) are
exact kernels at ``k = 0``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.constrained import restricted
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.errors import SpectrumError
from pearlbvp.held import AREA_AND_VOLUME, Held, Quantities, coefficients
from pearlbvp.representation import brief
from pearlbvp.stability.bloch import waves
from pearlbvp.stability.spectrum import kernel_residual

MOST_WAVES = 2000
"""Largest number of waves along the tube among which the first to grow is looked for."""

MOST_WORK = 2e8
"""Waves along times classes times the cube of their sizes, up to which a spectrum is computed: a few seconds."""


@dataclass(frozen=True)
class PlaneProfile:
    """A closed equilibrium curve of perimeter ``2 pi`` with ``n`` equal symmetric lobes, counterclockwise.

    Attributes:
        states: ``psi, kappa, kappa'`` (turn of the tangent from the tip on, curvature, its derivative by arclength), shape
            (K, 3), as a function of ``sigma`` in [0, 1], shape (K,): from the tip of a lobe to the waist.
        n: number of lobes.
        c0, lambda1, lambda2: parameters and multipliers with which the cylinder over it is an equilibrium.
    """

    __repr__ = brief

    states: Callable[[Array], Array]
    n: int
    c0: float
    lambda1: float
    lambda2: float

    @property
    def a(self) -> float:
        """``2(c0^2 + lambda1)``."""
        return 2 * (self.c0**2 + self.lambda1)

    def at(self, sigma: Array) -> Array:
        """States at ``sigma`` from 0 to ``2 n``, shape (K,): all around the curve, shape (K, 3)."""
        lobe, within = np.divmod(sigma, 2.0)
        beyond = within > 1
        states = np.array(self.states(np.where(beyond, 2 - within, within)))
        states[beyond, 2] *= -1
        states[beyond, 0] *= -1
        states[:, 0] += 2 * math.pi / self.n * (lobe + beyond)
        return states

    def curve(self, sigma: Array) -> NDArray[np.complex128]:
        """Points in the complex plane about the centre, the first tip on the positive real axis, shape (K,).

        ``2 lambda2`` times the position is the force ``e^{i psi} (kappa^2/2 - a + i kappa')`` turned by a right angle
        (``theta.elastica`` has its closed form): no integration, no drift.
        """
        psi, kappa, slope = self.at(sigma).T
        return np.asarray(np.exp(1j * psi) * (kappa**2 / 2 - self.a + 1j * slope) / (2 * self.lambda2))

    def surface(self, length: float, along: int = 2, around: int = 181) -> tuple[Array, Array, Array]:
        """Points of the cylinder, to draw or to export: ``x, y, z``, each of shape (along, around), closed around."""
        curve = self.curve(np.linspace(0, 2 * self.n, around))
        x = np.repeat(np.linspace(0, length, along)[:, None], around, axis=1)
        return x, np.tile(curve.real, (along, 1)), np.tile(curve.imag, (along, 1))


class PlanarBlock(NamedTuple):
    """A symmetry block of perturbations: ``j`` waves along the tube, turning by ``2 pi c/n`` from lobe to lobe.

    Where the turn is neither 0 nor pi, classes ``c`` and ``n - c`` have the same rates and are one block.
    """

    j: int
    c: int
    n: int
    parity: str | None

    @property
    def theta(self) -> float:
        """Phase per lobe, exactly pi where it is."""
        return math.pi if 2 * self.c == self.n else 2 * math.pi * self.c / self.n

    @property
    def multiplicity(self) -> int:
        """How often each growth rate occurs: two directions along the tube, two around it."""
        return (1 if self.j == 0 else 2) * (1 if self.parity else 2)

    def __str__(self) -> str:
        return f"j={self.j} c={self.c}/{self.n}" + (f" {self.parity}" if self.parity else "")


def classes_of(n: int) -> list[tuple[int, str | None]]:
    """Classes and parities of the perturbations of ``n`` lobes."""
    found: list[tuple[int, str | None]] = []
    for c in range(n // 2 + 1):
        parities = ("even", "odd") if c == 0 or 2 * c == n else (None,)
        found += [(c, parity) for parity in parities]
    return found


@dataclass(frozen=True)
class PlanarVariation:
    """The second variation of a plane profile, sampled once, for any wave number and class.

    Attributes:
        profile: what is perturbed.
        psi, kappa, slope: its states at the points ``(i + 1/2)/count`` of a lobe, shape (count,).
    """

    __repr__ = brief

    profile: PlaneProfile
    psi: Array
    kappa: Array
    slope: Array

    @classmethod
    def of(cls, profile: PlaneProfile, points: int = 64) -> PlanarVariation:
        """Sample a profile at an even number of points of a lobe (an odd one is raised by one)."""
        count = points + points % 2
        return cls(profile, *profile.at(2 * (np.arange(count) + 0.5) / count).T)

    def waves(self, c: int, parity: str | None) -> tuple[NDArray[Any], NDArray[Any], Array]:
        """Unit waves of a class, their derivatives and numbers, at the points (the first half of them with a parity)."""
        wave, slope, per_lobe = waves(len(self.kappa), PlanarBlock(0, c, self.profile.n, parity).theta, parity)
        number = per_lobe * self.profile.n / (2 * math.pi)
        return wave, slope * number, number

    def matrices(self, c: int, parity: str | None) -> tuple[Array, Array]:
        """``M`` and ``S`` of a class: its rates at wave number ``k`` are those of ``M + k^2 S - k^4/2``.

        They act on the coefficients of ``w`` in the class's ``waves``.
        """
        profile = self.profile
        wave, derivative, number = self.waves(c, parity)
        here = slice(None, len(wave))
        kappa, slope = self.kappa[here], self.slope[here]
        bend = -(kappa**3) / 2 + profile.a * kappa + 2 * profile.lambda2  # kappa''
        f = kappa**2 / 2 - profile.a
        value = -f * kappa**2 / 2 - kappa * bend - slope**2 / 2

        def product(factor: Array) -> Array:
            return np.asarray((wave.conj().T @ (factor[:, None] * wave)).real)

        bending = product(kappa**2) - np.diag(number**2)
        stretching = (derivative.conj().T @ (f[:, None] * derivative)).real
        at_rest = (stretching - bending.T @ bending) / 2 + product(value)
        by_square = bending + product(f / 2 + (2 * profile.c0 - kappa) * kappa)
        return (at_rest + at_rest.T) / 2, (by_square + by_square.T) / 2

    def kernels(self, c: int, parity: str | None) -> list[Array]:
        """Rigid motions of a class at ``k = 0``, as unit vectors of coefficients."""
        translation, found = np.exp(1j * self.psi), []
        if c == 0 and parity == "odd" and np.abs(self.slope).max() > 1e-6:
            found.append(self.slope)  # -p times the normal part of a rotation; on the circle there is none
        if c == 1 and parity is None:
            found.append(translation)
        elif c == 1:
            found.append(translation.real if parity == "even" else translation.imag)
        coefficients = [self._coefficients(vector, c, parity) for vector in found]
        return [vector / np.linalg.norm(vector) for vector in coefficients]

    def _coefficients(self, values: NDArray[Any], c: int, parity: str | None) -> Array:
        """Of values at all points in the waves of a class."""
        wave = self.waves(c, parity)[0]
        return np.asarray((wave.conj().T @ values[: len(wave)]).real)

    def quantities(self, length: float) -> Quantities:
        """Area, volume and integrated mean curvature of a tube of a length, by perturbations even about the tips, ``k = 0``.

        The volume is half the integral of the distances ``(kappa^2/2 - a)/(2 lambda2)`` of tangents from the centre (see
        ``PlaneProfile.curve``); ``M`` does not change, as ``2H`` turns the tangent once.
        """
        profile, count = self.profile, len(self.waves(0, "even")[0])
        distance = float((self.kappa**2 / 2 - profile.a).mean()) / (2 * profile.lambda2)
        changes = (self.kappa, np.ones_like(self.kappa), np.zeros_like(self.kappa))
        return Quantities(
            count * np.array([1.0, distance / 2, 0.5]),
            np.array([self._coefficients(by, 0, "even") for by in changes]),
            coefficients(profile.lambda1, profile.lambda2, profile.c0),
            2 * math.pi * length / count,
        )

    def at_rest(
        self, c: int, parity: str | None, length: float = 1.0, held: Held = AREA_AND_VOLUME
    ) -> tuple[list[Array], NDArray[Any]]:
        """At ``k = 0``: rows that perturbations of a class are orthogonal to, and their second variation; see ``rates_at``."""
        second = -self.matrices(c, parity)[0]
        if c == 0 and parity == "even":
            return held.constrained(second, self.quantities(length))
        return self.kernels(c, parity), second

    def rates_at(
        self, c: int, parity: str | None, k: Array, length: float = 1.0, held: Held = AREA_AND_VOLUME
    ) -> list[Array]:
        """Growth rates at wave numbers ``k``, shape (J,), each largest first; at ``k = 0`` without rigid motions.

        Args:
            c, parity: of the class.
            k: the wave numbers.
            length: of the tube, which a law of what is held may go by.
            held: what is held.
        """
        at_rest, by_square = self.matrices(c, parity)
        square = np.square(k)[:, None]
        moving = np.linalg.eigvalsh(at_rest + square[:, None] * by_square)[:, ::-1] - square**2 / 2
        found = list(moving)
        for place in np.flatnonzero(k == 0):
            rows, second = self.at_rest(c, parity, length, held)
            (resting,) = restricted(rows, -second)
            found[place] = np.linalg.eigvalsh(resting)[::-1]
        return found

    def largest_wave_number(self, c: int, parity: str | None) -> float:
        """A ``k`` beyond which no wave of a class grows: ``k^4/2 > M + k^2 S`` for the largest eigenvalues of both."""
        top, by_square = (max(0.0, float(np.linalg.eigvalsh(matrix)[-1])) for matrix in self.matrices(c, parity))
        return math.sqrt(by_square + math.sqrt(by_square**2 + 2 * top))

    def most_waves(self, length: float) -> int:
        """Number of waves along a tube up to which growing ones are looked for: a tenth beyond the last that could grow."""
        largest = max(self.largest_wave_number(c, parity) for c, parity in classes_of(self.profile.n))
        return math.floor(1.1 * largest * length / (2 * math.pi)) + 1

    def residual(self) -> float:
        """Largest error of a rigid motion as a kernel: how well profile and points resolve the rates."""
        found = 0.0
        for c, parity in classes_of(self.profile.n):
            if kernels := self.kernels(c, parity):
                matrix = self.matrices(c, parity)[0]
                largest = float(np.linalg.eigvalsh(matrix)[-1])
                found = max(found, *(kernel_residual(matrix, kernel, largest) for kernel in kernels))
        return found


_KEPT = 8
"""Growth rates kept of each block, besides the positive ones."""


FEW, USUAL = 16, 32
"""Points of a lobe to begin with."""


def _enough(profile: PlaneProfile, tolerance: float) -> int:
    """Points of a lobe to begin with.

    Where there are many lobes, the rounding of the highest waves' fourth derivatives is what limits rates on the usual points:
    it shows in the lower ones, and nothing is won by such waves if what can grow is far below them.
    """
    rounding = np.finfo(float).eps * (profile.n * USUAL / 2) ** 4 / 2
    if rounding < tolerance:
        return USUAL
    kappa = profile.at(np.linspace(0.0, 1.0, USUAL))[:, 1]
    # On a circle no wave grows whose number is larger: the quadratic form there, with the largest coefficients here.
    fastest = math.sqrt(1 + max(0.0, *(kappa**2 / 2 - profile.a)) + 2 * max(0.0, *((2 * profile.c0 - kappa) * kappa)))
    return min(USUAL, max(FEW, 8 + 4 * math.ceil(fastest / profile.n)))


def resolved(profile: PlaneProfile, *, tolerance: float = 1e-9, max_points: int = 512) -> tuple[PlanarVariation, float]:
    """The second variation on as many points as make rigid motions kernels to ``tolerance``, and how well they are.

    Args:
        profile: the curve.
        tolerance: for the residual of the exact kernels; points are doubled as long as that helps.
        max_points: of a lobe, the most to go to.
    """
    variation = PlanarVariation.of(profile, _enough(profile, tolerance))
    residual = variation.residual()
    while residual > tolerance and 2 * len(variation.psi) <= max_points:
        finer = PlanarVariation.of(profile, 2 * len(variation.psi))
        smaller = finer.residual()
        if smaller > residual / 2:  # rounding, or the profile itself, is what remains
            break
        variation, residual = finer, smaller
    return variation, residual


def planar_spectrum(
    profile: PlaneProfile, length: float, *, held: Held = AREA_AND_VOLUME, tolerance: float = 1e-9
) -> Spectrum:
    """Growth rates of all perturbations of a tube of a length that can grow.

    All waves along the tube are looked at up to beyond the largest wave number at which any could grow, so that a block in
    which one begins to grow was there on the solution before.

    Args:
        profile: the cross-section.
        length: axial period of the tube.
        held: what is held.
        tolerance: for the residual of the exact kernels.

    Raises:
        SpectrumError: those that can grow are too many.
    """
    variation, residual = resolved(profile, tolerance=tolerance)
    rates: dict[PlanarBlock, Array] = {}
    most, points = variation.most_waves(length), len(variation.psi)
    few = MOST_WORK / ((profile.n // 2 + 1) * points**3) - 1
    if most > few:
        instead = (
            "fewer lobes, or stop before" if few < 2 else f"a shorter tube, of at most {few / most:.2g} of that length"
        )
        raise SpectrumError(
            f"its stability would take too many modes: up to {most} waves along the tube may grow; take {instead}"
        )
    k = np.arange(most + 1, dtype=np.float64) * (2 * math.pi / length)
    for c, parity in classes_of(profile.n):
        for start in range(0, len(k), 128):  # no more matrices at a time than fit a cache
            for j, found in enumerate(variation.rates_at(c, parity, k[start : start + 128], length, held), start):
                rates[PlanarBlock(j, c, profile.n, parity)] = found[: _KEPT + int((found > 0).sum())]
    return Spectrum.of(rates, residual, points=points)


def planar_rates(
    profile: PlaneProfile, length: float, block: PlanarBlock, points: int, held: Held = AREA_AND_VOLUME
) -> Array:
    """Growth rates of one block on a number of points of a lobe, largest first, without exact kernels."""
    k = np.array([2 * math.pi * block.j / length])
    return PlanarVariation.of(profile, points).rates_at(block.c, block.parity, k, length, held)[0]
