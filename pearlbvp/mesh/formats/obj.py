"""Wavefront OBJ: vertices and faces; textures, normals, colours, groups, materials and lines are passed over."""

from __future__ import annotations

import numpy as np

from pearlbvp.mesh.formats.soup import Soup, Unreadable, integers, numbers, text_of

IDLE = frozenset(
    (
        "vt", "vn", "vp", "g", "o", "s", "l", "p", "usemtl", "mtllib", "usemap", "maplib", "lod", "bevel", "c_interp",
        "d_interp", "shadow_obj", "trace_obj", "mg", "deg", "cstype", "bmat", "step", "parm", "trim", "hole", "scrv", "sp",
        "end", "con", "curv", "curv2", "ctech", "stech", "bsp", "bzp", "cdc", "cdp", "res",
    )
)  # fmt: skip
"""Statements that say nothing of the surface. Free-form surfaces (``surf``) and other files (``call``) are not among them."""


def read_obj(data: bytes) -> Soup:
    """The polygons of an OBJ file, counted from 1 as it counts its vertices.

    Raises:
        Unreadable: a line that is none of OBJ's, or a number that is none.
    """
    points: list[list[float]] = []
    faces: list[list[int]] = []
    number, going_on = 0, ""
    for number, whole in enumerate(text_of(data).split("\n"), start=1):
        line = going_on + whole.split("#", 1)[0].rstrip()
        if line.endswith("\\"):
            going_on = line[:-1] + " "
            continue
        going_on = ""
        words = line.split()
        if not words:
            continue
        try:
            if words[0] == "v":
                points.append(_point(numbers(words[1:])))
            elif words[0] in ("f", "fo"):
                faces.append(_face(words[1:], len(points), number))
            elif words[0] not in IDLE:
                raise Unreadable(f"line {number} begins with {words[0][:20]!r}, which is none of its statements")
        except (ValueError, OverflowError):
            what = "a vertex of three coordinates" if words[0] == "v" else "a face of three or more whole numbers"
            raise Unreadable(f"line {number} begins with {words[0]!r} and is not {what}") from None
    if going_on:
        raise Unreadable(f"line {number} goes on after the end")
    return Soup.of(np.array(points), faces, first=1)


def _point(values: list[float]) -> list[float]:
    """``x, y, z``, where a weight that is 1, or a colour of three or four numbers may follow."""
    if len(values) not in (3, 4, 6, 7) or (len(values) == 4 and values[3] != 1):
        raise ValueError
    return values[:3]


def _face(words: list[str], count: int, line: int) -> list[int]:
    """Corners counted from 0, of words like ``7/1/2`` or, counted from the last vertex, ``-1//2``."""
    found = integers(word.split("/", 1)[0] for word in words)
    if len(found) < 3:
        raise ValueError
    if 0 in found:
        raise Unreadable(f"line {line} has a face with the corner 0; OBJ counts its vertices from 1")
    if min(found) < -count:
        raise Unreadable(f"line {line} has a face with the corner {min(found)}, and {count} vertices are before it")
    return [corner - 1 if corner > 0 else count + corner for corner in found]
