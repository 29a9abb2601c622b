"""Pictures of surfaces: one tube, or several beside one another, to one scale."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import LightSource, to_hex, to_rgb
from matplotlib.figure import Figure

from pearlbvp.arrays import Array
from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.solution import Solution
from pearlbvp.figures.canvas import new_blank, own_style
from pearlbvp.membrane import Grid
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.sections import one_period

STABLE, UNSTABLE, PLAIN = "#7ba7d9", "#e0a070", "#9db8d6"
"""Colours of surfaces: light enough for shades to show, those of curves in kind."""

LIGHT = LightSource(azdeg=225, altdeg=50)

DARKEST = 0.35
"""Brightness of what faces away from the light."""


def shown(solution: Solution[Any]) -> Grid | PeriodicMesh:
    """A solution's surface on the whole tube; of a curve in two parameters that of its shapes."""
    found: Grid | PeriodicMesh = solution.problem.shapes.to_draw(solution.u)
    return found


def coarse(surface: Grid | PeriodicMesh) -> Grid | PeriodicMesh:
    """A surface for a small picture: of a grid as many rows and columns as can be seen."""
    if isinstance(surface, PeriodicMesh):
        return surface
    rows, columns = (
        np.unique(np.linspace(0, size - 1, min(size, most)).round().astype(int))
        for size, most in zip(surface[0].shape, SMALL, strict=True)
    )
    x, y, z = (part[np.ix_(rows, columns)] for part in surface)
    return x, y, z


SMALL = (121, 33)
"""Points along and around a tube in a small picture."""


def faces_of(surface: Grid | PeriodicMesh) -> Array:
    """Corners of a surface's quadrangles or triangles, shape (F, 4 or 3, 3), in one sense as seen from outside."""
    if isinstance(surface, PeriodicMesh):
        return np.asarray(one_period(surface))
    points = np.stack(surface, axis=-1)
    faces = np.stack((points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]), axis=2)
    outwards = (faces - points.mean(axis=1)[:-1, None, None]).mean(axis=2)
    faces = faces.reshape(-1, 4, 3)
    inside_out = np.sum(_normals(faces) * outwards.reshape(-1, 3)) < 0
    return faces[:, ::-1] if inside_out else faces


def _normals(faces: Array) -> Array:
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, -1] - faces[:, 0])
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300))


def view(elevation: float, azimuth: float) -> Array:
    """Rows: the directions to the right, upwards and towards a viewer who is far away; angles in degrees.

    From an azimuth of -90 the tube's axis runs to the right in its full length.
    """
    elevation, azimuth = np.deg2rad(elevation), np.deg2rad(azimuth)
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    towards = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    return np.array([right, np.cross(towards, right), towards])


AFAR = view(20, -72)
"""How shapes are shown."""


def _centred(surface: Grid | PeriodicMesh) -> Array:
    """Its faces, the middle of its length at 0."""
    faces = faces_of(surface)
    return faces - np.array([(faces[..., 0].min() + faces[..., 0].max()) / 2, 0.0, 0.0])


def box_of(surfaces: Sequence[Grid | PeriodicMesh]) -> tuple[float, float]:
    """Half the width and height of the smallest box in which some surfaces are seen, centred, from afar."""
    reach = np.max([np.abs(seen_points(surface)).max(axis=0) for surface in surfaces], axis=0)
    return EDGE * float(reach[0]), EDGE * float(reach[1])


def seen_points(surface: Grid | PeriodicMesh) -> Array:
    """Corners of its faces to the right of and above the middle of the box, shape (K, 2)."""
    return np.asarray((_centred(surface) @ AFAR[:2].T).reshape(-1, 2))


EDGE = 1.02
"""Size of a box by that of what is in it."""


