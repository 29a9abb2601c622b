"""Caps: ends with which modelling programs close a tube. What lies twice, a period apart, is no part of one period."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from pearlbvp.arrays import Array, Integers

Mask = NDArray[np.bool_]

FLAT = 0.1
"""Angle between neighbouring triangles of one flat part at most, in degrees."""

FEWEST, MOST = 5, 1500
"""Corners around a flat part at least that may be a cap, and such parts of equally many corners at most."""

LIKE = 1e-3
"""Relative difference from the period at which a distance between parts is tried."""


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


def caps(points: Array, triangles: Integers, polygons: Integers, length: float, near: float) -> Mask | None:
    """Which triangles are caps of a tube that is closed at one end or at both; None if no two ends lie a period apart.

    Args:
        points: shape (P, 3).
        triangles: shape (T, 3).
        polygons: number of the polygon that each triangle is of: those of one polygon are one part, flat or not.
        length: the period.
        near: distance at which points are one.
    """
    edges, edge, count = edges_of(triangles)
    order, place, inner = np.argsort(edge.ravel(), kind="stable"), np.cumsum(count) - count, count == 2
    sides = np.column_stack((order[place[inner]], order[place[inner] + 1])) // 3
    open_ends = loops_of(edges[count == 1])
    parts = _parts(points, triangles, polygons, sides)
    rims = _rims(parts, sides, edges[inner])
    for step in _steps(points, edges, rims, open_ends, length, near):
        removed = (
            _beyond(points, triangles, sides, edges[inner], open_ends[0], step, near)
            if open_ends
            else np.isin(parts, _twice(points, rims, step, near))
        )
        if removed.any() and not removed.all():
            left, _, number = edges_of(triangles[~removed])
            ends = loops_of(left[number == 1])
            if len(ends) == 2 and translation(points[ends[0]], points[ends[1]], near) is not None:
                return removed
    return None


def _parts(points: Array, triangles: Integers, polygons: Integers, sides: Integers) -> Integers:
    """Number of the flat part that each triangle is of."""
    at = points[triangles]
    normals = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    cosines = np.abs(np.einsum("ex,ex->e", normals[sides[:, 0]], normals[sides[:, 1]]))
    same = (cosines > np.cos(np.radians(FLAT))) | (polygons[sides[:, 0]] == polygons[sides[:, 1]])
    graph = coo_matrix((np.ones(same.sum()), sides[same].T), shape=(len(triangles),) * 2)
    return np.asarray(connected_components(graph, directed=False)[1])


def _rims(parts: Integers, sides: Integers, edges: Integers) -> dict[int, Integers]:
    """Vertices around each part."""
    pair = parts[sides]
    between = pair[:, 0] != pair[:, 1]
    owner, ends = pair[between].ravel(), np.repeat(edges[between], 2, axis=0)
    order = np.argsort(owner, kind="stable")
    names, begin = np.unique(owner[order], return_index=True)
    return {name: np.unique(part) for name, part in zip(names.tolist(), np.split(ends[order], begin[1:]), strict=False)}


def _steps(
    points: Array, edges: Integers, rims: dict[int, Integers], open_ends: list[Integers], length: float, near: float
) -> Iterator[Array]:
    """Vectors of a period's length by which one end may lie from the other.

    They lead from one flat part, or the open end, to another of the same rim, from one middle of a fan to another, or along
    the coordinates.
    """
    by_size: dict[int, list[Integers]] = {}
    for rim in rims.values():
        if len(rim) >= FEWEST:
            by_size.setdefault(len(rim), []).append(rim)
    for size in sorted(by_size, reverse=True):
        some = by_size[size] if len(by_size[size]) <= MOST else []
        begins = open_ends or some
        if not some or not begins:
            continue
        apart = np.array([points[rim].mean(axis=0) for rim in some]) - np.array(
            [points[rim].mean(axis=0) for rim in begins]
        ).reshape(-1, 1, 3)
        for i, j in np.argwhere(np.abs(np.linalg.norm(apart, axis=2) - length) < LIKE * length):
            if translation(points[begins[i]], points[some[j]], near) is not None:
                yield apart[i, j]
    middles = np.argsort(np.bincount(edges.ravel(), minlength=len(points)))[-2:]
    begins_at = [points[open_ends[0]].mean(axis=0)] if open_ends else list(points[middles])
    for begin in begins_at:
        for step in points[middles] - begin:
            if abs(np.linalg.norm(step) - length) < LIKE * length:
                yield step
    for step in length * np.eye(3)[[0, 2, 1]]:
        yield step
        yield -step


def _twice(points: Array, rims: dict[int, Integers], step: Array, near: float) -> list[int]:
    """Parts of which there is another one a step on, and those."""
    names = list(rims)
    if not names:
        return []
    centres = np.array([points[rims[name]].mean(axis=0) for name in names])
    pairs = cKDTree(centres).query_ball_point(centres + step, near)
    return [
        name
        for i, others in enumerate(pairs)
        for j in others
        if translation(points[rims[names[i]]], points[rims[names[j]]], near) is not None
        for name in (names[i], names[j])
    ]


def _beyond(
    points: Array, triangles: Integers, sides: Integers, edges: Integers, end: Integers, step: Array, near: float
) -> Mask:
    """Triangles on the other side of where the open end lies a step on, seen from the open end."""
    used = np.unique(triangles)
    distance, place = cKDTree(points[used]).query(points[end] + step)
    if distance.max() > near:
        return np.zeros(len(triangles), dtype=bool)
    rim = np.isin(edges, used[place]).all(axis=1)
    graph = coo_matrix((np.ones((~rim).sum()), sides[~rim].T), shape=(len(triangles),) * 2)
    part = connected_components(graph, directed=False)[1]
    near_end = part[np.isin(triangles, end).any(axis=1)]
    return np.asarray(~np.isin(part, near_end))
