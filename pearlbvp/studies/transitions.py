"""Where the least shape of a tube changes as its volume grows, and where shapes gain and lose stability."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise
from typing import Any

import pandas as pd

from pearlbvp.continuation.branch import Status
from pearlbvp.continuation.path import PathEnd
from pearlbvp.errors import InputError, Interruption
from pearlbvp.helfrich import Tube
from pearlbvp.studies.diagram import MESH
from pearlbvp.studies.stretches import Piece, equal_energies

COLUMNS = ["v", "event", "branch", "other", "E", "E_other", "lambda2", "lambda2_other", "special", "critical", "falls_to",
           "c0", "L", "message"]  # fmt: skip

EVENTS = ("maxwell", "continuous", "jump", "stable", "unstable", "end")
"""The least shape changes at equal energies, continuously, or because one begins or ends; stability is gained or lost as
the volume grows; a branch cannot be followed further."""

STRAIGHT = "straight"
"""Name of the straight tube among the shapes."""

SAME_PLACE = 1e-9
"""Distance of volumes that is none where pieces of different branches meet."""

MEETING = 1e-7
"""Differences of ``v`` and ``E`` up to which branches meet."""

EQUAL_ENERGY, EQUAL_PRESSURE = 1e-9, 1e-5
"""Differences that are none: of energies by area, and of ``lambda2``, which is rougher where a branch begins."""


@dataclass(frozen=True)
class Part:
    """Volumes from ``low`` to ``high`` at which a stretch is the least; there is none where no shape is stable."""

    low: float
    high: float
    stretch: Piece | None

    @property
    def name(self) -> str:
        """The shape's name, nothing where there is none."""
        return "" if self.stretch is None else self.stretch.name


def least_parts(stretches: Sequence[Piece], low: float, high: float, say: Callable[[str], None]) -> list[Part]:
    """Which stable stretch has the least energy, from end to end of a range of volumes.

    Args:
        stretches: stable ones.
        low, high: ends of the range.
        say: called with a sentence where two energies are equal, but the place could not be located.
    """
    places = {low, high}
    for piece in stretches:
        places |= {piece.low, piece.high}
    for one, two in combinations(stretches, 2):
        try:
            places |= set(equal_energies(one, two))
        except PathEnd as error:
            say(str(error.args[0]))
    inside = sorted(place for place in places if low <= place <= high)
    edges = [place for i, place in enumerate(inside) if i == 0 or place - inside[i - 1] > SAME_PLACE]
    parts: list[Part] = []
    for left, right in pairwise(edges):
        middle = (left + right) / 2
        here = [piece for piece in stretches if piece.low <= middle <= piece.high]
        least = min(here, key=lambda piece: float(piece.energies([middle])[0]), default=None)
        if parts and parts[-1].stretch is least:
            parts[-1] = replace(parts[-1], high=right)
        else:
            parts.append(Part(left, right, least))
    return parts


def ranges(parts: Sequence[Part]) -> pd.DataFrame:
    """``low, high, branch``: neighbours of one name as one."""
    rows: list[tuple[float, float, str]] = []
    for part in parts:
        if rows and rows[-1][2] == part.name:
            rows[-1] = (rows[-1][0], part.high, part.name)
        else:
            rows.append((part.low, part.high, part.name))
    return pd.DataFrame(rows, columns=["low", "high", "branch"])


def transitions(
    tube: Tube,
    parts: Sequence[Part],
    stretches: Sequence[Piece],
    names: Sequence[str],
    ends: tuple[float, float],
    falls: Callable[[Piece, bool], list[str]],
    stopped: Interruption,
) -> pd.DataFrame:
    """A row an event, by volume, the columns ``COLUMNS``.

    Args:
        tube: the straight tube.
        parts: from ``least_parts``.
        stretches: the stable ones.
        names: of all branches.
        ends: of the range of volumes.
        falls: names of the shapes that a stretch flows to at its lower or upper end.
        stopped: an interruption ends the table where it is.
    """
    rows: list[dict[str, Any]] = []
    with stopped:
        rows += (_change(before, after) for before, after in pairwise(parts) if not _is_one(before.name, after.name))
        for piece in stretches:
            for upper, number, event in zip((False, True), piece.ends, ("stable", "unstable"), strict=True):
                point = piece.branch.points[number]
                if ends[0] < point.value("v") < ends[1] and not _goes_on(piece, number, names):
                    row = _of_stability(piece, number, event, stretches, names)
                    rows.append(row)
                    try:
                        row["falls_to"] = ", ".join(falls(piece, upper))
                    except (InputError, PathEnd) as error:
                        row["message"] = "; ".join(filter(None, (row["message"], str(error))))
    rows.sort(key=lambda row: (row["v"], row["event"]))
    table = pd.DataFrame(rows, columns=COLUMNS)
    words = table[["other", "special", "critical", "falls_to", "message"]].astype(object).fillna("")
    return table.assign(c0=tube.c0, L=tube.length, **words)


