"""Picture of the pearls' stability region."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from pearlbvp.figures.canvas import COLOURS, add_legend, dress, new_figure, note_unit, own_style
from pearlbvp.units import RADII, Units


@own_style()
def draw_region(table: pd.DataFrame, units: Units = RADII) -> Figure:
    """The largest stable volume over the period, one line for each number of pearls; stable below.

    Args:
        table: from ``studies.region.stability_region``.
        units: of the table.
    """
    figure, axes = new_figure()
    found = table[table["status"] == "found"]
    for i, (pearls, rows) in enumerate(found.groupby("pearls")):
        colour = COLOURS[i % len(COLOURS)]
        rows = rows.sort_values("period")
        axes.plot(rows["period"], rows["v"], ".-", color=colour, markersize=4, label=f"{pearls} pearls")
        axes.fill_between(rows["period"].to_numpy(float), 1.0, rows["v"].to_numpy(float), color=colour, alpha=0.08)
    along = units.axis_label("period", "period of the pearls")
    c0 = f"{units.symbol('c0')} = {units.named('c0', table['c0'].iloc[0]):g}"
    dress(axes, along, "reduced volume v", f"{c0}: pearls stable below")
    note_unit(figure, units)
    if not found.empty:
        add_legend(axes, fontsize="small", loc="upper right")
    return figure
