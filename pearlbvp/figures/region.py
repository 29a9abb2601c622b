"""Picture of the pearls' stability region."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from pearlbvp.figures.canvas import COLOURS, dress, new_figure, note_unit, own_style
from pearlbvp.units import RADII, Units

WIDTH, HEIGHT = 3.4, 2.6
"""Of one of several panels, in inches."""

FILLED = 0.85
"""Part of the distance between two periods that bars fill."""


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
    found = table[table["status"] == "found"]
    numbers = np.sort(found["pearls"].unique())
    for axes, c0 in zip(panels, curvatures, strict=False):
        _fill(axes, table[table["c0"] == c0], numbers)
        dress(
            axes,
            units.axis_label("period", "period of the pearls"),
            "reduced volume v",
            f"{units.symbol('c0')} = {units.named('c0', c0):g}",
        )
    for axes in panels[len(curvatures) :]:
        axes.set_axis_off()
    note_unit(figure, units)
    if len(numbers):  # where there is room, or in the first
        words = panels[0].get_legend_handles_labels()
        how = {"fontsize": "small", "loc": "upper left", "title": "darker: two shapes", "title_fontsize": "small"}
        panels[len(curvatures) % len(panels)].legend(*words, **how)
    return figure


def _fill(axes: Axes, table: pd.DataFrame, numbers: NDArray[np.float64]) -> None:
    """A bar for each interval, those of other numbers of pearls beside it, between lines, for some are too short to be seen."""
    periods = np.sort(table["period"].unique())
    apart = float(np.diff(periods).min()) if len(periods) > 1 else 0.1 * float(periods[0])
    width = FILLED * apart / max(len(numbers), 1)
    for i, pearls in enumerate(map(float, numbers)):
        rows = table[(table["status"] == "found") & (table["pearls"] == pearls)]
        colour = COLOURS[i % len(COLOURS)]
        name = "any length" if math.isinf(pearls) else f"{pearls:.0f} pearl{'s' * (pearls != 1)}"
        left = rows["period"].to_numpy(float) + (i - len(numbers) / 2) * width
        low, high = (rows[end].to_numpy(float) for end in ("v_from", "v_to"))
        axes.bar(left, high - low, width, low, align="edge", facecolor=(colour, 0.35), linewidth=0, label=name)
        axes.hlines([*low, *high], [*left, *left], [*left + width, *left + width], color=colour, linewidth=1)
