"""Picture of a scan of pearl periods."""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pearlbvp.figures.canvas import COLOURS, add_legend, dress, new_figure, note_unit, own_style
from pearlbvp.units import RADII, Units


def _plot_by_pearls(axes: Axes, rows: pd.DataFrame, column: str, colour: str, label: str) -> None:
    """A line for each number of pearls, so that none is drawn across the jump from one number to the next."""
    for i, (_, same) in enumerate(rows.groupby(rows["pearls"].diff().fillna(0).ne(0).cumsum())):
        axes.plot(same["L"], same[column], ".-", color=colour, markersize=3, label=label if i == 0 else None)


@own_style()
def draw_periods(table: pd.DataFrame, units: Units = RADII) -> Figure:
    """Pearl period, stable interval of ``lambda2`` and onset of the localized pearl against ``L``, a colour a ``c0``.

    Args:
        table: from ``studies.period.pearl_periods``.
        units: of the table.
    """
    figure, (top, middle, bottom) = new_figure(3, 1, height=8.5, sharex=True)
    for i, (_, rows) in enumerate(table.sort_values("L").groupby("c0")):
        colour, c0 = COLOURS[i % len(COLOURS)], units.named("c0", rows["c0"].iloc[0])
        _plot_by_pearls(top, rows, "period", colour, f"{units.symbol('c0')} = {c0:g}")
        middle.plot(
            rows["L"], rows["lambda2_upper"], color=colour, linestyle=":", label="" if i else "first other mode"
        )
        middle.plot(rows["L"], rows["lambda2_pearl"], color=colour, label="" if i else "pearls")
        middle.fill_between(rows["L"].to_numpy(float), rows["lambda2_pearl"].to_numpy(float),
                            rows["lambda2_upper"].to_numpy(float), color=colour, alpha=0.12)  # fmt: skip
        _plot_by_pearls(bottom, rows, "v_localized", colour, "")
    dress(top, "", units.axis_label("period", "pearl period L / m"), "first pearls of a straight tube")
    dress(middle, "", units.axis_label("lambda2"), "stable range of the straight tube")
    dress(bottom, units.axis_label("L", "tube length L"), "reduced volume v", "where the localized pearl branches off")
    note_unit(figure, units)
    if top.get_legend_handles_labels()[0]:
        add_legend(top, fontsize="small")
        add_legend(middle, fontsize="small")
    return figure
