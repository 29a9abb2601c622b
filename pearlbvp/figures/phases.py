"""Picture of the shapes that a tube takes: energies above the least, which shape that is, and what it looks like."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from pearlbvp.continuation.solution import Solution
from pearlbvp.errors import InputError
from pearlbvp.figures.canvas import COLOURS, dress, new_figure, note_unit, own_style
from pearlbvp.figures.surface import PLAIN, box_of, show_surface, shown, tint
from pearlbvp.studies.names import name_of
from pearlbvp.units import RADII, Units

if TYPE_CHECKING:
    from pearlbvp.studies.phases import Phases

ABOVE = 1.5
"""Height of the picture of energies, by the largest excess of a stable shape, or of every other branch."""

WIDTH, HEIGHT = 9.5, 6.2
"""Size in inches."""

LEFT, RIGHT = 0.11, 0.78
"""Sides of the axes, in shares of the figure; names stand at the right."""

LETTERS = 25
"""Of a line beside the axes."""

MOST_NAMED = 16
"""Branches that have a line in the legend: the stable ones first."""

NARROWEST = 0.08
"""Share of the range that has room for its name, and for a picture of its shape."""


@own_style()
def draw_phases(found: Phases, units: Units = RADII) -> Figure:
    """Energies above the least over the volume, stable parts solid; a strip that says which shape is the least; shapes.

    Args:
        found: from ``studies.phases``.
        units: in which it is labelled.

    Raises:
        InputError: it has one volume only.
    """
    if found.ranges.empty:
        raise InputError("plot", "one volume makes no picture", "give several, like 0.9:1.1:0.01")
    figure, (above, strip) = new_figure(
        2, 1, width=WIDTH, height=HEIGHT, sharex=True, gridspec_kw={"height_ratios": [12, 1]}
    )
    figure.subplots_adjust(left=LEFT, right=RIGHT, top=0.93, bottom=0.3, hspace=0.08)
    curves = units.columns(found.curves)
    colours = _colours(curves)
    _draw_energies(above, curves, colours, {name: str(name_of(branch)) for name, branch in found.branches.items()})
    tube = [f"{units.symbol(name)} = {units.named(name, value):.6g}" for name, value in vars(found.tube).items()]
    dress(
        above, "", units.axis_label("E", "E/A above the least"), f"{', '.join(tube)}; solid: stable, dashed: unstable"
    )
    _draw_strip(strip, found.ranges, colours)
    dress(strip, units.axis_label("v"), "")
    strip.grid(False)
    _draw_shapes(figure, found, colours)
    note_unit(figure, units)
    handles, names = above.get_legend_handles_labels()
    above.legend(
        handles[:MOST_NAMED],
        names[:MOST_NAMED],
        frameon=False,
        fontsize="small",
        loc="upper left",
        bbox_to_anchor=(1.01, 1.0),
    )
    return figure


def _colours(curves: pd.DataFrame) -> dict[str, str]:
    """Colours by name, those of the branches with stable parts first."""
    stable = curves["stable"].astype(bool)
    names = list(dict.fromkeys([*curves.loc[stable, "branch"], *curves["branch"]]))
    several = colormaps["turbo"].resampled(len(names) + 2)
    return {name: COLOURS[i] if i < len(COLOURS) else to_hex(several(i + 1)) for i, name in enumerate(names)}


def _draw_energies(axes: Axes, curves: pd.DataFrame, colours: Mapping[str, str], words: Mapping[str, str]) -> None:
    for name, colour in colours.items():
        rows = curves[curves["branch"] == name]
        named = False
        for stable, style in ((True, "-"), (False, "--")):
            part = rows[rows["stable"] == stable]
            if part["v"].notna().any():
                label = None if named else textwrap.fill(f"{name}: {words[name]}" if name in words else name, LETTERS)
                axes.plot(part["v"], part["excess"], style, color=colour, linewidth=1.5 if stable else 1.0, label=label)
                named = True
    highest = curves.groupby("branch")["excess"].max()
    stable = curves.loc[curves["stable"].astype(bool), "excess"].max()
    top = ABOVE * max(float(highest.median()), float(stable))
    if top > 0:
        axes.set_ylim(-0.04 * top, top)


def _draw_strip(axes: Axes, ranges: pd.DataFrame, colours: Mapping[str, str]) -> None:
    """Which shape is the least."""
    whole = ranges["high"].max() - ranges["low"].min()
    for low, high, name in ranges.itertuples(index=False):
        axes.axvspan(low, high, color=colours.get(name, "white"), alpha=0.45, linewidth=0)
        if high - low > NARROWEST * whole:
            axes.text((low + high) / 2, 0.5, name or "none found", ha="center", va="center", fontsize="small")
    for place in ranges["low"].iloc[1:]:
        axes.axvline(place, color="black", linewidth=0.8)
    axes.set(xlim=(ranges["low"].min(), ranges["high"].max()), ylim=(0, 1), yticks=[])


def _draw_shapes(figure: Figure, found: Phases, colours: Mapping[str, str]) -> None:
    """The least shapes below the strip, each under the middle of its range and in its tint, all to one scale."""
    chosen: list[tuple[float, str, Solution[Any]]] = []
    whole = found.ranges["high"].max() - found.ranges["low"].min()
    for low, high, name in found.ranges.itertuples(index=False):
        wanted = [solution for (_, shape), solution in found.solutions.items() if shape == name]
        points = wanted + (found.branches[name].points if name in found.branches else [])
        inside = {point.observables["v"]: point for point in points if low <= point.observables["v"] <= high}
        if inside and high - low > NARROWEST * whole:
            v = min(inside, key=lambda v: abs(v - (low + high) / 2))
            chosen.append((v, name, inside[v]))
    if not chosen:
        return
    surfaces = [shown(solution) for *_, solution in chosen]
    seen = box_of(surfaces)
    start, span = float(found.ranges["low"].min()), RIGHT - LEFT
    width = min(0.3, span / len(chosen))
    places = [LEFT + span * (v - start) / whole - width / 2 for v, *_ in chosen]
    for i, place in enumerate(places):  # side by side, in order
        places[i] = max(place, places[i - 1] + width if i else 0.01)
    for (v, name, _), surface, place in zip(chosen, surfaces, places, strict=True):
        axes = figure.add_axes((place, 0.03, width, 0.15))
        show_surface(axes, surface, seen, tint(colours[name]) if name in colours else PLAIN)
        figure.text(place + width / 2, 0.01, f"{name}, v = {v:.6g}", fontsize="small", ha="center")
