"""A flow as a movie."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pearlbvp.figures.canvas import new_blank, own_style, pixels, save_movie
from pearlbvp.figures.flow import surfaces_of
from pearlbvp.figures.surface import box_of, show_surface
from pearlbvp.flows.record import FlowState
from pearlbvp.units import RADII, Units


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
    surfaces = surfaces_of(chosen, 81, 49)
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
