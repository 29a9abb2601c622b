"""PLY, as text and binary of either order: vertices, and faces as polygons or strips, among elements of any other kind."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.mesh.formats.soup import Soup, Unreadable, integers, numbers, strips, text_of

TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4",
    "float64": "f8", "int64": "i8", "uint64": "u8", "long": "i8", "ulong": "u8",
}  # fmt: skip
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
CORNERS = ("vertex_indices", "vertex_index")


@dataclass(frozen=True)
class _Property:
    """A number of an element, or a list of numbers: then ``size`` is the type of its length."""

    name: str
    kind: str
    size: str = ""


@dataclass(frozen=True)
class _Element:
    """So many rows of the same properties."""

    name: str
    count: int
    properties: tuple[_Property, ...]


def read_ply(data: bytes) -> Soup:
    """The polygons of a PLY file.

    Raises:
        Unreadable: the header is broken, or does not fit what follows it.
    """
    order, elements, body = _header(data)
    rows = _text(elements, body) if order == "" else _binary(elements, body, order)
    if "vertex" not in rows or not {"x", "y", "z"} <= rows["vertex"].keys():
        raise Unreadable("it has no vertices with x, y, z")
    points = np.column_stack([np.asarray(rows["vertex"][name], dtype=float) for name in "xyz"])
    for name in ("face", "tristrips"):
        lists = next((rows[name][key] for key in CORNERS if key in rows.get(name, {})), None)
        if lists is not None and len(lists):
            if name == "tristrips":  # runs that end with -1
                lists = strips(run for row in lists for run in _runs(list(row)))
            if isinstance(lists, np.ndarray):
                return Soup(points, lists.ravel(), np.full(len(lists), lists.shape[1]))
            return Soup.of(points, lists)
    raise Unreadable("it has no faces with vertex_indices")


def _runs(strip: list[int]) -> list[list[int]]:
    found: list[list[int]] = [[]]
    for corner in strip:
        found.append([]) if corner < 0 else found[-1].append(corner)
    return found


def _header(data: bytes) -> tuple[str, list[_Element], bytes]:
    """Byte order ("" for text), elements, and what follows."""
    data = data.removeprefix(b"\xef\xbb\xbf")
    match = re.search(rb"[\r\n][ \t]*end_header[ \t]*(\r\n|\r|\n|$)", data)
    if not data.startswith(b"ply") or match is None:
        raise Unreadable("its header does not begin with ply, or does not end")
    end, body = match.start(), data[match.end() :]
    order, elements = None, []
    for line in text_of(data[:end]).split("\n")[1:]:
        words = line.split()
        try:
            match words:
                case [] | ["comment" | "obj_info", *_]:
                    pass
                case ["format", name, "1.0", *_] if order is None:
                    order = ORDERS[name]
                case ["element", name, count, *_]:
                    elements.append(_Element(name, integers([count])[0], ()))
                case ["property", *rest]:
                    found = _property(rest)
                    last = elements.pop()
                    elements.append(_Element(last.name, last.count, (*last.properties, found)))
                case _:
                    raise ValueError
        except (KeyError, ValueError, IndexError, OverflowError):
            raise Unreadable(f"the line {line.strip()[:60]!r} of its header is not understood") from None
    if order is None or any(element.count < 0 for element in elements):
        raise Unreadable("its header has no format, or a negative count")
    if len({element.name for element in elements}) < len(elements):
        raise Unreadable("its header names the same rows twice")
    return order, elements, body


def _property(words: list[str]) -> _Property:
    match words:
        case ["list", size, kind, name, *_] if TYPES[size][0] != "f" and (name not in CORNERS or TYPES[kind][0] != "f"):
            return _Property(name, TYPES[kind], TYPES[size])
        case [kind, name, *_] if kind != "list":
            return _Property(name, TYPES[kind])
    raise ValueError


def _text(elements: list[_Element], body: bytes) -> dict[str, dict[str, Any]]:
    """Columns of each element; one line for each of its rows, comments between them."""
    lines = [line for whole in text_of(body).split("\n") if (line := whole.split("#", 1)[0].split())]
    lines = [words for words in lines if words[0] not in ("comment", "obj_info")]
    if len(lines) != sum(element.count for element in elements):
        declared = ", ".join(f"{element.count} of {element.name}" for element in elements)
        raise Unreadable(f"it has {len(lines)} rows, and its header declares {declared}")
    found: dict[str, dict[str, Any]] = {}
    place = 0
    for element in elements:
        rows, place = lines[place : place + element.count], place + element.count
        columns: dict[str, list[Any]] = {field.name: [] for field in element.properties}
        for number, words in enumerate(rows):
            try:
                _row(element, words, columns)
            except (ValueError, IndexError, OverflowError):
                raise Unreadable(f"{element.name} {number} is not what its header declares") from None
        found[element.name] = columns
    return found


def _row(element: _Element, words: list[str], columns: dict[str, list[Any]]) -> None:
    """The numbers of one line, added to the columns."""
    place = 0
    for field in element.properties:
        convert = numbers if field.kind[0] == "f" else integers
        if not field.size:
            columns[field.name].append(convert(words[place : place + 1])[0])
            place += 1
            continue
        size = integers(words[place : place + 1])[0]
        values = convert(words[place + 1 : place + 1 + size])
        if size < 0 or len(values) != size:
            raise ValueError
        columns[field.name].append(values)
        place += 1 + size
    if place != len(words):
        raise ValueError


def _binary(elements: list[_Element], body: bytes, order: str) -> dict[str, dict[str, Any]]:
    """Columns of each element; lists are a table where all are as long as the first."""
    found: dict[str, dict[str, Any]] = {}
    place = 0
    for element in elements:
        try:
            found[element.name], place = _table(element, body, place, order) or _lists(element, body, place, order)
        except (ValueError, IndexError):
            raise Unreadable(f"it ends before the last {element.name} of {element.count}") from None
    if (rest := body[place:].strip()) and not rest.startswith((b"comment", b"#")):
        raise Unreadable(f"{len(body) - place} bytes follow on all that its header declares")
    return found


def _table(element: _Element, body: bytes, place: int, order: str) -> tuple[dict[str, Array], int] | None:
    """Columns of an element whose lists are all as long as in its first row, and where it ends; None if they are not."""
    fields: list[Any] = []
    at = place
    for i, field in enumerate(element.properties):
        name, kind = f"{i}", order + field.kind
        if not field.size:
            fields.append((name, kind))
            at += np.dtype(kind).itemsize
            continue
        if not element.count:
            return {}, place
        size = int(np.frombuffer(body, order + field.size, 1, at)[0])
        at += np.dtype(field.size).itemsize + size * np.dtype(kind).itemsize
        if size < 0 or at > len(body):
            raise ValueError
        fields += [(f"size{i}", order + field.size), (name, kind, (size,))]
    dtype = np.dtype(fields)
    if element.count * dtype.itemsize > len(body) - place:
        if any(field.size for field in element.properties):
            return None
        raise ValueError
    rows = np.frombuffer(body, dtype, element.count, place)
    for name in dtype.names or ():
        if name.startswith("size") and (rows[name] != rows[name][0]).any():
            return None
    columns = {field.name: rows[f"{i}"] for i, field in enumerate(element.properties)}
    return columns, place + element.count * dtype.itemsize


def _lists(element: _Element, body: bytes, place: int, order: str) -> tuple[dict[str, list[Any]], int]:
    """Columns of an element whose lists differ in length, and where it ends."""
    columns: dict[str, list[Any]] = {field.name: [] for field in element.properties}
    kinds = [
        (field.name, field.size and np.dtype(order + field.size), np.dtype(order + field.kind))
        for field in element.properties
    ]
    if element.count > len(body):
        raise ValueError
    for _ in range(element.count):
        for name, size, kind in kinds:
            length = 1
            if size:
                length = int(np.frombuffer(body, size, 1, place)[0])
                place += size.itemsize
            if length < 0 or place + length * kind.itemsize > len(body):
                raise ValueError
            values = np.frombuffer(body, kind, length, place).tolist()
            columns[name].append(values if size else values[0])
            place += length * kind.itemsize
    return columns, place
