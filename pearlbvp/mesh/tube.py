"""Polygons of a file as one period of a tube: without caps, axis along ``x``, seam closed, oriented outwards, checked."""

from __future__ import annotations

import contextlib
from dataclasses import replace

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from pearlbvp.arrays import Array, Integers
from pearlbvp.errors import InputError
from pearlbvp.mesh.caps import Mask, caps, edges_of, loops_of
from pearlbvp.mesh.formats.soup import Soup
from pearlbvp.mesh.mesh_error import MeshError
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.repair import SAME, Surface, repaired
from pearlbvp.mesh.seam import SEAM, Seam, named, of_ends, of_wrapped, overlap, turned
from pearlbvp.messages import counted

UNLIKE = 1e-4
"""Relative difference of area or volume between the mesh and the file's own triangles that is none."""

NAMED = 3
"""Pieces that are named one by one."""

FEWEST_AROUND = 5
"""Vertices around a tube at least, as many as the package's own meshes have.

With four, the wave ``sin 2 phi`` is zero at all of them: an oval section looks round. The energy of the straight tube is then
wrong by 2 per cent on a subdivision surface, with three by 10, with five by 0.8; its volume as a polyhedron by 28, 45 and 18.
"""

WORTH_SAYING = 1e-4
"""Distance, in mean edges, between points that became one from which on that is said."""


def tube_of(soup: Soup, length: float) -> tuple[PeriodicMesh, tuple[str, ...]]:
    """The tube, and what was repaired.

    Args:
        soup: polygons of a file.
        length: the period.

    Raises:
        InputError: they are no tube of that period; elements have the file's numbers.
    """
    surface = repaired(soup)
    _check_edges(surface)
    try:
        surface, seam = _seam(surface, length)
    except InputError:
        _check_debris(surface, length)
        raise
    _check_pieces(surface, seam.vertex[surface.triangles])
    triangles = seam.vertex[surface.triangles]
    points = turned(surface.points, seam.axis)
    order, flipped = _oriented(surface, triangles, seam.wraps)
    if _volume(points[triangles] + length * seam.wraps[..., None] * np.eye(3)[0], order) < 0:
        order, flipped = order[:, ::-1], ~flipped
    surface = replace(surface, corners=np.take_along_axis(surface.corners, order, axis=1))
    triangles, wraps = (np.take_along_axis(array, order, axis=1) for array in (triangles, seam.wraps))
    kept, number = np.unique(triangles, return_inverse=True)
    try:
        mesh = PeriodicMesh(points[kept], number.reshape(-1, 3), wraps, length)
    except MeshError as error:
        raise error.renumbered(surface.corners, surface.first, surface.faces) from None
    if (twice := overlap(mesh.vertices, length, SAME * float(np.median(mesh.edge_lengths)))) is not None:
        one, other = kept[twice] + surface.first
        raise InputError(
            "vertices",
            f"vertex {one} and vertex {other} (of the file, from {surface.first} on) lie at the same place, but for whole "
            "periods",
            "give one period, whose ends do not overlap and are open or flat",
        )
    _check_around(mesh)
    _compare(mesh, surface, seam)
    faces = len(np.unique(surface.faces[flipped]))
    away = seam.apart > WORTH_SAYING * float(mesh.edge_lengths.mean())
    surface = surface.saying(
        "" if not faces else "turned all faces outwards" if flipped.all() else f"turned {counted(faces, 'face')} round",
        f"closed a seam whose ends differ by {seam.apart:.2g}" if away else "",
        f"turned the axis from {named(seam.axis)} to x" if seam.axis[0] != 1 else "",
    )
    return mesh, surface.said


def _check_edges(surface: Surface) -> None:
    """Refuse edges at which more than two triangles meet.

    Raises:
        InputError: the first of them.
    """
    _, edge, count = edges_of(surface.triangles)
    if (wrong := np.flatnonzero(count[edge.ravel()] > 2)).size:
        raise _manifold(surface, int(wrong[0]), int(count[edge.ravel()[wrong[0]]]))


