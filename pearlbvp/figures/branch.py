"""Picture of a branch: the diagrams that the paper draws, unstable parts dashed, and shapes along it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from scipy.interpolate import PchipInterpolator

from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.solution import Solution
from pearlbvp.figures.canvas import COLOURS, dress, new_figure, note_unit, own_style
from pearlbvp.figures.surface import along, place_surfaces
from pearlbvp.units import RADII, Units


def draw_curve(axes: Axes, table: pd.DataFrame, x: str, y: str, colour: str, label: str | None = None) -> None:
    """One branch in one diagram: stable parts solid, unstable parts dashed, special points marked."""
    stable = (table["n_unstable"] == 0).fillna(False).to_numpy(bool)
    infinite = table["special"].str.contains("cmc").to_numpy(bool)
    if len(table) == 1:  # the end of a flow
        axes.plot(table[x], table[y], "o", color=colour, markersize=4, label=label)
        return
    xs, ys = smooth(*(np.where(infinite & (name in INFINITE), np.nan, table[name].to_numpy(float)) for name in (x, y)))
    stable_stretches = np.repeat(stable[1:] & stable[:-1], BETWEEN)
    for wanted, style in ((True, "-"), (False, "--")):
        # A stretch between two points is stable where neither of its ends is unstable.
        pieces_x, pieces_y = _broken(xs, ys, stable_stretches == wanted)
        axes.plot(
            pieces_x,
            pieces_y,
            style,
            color=colour,
            linewidth=1.4,
            label=label if wanted == (stable.mean() > 0.5) else None,
        )
    for kind, marker, face in (("bp", "o", "white"), ("fold", "x", None)):
        rows = table[table["special"].str.contains(kind)]
        if len(rows):
            axes.plot(rows[x], rows[y], marker, color=colour, markerfacecolor=face or colour, markersize=5)


INFINITE = ("lambda1", "lambda2", "force")
"""Columns that are infinite at a surface of constant mean curvature; a number that stands there is rounding."""

BETWEEN = 12
"""Steps from one point of a branch to the next in a picture."""


def smooth(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A smooth curve through the points of a polygon, ``BETWEEN`` steps from each to the next, in the box of both.

    Both coordinates are monotone between neighbours as functions of the polygon's length (PCHIP), so that turning points stay
    where they were located. Where a value is missing or a point repeats, the curve is interrupted.
    """
    size = max(float(np.ptp(x[np.isfinite(x)])), 1e-300), max(float(np.ptp(y[np.isfinite(y)])), 1e-300)
    steps = np.hypot(np.diff(x) / size[0], np.diff(y) / size[1])
    points, part = np.column_stack((x, y)), np.arange(BETWEEN)[:, None] / BETWEEN
    pieces = points[:-1, None] + part * np.diff(points, axis=0)[:, None]
    breaks = np.concatenate(([-1], np.flatnonzero(~(steps > 1e-12)), [len(steps)]))
    for first, last in zip(breaks[:-1] + 1, breaks[1:], strict=True):
        if last - first > 1:
            at = np.concatenate(([0.0], np.cumsum(steps[first:last])))
            between = PchipInterpolator(at, points[first : last + 1])
            pieces[first:last] = between(at[:-1, None] + part.T * np.diff(at)[:, None])
    found = np.concatenate((pieces.reshape(-1, 2), points[-1:]))
    found[::BETWEEN] = points
    return found[:, 0], found[:, 1]


