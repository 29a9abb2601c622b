"""The axisymmetric equation where the multipliers are large, or infinite: a second chart.

See ``docs/theory/axisymmetric.md``. At a surface of constant mean curvature the gradients of area and volume are parallel
and ``lambda1, lambda2`` pass through infinity while shape, ``v`` and ``E`` stay smooth. Homogeneous multipliers ``m0 dE +
m1 dA + m2 dV = 0`` do not notice. With ``m1 = 1`` they are ``compliance = m0/m1 = 1/lambda1`` and ``mean = -m2/(2 m1)``,
the mean curvature that pressure and tension alone would give, so that ``lambda2 = -2 mean/compliance``. The states are ``r,
psi, g, omega`` with ``h = mean + compliance g`` and ``w = compliance omega``; primes are derivatives by arclength, ``K`` as
usual::

    r' = sin psi    psi' = cos psi/r - 2h    g' = omega
    compliance omega' = -compliance (sin psi/r) omega - 2h (h - cos psi/r)^2 - 2 c0 K + 2 c0^2 h + 2g

Exact for every ``lambda1`` other than zero; at ``compliance = 0`` the last equation is algebraic.
"""

from __future__ import annotations

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.compiled import compiled

STATES = ("r", "psi", "g", "omega")
PARAMETERS = ("arclength", "compliance", "mean", "c0", "length", "v")


@compiled
def rhs(t, y, p):  # type: ignore[no-untyped-def]
    """Right-hand side by ``sigma = s / arclength``, shape (K, 4)."""
    length, compliance, mean, c0 = p[0], p[1], p[2], p[3]
    f = np.empty_like(y)
    for i in range(y.shape[0]):
        r, psi, g, omega = y[i, 0], y[i, 1], y[i, 2], y[i, 3]
        h = mean + compliance * g
        around, b = np.cos(psi) / r, np.sin(psi) / r
        gauss = (2 * h - around) * around
        f[i, 0] = length * np.sin(psi)
        f[i, 1] = length * (around - 2 * h)
        f[i, 2] = length * omega
        f[i, 3] = length * (
            -compliance * b * omega - 2 * h * (h - around) ** 2 - 2 * c0 * gauss + 2 * c0**2 * h + 2 * g
        )
    return f


@compiled
def rhs_jacobian(t, y, p):  # type: ignore[no-untyped-def]
    """Its derivatives by states (K, 4, 4) and parameters (K, 4, 6)."""
    length, compliance, mean, c0 = p[0], p[1], p[2], p[3]
    by_y = np.zeros((y.shape[0], 4, 4))
    by_p = np.zeros((y.shape[0], 4, 6))
    for i in range(y.shape[0]):
        r, psi, g, omega = y[i, 0], y[i, 1], y[i, 2], y[i, 3]
        h = mean + compliance * g
        sine, around, b = np.sin(psi), np.cos(psi) / r, np.sin(psi) / r
        gauss = (2 * h - around) * around
        by_around = 4 * (h - around) * (h - c0)
        by_h = -2 * (h - around) ** 2 - 4 * h * (h - around) - 4 * c0 * around + 2 * c0**2
        last = -compliance * b * omega - 2 * h * (h - around) ** 2 - 2 * c0 * gauss + 2 * c0**2 * h + 2 * g
        by_y[i, 0, 1] = length * around * r
        by_y[i, 1, 0] = -length * around / r
        by_y[i, 1, 1] = -length * b
        by_y[i, 1, 2] = -2 * length * compliance
        by_y[i, 2, 3] = length
        by_y[i, 3, 0] = length * (compliance * b * omega / r - by_around * around / r)
        by_y[i, 3, 1] = length * (-compliance * around * omega - by_around * b)
        by_y[i, 3, 2] = length * (compliance * by_h + 2)
        by_y[i, 3, 3] = -length * compliance * b
        by_p[i, 0, 0] = sine
        by_p[i, 1, 0] = around - 2 * h
        by_p[i, 2, 0] = omega
        by_p[i, 3, 0] = last
        by_p[i, 1, 1] = -2 * length * g
        by_p[i, 3, 1] = length * (-b * omega + by_h * g)
        by_p[i, 1, 2] = -2 * length
        by_p[i, 3, 2] = length * by_h
        by_p[i, 3, 3] = length * (-2 * gauss + 4 * c0 * h)
    return by_y, by_p


def mass(p: Array) -> tuple[Array, Array]:
    """Factors of the derivatives, (4,), and their derivatives by the parameters, (4, 6)."""
    factors, by_p = np.ones(4), np.zeros((4, 6))
    factors[3] = p[1]
    by_p[3, 1] = 1.0
    return factors, by_p


def from_multipliers(values: Array, p: Array) -> tuple[Array, Array]:
    """States ``r, psi, h, w`` and parameters with ``lambda1, lambda2`` in this chart."""
    compliance, mean = 1 / p[1], -p[2] / (2 * p[1])
    moved, parameters = values.copy(), p.copy()
    moved[:, 2] = (values[:, 2] - mean) / compliance
    moved[:, 3] = values[:, 3] / compliance
    parameters[1:3] = compliance, mean
    return moved, parameters


def to_multipliers(values: Array, p: Array) -> tuple[Array, Array]:
    """The inverse of ``from_multipliers``: infinite multipliers at ``compliance = 0``."""
    moved, parameters = values.copy(), p.copy()
    moved[:, 2] = p[2] + p[1] * values[:, 2]
    moved[:, 3] = p[1] * values[:, 3]
    with np.errstate(divide="ignore"):
        parameters[1:3] = np.float64(1) / p[1], -2 * np.float64(p[2]) / p[1]
    return moved, parameters


def weights_of(wave_number: float, in_large_chart: bool) -> Array | None:
    """Weights of states and parameters, of a full cell's too, in the inner product; None where all are 1.

    With ``k`` the wave number, ``h`` is of size ``k`` on short pearls, ``w`` and both multipliers are of size ``k^2``; slopes
    and volumes are of size 1.
    """
    if wave_number == 1:
        return None
    states = (0, 0, -3, -4) if in_large_chart else (0, 0, -1, -2)
    parameters = (0, 2, 0, -1, 0, 0, 0) if in_large_chart else (0, -2, -2, -1, 0, 0, 0)
    return np.asarray(wave_number ** (2.0 * np.array(states + parameters)))