def _manifold(surface: Surface, half_edge: int, count: int) -> MeshError:
    return surface.error(
        (
            "triangles",
            f"{count} triangles meet at the edge from vertex {{0}} to {{1}} (triangle {{triangle}})",
            "leave two of them",
        ),
        half_edge,
        half_edge + 1 if half_edge % 3 < 2 else half_edge - 2,
    )


def _pieces(triangles: Integers) -> list[Integers]:
    """Triangles of each piece that hangs together by vertices, the largest piece first."""
    heads = np.roll(triangles, -1, axis=1)
    size = int(triangles.max()) + 1
    graph = coo_matrix((np.ones(triangles.size), (triangles.ravel(), heads.ravel())), shape=(size, size))
    label = connected_components(graph, directed=False)[1][triangles[:, 0]]
    _, number, count = np.unique(label, return_inverse=True, return_counts=True)
    found = np.split(np.argsort(number, kind="stable"), np.cumsum(count)[:-1])
    return sorted(found, key=len, reverse=True)


def _check_pieces(surface: Surface, triangles: Integers) -> None:
    """Refuse what is in several pieces.

    Raises:
        InputError: how many, and where those are that are no tube.
    """
    pieces = _pieces(triangles)
    if len(pieces) == 1:
        return
    others = [
        f"{counted(len(piece), 'triangle')} (with vertex {surface.corners[piece[0], 0] + surface.first})"
        for piece in pieces[1 : 1 + NAMED]
    ]
    more = f" and {len(pieces) - 1 - NAMED} more" if len(pieces) > 1 + NAMED else ""
    raise InputError(
        "triangles",
        f"there are {len(pieces)} pieces, the largest of {len(pieces[0])} triangles, and {', '.join(others)}{more}",
        f"delete all but one tube (vertices are numbered from {surface.first} on)",
    )


def _check_debris(surface: Surface, length: float) -> None:
    """Say of a surface that does not repeat that it is in several pieces, if the largest one does.

    Raises:
        InputError: it is, and does.
    """
    pieces = _pieces(surface.triangles)
    if len(pieces) > 1:
        largest = False
        with contextlib.suppress(InputError):
            tube, seam = _seam(surface.only(np.sort(pieces[0])), length)
            largest = len(_pieces(seam.vertex[tube.triangles])) == 1
        if largest:
            _check_pieces(surface, surface.triangles)


def _check_around(mesh: PeriodicMesh) -> None:
    """Refuse a tube with so few vertices around it that its sections have no shape.

    A plane across meets a ring of triangles, whose corners are as many, half of them on either side.

    Raises:
        InputError: how many there are, and where.
    """
    steps = mesh.edge_vectors[mesh.edges, 0]
    begin = (mesh.vertices[mesh.tail[mesh.edges], 0] + np.minimum(steps, 0)) % mesh.length
    end = begin + np.abs(steps)
    ends = np.concatenate((begin, end % mesh.length))
    order = np.argsort(ends)
    change = np.concatenate((np.ones(len(begin)), -np.ones(len(end))))[order]
    met = np.cumsum(change) + (end >= mesh.length).sum()
    apart = np.diff(np.append(ends[order], ends[order[0]] + mesh.length)) > 1e-9 * mesh.length
    x, met = ends[order][apart], met[apart]
    if len(met) and met.min() < 2 * FEWEST_AROUND:
        raise InputError(
            "triangles",
            f"about {met.min() / 2:g} vertices lie around the tube beyond {x[met.argmin()]:.4g} "
            "along its axis, too few for the shape of a section",
            f"mesh it with {FEWEST_AROUND} or more, better 12",
        )


def _seam(surface: Surface, length: float) -> tuple[Surface, Seam]:
    """The surface without caps, and its seam."""
    edges, _, count = edges_of(surface.triangles)
    rim = edges[count == 1]
    if len(rim) == 0 or len(loops_of(rim)) == 1:
        near = SEAM * float(np.linalg.norm(np.diff(surface.points[edges], axis=1), axis=2).min())
        found = caps(surface.points, surface.triangles, surface.faces, length, near)
        if found is not None:
            faces = len(np.unique(surface.faces[found]))
            surface = surface.only(~found).saying(
                f"removed {'caps' if len(rim) == 0 else 'a cap'} of {counted(faces, 'face')}"
            )
        elif len(rim) == 0:
            seam = of_wrapped(surface.points, surface.triangles, length)
            if seam is None:
                raise _closed(surface, length)
            return surface.saying(seam.said), seam
    return surface, of_ends(surface.points, surface.triangles, length)