def _broken(x: np.ndarray, y: np.ndarray, wanted: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The wanted segments of a polygon as one line with gaps."""
    xs, ys = [np.nan], [np.nan]
    for i in np.flatnonzero(wanted):
        if xs[-1] != x[i] or ys[-1] != y[i]:
            xs += [np.nan, x[i]]
            ys += [np.nan, y[i]]
        xs.append(x[i + 1])
        ys.append(y[i + 1])
    return np.array(xs), np.array(ys)


def draw_shapes(axes: Axes, branch: Branch[Any], count: int = 4, units: Units = RADII) -> bool:
    """Outlines of some shapes along a branch, one period each, above one another; whether they are drawn to scale."""
    chosen = np.unique(np.linspace(0, len(branch.points) - 1, count).round().astype(int))
    height = 3.0 * units.to_user("r_max", max(branch.points[i].observables["r_max"] for i in chosen))
    for place, index in enumerate(chosen):
        point = branch.points[index]
        profile = point.problem.shapes.profile(point.u)
        x, r = (units.to_user(name, values) for name, values in zip("xr", profile.outline(), strict=True))
        colour = _curve_colour(branch.points[index])
        for side in (1, -1):
            axes.plot(x, side * r - place * height, color=colour, linewidth=1.2)
        axes.fill_between(x, r - place * height, -r - place * height, color=colour, alpha=0.12, linewidth=0)
        label = f"point {index}: v = {point.observables['v']:.4f}"
        axes.text(x[-1] / 2, -(place + 0.48) * height, label, ha="center", va="center", fontsize=8)
    axes.set_yticks([])
    return _to_scale(axes, -(len(chosen) - 0.3) * height)


def _to_scale(axes: Axes, lowest: float) -> bool:
    """One scale along and across, down to the lowest words, unless that would leave nothing to see; whether it is."""
    (left, right), high = axes.get_xlim(), axes.get_ylim()[1]
    axes.set_ylim(lowest, high)
    place, (wide, tall) = axes.get_position(), axes.figure.get_size_inches()  # type: ignore[union-attr]
    sides = (place.width * wide, place.height * tall)
    scales = (right - left) / sides[0], (high - lowest) / sides[1]
    if not 1 / STRETCHED < scales[0] / scales[1] < STRETCHED:
        return False
    reach = [max(scales) * side / 2 for side in sides]
    middle = (left + right) / 2, (lowest + high) / 2
    axes.set(xlim=(middle[0] - reach[0], middle[0] + reach[0]), ylim=(middle[1] - reach[1], middle[1] + reach[1]))
    return True


STRETCHED = 4.0
"""Ratio of the scales beyond which a picture is not drawn to one."""


def draw_sections(axes: Axes, branch: Branch[Any], count: int = 4, units: Units = RADII) -> None:
    """Cross-sections of some rings along a branch, side by side."""
    reach = 0.0
    width = 2.8 * units.to_user("r_max", max(entry.observables["r_max"] for entry in along(branch, count)))
    for place, entry in enumerate(along(branch, count)):
        section = entry.problem.shapes.section(entry.u, 0.0)
        y, z = (units.to_user(name, values) for name, values in zip("yz", section, strict=True))
        axes.plot(y + place * width, z, color=_curve_colour(entry), linewidth=1.2)
        reach = max(reach, float(np.abs(z).max()))
        label = f"v = {entry.observables['v']:.4f}"
        axes.text(place * width, -0.65 * width, label, ha="center", va="center", fontsize=8)
    axes.set_yticks(
        [tick for tick in MaxNLocator(2).tick_values(-reach, reach) if abs(tick) <= reach]
    )  # not beside words
    _to_scale(axes, -0.8 * width)


def _curve_colour(entry: Solution[Any]) -> str:
    return COLOURS[0] if entry.spectrum.stable else COLOURS[1]


@own_style()
def draw_branch(branch: Branch[Any], table: pd.DataFrame, title: str = "", units: Units = RADII) -> Figure:
    """Energy and pressure over the reduced volume, the two multipliers, and shapes.

    Args:
        branch: whose shapes are drawn.
        table: its rows.
        title: of the picture.
        units: of the table, and of the shapes as they are drawn.
    """
    figure, axes = new_figure(2, 2, width=9.5, height=7.5)
    varied = next((name for name in ("c0", "L") if np.ptp(table[name]) > 1e-9 * table[name].abs().max()), None)
    pairs = (("v", "E"), ("v", "lambda2"), ("lambda2", "lambda1"))
    if varied is not None:
        pairs = ((varied, "E"), (varied, "lambda2"), (varied, "v"))
    for place, (x, y) in zip(axes.ravel(), pairs, strict=False):
        draw_curve(place, table, x, y, COLOURS[0])
        dress(place, units.axis_label(x), units.axis_label(y), title if place is axes[0, 0] else "")
    problem = branch.points[0].problem.shapes
    if problem.drawn == "surface":
        figure.delaxes(axes[1, 1])
        points = along(branch)
        titles = [f"v = {point.observables['v']:.4f}" for point in points]
        place_surfaces(figure, (0.53, 0.02, 0.46, 0.42), points, titles, (2, 2))
        figure.text(0.76, 0.46, "shapes: stable blue, unstable brown", ha="center", fontsize=9)
    elif problem.drawn == "section":
        draw_sections(axes[1, 1], branch, units=units)
        beside = units.axis_label("y", "shapes beside one another, y")
        dress(axes[1, 1], beside, units.axis_label("z", "z"), "sections: stable blue, unstable brown")
    else:
        scale = "" if draw_shapes(axes[1, 1], branch, units=units) else ", not to scale"
        dress(axes[1, 1], units.axis_label("x"), "", f"shapes: stable blue, unstable brown{scale}")
    axes[0, 1].set_title("dashed: unstable; circles: branch points; crosses: folds", fontsize=9)
    note_unit(figure, units)
    return figure
