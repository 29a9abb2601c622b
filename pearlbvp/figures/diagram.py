"""Picture of a bifurcation diagram."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from pearlbvp.figures.branch import draw_curve
from pearlbvp.figures.canvas import COLOURS, add_legend, dress, new_figure, note_unit, own_style
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
