"""Picture of a branch: the diagrams that the paper draws, unstable parts dashed, and shapes along it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.solution import Solution
from pearlbvp.figures.canvas import COLOURS, dress, em, new_figure, note_unit, own_style
from pearlbvp.figures.surface import place_surfaces, some_of
from pearlbvp.studies.branch import curve
from pearlbvp.studies.energies import Reference
from pearlbvp.units import RADII, Units


def draw_curve(axes: Axes, table: pd.DataFrame, x: str, y: str, colour: str, label: str | None = None) -> None:
    """One branch in one diagram: stable parts solid, unstable parts dashed, special points marked.

    Args:
        axes: where to draw.
        table: rows so near to each other that lines between them will do (``studies.branch.curve``).
        x, y: columns.
        colour, label: of the branch.
    """
    if len(table) == 1:  # the end of a flow
        axes.plot(table[x], table[y], "o", color=colour, markersize=4, label=label)
        return
    stable = (table["n_unstable"] == 0).fillna(False).to_numpy(bool)
    stretches = stable[1:] & stable[:-1]
    xs, ys = (
        np.where(_beside_infinity(table) & (name in INFINITE), np.nan, table[name].to_numpy(float)) for name in (x, y)
    )
    for wanted, style in ((True, "-"), (False, "--")):
        # A stretch between two rows is stable where neither of its ends is unstable.
        axes.plot(*_broken(xs, ys, stretches == wanted), style, color=colour)
    if label is not None:
        axes.plot([], [], color=colour, label=label)
    if "special" not in table:
        return
    for kind, marker, face in (("bp", "o", "white"), ("fold", "x", None)):
        rows = table[table["special"].str.contains(kind)]
        if len(rows):
            axes.plot(rows[x], rows[y], marker, color=colour, markerfacecolor=face or colour, markersize=5, mew=1)


INFINITE = ("lambda1", "lambda2", "force")
"""Columns that are infinite at a surface of constant mean curvature; a number that stands there is rounding."""


def _beside_infinity(table: pd.DataFrame) -> np.ndarray:
    """Which rows lie less than a point from one of constant mean curvature."""
    if "special" not in table or "point" not in table:
        return np.zeros(len(table), dtype=bool)
    points = table["point"].to_numpy(float)
    infinite = points[table["special"].str.contains("cmc").to_numpy(bool)]
    return np.asarray((np.abs(points[:, None] - infinite) < 1).any(axis=1))


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
    """Outlines of some shapes along a branch, on the whole tube, above one another; whether they are drawn to scale."""
    chosen = np.unique(np.linspace(0, len(branch.points) - 1, count).round().astype(int))
    height = 3.0 * units.to_user("r_max", max(branch.points[i].observables["r_max"] for i in chosen))
    for place, index in enumerate(chosen):
        point = branch.points[index]
        whole = point.problem.shapes.curve(point.u, SAMPLES)
        x, r = (units.to_user(name, whole[name]) for name in "xr")
        colour = _curve_colour(branch.points[index])
        for side in (1, -1):
            axes.plot(x, side * r - place * height, color=colour)
        axes.fill_between(x, r - place * height, -r - place * height, color=colour, alpha=0.12, linewidth=0)
        label = f"point {index}: v = {point.observables['v']:.4f}"
        axes.text(x[-1] / 2, -(place + 0.48) * height, label, ha="center", va="center", fontsize="small")
    axes.set_yticks([])
    return _to_scale(axes, -(len(chosen) - 0.3) * height, height)


def _to_scale(axes: Axes, lowest: float, row: float = np.inf) -> bool:
    """One scale along and across, down to the lowest words, unless that would leave nothing to see; whether it is.

    Args:
        axes: of the shapes.
        lowest: where the words end.
        row: height of one of several rows, each with words.
    """
    (left, right), high = axes.get_xlim(), axes.get_ylim()[1]
    axes.set_ylim(lowest, high)
    place, (wide, tall) = axes.get_position(), axes.figure.get_size_inches()  # type: ignore[union-attr]
    sides = (place.width * wide, place.height * tall)
    scales = (right - left) / sides[0], (high - lowest) / sides[1]
    if not 1 / STRETCHED < scales[0] / scales[1] < STRETCHED or row / max(scales) < ROW * em():
        return False
    reach = [max(scales) * side / 2 for side in sides]
    middle = (left + right) / 2, (lowest + high) / 2
    axes.set(xlim=(middle[0] - reach[0], middle[0] + reach[0]), ylim=(middle[1] - reach[1], middle[1] + reach[1]))
    return True


ROW = 3.0
"""Height of a row with a shape and words, by the font's size."""

