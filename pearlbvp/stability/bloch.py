"""Growth rates of perturbations ``e^{i n phi} e^{i theta x / period}``: the second variation on one period.

The second variation of the energy at fixed multipliers, in the direction of a normal perturbation ``w``, is minus

    integral of -(Lap w + Q w)^2/2 + (f/2 + g kappa_phi) w'^2 + [(f/2 + g kappa_s) n^2/r^2 + R] w^2  dS,

``Q = 4H^2 - 2K``, ``f = 2H^2 - 2(c0^2 + lambda1)``, ``g = 2 c0 - 2H``: the equation of ``docs/theory/stability.md``,
multiplied by ``w`` and integrated by parts (``div`` of the cofactor of the curvature tensor vanishes, Codazzi). It is
discretized by Fourier series in the isothermal coordinate ``xi``, ``ds = r dxi``, in which ``Lap = (d^2/dxi^2 - n^2)/r^2``
and a neck of radius ``eps`` costs ``log(1/eps)`` points. The matrix is Hermitian by construction. Where the profile has
planes of reflection and ``theta`` is 0 or pi, waves are even or odd about the first of them (the belly): real matrices of
half the size.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.constrained import restricted
from pearlbvp.helfrich import Fixed
from pearlbvp.representation import brief
from pearlbvp.stability.profile import Profile, curvatures

_GAUSS_NODES, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(12)


def isothermal_points(profile: Profile, count: int) -> tuple[Array, float]:
    """Points of the whole period evenly spaced in ``xi = integral of ds/r``, at ``(j + 1/2) / count`` of it.

    Returns:
        ``sigma`` (as ``Profile.at`` takes it), shape (count,), and the period in ``xi``.
    """
    mesh, states = profile.states.mesh, profile.states

    def xi_beyond(left: Array, right: Array) -> Array:
        """Integral of ds/r from left to right, each pair inside one interval."""
        half = (right - left) / 2
        points = (left + right)[:, None] / 2 + half[:, None] * _GAUSS_NODES
        radius = states(points.ravel())[:, 0].reshape(points.shape)
        result: Array = profile.arclength * half * ((1 / radius) @ _GAUSS_WEIGHTS)
        return result

    at_mesh = np.concatenate(([0.0], np.cumsum(xi_beyond(mesh[:-1], mesh[1:]))))
    copies = 2 if profile.half else 1
    total = copies * at_mesh[-1]
    target = (np.arange(count) + 0.5) * total / count
    folded = np.where(target > at_mesh[-1], total - target, target)
    interval = np.clip(np.searchsorted(at_mesh, folded, side="right") - 1, 0, len(mesh) - 2)
    left, right = mesh[interval], mesh[interval + 1]
    sigma = left + (right - left) * (folded - at_mesh[interval]) / (at_mesh[interval + 1] - at_mesh[interval])
    for _ in range(20):  # Newton: d xi / d sigma = arclength / r
        miss = at_mesh[interval] + xi_beyond(left, sigma) - folded
        step = miss * states(sigma)[:, 0] / profile.arclength
        sigma = np.clip(sigma - step, left, right)
        if np.abs(step).max() < 1e-14:
            break
    return np.where(target > at_mesh[-1], 2 - sigma, sigma), float(total)


@lru_cache(maxsize=64)
def waves(count: int, theta: float, parity: str | None) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Waves, their derivatives, and wave numbers per period, at the points ``(j + 1/2) / count``.

    Without parity: ``e^{i kappa xi}`` on ``count`` points. With parity: cosines or sines on the first half of the points,
    where the discrete transforms DCT-II, DST-II (``theta = 0``), DCT-IV, DST-IV (``theta = pi``) make them orthonormal.
    Derivatives are to be multiplied by the wave numbers.
    """
    if parity is None:
        x = (np.arange(count) + 0.5) / count
        kappa = 2 * np.pi * (np.arange(count) - count // 2) + theta
        wave = np.exp(1j * np.outer(x, kappa)) / np.sqrt(count)
        return wave, 1j * wave, kappa
    half = count // 2
    x = (np.arange(half) + 0.5) / count
    shift = 1 if parity == "odd" and theta == 0 else 0
    kappa = 2 * np.pi * (np.arange(half) + shift) + theta
    angles = np.outer(x, kappa)
    even = parity == "even"
    wave, slope = (np.cos(angles), -np.sin(angles)) if even else (np.sin(angles), np.cos(angles))
    sizes = np.linalg.norm(wave, axis=0)
    return wave / sizes, slope / sizes, kappa


@dataclass(frozen=True)
class SecondVariation:
    """The second variation of a profile, sampled once, for any ``n`` and ``theta``.

    Attributes:
        xi_period: the period in the isothermal coordinate.
        r, q: radius and ``Q`` at the points, shape (K,).
        by_slope: coefficient of ``w'^2``.
        by_n: coefficient of ``n^2 w^2 / r^2``.
        by_value: coefficient ``R`` of ``w^2``.
        h: mean curvature.
        psi: tangent angle.
        symmetric: whether the points mirror each other, so that waves have parities.
    """

    __repr__ = brief

    xi_period: float
    r: Array
    q: Array
    by_slope: Array
    by_n: Array
    by_value: Array
    h: Array
    psi: Array
    symmetric: bool

    @classmethod
    def of(cls, profile: Profile, points: int = 64) -> SecondVariation:
        """Sample a profile at an even number of points of its whole period (an odd one is raised by one)."""
        sigma, total = isothermal_points(profile, points + points % 2)
        states = profile.at(sigma)
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
        return cls(total, g.r, q, by_slope, by_n, by_value, g.h, states[:, 1], profile.half)

    def matrix(self, n: int, theta: float, parity: str | None = None) -> NDArray[Any]:
        """Hermitian matrix of the growth rates, acting on ``r w`` at the points (the first half of them with a parity).

        Args:
            n: azimuthal number.
            theta: phase per period.
            parity: ``even`` or ``odd`` about the belly, where ``theta`` is 0 or pi and the profile symmetric.

        Raises:
            ValueError: a parity where waves have none.
        """
        if parity is not None and not (self.symmetric and theta in (0.0, np.pi)):
            raise ValueError("parity: only waves with theta = 0 or pi on a profile with planes of reflection have one")
        wave, slope_wave, per_period = waves(len(self.r), theta, parity)
        here = slice(None, len(wave))
        r = self.r[here]
        kappa = per_period / self.xi_period
        slope = (slope_wave * kappa) @ wave.conj().T
        laplacian = (wave * -(kappa**2 + n**2)) @ wave.conj().T
        bending = laplacian / r[:, None] + np.diag(self.q[here] * r)  # r (Lap w + Q w)
        value = r**2 * self.by_value[here] + n**2 * self.by_n[here]
        form = -0.5 * bending.conj().T @ bending + slope.conj().T @ (self.by_slope[here, None] * slope) + np.diag(value)
        form = form / np.outer(r, r)
        hermitian: NDArray[Any] = (form + form.conj().T) / 2
        return hermitian

    def growth_rates(
        self, n: int, theta: float, parity: str | None = None, *, fixed: Fixed = "area and volume"
    ) -> Array:
        """Growth rates of the Bloch waves ``(n, theta)``, largest first.

        Only ``n = 0, theta = 0`` (and not odd) is affected by what is ``fixed``: ``integral of H w dS = 0`` keeps the area,
        ``integral of w dS = 0`` the volume. On a surface of constant mean curvature the two are one.
        """
        matrix = self.matrix(n, theta, parity)
        if n == 0 and theta == 0 and parity != "odd" and fixed != "nothing":
            r, h = self.r[: len(matrix)], self.h[: len(matrix)]
            (matrix,) = restricted((h * r, r) if fixed == "area and volume" else (h * r,), matrix)
        return np.asarray(np.linalg.eigvalsh(matrix)[::-1])


def growth_rates(profile: Profile, n: int, theta: float, points: int = 64) -> Array:
    """Growth rates of perturbations ``e^{i n phi} e^{i theta x / period}`` at fixed area and volume, largest first.

    Args:
        profile: one period, or half of it.
        n: azimuthal number.
        theta: phase per period, ``q * period``; on a tube of ``N`` periods it takes the values ``2 pi j / N``.
        points: Fourier points of the period.
    """
    return SecondVariation.of(profile, points).growth_rates(n, theta)
