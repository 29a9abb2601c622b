"""Picture of a localized-pearl table."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from pearlbvp.figures.canvas import COLOURS, add_legend, dress, new_figure, note_unit, own_style
from pearlbvp.units import RADII, Units


@own_style()
def draw_localized(table: pd.DataFrame, units: Units = RADII) -> Figure:
    """Reduced volume and ``lambda2`` of the branch points against ``L``; columns named ``v_...`` are drawn beside.

    Args:
        table: from ``studies.localized.localized_pearls``.
        units: of the table.
    """
    figure, (left, right) = new_figure(1, 2, width=9.5, height=4.0)
    found = table[table["status"] == "found"].sort_values("L")
    left.plot(found["L"], found["v"], "o-", color=COLOURS[0], label="pearlbvp", markersize=5)
    others = [name for name in table.columns if name.startswith("v_")]
    for i, name in enumerate(others):
        shown = table.dropna(subset=[name])
        left.plot(shown["L"], shown[name], "x+1"[i % 3], color=COLOURS[1 + i % 5], markersize=9 + 3 * i, mew=1.5,
                  label=name[2:].replace("_", " "))  # fmt: skip
    right.plot(found["L"], found["lambda2"], "o-", color=COLOURS[0], markersize=5)
    c0, period = (units.named(name, table[name].iloc[0]) for name in ("c0", "period"))
    title = f"{units.symbol('c0')} = {c0:g}, pearls of period {period:g}"
    along = units.axis_label("L", "tube length L")
    pressure = units.axis_label("lambda2", "lambda2 at the branch point")
    dress(left, along, "reduced volume v at the branch point", title)
    dress(right, along, pressure, "localized single pearl")
    note_unit(figure, units)
    for axes in (left, right):
        if found.empty:
            axes.text(0.5, 0.5, "no branch point found", transform=axes.transAxes, ha="center")
    if others and not found.empty:
        add_legend(left)
    return figure
