"""Pictures of amplitude equations: predicted branches over computed ones, and maps of instabilities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from pearlbvp.figures.branch import draw_curve
from pearlbvp.figures.canvas import COLOURS, LETTER, add_legend, dress, new_figure, note_unit, own_style
from pearlbvp.units import RADII, Units


@own_style()
def draw_prediction(
    predicted: Mapping[str, pd.DataFrame], computed: pd.DataFrame | None, title: str = "", units: Units = RADII
) -> Figure:
    """Energy, pressure and wave ``2 A`` over the volume: predicted branches as lines, a computed one as points.

    Args:
        predicted: tables of predicted branches by name.
        computed: table of a computed one, drawn as far as the predictions go.
        title: of the picture.
        units: of the tables.
    """
    figure, (left, right, last) = new_figure(1, 3, width=13.5)
    for i, (name, table) in enumerate(predicted.items()):
        colour = COLOURS[i % len(COLOURS)]
        draw_curve(left, table, "v", "E", colour, f"{name}, predicted")
        draw_curve(right, table, "v", "lambda2", colour)
        draw_curve(last, table, "v", "wave", colour)
    if computed is not None:
        volumes = np.concatenate([table["v"].to_numpy(float) for table in predicted.values()])
        near = computed[computed["v"].between(volumes.min(), volumes.max())]
        left.plot(near["v"], near["E"], ".", color="black", label="computed")
        right.plot(near["v"], near["lambda2"], ".", color="black")
        if "wave" in near:
            last.plot(near["v"], near["wave"], ".", color="black")
    dress(left, units.axis_label("v"), units.axis_label("E"), title)
    dress(right, units.axis_label("v"), units.axis_label("lambda2"), "dashed: unstable at fixed area and volume")
    dress(last, units.axis_label("v"), units.axis_label("wave", "wave 2A"))
    add_legend(left, fontsize="small")
    note_unit(figure, units)
    return figure


@own_style()
def draw_map(table: pd.DataFrame, exchange: pd.DataFrame, units: Units = RADII) -> Figure:
    """Which mode destabilizes the tube over ``c0`` and ``L``, at the lower and the upper end of its stable interval.

    Args:
        table: from ``studies.amplitude.instability_map``, on a full grid.
        exchange: from ``studies.amplitude.exchange_curve``: where coils and buckles exchange stability.
        units: of both tables.
    """
    figure, (left, right) = new_figure(1, 2, width=10.5, height=4.6)
    lower = table["lower_mode"] + np.where(table["lower_criticality"] == "subcritical", " sub", "")
    _draw_cells(left, table, lower)
    title = "lower end: mode m:n that destabilizes (sub: subcritical)"
    dress(left, units.axis_label("c0"), units.axis_label("L"), title)
    upper = table["upper_mode"] + " " + table["stable"]
    visible = exchange[exchange["L"].between(table["L"].min(), table["L"].max())]
    _draw_cells(right, table, upper, visible[["c0", "L"]].to_numpy(float))
    right.plot(visible["c0"], visible["L"], "k.", markersize=3)
    dress(
        right,
        units.axis_label("c0"),
        "",
        "upper end: mode m:n, and the family stable at onset\ndots: coils and buckles (1,1) exchange stability",
    )
    note_unit(figure, units)
    return figure


PAPER = {"facecolor": "white", "alpha": 0.6, "linewidth": 0, "pad": 1}
"""What words are written on."""


NO_DOTS = np.zeros((0, 2))


def _draw_cells(axes: Axes, table: pd.DataFrame, words: pd.Series, dots: np.ndarray = NO_DOTS) -> None:
    """A grid coloured by a word for each cell, with the word written in the middle of its region, beside dots (``c0, L``)."""
    grid = pd.DataFrame({"c0": table["c0"], "L": table["L"], "word": words.str.strip()})
    names = [name for name in grid["word"].value_counts().index if name]
    cells = grid.pivot(index="L", columns="c0", values="word")
    codes = np.array([[names.index(word) if word in names else np.nan for word in row] for row in cells.to_numpy()])
    palette = [
        "#cfe2f3",
        "#fce5cd",
        "#d9ead3",
        "#ead1dc",
        "#fff2cc",
        "#e0e0e0",
        "#b4c7dc",
        "#f4b183",
        "#a9d08e",
        "#d5a6bd",
    ]
    colours = [palette[i % len(palette)] for i in range(max(len(names), 1))]
    axes.pcolormesh(
        cells.columns,
        cells.index,
        codes,
        cmap=ListedColormap(colours),
        vmin=-0.5,
        vmax=len(colours) - 0.5,
        shading="nearest",
    )
    _write_names(axes, cells, codes, names, dots)


def _write_names(axes: Axes, cells: pd.DataFrame, codes: np.ndarray, names: Sequence[str], dots: np.ndarray) -> None:
    """The word of each region where it covers least of others, near the middle of its own, and no word written before.

    In a region that is narrow it is written upwards.
    """
    x, y = cells.columns.to_numpy(float), cells.index.to_numpy(float)
    size = rcParams["font.size"] * SMALL / 72
    an_inch = np.array(codes.shape) / (
        np.array(axes.get_window_extent().size)[::-1] / axes.figure.dpi
    )  # cells, y and x
    written = np.zeros(codes.shape, dtype=bool)
    for c0, length in dots:
        written[np.abs(y - length).argmin(), np.abs(x - c0).argmin()] = True
    for code, name in enumerate(names):
        own = codes == code
        if own.sum() <= LEAST * codes.size:
            continue
        letters, middle = size * LETTER * len(name), np.median(np.argwhere(own), axis=0)
        half = {0: an_inch * (size, letters) / 2, 90: an_inch * (letters, size) / 2}  # of the word's height and width

        def badness(turned: int, at: np.ndarray, half=half, own=own, middle=middle) -> float:  # type: ignore[no-untyped-def]
            part = _part(at, half[turned])
            outside = (at < half[turned] - 0.5).any() or (at > np.array(codes.shape) - half[turned] - 0.5).any()
            away = np.abs((at - middle) / codes.shape).sum()
            return float(9 * written[part].mean() + 9 * outside + 3 * (1 - own[part].mean()) + away + 0.003 * turned)

        turned, at = min(
            ((turned, at) for turned in half for at in np.argwhere(own)), key=lambda place: badness(*place)
        )
        written[_part(at, half[turned] + 1)] = True
        axes.text(x[at[1]], y[at[0]], name, ha="center", va="center", fontsize="x-small", bbox=PAPER, rotation=turned)


def _part(at: np.ndarray, half: np.ndarray) -> tuple[slice, slice]:
    """The cells under a word, as far as there are any."""
    low, high = np.round(at - half).astype(int), np.round(at + half).astype(int) + 1
    return slice(max(low[0], 0), high[0]), slice(max(low[1], 0), high[1])


LEAST = 0.004
"""Share of a map from which on a region has its name written."""

SMALL = 0.694
"""Size of the words on a map by the font's."""
