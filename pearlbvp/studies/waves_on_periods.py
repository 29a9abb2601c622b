"""Which waves grow on more than one period of stable pearls? On so many of them, or on a tube of any length.

On ``N`` periods waves have phases ``theta = 2 pi j / N`` a period; on a tube of any length all phases occur. For ``n = 0``
and 1 all waves between 0 and pi decay, or all grow, unless one of them is neutral. Floquet's multipliers tell: there is one at
most, ``2 cos(theta) = rho`` (``stability.floquet``), so that a tube of any length is stable where ``|rho| > 2`` and one of the
waves decays. Where ``rho`` passes 2 infinitely long waves begin to grow, where it passes -2 those that change their sign from
period to period.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from operator import itemgetter
from typing import Any

import numpy as np

from pearlbvp.constrained import leading_eigenvalues
from pearlbvp.continuation.events import EIGENVALUE
from pearlbvp.continuation.path import PathEnd
from pearlbvp.continuation.segment import Segment
from pearlbvp.continuation.solution import Solution
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.stability.bloch import SecondVariation
from pearlbvp.stability.floquet import neutral_cosines
from pearlbvp.stability.spectrum import LEAST_N, Block, block_rates, blocks_of
from pearlbvp.studies.equal_pearls import Limit, Stretch

NEUTRAL = 1e-8
"""Size up to which growth rates at the end of a stretch are zero."""

MOST_N = 64
"""Azimuthal numbers that are looked at at most."""

FEWEST = 16
"""Parts of a stretch at whose ends waves are looked at."""

PHASES = 8
"""Steps from phase 0 to pi in which the fastest wave is looked for that winds around the tube more than once."""

Pearls = Solution[PearlProblem]


def stable_by_number(alone: list[Stretch], counts: Sequence[float]) -> dict[float, list[Stretch]]:
    """What is stable on each of several numbers of periods, given what is stable on one."""
    found = {1.0: alone}
    for count in counts:
        for fewer, more in pairwise(_divisors(count)):
            if more not in found:
                found[more] = [part for stretch in found[fewer] for part in stable_on(stretch, more)]
    return {count: found[count] for count in counts}


def _divisors(count: float) -> list[float]:
    """Numbers of periods from 1 to a number of them, each a multiple of the one before: what is stable on one is on fewer."""
    if count == math.inf:
        return [1.0, 2.0, 4.0, 8.0, math.inf]
    found, left, factor = [1.0], int(count), 2
    while left > 1:
        while left % factor == 0:
            found.append(found[-1] * factor)
            left //= factor
        factor += 1
    return found


def stable_on(stretch: Stretch, pearls: float) -> Iterator[Stretch]:
    """The parts of a stretch that are stable on a tube of so many periods, too; of any number where that is infinite.

    Pearls with long thin necks hardly feel each other: where the growth rates of their exchange are rounding, it ends.
    """
    waves: Waves = AnyLength() if math.isinf(pearls) else OnPeriods(int(pearls))
    points = _resolved(stretch.points)
    here = waves.within(points[0])
    growing = {key for key, value in here.items() if value > 0}
    begin, kept = stretch.ends[0], [points[0]]
    for first, last in pairwise(points):
        there = waves.within(last) if last is points[-1] else waves.values(last)
        crossings = _crossings(waves, first, last, here, there)
        if crossings is None:
            if not growing:
                yield Stretch(kept, (begin, Limit("not resolved", None, math.nan, first.observables)))
            return
        for key, point in crossings:
            end = waves.limit(key, point)
            if not growing:
                yield Stretch([*kept, point], (begin, end))
            growing ^= {key}
            begin, kept = end, [point]
        kept.append(last)
        here = there
    if not growing:
        yield Stretch(kept, (begin, stretch.ends[1]))


def _resolved(points: list[Pearls]) -> list[Pearls]:
    """The points of a stretch and, where they are few, others between them: waves may decay on a part of it only."""
    parts = math.ceil(FEWEST / max(len(points) - 1, 1))
    found = points[:1]
    for first, last in pairwise(points):
        segment = Segment(first, last)
        with suppress(PathEnd):
            for i in range(1, parts):
                found.append(segment.point(i / parts * segment.length))
        found.append(last)
    return found


def _crossings(
    waves: Waves, first: Pearls, last: Pearls, here: Mapping[Any, float], there: Mapping[Any, float]
) -> list[tuple[Any, Pearls]] | None:
    """The waves that become neutral between two points, in order, and where; None where growth rates are rounding."""
    segment, found = Segment(first, last), []
    for key in here.keys() & there.keys():
        if min(abs(here[key]), abs(there[key])) < NEUTRAL:
            return None
        if here[key] * there[key] < 0:
            like = first.spectrum.points
            try:
                point = segment.root(partial(waves.value, key=key, resolution=like), here[key], EIGENVALUE)
            except PathEnd:
                return None
            found.append((first.problem.inner(first.tangent, point.u - first.u), key, point))
    return [(key, point) for _, key, point in sorted(found, key=itemgetter(0))]


class Waves(ABC):
    """Functions of pearls, by wave, that are positive where it grows."""

    @abstractmethod
    def values(self, point: Pearls) -> dict[Any, float]:
        """Of all waves that may grow."""

    @abstractmethod
    def value(self, point: Pearls, key: Any, resolution: int) -> float:
        """Of one, on so many points of a period."""

    @abstractmethod
    def limit(self, key: Any, point: Pearls) -> Limit:
        """What ends a stable stretch where it is neutral."""

    def within(self, point: Pearls) -> dict[Any, float]:
        """Of all waves at an end of a stretch; those that are neutral there decay within it."""
        return {key: -NEUTRAL if abs(value) < NEUTRAL else value for key, value in self.values(point).items()}


def _by_n(first: int, of_n: Callable[[int], dict[Any, float]]) -> dict[Any, float]:
    """Values of all azimuthal numbers up to one whose waves all decay, and faster than those before."""
    found: dict[Any, float] = {}
    before = 0.0
    for n in range(first, MOST_N):
        here = of_n(n)
        found |= here
        largest = max(here.values())
        if n >= LEAST_N - 1 and largest < min(0.0, before):
            break
        before = largest
    return found


@dataclass(frozen=True)
class OnPeriods(Waves):
    """The largest growth rates of waves that fit several periods but not one.

    Attributes:
        periods: their number.
    """

    periods: int

    def values(self, point: Pearls) -> dict[Any, float]:
        """By block."""
        variation = SecondVariation.of(point.problem.profile(point.u), point.spectrum.points)
        forms = {(b.j, b.parity): variation.form(b.theta, b.parity) for b in blocks_of(self.periods, 0, True) if b.j}

        def of_n(n: int) -> dict[Any, float]:
            return {
                Block(n, j, self.periods, parity): float(leading_eigenvalues(form.matrix(n))[0])
                for (j, parity), form in forms.items()
            }

        return _by_n(0, of_n)

    def value(self, point: Pearls, key: Block, resolution: int) -> float:
        """Of a block."""
        variation = SecondVariation.of(point.problem.profile(point.u), resolution)
        return float(block_rates(variation, key)[0][0])

    def limit(self, key: Block, point: Pearls) -> Limit:
        """The block's wave."""
        return Limit("wave", key.n, key.theta, point.observables)


