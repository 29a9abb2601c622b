"""STL and OFF."""

from __future__ import annotations

from itertools import islice

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.mesh.formats.soup import Soup, Unreadable, integers, numbers, text_of

FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(data: bytes) -> Soup:
    """The triangles of an STL file, each with points of its own; binary files are recognized by their size.

    Raises:
        Unreadable: neither binary of the declared size nor text.
    """
    declared = int.from_bytes(data[80:84], "little")
    held = (len(data) - 84) // FACET.itemsize
    if len(data) >= 84 and 0 < declared <= held and not data[84 + declared * FACET.itemsize :].strip(b"\0\r\n "):
        corners = np.frombuffer(data, FACET, declared, 84)["corners"].astype(float)
    elif data.lstrip()[:5].lower() == b"solid" and b"facet" in data[:10_000].lower():
        corners = _text_of_facets(data)
    else:
        raise Unreadable(f"it declares {declared} triangles and holds {max(held, 0)}")
    count = len(corners)
    return Soup(corners.reshape(-1, 3), np.arange(3 * count), np.full(count, 3))


def _text_of_facets(data: bytes) -> Array:
    """Corners of the facets of one or several solids."""
    values: list[float] = []
    counts = dict.fromkeys(("solid", "facet", "outer", "vertex", "endloop", "endfacet", "endsolid"), 0)
    for number, line in enumerate(text_of(data).split("\n"), start=1):
        words = line.split()
        if not words:
            continue
        word = words[0].lower()
        try:
            counts[word] += 1
            if word == "vertex":
                x, y, z = numbers(words[1:])
                values += (x, y, z)
            if word == "endfacet" and counts["vertex"] != 3 * counts["facet"]:
                raise ValueError
        except (KeyError, ValueError):
            raise Unreadable(
                f"line {number} begins with {words[0][:20]!r} where a facet of three vertices goes on"
            ) from None
    if (
        counts["solid"] != counts["endsolid"]
        or len({counts[name] for name in ("facet", "outer", "endloop", "endfacet")}) > 1
    ):
        raise Unreadable("it is cut off")
    return np.array(values).reshape(-1, 3, 3)


def read_off(data: bytes) -> Soup:
    """The polygons of an OFF file, with colours and normals (COFF, NOFF, ...) passed over.

    Raises:
        Unreadable: the counts are not those of the lines, or a line is none of OFF's.
    """
    lines = [line for whole in text_of(data).split("\n") if (line := whole.split("#", 1)[0].split())]
    if not lines or not lines[0][0].endswith("OFF") or not set(lines[0][0][:-3]) <= set("STCN"):
        raise Unreadable("it does not begin with OFF, COFF or NOFF")
    if "BINARY" in lines[0]:
        raise Unreadable("it is binary, which is not read; write it as text")
    rows = iter(lines if lines[0][1:] else lines[1:])
    try:
        vertices, faces = integers([word for word in next(rows) if not word.endswith("OFF")][:2])
    except (ValueError, StopIteration, OverflowError):
        raise Unreadable("it does not say how many vertices and faces it has") from None
    try:
        points = [numbers(row) for row in islice(rows, max(vertices, 0))]
        polygons = [_corners(row) for row in islice(rows, max(faces, 0))]
        if len(set(map(len, points))) > 1 or (points and len(points[0]) < 3):  # as many numbers behind x, y, z in each
            raise ValueError
    except (ValueError, IndexError, OverflowError):
        raise Unreadable("a line is neither a vertex nor a face where its counts want one") from None
    if (len(points), len(polygons)) != (vertices, faces) or next(rows, None) is not None:
        raise Unreadable(f"it does not hold the {vertices} vertices and {faces} faces that it declares")
    return Soup.of(np.array(points).reshape(vertices, -1)[:, :3], polygons)


def _corners(row: list[str]) -> list[int]:
    """Corners of a face's line; a colour may follow, as an index or of three or four parts."""
    size = integers(row[:1])[0]
    found = integers(row[1 : size + 1])
    if size < 1 or len(found) != size or len(numbers(row[size + 1 :])) not in (0, 1, 3, 4):
        raise ValueError
    return found
