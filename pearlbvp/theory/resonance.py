"""Pearls of ``m`` and of ``2m`` waves near their resonance: two amplitude equations instead of one.

Where ``4k^4 - 5k^2 + 4c0 - 1 = 0`` both are neutral at the same ``lambda2``, and the second harmonic of the one is no slave of
it. For ``u = A e^{ikx} + C e^{2ikx} + c.c.``, real amplitudes (the symmetries fix the phases) and fixed area

    dA/dt = a_m  (lambda2 - lambda2_m)  A + 2 force A C + A (aa A^2 + ac C^2)
    dC/dt = a_2m (lambda2 - lambda2_2m) C +   force A^2 + C (ac A^2 + cc C^2)

Both derive from one potential (``tests/derivations/amplitude.py``, ``resonant``). The paper leaves the resonance out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, cylinder_lambda1, finite, known_tube, whole
from pearlbvp.theory.amplitude import direct1, force22, linear, tension
from pearlbvp.theory.dispersion import critical_lambda2, growth_rate, onset_lambda2


def cross(kappa: Any, c0: Any, lambda2: Any) -> Any:
    """``ac`` without the work of the wave ``3k``."""
    return 60 * kappa**3 - kappa**2 * (32 * c0 + 24 * lambda2 + 4) - 5 * kappa - 6


def force3(kappa: Any, lambda2: Any) -> Any:
    """What ``A C`` does to the wave ``3k``."""
    return -49 * kappa**2 / 2 + kappa * (7 * lambda2 - 3.5) + 1.5


def resonant_lengths(c0: float, m: int = 1) -> list[float]:
    """Lengths of the tube at which pearls of ``m`` and ``2m`` waves are neutral together, increasing.

    From ``k^2 = (5 +- sqrt(41 - 64 c0))/8``; none for ``c0 > 41/64``.

    Raises:
        InputError: ``c0`` is no number, or ``m`` no whole one from 1 on.

    Examples:
        >>> [round(length, 4) for length in resonant_lengths(0.4)]
        [5.9489, 17.1347]
    """
    c0, m = finite("c0", c0), whole("m", m)
    if c0 > 41 / 64:
        return []
    roots = [(5 + sign * math.sqrt(41 - 64 * c0)) / 8 for sign in (1, -1)]
    return [2 * math.pi * m / math.sqrt(kappa) for kappa in roots if kappa > 0]


@dataclass(frozen=True)
class Resonance:
    """The two-mode equations of a straight tube.

    Attributes:
        tube: the straight tube.
        m: waves of the longer of the two; the other has ``2m``.

    Raises:
        InputError: on construction: no whole number of waves, or one of the two has no branch (``k = 1``).
    """

    tube: Tube
    m: int = 1

    def __post_init__(self) -> None:
        known_tube(self.tube)
        whole("m", self.m)
        for waves in (self.m, 2 * self.m):
            onset_lambda2(self.tube, int(waves), 0)  # refuses pearls that branch off nowhere

    @cached_property
    def kappa(self) -> float:
        """``k^2`` of ``m`` waves."""
        return self.tube.wave_number(self.m) ** 2

    @cached_property
    def onset(self) -> float:
        """``lambda2_m``."""
        return float(critical_lambda2(math.sqrt(self.kappa), 0, self.tube.c0))

    @cached_property
    def onset_double(self) -> float:
        """``lambda2_2m``."""
        return float(critical_lambda2(2 * math.sqrt(self.kappa), 0, self.tube.c0))

    @property
    def a(self) -> tuple[float, float]:
        """``a_m, a_2m``."""
        return float(linear(self.kappa, 0)), float(linear(4 * self.kappa, 0))

    @cached_property
    def force(self) -> float:
        """The quadratic coefficient."""
        return float(force22(self.kappa, 0, self.onset))

    @cached_property
    def cubic(self) -> tuple[float, float, float]:
        """``aa, ac, cc``."""
        kappa, lambda2, c0 = self.kappa, self.onset, self.tube.c0
        k = math.sqrt(kappa)
        third, fourth = (float(growth_rate(j * k, 0, lambda2, c0)) for j in (3, 4))
        return (
            float(direct1(kappa, 0, c0, lambda2)),
            float(cross(kappa, c0, lambda2) - force3(kappa, lambda2) ** 2 / third),
            float(direct1(4 * kappa, 0, c0, lambda2) - 2 * force22(4 * kappa, 0, lambda2) ** 2 / fourth),
        )

    def observables(self, lambda2: Any, A: Any, C: Any) -> dict[str, NDArray[np.float64]]:
        """``lambda1, lambda2, v, A, C`` of solutions, to leading order."""
        kappa, (a_m, a_2m) = self.kappa, self.a
        bend = tension(kappa, 0, self.onset) * A**2 + tension(4 * kappa, 0, self.onset) * C**2
        found = {
            "lambda1": cylinder_lambda1(lambda2, self.tube.c0) + bend,
            "lambda2": lambda2,
            "v": 1 - 2 * (a_m * A**2 + a_2m * C**2),
            "A": A,
            "C": C,
        }
        return {name: np.asarray(value, dtype=float) for name, value in found.items()}

    def double(self, C: Any) -> dict[str, NDArray[np.float64]]:
        """The branch of ``2m`` pearls, over its amplitude: ``A = 0``."""
        C = np.asarray(C, dtype=float)
        return self.observables(self.onset_double - self.cubic[2] * C**2 / self.a[1], 0 * C, C)

    def mixed(self, C: Any) -> dict[str, NDArray[np.float64]]:
        """Branches of period ``L/m``, over the amplitude of ``2m`` waves, where they exist (``A^2 >= 0``).

        For given ``C`` both equations are linear in ``lambda2`` and ``A^2``. They leave the cylinder at ``C = 0``, and the
        branch of ``2m`` pearls where ``A = 0``.
        """
        C = np.asarray(C, dtype=float)
        (a_m, a_2m), (aa, ac, cc), f = self.a, self.cubic, self.force
        known = a_m * self.onset - 2 * f * C - ac * C**2, a_2m * C * self.onset_double - cc * C**3
        row1, row2 = (a_m + 0 * C, aa + 0 * C), (a_2m * C, f + ac * C)
        determinant = row1[0] * row2[1] - row1[1] * row2[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            lambda2 = (known[0] * row2[1] - row1[1] * known[1]) / determinant
            square = (row1[0] * known[1] - row2[0] * known[0]) / determinant
        exists = square >= 0
        return self.observables(lambda2[exists], np.sqrt(square[exists]), C[exists])

    def crossing(self) -> float:
        """``C`` where the branch of ``2m`` pearls meets the mixed one: the root nearest to the cylinder.

        Raises:
            InputError: they do not meet.
        """
        (a_m, a_2m), (_, ac, cc) = self.a, self.cubic
        polynomial = [ac - a_m * cc / a_2m, 2 * self.force, a_m * (self.onset_double - self.onset)]
        roots = np.roots(polynomial)
        real = roots[np.abs(roots.imag) < 1e-12].real
        if not len(real):
            raise InputError(
                "mode", f"pearls of {2 * self.m} waves meet none of {self.m} near this resonance", "go nearer"
            )
        return float(real[np.abs(real).argmin()])
