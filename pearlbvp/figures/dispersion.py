"""Picture of the straight tube's instabilities (the paper's Fig. neigs)."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from pearlbvp.figures.canvas import COLOURS, dress, new_figure


def draw_dispersion(table: pd.DataFrame, curves: pd.DataFrame, title: str) -> Figure:
    """Instability curves over the wave number with the tube's own modes, and the stable interval shaded.

    Args:
        table: branch points of a tube, from ``studies.dispersion.branch_points``.
        curves: from ``studies.dispersion.instability_curves``.
        title: of the picture.
    """
    figure, axes = new_figure()
    ends = {row["role"]: row["lambda2"] for _, row in table.iterrows() if row["role"]}
    low, high = min(ends.values(), default=-1.0), max(ends.values(), default=1.5)
    floor, ceiling = low - 0.5 * (high - low) - 0.5, high + 0.8 * (high - low) + 0.5
    for n, colour in zip(sorted(set(curves["n"].astype(int))), COLOURS, strict=False):
        rows = curves[curves["n"] == n]
        k, curve = rows["k"].to_numpy(float), rows["lambda2"].to_numpy(float)
        curve = np.where((curve > floor - 2) & (curve < ceiling + 2), curve, np.nan)
        name = {0: "pearling, n = 0", 1: "coiling/buckling, n = 1"}.get(n, f"n = {n} (k = 0: wrinkling)")
        modes = table[table["n"] == n]
        visible = ((curve > floor) & (curve < ceiling)).any()
        axes.plot(k, curve, color=colour, linewidth=1, label=name if visible else None)
        axes.plot(modes["k"], modes["lambda2"], "o", color=colour, markersize=4)
    if "lower" in ends and "upper" in ends:
        axes.axhspan(ends["lower"], ends["upper"], color="0.85", zorder=0, label="straight tube stable")
    axes.set_ylim(floor, ceiling)
    dress(axes, "wave number k (1/radius)", "lambda2 at which the mode is neutral", title)
    axes.legend(frameon=False, fontsize="small")
    return figure
