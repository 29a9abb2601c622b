"""Growth rates of perturbations ``e^{i n phi} e^{i theta x / period}``: the second variation on one period.

The second variation of the energy at fixed multipliers, in the direction of a normal perturbation ``w``, is minus

    integral of -(Lap w + Q w)^2/2 + (f/2 + g kappa_phi) w'^2 + [(f/2 + g kappa_s) n^2/r^2 + R] w^2  dS,

``Q = 4H^2 - 2K``, ``f = 2H^2 - 2(c0^2 + lambda1)``, ``g = 2 c0 - 2H``: the equation of design §5, multiplied by ``w`` and
integrated by parts (``div`` of the cofactor of the curvature tensor vanishes, Codazzi). It is discretized by Fourier
series in the isothermal coordinate ``xi``, ``ds = r dxi``, in which ``Lap = (d^2/dxi^2 - n^2)/r^2`` and a neck of radius
``eps`` costs ``log(1/eps)`` points. The matrix is Hermitian by construction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pearlbvp.collocation.scheme import Array
from pearlbvp.stability.profile import Profile, curvatures

_GAUSS_NODES, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(12)


def isothermal_points(profile: Profile, count: int) -> tuple[Array, float]:
    """Points of the whole period evenly spaced in ``xi = integral of ds/r``.

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
    target = np.arange(count) * total / count
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
    """

    xi_period: float
    r: Array
    q: Array
    by_slope: Array
    by_n: Array
    by_value: Array
    h: Array

    @classmethod
    def of(cls, profile: Profile, points: int = 65) -> SecondVariation:
        """Sample a profile at an odd number of points (an even one is raised by one)."""
        sigma, total = isothermal_points(profile, points | 1)
        g = curvatures(profile.at(sigma), profile)
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
        return cls(total, g.r, q, f / 2 + coupling * g.around, f / 2 + coupling * g.along, by_value, g.h)

    def matrix(self, n: int, theta: float) -> NDArray[np.complex128]:
        """Hermitian matrix of the growth rates, shape (K, K), acting on ``r w``."""
        count = len(self.r)
        modes = np.arange(count) - count // 2
        fourier = np.exp(2j * np.pi * np.outer(np.arange(count), modes) / count) / np.sqrt(count)
        wave = (2 * np.pi * modes + theta) / self.xi_period
        slope = (fourier * (1j * wave)) @ fourier.conj().T
        laplacian = (fourier * -(wave**2 + n**2)) @ fourier.conj().T
        bending = laplacian / self.r[:, None] + np.diag(self.q * self.r)  # r (Lap w + Q w)
        value = self.r**2 * self.by_value + n**2 * self.by_n
        form = (
            -0.5 * bending.conj().T @ bending + slope.conj().T @ (self.by_slope[:, None] * slope) + np.diag(value)
        ) / np.outer(self.r, self.r)
        hermitian: NDArray[np.complex128] = (form + form.conj().T) / 2
        return hermitian

    def growth_rates(self, n: int, theta: float, *, constrained: bool = True) -> Array:
        """Growth rates of the Bloch waves ``(n, theta)``, largest first, shape (K,) or fewer.

        At ``n = 0, theta = 0`` only perturbations that keep area and volume count (``constrained``):
        ``integral of H w dS = integral of w dS = 0``. On a surface of constant mean curvature the two are one.
        """
        matrix = self.matrix(n, theta)
        if constrained and n == 0 and theta == 0:
            normals = np.column_stack((self.r, self.h * self.r))
            basis, sizes, _ = np.linalg.svd(normals, full_matrices=True)
            allowed = basis[:, int((sizes > 1e-8 * sizes[0]).sum()) :]
            matrix = allowed.T @ matrix @ allowed
        return np.asarray(np.linalg.eigvalsh(matrix)[::-1])


def growth_rates(profile: Profile, n: int, theta: float, points: int = 65) -> Array:
    """Growth rates of perturbations ``e^{i n phi} e^{i theta x / period}`` at fixed area and volume, largest first.

    Args:
        profile: one period, or half of it.
        n: azimuthal number.
        theta: phase per period, ``q * period``; on a tube of ``N`` periods it takes the values ``2 pi j / N``.
        points: Fourier points of the period.
    """
    return SecondVariation.of(profile, points).growth_rates(n, theta)
