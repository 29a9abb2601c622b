"""One look for all pictures, whatever a user's settings of matplotlib are, and how they reach the disk.

Figures belong to no window system: ``pyplot`` and its backends are never asked. They are made in ``own_style`` and written by
the canvas of the file's format. What users want otherwise they say by a style (``figures.style``).
"""

from __future__ import annotations

import importlib
import textwrap
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context, rcParams, rcParamsDefault
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from numpy.typing import NDArray

from pearlbvp.errors import InputError
from pearlbvp.units import Units

COLOURS = ("#0b5394", "#c55a11", "#38761d", "#741b47", "#7f6000", "#444444", "#2a8c8c", "#c2487e")
"""Dark enough for print, distinct without colour vision in this order."""

FAMILIES = {
    "pearl": "#0072b2", "unequal": "#56b4e9", "coil": "#d55e00", "buckle": "#009e73", "ring": "#cc79a7", "mixed": "#e69f00",
}  # fmt: skip
"""Colours of branches by what they are (``studies.names``), which people of all kinds of colour vision tell apart.

Source: M. Okabe, K. Ito, Color Universal Design (2008), https://jfly.uni-koeln.de/color/."""

OTHERS = "#000000"
"""That of families that were added."""

STYLE: ContextVar[Mapping[str, Any]] = ContextVar("style", default={})  # noqa: B039
"""Settings of matplotlib over our own, for the pictures of a command."""

OWN: dict[Any, Any] = {
    "svg.hashsalt": "pearlbvp",  # without salt the names in an SVG file are another in every run
    "figure.dpi": 130, "axes.grid": True, "grid.alpha": 0.25, "grid.linewidth": 0.6, "axes.spines.top": False,
    "axes.spines.right": False, "axes.titlesize": "small", "axes.formatter.useoffset": False, "legend.framealpha": 0.8,
    "legend.edgecolor": "none",
}  # fmt: skip
"""Settings that are not matplotlib's defaults."""

CANVASES = {"pdf": ("pdf", "Pdf"), "svg": ("svg", "SVG"), "eps": ("ps", "PS"), "ps": ("ps", "PS")}
"""Backend and canvas of formats that are no images; all others are drawn by Agg."""

LEFT, RIGHT, BELOW, ABOVE, NOTE = 7.2, 2.2, 4.0, 2.5, 0.7
"""Margins about the axes, and between what is noted at the right and the edge, in sizes of the font."""

WIDEST_NUMBER = 4.3
"""Room for a number on the horizontal axis, in sizes of the font."""

LETTER, LONGEST, SHORTEST = 0.55, 1.25, 30
"""Mean width of a letter by the font's size, the longest line along a vertical axis by its length, letters that any one has."""

FINE = 300
"""Dots an inch of surfaces in formats that are no images."""

UNDATED = {"pdf": {"CreationDate": None}, "svg": {"Date": None}}
"""Metadata without the time, so that the same picture is the same file."""


@contextmanager
def own_style(style: Mapping[str, Any] | None = None) -> Iterator[None]:
    """Matplotlib's defaults and our own settings, for a while: those of a user's session or ``matplotlibrc`` say nothing.

    Args:
        style: settings over these, by default those of ``figures.style.styled``.
    """
    style = STYLE.get() if style is None else style
    with rc_context():
        with warnings.catch_warnings(action="ignore"):  # of settings that a release is about to drop
            settings: dict[Any, Any] = dict(rcParamsDefault)
            rcParams.update({name: value for name, value in settings.items() if name != "backend"} | OWN | dict(style))
        yield


class Picture(Figure):
    """A figure that is drawn in the style it was made in, wherever and whenever that is: ticks are made while it is drawn."""

    def __init__(self, *args: Any, **how: Any) -> None:
        super().__init__(*args, **how)
        self.style = STYLE.get()

    def draw(self, renderer: Any) -> None:
        """Draw it."""
        with own_style(self.style):
            super().draw(renderer)

    def get_tightbbox(self, *args: Any, **how: Any) -> Any:
        """The box of all that is drawn, which takes the ticks' words."""
        with own_style(self.style):
            return super().get_tightbbox(*args, **how)


