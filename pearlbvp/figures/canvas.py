"""One look for all pictures, whatever a user's settings of matplotlib are, and how they reach the disk.

Figures belong to no window system: ``pyplot`` and its backends are never asked. They are made in ``own_style`` and written by
the canvas of the file's format.
"""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context, rcParams, rcParamsDefault
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from pearlbvp.units import Units

COLOURS = ("#0b5394", "#c55a11", "#38761d", "#741b47", "#7f6000", "#444444", "#2a8c8c", "#c2487e")
"""Dark enough for print, distinct without colour vision in this order."""

DPI = 130
"""Dots an inch of pictures."""

OWN: dict[Any, Any] = {"svg.hashsalt": "pearlbvp"}
"""Settings that are not matplotlib's defaults: without salt the names in an SVG file are another in every run."""

CANVASES = {"pdf": ("pdf", "Pdf"), "svg": ("svg", "SVG"), "eps": ("ps", "PS"), "ps": ("ps", "PS")}
"""Backend and canvas of formats that are no images; all others are drawn by Agg."""

RIGHT, NOTE = 0.3, 0.1
"""Margin at the right of the axes, and between what is noted there and the edge, in inches."""

WIDEST_NUMBER = 0.6
"""Room for a number on the horizontal axis, in inches."""

UNDATED = {"pdf": {"CreationDate": None}, "svg": {"Date": None}}
"""Metadata without the time, so that the same picture is the same file."""


@contextmanager
def own_style() -> Iterator[None]:
    """Matplotlib's defaults and our own settings, for a while: those of a user's session or ``matplotlibrc`` say nothing."""
    with rc_context():
        with warnings.catch_warnings(action="ignore"):  # of settings that a release is about to drop
            settings: dict[Any, Any] = dict(rcParamsDefault)
            rcParams.update({name: value for name, value in settings.items() if name != "backend"} | OWN)
        yield


@own_style()
def new_figure(
    rows: int = 1, columns: int = 1, *, width: float = 7.0, height: float = 4.2, **options: Any
) -> tuple[Figure, Any]:
    """A figure that belongs to no window system, with its axes.

    Margins are fixed in inches: matplotlib's layout engines draw everything twice, which costs as long as a table.
    """
    figure = new_blank(width, height)
    axes = figure.subplots(rows, columns, **options)
    figure.subplots_adjust(
        left=1.0 / width, right=1 - RIGHT / width, bottom=0.55 / height, top=1 - 0.35 / height, wspace=0.3, hspace=0.25
    )
    return figure, axes


@own_style()
def new_blank(width: float, height: float, dpi: float = DPI) -> Figure:
    """A figure without axes, of a size in inches."""
    return Figure(figsize=(width, height), dpi=dpi)


def dress(axes: Axes, xlabel: str, ylabel: str, title: str = "") -> None:
    """Labels, a light grid and no box, whole numbers along the axes, and no more of them than there is room for."""
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    if title:
        axes.set_title(title, fontsize=9)
    if axes.get_xscale() == "linear":
        width = axes.get_position().width * axes.figure.get_figwidth()  # type: ignore[union-attr]
        axes.locator_params(axis="x", nbins=max(3, int(width / WIDEST_NUMBER)))
    for name, scale in (("x", axes.get_xscale()), ("y", axes.get_yscale())):
        if scale == "linear":
            axes.ticklabel_format(axis=name, useOffset=False)  # type: ignore[arg-type]
    axes.grid(True, alpha=0.25, linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)


def add_legend(axes: Axes, **options: Any) -> None:
    """A legend where it hides least, and through which lines do not run."""
    axes.legend(framealpha=0.8, edgecolor="none", **options)


def note_unit(figure: Figure, units: Units) -> None:
    """What the unit of length on the axes is, along the right edge, where that is not the tube's radius."""
    if units.note():
        figure.text(
            1 - NOTE / figure.get_figwidth(), 0.92, units.note(), fontsize=7, rotation="vertical", ha="right", va="top"
        )


@own_style()
def save_figure(figure: Figure, path: Path) -> None:
    """Write a figure in the format that the path's ending names, as PNG where it has none."""
    kind = path.suffix[1:].lower() or "png"
    backend, name = CANVASES.get(kind, ("agg", "Agg"))
    canvas: Any = getattr(importlib.import_module(f"matplotlib.backends.backend_{backend}"), f"FigureCanvas{name}")
    with path.open("wb") as file:  # whose name would be PostScript's title
        canvas(figure).print_figure(file, format=kind, metadata=UNDATED.get(kind))


def pixels(figure: Figure) -> NDArray[np.uint8]:
    """A figure as an image, shape (height, width, 4): red, green, blue, opacity."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.array(canvas.buffer_rgba())


def save_movie(frames: Sequence[NDArray[np.uint8]], path: Path, rate: int) -> None:
    """Write images as a GIF that repeats for ever, so many a second."""
    from PIL import Image

    first, *others = (Image.fromarray(frame[..., :3]) for frame in frames)
    first.save(path, format="GIF", save_all=True, append_images=others, duration=1000 // rate, loop=0)
