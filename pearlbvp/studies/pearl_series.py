"""Pearls of all periods from those of a few: their functions as one Chebyshev series in the period and the amplitude.

Along the pearls of a period all that decides about the localized pearl is analytic in the squared amplitude; for a given
squared amplitude it is analytic in the period, too. So two dozen periods give those of all others in between, for every
number of pearls at once (``docs/theory/stability.md``). Where pearls cannot be followed far enough there is no series, and
where a series does not decide, as next to a fold, it says so: both are left to a continuation each
(``localized.PeriodicPearls``).
"""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.continuation import PathOptions, Solution, follow
from pearlbvp.continuation.chebyshev import Unresolved, in_pieces, resolve, series
from pearlbvp.helfrich import Tube
from pearlbvp.representation import brief
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.shapes.pearling import pearling_onset
from pearlbvp.studies.amplitude_series import at_shares, first_losses
from pearlbvp.studies.localized import (
    COSINE,
    FUNCTIONS,
    PROFILES,
    SQUARE,
    SUM,
    PeriodicPearls,
    V,
    branch_point,
    functions_of,
    has_wave_around,
    losses_at,
)
from pearlbvp.studies.stability_loss import THINNEST_NECK, Ending, Outcome
from pearlbvp.theory.dispersion import stable_wave_numbers

TOLERANCE = 1e-10
"""Of the last coefficients, relative to one plus the functions' size."""

DEGREES = 12, 48
"""In the period, first and last; a series that the last does not resolve is tried on halves."""

HOPELESS = 3e-4
"""Error at which a larger degree is not tried."""

AMPLITUDES = 21
"""Terms in the squared amplitude."""

PROBES = 3
"""Periods at which the amplitude is found that the series has to reach."""

FEWEST = 56
"""Periods wanted in an interval for which a series is tried: about as many as it takes continuations at most."""

CURVATURES = 0.26, 0.4995
"""Values of ``c0`` between which there are series: below, pearls are so long that their multipliers have too few digits;
beyond, the shortest are next to the period ``2 pi``, where none are.
"""

BEYOND = 1.1
"""By how much the series reaches further than the probes' squared amplitudes."""


def scaled(period: Array) -> Array:
    """The coordinate ``log(1/k^2 - 1)`` in which pearls change evenly from short to long ones."""
    found: Array = np.log((period / (2 * math.pi)) ** 2 - 1)
    return found


def unscaled(u: float) -> float:
    """The period at a coordinate."""
    return 2 * math.pi * math.sqrt(1 + math.exp(u))


@dataclass(frozen=True)
class PearlSeries:
    """The pearls of all periods of an interval, as far as two of them need to lose stability.

    Attributes:
        c0: spontaneous curvature.
        low, high: ends of the interval, in ``scaled`` periods.
        reach: largest squared amplitude.
        clear: squared amplitude up to which no pearls have a neutral wave around the tube.
        coefficients: shape (P, A, 7), of the functions of ``localized.FUNCTIONS`` in Chebyshev polynomials of the scaled period
            and of the squared amplitude.
        error: what they leave unresolved, relative to one plus the functions' size.
        continuations: number of paths that were followed.
    """

    __repr__ = brief

    c0: float
    low: float
    high: float
    reach: float
    clear: float
    coefficients: Array
    error: float
    continuations: int

    @classmethod
    def over(
        cls,
        c0: float,
        low: float,
        high: float,
        *,
        reach: float | None = None,
        degrees: tuple[int, int] = DEGREES,
        tolerance: float = TOLERANCE,
    ) -> PearlSeries:
        """The series over an interval of scaled periods.

        Args:
            c0: spontaneous curvature.
            low, high: ends of the interval.
            reach: largest squared amplitude; by default what two pearls need.
            degrees: in the period, first and last.
            tolerance: of the last coefficients.

        Raises:
            Unresolved: there is none: pearls cannot be followed so far, or the degree does not suffice.
        """
        probes = [stable_up_to(c0, unscaled(u)) for u in (low, (low + high) / 2, high)]
        end = reach or BEYOND * max(float(probe[-1, SQUARE]) for probe in probes)
        # What is looked up is where the cosine has a value: its error counts by the others' change over its own, of order 1.
        changes = max(float(np.ptp(probe[:, :SQUARE], axis=0).max()) for probe in probes)
        size = np.ones(len(FUNCTIONS))
        size[[SUM, COSINE]] = max(1.0, min(1 / changes, 30.0))
        clear = [math.inf]

        def sample(t: float) -> Array:
            found, free = _up_to(c0, unscaled(low + t * (high - low)), end)
            clear.append(free)
            return found / size

        coefficients, error, count = series(sample, tolerance, *degrees, hopeless=HOPELESS)
        error = max(error, float((np.abs(coefficients[:, -2:]).max(axis=(0, 1))).max()))
        if error > tolerance:
            raise Unresolved(f"pearls between two periods are resolved to {error:.1e} only")
        return cls(c0, low, high, end, min(clear), coefficients * size, error, count + PROBES)

    def to_bytes(self) -> bytes:
        """All of it, as ``from_bytes`` takes it."""
        numbers = [self.c0, self.low, self.high, self.reach, self.clear, self.error, self.continuations]
        file = io.BytesIO()
        np.savez(file, numbers=np.array(numbers, dtype=float), coefficients=self.coefficients)
        return file.getvalue()

    @classmethod
    def from_bytes(cls, content: bytes) -> PearlSeries:
        """A series that was kept; nothing in it is executed."""
        with np.load(io.BytesIO(content), allow_pickle=False) as file:
            c0, low, high, reach, clear, error, count = file["numbers"].tolist()
            return cls(c0, low, high, reach, clear, file["coefficients"], error, int(count))

    def covers(self, periods: Array) -> NDArray[np.bool_]:
        """Which periods, shape (K,), lie in the interval."""
        u = scaled(periods)
        return (self.low - 1e-12 <= u) & (u <= self.high + 1e-12)

    def at(self, periods: Array) -> Array:
        """Coefficients in the squared amplitude for each of several periods, shape (A, K, 7)."""
        y = (2 * scaled(periods) - self.low - self.high) / (self.high - self.low)
        polynomials = chebyshev.chebvander(y, len(self.coefficients) - 1)
        return np.tensordot(polynomials, self.coefficients, 1).transpose(1, 0, 2)

    def values(self, periods: Array, pearls: NDArray[np.int64]) -> Array:
        """The functions at the localized pearl's branch point, shape (K, 7), for periods and numbers of pearls, shape (K,).

        The pearls are those that are stable at their onset. Not numbers where the series does not decide.
        """
        c = self.at(periods)
        share = first_losses(c, pearls)
        values = at_shares(c, share)
        values[~(share * self.reach < 0.9 * self.clear)] = np.nan
        return values


