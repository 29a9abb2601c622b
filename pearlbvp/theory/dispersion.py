"""Stability of the straight cylinder in closed form (paper, §3): growth rates, branch points, stable intervals.

With ``kappa = k^2`` and ``q = kappa + n^2`` the growth rate of ``e^{i(kx + n phi)}`` (paper, eq. (eigs) at r = 1) is
``mu = -(q - 1)^2/2 + lambda2 (q - 1) - (1 - 2 c0) kappa``: a mode with ``q > 1`` is unstable above its critical
``lambda2``, a pearling mode with ``k < 1`` below it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pearlbvp.arrays import numeric
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, WaveNumbers, finite, known_tube
from pearlbvp.units import Sentence

LARGEST_LAMBDA2 = 1e6
"""Beyond, onsets are too far from the tube's own scale to compute with: pearls next to ``k = 1``, and very short waves."""

SHORT_PERIOD = 0.2
"""Short waves whose branches, and their stability, are computed without trouble."""


def growth_rate(k: ArrayLike, n: ArrayLike, lambda2: ArrayLike, c0: ArrayLike) -> NDArray[np.float64]:
    """Growth rate ``mu(k, n, lambda2)`` of a mode of the cylinder; positive means unstable. Broadcasts.

    Raises:
        InputError: an argument that is no number and no array of them.

    Examples:
        >>> bool(growth_rate(0.5, 0, critical_lambda2(0.5, 0, 0.48) + 0.1, 0.48) < 0)  # pearls grow below it
        True
    """
    kappa = np.square(numeric("k", k))
    excess = kappa + np.square(numeric("n", n)) - 1
    mu: NDArray[np.float64] = (
        -(excess**2) / 2 + numeric("lambda2", lambda2) * excess - (1 - 2 * numeric("c0", c0)) * kappa
    )
    return mu


def critical_lambda2(k: ArrayLike, n: ArrayLike, c0: ArrayLike) -> NDArray[np.float64]:
    """The ``lambda2`` at which the mode ``(k, n)`` is neutral: ``(q - 1)/2 + (1 - 2 c0) k^2/(q - 1)``. Broadcasts.

    Pearling is eq. (l2hu) of the paper, coiling/buckling eq. (inmixed), wrinkling ``(n^2 - 1)/2``. Not a number for
    modes that are neutral everywhere (translations, ``k = 0, n = 1``) or nowhere (``k = 1, n = 0``).

    Raises:
        InputError: an argument that is no number and no array of them.

    Examples:
        >>> critical_lambda2(0, [2, 3], 0.48).tolist()  # wrinkles of two and three lobes
        [1.5, 4.0]
    """
    kappa = np.square(numeric("k", k))
    excess = kappa + np.square(numeric("n", n)) - 1
    c0 = numeric("c0", c0)
    with np.errstate(divide="ignore", invalid="ignore"):
        critical: NDArray[np.float64] = np.where(
            excess == 0, np.nan, excess / 2 + (1 - 2 * c0) * kappa / np.where(excess == 0, 1, excess)
        )
    return critical


def growing_waves(lambda2: float, c0: float) -> dict[int, tuple[float, float]]:
    """The waves that grow: by the number of waves around the tube, the interval of wave numbers ``k`` in which ``mu > 0``.

    ``mu`` is a concave polynomial in ``k^2``, ``-k^4/2 + (beta - e) k^2 + lambda2 e - e^2/2`` with ``e = n^2 - 1`` and
    ``beta = lambda2 - 1 + 2 c0``, so that none grow with ``e >= beta`` and ``e >= 2 lambda2``.
    """
    beta = lambda2 - 1 + 2 * c0
    found = {}
    for n in range(math.isqrt(math.ceil(1 + max(0.0, beta, 2 * lambda2))) + 1):
        e = n**2 - 1
        square = beta**2 + 2 * (1 - 2 * c0) * e  # of half the distance between the two roots
        if square <= 0:
            continue
        # The larger root without cancellation, the other from the product of the two.
        far = abs(beta - e) + math.sqrt(square)
        near = (e**2 - 2 * lambda2 * e) / far
        low, high = (near, far) if beta >= e else (-far, -near)
        if high > 0:
            found[n] = (math.sqrt(max(0.0, low)), math.sqrt(high))
    return found


