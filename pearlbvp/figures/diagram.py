"""Picture of a bifurcation diagram."""

from __future__ import annotations

import pandas as pd
from matplotlib import colormaps
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from pearlbvp.figures.branch import draw_curve
from pearlbvp.figures.canvas import COLOURS, add_legend, dress, new_figure, note_unit, own_style
from pearlbvp.studies.diagram import tubes_apart
from pearlbvp.units import RADII, Units


@own_style()
def draw_diagram(table: pd.DataFrame, title: str = "", units: Units = RADII) -> Figure:
    """Energy and pressure over the volume for every branch of a diagram's table, unstable parts dashed.

    Args:
        table: of branches, named by a column ``branch``.
        title: of the picture.
        units: of the table.
    """
    figure, (left, right) = new_figure(1, 2, width=9.5)
    for i, (name, rows) in enumerate(table.groupby("branch", sort=False)):
        colour = COLOURS[i % len(COLOURS)]
        draw_curve(left, rows, "v", "E", colour, f"pearls {name}" if str(name)[:1].isdigit() else str(name))
        draw_curve(right, rows, "v", "lambda2", colour)
    dress(left, units.axis_label("v"), units.axis_label("E"), title)
    dress(
        right,
        units.axis_label("v"),
        units.axis_label("lambda2"),
        "dashed: unstable; circles: branch points; crosses: folds",
    )
    note_unit(figure, units)
    add_legend(left, fontsize="small")
    return figure


FEW = 6
"""Branches whose names fit into a picture; more stand beside it."""


@own_style()
def draw_plane(table: pd.DataFrame, x: str, y: str, title: str = "", units: Units = RADII) -> Figure:
    """Any two columns of several branches, unstable parts dashed, special points marked.

    Args:
        table: of a diagram, with a column ``branch``.
        x, y: columns.
        title: of the picture.
        units: of the table.
    """
    names = list(dict.fromkeys(table["branch"]))
    beside = len(names) > FEW
    figure, axes = new_figure(1, 1, width=9.5 if beside else 7.0, height=4.8)
    several = colormaps["turbo"].resampled(len(names) + 2)
    tubes, between = tubes_apart(table, units), "\n" if beside else " "
    for i, name in enumerate(names):
        colour = COLOURS[i] if len(names) <= len(COLOURS) else to_hex(several(i + 1))
        draw_curve(
            axes,
            table[table["branch"] == name],
            x,
            y,
            colour,
            f"{name}{between}({tubes[str(name)]})" if tubes else str(name),
        )
    dress(
        axes,
        units.axis_label(x, x),
        units.axis_label(y, y),
        title or "dashed: unstable; circles: branch points; crosses: folds",
    )
    note_unit(figure, units)
    if beside:
        figure.subplots_adjust(right=0.8)
        axes.legend(
            frameon=False, fontsize="x-small", loc="center left", bbox_to_anchor=(1.0, 0.5), ncols=1 + len(names) // 26
        )
    else:
        add_legend(axes, fontsize="small")
    return figure
