"""Where a tube in a file begins again: its axis, and which of its points are one a period apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix

from pearlbvp.arrays import Array, Integers
from pearlbvp.errors import InputError
from pearlbvp.mesh.caps import edges_of, loops_of, translation
from pearlbvp.mesh.repair import joined_points

SEAM = 1e-2
"""Distance, in the shortest edge there, at which two points a period apart are one: formats differ in their digits."""

PERIOD = 2e-5
"""Relative difference between the period that is given and that of a file at which they are the same."""

DOUBT = 4.0
"""Standard errors by which the period of a tube without ends may differ from that at which its seam is smoothest."""

NAMES = "xyz"


@dataclass(frozen=True)
class Seam:
    """How a tube repeats.

    Attributes:
        axis: unit vector along which it does, in the file.
        vertex: the vertex that each point is, shape (P,), by the first of the points that are one.
        wraps: periods by which the triangles' corners are shifted from there, shape (T, 3).
        apart: largest distance, but for whole periods, between points that are one.
        said: what a user should know of it.
    """

    axis: Array
    vertex: Integers
    wraps: Integers
    apart: float
    said: str = ""


def turned(points: Array, axis: Array) -> Array:
    """Points turned so that the axis lies along ``x``: coordinates exchanged where it is one of them, else the least turn."""
    along = np.flatnonzero(axis == 1)
    if len(along):
        return np.roll(points, -int(along[0]), axis=1)
    cross = np.array([0.0, axis[2], -axis[1]])  # of the axis and x
    matrix = np.array([[0, -cross[2], cross[1]], [cross[2], 0, -cross[0]], [-cross[1], cross[0], 0]])
    return np.asarray(points @ (np.eye(3) + matrix + matrix @ matrix / (1 + axis[0])).T)


def named(axis: Array) -> str:
    """The axis in words."""
    along = np.flatnonzero(axis == 1)
    return NAMES[along[0]] if len(along) else f"({', '.join(f'{value:.4g}' for value in axis)})"


def _axis(vector: Array) -> Array:
    """The unit vector along a vector or against it, whose largest part is positive; a coordinate's where it is all but that."""
    vector = vector / np.linalg.norm(vector)
    largest = int(np.abs(vector).argmax())
    vector = vector * np.sign(vector[largest])
    return np.eye(3)[largest] if np.abs(np.delete(vector, largest)).max() < PERIOD else np.asarray(vector)


def of_ends(points: Array, triangles: Integers, length: float) -> Seam:
    """The seam of a tube that is cut open: its ends are the same but for a period, whatever the cut.

    Args:
        points: shape (P, 3).
        triangles: shape (T, 3), with one point for each place.
        length: the period.

    Raises:
        InputError: the ends are not the same, or not a period apart.
    """
    edges, _, count = edges_of(triangles)
    rim = edges[count == 1]
    ends = loops_of(rim)
    near = SEAM * float(np.linalg.norm(points[rim[:, 0]] - points[rim[:, 1]], axis=1).min())
    steps = _translations(points, ends, near)
    candidates = [_axis(step) for step in steps if abs(np.linalg.norm(step) / length - 1) < PERIOD]
    candidates += list(np.eye(3)[[0, 2, 1]])
    best: Seam | None = None
    most = 0
    for axis in candidates:
        seam, left = _joined(points, triangles, rim, axis, length, near)
        if left == 0:
            return seam
        if (found := len(rim) - left) > most:
            best, most = seam, found
    if len(ends) == 2 and steps:
        raise _other_period(points, triangles, length, float(np.linalg.norm(steps[0])), _axis(steps[0]))
    if best is not None:
        return best  # with a hole, which the mesh's own check names
    raise _no_period(points[np.unique(triangles)], length, len(ends))


def _translations(points: Array, ends: list[Integers], near: float) -> list[Array]:
    """Vectors by which one end is another."""
    few = ends if len(ends) <= 8 else []
    found = (translation(points[few[i]], points[few[j]], near) for i in range(len(few)) for j in range(i))
    return [step for step in found if step is not None]


def _joined(
    points: Array, triangles: Integers, rim: Integers, axis: Array, length: float, near: float
) -> tuple[Seam, int]:
    """The seam if the tube repeats along an axis, and how many edges of its ends find no other by that."""
    own = np.unique(rim)
    at = turned(points[own], axis)
    angle, circle = 2 * np.pi * at[:, 0] / length, length / (2 * np.pi)
    first = joined_points(np.column_stack((circle * np.cos(angle), circle * np.sin(angle), at[:, 1:])), near)
    vertex, wrap = np.arange(len(points)), np.zeros(len(points), dtype=np.int64)
    vertex[own] = own[first]
    away = at - at[first]
    wrap[own] = np.round(away[:, 0] / length).astype(np.int64)
    away[:, 0] -= length * wrap[own]
    seam = Seam(axis, vertex, wrap[triangles], float(np.linalg.norm(away, axis=1).max()))
    shifted = np.column_stack((vertex[rim], wrap[rim[:, 1]] - wrap[rim[:, 0]]))
    back = shifted[:, 0] > shifted[:, 1]
    shifted[back] = shifted[back][:, [1, 0, 2]] * [1, 1, -1]
    _, number = np.unique(shifted, axis=0, return_counts=True)
    if not wrap.any():
        return seam, len(rim)
    return seam, int(number[number != 2].sum())


