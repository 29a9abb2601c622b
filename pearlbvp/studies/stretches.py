"""Stable stretches of branches: shapes as functions of the reduced volume, and where two of them have one energy.

At fixed area and length ``-2 dE/dv = lambda2`` along every branch (``E`` by area, ``v = V/(pi L)``): energies between computed
points are cubics with these slopes, and the place where two are equal is found by Newton's method on computed shapes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from pearlbvp.arrays import Array
from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.events import first_wanted
from pearlbvp.continuation.path import PathEnd
from pearlbvp.continuation.segment import Segment
from pearlbvp.continuation.solution import Solution

STEEPEST = 3.0
"""Slope of an energy by that of the chord beyond which it is taken from the chord: multipliers pass through infinity there."""

BETWEEN = 12
"""Places between two points at which energies are compared."""

SAME_ENERGY, SAME_SLOPE = 1e-9, 1e-6
"""Differences of energy and ``lambda2`` up to which two shapes of one volume are one, shifted or mirrored."""

SAME_VOLUME = 1e-12
"""Difference of volumes that is rounding."""

NEAR = 1e-8
"""Distance of a volume from a point at which branches cross or turn where that is taken if Newton's method fails beside it."""


@dataclass(frozen=True, eq=False)
class Piece:
    """Consecutive points of a branch along which the volume grows, or falls, and stability is one.

    Attributes:
        name: of the branch.
        branch: all of it.
        first, last: numbers of the points at its ends, the smaller first.
        stable: whether its shapes are.
    """

    name: str
    branch: Branch[Any]
    first: int
    last: int
    stable: bool

    @cached_property
    def _places(self) -> list[int]:
        """Numbers of its points, by increasing volume."""
        numbers = list(range(self.first, self.last + 1))
        points = self.branch.points
        return numbers if points[self.first].value("v") < points[self.last].value("v") else numbers[::-1]

    @cached_property
    def _table(self) -> tuple[Array, Array, Array]:
        """``v, E, dE/dv`` of its points."""
        points = [self.branch.points[i].observables for i in self._places]
        v, energy, slope = (np.array([point[name] for point in points]) for name in ("v", "E", "lambda2"))
        chords = np.diff(energy) / np.diff(v)
        slope = -slope / 2
        near = np.maximum(np.abs(np.append(chords, chords[-1])), np.abs(np.append(chords[0], chords)))
        mean = (np.append(chords, chords[-1]) + np.append(chords[0], chords)) / 2
        return v, energy, np.where(np.abs(slope) <= STEEPEST * near + 1.0, slope, mean)

    @property
    def low(self) -> float:
        """The smallest volume."""
        return float(self._table[0][0])

    @property
    def high(self) -> float:
        """The largest volume."""
        return float(self._table[0][-1])

    @property
    def ends(self) -> tuple[int, int]:
        """Numbers of the points of smallest and largest volume."""
        return self._places[0], self._places[-1]

    def energies(self, v: Array | Sequence[float]) -> Array:
        """Energies by area at some volumes, interpolated; not a number outside of the piece."""
        from scipy.interpolate import CubicHermiteSpline

        v = np.asarray(v, dtype=float)
        inside = (v >= self.low - SAME_VOLUME) & (v <= self.high + SAME_VOLUME)
        return np.where(inside, CubicHermiteSpline(*self._table)(np.clip(v, self.low, self.high)), np.nan)

    def samples(self) -> Array:
        """Volumes from end to end: those of its points, and ``BETWEEN`` between any two."""
        v = self._table[0]
        parts = np.arange(BETWEEN) / BETWEEN
        return np.append((v[:-1, None] + parts * np.diff(v)[:, None]).ravel(), v[-1])

    def at(self, v: float) -> Solution[Any]:
        """The shape of a volume.

        Raises:
            PathEnd: it could not be computed.
        """
        volumes = self._table[0]
        right = int(np.clip(np.searchsorted(volumes, v), 1, len(volumes) - 1))
        pair = sorted(self._places[right - 1 : right + 1])
        points = [self.branch.points[i] for i in pair]
        nearest = min(points, key=lambda point: abs(point.value("v") - v))
        if abs(nearest.value("v") - v) <= SAME_VOLUME:
            return nearest
        found = first_wanted(points[0], points[1], {"v": v})
        if found is not None and found.converged:
            return found.point
        if abs(nearest.value("v") - v) <= NEAR:
            return nearest
        raise PathEnd(f"the shape of v = {v:.10g} between points {pair[0]} and {pair[1]} could not be computed")


def pieces(name: str, branch: Branch[Any], judged: bool = True) -> list[Piece]:
    """A branch in pieces of one stability each, along which the volume is monotone.

    Args:
        name: of the branch.
        branch: of any family.
        judged: whether stability divides it; else no piece is called stable.
    """
    found: list[Piece] = []
    v = [point.value("v") for point in branch.points]
    for i in range(len(v) - 1):
        if abs(v[i + 1] - v[i]) <= SAME_VOLUME:
            continue
        stable, grows = judged and _is_stable_between(branch, i), v[i + 1] > v[i]
        before = found[-1] if found else None
        if before and before.last == i and before.stable == stable and (v[i] > v[i - 1]) == grows:
            found[-1] = Piece(name, branch, before.first, i + 1, stable)
        else:
            found.append(Piece(name, branch, i, i + 1, stable))
    return found


