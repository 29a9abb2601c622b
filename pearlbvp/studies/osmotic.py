"""Equilibria of a tube at a given tension with solute in it: its pearls of one period, and of all that fit its length.

Pearls of a period leave the straight tube as it is blown up; along their branch the osmolarity varies (``shapes.osmotic``)
and is what is wanted at one or more equilibria. From these the period varies at that osmolarity, so that one curve has the
pearls of many periods, up to folds: beyond one, pearls are unstable to a change of all alike.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from pearlbvp.continuation import PathOptions, Solution, follow
from pearlbvp.continuation.segment import Segment
from pearlbvp.continuation.switching import tangent_along
from pearlbvp.errors import InputError
from pearlbvp.helfrich import finite, positive
from pearlbvp.shapes.osmotic import OsmoticPearl, osmotic_onset
from pearlbvp.shapes.pearl import THINNEST_NECK
from pearlbvp.theory.osmotic import onset_sizes

Pearl = Solution[OsmoticPearl]

FULL = 1.3
"""Volume, by that at which both sides are of one osmolarity, up to which equilibria are looked for."""

SHORTEST = 3.0
"""Period of the shortest pearls that are looked for."""

LONGEST = 500.0
"""Of the whole tube; pearls of every number that fits it are looked for."""

LARGEST_C0 = 3.0
"""Beyond, the tension is below -8.75."""

SAME = 1e-7
"""Relative difference of volumes at which two shapes of a period are one, and of periods."""

FLAT = 1e-4
"""Radius of the belly minus that of the neck below which a tube is straight: pearls are that only where they leave it."""

OPTIONS = PathOptions(step=0.1, max_step=1.0)


@dataclass(frozen=True)
class OsmoticTube:
    """A tube at a given tension with solute in it, in radii of the straight tube without a pressure difference.

    Attributes:
        c0: spontaneous curvature; the tension is ``lambda1 = 1/4 - c0^2``.
        solute, osmolarity: of the law ``lambda2 = osmolarity - solute / v``.
        length: of the whole tube.

    Raises:
        InputError: a number that cannot be used.
    """

    c0: float
    solute: float
    osmolarity: float
    length: float

    def __post_init__(self) -> None:
        if abs(finite("c0", self.c0)) > LARGEST_C0:
            raise InputError("c0", f"{self.c0:g} is beyond {LARGEST_C0:g} in units of 1/radius", "give a smaller one")
        for name in ("solute", "osmolarity", "length"):
            positive(name, getattr(self, name))
        if self.length > LONGEST:
            raise InputError("length", f"{self.length:g} radii are beyond {LONGEST:g}", "give a part of the tube")

    @property
    def periods(self) -> list[float]:
        """Periods of equal pearls that fill the tube, shortest first."""
        return [self.length / pearls for pearls in range(math.floor(self.length / SHORTEST), 0, -1)]


def pearls_of_period(tube: OsmoticTube, period: float) -> list[Pearl]:
    """Equal pearls of a period on the branch that leaves the straight tube, smallest volume first; there may be none."""
    sizes = onset_sizes(tube.c0, period)
    if len(sizes) == 0:
        return []
    full = FULL * tube.solute / tube.osmolarity

    def stop(point: Pearl) -> str | None:
        return "full" if point.observables["v"] > full else _closed(point)

    path = follow(osmotic_onset(tube.c0, period, float(sizes[0]), tube.solute), OPTIONS, stop)
    return list(_crossings(path.points, "osmolarity", tube.osmolarity))


def at_periods(tube: OsmoticTube, pearl: Pearl, periods: Sequence[float]) -> list[Pearl]:
    """Equilibria of several periods, shortest first, on the curve through one, between its next folds in the period."""
    problem, u = pearl.problem.at_osmolarity(pearl.u, tube.osmolarity)
    growing = np.zeros_like(u)
    growing[-1] = 1.0  # the half period is the last unknown
    tangent, here = tangent_along(problem, u, growing), pearl.observables["L"]
    found: list[Pearl] = []
    for way in (-1.0, 1.0):
        beyond = [period for period in periods if (period - here) * way > 0]
        if beyond:
            path = follow(Solution.along(problem, u, way * tangent), OPTIONS, _end(way, max(way * p for p in beyond)))
            found += [pearl for period in beyond for pearl in _crossings(path.points, "L", period)]
    return sorted(found, key=lambda point: point.observables["L"])


def _closed(point: Pearl) -> str | None:
    return "neck" if point.observables["r_min"] < THINNEST_NECK else None


def _is_straight(point: Pearl) -> bool:
    """Whether it is the straight tube, or pearls with belly and neck exchanged, which lie beyond it."""
    return point.problem.signed_amplitude(point.u) < FLAT


def _end(way: float, last: float) -> Callable[[Pearl], str | None]:
    """Where the curve over periods ends: beyond the last one wanted, at a fold, at the straight tube, at a closed neck."""

    def stop(point: Pearl) -> str | None:
        if _is_straight(point):
            return "straight"
        if point.tangent[-1] * way < 0:
            return "fold"
        return "last" if point.observables["L"] * way > last else _closed(point)

    return stop


def _crossings(points: Sequence[Pearl], name: str, value: float) -> Iterator[Pearl]:
    """Where an observable has a value along a path of pearls, up to where they become straight."""
    for before, after in pairwise(points):
        miss = before.observables[name] - value
        if miss * (after.observables[name] - value) < 0:
            found = Segment(before, after).root(lambda point: point.observables[name] - value, miss)
            if not _is_straight(found):
                yield found


def pearls_of_periods(tube: OsmoticTube, periods: Sequence[float]) -> dict[float, list[Pearl]]:
    """Equal pearls of several periods, smallest volume first, each with the stability of as many as fill the tube.

    They are those of the first period on its branch from the straight tube; those that these become as their period varies, if
    they are stable to a change of all alike, which they are up to a fold; and in the same way of each period not found so far.
    """
    several = [period for i, period in enumerate(periods) if not _is_among(period, periods[:i])]
    found: dict[float, list[Pearl]] = {period: [] for period in several}
    for period in several:
        if period == periods[0] or not found[period]:
            for pearl in pearls_of_period(tube, period):
                judged = _add(found, tube, pearl)
                if judged is not None and judged.spectrum.rates[judged.problem.trivial_block][0] < 0:
                    for other in at_periods(tube, pearl, periods):
                        _add(found, tube, other)
    in_order = {period: sorted(pearls, key=_volume) for period, pearls in found.items()}
    return {period: in_order[min(several, key=lambda one: abs(one - period))] for period in periods}


def _is_among(period: float, others: Sequence[float]) -> bool:
    """Whether a period is one of others, but for the rounding of units and divisions."""
    return any(abs(period - other) < SAME * other for other in others)


def _volume(pearl: Pearl) -> float:
    return pearl.observables["v"]


def _add(found: dict[float, list[Pearl]], tube: OsmoticTube, pearl: Pearl) -> Pearl | None:
    """A pearl on the whole tube, put to those of its period; None where it is there already."""
    period = min(found, key=lambda one: abs(one - pearl.observables["L"]))
    if any(abs(_volume(pearl) - _volume(other)) < SAME * _volume(other) for other in found[period]):
        return None
    cells = max(1, round(tube.length / period))
    found[period].append(replace(pearl, problem=replace(pearl.problem, cells=cells)))
    return found[period][-1]