def add_faces(axes: Axes, faces: Array, colours: Array, seen_from: Array, edges: Any = "face") -> None:
    """Faces as a viewer sees them, lit from above, the farthest drawn first.

    Args:
        axes: plain ones.
        faces: corners, shape (F, corners, 3).
        colours: red, green and blue of all or of each face.
        seen_from: a ``view``.
        edges: their colour, or ``face`` for that of the face, so that no seams show.
    """
    seen = faces @ seen_from.T
    order = np.argsort(seen[..., 2].mean(axis=1))
    light = DARKEST + (1 - DARKEST) * LIGHT.shade_normals(_normals(faces))
    lit = (light[:, None] * colours)[order]
    width = 0.7 if isinstance(edges, str) else 0.2
    axes.add_collection(PolyCollection(list(seen[order, :, :2]), facecolors=lit, edgecolors=edges, linewidths=width))


def show_surface(
    axes: Axes, surface: Grid | PeriodicMesh, box: tuple[float, float], colour: str | Array = PLAIN
) -> None:
    """A tube seen from afar, lit from above, in a box of given size: what is farther away is drawn first.

    Args:
        axes: plain ones; what they showed is cleared.
        surface: the tube; the middle of its length is put into the middle of the box.
        box: half its width and height, from ``box_of``.
        colour: of the surface, or red, green and blue of each of its faces.
    """
    axes.clear()
    add_faces(axes, _centred(surface), np.array(to_rgb(colour)) if isinstance(colour, str) else colour, AFAR)
    for faces in axes.collections:
        faces.set_rasterized(True)  # thousands of polygons
    axes.set(xlim=(-box[0], box[0]), ylim=(-box[1], box[1]), aspect="equal")
    axes.set_axis_off()


TINT = 0.35
"""Share of white in the colour of a surface, so that its shades show."""


def tint(colour: str) -> str:
    """The colour of a surface that belongs to a curve of a colour."""
    red, green, blue = (TINT + (1 - TINT) * part for part in to_rgb(colour))
    return to_hex((red, green, blue))


def colour_of(point: Solution[Any]) -> str:
    """Blue for a stable solution, brown for an unstable one."""
    return STABLE if point.spectrum.stable else UNSTABLE


def stability(point: Solution[Any]) -> str:
    """``stable``, or how many directions are not."""
    return f"{point.spectrum.n_unstable} unstable" if point.spectrum.n_unstable else "stable"


def title_of(point: Solution[Any]) -> str:
    """A solution's volume, and how stable it is, where that is known."""
    return f"v = {point.observables['v']:.4f}" + (f", {stability(point)}" if point.spectrum.complete else "")


@own_style()
def draw_surfaces(points: Sequence[Solution[Any]], titles: Sequence[str] = (), columns: int = 4) -> Figure:
    """Solutions beside one another, stable ones blue, unstable ones brown, all to one scale.

    Args:
        points: points of branches, of any family.
        titles: one for each; by default their volume and number of unstable directions.
        columns: how many stand side by side.
    """
    titles = titles or [title_of(point) for point in points]
    rows = -(-len(points) // columns)
    columns = min(columns, len(points))
    size = 2.0 if len(points) == 1 else 1.0
    figure = new_blank(2.7 * size * columns, 2.0 * size * rows)
    place_surfaces(figure, (0.0, 0.0, 1.0, 1.0), points, titles, (rows, columns))
    return figure


def place_surfaces(
    figure: Figure,
    box: tuple[float, float, float, float],
    points: Sequence[Solution[Any]],
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
    surfaces = [shown(point) for point in points]
    seen = box_of(surfaces)
    left, bottom, width, height = box[0], box[1], box[2] / grid[1], box[3] / grid[0]
    for place, (point, surface, title) in enumerate(zip(points, surfaces, titles, strict=True)):
        row, column = divmod(place, grid[1])
        corner = left + column * width, bottom + (grid[0] - 1 - row) * height
        axes = figure.add_axes((corner[0] + 0.03 * width, corner[1] + 0.04 * height, 0.94 * width, 0.8 * height))
        show_surface(axes, surface, seen, colour_of(point))
        figure.text(corner[0] + width / 2, corner[1] + 0.88 * height, title, fontsize="small", ha="center")


def some_of(branch: Branch[Any], count: int = 4) -> list[Solution[Any]]:
    """Some points from a branch's first to its last."""
    chosen = np.unique(np.linspace(0, len(branch.points) - 1, count).round().astype(int))
    return [branch.points[i] for i in chosen]
