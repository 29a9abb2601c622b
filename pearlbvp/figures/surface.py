"""Pictures of surfaces: one tube, or several beside one another, to one scale."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.colors import LightSource
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from pearlbvp.collocation.scheme import Array
from pearlbvp.continuation.branch import Branch, BranchPoint
from pearlbvp.figures.canvas import new_blank
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.sections import one_period

STABLE, UNSTABLE, PLAIN = "#7ba7d9", "#e0a070", "#9db8d6"
"""Colours of surfaces: light enough for shades to show, those of curves in kind."""

Surface = tuple[Array, Array, Array]
"""``x, y, z`` of points along (rows) and around (columns) a tube, closed around."""

LIGHT = LightSource(azdeg=225, altdeg=50)


def surface_of(point: Any) -> Surface | PeriodicMesh:
    """A solution's surface on the whole tube, of any family, to draw or to export: points, or a mesh where it is on one.

    Args:
        point: a point of a branch (``branch.points[i]``) or what it holds (``.point``).
    """
    if isinstance(point, BranchPoint):
        point = point.point
    problem, u = getattr(point.problem, "base", point.problem), point.u  # of a curve in two parameters: the shapes' own
    if problem.stored_as == "mesh":
        mesh: PeriodicMesh = problem.surface(u)
        return mesh
    if problem.stored_as == "tube":
        problem, u = problem.released(u, "lambda1", "lambda2", "v")  # whatever varies, at the shape's own length
        x = np.linspace(0, problem.length, max(2, round(6 * problem.length)) + 1)
        return problem.surface(u, x, 64)
    profile = problem.profile(point.u)
    if hasattr(profile, "curve"):  # a ring: the same section everywhere
        x, y, z = profile.surface(problem.length, along=round(4 * problem.length) + 1, around=97)
        return x, y, z
    return repeated(profile.surface(), profile.period, max(1, round(point.observables["L"] / profile.period)))


def repeated(surface: Surface, period: float, count: int) -> Surface:
    """A period of a tube, its end the image of its beginning, ``count`` times along the axis."""
    x, y, z = surface
    along = np.concatenate([x[: -1 if i + 1 < count else None] + i * period for i in range(count)])
    across = [np.concatenate([part[: -1 if i + 1 < count else None] for i in range(count)]) for part in (y, z)]
    return along, across[0], across[1]


def coordinates(surface: Surface | PeriodicMesh) -> Surface:
    """``x, y, z`` of a surface's points; of a mesh those of its triangles' corners, (T, 3), cut off at the ends."""
    if isinstance(surface, PeriodicMesh):
        corners = one_period(surface)
        return corners[..., 0], corners[..., 1], corners[..., 2]
    return surface


def show_surface(
    axes: Any,
    surface: Surface | PeriodicMesh,
    half_length: float,
    extent: float,
    colour: str = PLAIN,
    zoom: float = 1.9,
) -> None:
    """A tube seen from afar, lit from above, in a box of given size.

    Args:
        axes: three-dimensional axes; what they showed is cleared.
        surface: the tube; the middle of its length is put into the middle of the box.
        half_length, extent: half the size of the box along and across the axis.
        colour: of the surface.
        zoom: how much larger than the axes' square the box is shown.
    """
    x, y, z = coordinates(surface)
    x = x - (x.min() + x.max()) / 2
    axes.clear()
    if isinstance(surface, PeriodicMesh):
        corners = np.stack((x, y, z), axis=-1)
        shaded = Poly3DCollection(corners, facecolors=colour, shade=True, lightsource=LIGHT, antialiased=False)
        drawn = axes.add_collection3d(shaded)
    else:
        drawn = axes.plot_surface(
            x, y, z, rstride=1, cstride=1, color=colour, linewidth=0, antialiased=False, lightsource=LIGHT
        )
    drawn.set_clip_on(False)  # three-dimensional axes are square, tubes are not
    axes.set(xlim=(-half_length, half_length), ylim=(-extent, extent), zlim=(-extent, extent))
    axes.set_proj_type("ortho")
    axes.set_box_aspect((2 * half_length, 2 * extent, 2 * extent), zoom=zoom)
    axes.view_init(elev=20, azim=-60)
    axes.set_axis_off()


def colour_of(point: BranchPoint[Any]) -> str:
    """Blue for a stable solution, brown for an unstable one."""
    return STABLE if point.spectrum.n_unstable == 0 else UNSTABLE


def draw_surfaces(points: Sequence[BranchPoint[Any]], titles: Sequence[str] = (), columns: int = 4) -> Figure:
    """Solutions beside one another, stable ones blue, unstable ones brown, all to one scale.

    Args:
        points: points of branches, of any family.
        titles: one for each; by default their volume and number of unstable directions.
        columns: how many stand side by side.
    """
    titles = titles or [
        f"v = {point.observables['v']:.4f}, {point.spectrum.n_unstable} unstable" for point in points
    ]  # fmt: skip
    rows = -(-len(points) // columns)
    columns = min(columns, len(points))
    figure = new_blank(2.7 * columns, 2.0 * rows)
    place_surfaces(figure, (0.0, 0.0, 1.0, 1.0), points, titles, (rows, columns))
    return figure


def place_surfaces(
    figure: Figure,
    box: tuple[float, float, float, float],
    points: Sequence[BranchPoint[Any]],
    titles: Sequence[str],
    grid: tuple[int, int],
) -> None:
    """Surfaces in a grid in a part of a figure.

    Args:
        figure: where to draw.
        box: left, bottom, width, height in shares of the figure.
        points, titles: what to draw and what to write above each.
        grid: rows and columns.
    """
    surfaces = [surface_of(point) for point in points]
    extent = max(float(np.abs(part).max()) for surface in surfaces for part in coordinates(surface)[1:])
    half_length = max(float(np.ptp(coordinates(surface)[0])) for surface in surfaces) / 2
    left, bottom, width, height = box[0], box[1], box[2] / grid[1], box[3] / grid[0]
    for place, (point, surface, title) in enumerate(zip(points, surfaces, titles, strict=True)):
        row, column = divmod(place, grid[1])
        corner = left + column * width, bottom + (grid[0] - 1 - row) * height
        axes = figure.add_axes((*corner, width, 0.92 * height), projection="3d")
        # A box this large fills most of the width of its place.
        zoom = 0.9 * (width * figure.get_figwidth()) / (0.92 * height * figure.get_figheight())
        show_surface(axes, surface, half_length, extent, colour_of(point), zoom)
        axes.set_title(title, fontsize=8, y=0.98)


def along(branch: Branch[Any], count: int = 4) -> list[BranchPoint[Any]]:
    """Some points from a branch's first to its last."""
    chosen = np.unique(np.linspace(0, len(branch.points) - 1, count).round().astype(int))
    return [branch.points[i] for i in chosen]
