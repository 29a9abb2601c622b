"""Tubes on which two things happen at once: coils and buckles exchange stability, or two modes are neutral together."""

from __future__ import annotations

import math

import numpy as np

from pearlbvp.errors import InputError
from pearlbvp.helfrich import WaveNumbers, finite, mode_numbers, positive
from pearlbvp.roots import root
from pearlbvp.theory.amplitude import direct1, direct2, force02, force20, force22, linear
from pearlbvp.theory.dispersion import critical_lambda2, growth_rate


def exchange_lengths(c0: float, m: int = 1, n: int = 1, shortest: float = 2.0, longest: float = 200.0) -> list[float]:
    """Lengths, ``shortest`` to ``longest``, at which coils and buckles of a mode exchange stability (``b1 = b2``), increasing.

    Args:
        c0: spontaneous curvature.
        m: waves along the tube, at least 1.
        n: waves around it, at least 1.

    Raises:
        InputError: ``m`` or ``n`` is 0, or an argument is no number.

    Examples:
        >>> [round(length, 4) for length in exchange_lengths(0.4)]
        [2.6055, 10.7215]
    """
    c0, (m, n) = finite("c0", c0), mode_numbers("mode", (m, n), -math.inf)
    shortest, longest = positive("shortest", shortest), positive("longest", longest)
    if m < 1 or n < 1:
        raise InputError("mode", f"({m},{n}) has no coils and buckles", "give m,n with both >= 1")

    def difference(length: float) -> float:
        """``b1 - b2`` times the three denominators: it has no poles."""
        k = 2 * math.pi * m / length
        lambda2 = float(critical_lambda2(k, n, c0))
        rates = [float(growth_rate(p * k, q, lambda2, c0)) for p, q in ((2, 2 * n), (2, 0), (0, 2 * n))]
        forces = force22(k**2, n, lambda2), force20(k**2, n, c0, lambda2), force02(k**2, n, c0, lambda2)
        direct = direct1(k**2, n, c0, lambda2) - direct2(k**2, n, c0, lambda2)
        work = [-2 * forces[0] ** 2, forces[1] ** 2, forces[2] ** 2]
        return float(
            direct * rates[0] * rates[1] * rates[2]
            + work[0] * rates[1] * rates[2]
            + work[1] * rates[0] * rates[2]
            + work[2] * rates[0] * rates[1]
        )

    lengths = np.geomspace(shortest, longest, 400)
    values = np.array([difference(length) for length in lengths])
    brackets = np.flatnonzero(values[1:] * values[:-1] < 0)
    return [root(difference, float(lengths[i]), float(lengths[i + 1]), 1e-13) for i in brackets]


def meeting_c0(one: WaveNumbers, two: WaveNumbers, length: float) -> float:
    """The ``c0`` at which two modes of a tube are neutral at the same ``lambda2``: a point of codimension two.

    Not a number where they never meet. (The paper leaves these out; wrinkling (0,2) and coiling (1,1) meet at
    ``c0 = -1/4 + k^2/4``.)

    Raises:
        InputError: two modes and a length are not given.

    Examples:
        >>> round(meeting_c0((0, 2), (1, 1), 10), 6)
        -0.151304
    """
    one, two, length = mode_numbers("one", one), mode_numbers("two", two), positive("length", length)
    kappa = [(2 * math.pi * m / length) ** 2 for m, _ in (one, two)]
    e = [linear(q, n) for q, (_, n) in zip(kappa, (one, two), strict=True)]
    if 0 in e:
        return math.nan
    slope = kappa[0] / e[0] - kappa[1] / e[1]
    return (1 + (e[0] - e[1]) / (2 * slope)) / 2 if slope else math.nan