SAMPLES = 200
"""Steps of a period of an outline."""

STRETCHED = 4.0
"""Ratio of the scales beyond which a picture is not drawn to one."""


def draw_sections(axes: Axes, branch: Branch[Any], count: int = 4, units: Units = RADII) -> None:
    """Cross-sections of some rings along a branch, side by side."""
    reach = 0.0
    width = 2.8 * units.to_user("r_max", max(entry.observables["r_max"] for entry in some_of(branch, count)))
    for place, entry in enumerate(some_of(branch, count)):
        section = entry.problem.shapes.section(entry.u, 0.0)
        y, z = (units.to_user(name, values) for name, values in zip("yz", section, strict=True))
        axes.plot(y + place * width, z, color=_curve_colour(entry))
        reach = max(reach, float(np.abs(z).max()))
        label = f"v = {entry.observables['v']:.4f}"
        axes.text(place * width, -0.65 * width, label, ha="center", va="center", fontsize="small")
    axes.set_yticks(
        [tick for tick in MaxNLocator(2).tick_values(-reach, reach) if abs(tick) <= reach]
    )  # not beside words
    _to_scale(axes, -0.8 * width)


def _curve_colour(entry: Solution[Any]) -> str:
    return COLOURS[0] if entry.spectrum.stable else COLOURS[1]


def along(branch: Branch[Any]) -> str:
    """What varies along a branch, to be drawn to the right: ``c0``, ``L``, or else ``v``."""
    for name in ("c0", "L"):
        values = np.array([point.observables[name] for point in branch.points])
        if np.ptp(values) > 1e-9 * np.abs(values).max():
            return name
    return "v"


@own_style()
def draw_branch(
    branch: Branch[Any], title: str = "", units: Units = RADII, *, reference: Reference | None = None
) -> Figure:
    """Energy and pressure over the reduced volume, the two multipliers, and shapes.

    Args:
        branch: of any family.
        title: of the picture.
        units: of the axes, and of the shapes as they are drawn.
        reference: what energies are drawn above.

    Raises:
        InputError: the reference has none of the volumes.
    """
    table = curve(branch)
    table = units.columns(table if reference is None else reference.above(table))
    figure, axes = new_figure(2, 2, width=9.5, height=7.5)
    x = along(branch)
    last = ("lambda2", "lambda1") if x == "v" else (x, "v")
    pairs = ((x, "E"), (x, "lambda2"), last)
    for place, (x, y) in zip(axes.ravel(), pairs, strict=False):
        draw_curve(place, table, x, y, COLOURS[0])
        up = units.axis_label(y, None if reference is None or y != "E" else reference.difference)
        dress(place, units.axis_label(x), up, title if place is axes[0, 0] else "")
    problem = branch.points[0].problem.shapes
    if problem.drawn == "surface":
        figure.delaxes(axes[1, 1])
        points = some_of(branch)
        titles = [f"v = {point.observables['v']:.4f}" for point in points]
        place_surfaces(figure, (0.53, 0.02, 0.46, 0.42), points, titles, (2, 2))
        figure.text(0.76, 0.46, "shapes: stable blue, unstable brown", ha="center", fontsize="small")
    elif problem.drawn == "section":
        draw_sections(axes[1, 1], branch, units=units)
        beside = units.axis_label("y", "shapes beside one another, y")
        dress(axes[1, 1], beside, units.axis_label("z", "z"), "sections: stable blue, unstable brown")
    else:
        scale = "" if draw_shapes(axes[1, 1], branch, units=units) else ", not to scale"
        dress(axes[1, 1], units.axis_label("x"), "", f"shapes: stable blue, unstable brown{scale}")
    axes[0, 1].set_title("dashed: unstable; circles: branch points; crosses: folds", fontsize="small")
    note_unit(figure, units)
    return figure
