"""VTK's legacy files, as text and binary: polygons (POLYDATA) and unstructured grids, of versions 1 to 5."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Integers
from pearlbvp.mesh.formats.cells import POLYGON, STRIP, polygons_of
from pearlbvp.mesh.formats.soup import Soup, Unreadable, integers, numbers

TYPES = {
    "char": "i1", "unsigned_char": "u1", "short": "i2", "unsigned_short": "u2", "int": "i4", "unsigned_int": "u4",
    "long": "i8", "unsigned_long": "u8", "vtkidtype": "i8", "vtktypeint64": "i8", "vtktypeint32": "i4", "float": "f4",
    "double": "f8",
}  # fmt: skip
END = ("POINT_DATA", "CELL_DATA")
"""What follows is no part of the surface."""


@dataclass
class _Cursor:
    """Where in a file one is."""

    data: bytes
    binary: bool
    place: int

    def words(self) -> list[str]:
        """The words of the next line that has any; none at the end."""
        while self.place < len(self.data):
            end = self.data.find(b"\n", self.place)
            end = len(self.data) if end < 0 else end
            line, self.place = self.data[self.place : end], end + 1
            if words := line.decode("latin-1").split():
                return words
        return []

    def integers(self, count: int, kind: str = "int") -> Integers:
        """So many whole numbers of a type of VTK's."""
        return np.asarray(self.values(count, kind)).astype(np.int64)

    def values(self, count: int, kind: str) -> NDArray[Any]:
        """So many numbers of a type of VTK's."""
        dtype = np.dtype(">" + TYPES[kind.lower()])
        if not 0 <= count <= len(self.data) - self.place:
            raise Unreadable(f"it declares {count} numbers and ends before them")
        if self.binary:
            found = np.frombuffer(self.data, dtype, count, self.place)
            self.place += found.nbytes
            return found
        pattern = re.compile(rb"\S+")
        words: list[str] = []
        while len(words) < count and (match := pattern.search(self.data, self.place)):
            words.append(match.group().decode("latin-1"))
            self.place = match.end()
        if len(words) < count:
            raise Unreadable(f"it declares {count} numbers and ends before them")
        return np.array(numbers(words) if dtype.kind == "f" else integers(words), dtype=dtype.newbyteorder("="))


def read_vtk(data: bytes) -> Soup:
    """The polygons of a legacy VTK file.

    Raises:
        Unreadable: another data set, or counts that do not fit.
    """
    head = re.match(rb"# vtk DataFile Version (\d+)\.\d+\s*?\n[^\n]*\n\s*(ASCII|BINARY)\s*?\n", data, re.IGNORECASE)
    if not head:
        raise Unreadable("it does not begin as a VTK file does")
    cursor = _Cursor(data, head[2].upper() == b"BINARY", head.end())
    if (words := [word.upper() for word in cursor.words()]) not in (
        ["DATASET", "POLYDATA"],
        ["DATASET", "UNSTRUCTURED_GRID"],
    ):
        raise Unreadable(
            f"its data set is {' '.join(words[1:2]) or 'missing'}; write it as POLYDATA or UNSTRUCTURED_GRID"
        )
    points, kinds, cells = None, None, []
    while words := cursor.words():
        name = words[0].upper()
        if name in END:
            break
        if name == "POINTS":
            points = np.asarray(cursor.values(3 * integers(words[1:2])[0], words[2]), dtype=float).reshape(-1, 3)
        elif name in ("CELLS", "POLYGONS", "TRIANGLE_STRIPS", "LINES", "VERTICES"):
            count, size = integers(words[1:3])
            found = _cells(cursor, count, size)
            if name not in ("LINES", "VERTICES"):
                cells.append((name, *found))
        elif name == "CELL_TYPES":
            kinds = cursor.integers(integers(words[1:2])[0])
        elif name == "METADATA":  # ends with an empty line
            end = re.compile(rb"\n\s*?\n").search(data, cursor.place - 1)
            cursor.place = end.end() if end else len(data)
        elif name == "FIELD":
            _pass_field(cursor, integers(words[2:3])[0])
        else:
            raise Unreadable(f"its section {words[0][:20]!r} is not understood")
    if points is None or not cells:
        raise Unreadable("it has no faces")
    parts = []
    for name, corners, starts in cells:
        kind = STRIP if name == "TRIANGLE_STRIPS" else POLYGON
        own = np.full(len(starts) - 1, kind) if name != "CELLS" else kinds
        if own is None:
            raise Unreadable("its cells have no CELL_TYPES")
        parts.append(polygons_of(corners, starts, own))
    return Soup.joined(points, parts)


def _cells(cursor: _Cursor, count: int, size: int) -> tuple[Integers, Integers]:
    """Corners and where each cell's begin: as lists with their lengths, or, from version 5.1 on, as two arrays."""
    mark = cursor.place
    words = cursor.words()
    if words[:1] == ["OFFSETS"]:
        offsets = cursor.integers(count, words[1])
        words = cursor.words()
        if words[:1] != ["CONNECTIVITY"] or not len(offsets):
            raise Unreadable("its cells have OFFSETS without CONNECTIVITY")
        return cursor.integers(size, words[1]), offsets
    cursor.place = mark
    flat = cursor.integers(size).tolist()
    corners: list[int] = []
    starts = [0]
    place = 0
    while place < len(flat):
        length = flat[place]
        if length < 0:
            break
        corners += flat[place + 1 : place + 1 + length]
        place += 1 + length
        starts.append(starts[-1] + length)
    if place != size or len(starts) != count + 1:
        raise Unreadable(f"its {count} cells are not those of the {size} numbers that it declares")
    return np.array(corners, dtype=np.int64), np.array(starts)


def _pass_field(cursor: _Cursor, count: int) -> None:
    for _ in range(count):
        words = cursor.words()
        while words[:1] == ["METADATA"]:
            while cursor.data[cursor.place : cursor.place + 1] not in (b"\n", b""):
                cursor.words()
            words = cursor.words()
        width, rows = integers(words[1:3])
        cursor.values(width * rows, words[3])
