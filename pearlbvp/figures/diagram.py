"""Picture of a bifurcation diagram."""

from __future__ import annotations

import pandas as pd
from matplotlib import colormaps
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from pearlbvp.figures.branch import draw_curve
from pearlbvp.figures.canvas import COLOURS, dress, new_figure


def draw_diagram(table: pd.DataFrame, title: str = "") -> Figure:
    """Energy and pressure over the volume for every branch of a diagram's table, unstable parts dashed."""
    figure, (left, right) = new_figure(1, 2, width=9.5)
    for i, (name, rows) in enumerate(table.groupby("branch", sort=False)):
        colour = COLOURS[i % len(COLOURS)]
        draw_curve(left, rows, "v", "E", colour, str(name))
        draw_curve(right, rows, "v", "lambda2", colour)
    dress(left, "reduced volume v", "energy by area E/A", title)
    dress(right, "reduced volume v", "pressure lambda2", "dashed: unstable; circles: branch points; crosses: folds")
    left.legend(frameon=False, fontsize="small")
    return figure


FEW = 6
"""Branches whose names fit into a picture; more stand beside it."""


def draw_plane(table: pd.DataFrame, x: str, y: str, title: str = "") -> Figure:
    """Any two columns of several branches, unstable parts dashed, special points marked.

    Args:
        table: of a diagram, with a column ``branch``.
        x, y: columns.
        title: of the picture.
    """
    names = list(dict.fromkeys(table["branch"]))
    beside = len(names) > FEW
    figure, axes = new_figure(1, 1, width=9.5 if beside else 7.0, height=4.8)
    several = colormaps["turbo"].resampled(len(names) + 2)
    for i, name in enumerate(names):
        colour = COLOURS[i] if len(names) <= len(COLOURS) else to_hex(several(i + 1))
        draw_curve(axes, table[table["branch"] == name], x, y, colour, str(name))
    dress(axes, x, y, title or "dashed: unstable; circles: branch points; crosses: folds")
    if beside:
        figure.subplots_adjust(right=0.8)
        axes.legend(
            frameon=False, fontsize="x-small", loc="center left", bbox_to_anchor=(1.0, 0.5), ncols=1 + len(names) // 26
        )
    else:
        axes.legend(frameon=False, fontsize="small")
    return figure
