"""Pictures of triangulated tubes: the surface with its triangles, coloured by values at the vertices."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from numpy.typing import NDArray

from pearlbvp.figures.canvas import new_blank, note_unit, own_style
from pearlbvp.figures.surface import LIGHT
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
    """One period of a tube.

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
    corners = surface.corners
    low, high = float(values.min()), float(values.max())
    if high - low < 1e-9 * abs(high):  # all alike: the colour in the middle
        low, high = 0.9 * low, 1.1 * high
    colours = ScalarMappable(Normalize(low, high), colormaps["viridis"])
    faces = colours.to_rgba(values[surface.triangles].mean(axis=1))
    figure = new_blank(7.5, 4.2)
    axes = figure.add_axes((0.0, 0.0, 0.86, 0.95), projection="3d")
    axes.add_collection3d(  # type: ignore[attr-defined]
        Poly3DCollection(
            corners, facecolors=faces, edgecolors=(0, 0, 0, 0.25), linewidths=0.2, shade=True, lightsource=LIGHT
        )
    )
    first, last = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    axes.set(xlim=(first[0], last[0]), ylim=(first[1], last[1]), zlim=(first[2], last[2]))
    axes.set_box_aspect(last - first, zoom=1.2)  # type: ignore[call-arg]
    axes.set(xlabel=units.axis_label("x", "x"), ylabel="y", zlabel="z")
    note_unit(figure, units)
    axes.set_title(title, fontsize="medium", y=0.93)
    for axis in (axes.yaxis, axes.zaxis):  # type: ignore[attr-defined]
        axis.set_major_locator(MaxNLocator(3))
    axes.view_init(elev=20, azim=-70)  # type: ignore[attr-defined]
    figure.colorbar(colours, cax=figure.add_axes((0.88, 0.2, 0.02, 0.6)), label=label)
    return figure
