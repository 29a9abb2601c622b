"""VTK's XML files of surfaces, VTU and VTP: text, base64 and appended data, compressed or not, of any version and pieces."""

from __future__ import annotations

import base64
import lzma
import zlib
from dataclasses import dataclass
from itertools import accumulate, pairwise
from xml.etree import ElementTree

import numpy as np

from pearlbvp.arrays import Array, Integers
from pearlbvp.mesh.formats.cells import POLYGON, STRIP, polygons_of
from pearlbvp.mesh.formats.soup import Polygons, Soup, Unreadable, integers, numbers

TYPES = {
    "Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4", "UInt32": "u4", "Int64": "i8",
    "UInt64": "u8", "Float32": "f4", "Float64": "f8",
}  # fmt: skip
MOST_BYTES = 1 << 30
"""Of one array, however well it is compressed."""


@dataclass(frozen=True)
class _Coding:
    """How the arrays of a file are written.

    Attributes:
        order: ``<`` or ``>``.
        header: type of the lengths before an array.
        compressor: empty without one.
        appended: the bytes of the appended data, behind their underscore.
        is_raw: whether those are bytes, and not base64.
    """

    order: str
    header: np.dtype[np.generic]
    compressor: str
    appended: bytes
    is_raw: bool


def read_xml(data: bytes) -> Soup:
    """The polygons of a VTU or VTP file.

    Raises:
        Unreadable: another data set, arrays that do not fit, or a compression that is not read (LZ4).
    """
    head, appended, is_raw = _parts(data)
    if b"<!DOCTYPE" in head or b"<!ENTITY" in head:
        raise Unreadable("it declares entities, which no mesh needs")
    try:
        root = ElementTree.fromstring(head)
    except ElementTree.ParseError:
        raise Unreadable("its XML is broken or cut off") from None
    kind = root.get("type", "")
    grid = root.find(kind) if kind in ("UnstructuredGrid", "PolyData") else None
    if root.tag != "VTKFile" or grid is None:
        raise Unreadable(f"its data set is {kind[:30] or 'missing'}; write it as UnstructuredGrid or PolyData")
    header = TYPES.get(root.get("header_type", "UInt32"), "u4")
    order = {"LittleEndian": "<", "BigEndian": ">"}.get(root.get("byte_order", "LittleEndian"))
    if order is None:
        raise Unreadable("its byte_order is neither LittleEndian nor BigEndian")
    coding = _Coding(order, np.dtype(order + header), root.get("compressor", ""), appended, is_raw)
    points: list[Array] = [np.zeros((0, 3))]
    polygons: list[Polygons] = []
    before = 0
    for piece in grid.findall("Piece"):
        points.append(_points(piece, coding))
        polygons += [(corners + before, sizes) for corners, sizes in _polygons(piece, kind, coding, len(points[-1]))]
        before += len(points[-1])
    return Soup.joined(np.concatenate(points), polygons)


def _parts(data: bytes) -> tuple[bytes, bytes, bool]:
    """The XML without appended data, those data, and whether they are raw: then they are no XML."""
    begin = data.find(b"<AppendedData")
    if begin < 0:
        return data, b"", False
    tag = data.find(b">", begin) + 1
    mark, end = data.find(b"_", tag), data.rfind(b"</AppendedData>")
    if tag <= 0 or mark < 0 or end < mark:
        raise Unreadable("its appended data are cut off")
    return data[:tag] + data[end:], data[mark + 1 : end], b"raw" in data[begin:tag]


def _declared(piece: ElementTree.Element, what: str) -> int:
    """How many points or cells a piece declares."""
    try:
        return integers([piece.get(f"NumberOf{what}", "0")])[0]
    except (ValueError, OverflowError):
        raise Unreadable(f"a piece of it does not say how many {what} it has") from None


def _points(piece: ElementTree.Element, coding: _Coding) -> Array:
    """Points of one piece, shape (P, 3)."""
    count = _declared(piece, "Points")
    if count == 0:
        return np.zeros((0, 3))
    values = _array(piece.find("Points/DataArray"), coding)
    if len(values) != 3 * count:
        raise Unreadable(f"a piece of it has {len(values)} coordinates and declares {count} points")
    return values.astype(float).reshape(-1, 3)