def overlap(points: Array, length: float, near: float) -> Integers | None:
    """Two points that lie at the same place but for whole periods along ``x``; None if there are none."""
    angle, circle = 2 * np.pi * points[:, 0] / length, length / (2 * np.pi)
    first = joined_points(np.column_stack((circle * np.cos(angle), circle * np.sin(angle), points[:, 1:])), near)
    again = np.flatnonzero(first != np.arange(len(points)))
    return np.array([first[again[0]], again[0]]) if len(again) else None


def _extent(points: Array) -> str:
    low, high = points[:, 0].min(), points[:, 0].max()
    return f"x, which runs from {low:.6g} to {high:.6g}"


def _no_period(points: Array, length: float, ends: int) -> InputError:
    others = ", ".join(f"{name} from {a:.6g} to {b:.6g}" for name, a, b in
                       zip("yz", points.min(axis=0)[1:], points.max(axis=0)[1:], strict=True))  # fmt: skip
    what = "its two ends do not match" if ends == 2 else f"it has {ends} open {'ends' if ends > 1 else 'end'} or holes"
    return InputError(
        "length",
        f"no two points of the file lie {length:g} apart along {_extent(points)} ({others}), and {what}",
        "give the tube's period, of a tube whose ends are the same",
    )


def _other_period(points: Array, triangles: Integers, length: float, found: float, axis: Array) -> InputError:
    along = turned(points[np.unique(triangles)], axis)[:, 0]
    if (periods := round(found / length)) > 1 and abs(found / (periods * length) - 1) < PERIOD:
        return InputError(
            "length",
            f"the file runs from {named(axis)} = {along.min():.6g} to {along.max():.6g}, {periods} periods of {length:g}",
            "give the period of the whole, or a file of one period",
        )
    extent = _extent(points[np.unique(triangles)])
    return InputError(
        "length",
        f"no two points of the file lie {length:g} apart along {extent}, and its ends are the same {found:.6g} apart "
        f"along {named(axis)}",
        "give that as the period",
    )


def of_wrapped(points: Array, triangles: Integers, length: float) -> Seam | None:
    """The seam of a tube without ends, some triangles of which lead from its last vertices back to its first; None if none do.

    Such triangles are long: each edge is taken to lead to the nearest image of its end. Nothing in the file says how far on the
    first vertices follow, but that the surface is as smooth there as elsewhere: the vector with which it is smoothest has to
    be the period, along a coordinate or along itself.

    Raises:
        InputError: it is smooth there with another period.
    """
    used, number = np.unique(triangles, return_inverse=True)
    size, points, triangles = len(points), points[used], number.reshape(-1, 3)
    ends = np.column_stack((triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()))
    steps = points[ends[:, 1]] - points[ends[:, 0]]
    longest = steps[np.linalg.norm(steps, axis=1).argmax()]
    other = None
    for axis in (*np.eye(3)[[0, 2, 1]], _axis(longest)):
        for _ in range(3):
            shift = -np.round(steps @ axis / length).astype(np.int64)
            if not shift.any() or shift.reshape(-1, 3).sum(axis=1).any():
                break
            step, doubt = _smoothest(points, ends, shift)
            if np.linalg.norm(step - length * axis) <= DOUBT * doubt:
                wraps = np.column_stack((0 * shift[::3], shift[::3], -shift[2::3]))
                leading = int((wraps != 0).any(axis=1).sum())
                said = f"let {leading} triangles lead on into the next period (by the mesh {np.linalg.norm(step):.4g}"
                return Seam(axis, np.arange(size), wraps, 0.0, f"{said} +- {max(DOUBT * doubt, 1e-4 * length):.1g})")
            if abs(np.linalg.norm(step) - length) > DOUBT * doubt:
                other = other or (float(np.linalg.norm(step)), named(_axis(step)))
                break
            axis = _axis(step)
    if other is not None:
        raise InputError(
            "length",
            f"its triangles lead on to where it begins smoothly after {other[0]:.4g} along {other[1]}, "
            f"and not after {length:g}",
            "give its period, or a file whose last vertices are its first ones a period on",
        )
    return None


def _smoothest(points: Array, ends: Integers, shift: Integers) -> tuple[Array, float]:
    """The period, as a vector, with which the surface is smoothest at its seam, and the standard error of that.

    Least squares of the second differences of second differences over the graph of edges, which are linear in the period
    at the seam; what they are elsewhere is their error.
    """
    size = len(points)
    tail, head = np.concatenate((ends, ends[:, ::-1])).T
    graph = coo_matrix((np.ones(len(tail)), (tail, head)), shape=(size, size)).tocsr()
    degree = np.bincount(tail, minlength=size)

    def differences(values: Array) -> Array:
        return np.asarray((graph @ values) / degree[:, None] - values)

    steps = np.bincount(tail, np.concatenate((shift, -shift)), minlength=size) / degree
    seen, known = differences(steps[:, None])[:, 0], differences(differences(points))
    elsewhere = known[np.abs(seen) < 1e-12]
    spread = np.linalg.norm(elsewhere) / np.sqrt(max(len(elsewhere), 1))
    weight = max(float(seen @ seen), 1e-300)
    return np.asarray(-(seen @ known) / weight), float(spread / np.sqrt(weight))
