"""Shapes of saved branches as tables: the curve that a surface is made of, or points on it. Nothing is solved for it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from pearlbvp.arrays import Array
from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.events import SAME_VALUE
from pearlbvp.continuation.solution import Solution
from pearlbvp.errors import InputError
from pearlbvp.helfrich import finite, whole
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.numbers import as_whole
from pearlbvp.studies.branch import STOPS, known_branch, known_point
from pearlbvp.studies.mesh import NODES
from pearlbvp.studies.point import special_place
from pearlbvp.units import Sentence

SAMPLES = 400
"""Points of a curve: on a period of an axisymmetric shape, around a section."""


def stored(branch: Branch[Any], name: str) -> tuple[int, str]:
    """Which computed point of a branch is meant; none is computed.

    Args:
        branch: of any family.
        name: a point's number (negative: from the end), a special point (``bp``, ``bp:2``, ``fold:v``, ``start``, ``end``,
            ``stop``), or ``NAME=VALUE`` for the point that has a column's value, or else is next to where it is first passed.

    Returns:
        Its number, and a sentence where it does not have the value itself, else nothing.

    Raises:
        InputError: there is no such point.
    """
    last, name = len(known_branch(branch).points) - 1, str(name)
    number = as_whole(name)
    if number is not None:
        if not -last - 1 <= number <= last:
            raise InputError("point", f"there is no point {number}", f"the branch has points 0 to {last}")
        return number % (last + 1), ""
    column, equals, text = name.partition("=")
    if not equals:
        place = special_place(branch, name)
        if place is None:
            kinds = ", ".join(dict.fromkeys(special.kind for special in branch.special))
            raise InputError(
                "point",
                f"{name!r} is no point of this branch",
                f"give a number, NAME=VALUE like v=1.02, or one of its special points ({kinds}; bp:2 is the second)",
            )
        return place, ""
    column, value = column.strip(), finite("point", text)  # type: ignore[arg-type]
    if column not in STOPS:
        raise InputError(
            "point", f"{column!r} is no column with numbers of a shape", f"choose one of {', '.join(STOPS)}"
        )

    def said(text: str, number: float) -> Sentence:
        return Sentence(text.replace("{column}", column).replace("{value", f"{{{column}"), **{column: number})

    found = [entry.value(column) for entry in branch.points]
    at = _nearest(found, value)
    if at is None:
        known = [number for number in found if not math.isnan(number)]
        what = Sentence.joined(
            said("{column} = {value:g}", value),
            said(" is not reached on this branch, where it goes from {value:.6g}", min(known)),
            said(" to {value:.6g}", max(known)),
        )
        raise InputError("point", what, "give a value between, or follow the branch further")
    if abs(found[at] - value) <= SAME_VALUE * (1 + abs(value)):
        return at, ""
    return at, Sentence.joined(
        said("{column} = {value:g} lies between two points", value),
        said(f"; the nearest, point {at}, has {{value:.8g}}", found[at]),
        said(" (pearlbvp branch --until {column}={value:g} computes the shape itself)", value),
    )


def _nearest(values: Sequence[float], wanted: float) -> int | None:
    """The first of several values that is the wanted one, else the nearer of the first two that it lies between."""
    gaps = [value - wanted for value in values]
    for place, gap in enumerate(gaps):
        if abs(gap) <= SAME_VALUE * (1 + abs(wanted)):
            return place
    for place in range(len(gaps) - 1):
        if gaps[place] * gaps[place + 1] < 0:
            return place if abs(gaps[place]) < abs(gaps[place + 1]) else place + 1
    return None


def profile_table(point: Solution[Any], samples: int = SAMPLES) -> pd.DataFrame:
    """The curve that a shape is made of, in radii.

    Args:
        point: of a branch of any family.
        samples: steps on each period of an axisymmetric shape, or around a section.

    Returns:
        Of axisymmetric shapes, on the whole tube and at equal steps of arclength, ``x, r, psi`` (the tangent's angle), ``H``
        (mean curvature); of rings their section ``y, z, psi, H``; of coils the section at ``x = 0``, which turns along the
        tube: ``y, z``. Both are closed: the first point is the last.

    Raises:
        InputError: the shape is made of no single curve.
    """
    point, samples = known_point(point), whole("samples", samples, 4)
    columns: dict[str, Array] = point.problem.shapes.curve(point.u, samples)
    return pd.DataFrame(columns)


def surface_table(point: Solution[Any], nodes: int = NODES) -> pd.DataFrame:
    """Points of a surface, in radii: a grid whose rows ``i`` run along the tube and whose columns ``j`` run around it.

    Args:
        point: of a branch of any family; one on a mesh has its own vertices.
        nodes: of the grid, about.

    Returns:
        ``x, y, z, i, j``, of meshes ``x, y, z``. The grid is closed: its last column is the first, its last row the first
        one a period further.
    """
    point, nodes = known_point(point), whole("nodes", nodes)
    problem = point.problem.shapes
    own: PeriodicMesh | None = problem.own_mesh(point.u)
    if own is not None:
        return pd.DataFrame(own.reduced().vertices, columns=["x", "y", "z"])
    length = point.observables["L"]
    around = max(8, round(math.sqrt(nodes * 2 * math.pi / length)))
    rows = max(8, round(nodes / around))
    i, j = (part.ravel() for part in np.meshgrid(np.arange(rows + 1), np.arange(around + 1), indexing="ij"))
    found: Array = problem.parametrized(point.u)(length * (i % rows) / rows, 2 * math.pi * (j % around) / around)
    found[i == rows, 0] += length
    return pd.DataFrame({"x": found[:, 0], "y": found[:, 1], "z": found[:, 2], "i": i, "j": j})