def _polygons(piece: ElementTree.Element, kind: str, coding: _Coding, count: int) -> list[Polygons]:
    """Polygons of one piece of so many points, which count from its own first point."""
    found = []
    for name, cell in (("Cells", 0),) if kind == "UnstructuredGrid" else (("Polys", POLYGON), ("Strips", STRIP)):
        declared = _declared(piece, name)
        if declared == 0:
            continue
        arrays = {array.get("Name"): array for array in piece.findall(f"{name}/DataArray")}
        corners, ends = (_array(arrays.get(key), coding).astype(np.int64) for key in ("connectivity", "offsets"))
        kinds = np.full(declared, cell) if cell else _array(arrays.get("types"), coding).astype(np.int64)
        if not len(ends) == len(kinds) == declared or (
            len(corners) and not 0 <= corners.min() <= corners.max() < count
        ):
            raise Unreadable(f"a piece of it declares {declared} {name} on {count} points, and has others")
        found.append(polygons_of(corners, np.concatenate(([0], ends)), kinds))
    return found


def _array(array: ElementTree.Element | None, coding: _Coding) -> Array | Integers:
    """The numbers of an array.

    Raises:
        Unreadable: there is no such array, or it is broken.
    """
    if array is None or array.get("type") not in TYPES:
        raise Unreadable("some of its points or cells are missing")
    dtype = np.dtype(coding.order + TYPES[array.get("type", "")])
    form = array.get("format", "ascii")
    try:
        if form == "ascii":
            words = (array.text or "").split()
            return np.array(numbers(words)) if dtype.kind == "f" else np.array(integers(words), dtype=np.int64)
        if form == "appended":
            data = coding.appended[integers([array.get("offset", "")])[0] :]
            is_raw = coding.is_raw
        else:
            data, is_raw = "".join((array.text or "").split()).encode("ascii"), False
        whole = _decoded(data, is_raw, coding)
    except (ValueError, IndexError, OverflowError, zlib.error, lzma.LZMAError):
        raise Unreadable(f"its {array.get('Name', 'Points')[:30]} are broken or cut off") from None
    if len(whole) % dtype.itemsize:
        raise Unreadable(f"its {array.get('Name', 'Points')[:30]} are no whole number of numbers")
    return np.frombuffer(whole, dtype)


def _decoded(data: bytes, is_raw: bool, coding: _Coding) -> bytes:
    """The bytes of an array, behind the header that says how many there are, or in how many blocks."""
    width = coding.header.itemsize
    head = _bytes(data, 0, width, is_raw)
    first = int(np.frombuffer(head, coding.header)[0])
    if not coding.compressor:
        if not is_raw and data[_coded(width) - 1 : _coded(width)] == b"=":  # the header is coded by itself
            return _bytes(data[_coded(width) :], 0, first, is_raw)
        return _bytes(data, width, first, is_raw)
    head = _bytes(data, 0, (3 + first) * width, is_raw)
    _, size, last, *packed = (int(value) for value in np.frombuffer(head, coding.header))
    sizes = [*([size] * (first - 1)), last or size] if first else []
    if sum(sizes) > MOST_BYTES:
        raise ValueError
    whole = _bytes(data[len(head) if is_raw else _coded(len(head)) :], 0, sum(packed), is_raw)
    ends = [0, *accumulate(packed)]
    return b"".join(
        _unpacked(whole[a:b], most, coding.compressor) for (a, b), most in zip(pairwise(ends), sizes, strict=True)
    )


def _coded(size: int) -> int:
    """Characters of base64 for so many bytes."""
    return -(-size // 3) * 4


def _bytes(data: bytes, begin: int, count: int, is_raw: bool) -> bytes:
    """So many bytes from a place on, of data that are raw or coded in base64 from their beginning."""
    if not 0 <= count <= len(data):
        raise ValueError
    skipped = 0 if is_raw else begin // 3
    found = data if is_raw else base64.b64decode(data[4 * skipped : _coded(begin + count)], validate=True)
    found = found[begin - 3 * skipped :][:count]
    if len(found) != count:
        raise ValueError
    return found


def _unpacked(block: bytes, size: int, compressor: str) -> bytes:
    """A block that has this size when it is decompressed."""
    if compressor == "vtkZLibDataCompressor":
        found = zlib.decompressobj().decompress(block, size)
    elif compressor == "vtkLZMADataCompressor":
        found = lzma.LZMADecompressor().decompress(block, size)
    else:
        raise Unreadable(f"it is compressed by {compressor[:30]}, which is not read; use zlib")
    if len(found) != size:
        raise ValueError
    return found
