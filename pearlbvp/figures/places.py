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

TRIED = 400
"""Places, the nearest ones first, among which one is sought whose line to what it belongs to crosses no other picture."""

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


def free_places(taken: Mask, boxes: Sequence[Cell], belonging: Sequence[tuple[float, float]]) -> list[Cell | None]:
    """Lower left corners of boxes that lie on no cell that is taken and not on each other, each near what it belongs to.

    Args:
        taken: cells, shape (columns, rows).
        boxes: their columns and rows.
        belonging: the cell that each belongs to.

    Returns:
        A corner for each box, or None where no place is free.
    """
    taken, pictures = taken.copy(), np.zeros_like(taken)
    found: list[Cell | None] = []
    for (width, height), (x, y) in zip(boxes, belonging, strict=True):
        corner = _place(taken, pictures, (width, height), (x, y))
        found.append(corner)
        if corner is not None:
            part = np.s_[corner[0] : corner[0] + width, corner[1] : corner[1] + height]
            taken[part] = pictures[part] = True
            _mark(taken, (x, y), nearest((x, y), corner, (width, height)))
    return found


def nearest(point: tuple[float, float], corner: Cell, box: Cell) -> tuple[float, float]:
    """The point of a box that is nearest to another."""
    x, y = (min(max(at, low), low + size) for at, low, size in zip(point, corner, box, strict=True))
    return float(x), float(y)


def _place(taken: Mask, pictures: Mask, box: Cell, point: tuple[float, float]) -> Cell | None:
    """The free place nearest to a point, its line to that over no picture if there is such a one."""
    sums = np.pad(taken.astype(np.int64).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    width, height = box
    if width > taken.shape[0] or height > taken.shape[1]:
        return None
    inside = sums[width:, height:] - sums[:-width, height:] - sums[width:, :-height] + sums[:-width, :-height]
    free = np.argwhere(inside == 0)
    if not len(free):
        return None
    gaps = np.maximum(np.maximum(free - np.array(point), np.array(point) - free - np.array(box)), 0)
    near = free[np.argsort(np.hypot(*gaps.T), kind="stable")[:TRIED]]
    for corner in near:
        place = int(corner[0]), int(corner[1])
        if not pictures[_cells(pictures.shape, point, nearest(point, place, box))].any():
            return place
    return int(near[0][0]), int(near[0][1])
