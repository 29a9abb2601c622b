"""Picture of a scan: a column over the parameter that has most values, a curve for each value of the others."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pearlbvp.dimensions import AXES
from pearlbvp.figures.canvas import COLOURS, add_legend, dress, new_figure, note_unit, own_style
from pearlbvp.units import RADII, Units

MOST_NAMED = 8
"""Curves that get a line each in the legend; of more, every so many."""


@own_style()
def draw_scan(
    table: pd.DataFrame,
    name: str,
    parameters: Sequence[str],
    drawn: Sequence[str],
    units: Units = RADII,
    *,
    role: str = "",
) -> Figure:
    """What is finished of a scan.

    Args:
        table: its rows.
        name: of its question, for the title.
        parameters: of its question.
        drawn: the columns that are drawn, each on axes of its own.
        units: of the table.
        role: of the rows that are drawn; all, where it is empty.
    """
    figure, panels = new_figure(1, len(drawn), width=1.5 + 5.5 * len(drawn), squeeze=False)
    table = table[table["role"] == role] if role else table
    varying = _independent(table, parameters) or [parameters[0]]
    numbers = [name for name in varying if pd.api.types.is_numeric_dtype(table[name])] or [parameters[0]]
    along = max(numbers, key=lambda name: len(set(table[name])))
    others = [name for name in varying if name != along]
    title = ", ".join(
        [name, *(words for one in parameters if one not in varying for words in _fixed(table, one, units))]
    )
    for axes, column in zip(panels[0], drawn, strict=True):
        _draw_column(axes, table, along, others, column, units)
        labels = [units.axis_label(one, None if one in AXES else one) for one in (along, column)]
        dress(axes, labels[0], labels[1], title)
    note_unit(figure, units)
    if others and len(table):
        add_legend(panels[0, 0], fontsize="small")
    return figure


def _fixed(table: pd.DataFrame, name: str, units: Units) -> list[str]:
    """What a parameter is in all rows, in words; nothing where it varies with others, or has no number."""
    values = table[name].dropna().unique().tolist() if name in table else []
    if len(values) != 1:
        return []
    return [_said(name, values[0], units)]


def _draw_column(axes: Axes, table: pd.DataFrame, along: str, others: list[str], drawn: str, units: Units) -> None:
    """A column over a parameter, a curve for each value of the others."""
    curves = list(table.groupby(others, sort=True)) if others else [((), table)]
    every = -(-len(curves) // MOST_NAMED)
    for i, (values, rows) in enumerate(curves):
        colour = COLOURS[i] if len(curves) <= min(MOST_NAMED, len(COLOURS)) else colormaps["viridis"](i / len(curves))
        named = ", ".join(_said(name, value, units) for name, value in zip(others, values, strict=True))
        shown = rows.dropna(subset=[drawn]).sort_values(along)
        label = named if i % every == 0 and named else None
        several = shown[along].duplicated().any()  # of one tube, as its modes are, which no line joins
        axes.plot(shown[along], shown[drawn].astype(float), "." if several else ".-", color=colour, markersize=3,
                  label=label)  # fmt: skip


def _independent(table: pd.DataFrame, parameters: Sequence[str]) -> list[str]:
    """Parameters that vary, without those that follow from the others, as the critical period does from ``c0`` and ``L``."""
    varying = [name for name in parameters if name in table and table[name].nunique() > 1]
    for name in sorted(varying, key=lambda name: -table[name].nunique()):
        others = [other for other in varying if other != name]
        if len(varying) > 2 and table.groupby(others).ngroups == table.groupby(varying).ngroups:
            varying = others
    return varying


def _said(name: str, value: object, units: Units) -> str:
    """What a parameter is, in words and the user's unit."""
    return f"{units.symbol(name)} = {units.named(name, value):g}" if isinstance(value, float) else f"{name} = {value}"
