"""Picture of the growth rates of a straight tube's waves."""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pearlbvp.figures.canvas import COLOURS, add_legend, dress, new_figure, note_unit, own_style
from pearlbvp.units import RADII, Units

NAMES = {0: "pearling, n = 0", 1: "coiling/buckling, n = 1"}
FLOWS = {"rate": "fluids (Stokes)", "mu": "L² flow", "mu_diffusion": "H⁻¹ flow"}

MARGIN = 1.2
"""How far above zero the axes reach, by the largest rate, and as far below: how fast others decay says little."""


@own_style()
def draw_growth(table: pd.DataFrame, curves: pd.DataFrame, title: str, units: Units = RADII) -> Figure:
    """Growth rates in fluids over the wave number, and beside them those of the fastest kind of wave in all three flows.

    Args:
        table: from ``studies.growth.growth``, the tube's own waves.
        curves: from ``studies.growth.curves``.
        title: of the picture.
        units: of both tables.
    """
    figure, (rates, flows) = new_figure(1, 2, width=9.5)
    fastest = table[table["role"] == "fastest"]
    around = int(fastest["n"].iloc[0]) if len(fastest) else 0
    shown = curves[curves["n"] == around]
    scales = {name: _scale(shown[name], bool(len(fastest))) for name in FLOWS}
    for n, colour in zip(sorted(set(curves["n"])), COLOURS, strict=False):
        rows, waves = curves[curves["n"] == n], table[(table["n"] == n) & table["m"].notna()]
        name = NAMES.get(n, f"n = {n} (k = 0: wrinkling)")
        visible = (rows["rate"].abs() < MARGIN * scales["rate"]).any()
        rates.plot(rows["k"], rows["rate"], color=colour, label=name if visible else None)
        rates.plot(waves["k"], waves["rate"], "o", color=colour, markersize=3)
    rates.plot(
        fastest["k"], fastest["rate"], "o", color="black", markersize=5, label="fastest" if len(fastest) else None
    )
    for (column, name), colour in zip(FLOWS.items(), COLOURS, strict=False):
        flows.plot(shown["k"], shown[column] / scales[column], color=colour, label=name)
    _frame(rates, scales["rate"])
    _frame(flows, 1.0)
    wave = units.axis_label("k")
    dress(rates, wave, units.axis_label("rate", "growth rate in fluids"), title)
    dress(flows, wave, "growth rate by its largest", f"the same waves in three flows, n = {around}")
    for axes in (rates, flows):
        add_legend(axes, fontsize="small")
    note_unit(figure, units)
    return figure


def _scale(rates: pd.Series[float], growing: bool) -> float:
    """The largest rate where waves grow, else how fast they decay in the middle."""
    return float(rates.max() if growing else rates.abs().median())


def _frame(axes: Axes, largest: float) -> None:
    axes.axhline(0, color="0.4", linewidth=0.6)
    axes.set_ylim(-MARGIN * largest, MARGIN * largest)
