"""Which point of a branch: by its number, by a column's value, or by the name that the paper gives a sample."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any

from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.path import PathEnd, Point
from pearlbvp.continuation.segment import Segment
from pearlbvp.errors import InputError
from pearlbvp.helfrich import finite

SAMPLES = {
    ("pearl", 0.0, 10.0, "A2"): ("lambda2", -3.165),
    ("coil", 0.0, 10.0, "B"): ("lambda2", 1.387),
    ("buckle", 0.0, 10.0, "C"): ("lambda2", 1.29),
}
"""Samples of the paper's branches by family, ``c0``, ``L`` and name (Table ptab1)."""


def chosen(branch: Branch[Any], name: str, family: str = "pearl") -> Point[Any]:
    """A point of a branch.

    Args:
        branch: of pearls, rings, coils or buckles.
        name: its number (negative: from the end), or ``NAME=VALUE`` for the first place where a column has a value, or one
            of the paper's names (``SAMPLES``).
        family: of the branch.

    Raises:
        InputError: there is no such point.
    """
    points = [entry.point for entry in branch.points]
    try:
        number = int(name)
    except ValueError:
        pass
    else:
        if not -len(points) <= number < len(points):
            raise InputError(f"point: there is no point {number}; the branch has points 0 to {len(points) - 1}")
        return points[number]
    column, equals, text = name.partition("=")
    if equals:
        value = finite("point", text)  # type: ignore[arg-type]
    else:
        first = points[0].observables
        known = {key[3]: found for key, found in SAMPLES.items() if key[:3] == (family, first["c0"], first["L"])}
        if name not in known:
            names = f" or one of {', '.join(known)}" if known else ""
            raise InputError(f"point: {name!r} is no point of this branch; give its number, NAME=VALUE{names}")
        column, value = known[name]
    if column not in points[0].observables:
        raise InputError(
            f"point: {column!r} is no column of the branch; choose one of {', '.join(points[0].observables)}"
        )
    for before, after in itertools.pairwise(points):
        ends = [point.observables[column] - value for point in (before, after)]
        if ends[1] == 0:
            return after
        if ends[0] * ends[1] < 0:
            try:
                return Segment(before, after).root(lambda point: point.observables[column] - value, ends[0])
            except PathEnd:
                break
    raise InputError(f"point: {column} = {value:g} is not reached on this branch; follow it further")


def in_radii(name: str, radius: float, powers: Mapping[str, int]) -> str:
    """A point's name given on a tube of any radius, as it is on that of radius 1; only ``NAME=VALUE`` changes.

    Args:
        name: as ``chosen`` takes it.
        radius: of the tube.
        powers: of length, of the columns.
    """
    column, equals, text = name.partition("=")
    if not equals or radius == 1:
        return name
    return f"{column}={finite('point', text) / radius ** powers.get(column, 0)!r}"  # type: ignore[arg-type]
