"""Picture of a bifurcation diagram: several branches in one plane, with shapes at their places."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure

from pearlbvp.arrays import Array
from pearlbvp.continuation.branch import Branch
from pearlbvp.dimensions import AXES
from pearlbvp.figures.branch import draw_curve
from pearlbvp.figures.canvas import FAMILIES, OTHERS, add_legend, dress, new_figure, note_unit, own_style
from pearlbvp.figures.places import covered, free_places
from pearlbvp.figures.surface import box_of, coarse, seen_points, show_surface, shown, tint
from pearlbvp.studies.diagram import curves, tubes_apart
from pearlbvp.studies.energies import Reference
from pearlbvp.studies.names import Name, names
from pearlbvp.units import RADII, Units

FEW = 6
"""Branches whose names fit into a picture; more stand beside it."""

SIGNS = "dashed: unstable; circles: branch points; crosses: folds"


@own_style()
def draw_plane(
    branches: Mapping[str, Branch[Any]],
    x: str = "v",
    y: str = "E",
    title: str = "",
    units: Units = RADII,
    *,
    reference: Reference | None = None,
    shapes: bool = False,
    called: bool = False,
) -> Figure:
    """Any two columns of several branches, unstable parts dashed, special points marked, named as people name them.

    Args:
        branches: by name.
        x, y: columns.
        title: of the picture.
        units: of the axes.
        reference: what energies are drawn above.
        shapes: whether some shapes are drawn at their places.
        called: whether branches stand in the legend by the names that they come with.

    Raises:
        InputError: the reference has none of the volumes.
    """
    table = curves(branches)
    table = units.columns(table if reference is None else reference.above(table))
    named, tubes = names(branches), tubes_apart(table, units)
    beside = len(branches) > FEW
    figure, axes = new_figure(1, 1, width=9.5 if beside or shapes else 7.0, height=5.6 if shapes else 4.8)
    colours = shades(named)
    for key, name in named.items():
        words = key if called else name
        label = f"{words}{chr(10) if beside else ' '}({tubes[key]})" if tubes else str(words)
        draw_curve(axes, table[table["branch"] == key], x, y, colours[key], label)
    across, up = (units.axis_label(name, None if name in AXES else name) for name in (x, y))
    if reference is not None:
        up = units.axis_label("E", reference.difference)
    dress(axes, across, up, title or SIGNS)
    note_unit(figure, units)
    if beside:
        figure.subplots_adjust(right=0.78)
        axes.legend(
            frameon=False, fontsize="x-small", loc="center left", bbox_to_anchor=(1.0, 0.5), ncols=1 + len(named) // 26
        )
    else:
        add_legend(axes, fontsize="small")
    if shapes:
        _add_shapes(axes, branches, table, (x, y), colours)
    return figure


def shades(named: Mapping[str, Name]) -> dict[str, str]:
    """A colour for each branch: that of its family, of several of one family from dark to light."""
    kinds = [name.kind for name in named.values()]
    done: dict[str, int] = dict.fromkeys(kinds, 0)
    found = {}
    for key, name in named.items():
        count, place = kinds.count(name.kind), done[name.kind]
        done[name.kind] += 1
        colour = np.array(to_rgb(FAMILIES.get(name.kind, OTHERS)))
        share = DARKEST + (LIGHTEST - DARKEST) * place / max(count - 1, 1) if count > 1 else 0.0
        found[key] = _hex(colour + abs(share) * ((share > 0) - colour))
    return found


DARKEST, LIGHTEST = -0.25, 0.5
"""Shares of black (negative) and white in the colours of the first and the last branch of a family."""


def _hex(colour: Array) -> str:
    red, green, blue = map(float, colour)
    return to_hex((red, green, blue))


# Shapes at their places.

MOST_SHAPES = 6
"""Shapes in a picture, about, unless there are more branches."""

LARGEST = (1.9, 1.2)
"""Width and height of the largest shape, in inches."""

SHARE = 0.32
"""Size of the largest shape by that of the axes, at most."""

FINENESS = 45
"""Cells an inch in which free places are sought."""

SMALLER, ROOM = 0.88, 0.12
"""Where no place is free, shapes become smaller, and the axes reach further."""

ATTEMPTS = 8


def _add_shapes(
    axes: Axes,
    branches: Mapping[str, Branch[Any]],
    table: pd.DataFrame,
    columns: tuple[str, str],
    colours: Mapping[str, str],
) -> None:
    """Surfaces of some points, each near its point, in the tint of its branch, all to one scale."""
    each = max(1, (MOST_SHAPES + len(branches) // 2) // len(branches))
    chosen = [
        (str(key), rows[[*columns]].to_numpy(float)[place], branches[str(key)].points[number])
        for key, rows in table.groupby("branch", sort=False)
        for place, number in _chosen(branches[str(key)], rows, columns, each)
    ]
    if not chosen:
        return
    surfaces = [coarse(shown(point)) for *_, point in chosen]
    boxes = np.array([box_of([surface]) for surface in surfaces])
    inches = np.array(axes.get_window_extent().size) / axes.figure.dpi
    scale = min(np.minimum(LARGEST, SHARE * inches) / (2 * boxes.max(axis=0)))
    at = np.array([place for _, place, _ in chosen])
    found = _free(axes, at, surfaces, boxes, scale)
    for _ in range(ATTEMPTS):
        if None not in found:
            break
        scale *= SMALLER
        low, high = axes.get_ylim()
        axes.set_ylim(low - ROOM * (high - low), high + ROOM * (high - low))
        found = _free(axes, at, surfaces, boxes, scale)
    for (key, place, _), surface, box, corner in zip(chosen, surfaces, boxes, found, strict=True):
        if corner is not None:
            _add_shape(axes, surface, (float(box[0]), float(box[1])), scale, corner, place, colours[key])


def _chosen(branch: Branch[Any], rows: pd.DataFrame, columns: tuple[str, str], count: int) -> list[tuple[int, int]]:
    """Rows of points whose shapes are drawn, and their numbers: the last, and others at equal distances along the curve."""
    at = rows[[*columns]].to_numpy(float)
    known = (rows["point"] % 1 == 0).to_numpy() & np.isfinite(at).all(axis=1)
    plain = known & ~rows["special"].str.contains("bp|fold").to_numpy()  # whose signs a dot would hide
    known = np.flatnonzero(plain if plain.any() else known)
    if not len(known):
        return []
    size = np.maximum(np.ptp(at[known], axis=0), 1e-300)
    ways = np.append(0.0, np.cumsum(np.hypot(*(np.diff(at[known], axis=0) / size).T)))
    wanted = ways[-1] * (1 - np.arange(count) / count)
    places = dict.fromkeys(int(np.abs(ways - way).argmin()) for way in wanted)
    return [(int(known[i]), round(float(rows["point"].iloc[known[i]]))) for i in places]


def _free(axes: Axes, at: Array, surfaces: list[Any], boxes: Array, scale: float) -> list[tuple[int, int] | None]:
    """Lower left corners, in cells of the axes, of the boxes of surfaces at a scale in inches."""
    figure = axes.figure
    FigureCanvasAgg(figure).draw()  # type: ignore[arg-type]  # which places the legend
    inches = np.array(axes.get_window_extent().size) / figure.dpi
    cells = np.ceil(FINENESS * inches).astype(int)

    def in_cells(points: Array) -> Array:
        return np.asarray(axes.transAxes.inverted().transform(axes.transData.transform(points)) * cells)

    lines: list[Array] = []
    for line in axes.lines:
        points = in_cells(np.column_stack([np.asarray(values, dtype=float) for values in line.get_data()]))
        lines += [points] if line.get_linestyle() != "None" else [np.stack((point, point)) for point in points]
    taken = covered((int(cells[0]), int(cells[1])), lines)
    legend = axes.get_legend()
    if legend is not None:
        corners = axes.transAxes.inverted().transform(legend.get_window_extent().get_points()) * cells
        low, high = np.clip(np.floor(corners), 0, cells).astype(int)
        taken[low[0] : high[0] + 1, low[1] : high[1] + 1] = True
    sizes = [(int(w), int(h)) for w, h in np.ceil(FINENESS * 2 * scale * boxes)]
    seen = [
        np.unique(np.floor(FINENESS * scale * (seen_points(surface) + box)), axis=0)
        for surface, box in zip(surfaces, boxes, strict=True)
    ]
    return free_places(taken, sizes, [(float(x), float(y)) for x, y in in_cells(at)], seen)


def _add_shape(
    axes: Axes,
    surface: Any,
    box: tuple[float, float],
    scale: float,
    corner: tuple[int, int],
    at: Array,
    colour: str,
) -> None:
    """One surface at its place, a dot at its point, and a thin line between them."""
    figure = axes.figure
    inches = np.array(axes.get_window_extent().size) / figure.dpi
    size = 2 * scale * np.array(box) / inches  # in shares of the axes
    low = np.array(corner) / np.ceil(FINENESS * inches)
    place = axes.get_position()
    share = np.array([place.width, place.height])
    inset = figure.add_axes((*(np.array([place.x0, place.y0]) + low * share), *(size * share)))
    show_surface(inset, surface, box, tint(colour))
    own = axes.transAxes.inverted().transform(axes.transData.transform(at))
    seen = low + size * (0.5 + seen_points(surface) / (2 * np.array(box)))
    near = seen[np.hypot(*((seen - own) * inches).T).argmin()]
    axes.annotate(
        "", (at[0], at[1]), (near[0], near[1]), xycoords="data", textcoords="axes fraction",
        arrowprops={"arrowstyle": "-", "color": "0.55", "linewidth": 0.7, "shrinkA": 0, "shrinkB": 0},
    )  # fmt: skip
    axes.plot(*at, "o", color=colour, markersize=3.5)
