"""Picture of the pearls' stability region."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pearlbvp.figures.canvas import COLOURS, add_legend, dress, new_figure, note_unit, own_style
from pearlbvp.units import RADII, Units

WIDTH, HEIGHT = 3.4, 2.6
"""Of one of several panels, in inches."""


@own_style()
def draw_region(table: pd.DataFrame, units: Units = RADII) -> Figure:
    """Intervals of volumes on which equal pearls are stable, over their period, a panel for each spontaneous curvature.

    Args:
        table: from ``studies.region.stability_region``.
        units: of the table.
    """
    curvatures = table["c0"].unique()
    if len(curvatures) == 1:
        figure, axes = new_figure()
        panels = [axes]
    else:
        columns = min(3, len(curvatures))
        rows = math.ceil(len(curvatures) / columns)
        figure, axes = new_figure(rows, columns, width=columns * WIDTH, height=rows * HEIGHT, squeeze=False)
        panels = list(axes.ravel())
        figure.subplots_adjust(hspace=0.45)
    for axes, c0 in zip(panels, curvatures, strict=False):
        _fill(axes, table[table["c0"] == c0], units)
        dress(
            axes,
            units.axis_label("period", "period of the pearls"),
            "reduced volume v",
            f"{units.symbol('c0')} = {units.named('c0', c0):g}",
        )
    for axes in panels[len(curvatures) :]:
        axes.remove()
    note_unit(figure, units)
    if (table["status"] == "found").any():
        add_legend(panels[0], fontsize="small", loc="upper left")
    return figure


def _fill(axes: Axes, table: pd.DataFrame, units: Units) -> None:
    """A bar for each interval, as wide as periods are apart, and marks at its ends, for some are too short to be seen."""
    periods = np.sort(table["period"].unique())
    width = float(np.diff(periods).min()) if len(periods) > 1 else 0.1 * float(periods[0])
    for i, (pearls, rows) in enumerate(table[table["status"] == "found"].groupby("pearls")):
        colour = COLOURS[i % len(COLOURS)]
        name = "any length" if math.isinf(float(pearls)) else f"{pearls:.0f} pearl{'s' * (pearls != 1)}"  # type: ignore[arg-type]
        heights = (rows["v_to"] - rows["v_from"]).to_numpy(float)
        axes.bar(
            rows["period"].to_numpy(float), heights, width, rows["v_from"].to_numpy(float),
            facecolor=(colour, 0.35), linewidth=0, label=name,
        )  # fmt: skip
        for end in ("v_from", "v_to"):
            axes.plot(rows["period"], rows[end], "_", color=colour, markersize=4)
