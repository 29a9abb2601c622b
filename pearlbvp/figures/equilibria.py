"""Picture of the pearled equilibria of many tubes."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from pearlbvp.figures.canvas import COLOURS, add_legend, dress, new_figure, own_style
from pearlbvp.quantities import read
from pearlbvp.tables import name_of


@own_style()
def draw_equilibria(table: pd.DataFrame) -> Figure:
    """Diameters of beads and necks, and spacings, case by case: full where they are stable, beside those of the table.

    Args:
        table: from ``studies.equilibria.equilibria``.
    """
    figure, (top, bottom) = new_figure(2, 1, width=9.0, height=7.0, sharex=True)
    case = np.arange(1, len(table) + 1)
    pearls = (table["status"] == "found").to_numpy()
    stable = (table["n_unstable"] == 0).fillna(False).to_numpy(bool)
    for name, colour, label in (("bead[nm]", COLOURS[0], "bead"), ("neck[nm]", COLOURS[1], "neck")):
        for chosen, face, words in ((pearls & stable, colour, "stable"), (pearls & ~stable, "none", "unstable")):
            top.plot(case[chosen], table[name][chosen].astype(float), "o", color=colour, markerfacecolor=face,
                     markersize=4, label=f"{label}, {words}")  # fmt: skip
    top.plot(case, table["straight[nm]"], "_", color=COLOURS[5], markersize=8, label="straight tube")
    fits = [(i, float(spacing)) for i, text in zip(case, table["stable_spacings[nm]"].fillna(""), strict=True)
            for spacing in str(text).split()]  # fmt: skip
    bottom.plot(*np.array(fits).reshape(-1, 2).T, "o", color=COLOURS[2], markersize=4, label="stable, fits the tube")
    for axes, name in ((top, "measured"), (bottom, "spacing")):
        for heading in (column for column in map(str, table) if name_of(column) == name):
            nm = 1e9 * read(heading, f"1{heading.partition('[')[2].removesuffix(']')}").value
            axes.plot(case, nm * table[heading], "x", color=COLOURS[7], markersize=4, label=f"{heading} of the table")
    dress(top, "", "diameter (nm)", "pearled equilibria at given tension and osmolarity")
    dress(bottom, "case", "spacing (nm)")
    top.set_ylim(bottom=0)
    add_legend(top, fontsize="x-small", ncols=3)
    add_legend(bottom, fontsize="x-small")
    return figure
