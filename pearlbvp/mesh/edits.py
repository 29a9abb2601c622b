"""Changes of a mesh, many edges at once: splits, collapses and flips of edges that do not touch each other.

All keep track of periods: corners are compared in the frame of one triangle, in which its own wraps hold.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from pearlbvp.arrays import Array, Integers
from pearlbvp.mesh.periodic import PeriodicMesh


def apart(mesh: PeriodicMesh, half_edges: Integers, rings: bool) -> Integers:
    """Those of some half-edges, in order of preference, that share no triangle (or no ring of triangles) with others."""
    start, order = mesh.star
    taken = np.zeros(len(mesh.triangles), dtype=bool)
    chosen = []
    for h in half_edges:
        if rings:
            vertices = [mesh.tail[h], mesh.head[h], mesh.tail[_next(_next(h))], mesh.tail[_next(_next(mesh.twin[h]))]]
            near = np.concatenate([order[start[i] : start[i + 1]] // 3 for i in vertices])
        else:
            near = np.array([h // 3, mesh.twin[h] // 3])
        if not taken[near].any():
            taken[near] = True
            chosen.append(h)
    return np.array(chosen, dtype=np.int64)


def _next(h: Any) -> Any:
    """The half-edge after one in its triangle."""
    return np.where(h % 3 == 2, h - 2, h + 1)


def _diamonds(mesh: PeriodicMesh, half_edges: Integers) -> tuple[Integers, Integers]:
    """Vertices ``a, b, c, d`` of the triangles ``(a, b, c)`` and ``(b, a, d)`` at edges, and their wraps, shape (K, 4)."""
    twins = mesh.twin[half_edges]
    places = [half_edges, _next(half_edges), _next(_next(half_edges)), _next(_next(twins))]
    vertices = np.column_stack([mesh.triangles.ravel()[p] for p in places])
    wraps = np.column_stack([mesh.wraps.ravel()[p] for p in places])
    # the twin starts at b: its frame against that of the first triangle
    wraps[:, 3] += wraps[:, 1] - mesh.wraps.ravel()[twins]
    return vertices, wraps


def _placed(points: Array, wraps: Integers, length: float) -> Array:
    moved = points.copy()
    moved[..., 0] += length * wraps
    return moved


def flipped(mesh: PeriodicMesh, half_edges: Integers) -> PeriodicMesh:
    """Edges ``ab`` between ``c`` and ``d`` turned into ``cd``. They must share no triangle."""
    v, w = _diamonds(mesh, half_edges)
    triangles, wraps = mesh.triangles.copy(), mesh.wraps.copy()
    first, second = half_edges // 3, mesh.twin[half_edges] // 3
    triangles[first], wraps[first] = v[:, [0, 3, 2]], w[:, [0, 3, 2]]
    triangles[second], wraps[second] = v[:, [3, 1, 2]], w[:, [3, 1, 2]]
    return replace(mesh, triangles=triangles, wraps=wraps)


def split(mesh: PeriodicMesh, half_edges: Integers) -> PeriodicMesh:
    """Edges cut in their middles, with the triangles at them. They must share no triangle."""
    v, w = _diamonds(mesh, half_edges)
    ends = _placed(mesh.vertices[v[:, :2]], w[:, :2], mesh.length)
    m = mesh.count + np.arange(len(half_edges))
    zero = np.zeros_like(m)
    triangles, wraps = mesh.triangles.copy(), mesh.wraps.copy()
    first, second = half_edges // 3, mesh.twin[half_edges] // 3
    triangles[first], wraps[first] = np.column_stack((v[:, 0], m, v[:, 2])), np.column_stack((w[:, 0], zero, w[:, 2]))
    triangles[second], wraps[second] = np.column_stack((v[:, 1], m, v[:, 3])), np.column_stack((w[:, 1], zero, w[:, 3]))
    more = np.concatenate((np.column_stack((m, v[:, 1:3])), np.column_stack((m, v[:, [0, 3]]))))
    more_wraps = np.concatenate((np.column_stack((zero, w[:, 1:3])), np.column_stack((zero, w[:, [0, 3]]))))
    return PeriodicMesh(
        np.concatenate((mesh.vertices, ends.mean(axis=1))),
        np.concatenate((triangles, more)),
        np.concatenate((wraps, more_wraps)),
        mesh.length,
    )


def may_collapse(mesh: PeriodicMesh, h: int) -> bool:
    """Whether an edge can be collapsed: its ends have only the two vertices across in common, of valence 5 or more."""
    start, order = mesh.star
    valence = np.diff(start)
    a, b = mesh.tail[h], mesh.head[h]
    c, d = mesh.tail[_next(_next(h))], mesh.tail[_next(_next(mesh.twin[h]))]
    rings = [set(mesh.head[order[start[i] : start[i + 1]]].tolist()) for i in (a, b)]
    common = rings[0] & rings[1]
    return bool(common == {int(c), int(d)} and min(valence[c], valence[d]) > 4 and valence[a] + valence[b] <= 12)


def collapsed(mesh: PeriodicMesh, half_edges: Integers) -> PeriodicMesh:
    """Edges shrunk to their middles. They must share no ring of triangles, and each ``may_collapse``."""
    v, w = _diamonds(mesh, half_edges)
    vertices, triangles, wraps = mesh.vertices.copy(), mesh.triangles.copy(), mesh.wraps.copy()
    ends = _placed(mesh.vertices[v[:, :2]], w[:, :2] - w[:, :1], mesh.length)
    vertices[v[:, 0]] = ends.mean(axis=1)
    into = np.arange(mesh.count)
    shift = np.zeros(mesh.count, dtype=np.int64)
    into[v[:, 1]] = v[:, 0]
    shift[v[:, 1]] = w[:, 0] - w[:, 1]
    wraps += shift[triangles]
    triangles = into[triangles]
    gone = np.concatenate((half_edges // 3, mesh.twin[half_edges] // 3))
    kept = np.setdiff1d(np.arange(len(triangles)), gone)
    left = np.setdiff1d(np.arange(mesh.count), v[:, 1])
    number = np.full(mesh.count, -1)
    number[left] = np.arange(len(left))
    return PeriodicMesh(vertices[left], number[triangles[kept]], wraps[kept], mesh.length)
