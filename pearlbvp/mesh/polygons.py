"""Polygons split into triangles: quads along the diagonal that stays inside, longer ones ear by ear."""

from __future__ import annotations

import numpy as np

from pearlbvp.arrays import Array, Integers
from pearlbvp.errors import InputError

TIE = 1e-3
"""Relative difference of a quad's diagonals below which they are equally long, and the first is taken: digits do not decide."""

LONGEST = 5000
"""Corners of a polygon at most."""


def split(points: Array, corners: Integers, sizes: Integers, first: int = 0) -> Integers:
    """Places in ``corners`` of all triangles' corners, shape (T, 3), and of which polygon each is, as a fourth column.

    Polygons need not be flat, nor convex: what is inside is seen along the mean normal.

    Args:
        points: shape (P, 3).
        corners, sizes: of polygons of three corners or more, as a ``Soup`` has them.
        first: number of the first polygon in messages.

    Raises:
        InputError: a polygon crosses itself, or has too many corners.
    """
    begin = np.cumsum(sizes) - sizes
    found = []
    for size in np.unique(sizes):
        faces = np.flatnonzero(sizes == size)
        places = begin[faces, None] + np.arange(size)
        if size == 3:
            found.append(np.column_stack((places, faces)))
        elif size == 4:
            found.append(_quads(points, corners[places], places, faces))
        else:
            for face, own in zip(faces, places, strict=True):
                ears = None if size > LONGEST else _ears(points[corners[own]])
                if ears is None:
                    raise InputError(
                        "triangles",
                        f"the polygon {face + first} of {size} corners (counted from {first} on) "
                        "crosses itself, or has too many",
                        "split it into triangles",
                    )
                found.append(np.column_stack((own[ears], np.full(len(ears), face))))
    triangles = np.concatenate(found)
    return triangles[np.argsort(triangles[:, 3], kind="stable")]


def _normals(points: Array) -> Array:
    """Area vectors of polygons, shape (..., n, 3), doubled: the sum over any triangles that fill them."""
    return np.cross(points, np.roll(points, -1, axis=-2)).sum(axis=-2)


def _quads(points: Array, corners: Integers, places: Integers, faces: Integers) -> Integers:
    """Two triangles of each quad: along the shorter diagonal, of those on whose both sides it lies."""
    at = points[corners]
    at = at - at.mean(axis=1, keepdims=True)
    normal = _normals(at)
    ways = np.array([[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]])
    areas = np.einsum("wtqx,qx->wqt", _normals(at[:, ways]).transpose(1, 2, 0, 3), normal)
    inside = (areas > 0).all(axis=2)
    long = np.linalg.norm(at[:, [0, 1]] - at[:, [2, 3]], axis=2).T
    second = np.where(inside[0] == inside[1], long[1] < (1 - TIE) * long[0], inside[1])
    chosen = ways[second.astype(int)]
    triangles = np.take_along_axis(places, chosen.reshape(-1, 6), axis=1).reshape(-1, 3)
    return np.column_stack((triangles, np.repeat(faces, 2)))


def _ears(points: Array) -> Integers | None:
    """Triangles of a polygon, shape (n - 2, 3): each cuts off the ear with the shortest diagonal. None if it crosses itself."""
    points = points - points.mean(axis=0)
    normal = _normals(points)
    size = np.linalg.norm(normal)
    if size == 0:  # it encloses nothing: any triangles will do, and have no area
        return np.array([[0, i, i + 1] for i in range(1, len(points) - 1)])
    across = np.linalg.svd(normal[None])[2][1:]
    flat = points @ across.T
    if np.dot(np.cross(*across), normal) < 0:
        flat = flat[:, ::-1]
    left = np.arange(len(points))
    found = []
    while len(left) > 3:
        before, here, after = flat[np.roll(left, 1)], flat[left], flat[np.roll(left, -1)]
        turns = _turn(before, here, after)
        bent = here[turns <= 0]
        for i in np.argsort(np.linalg.norm(after - before, axis=1)):
            if turns[i] > 0 and not _holds(bent, before[i], here[i], after[i]):
                break
        else:
            straight = np.flatnonzero(np.abs(turns) <= 1e-12 * size)
            if not len(straight):
                return None
            i = straight[0]
        found.append([left[i - 1], left[i], left[(i + 1) % len(left)]])
        left = np.delete(left, i)
    found.append(list(left))
    return np.array(found)


def _turn(a: Array, b: Array, c: Array) -> Array:
    """Twice the area of triangles in the plane, positive if they turn left."""
    (x, y), (p, q) = (b - a).T, (c - a).T
    return np.asarray(x * q - y * p)


def _holds(points: Array, a: Array, b: Array, c: Array) -> bool:
    """Whether a triangle has any of the points in it that is not its corner."""
    own = np.array([(points == corner).all(axis=1) for corner in (a, b, c)]).any(axis=0)
    points = points[~own]
    sides = [_turn(p, q, points) if len(points) else np.zeros(0) for p, q in ((a, b), (b, c), (c, a))]
    return bool((np.array(sides) >= 0).all(axis=0).any())