def _is_stable_between(branch: Branch[Any], i: int) -> bool:
    """Whether the shapes between points ``i`` and ``i + 1`` are stable: of two special points the middle tells."""
    pair = branch.points[i : i + 2]
    if any(not point.spectrum.complete or point.spectrum.n_unstable for point in pair):
        return False
    changing = {
        special.index for special in branch.special if special.kind in ("start", "bp") or "fold" in special.kind
    }
    if not {i, i + 1} <= changing:
        return True
    segment = Segment(pair[0], pair[1])
    try:
        return segment.point(segment.length / 2).spectrum.stable
    except PathEnd:
        return False


def distinct(stretches: Sequence[Piece]) -> tuple[list[Piece], dict[str, str]]:
    """Without those that are images of another on all volumes of theirs, as far as energy and pressure tell.

    Returns:
        The pieces that are kept, and the branches of the others by name, each with that of its image.
    """
    kept: list[Piece] = []
    images: dict[str, str] = {}
    for one in sorted(stretches, key=lambda piece: piece.low - piece.high):
        image = next((other for other in kept if _is_image(one, other)), None)
        if image is None:
            kept.append(one)
        else:
            images[one.name] = image.name
    return [piece for piece in stretches if piece in kept], images


def _is_image(one: Piece, other: Piece) -> bool:
    if one.low < other.low - SAME_ENERGY or one.high > other.high + SAME_ENERGY or one.branch is other.branch:
        return False
    middle = (one.low + one.high) / 2
    if abs(one.energies([middle]) - other.energies([middle]))[0] > 1e3 * SAME_ENERGY:
        return False
    try:
        return is_same(one.at(middle), other.at(middle))
    except PathEnd:
        return False


def is_same(one: Solution[Any], other: Solution[Any]) -> bool:
    """Whether two shapes of one volume are images of each other, as far as energy, pressure and radii tell."""
    p, q = one.observables, other.observables
    gaps = {name: abs(p[name] - q[name]) for name in ("E", "lambda2", "r_max")}
    return gaps["E"] < SAME_ENERGY and max(gaps["lambda2"], gaps["r_max"]) < SAME_SLOPE


def equal_energies(one: Piece, other: Piece) -> list[float]:
    """Volumes at which two pieces have the same energy, to rounding; their common ends are none.

    Raises:
        PathEnd: a shape could not be computed.
    """
    low, high = max(one.low, other.low), min(one.high, other.high)
    if not high - low > 1e3 * SAME_VOLUME:
        return []
    v = np.union1d(one.samples(), other.samples())
    v = np.concatenate(([low], v[(v > low) & (v < high)], [high]))
    inside = np.concatenate(([v[0] + (v[1] - v[0]) / BETWEEN], v[1:-1], [v[-1] - (v[-1] - v[-2]) / BETWEEN]))
    gap = one.energies(inside) - other.energies(inside)
    changes = np.flatnonzero(gap[:-1] * gap[1:] < 0)
    return [_crossing(one, other, float(inside[i]), float(inside[i + 1])) for i in changes]


MOST_STEPS = 12


def _crossing(one: Piece, other: Piece, low: float, high: float) -> float:
    """Newton's method for equal energies between two volumes: the gap's slope is half the difference of the pressures.

    Raises:
        PathEnd: it did not converge there.
    """
    width, v = high - low, (low + high) / 2
    for _ in range(MOST_STEPS):
        p, q = one.at(v).observables, other.at(v).observables
        step = 2 * (p["E"] - q["E"]) / (p["lambda2"] - q["lambda2"])
        v = min(max(v + step, low - width, one.low, other.low), high + width, one.high, other.high)
        if abs(step) < 1e-11:
            return v
    raise PathEnd(
        f"the energies of {one.name} and {other.name} are equal near v = {v:.8g}, but the place was not located"
    )


CURVES = ["branch", "stable", "v", "E", "excess"]
"""Columns of energies along branches."""


def curves_of(everything: Sequence[Piece], stretches: Sequence[Piece], low: float, high: float) -> pd.DataFrame:
    """Energies along all branches, and by how much they exceed the least stable one of their volume, within a range."""
    tables = [pd.DataFrame(columns=CURVES)]
    for piece in everything:
        v = np.union1d(piece.samples(), [end for end in (low, high) if piece.low <= end <= piece.high])
        v = v[(v >= low) & (v <= high)]
        if len(v) == 0:
            continue
        least = np.fmin.reduce([other.energies(v) for other in stretches] or [np.full_like(v, np.nan)])
        energy = piece.energies(v)
        table = pd.DataFrame({"v": v, "E": energy, "excess": energy - least}).assign(
            branch=piece.name, stable=piece.stable
        )
        tables += [table, pd.DataFrame({"branch": [piece.name], "stable": [piece.stable]})]
    return pd.concat(tables, ignore_index=True).reindex(columns=CURVES)