def _closed(surface: Surface, length: float) -> InputError:
    points = surface.points[np.unique(surface.triangles)]
    extent = " x ".join(f"{size:.4g}" for size in np.ptp(points, axis=0))
    return InputError(
        "length",
        f"the surface is closed, of extent {extent}, and neither has two flat ends {length:g} apart nor leads from its end to "
        "its beginning after that period",
        "give the period of a tube, open or with flat caps",
    )


def _oriented(surface: Surface, triangles: Integers, wraps: Integers) -> tuple[Integers, Mask]:
    """Order of each triangle's corners in which all are oriented alike, shape (T, 3), and which ones it turns.

    Each triangle has two nodes in a graph, one for each orientation, joined where they fit along an edge: a surface that can
    be oriented is two components of it.
    """
    heads, shifts = np.roll(triangles, -1, axis=1), np.roll(wraps, -1, axis=1) - wraps
    keys = np.stack((triangles, heads, shifts), axis=2).reshape(-1, 3)
    back = (keys[:, 0] > keys[:, 1]) | ((keys[:, 0] == keys[:, 1]) & (keys[:, 2] < 0))
    keys[back] = keys[back][:, [1, 0, 2]] * [1, 1, -1]
    _, edge, count = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    edge = edge.ravel()
    if (wrong := np.flatnonzero(count[edge] > 2)).size:
        raise _manifold(surface, int(wrong[0]), int(count[edge[wrong[0]]]))
    order = np.argsort(edge, kind="stable")
    first = (np.cumsum(count) - count)[count == 2]
    one, other = order[first], order[first + 1]
    alike = back[one] == back[other]  # both run along the edge the same way: one has to be turned
    total = len(triangles)
    a, b = one // 3, other // 3
    rows = np.concatenate((a, a + total))
    columns = np.concatenate((np.where(alike, b + total, b), np.where(alike, b, b + total)))
    graph = coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(2 * total,) * 2)
    label = connected_components(graph, directed=False)[1].reshape(2, total)
    if (label[0] == label[1]).any():
        raise InputError(
            "triangles", "the triangles cannot all be oriented alike, as the surface has one side only", "give a tube"
        )
    flipped = label[0] > label[1]
    if 2 * flipped.sum() > total:
        flipped = ~flipped
    return np.where(flipped[:, None], [0, 2, 1], [0, 1, 2]), flipped


def _volume(corners: Array, order: Integers) -> float:
    corners = np.take_along_axis(corners, order[..., None], axis=1)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float((corners.mean(axis=1)[:, 1:] * normals[:, 1:]).sum() / 4)


def _compare(mesh: PeriodicMesh, surface: Surface, seam: Seam) -> None:
    """Compare area and volume with those of the file's own triangles, where they lie in the file.

    Area by Heron's formula from the lengths of edges, volume by the divergence theorem about the file's own axis.

    Raises:
        InputError: they differ: the file was not understood.
    """
    corners = surface.points[surface.corners]
    edges = np.roll(corners, -1, axis=1) - corners
    periods = np.round(edges @ seam.axis / mesh.length)  # of triangles that lead on into the next period
    edges = edges - mesh.length * periods[..., None] * seam.axis
    a, b, c = np.sort(np.linalg.norm(edges, axis=2), axis=1).T[::-1]
    products = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))
    area = float(np.sqrt(np.maximum(products, 0)).sum() / 4)
    across = corners - (corners @ seam.axis)[..., None] * seam.axis
    volume = float((across.mean(axis=1) * np.cross(edges[:, 0], edges[:, 1])).sum() / 4)
    for name, found, own in (("area", mesh.area, area), ("volume", mesh.volume, volume)):
        if not abs(found - own) <= UNLIKE * abs(own):
            raise InputError(
                "mesh",
                f"the tube that was read has the {name} {found:.8g}, its file's triangles have {own:.8g}",
                "write it as triangles, cut open at its period",
            )
