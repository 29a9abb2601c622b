"""Which point of a branch: by its number, by a column's value, or by the name that the paper gives a sample."""

from __future__ import annotations

import itertools
from typing import Any

from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.events import SAME_VALUE
from pearlbvp.continuation.path import PathEnd
from pearlbvp.continuation.segment import Segment
from pearlbvp.continuation.solution import Solution
from pearlbvp.errors import InputError
from pearlbvp.helfrich import finite
from pearlbvp.numbers import as_whole
from pearlbvp.studies.branch import known_branch
from pearlbvp.units import Sentence

SAMPLES = {
    ("pearl", 0.0, 10.0, "A2"): ("lambda2", -3.165),
    ("coil", 0.0, 10.0, "B"): ("lambda2", 1.387),
    ("buckle", 0.0, 10.0, "C"): ("lambda2", 1.29),
}
"""Samples of the paper's branches by family, ``c0``, ``L`` and name (Table ptab1)."""


def sample(family: str, c0: float, length: float, name: str) -> tuple[str, float]:
    """Column and value by which the paper gives a sample of a branch.

    Args:
        family, c0, length: of the branch.
        name: the sample's.

    Raises:
        InputError: the branch has none of that name; the message says which there are.
    """
    known = SAMPLES.get((family, c0, length, name))
    if known is None:
        names = ", ".join(f"{key[3]} ({key[0]}, c0 = {key[1]:g}, L = {key[2]:g} radii)" for key in SAMPLES)
        where = Sentence("at c0 = {c0:.6g}, L = {L:.6g} {L_unit}", c0=c0, L=length)
        what = Sentence.joined(f"{name!r} is no point of a {family} branch ", where)
        remedy = f"give NAME=VALUE, like v=1.02, a number on a saved branch, or a sample of the paper: {names}"
        raise InputError("point", what, remedy)
    return known


def special_place(branch: Branch[Any], name: str) -> int | None:
    """The place of a special point of a branch among its points, or None where it has none of that name.

    Args:
        branch: of any family.
        name: ``bp``, ``bp:2``, ``fold:v``, ``fold:v:2``, ``start``, ``end``: kind and number, the first where none is given.
    """
    kind, _, last = name.rpartition(":")
    number = as_whole(last)
    kind, count = (name, 1) if number is None or not kind else (kind, number)
    places = [special.index for special in branch.find(kind)]
    return places[count - 1] if 1 <= count <= len(places) else None


def chosen(branch: Branch[Any], name: str, family: str = "pearl") -> Solution[Any]:
    """A point of a branch.

    Args:
        branch: of pearls, rings, coils or buckles.
        name: its number (negative: from the end), ``NAME=VALUE`` for the first place where a column has a value, a special
            point (``bp``, ``fold:v:2``), or one of the paper's names (``SAMPLES``).
        family: of the branch.

    Raises:
        InputError: there is no such point.
    """
    points, name = known_branch(branch).points, str(name)
    try:
        number = int(name)
    except ValueError:
        pass
    else:
        if not -len(points) <= number < len(points):
            raise InputError("point", f"there is no point {number}", f"the branch has points 0 to {len(points) - 1}")
        return points[number]
    column, equals, text = name.partition("=")
    place = special_place(branch, name)
    if place is not None:
        return points[place]
    if equals:
        value = finite("point", text)  # type: ignore[arg-type]
    else:
        column, value = sample(family, points[0].observables["c0"], points[0].observables["L"], name)
    if column not in points[0].observables:
        raise InputError(
            "point", f"{column!r} is no column of the branch", f"choose one of {', '.join(points[0].observables)}"
        )
    reached = SAME_VALUE * (1 + abs(value))
    for before, after in itertools.pairwise(points):
        ends = [point.observables[column] - value for point in (before, after)]
        if abs(ends[1]) <= reached:
            return after
        if ends[0] * ends[1] < 0:
            try:
                return Segment(before, after).root(lambda point: point.observables[column] - value, ends[0])
            except PathEnd:
                break
    raise InputError("point", f"that value of {column} is not reached on this branch", "follow it further")