def _goes_on(piece: Piece, number: int, names: Sequence[str]) -> bool:
    """Whether a branch goes on beyond a point, where it was told to stop or triangles take it over from modes."""
    if "stop" in piece.branch.kinds(number) or (number == 0 and piece.name.endswith(f" {MESH}")):
        return True
    return number == len(piece.branch.points) - 1 and f"{piece.name} {MESH}" in names


def _is_one(one: str, other: str) -> bool:
    """Whether the names are those of two parts of a branch, in modes and on triangles."""
    return one != other and one.removesuffix(f" {MESH}") == other.removesuffix(f" {MESH}")


def _change(before: Part, after: Part) -> dict[str, Any]:
    """Where the least shape changes."""
    row: dict[str, Any] = {"v": after.low, "branch": before.name, "other": after.name}
    try:
        found = [None if part.stretch is None else part.stretch.at(after.low).observables for part in (before, after)]
    except PathEnd as error:
        return row | {"event": "jump", "message": error.args[0]}
    for suffix, numbers in zip(("", "_other"), found, strict=True):
        row |= {} if numbers is None else {f"{name}{suffix}": numbers[name] for name in ("E", "lambda2")}
    gaps = {name: abs(row.get(name, math.nan) - row.get(f"{name}_other", math.nan)) for name in ("E", "lambda2")}
    if not gaps["E"] < EQUAL_ENERGY:
        return row | {"event": "jump", "message": "a shape begins or ends to be stable there"}
    if abs(after.low - 1) <= SAME_PLACE:
        return row | {"event": "continuous", "message": "by way of the straight tube"}
    if gaps["lambda2"] < EQUAL_PRESSURE:
        return row | {"event": "continuous", "message": "the one branches off from the other"}
    return row | {"event": "maxwell", "message": "equal energies of two shapes"}


def _of_stability(
    piece: Piece, number: int, event: str, stretches: Sequence[Piece], names: Sequence[str]
) -> dict[str, Any]:
    """Where a shape gains or loses stability as the volume grows."""
    branch, kinds = piece.branch, piece.branch.kinds(number)
    point, special = branch.points[number], [found for found in branch.special if found.index == number]
    blocks = dict.fromkeys(str(found.block) for found in special if found.block is not None)
    located = any(found.converged for found in special)
    ended = "end" in kinds and branch.status is not Status.PITCHFORK and "bp" not in kinds
    return {
        "v": point.value("v"), "event": "end" if ended else event, "branch": piece.name,
        "other": " ".join(_neighbours(piece, number, stretches, names)),
        "E": point.value("E"), "lambda2": point.value("lambda2"), "special": ",".join(kinds), "critical": ", ".join(blocks),
        "message": branch.reason if ended else "" if located else "the place was not located",
    }  # fmt: skip


def _neighbours(piece: Piece, number: int, stretches: Sequence[Piece], names: Sequence[str]) -> dict[str, None]:
    """Shapes whose branches meet a piece at one of its ends: by the names that ``studies.diagram`` gives, or by what they are.

    Args:
        piece: of a branch.
        number: of the point.
        stretches: the stable pieces of all branches.
        names: of all branches.
    """
    branch, name = piece.branch, piece.name
    here = [str(k) for k, found in enumerate(branch.find("bp"), start=1) if found.index == number]
    found = [name.rpartition("/")[0] or STRAIGHT] if number == 0 and "start" in branch.kinds(0) else []
    children = {f"{name}/{k}" for k in here}
    found += [other for other in names if other.removesuffix(" neck").removesuffix(" shrink") in children]
    place = branch.points[number].observables
    for other in stretches:
        ends = (other.branch.points[i].observables for i in other.ends)
        if other.branch is not branch and any(_is_at(place, end) for end in ends):
            found.append(other.name)
    return dict.fromkeys(found)


def _is_at(place: Mapping[str, float], end: Mapping[str, float]) -> bool:
    """Whether two solutions at which branches meet are one; the straight tube is none of them."""
    gaps = [abs(place[name] - end[name]) for name in ("v", "E", "lambda2", "r_max")]
    return place["amplitude"] > EQUAL_PRESSURE and max(gaps[:2]) < MEETING and max(gaps[2:]) < EQUAL_PRESSURE
