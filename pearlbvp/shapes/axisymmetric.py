"""The axisymmetric Helfrich equation in arclength and tangent angle, compiled (``docs/theory/axisymmetric.md``).

States ``r, psi, h, w``: radius, tangent angle, mean curvature, its derivative by arclength. Parameters ``arclength,
lambda1, lambda2, c0, length, v``; primes are derivatives by arclength, ``K = (2h - cos psi/r) cos psi/r``::

    r' = sin psi    psi' = cos psi/r - 2h    h' = w
    w' = -(sin psi/r) w - 2h (h - cos psi/r)^2 - 2 c0 K + 2(c0^2 + lambda1) h + lambda2

Three integrals fix axial length, area (``2 pi length``) and volume (``v pi length``). ``x = integral of cos psi ds`` is
no state: it would make every linear system a quarter larger.
"""

from __future__ import annotations

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.compiled import compiled

STATES = ("r", "psi", "h", "w")
PARAMETERS = ("arclength", "lambda1", "lambda2", "c0", "length", "v")


@compiled
def rhs(t, y, p):  # type: ignore[no-untyped-def]
    """Right-hand side by ``sigma = s / arclength``, shape (K, 4)."""
    length, lambda1, lambda2, c0 = p[0], p[1], p[2], p[3]
    f = np.empty_like(y)
    for i in range(y.shape[0]):
        r, psi, h, w = y[i, 0], y[i, 1], y[i, 2], y[i, 3]
        around, b = np.cos(psi) / r, np.sin(psi) / r
        gauss = (2 * h - around) * around
        f[i, 0] = length * np.sin(psi)
        f[i, 1] = length * (around - 2 * h)
        f[i, 2] = length * w
        f[i, 3] = length * (-b * w - 2 * h * (h - around) ** 2 - 2 * c0 * gauss + 2 * (c0**2 + lambda1) * h + lambda2)
    return f


@compiled
def rhs_jacobian(t, y, p):  # type: ignore[no-untyped-def]
    """Its derivatives by states (K, 4, 4) and parameters (K, 4, 6)."""
    length, lambda1, lambda2, c0 = p[0], p[1], p[2], p[3]
    by_y, by_p = np.zeros((y.shape[0], 4, 4)), np.zeros((y.shape[0], 4, 6))
    for i in range(y.shape[0]):
        r, psi, h, w = y[i, 0], y[i, 1], y[i, 2], y[i, 3]
        sine, around, b = np.sin(psi), np.cos(psi) / r, np.sin(psi) / r
        gauss = (2 * h - around) * around
        by_around = 4 * (h - around) * (h - c0)
        by_y[i, 0, 1] = length * around * r
        by_y[i, 1, 0] = -length * around / r
        by_y[i, 1, 1] = -length * b
        by_y[i, 1, 2] = -2 * length
        by_y[i, 2, 3] = length
        by_y[i, 3, 0] = length * (b * w / r - by_around * around / r)
        by_y[i, 3, 1] = length * (-around * w - by_around * b)
        by_y[i, 3, 2] = length * (
            -2 * (h - around) ** 2 - 4 * h * (h - around) - 4 * c0 * around + 2 * (c0**2 + lambda1)
        )
        by_y[i, 3, 3] = -length * b
        by_p[i, 0, 0] = sine
        by_p[i, 1, 0] = around - 2 * h
        by_p[i, 2, 0] = w
        by_p[i, 3, 0] = -b * w - 2 * h * (h - around) ** 2 - 2 * c0 * gauss + 2 * (c0**2 + lambda1) * h + lambda2
        by_p[i, 3, 1] = 2 * length * h
        by_p[i, 3, 2] = length
        by_p[i, 3, 3] = length * (-2 * gauss + 4 * c0 * h)
    return by_y, by_p


@compiled
def constraints(t, y, p):  # type: ignore[no-untyped-def]
    """Integrands of the axial length, the area and the volume, shape (K, 3); their integrals vanish."""
    g = np.empty((y.shape[0], 3))
    for i in range(y.shape[0]):
        cosine = np.cos(y[i, 1])
        g[i, 0] = p[0] * cosine - p[4]
        g[i, 1] = p[0] * y[i, 0] - p[4]
        g[i, 2] = p[0] * y[i, 0] ** 2 * cosine - p[5] * p[4]
    return g


@compiled
def constraints_jacobian(t, y, p):  # type: ignore[no-untyped-def]
    """Their derivatives by states (K, 3, 4) and parameters (K, 3, 6)."""
    by_y, by_p = np.zeros((y.shape[0], 3, 4)), np.zeros((y.shape[0], 3, 6))
    for i in range(y.shape[0]):
        r, sine, cosine = y[i, 0], np.sin(y[i, 1]), np.cos(y[i, 1])
        by_y[i, 0, 1] = -p[0] * sine
        by_y[i, 1, 0] = p[0]
        by_y[i, 2, 0] = 2 * p[0] * r * cosine
        by_y[i, 2, 1] = -p[0] * r**2 * sine
        by_p[i, 0, 0], by_p[i, 1, 0], by_p[i, 2, 0] = cosine, r, r**2 * cosine
        by_p[i, 0, 4], by_p[i, 1, 4], by_p[i, 2, 4], by_p[i, 2, 5] = -1.0, -1.0, -p[5], -p[4]
    return by_y, by_p


def energy_density(y: Array, p: Array) -> Array:
    """Integrand of ``E/A`` over ``sigma``, shape (K,)."""
    return np.asarray(p[0] * y[:, 0] * (y[:, 2] - p[3]) ** 2 / p[4])


def curvature_density(y: Array, p: Array) -> Array:
    """Integrand of the mean of ``H`` over the surface, shape (K,)."""
    return np.asarray(p[0] * y[:, 0] * y[:, 2] / p[4])


def axial_force(y: Array, p: Array) -> Array:
    """The first integral at points, shape (K,): the force along the axis divided by 2 pi.

    ``r cos psi [(h - c0)^2 + lambda1 + psi' (h - c0)] - r w sin psi + lambda2 r^2 / 2``, from the Hamiltonian of the
    profile's Lagrangian, which vanishes because the arclength is free. (The multiplier of ``x' = cos psi``; compare U.
    Seifert, K. Berndl, R. Lipowsky, Phys. Rev. A 44 (1991) 1182, §III.)
    """
    r, psi, h, w = y.T
    bend, slope = h - p[3], np.cos(psi) / r - 2 * h
    return np.asarray(r * np.cos(psi) * (bend**2 + p[1] + slope * bend) - r * w * np.sin(psi) + p[2] * r**2 / 2)
