"""The paper's panels, drawn from their data."""

from __future__ import annotations

from collections.abc import Mapping
from functools import singledispatch
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pearlbvp.arrays import Array
from pearlbvp.continuation.solution import Solution
from pearlbvp.figures.branch import draw_curve
from pearlbvp.figures.canvas import COLOURS, add_legend, dress, new_blank, new_figure, own_style
from pearlbvp.figures.flow import draw_flow
from pearlbvp.figures.surface import box_of, show_surface, shown, stability
from pearlbvp.paper.sheet import Course, Curves, Panel, Rates, Regions, Sectors, Shapes
from pearlbvp.studies.displacement import normal_displacement
from pearlbvp.units import RADII

REACH = 3.0
"""Pressures that the regions of instability show."""

WAVES = {0: "n = 0: pearling", 1: "n = 1: coiling, buckling", 2: "n = 2 (k = 0: wrinkling)"}


@own_style()
def draw_panel(panel: Panel, title: str = "") -> Figure:
    """One panel as a figure of its own."""
    return _drawn(panel, title)


@singledispatch
def _drawn(panel: Any, title: str) -> Figure:
    raise TypeError(type(panel).__name__)


@_drawn.register
def _(panel: Curves, title: str) -> Figure:
    figure, axes = new_figure()
    for colour, (name, table) in zip(COLOURS, panel.branches.items(), strict=False):
        draw_curve(axes, table, panel.x, panel.y, colour, name)
        if name in panel.predicted:
            line = panel.predicted[name]
            axes.plot(line[panel.x], line[panel.y], "*-", color=colour, linewidth=0.7, markersize=4, markevery=4,
                      label=f"{name}, amplitude equation")  # fmt: skip
    for name, point in panel.samples.items():
        place = point.observables[panel.x], point.observables[panel.y]
        axes.plot(*place, "s", color="black", markersize=4)
        axes.annotate(name, place, xytext=(5, 5), textcoords="offset points", fontsize="small")
    dress(axes, RADII.axis_label(panel.x, panel.x), RADII.axis_label(panel.y, panel.y), title or "dashed: unstable")
    add_legend(axes, fontsize="small")
    return figure


