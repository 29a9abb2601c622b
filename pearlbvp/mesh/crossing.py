"""Does a triangulated surface pass through itself? Each triangle against those near it that share no corner with it.

Triangles are sorted into cubes as large as the largest of them, so that two which meet lie in neighbouring cubes. Two
triangles in general position intersect if and only if an edge of one passes through the other, which signs of volumes tell
(P. J. Schneider, D. H. Eberly, Geometric Tools for Computer Graphics (Morgan Kaufmann 2003), §11.7).
"""

from __future__ import annotations

import numpy as np

from pearlbvp.compiled import compiled
from pearlbvp.mesh.periodic import PeriodicMesh

MOST_CUBES = 8
"""By the number of triangles: beyond, cubes are larger, for those of a slender coil would be mostly empty."""


def crossing_triangles(mesh: PeriodicMesh) -> tuple[int, int] | None:
    """Numbers of two triangles of a mesh, or of its next periods, that pass through each other; None where none do.

    Those that share a corner are left out: a surface that passes through itself there does so beside it, too.

    Examples:
        >>> from pearlbvp.mesh.families import tube_mesh
        >>> crossing_triangles(tube_mesh(10, 400)) is None
        True
    """
    corners = mesh.corners
    low, high = corners.min(axis=1), corners.max(axis=1)
    middles = (low + high) / 2
    shift = -mesh.length * np.floor(middles[:, 0] / mesh.length)
    corners, low, high, middles = (points.copy() for points in (corners, low, high, middles))
    corners[:, :, 0] += shift[:, None]
    for points in (low, high, middles):
        points[:, 0] += shift
    spread = np.array([mesh.length, *np.ptp(middles[:, 1:], axis=0)])
    size = max(float((high - low).max()), float(np.prod(spread + 1e-300) / (MOST_CUBES * len(corners))) ** (1 / 3))
    counts = np.maximum(1, np.floor(spread / size)).astype(np.int64)
    origin = np.array([0.0, *middles[:, 1:].min(axis=0)])
    cubes = np.minimum(((middles - origin) / (spread + 1e-300) * counts).astype(np.int64), counts - 1)
    number = (cubes[:, 0] * counts[1] + cubes[:, 1]) * counts[2] + cubes[:, 2]
    order = np.argsort(number, kind="stable")
    first = np.searchsorted(number[order], np.arange(np.prod(counts) + 1))
    found = np.full(2, -1)
    _search(corners, low, high, mesh.triangles, cubes, counts, order, first, mesh.length, np.empty((3, 3)), found)
    return None if found[0] < 0 else (int(found[0]), int(found[1]))


@compiled
def _side(a, b, c, p):  # type: ignore[no-untyped-def]
    """Six volumes of the tetrahedron ``a, b, c, p``, by their sign on which side of the plane ``p`` lies."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    wx, wy, wz = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    return (uy * vz - uz * vy) * wx + (uz * vx - ux * vz) * wy + (ux * vy - uy * vx) * wz


@compiled
def _pierces(one, other):  # type: ignore[no-untyped-def]
    """Whether an edge of a triangle passes through the inside of another."""
    a, b, c = other[0], other[1], other[2]
    s, t, u = _side(a, b, c, one[0]), _side(a, b, c, one[1]), _side(a, b, c, one[2])
    if (s >= 0 and t >= 0 and u >= 0) or (s <= 0 and t <= 0 and u <= 0):
        return False
    for i in range(3):
        p, q = one[i], one[(i + 1) % 3]
        before, after = (s, t, u)[i], (s, t, u)[(i + 1) % 3]
        if before * after < 0:
            x, y, z = _side(p, q, a, b), _side(p, q, b, c), _side(p, q, c, a)
            if (x > 0 and y > 0 and z > 0) or (x < 0 and y < 0 and z < 0):
                return True
    return False


@compiled
def _apart(low, high, i, j, shift):  # type: ignore[no-untyped-def]
    """Whether the boxes around two triangles have no point in common, the second shifted along ``x``."""
    if low[i, 0] > high[j, 0] + shift or low[j, 0] + shift > high[i, 0]:
        return True
    if low[i, 1] > high[j, 1] or low[j, 1] > high[i, 1]:
        return True
    return low[i, 2] > high[j, 2] or low[j, 2] > high[i, 2]


@compiled
def _search(corners, low, high, triangles, cubes, counts, order, first, length, moved, found):  # type: ignore[no-untyped-def]
    """Fill in the numbers of the first two triangles that pass through each other."""
    for i in range(len(corners)):
        for along in range(-1, 2):
            # On fewer than three cubes along the tube a neighbour is one on both sides.
            if counts[0] < 3 and along > counts[0] - 2:
                continue
            x = (cubes[i, 0] + along) % counts[0]
            for y in range(max(cubes[i, 1] - 1, 0), min(cubes[i, 1] + 2, counts[1])):
                for z in range(max(cubes[i, 2] - 1, 0), min(cubes[i, 2] + 2, counts[2])):
                    cube = (x * counts[1] + y) * counts[2] + z
                    for place in range(first[cube], first[cube + 1]):
                        j = order[place]
                        if j <= i:
                            continue
                        away = (low[i, 0] + high[i, 0] - low[j, 0] - high[j, 0]) / 2
                        shift = length * np.floor(away / length + 0.5)
                        if _apart(low, high, i, j, shift):
                            continue
                        together = False
                        for k in range(3):
                            for m in range(3):
                                together = together or triangles[i, k] == triangles[j, m]
                        if together:
                            continue
                        for k in range(3):
                            for m in range(3):
                                moved[k, m] = corners[j, k, m]
                            moved[k, 0] += shift
                        if _pierces(corners[i], moved) or _pierces(moved, corners[i]):
                            found[0], found[1] = i, j
                            return
