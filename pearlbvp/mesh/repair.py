"""Polygons of a file as triangles that share their vertices: split, merged, without what is there twice or has no area."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from pearlbvp.arrays import Array, Integers
from pearlbvp.errors import InputError
from pearlbvp.mesh.formats.soup import Soup
from pearlbvp.mesh.mesh_error import MeshError
from pearlbvp.mesh.polygons import split
from pearlbvp.messages import counted

SAME = 1e-5
"""Distance, in median edges, at which two points are one, and height, in its longest edge, at which a triangle has no area."""

LARGEST = 1e30
"""Coordinates whose products are still numbers."""

ASTRAY = 1e4
"""Distance of a vertex from the middle of all, in half of them, beyond which it is no part of a tube: no mesh is so uneven."""


@dataclass(frozen=True)
class Surface:
    """Triangles of a file, by its own points.

    Attributes:
        points: of the file, shape (P, 3).
        vertex: the first point that lies where each point does, shape (P,).
        corners: points of the triangles' corners, shape (T, 3).
        faces: number of the polygon that each triangle is of, shape (T,).
        first: number of the file's first point and polygon in messages.
        said: what was repaired.
    """

    points: Array
    vertex: Integers
    corners: Integers
    faces: Integers
    first: int
    said: tuple[str, ...] = field(default=())

    @property
    def triangles(self) -> Integers:
        """The triangles, shape (T, 3), by one point for each place."""
        return self.vertex[self.corners]

    def only(self, kept: NDArray[np.bool_] | Integers) -> Surface:
        """Some of the triangles."""
        return replace(self, corners=self.corners[kept], faces=self.faces[kept])

    def saying(self, *words: str) -> Surface:
        """The same, with more words of what was repaired."""
        return replace(self, said=(*self.said, *(word for word in words if word)))

    def error(self, template: tuple[str, str, str], *corners: int) -> MeshError:
        """An error about corners ``3 t + a``, by the file's numbers; see ``MeshError``."""
        return MeshError.at(template, self.triangles, *corners).renumbered(self.corners, self.first, self.faces)


def repaired(soup: Soup) -> Surface:
    """The triangles of a soup.

    Raises:
        InputError: a vertex is not finite, or a polygon crosses itself; by the file's numbers.
    """
    used = np.unique(soup.corners)
    wrong = used[~np.isfinite(soup.points[used]).all(axis=1)]
    if len(wrong):
        raise InputError(
            "vertices",
            f"vertex {wrong[0] + soup.first} (of the file, from {soup.first} on) at "
            f"{soup.points[wrong[0]]} is not finite",
            "give ordinary numbers",
        )
    _check_sizes(soup, used)
    owner = np.repeat(np.arange(len(soup.sizes)), soup.sizes)
    vertex = _welded(soup, used)
    corners, sizes = _without_repeats(vertex, soup.corners, owner, len(soup.sizes))
    kept = np.flatnonzero(sizes >= 3)
    corners = corners[np.repeat(sizes >= 3, sizes)]
    if not len(kept):
        raise InputError("triangles", "no face of the file has an area", "export it again")
    places = split(soup.points, corners, sizes[kept], soup.first)
    surface = Surface(soup.points, vertex, corners[places[:, :3]], kept[places[:, 3]], soup.first)
    quads, others = int((sizes == 4).sum()), int((sizes > 4).sum())
    merged = len(used) - len(np.unique(vertex[used]))
    idle = len(soup.points) - len(used)
    surface = surface.saying(
        f"split {counted(quads, 'quad')}" if quads else "",
        f"split {counted(others, 'polygon')}" if others else "",
        f"merged {counted(merged, 'duplicate vertex', 'duplicate vertices')}" if merged else "",
        f"left out {counted(idle, 'vertex', 'vertices')} of no face" if idle else "",
    )
    return _without_area(_without_doubles(surface), len(soup.sizes) - len(kept))


def _check_sizes(soup: Soup, used: Integers) -> None:
    """Refuse vertices that are far from all others, and coordinates beyond all use.

    Raises:
        InputError: the farthest of them, by the file's number.
    """
    away = np.abs(soup.points[used] - np.median(soup.points[used], axis=0)).max(axis=1)
    far = int(away.argmax())
    named = f"vertex {used[far] + soup.first} (of the file, from {soup.first} on) at {soup.points[used[far]]}"
    usual = float(np.median(away))
    if usual > 0 and away[far] > ASTRAY * usual:
        raise InputError(
            "vertices",
            f"{named} is {away[far]:.3g} away from the middle of all, half of which are within {usual:.3g}",
            "correct it, or leave its faces out",
        )
    if float(np.abs(soup.points[used]).max()) > LARGEST:
        raise InputError(
            "vertices", f"{named} is farther out than can be computed with", "give a tube of ordinary size"
        )


