"""Cells as VTK's files have them: offsets into a list of corners, and what kind each cell is."""

from __future__ import annotations

import numpy as np

from pearlbvp.arrays import Integers
from pearlbvp.mesh.formats.soup import Polygons, Unreadable, strips

TRIANGLE, STRIP, POLYGON, QUAD = 5, 6, 7, 9
IDLE = (1, 2, 3, 4)
"""Points and lines, which are no part of the surface."""


def polygons_of(corners: Integers, starts: Integers, kinds: Integers) -> Polygons:
    """Triangles, quads, polygons and strips as polygons.

    Args:
        corners: of the cells, one after the other.
        starts: where each cell's corners begin, and the end, shape (C + 1,).
        kinds: VTK's numbers of the cells' kinds, shape (C,).

    Raises:
        Unreadable: the arrays do not fit each other, or there are cells of other kinds.
    """
    sizes = np.diff(starts)
    if len(sizes) != len(kinds) or starts[0] != 0 or starts[-1] != len(corners) or (sizes < 0).any():
        raise Unreadable("its cells are not as many, or not as long, as it declares")
    if (other := kinds[~np.isin(kinds, (TRIANGLE, STRIP, POLYGON, QUAD, *IDLE))]).size:
        raise Unreadable(f"it has cells of kind {other[0]}; write its surface as triangles, quads or polygons")
    if (sizes[kinds == TRIANGLE] != 3).any() or (sizes[kinds == QUAD] != 4).any():
        raise Unreadable("a triangle or quad of it has another number of corners")
    whole = np.isin(kinds, (TRIANGLE, POLYGON, QUAD))
    pieces = strips(corners[starts[i] : starts[i + 1]].tolist() for i in np.flatnonzero(kinds == STRIP))
    return (
        np.concatenate((corners[np.repeat(whole, sizes)], np.array(pieces, dtype=np.int64).ravel())),
        np.concatenate((sizes[whole], np.full(len(pieces), 3))),
    )
