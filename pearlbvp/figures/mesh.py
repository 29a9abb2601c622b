"""Pictures of triangulated tubes: the surface with its triangles, coloured by values at the vertices."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from numpy.typing import NDArray

from pearlbvp.mesh.periodic import PeriodicMesh


def draw_mesh(
    surface: PeriodicMesh, values: NDArray[np.float64] | None = None, title: str = "", label: str = ""
) -> Figure:
    """One period of a tube.

    Args:
        surface: its vertices on the surface.
        values: at the vertices, for the colours, shape (V,); by default the distance from the axis.
        title: above the picture.
        label: of the colours.
    """
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.ticker import MaxNLocator

    surface = surface.reduced()
    if values is None:
        values, label = np.hypot(surface.vertices[:, 1], surface.vertices[:, 2]), "distance from the axis (radii)"
    corners = surface.corners
    colours = ScalarMappable(Normalize(float(values.min()), float(values.max())), colormaps["viridis"])
    faces = colours.to_rgba(values[surface.triangles].mean(axis=1))
    figure = Figure(figsize=(7.5, 4.2), dpi=130)
    axes = figure.add_axes((0.0, 0.0, 0.86, 0.95), projection="3d")
    axes.add_collection3d(  # type: ignore[attr-defined]
        Poly3DCollection(corners, facecolors=faces, edgecolors=(0, 0, 0, 0.25), linewidths=0.2)
    )
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low, zoom=1.2)  # type: ignore[call-arg]
    axes.set(xlabel="x", ylabel="y", zlabel="z", title=title)
    for axis in (axes.yaxis, axes.zaxis):  # type: ignore[attr-defined]
        axis.set_major_locator(MaxNLocator(3))
    axes.view_init(elev=20, azim=-70)  # type: ignore[attr-defined]
    figure.colorbar(colours, cax=figure.add_axes((0.88, 0.2, 0.02, 0.6)), label=label)
    return figure