def joined_points(points: Array, near: float) -> Integers:
    """For each point the first of those that lie together with it, chains of near ones being one."""
    places, first, place = np.unique(points, axis=0, return_index=True, return_inverse=True)
    pairs = cKDTree(places).query_pairs(near, output_type="ndarray")
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(places),) * 2)
    label = connected_components(graph, directed=False)[1]
    lowest = np.full(label.max() + 1, len(points))
    np.minimum.at(lowest, label, first)
    return np.asarray(lowest[label][place.ravel()])


def _welded(soup: Soup, used: Integers) -> Integers:
    """The first point that lies where each point does."""
    after = np.arange(1, len(soup.corners) + 1)
    ends = np.cumsum(soup.sizes)[soup.sizes > 0]
    after[ends - 1] = ends - soup.sizes[soup.sizes > 0]
    edges = np.linalg.norm(soup.points[soup.corners] - soup.points[soup.corners[after]], axis=1)
    edges = edges[edges > 0]
    near = SAME * float(np.median(edges)) if len(edges) else 0.0
    vertex = np.arange(len(soup.points))
    vertex[used] = used[joined_points(soup.points[used], near)]
    return vertex


def _without_repeats(vertex: Integers, corners: Integers, owner: Integers, count: int) -> tuple[Integers, Integers]:
    """Corners of polygons that follow on one at the same place left out, and the sizes that remain."""
    while True:
        sizes = np.bincount(owner, minlength=count)
        ends = np.cumsum(sizes)[sizes > 0]
        after = np.arange(1, len(corners) + 1)
        after[ends - 1] = ends - sizes[sizes > 0]
        same = vertex[corners] == vertex[corners[after]] if len(corners) else np.zeros(0, dtype=bool)
        if not same.any():
            return corners, sizes
        corners, owner = corners[~same], owner[~same]


def _without_doubles(surface: Surface) -> Surface:
    """Triangles on the same three vertices taken once."""
    _, kept = np.unique(np.sort(surface.triangles, axis=1), axis=0, return_index=True)
    faces = len(np.unique(surface.faces)) - len(np.unique(surface.faces[kept]))
    return surface.only(np.sort(kept)).saying(
        f"left out {counted(faces, 'face that is', 'faces that are')} there twice" if faces else ""
    )


def _without_area(surface: Surface, dropped: int) -> Surface:
    """Triangles without area left out; where one has three vertices in a row, the middle one splits the triangle beside it."""
    triangles = surface.triangles
    repeated = (triangles == np.roll(triangles, 1, axis=1)).any(axis=1)
    surface = surface.only(~repeated)
    dropped += int(repeated.sum())
    for _ in range(len(surface.corners)):
        at = surface.points[surface.triangles]
        edges = np.linalg.norm(at - np.roll(at, -1, axis=1), axis=2)
        areas = np.linalg.norm(np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]), axis=1)
        flat = np.flatnonzero(areas < SAME * edges.max(axis=1) ** 2)
        if not len(flat):
            break
        surface = _split_beside(surface, int(flat[0]), int(edges[flat[0]].argmax()))
        dropped += 1
    if not len(surface.corners):
        raise InputError("triangles", "no face of the file has an area", "export it again")
    return surface.saying(f"left out {counted(dropped, 'face')} without area" if dropped else "")


def _split_beside(surface: Surface, flat: int, longest: int) -> Surface:
    """A triangle left out; the one beyond its longest edge is split at the third corner."""
    triangles = surface.triangles
    a, c = triangles[flat, longest], triangles[flat, (longest + 1) % 3]
    middle = surface.corners[flat, (longest + 2) % 3]
    beside = np.flatnonzero((triangles == a).any(axis=1) & (triangles == c).any(axis=1))
    beside = beside[beside != flat]
    kept = np.arange(len(triangles)) != flat
    if len(beside) != 1 or surface.vertex[middle] in triangles[beside[0]]:
        return surface.only(kept)
    kept[beside] = False
    halves = np.repeat(surface.corners[beside], 2, axis=0)
    halves[0, triangles[beside[0]] == a] = middle
    halves[1, triangles[beside[0]] == c] = middle
    rest = surface.only(kept)
    return replace(
        rest,
        corners=np.concatenate((rest.corners, halves)),
        faces=np.concatenate((rest.faces, np.repeat(surface.faces[beside], 2))),
    )