def onset_lambda2(tube: Tube, m: int, n: int) -> float:
    """The ``lambda2`` at which a mode's branches leave a straight tube.

    Raises:
        InputError: none do, or so far away that nothing can be computed there; the remedy is a length, or a number of waves.
    """
    if m < 0 or n < 0 or (m, n) in ((0, 0), (0, 1)):
        raise InputError(
            "mode",
            f"({m},{n}) is no bifurcation but a change of radius or a shift of the tube",
            "give m,0 with m >= 1, 0,n with n >= 2, or m,n with both >= 1",
        )
    k = tube.wave_number(m)
    critical = float(critical_lambda2(k, n, tube.c0))
    if abs(critical) < LARGEST_LAMBDA2:
        return critical
    if n == 0 and k < 2:
        raise _next_to_one(tube, m)
    raise _too_short(tube, m, n, critical)


def _next_to_one(tube: Tube, m: int) -> InputError:
    """What is wrong with pearls whose period is the tube's circumference: their ``lambda2`` is a pole."""
    k = tube.wave_number(m)
    nearness = "{k:g}" if k == 1 else "{k:.12g}"
    text = (
        f"pearls of mode ({m},0) on L = {{L:.12g}} have the circumference of the tube as their period (k = {nearness}), "
        "where none branch off"
    )
    remedy = Sentence("give another length, like {length:.4g}", length=2 * math.pi * m * 1.1)
    return InputError("mode", Sentence(text, L=tube.length, k=k), remedy)


def _too_short(tube: Tube, m: int, n: int, critical: float) -> InputError:
    """What is wrong with waves that branch off at a ``lambda2`` of the size of their number's square."""
    around = n**2 > LARGEST_LAMBDA2  # these alone are half of it
    what = Sentence(
        f"waves ({m},{n}) on L = {{L:.6g}} are {{period:.3g}} long, so short that they branch off at lambda2 = "
        "{lambda2:.3g}, beyond {pressure:.3g}",
        L=tube.length,
        period=2 * math.pi / math.hypot(tube.wave_number(m), n),
        lambda2=critical,
        pressure=LARGEST_LAMBDA2,
    )
    longer = Sentence("give a longer tube, like {length:.3g}", length=SHORT_PERIOD * m)
    return InputError("mode", what, "give fewer waves around the tube" if around else longer)


def mode_type(m: int, n: int) -> str:
    """The field's name of the branches that a mode gives rise to."""
    if n == 0:
        return "pearling"
    return "wrinkling" if m == 0 else "coiling/buckling"


@dataclass(frozen=True)
class StableInterval:
    """The range of ``lambda2`` in which the straight tube is stable at fixed area and volume.

    Attributes:
        lower: where pearling begins; ``-inf`` if no pearling mode with ``k < 1`` fits the tube.
        lower_mode: the pearling mode ``(m, 0)`` that begins there.
        upper: where the first of all other modes begins.
        upper_mode: that mode.
    """

    lower: float
    lower_mode: WaveNumbers | None
    upper: float
    upper_mode: WaveNumbers

    @property
    def exists(self) -> bool:
        """Whether the straight tube is stable anywhere."""
        return self.lower < self.upper


def stable_interval(tube: Tube) -> StableInterval:
    """The stable interval of a straight tube of finite length, at a cost that does not depend on the length.

    Raises:
        InputError: it is no tube.

    Examples:
        >>> interval = stable_interval(Tube(0.48, 15))
        >>> interval.lower_mode, interval.upper_mode, interval.exists
        ((2, 0), (1, 1), True)
    """
    known_tube(tube)
    return stable_intervals(tube.c0, np.array([tube.length]))[0]