@_drawn.register
def _(panel: Shapes, title: str) -> Figure:
    columns = min(4, len(panel.samples))
    rows = -(-len(panel.samples) // columns)
    figure = new_blank(2.7 * columns, 1.9 * rows + 0.3)
    surfaces = {name: shown(point) for name, point in panel.samples.items()}
    seen = box_of(list(surfaces.values()))
    width, height = 1 / columns, 1.9 / (1.9 * rows + 0.3)
    for i, (name, surface) in enumerate(surfaces.items()):
        point = panel.samples[name]
        left, bottom = (i % columns) * width, (rows - 1 - i // columns) * height
        axes = figure.add_axes((left + 0.03 * width, bottom + 0.03 * height, 0.94 * width, 0.82 * height))
        show_surface(axes, surface, seen, _colours(point))
        figure.text(
            left + width / 2,
            bottom + 0.87 * height,
            f"{name}: v = {point.observables['v']:.4g}, {stability(point)}",
            fontsize="small",
            ha="center",
        )
    figure.text(
        0.5,
        1 - 0.18 / (1.9 * rows + 0.3),
        title or "blue moves outwards along the branch, yellow inwards",
        fontsize="small",
        ha="center",
    )
    return figure


def _colours(point: Solution[Any]) -> Array:
    """Red, green and blue of the faces, by the displacement in the middle of each: from blue, outwards, to yellow, inwards."""
    u = normal_displacement(point)
    middle = (u[:-1, :-1] + u[1:, :-1] + u[1:, 1:] + u[:-1, 1:]) / 4
    shares = (middle.ravel() / max(float(np.abs(middle).max()), 1e-300) + 1) / 2
    return np.asarray(colormaps["cividis"](shares))[:, :3]


@_drawn.register
def _(panel: Regions, title: str) -> Figure:
    figure, axes = new_figure(width=4.6, height=3.8)
    for n, colour in zip(WAVES, COLOURS, strict=False):
        rows = panel.curves[panel.curves["n"] == n]
        k, curve = rows["k"].to_numpy(float), rows["lambda2"].to_numpy(float)
        # A wave is unstable above its curve where k^2 + n^2 > 1, below it elsewhere.
        edge = np.where(k**2 + n**2 > 1, REACH, -REACH)
        axes.fill_between(k, curve, edge, color=colour, alpha=0.15, linewidth=0)
        axes.plot(k, np.where(np.abs(curve) < 2 * REACH, curve, np.nan), color=colour, label=WAVES[n])
    axes.axhline(1.5, color=COLOURS[3], linewidth=0.8, label="wrinkling (0,2)")
    axes.set(ylim=(-REACH, REACH), xlim=(0, float(panel.curves["k"].max())))
    dress(axes, "wave number k", "pressure lambda2", title or f"c0 = {panel.c0:g}; shaded: unstable")
    add_legend(axes, fontsize="x-small")
    return figure


@_drawn.register
def _(panel: Rates, title: str) -> Figure:
    cases = list(panel.rates["case"].unique())
    rows = -(-len(cases) // 2)
    figure, places = new_figure(rows, min(2, len(cases)), width=8.0 if len(cases) > 1 else 4.6, height=2.6 * rows + 0.8)
    for axes, case in zip(np.atleast_1d(places).ravel(), cases, strict=False):
        _draw_rates(axes, panel, case)
    add_legend(np.atleast_1d(places).ravel()[0], fontsize="x-small")
    figure.subplots_adjust(hspace=0.5)
    return figure


def _draw_rates(axes: Axes, panel: Rates, case: str) -> None:
    here = panel.rates[panel.rates["case"] == case]
    for n, colour in enumerate(COLOURS[: int(here["n"].max()) + 1]):
        rows = here[here["n"] == n]
        axes.plot(rows["k"], rows["mu"], color=colour, label=f"n = {n}")
        axes.fill_between(rows["k"], 0, rows["mu"].clip(lower=0), color=colour, alpha=0.15, linewidth=0)
    axes.axhline(0, color="black", linewidth=0.6)
    axes.set_ylim(-1, max(0.5, 1.1 * float(here["mu"].max())))
    dress(axes, "wave number k", "growth rate mu", case)


@_drawn.register
def _(panel: Sectors, title: str) -> Figure:
    figure, axes = new_figure(width=5.6, height=5.2)
    axes.set(xlim=(-1.4, 1.4), ylim=(-1.4, 1.4), aspect="equal")
    axes.spines[:].set_visible(False)
    for angle in np.deg2rad(45 * np.arange(4)):
        axes.plot(
            [-1.3 * np.cos(angle), 1.3 * np.cos(angle)],
            [-1.3 * np.sin(angle), 1.3 * np.sin(angle)],
            "k-",
            linewidth=0.6,
        )
    for sector in panel.sectors.to_dict("records"):
        _draw_scheme(axes, sector)
    axes.set(xticks=[], yticks=[], xlabel="b1", ylabel="b2")
    axes.set_title(title or "brown: coils, green: buckles; solid: stable (amplitude over lambda2)", fontsize="small")
    return figure


def _draw_scheme(axes: Axes, sector: Mapping[Any, Any]) -> None:
    """Both branches of a sector as parabolas from their branch point."""
    x, y = sector["b1"], sector["b2"]
    axes.plot([x - 0.24, x + 0.24], [y - 0.15, y - 0.15], color="black", linewidth=0.8)
    s = np.linspace(0, 1, 30)
    for family, way, height in (("coil", sector["coils"], 0.3), ("buckle", sector["buckles"], 0.22)):
        to = 1 if way == "supercritical" else -1
        axes.plot(x + to * 0.22 * s, y - 0.15 + height * np.sqrt(s), color=COLOURS[1 if family == "coil" else 2],
                  linestyle="-" if sector["stable"] == family else "--", linewidth=1.6)  # fmt: skip


@_drawn.register
def _(panel: Course, title: str) -> Figure:
    return draw_flow(panel.result.state, panel.table(), title)