def stable_up_to(c0: float, period: float) -> Array:
    """The functions of pearls at onset and where two of them lose stability.

    Raises:
        Unresolved: they do not lose it to a localized pearl.
    """
    pearls = PeriodicPearls.trace(c0, period, 2)
    if pearls.outcomes([2])[0].ending is not Ending.FOUND:
        raise Unresolved("two pearls do not lose their stability to a localized one")
    return pearls.functions(np.append(0.0, pearls.losses_of_stability([2])))


def _up_to(c0: float, period: float, reach: float) -> tuple[Array, float]:
    """Coefficients of the functions of pearls in the squared amplitude, shape (A, 7), and up to where no waves around are
    neutral.

    Raises:
        Unresolved: the amplitude is not reached, or not on a straight way.
    """  # fmt: skip
    problem, u, tangent = pearling_onset(Tube(c0, period), tolerance=PROFILES)

    def stop(point: Solution[PearlProblem]) -> str | None:
        if point.observables["r_min"] < THINNEST_NECK:
            return "neck"
        return "reached" if point.observables["amplitude"] ** 2 >= reach else None

    path = follow(Solution(problem, u, tangent), PathOptions(step=0.1), stop)
    if path.reason != "reached":
        raise Unresolved(f"pearls of period {period:g} do not reach the amplitude of the others: {path.reason}")
    along = resolve(path.points, functions_of, pitchfork=True, until=lambda found: reach - found[:, SQUARE])
    waves = [point.observables["amplitude"] ** 2 for point in path.points[1:] if has_wave_around(point)]
    clear = min(waves, default=math.inf)
    squares = reach * (1 - np.cos(np.pi * np.arange(AMPLITUDES) / (AMPLITUDES - 1))) / 2
    x = np.append(0.0, along.first_crossings(SQUARE, squares[1:]))
    if not np.isfinite(x).all() or along.crossings(SQUARE, derivative=1).size:
        raise Unresolved(f"the amplitude of pearls of period {period:g} turns back")
    found = along(x)
    polynomials = chebyshev.chebvander(2 * squares / reach - 1, AMPLITUDES - 1)
    return np.asarray(np.linalg.solve(polynomials, found)), clear


def losses(
    c0: float, periods: Array, pearls: NDArray[np.int64], known: Sequence[PearlSeries] = ()
) -> tuple[list[Outcome], list[PearlSeries]]:
    """How pearls of many periods lose stability that are the first to appear on their tubes.

    Args:
        c0: spontaneous curvature.
        periods: shape (K,).
        pearls: how many of them are on the tube, 2 or more, shape (K,).
        known: series of this ``c0``.

    Returns:
        What became of each, and the series that were computed for it.
    """
    left = periods[~np.any([np.zeros(len(periods), dtype=bool), *(piece.covers(periods) for piece in known)], axis=0)]

    def beside(low: float, high: float) -> PearlSeries:
        if any(piece.low < high and low < piece.high for piece in known):
            raise Unresolved("part of it is known")
        return PearlSeries.over(c0, low, high)

    possible = CURVATURES[0] <= c0 <= CURVATURES[1]
    found = in_pieces(beside, *band(c0), scaled(np.unique(left)), FEWEST) if possible else []
    outcomes: list[Outcome | None] = [None] * len(periods)
    for piece in (*known, *found):
        here = np.array([i for i in np.flatnonzero(piece.covers(periods)) if outcomes[i] is None], dtype=int)
        for i, values in zip(here.tolist(), piece.values(periods[here], pearls[here]), strict=True):
            outcomes[i] = None if math.isnan(values[V]) else branch_point(values)
    alone: dict[float, list[int]] = {}
    for i, outcome in enumerate(outcomes):
        if outcome is None:
            alone.setdefault(float(periods[i]), []).append(i)
    for period, indices in alone.items():
        for i, outcome in zip(indices, losses_at(c0, period, pearls[indices].tolist()), strict=True):
            outcomes[i] = outcome
    return [outcome for outcome in outcomes if outcome is not None], found


def band(c0: float) -> tuple[float, float]:
    """The scaled periods between which some number of pearls, 2 or more, is stable at onset: those of two."""
    long, short = stable_wave_numbers(c0, 2)
    return float(scaled(2 * math.pi / short)), float(scaled(2 * math.pi / long))