def stable_intervals(c0: float, lengths: NDArray[np.float64]) -> list[StableInterval]:
    """The stable intervals of straight tubes of one ``c0`` and several lengths, shape (T,).

    Over wave numbers each curve ``lambda2(k, n)`` has at most one extremum, so of all modes of one ``n`` only those next
    to it and next to ``k = 0`` and ``k = 1`` can end the interval. No ``n`` counts that begins above (0, 2), at 3/2.
    """
    per_k = np.asarray(lengths, dtype=float)[:, None, None] / (2 * math.pi)
    n_max = math.floor(math.sqrt(4 + 2 * max(0.0, 2 * c0 - 1))) + 1
    n = np.arange(n_max + 1)
    e = n**2 - 1.0
    with np.errstate(invalid="ignore"):
        # d lambda2 / d kappa = 1/2 + (1 - 2 c0) e / (kappa + e)^2 vanishes at kappa = -e +- sqrt(2 (2 c0 - 1) e).
        root = np.sqrt(2 * (2 * c0 - 1) * e)
        extrema = np.sqrt(np.column_stack((-e - root, -e + root))) * per_k
    near = np.floor(np.nan_to_num(extrema))
    ends = np.concatenate((0 * per_k, np.floor(per_k)), axis=2) + np.zeros((n.size, 1))
    m = np.concatenate((near, near + 1, ends, ends + 1, ends - 1), axis=2).clip(0)  # (T, n, candidates)
    k = m / per_k
    modes = n[:, None] + 0 * m
    critical = critical_lambda2(k, modes, c0)
    pearling_below = (modes == 0) & (m > 0) & (k <= 1)
    lower = np.where(pearling_below & (k < 1), critical, -np.inf)
    if c0 > 0.5:  # at k = 1 exactly, mu = 2 c0 - 1 > 0 whatever lambda2
        lower = np.where(pearling_below & (k == 1), np.inf, lower)
    upper = np.where(k**2 + modes**2 > 1, critical, np.inf)
    lower, upper, m, modes = (values.reshape(len(per_k), -1) for values in (lower, upper, m, modes))
    tubes = np.arange(len(per_k))
    first, last = lower.argmax(axis=1), upper.argmin(axis=1)
    found = zip(
        *(values[tubes, at].tolist() for at in (first, last) for values in (lower, upper, m, modes)), strict=True
    )
    return [
        StableInterval(below, None if below == -math.inf else (int(m0), int(n0)), above, (int(m1), int(n1)))
        for below, _, m0, n0, _, above, m1, n1 in found
    ]


def critical_wave_number(c0: float) -> float:
    """Wave number of the first pearls on a very long tube: ``sqrt(1 - sqrt(2 - 4 c0))`` for 1/4 < c0 < 1/2, else 0.

    Source: paper, eq. (kape). For ``c0 >= 1/2`` it tends to 1, where long tubes have no stable interval.
    """
    c0 = finite("c0", c0)
    if c0 >= 0.5:
        return 1.0
    return math.sqrt(1 - math.sqrt(2 - 4 * c0)) if c0 > 0.25 else 0.0


def stable_wave_numbers(c0: ArrayLike, pearls: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Between which wave numbers that many pearls, 2 or more, are the first to appear on a straight tube they fill.

    ``k`` and ``k'`` are neutral together where ``(k^2 - 1)(k'^2 - 1) = 2 (1 - 2 c0)``; the others that fit have
    ``k' = k (1 +- 1/pearls)`` or lie beyond. For 1/4 < c0 < 1/2. Broadcasts.

    Examples:
        >>> k = stable_wave_numbers(0.48, 2)[1]
        >>> round(float(critical_lambda2(k, 0, 0.48) - critical_lambda2(k / 2, 0, 0.48)), 12)
        0.0
    """
    share, c0 = 1 / numeric("pearls", pearls), numeric("c0", c0)
    others = (1 + share) ** 2, (1 - share) ** 2  # other kappa^2 - (1 + other) kappa + 1 - 2 (1 - 2 c0) = 0
    low, high = (
        np.sqrt(((1 + other) / 2 - np.sqrt((1 + other) ** 2 / 4 - other * (4 * c0 - 1))) / other) for other in others
    )
    return low, high


def long_tube_interval(c0: float) -> tuple[float, float]:
    """The stable interval of ``lambda2`` as ``L`` tends to infinity (paper, Corollary destabcor).

    Empty (lower end not below the upper end) for ``c0 >= 1/2``.
    """
    c0 = finite("c0", c0)
    # The supremum of the pearling curve over 0 < k < 1; it is unbounded for c0 > 1/2.
    lower = math.inf if c0 > 0.5 else 0.0 if c0 == 0.5 else float(critical_lambda2(critical_wave_number(c0), 0, c0))
    # The infimum of coiling (k -> 0), of wrinkling, and of pearling with k > 1.
    upper = -math.inf if c0 > 0.5 else min(1 - 2 * c0, 1.5, (1 - 2 * c0) + math.sqrt(2 * (1 - 2 * c0)))
    return lower, upper
