"""Places for small pictures in a large one: none hides what is drawn already, or another."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

Mask = NDArray[np.bool_]
Cell = tuple[int, int]
"""Column from the left, row from below."""

STRIDE = 4
"""Cells between the places that are tried, the nearest ones first, for one whose line to what it belongs to crosses little."""

CROSSED, HIDDEN = 15, 50
"""Cells by which a place may be farther away for a line over one curve less, or over one cell less of a picture."""

CLEAR = 5
"""Cells about a point that are left to its own picture."""

MARGIN = 2
"""Cells that stay free about lines."""


def covered(shape: Cell, lines: Sequence[NDArray[np.float64]]) -> Mask:
    """The cells through which lines run, and a margin about them, shape (columns, rows).

    Args:
        shape: columns and rows of the picture.
        lines: points in cells, each of shape (N, 2); one that is not finite interrupts a line.
    """
    mask = np.zeros(shape, dtype=bool)
    for line in lines:
        for start, end in pairwise(line):
            if np.isfinite(start + end).all():
                _mark(mask, start, end)
    return np.asarray(binary_dilation(mask, iterations=MARGIN))


def _cells(shape: Cell, start: Sequence[float], end: Sequence[float]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Cells on a straight line that are in the picture."""
    begin, way = np.asarray(start, dtype=float), np.asarray(end, dtype=float) - np.asarray(start, dtype=float)
    count = min(int(2 * np.abs(way).max()) + 2, 4000)
    found = np.floor(begin + np.linspace(0, 1, count)[:, None] * way).astype(int)
    inside = ((found >= 0) & (found < np.array(shape))).all(axis=1)
    return found[inside, 0], found[inside, 1]


def _mark(mask: Mask, start: Sequence[float], end: Sequence[float]) -> None:
    mask[_cells(mask.shape, start, end)] = True


def free_places(
    taken: Mask,
    boxes: Sequence[Cell],
    belonging: list[tuple[float, float]],
    pictures: Sequence[NDArray[np.float64]] | None = None,
) -> list[Cell | None]:
    """Lower left corners of boxes that lie on no cell that is taken and not on each other, each near what it belongs to.

    Args:
        taken: cells, shape (columns, rows).
        boxes: their columns and rows.
        belonging: the cell that each belongs to.
        pictures: what is seen in each box, as points from its corner, shape (N, 2); by default its corners.

    Returns:
        A corner for each box, or None where no place is free.
    """
    if pictures is None:
        pictures = [
            np.array([[0, 0], [width, 0], [0, height], [width, height]], dtype=float) for width, height in boxes
        ]
    taken, seen = taken.copy(), np.zeros_like(taken)
    columns, rows = np.indices(taken.shape)
    found: list[Cell | None] = []
    for k, (box, picture, (x, y)) in enumerate(zip(boxes, pictures, belonging, strict=True)):
        kept = taken.copy()
        for other in belonging[:k] + belonging[k + 1 :]:
            kept |= np.hypot(columns - other[0], rows - other[1]) < CLEAR
        corner = _place(kept, taken, seen, box, picture, (x, y)) or _place(taken, taken, seen, box, picture, (x, y))
        found.append(corner)
        if corner is not None:
            taken[corner[0] : corner[0] + box[0], corner[1] : corner[1] + box[1]] = True
            inside = np.minimum((picture + corner).astype(int), np.array(taken.shape) - 1)
            seen[inside[:, 0], inside[:, 1]] = True
            _mark(taken, (x, y), _nearest((x, y), corner, picture))
    return found


def _nearest(point: tuple[float, float], corner: Cell, picture: NDArray[np.float64]) -> tuple[float, float]:
    """The point of a picture that is nearest to another."""
    there = picture + np.array(corner)
    x, y = there[np.square(there - point).sum(axis=1).argmin()]
    return float(x), float(y)


def _place(
    taken: Mask, crossed: Mask, seen: Mask, box: Cell, picture: NDArray[np.float64], point: tuple[float, float]
) -> Cell | None:
    """The free place near a point whose line to that runs over as few pictures and curves as there may be."""
    sums = np.pad(taken.astype(np.int64).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    width, height = box
    if width > taken.shape[0] or height > taken.shape[1]:
        return None
    inside = sums[width:, height:] - sums[:-width, height:] - sums[width:, :-height] + sums[:-width, :-height]
    free = np.argwhere(inside == 0)
    if not len(free):
        return None
    gaps = np.maximum(np.maximum(free - np.array(point), np.array(point) - free - np.array(box)), 0)
    far = np.hypot(*gaps.T)
    order = np.argsort(far, kind="stable")
    apart = order[(free[order] % STRIDE == 0).all(axis=1)]
    best, least = free[order[0]], np.inf
    for i in [order[0], *apart]:
        if far[i] >= least:
            break
        line = _cells(taken.shape, point, _nearest(point, (int(free[i][0]), int(free[i][1])), picture))
        curves = np.count_nonzero(np.diff(crossed[line].astype(int)) == 1)
        cost = far[i] + CROSSED * curves + HIDDEN * np.count_nonzero(seen[line])
        if cost < least:
            best, least = free[i], cost
    return int(best[0]), int(best[1])
