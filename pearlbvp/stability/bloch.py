"""Growth rates of perturbations ``e^{i n phi} e^{i theta x / period}``: the second variation on one period.

The second variation of the energy at fixed multipliers, in the direction of a normal perturbation ``w``, is minus

    integral of -(Lap w + Q w)^2/2 + (f/2 + g kappa_phi) w'^2 + [(f/2 + g kappa_s) n^2/r^2 + R] w^2  dS,

``Q = 4H^2 - 2K``, ``f = 2H^2 - 2(c0^2 + lambda1)``, ``g = 2 c0 - 2H``: the equation of ``docs/theory/stability.md``,
multiplied by ``w`` and integrated by parts (``div`` of the cofactor of the curvature tensor vanishes, Codazzi). It is
discretized by Fourier series in the isothermal coordinate ``xi``, ``ds = r dxi``, in which ``Lap = (d^2/dxi^2 - n^2)/r^2``
and a neck of radius ``eps`` costs ``log(1/eps)`` points. The matrix is Hermitian by construction. Where the profile has
planes of reflection, waves of any ``theta`` have a real matrix on real vectors: their real parts, even about the first of
the planes (the belly), and their imaginary parts, odd about it. Where ``theta`` is 0 or pi the two are apart.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.constrained import leading_eigenvalues
from pearlbvp.held import AREA_AND_VOLUME, Held, Quantities, coefficients
from pearlbvp.representation import brief
from pearlbvp.stability.isothermal import Isothermal
from pearlbvp.stability.profile import Profile, curvatures


@lru_cache(maxsize=64)
def waves(count: int, theta: float, parity: str | None) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Waves, their derivatives, and wave numbers per period, at the points ``(j + 1/2) / count``.

    Without parity: ``e^{i kappa xi}`` on ``count`` points. With one, on the first half of the points: cosines or sines, which
    the discrete transforms DCT-II, DST-II (``theta = 0``), DCT-IV, DST-IV (``theta = pi``) make orthonormal; or ``both``,
    cosines above sines, the real and the imaginary part of ``e^{i kappa xi}``. Derivatives are to be multiplied by the wave
    numbers.
    """
    if parity is None:
        x = (np.arange(count) + 0.5) / count
        kappa = 2 * np.pi * (np.arange(count) - count // 2) + theta
        wave = np.exp(1j * np.outer(x, kappa)) / np.sqrt(count)
        return wave, 1j * wave, kappa
    half = count // 2
    x = (np.arange(half) + 0.5) / count
    if parity == "both":
        kappa = 2 * np.pi * (np.arange(count) - half) + theta
    else:
        kappa = 2 * np.pi * (np.arange(half) + (1 if parity == "odd" and theta == 0 else 0)) + theta
    angles = np.outer(x, kappa)
    cosines, sines = np.cos(angles), np.sin(angles)
    wave, slope = {
        "even": (cosines, -sines),
        "odd": (sines, cosines),
        "both": (np.vstack((cosines, sines)), np.vstack((-sines, cosines))),
    }[parity]
    sizes = np.linalg.norm(wave, axis=0)
    return wave / sizes, slope / sizes, kappa


@lru_cache(maxsize=32)
def derivatives(count: int, theta: float, parity: str | None) -> tuple[NDArray[Any], NDArray[Any]]:
    """Matrices from values at the points to those of the first and the second derivative of the sum of ``waves``.

    By a coordinate of period 1. The first one's rows have the other parity.
    """
    wave, slope, kappa = waves(count, theta, parity)
    inverse = wave.conj().T
    return (slope * kappa) @ inverse, (wave * -(kappa**2)) @ inverse


@dataclass(frozen=True)
class QuadraticForm:
    """The second variation on all waves of a ``theta`` (and a parity): ``at_rest + n^2 by_square - n^4/2 by_fourth``.

    Attributes:
        at_rest, by_square: Hermitian, on ``r w`` at the points, shape (K, K).
        by_fourth: a diagonal, shape (K,).
    """

    __repr__ = brief

    at_rest: NDArray[Any]
    by_square: NDArray[Any]
    by_fourth: Array

    def matrix(self, n: int) -> NDArray[Any]:
        """Of the growth rates of waves ``n``."""
        found: NDArray[Any] = self.at_rest + n**2 * self.by_square
        found.ravel()[:: len(found) + 1] -= n**4 / 2 * self.by_fourth
        return found


@dataclass(frozen=True)
class SecondVariation:
    """The second variation of a profile, sampled once, for any ``n`` and ``theta``.

    Attributes:
        xi_period: the period in the isothermal coordinate.
        count: of the points of the whole period.
        r, q: radius and ``Q`` at the points, shape (K,); ``K`` is ``count``, or half of it where the profile is symmetric.
        by_slope: coefficient of ``w'^2``.
        by_n: coefficient of ``n^2 w^2 / r^2``.
        by_value: coefficient ``R`` of ``w^2``.
        h, gauss: mean and Gaussian curvature.
        psi: tangent angle.
        coefficients: of area, volume and integrated mean curvature in the Lagrangian (``held``).
        symmetric: whether the other half of the points mirrors these, so that waves have parities.
    """

    __repr__ = brief

    xi_period: float
    count: int
    r: Array
    q: Array
    by_slope: Array
    by_n: Array
    by_value: Array
    h: Array
    gauss: Array
    psi: Array
    coefficients: Array
    symmetric: bool

    @classmethod
    def of(cls, profile: Profile, points: int = 64, coordinate: Isothermal | None = None) -> SecondVariation:
        """Sample a profile at an even number of points of its whole period (an odd one is raised by one).

        Args:
            profile: the profile.
            points: how many.
            coordinate: the profile's, where it is known.
        """
        coordinate = coordinate or Isothermal.of(profile)
        count = points + points % 2
        states = profile.states(coordinate.points(count))
        g = curvatures(states, profile)
        q = 4 * g.h**2 - 2 * g.gauss
        f = 2 * g.h**2 - 2 * (profile.c0**2 + profile.lambda1)
        coupling = 2 * profile.c0 - 2 * g.h
        by_value = (
            -(g.h1**2 + g.h * g.lap)  # a quarter of the Laplacian of f, from w f Lap w
            - f * q / 2
            + (g.around * g.h2 + g.along * g.b * g.h1)  # from w g (cofactor : Hessian of w)
            - 2 * g.h * g.gauss * coupling
            - 2 * (g.along * g.h2 + g.around * g.b * g.h1)
            - 2 * g.h1**2
            - ((g.around - g.h) * (g.h2 - g.b * g.h1) - g.h1**2)  # from 2 (H - kappa_s) H' w w'
        )
        by_slope, by_n = f / 2 + coupling * g.around, f / 2 + coupling * g.along
        p = coefficients(profile.lambda1, profile.lambda2, profile.c0)
        return cls(
            coordinate.period, count, g.r, q, by_slope, by_n, by_value, g.h, g.gauss, states[:, 1], p, profile.half
        )

    def form(self, theta: float, parity: str | None = None) -> QuadraticForm:
        """The second variation on waves with a phase, acting on ``r w`` at the points.

        On a symmetric profile real: without a parity on the real part of ``r w``, then the imaginary part.

        Args:
            theta: phase per period.
            parity: ``even`` or ``odd`` about the belly, where ``theta`` is 0 or pi and the profile symmetric.

        Raises:
            ValueError: a parity where waves have none.
        """
        if parity is not None and not (self.symmetric and theta in (0.0, np.pi)):
            raise ValueError("parity: only waves with theta = 0 or pi on a profile with planes of reflection have one")
        both = parity is None and self.symmetric
        first, second = derivatives(self.count, theta, "both" if both else parity)
        of_points = np.array((self.r, self.q, self.by_slope, self.by_n, self.by_value))
        r, q, by_slope, by_n, by_value = np.tile(of_points, 2) if both else of_points
        bending = second / (self.xi_period**2 * np.outer(r, r))  # r (Lap w + Q w) is this, and - n^2 / r^2, times r w
        bending.ravel()[:: len(r) + 1] += q
        slope = first / (self.xi_period * r)
        at_rest = slope.conj().T @ (by_slope[:, None] * slope) - 0.5 * (bending.conj().T @ bending)
        at_rest.ravel()[:: len(r) + 1] += by_value
        by_square = bending / r[:, None] ** 2
        by_square.ravel()[:: len(r) + 1] += by_n / r**2
        return QuadraticForm(_hermitian(at_rest), _hermitian(by_square), 1 / r**4)

    def matrix(self, n: int, theta: float, parity: str | None = None) -> NDArray[Any]:
        """Hermitian matrix of the growth rates of the Bloch waves ``(n, theta)``; see ``form``."""
        return self.form(theta, parity).matrix(n)

    def quantities(self, size: int, cells: int = 1) -> Quantities:
        """Area, volume and integrated mean curvature of ``cells`` periods, by waves even about the belly, or without a parity.

        The coordinates of ``form`` are ``y = r w``, so that an integral of ``f w dS`` is the sum of ``f r y`` by the unit, the
        area between two circles of points by ``r^2``.
        """
        r, h = self.r, self.h
        volume = 0.5 * float(r**2 @ (r * np.cos(self.psi)))  # by the divergence of the part across the axis
        gradients = np.array([2 * h * r, r, self.gauss * r])
        return Quantities(
            np.array([r @ r, volume, h @ r**2]),
            np.pad(gradients, ((0, 0), (0, size - len(r)))),  # imaginary parts are odd: they change none of these
            self.coefficients,
            cells * 2 * np.pi * self.xi_period / len(r),
        )

    def constrained(self, matrix: NDArray[Any], held: Held, cells: int = 1) -> tuple[list[Array], NDArray[Any]]:
        """Rows that perturbations are orthogonal to, and the matrix of growth rates, by what is held.

        Args:
            matrix: of ``n = 0, theta = 0``, not odd: no other waves change what may be held. On a surface of constant mean
                curvature the rows of area and volume are one.
            held: what is held.
            cells: periods on the tube.
        """
        rows, second = held.constrained(-matrix, self.quantities(len(matrix), cells))
        return rows, -second

    def growth_rates(self, n: int, theta: float, parity: str | None = None, *, held: Held = AREA_AND_VOLUME) -> Array:
        """Growth rates of the Bloch waves ``(n, theta)`` of one period, largest first."""
        matrix = self.matrix(n, theta, parity)
        rows: list[Array] = []
        if n == 0 and theta == 0 and parity != "odd":
            rows, matrix = self.constrained(matrix, held)
        return leading_eigenvalues(matrix, rows)


def _hermitian(matrix: NDArray[Any]) -> NDArray[Any]:
    """The Hermitian part."""
    return np.asarray((matrix + matrix.conj().T) / 2)


def growth_rates(profile: Profile, n: int, theta: float, points: int = 64) -> Array:
    """Growth rates of perturbations ``e^{i n phi} e^{i theta x / period}`` at fixed area and volume, largest first.

    Args:
        profile: one period, or half of it.
        n: azimuthal number.
        theta: phase per period, ``q * period``; on a tube of ``N`` periods it takes the values ``2 pi j / N``.
        points: Fourier points of the period.
    """
    return SecondVariation.of(profile, points).growth_rates(n, theta)
