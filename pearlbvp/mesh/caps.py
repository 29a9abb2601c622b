"""Caps: flat ends with which modelling programs close a tube. They are found by where they lie, one period from each other."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from pearlbvp.mesh.periodic import Array, Integers

ANGLES = (0.1, 10.0, 40.0)
"""Between neighbouring triangles of one cap at most, in degrees: flat, flat but for digits, or bulging; tried in turn."""

FEWEST = 5
"""Vertices around a cap at least."""

MOST = 1500
"""Caps of equally many vertices around that are compared, the largest ones: where more are, none of them is a cap."""


def edges_of(triangles: Integers) -> tuple[Integers, Integers, Integers]:
    """Edges as pairs of vertices, shape (E, 2), the edge of each half-edge, shape (T, 3), and their numbers of triangles."""
    ends = np.sort(np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=2).reshape(-1, 2), axis=1)
    edges, edge, count = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    return edges, edge.reshape(-1, 3), count


def loops_of(edges: Integers) -> list[Integers]:
    """Vertices of the connected parts of some edges."""
    vertices, ends = np.unique(edges, return_inverse=True)
    ends = ends.reshape(-1, 2)
    graph = coo_matrix((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(len(vertices),) * 2)
    count, label = connected_components(graph, directed=False)
    return [vertices[label == i] for i in range(count)]


def translation(one: Array, other: Array, near: float) -> Array | None:
    """The vector by which one set of points is the other moved, to a distance; None if it is not."""
    if len(one) != len(other):
        return None
    moved = other.mean(axis=0) - one.mean(axis=0)
    distance, place = cKDTree(other).query(one + moved)
    if distance.max() > near or len(np.unique(place)) < len(place):
        return None
    return np.asarray(moved)


def caps(points: Array, triangles: Integers, polygons: Integers, length: float, near: float) -> Array | None:
    """Which triangles are caps of a tube that is closed at one end or at both; None if no two ends lie a period apart.

    Args:
        points: shape (P, 3).
        triangles: shape (T, 3).
        polygons: number of the polygon that each triangle is of: those of one polygon lie in one cap, flat or not.
        length: the period.
        near: distance at which points are one.
    """
    edges, edge, count = edges_of(triangles)
    open_ends = loops_of(edges[count == 1])
    if len(open_ends) > 1 or (count > 2).any():
        return None
    order = np.argsort(edge.ravel(), kind="stable")
    place = np.cumsum(count) - count
    inner = count == 2
    sides = np.column_stack((order[place[inner]], order[place[inner] + 1])) // 3
    at = points[triangles]
    normals = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    cosines = np.abs(np.einsum("ex,ex->e", normals[sides[:, 0]], normals[sides[:, 1]]))
    same = polygons[sides[:, 0]] == polygons[sides[:, 1]]
    for angle in ANGLES:
        flat = (cosines > np.cos(np.radians(angle))) | same
        graph = coo_matrix((np.ones(flat.sum()), sides[flat].T), shape=(len(triangles),) * 2)
        patch = connected_components(graph, directed=False)[1]
        rims = _rims(patch, sides, edges[inner], open_ends)
        for one, other in _pairs(points, rims, length):
            removed = np.isin(patch, [i for i in (one, other) if i >= 0])
            if translation(points[rims[one]], points[rims[other]], near) is None or removed.all():
                continue
            left, _, left_count = edges_of(triangles[~removed])
            if (np.unique(left[left_count == 1]).tolist() == np.unique(np.concatenate((rims[one], rims[other]))).tolist()) and (
                len(loops_of(left[left_count == 1])) == 2
            ):
                return np.asarray(removed)
    return None


def _rims(patch: Integers, sides: Integers, edges: Integers, open_ends: list[Integers]) -> dict[int, Integers]:
    """Vertices around each patch; an open end is patch -1."""
    pair = patch[sides]
    between = pair[:, 0] != pair[:, 1]
    owner = pair[between].ravel()
    ends = np.repeat(edges[between], 2, axis=0)
    order = np.argsort(owner, kind="stable")
    names, begin = np.unique(owner[order], return_index=True)
    parts = np.split(ends[order], begin[1:])
    rims = {int(name): np.unique(part) for name, part in zip(names, parts, strict=True) if len(part) >= FEWEST}
    return rims | {-1 - i: end for i, end in enumerate(open_ends)}


def _pairs(points: Array, rims: dict[int, Integers], length: float) -> list[tuple[int, int]]:
    """Rims of equally many vertices whose centres lie a period apart; with an open end only those that go with it."""
    sizes = {name: len(rim) for name, rim in rims.items()}
    found = []
    for size in sorted(set(sizes.values()), reverse=True):
        names = [name for name, own in sizes.items() if own == size]
        centres = np.array([points[rims[name]].mean(axis=0) for name in names])
        if len(names) > MOST:
            continue
        apart = np.linalg.norm(centres[:, None] - centres, axis=2)
        for i, j in np.argwhere(np.triu(np.abs(apart - length) < 1e-3 * length, 1)):
            if -1 not in rims or -1 in (names[i], names[j]):
                found.append((names[i], names[j]))
    return found
