"""Branches and flows as a page takes them: columns as their tables have them, special points, shapes, growth rates."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

import numpy as np
import pandas as pd

from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.curve import hermite
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.dimensions import AXES, QUANTITIES
from pearlbvp.errors import SpectrumError
from pearlbvp.explorer.perturbations import critical
from pearlbvp.explorer.shapes import Shared, frame_of, shape_of
from pearlbvp.flows.record import FlowState
from pearlbvp.studies.branch import shown
from pearlbvp.units import Units, headed

MOST_FRAMES = 120
"""Shapes of a flow that are shown."""

MOST_BLOCKS, MOST_RATES = 10, 6
"""Symmetry blocks whose growth rates are shown, the most unstable ones, and rates of each."""


Count = Callable[[], object]
"""What is called after each shape."""


def branch_series(
    name: str, branch: Branch[Any], shared: Shared, units: Units, count: Count = lambda: None
) -> dict[str, Any]:
    """A branch: a point for each of its solutions.

    Args:
        name: what it is called.
        branch: of tubes of any family.
        shared: where lists go that several shapes have.
        units: of the columns.
        count: called after each point.
    """
    curve = hermite(branch)
    slopes = {end: units.columns(each) for end, each in (("leaving", curve.leaving), ("arriving", curve.arriving))}
    table = units.columns(shown(curve.table))
    points = []
    for point in branch.points:
        found = {"shape": shape_of(point.problem.shapes, point.u, shared), "rates": _rates(point.spectrum, units)}
        with suppress(SpectrumError, np.linalg.LinAlgError):  # a picture without it says that it is not known
            wave = critical(point.problem.shapes, point.u, point.spectrum, shared) if point.spectrum.rates else None
            found |= {} if wave is None else {"wave": wave.drawn}
        points.append(found)
        count()
    family = str(branch.points[-1].problem.family)
    return {"name": name, "family": family, "kind": "branch", "end": units.said(branch.reason), **_columns(table, units),
            **{end: _slopes(each, list(map(str, table))) for end, each in slopes.items()}, "points": points}  # fmt: skip


def flow_series(
    name: str, state: FlowState, shared: Shared, units: Units, count: Count = lambda: None
) -> dict[str, Any]:
    """A flow: a point for each of its frames, thinned out; those of a table that stand at their times."""
    units, frames = units.of_flow(state.problem.law), state.record.frames
    frames = [frames[i] for i in np.unique(np.linspace(0, len(frames) - 1, MOST_FRAMES).round().astype(int))]
    table, times = state.columns(units), np.array(state.record.rows["t"])
    places = np.searchsorted(times, [frame.t for frame in frames], side="right") - 1
    points = []
    for frame in frames:
        points.append({"shape": frame_of(frame.problem, frame.q, shared), "rates": []})
        count()
    return {"name": name, "family": "flow", "kind": "flow", "end": "", **_columns(table.iloc[places], units),
            "points": points}  # fmt: skip


def _columns(table: pd.DataFrame, units: Units) -> dict[str, Any]:
    """A table column by column, and what axes say of those with numbers."""
    columns: dict[str, list[Any]] = {}
    labels: dict[str, str] = {}
    for column in map(str, table):
        values = table[column]
        if pd.api.types.is_numeric_dtype(values):
            columns[column] = [_number(value) for value in values]
            words = AXES.get(column, column) if column != "c0" else AXES["c0"].replace("c0", units.symbol("c0"))
            labels[column] = units.axis_label(column, words) if column in QUANTITIES else words
        else:
            columns[column] = ["" if value is None else str(value) for value in values]
    headings = dict(zip(map(str, table), map(str, headed(table)), strict=True))
    return {"columns": columns, "labels": labels, "headings": headings}


def _slopes(table: pd.DataFrame, shown: list[str]) -> dict[str, list[float | int | None]]:
    """Slopes of the columns that are shown, to the digits that a screen has."""
    return {name: [_number(float(f"{value:.6g}")) for value in table[name]] for name in shown if name in table}


def _number(value: Any) -> float | int | None:
    """A number as JSON has it; none where it is missing or not finite."""
    if pd.isna(value) or not math.isfinite(value):
        return None
    return int(value) if float(value).is_integer() and abs(value) < 2**53 else float(value)


def _rates(spectrum: Spectrum, units: Units) -> list[Mapping[str, Any]]:
    """The leading growth rates of the most unstable blocks."""
    known = sorted(
        (block for block, rates in spectrum.rates.items() if len(rates)), key=lambda b: -spectrum.rates[b][0]
    )
    return [
        {"block": str(block), "rates": [float(units.to_user("rate", mu)) for mu in spectrum.rates[block][:MOST_RATES]]}
        for block in known[:MOST_BLOCKS]
    ]
