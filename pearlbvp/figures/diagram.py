"""Picture of a bifurcation diagram."""

from __future__ import annotations

import pandas as pd
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
