"""Wrinkles (0, 2) and coiling waves (m, 1) where both are neutral: three amplitude equations instead of two and one.

Where ``c0 = -1/4 + k^2/4`` both are neutral at ``lambda2 = 3/2``, and the wave ``(0, 2)`` that coiling waves excite is no slave
of theirs. For ``u = A e^{i(kx + phi)} + B e^{i(kx - phi)} + C e^{2i phi} + c.c.`` at fixed area

    dA/dt = a_m (lambda2 - lambda2_m) A + force B C  + A (b1 |A|^2 + b2 |B|^2 + cross |C|^2)
    dB/dt = a_m (lambda2 - lambda2_m) B + force A C* + B (b2 |A|^2 + b1 |B|^2 + cross |C|^2)
    dC/dt = a_2 (lambda2 - 3/2)       C + force A B* + C (cross (|A|^2 + |B|^2) + b |C|^2)

All derive from one potential (``tests/derivations/amplitude.py``, ``meeting``). The paper leaves this point out. There
``force`` is ``3 k^4/2``: next to it, at fixed volume, the energy's cubic term ``-2 force A B C`` decides. Coils and wrinkles
are saddles of it on the ellipsoid of that volume, and what is stable are its extremes, buckles with
``k^2 A^2 = k^2 B^2 = 3 C^2``, of

    lambda2 = 3/2 - k^2 sqrt((1 - v)/8) + O(1 - v).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.helfrich import Tube, known_tube, whole
from pearlbvp.theory.amplitude import direct1, direct2, force02, force20, force22, linear
from pearlbvp.theory.dispersion import critical_lambda2, growth_rate, onset_lambda2

WRINKLES = 1.5
"""``lambda2`` where wrinkles of two lobes are neutral."""


def cross(kappa: Any, c0: Any, lambda2: Any) -> Any:
    """``cross`` without the work of the waves ``(m, 3)``."""
    return 4 * kappa**2 - kappa * (16 * c0 + 8 * lambda2 + 3) + 2 * lambda2 - 83


def force13(kappa: Any, c0: Any, lambda2: Any) -> Any:
    """What ``A C`` does to the wave ``(m, 3)``."""
    return -(kappa**2) / 2 + kappa * (8 * c0 + lambda2 + 4.5) - 7 * lambda2 + 50.5


def meeting_curvature(kappa: Any) -> Any:
    """``c0`` at which both are neutral together (``theory.codimension_two.meeting_c0``)."""
    return (kappa - 1) / 4


@dataclass(frozen=True)
class WrinklesAndCoils:
    """The three equations of a straight tube near the meeting; amplitudes of what is computed of them are real.

    Attributes:
        tube: the straight tube.
        m: coiling waves along it.

    Raises:
        InputError: on construction: no whole number of waves.

    Examples:
        >>> both = WrinklesAndCoils(Tube(-0.151303956, 10))  # where they meet
        >>> abs(both.onset - 1.5) < 1e-8, abs(both.force() / (1.5 * both.kappa**2) - 1) < 1e-7
        (True, True)
    """

    tube: Tube
    m: int = 1

    def __post_init__(self) -> None:
        known_tube(self.tube)
        whole("m", self.m)
        onset_lambda2(self.tube, self.m, 1)

    @cached_property
    def kappa(self) -> float:
        """``k^2`` of the coiling waves."""
        return self.tube.wave_number(self.m) ** 2

    @cached_property
    def onset(self) -> float:
        """``lambda2_m``, where the coiling waves are neutral."""
        return float(critical_lambda2(math.sqrt(self.kappa), 1, self.tube.c0))

    @property
    def a(self) -> tuple[float, float]:
        """``a_m, a_2``."""
        return float(linear(self.kappa, 1)), float(linear(0, 2))

    def force(self, lambda2: Any = WRINKLES) -> Any:
        """The quadratic coefficient, whose change with ``lambda2`` counts as much as cubic terms do."""
        return force02(self.kappa, 1, self.tube.c0, lambda2)

    def _rate(self, waves: int, n: int, lambda2: float) -> float:
        return float(growth_rate(waves * math.sqrt(self.kappa), n, lambda2, self.tube.c0))

    @cached_property
    def cubic(self) -> tuple[float, float, float, float]:
        """``b1, b2, cross, b``, the waves (2m, 2), (2m, 0), (m, 3) and (0, 4) eliminated."""
        kappa, c0, at = self.kappa, self.tube.c0, self.onset
        return (
            float(direct1(kappa, 1, c0, at) - 2 * force22(kappa, 1, at) ** 2 / self._rate(2, 2, at)),
            float(direct2(kappa, 1, c0, at) - force20(kappa, 1, c0, at) ** 2 / self._rate(2, 0, at)),
            float(cross(kappa, c0, at) - force13(kappa, c0, at) ** 2 / self._rate(1, 3, at)),
            float(direct1(0, 2, c0, WRINKLES) - 2 * force22(0, 2, WRINKLES) ** 2 / self._rate(0, 4, WRINKLES)),
        )

    def volume(self, A: Any, B: Any, C: Any) -> Any:
        """Reduced volume to third order: the potential's derivative by ``lambda2``, of ``force`` too, which is ``k^2 - 3``."""
        return 1 - 2 * (self.a[0] * (A**2 + B**2) + self.a[1] * C**2 + 2 * (self.kappa - 3) * A * B * C)

    def wrinkles(self, C: Any) -> Any:
        """``lambda2`` of wrinkles of an amplitude."""
        return WRINKLES - self.cubic[3] * C**2 / self.a[1]

    def coils(self, A: Any) -> Any:
        """``lambda2`` of coils of an amplitude."""
        return self.onset - self.cubic[0] * A**2 / self.a[0]

    def buckles(self, C: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """``lambda2`` and ``A^2 = B^2`` of buckles over the amplitude of wrinkles in them; they exist where that is positive.

        For given ``C`` and ``force`` two equations are linear in both. Those of ``-C`` with ``B = -A`` are the same, turned by
        a right angle.
        """
        (a_m, a_2), (b1, b2, s, b), C = self.a, self.cubic, np.asarray(C, dtype=float)
        lambda2 = np.full_like(C, WRINKLES)
        for _ in range(20):  # force follows lambda2; each round gains a factor of the amplitude
            f = self.force(lambda2)
            one = a_m, b1 + b2, a_m * self.onset - f * C - s * C**2
            two = a_2 * C, f + 2 * s * C, a_2 * C * WRINKLES - b * C**3
            determinant = one[0] * two[1] - one[1] * two[0]
            lambda2 = (one[2] * two[1] - one[1] * two[2]) / determinant
        return lambda2, (one[0] * two[2] - one[2] * two[0]) / determinant

    def wrinkles_exchange(self) -> float:
        """Amplitude ``C`` of wrinkles to which coiling waves are neutral: buckles leave there; not a number if nowhere.

        ``a_m (lambda2 - lambda2_m) + cross C^2 = -|force C|`` or ``|force C|``: the smaller root. To leading order
        ``C = 2 |lambda2_m - 3/2|/(3 k^2)``.
        """
        (a_m, a_2), (_, _, s, b), f = self.a, self.cubic, self.force()
        roots = [np.roots([s - a_m * b / a_2, sign * f, a_m * (WRINKLES - self.onset)]) for sign in (1, -1)]
        return _smallest(np.concatenate(roots))

    def growth_rates(self, lambda2: float, A: float, B: float, C: float) -> Array:
        """Growth rates of a solution's own waves, their phases among them, at fixed area and volume: largest first.

        Five of the real and imaginary parts of ``A, B, C``; shifts along the tube and turns about it are zeros.
        """
        z = np.array([A, B, C])
        jacobian = np.array(
            [self._along(lambda2, z, w).view(float) for unit in np.eye(3, dtype=complex) for w in (unit, 1j * unit)]
        )
        slopes = self.a[0] * A + (self.kappa - 3) * B * C, self.a[0] * B + (self.kappa - 3) * A * C
        normal = np.array([*slopes, self.a[1] * C + (self.kappa - 3) * A * B], dtype=complex).view(float)
        kept = np.linalg.svd(normal[None])[2][1:]
        return np.linalg.eigvalsh(kept @ (jacobian + jacobian.T) @ kept.T / 2)[::-1]

    def _along(self, lambda2: float, z: Array, w: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Derivative of the three equations at real amplitudes in a complex direction."""
        (a_m, a_2), (b1, b2, s, b), f, (A, B, C) = self.a, self.cubic, self.force(lambda2), z
        coupling = np.array([[b1, b2, s], [b2, b1, s], [s, s, b]])
        linear_part = np.array([a_m * (lambda2 - self.onset)] * 2 + [a_2 * (lambda2 - WRINKLES)])
        quadratic = np.array([w[1] * C + B * w[2], w[0] * C + A * w[2].conj(), w[0] * B + A * w[1].conj()])
        return (linear_part + coupling @ z**2) * w + f * quadratic + z * (coupling @ (2 * z * w.real))


def _smallest(roots: NDArray[Any]) -> float:
    """The smallest positive real root; not a number where there is none."""
    real = roots[(np.abs(roots.imag) < 1e-12) & (roots.real > 0)].real
    return float(real.min()) if len(real) else math.nan
