"""Pictures of triangulated tubes: the surface with its triangles, coloured by values at the vertices."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from pearlbvp.figures.canvas import dress, new_blank, note_unit, own_style
from pearlbvp.figures.surface import add_faces, view
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.units import RADII, Units


@own_style()
def draw_mesh(
    surface: PeriodicMesh,
    values: NDArray[np.float64] | None = None,
    title: str = "",
    label: str = "",
    units: Units = RADII,
) -> Figure:
    """One period of a tube, seen from its side and a little from above.

    Args:
        surface: its vertices on the surface.
        values: at the vertices, for the colours, shape (V,); by default the distance from the axis.
        title: above the picture.
        label: of the colours.
        units: of the vertices.
    """
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.ticker import MaxNLocator

    surface = surface.reduced()
    if values is None:
        values, label = np.hypot(surface.vertices[:, 1], surface.vertices[:, 2]), units.axis_label("r")
    low, high = float(values.min()), float(values.max())
    if high - low < 1e-9 * abs(high):  # all alike: the colour in the middle
        low, high = 0.9 * low, 1.1 * high
    colours = ScalarMappable(Normalize(low, high), colormaps["viridis"])
    side, corners = view(20, -90), surface.corners
    first, last = ((corners @ side.T)[..., :2]).min(axis=(0, 1)), ((corners @ side.T)[..., :2]).max(axis=(0, 1))
    height = float(np.clip(6.3 * (last - first)[1] / (last - first)[0], 0.4, 6.3))
    whole = height + 2.0
    figure = new_blank(7.5, whole)
    axes = figure.add_axes((0.12, 1.45 / whole, 0.84, height / whole))
    add_faces(axes, corners, colours.to_rgba(values[surface.triangles].mean(axis=1))[:, :3], side, (0, 0, 0, 0.25))
    margin = 0.02 * (last - first).max()
    axes.set(xlim=(first[0] - margin, last[0] + margin), ylim=(first[1] - margin, last[1] + margin), aspect="equal")
    dress(axes, units.axis_label("x"), units.axis_label("r", "across"))
    axes.yaxis.set_major_locator(MaxNLocator(2))
    axes.set_axisbelow(True)
    figure.text(0.54, 1 - 0.25 / whole, title, ha="center", va="center")
    bar = figure.add_axes((0.29, 0.55 / whole, 0.5, 0.12 / whole))
    figure.colorbar(colours, cax=bar, label=label, orientation="horizontal")
    note_unit(figure, units)
    return figure