@own_style()
def new_figure(
    rows: int = 1, columns: int = 1, *, width: float = 7.0, height: float = 4.2, **options: Any
) -> tuple[Figure, Any]:
    """A figure that belongs to no window system, with its axes; a style may have its size.

    Margins are fixed in sizes of the font: matplotlib's layout engines draw everything twice, which costs as long as a table.
    """
    width, height = STYLE.get().get("figure.figsize", (width, height))
    figure = new_blank(width, height)
    axes = figure.subplots(rows, columns, **options)
    across, up = em() / width, em() / height
    figure.subplots_adjust(
        left=LEFT * across, right=1 - RIGHT * across, bottom=BELOW * up, top=1 - ABOVE * up, wspace=0.3, hspace=0.25
    )
    return figure, axes


def em() -> float:
    """Size of the largest words on axes, in inches."""
    sizes = (rcParams[name] for name in ("font.size", "axes.labelsize", "xtick.labelsize", "ytick.labelsize"))
    return max(FontProperties(size=size).get_size_in_points() for size in sizes) / 72


@own_style()
def new_blank(width: float, height: float, dpi: float | None = None) -> Figure:
    """A figure without axes, of a size in inches."""
    return Picture(figsize=(width, height), dpi=dpi)


def dress(axes: Axes, xlabel: str, ylabel: str, title: str = "") -> None:
    """Labels, and no more numbers along the horizontal axis than there is room for."""
    place, (wide, tall) = axes.get_position(), axes.figure.get_size_inches()  # type: ignore[union-attr]
    letters = max(SHORTEST, int(LONGEST * place.height * tall / (LETTER * em())))
    axes.set_xlabel(xlabel)
    axes.set_ylabel("\n".join("\n".join(textwrap.wrap(line, letters)) for line in ylabel.splitlines()))
    if title:
        axes.set_title(title)
    if axes.get_xscale() == "linear":
        axes.locator_params(axis="x", nbins=max(3, int(place.width * wide / (WIDEST_NUMBER * em()))))
    low, high = axes.get_ylim()
    if axes.get_yscale() == "linear" and 0 < high - low < NARROW * max(abs(low), abs(high)):
        axes.ticklabel_format(axis="y", useOffset=True)  # else there is no room for the digits


NARROW = 2e-3
"""Range of a vertical axis, by its numbers, up to which these are written as differences."""


def add_legend(axes: Axes, **options: Any) -> None:
    """A legend where it hides least, and through which lines do not run."""
    axes.legend(**options)


def note_unit(figure: Figure, units: Units) -> None:
    """What the unit of length on the axes is, along the right edge, where that is not the tube's radius."""
    if units.note():
        figure.text(
            1 - NOTE * em() / figure.get_figwidth(),
            0.92,
            units.note(),
            fontsize="x-small",
            rotation="vertical",
            ha="right",
            va="top",
        )


@own_style()
def save_figure(figure: Figure, path: Path) -> None:
    """Write a figure in the format that the path's ending names, as PNG where it has none.

    Raises:
        InputError: LaTeX, which a style asks for, cannot set its words.
    """
    kind = path.suffix[1:].lower() or "png"
    backend, name = CANVASES.get(kind, ("agg", "Agg"))
    canvas: Any = getattr(importlib.import_module(f"matplotlib.backends.backend_{backend}"), f"FigureCanvas{name}")
    with path.open("wb") as file:  # whose name would be PostScript's title
        try:
            dpi = FINE if kind in CANVASES and rcParams["savefig.dpi"] == "figure" else None
            canvas(figure).print_figure(file, dpi=dpi, format=kind, metadata=UNDATED.get(kind))
        except RuntimeError as error:
            if not rcParams["text.usetex"]:
                raise
            raise InputError(
                "style",
                f"LaTeX cannot set the picture's words ({str(error).partition(chr(10))[0]})",
                "leave text.usetex out",
            ) from None


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
