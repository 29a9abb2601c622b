"""Pictures of a flow: energy, multipliers and velocity over time, and shapes."""

from __future__ import annotations

from typing import cast

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
)
from pearlbvp.figures.surface import box_of, show_surface
from pearlbvp.flows.record import FlowState, Frame
from pearlbvp.membrane import Grid
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.units import RADII, Units


def surfaces_of(frames: list[Frame], along: int, around: int) -> list[Grid | PeriodicMesh]:
    """What is drawn of shapes, on so many points where they have no triangles of their own."""
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
    surfaces = surfaces_of(ends, 161, 81)
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
    (surface,) = surfaces_of([frame], 121, 37)
    wide, tall = box_of([surface])
    if axes is None:
        height = WIDTH * tall / wide + TITLE
        axes = new_blank(WIDTH, height).add_axes((0.0, 0.0, 1.0, 1 - TITLE / height))
    show_surface(axes, surface, (wide, tall))
    axes.set_title(f"t = {units.of_flow(frame.problem.law).to_user('t', frame.t):.4g}", fontsize="small")
    return cast("Figure", axes.figure)
