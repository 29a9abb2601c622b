"""Picture of the straight tube's instabilities (the paper's Fig. neigs)."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from pearlbvp.figures.canvas import COLOURS, add_legend, dress, new_figure, note_unit, own_style
from pearlbvp.units import RADII, Units


@own_style()
def draw_dispersion(table: pd.DataFrame, curves: pd.DataFrame, title: str, units: Units = RADII) -> Figure:
    """Instability curves over the wave number with the tube's own modes, and the stable interval shaded.

    Args:
        table: branch points of a tube, from ``studies.dispersion.branch_points``.
        curves: from ``studies.dispersion.instability_curves``.
        title: of the picture.
        units: of both tables.
    """
    figure, axes = new_figure()
    one = units.to_user("lambda2", 1.0)
    ends = {row["role"]: row["lambda2"] for _, row in table.iterrows() if row["role"]}
    low, high = min(ends.values(), default=-one), max(ends.values(), default=1.5 * one)
    floor, ceiling = low - 0.5 * (high - low) - 0.5 * one, high + 0.8 * (high - low) + 0.5 * one
    for n, colour in zip(sorted(set(curves["n"].astype(int))), COLOURS, strict=False):
        rows = curves[curves["n"] == n]
        k, curve = rows["k"].to_numpy(float), rows["lambda2"].to_numpy(float)
        curve = np.where((curve > floor - 2 * one) & (curve < ceiling + 2 * one), curve, np.nan)
        name = {0: "pearling, n = 0", 1: "coiling/buckling, n = 1"}.get(n, f"n = {n} (k = 0: wrinkling)")
        modes = table[table["n"] == n]
        visible = ((curve > floor) & (curve < ceiling)).any()
        axes.plot(k, curve, color=colour, label=name if visible else None)
        axes.plot(modes["k"], modes["lambda2"], "o", color=colour, markersize=4)
    if "lower" in ends and "upper" in ends:
        axes.axhspan(ends["lower"], ends["upper"], color="0.85", zorder=0, label="straight tube stable")
    axes.set_ylim(floor, ceiling)
    neutral = units.axis_label("lambda2", "lambda2 at which the mode is neutral")
    dress(axes, units.axis_label("k"), neutral, title)
    note_unit(figure, units)
    add_legend(axes, fontsize="small")
    return figure
