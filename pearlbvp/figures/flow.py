"""Pictures of a flow: energy, multipliers and velocity over time, shapes at both ends, and a movie."""

from __future__ import annotations

from pathlib import Path
from typing import cast

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pearlbvp.figures.canvas import (
    COLOURS,
    add_legend,
    dress,
    new_blank,
    new_figure,
    note_unit,
    own_style,
    pixels,
    save_movie,
)
from pearlbvp.figures.surface import box_of, show_surface
from pearlbvp.flows.record import FlowState, Frame
from pearlbvp.membrane import Grid
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.units import RADII, Units


def _surfaces(frames: list[Frame], along: int, around: int) -> list[Grid | PeriodicMesh]:
    return [frame.problem.surface(frame.q, along, around) for frame in frames]


@own_style()
def draw_flow(state: FlowState, table: pd.DataFrame, title: str = "", units: Units = RADII) -> Figure:
    """Energy, multipliers and velocity over time (logarithmic, from the first step on), and the first and last shape.

    Args:
        state: the flow's.
        table: its rows.
        title: above the picture.
        units: of the table.
    """
    units = units.of_flow(state.problem.law)
    time = units.axis_label("t")
    figure, axes = new_figure(2, 2, width=9.5, height=7.0)
    table = table[table["t"] > 0]
    multipliers = f"{units.axis_label('lambda1')},\n{units.axis_label('lambda2')}"
    curves = ((axes[0, 0], ("E",), units.axis_label("E")), (axes[0, 1], ("lambda1", "lambda2"), multipliers))
    for place, names, label in curves:
        for name, colour in zip(names, COLOURS, strict=False):
            place.semilogx(table["t"], table[name], color=colour, label=name)
        dress(place, time, label, title if place is axes[0, 0] else "")
    add_legend(axes[0, 1])
    styles = (("velocity", "largest velocity"), ("area_error", "error of area"), ("volume_error", "error of volume"))
    for (name, label), colour in zip(styles, COLOURS, strict=False):
        axes[1, 0].loglog(table["t"], table[name].abs().clip(lower=1e-17), color=colour, label=label)
    add_legend(axes[1, 0], fontsize="small")
    dress(axes[1, 0], time, f"{units.axis_label('velocity', 'velocity')}, relative errors")
    axes[1, 1].set_axis_off()
    left, bottom, width, height = axes[1, 1].get_position().bounds
    left, bottom, width, height = left - 0.06, bottom - 0.04, width + 0.07, height + 0.04  # no axes need room there
    ends = [state.record.frames[0], state.record.frames[-1]]
    surfaces = _surfaces(ends, 121, 37)
    for row, (frame, surface) in enumerate(zip(ends, surfaces, strict=True)):
        below = bottom + (1 - row) * height / 2
        show_surface(figure.add_axes((left, below, width, 0.43 * height)), surface, box_of(surfaces))
        said = f"t = {units.to_user('t', frame.t):.4g}"
        figure.text(left + width / 2, below + 0.45 * height, said, fontsize="small", ha="center")
    note_unit(figure, units)
    return figure


WIDTH, TITLE = 4.5, 0.3
"""Of the picture of one shape, and of the room above it, in inches."""


@own_style()
def draw_shape(frame: Frame, axes: Axes | None = None, units: Units = RADII) -> Figure:
    """A shape on the way, its time above it.

    Args:
        frame: the shape.
        axes: where to draw, in a figure of their own by default.
        units: of the time.
    """
    (surface,) = _surfaces([frame], 121, 37)
    wide, tall = box_of([surface])
    if axes is None:
        height = WIDTH * tall / wide + TITLE
        axes = new_blank(WIDTH, height).add_axes((0.0, 0.0, 1.0, 1 - TITLE / height))
    show_surface(axes, surface, (wide, tall))
    axes.set_title(f"t = {units.of_flow(frame.problem.law).to_user('t', frame.t):.4g}", fontsize="small")
    return cast("Figure", axes.figure)


@own_style()
def write_movie(state: FlowState, path: Path, count: int = 30, rate: int = 10, units: Units = RADII) -> None:
    """The shapes on the way as a GIF; equal steps of energy and of the number of time steps share the frames.

    Times are written on them in the user's unit.
    """
    units = units.of_flow(state.problem.law)
    frames = state.record.frames
    chosen = [frames[i] for i in _evenly(state, min(count, len(frames)))]
    figure = new_blank(6.0, 3.2, dpi=90)
    axes = figure.add_axes((0.02, 0.02, 0.96, 0.86))
    surfaces = _surfaces(chosen, 61, 25)
    seen = box_of(surfaces)
    images = []
    for frame, surface in zip(chosen, surfaces, strict=True):
        show_surface(axes, surface, seen)
        axes.set_title(f"t = {units.to_user('t', frame.t):.4g}", fontsize="small")
        images.append(pixels(figure))
    save_movie(images, path, rate)


def _evenly(state: FlowState, count: int) -> list[int]:
    """Indices of frames, half of the progress counted by energy, half by steps."""
    rows = state.record.rows
    times = np.array([frame.t for frame in state.record.frames])
    energy = np.interp(times, rows["t"], rows["E"])
    fall = energy[0] - energy
    progress = fall / max(fall.max(), 1e-300) + np.linspace(0, 1, len(times))
    progress = np.maximum.accumulate(progress)
    wanted = np.linspace(progress[0], progress[-1], count)
    return [int(i) for i in np.unique(np.searchsorted(progress, wanted).clip(0, len(times) - 1))]
