"""Growth rates of waves of a straight tube in viscous fluids, of an incompressible membrane between them (Stokes flow).

Waves ``u e^{i(kx + n phi)}`` of the radius grow at ``mu``, the rate of the flow ``V_t = G`` (``theory.dispersion``), times a
mobility: 1 in that flow, ``k^2 + n^2`` in the flow of its Laplacian, and in fluids the inverse of a friction. The friction is
the least dissipation among all motions of the membrane that move its surface as the wave does and keep its area at every
point: the tension that varies along the membrane is the multiplier of this constraint.

Units: lengths in radii ``R``, viscosities in that of the fluid outside, ``eta``, energies in ``2 kappa``: rates are in units of
``2 kappa/(eta R^3)``. Derivation, limits and sources: ``docs/theory/stokes.md``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import k0e, k1e

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError
from pearlbvp.helfrich import finite, positive
from pearlbvp.theory.dispersion import growing_waves, growth_rate

LARGEST = 1e12
"""Viscosity by that of the fluid outside beyond which a number is a mistake of units."""


@dataclass(frozen=True)
class Fluids:
    """The fluids inside and outside of a tube, and its membrane as a fluid.

    Attributes:
        viscosity_ratio: viscosity of the fluid inside, by that of the fluid outside.
        membrane_viscosity: surface viscosity of the membrane, by the viscosity of the fluid outside and the radius.

    Raises:
        InputError: the ratio is not positive, or the viscosity of the membrane negative, or one of them too large.
    """

    viscosity_ratio: float = 1.0
    membrane_viscosity: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "viscosity_ratio", positive("viscosity_ratio", self.viscosity_ratio))
        object.__setattr__(self, "membrane_viscosity", finite("membrane_viscosity", self.membrane_viscosity))
        if self.membrane_viscosity < 0:
            raise InputError("membrane_viscosity", f"{self.membrane_viscosity:g} is negative", "give 0 or more")
        for name, value in vars(self).items():
            if value > LARGEST:
                raise InputError(
                    name, f"{value:g} is beyond {LARGEST:g} by the viscosity of the fluid outside", "check its unit"
                )


WATER = Fluids()
"""The same fluid on both sides of a membrane that has no viscosity."""


def stokes_rate(k: ArrayLike, n: int, lambda2: float, c0: float, fluids: Fluids = WATER) -> Array:
    """Growth rates of waves in fluids, ``mu`` by ``friction``, in units of ``2 kappa/(eta R^3)``; positive means unstable.

    Args:
        k: wave numbers along the tube, zero or more. A shift of the tube (``k = 0, n = 1``) and a change of its radius
            (``k = 0, n = 0``), which is none of an incompressible membrane, have the limit of long waves, rate 0.
        n: waves around the tube.
        lambda2: pressure difference; the tension is ``1/4 - lambda2 - c0^2``.
        c0: spontaneous curvature.
        fluids: their viscosities.

    Examples:
        >>> from pearlbvp.theory.stokes import stokes_rate
        >>> float(stokes_rate(0.47, 0, lambda2=0.25 - 1.5, c0=0.0).round(6))
        0.015545
    """
    k = np.asarray(k, dtype=float)
    resting = (k**2 < np.finfo(float).eps) & (n < 2)  # k^2 is lost beside 1
    rate = growth_rate(k, n, lambda2, c0) / friction(np.where(resting, 1.0, k), n, fluids)
    return np.where(resting, 0.0, rate)


def fastest_waves(lambda2: float, c0: float, fluids: Fluids = WATER) -> dict[int, float]:
    """By the number of waves around the tube, the wave number of those that grow fastest; only where some grow.

    Each is found to eight digits: a maximum's place is known to half the digits of its value.
    """
    fastest = {}
    for n, (low, high) in growing_waves(lambda2, c0).items():
        k = np.linspace(low, high, 101)
        for _ in range(5):
            best = int(stokes_rate(k, n, lambda2, c0, fluids).argmax())
            fastest[n] = float(k[best])
            k = np.linspace(k[max(best - 1, 0)], k[min(best + 1, k.size - 1)], 101)
        at_end, most = stokes_rate(np.array([low, fastest[n]]), n, lambda2, c0, fluids)
        if at_end >= most * (1 - ROUNDING):
            fastest[n] = low
    return fastest


ROUNDING = 1e-12
"""Of rates: next to a wave that does not vary along the tube all long ones grow alike."""


def friction(k: ArrayLike, n: int, fluids: Fluids = WATER) -> Array:
    """Force by velocity of the normal motion of a wave, in ``eta/R``: the least that the tangential motions allow.

    Args:
        k: wave numbers along the tube; for ``n < 2`` above 1e-8, as ``k^2`` is lost beside 1.
        n: waves around the tube.
        fluids: their viscosities.
    """
    k = np.asarray(k, dtype=float)
    matrix = fluids.viscosity_ratio * inside(k, n) + outside(k, n) + fluids.membrane_viscosity * membrane(k, n)
    zero, one = np.zeros_like(k), np.ones_like(k)
    # Motions that keep the membrane's area, v_r + n g - k w = 0: one that moves the surface, one that does not.
    if n:
        moving, sliding = np.stack((one, -one / n, zero), -1), np.stack((zero, k / n, one), -1)
    else:
        moving, sliding = np.stack((one, zero, 1 / k), -1), np.stack((zero, one, zero), -1)

    def power(a: Array, b: Array) -> Array:
        return np.einsum("...i,...ij,...j->...", a, matrix, b)

    least: Array = power(moving, moving) - power(moving, sliding) ** 2 / power(sliding, sliding)
    return least


def inside(k: Array, n: int) -> Array:
    """Matrix of tractions by velocities of the wall, of a fluid of viscosity 1 inside of it, shape (..., 3, 3).

    Velocities are ``(v_r, -i g, i w) e^{i(kx + n phi)}`` in the directions ``(r, phi, x)``, tractions likewise: the matrix is
    real, symmetric (Lorentz's reciprocal theorem) and positive.
    """
    return _traction_by_velocity(k, n, _i_ratio(k, n))


def outside(k: Array, n: int) -> Array:
    """The same for a fluid outside: ``(-1)^m K_m`` satisfy the recurrences of ``I_m``, and ``K_{-m} = K_m``.

    So its flows are those inside with ``-n`` waves and ``phi`` the other way round, and its tractions act on the other side.
    """
    other_way = np.array([1.0, -1.0, 1.0])
    return -other_way[:, None] * _traction_by_velocity(k, -n, -_k_ratio(k, n)) * other_way


def membrane(k: Array, n: int) -> Array:
    """The same for a membrane of surface viscosity 1, whose dissipation is ``2 E:E`` of the rate of strain ``E`` in it."""
    zero, one, root = np.zeros_like(k), np.ones_like(k), np.sqrt(2)
    around, along, shear = (root * one, root * n * one, zero), (zero, zero, -root * k), (zero, k, -n * one)
    strain = np.stack([np.stack(row, -1) for row in (around, along, shear)], -2)
    matrix: Array = np.swapaxes(strain, -1, -2) @ strain
    return matrix


def _traction_by_velocity(k: Array, n: int, ratio: Array) -> Array:
    """Tractions by velocities at ``r = 1`` of three flows with Bessel functions ``I_m(kr)``, ``ratio = I_{n+1}(k)/(k I_n(k))``.

    The flows are a vortex, one along the axis and one with a pressure: ``(v_r + i v_phi, v_r - i v_phi, v_x/i, p)`` equal to
    ``(-I_{n+1}, I_{n-1}, 0, 0)``, ``(2 I_{n+1}, 0, I_n, 0)`` and ``(r I_n/2 - (n+2)/k I_{n+1}, r I_n/2, r I_{n+1}/2, I_n)``,
    the first by ``I_{n-1}(k)``, the others by ``I_n(k)``, which stay independent for ``k -> 0``. The traction of a velocity
    ``(v_r, -i g, i w)`` is ``(-p + 2 v_r', -i (g' - g - n v_r), i (w' + k v_r))``.
    """
    zero, one, kk = np.zeros_like(k), np.ones_like(k), k**2
    below = 1 / (2 * n + kk * ratio)  # I_n/(k I_{n-1})
    grown = 1 - (n + 1) * ratio  # I_{n+1}'/I_n, where I_{n+1}' = k I_n - (n + 1) I_{n+1}
    plus = np.stack((-kk * ratio * below, 2 * k * ratio, one / 2 - (n + 2) * ratio), -1)
    d_plus = np.stack((-kk * below * grown, 2 * k * grown, (1 + n + kk * ratio) / 2 - (n + 2) * grown), -1)
    minus = np.stack((one, zero, one / 2), -1)
    d_minus = np.stack((n - 1 + kk * below, zero, (1 + n + kk * ratio) / 2), -1)
    axial = np.stack((zero, one, k * ratio / 2), -1)
    d_axial = np.stack((zero, n + kk * ratio, k * (1 - n * ratio) / 2), -1)
    pressure = np.stack((zero, zero, one), -1)
    radial, around = (plus + minus) / 2, (plus - minus) / 2
    d_radial, d_around = (d_plus + d_minus) / 2, (d_plus - d_minus) / 2
    velocity = np.stack((radial, around, axial), -1)
    traction = np.stack((2 * d_radial - pressure, d_around - around - n * radial, d_axial + k[..., None] * radial), -1)
    matrix: Array = np.swapaxes(np.linalg.solve(velocity, traction), -1, -2)
    return matrix


def _i_ratio(k: Array, n: int) -> Array:
    """``I_{n+1}(k)/(k I_n(k))``, which is ``1/(2n + 2)`` at 0, by backward recurrence (DLMF 10.29.1, 10.74(iv))."""
    ratio = np.zeros_like(k)
    for order in range(n + 30 + int(7 * np.sqrt(np.max(k, initial=0))), n - 1, -1):
        ratio = 1 / (2 * (order + 1) + k**2 * ratio)
    return ratio


def _k_ratio(k: Array, n: int) -> Array:
    """``K_{n-1}(k)/(k K_n(k))``, which is ``1/(2n - 2)`` at 0 for ``n > 1``, by forward recurrence (DLMF 10.29.1)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        scaled = np.where(k == 0, 0.0, k * k0e(k) / k1e(k))  # k K_0/K_1
        ratio = 1 / scaled if n == 0 else scaled / k**2
    for order in range(1, n):
        ratio = 1 / (2 * order + scaled)
        scaled = k**2 * ratio
    return ratio
