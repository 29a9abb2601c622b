"""One look for all pictures, and how they reach the disk."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pearlbvp.units import Units

COLOURS = ("#0b5394", "#c55a11", "#38761d", "#741b47", "#7f6000", "#444444", "#2a8c8c", "#c2487e")
"""Dark enough for print, distinct without colour vision in this order."""


def new_figure(
    rows: int = 1, columns: int = 1, *, width: float = 7.0, height: float = 4.2, **options: Any
) -> tuple[Figure, Any]:
    """A figure that belongs to no window system, with its axes.

    Margins are fixed in inches: matplotlib's layout engines draw everything twice, which costs as long as a table.
    """
    figure = Figure(figsize=(width, height), dpi=130)
    axes = figure.subplots(rows, columns, **options)
    figure.subplots_adjust(
        left=1.0 / width, right=1 - 0.15 / width, bottom=0.55 / height, top=1 - 0.35 / height, wspace=0.3, hspace=0.25
    )
    return figure, axes


def new_blank(width: float, height: float) -> Figure:
    """A figure without axes, of a size in inches."""
    return Figure(figsize=(width, height), dpi=130)


def dress(axes: Axes, xlabel: str, ylabel: str, title: str = "") -> None:
    """Labels, a light grid and no box."""
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    if title:
        axes.set_title(title, fontsize="medium")
    axes.grid(True, alpha=0.25, linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)


def note_unit(figure: Figure, units: Units) -> None:
    """What the unit of length on the axes is, in a corner, where that is not the tube's radius."""
    if units.note():
        figure.text(0.005, 0.008, units.note(), fontsize=7)


def save_figure(figure: Figure, path: Path) -> None:
    """Write a figure in the format that the path's ending names, as PNG where it has none."""
    figure.savefig(path, format=path.suffix[1:].lower() or "png")