@dataclass(frozen=True)
class AnyLength(Waves):
    """Of every azimuthal number a function of all phases."""

    def values(self, point: Pearls) -> dict[Any, float]:
        """By azimuthal number."""
        return _by_n(0, lambda n: {n: self.value(point, n, point.spectrum.points)})

    def value(self, point: Pearls, key: int, resolution: int) -> float:
        """``2 - |rho|`` for ``n`` of 0 and 1, unless all waves grow together; else the largest growth rate of any phase."""
        profile = point.problem.profile(point.u)
        variation = SecondVariation.of(profile, resolution)
        if key > 1:
            return _fastest(variation, key)[0]
        margin = 2 - abs(float(neutral_cosines(profile, key)[1].real))
        return abs(margin) if _grows_between(variation, key) else margin

    def within(self, point: Pearls) -> dict[Any, float]:
        """At an end of a stretch the wave of a phase may be neutral that is not the first of its ``n`` to grow."""
        variation = SecondVariation.of(point.problem.profile(point.u), point.spectrum.points)
        return super().within(point) | {n: NEUTRAL for n in (0, 1) if _grows_between(variation, n)}

    def limit(self, key: int, point: Pearls) -> Limit:
        """The wave that is neutral."""
        profile = point.problem.profile(point.u)
        if key > 1:
            theta = _fastest(SecondVariation.of(profile, point.spectrum.points), key)[1]
        else:
            theta = 0.0 if neutral_cosines(profile, key)[1].real > 0 else math.pi
        return Limit("wave", key, theta, point.observables)


def _grows_between(variation: SecondVariation, n: int) -> bool:
    """Whether a wave of a phase between 0 and pi grows: with the first or the last of them neutral, all do or none."""
    return bool(leading_eigenvalues(variation.matrix(n, math.pi / 2))[0] > 0)


def _fastest(variation: SecondVariation, n: int) -> tuple[float, float]:
    """Growth rate and phase of the fastest wave that winds ``n`` times around, 2 or more."""
    from scipy.optimize import minimize_scalar

    def rate(theta: float) -> float:
        return float(leading_eigenvalues(variation.matrix(n, theta))[0])

    phases = np.linspace(0, math.pi, PHASES + 1)
    rates = [rate(theta) for theta in phases.tolist()]
    i = int(np.argmax(rates))
    if i in (0, PHASES):
        return rates[i], float(phases[i])
    found = minimize_scalar(
        lambda theta: -rate(theta), bounds=(phases[i - 1], phases[i + 1]), method="bounded", options={"xatol": 1e-7}
    )
    return -float(found.fun), float(found.x)
