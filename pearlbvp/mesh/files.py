"""Meshes in files of other programs, through meshio: VTU, PLY, OBJ. One period, cut open where it begins again."""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Mapping
from pathlib import Path
from xml.etree.ElementTree import ParseError

import meshio
import numpy as np
from scipy.spatial import cKDTree

from pearlbvp.errors import InputError
from pearlbvp.files import readable, writable, write_whole
from pearlbvp.helfrich import positive
from pearlbvp.mesh.periodic import Array, Integers, MeshError, PeriodicMesh

BROKEN = (
    meshio.ReadError, ParseError, OSError, EOFError, ValueError, LookupError, TypeError, AttributeError, AssertionError,
    ArithmeticError, struct.error, zlib.error,
)  # fmt: skip
"""What the readers of meshio meet in a broken file; their words speak of their own inside."""

FORMATS = {".vtu": "vtu", ".ply": "ply", ".obj": "obj"}

SAME = 1e-5
"""Distance, in mean edges, at which two points a period apart are one: formats differ in their digits."""


def _format(name: str, path: Path) -> str:
    try:
        return FORMATS[path.suffix.lower()]
    except KeyError:
        raise InputError(
            f"{name}: {path.name} has none of the endings {', '.join(FORMATS)}; choose one of these formats"
        ) from None


def writable_mesh(name: str, path: str | os.PathLike[str]) -> Path:
    """``path`` as a Path, checked before a mesh is computed for it.

    Args:
        name: the argument's name, for the message.
        path: ending in ``.vtu``, ``.ply`` or ``.obj``.

    Raises:
        InputError: another ending, or a place that cannot be written to.
    """
    checked = writable(name, path)
    _format(name, Path(path))
    return checked


def write_mesh(mesh: PeriodicMesh, path: str | os.PathLike[str], data: Mapping[str, Array] | None = None) -> None:
    """Write one period of a mesh; corners in the next period get vertices of their own.

    Args:
        mesh: its vertices on the surface.
        path: ending in ``.vtu``, ``.ply`` or ``.obj``.
        data: values at the vertices by name, shape (V,); only VTU and PLY keep them.

    Raises:
        InputError: another ending, or a place that cannot be written to.
    """
    path = writable("out", path)
    kind = _format("out", path)
    mesh = mesh.reduced()
    pairs, corners = np.unique(
        np.column_stack((mesh.triangles.ravel(), mesh.wraps.ravel())), axis=0, return_inverse=True
    )
    points = mesh.vertices[pairs[:, 0]]
    points[:, 0] += mesh.length * pairs[:, 1]
    values = {} if kind == "obj" else {name: np.asarray(value)[pairs[:, 0]] for name, value in (data or {}).items()}
    made = meshio.Mesh(points, [("triangle", corners.reshape(-1, 3).astype(np.int32))], point_data=values)
    write_whole("out", path, lambda temporary: meshio.write(temporary, made, file_format=kind))


def read_mesh(path: str | os.PathLike[str], length: float) -> PeriodicMesh:
    """Read one period of a tube that is cut open, whatever the cut; points a period apart are one vertex.

    Args:
        path: a VTU, PLY or OBJ file.
        length: the period.

    Raises:
        InputError: no such file, or it is no triangulated tube of that period; the message names the first element as
            the file numbers it.
    """
    path, length = Path(path), positive("length", length)
    kind = _format("mesh", path)
    readable("mesh", path)
    if kind == "ply" and b"end_header" not in path.read_bytes()[:100_000]:  # meshio would look for it for ever
        raise InputError(f"mesh: {path} cannot be read as PLY (its header does not end); export it again")
    try:
        found = meshio._helpers.reader_map[kind](str(path))  # meshio.read() ends the program where a file is broken
    except BROKEN:
        raise InputError(
            f"mesh: {path} cannot be read as {kind.upper()}: it is broken or cut off; export it again"
        ) from None
    blocks = [np.asarray(block.data) for block in found.cells if block.type == "triangle"]
    others = sorted({block.type for block in found.cells} - {"triangle", "vertex", "line"})
    if others or not blocks:
        raise InputError(f"mesh: {path} has {', '.join(others) or 'no faces'}; give one of triangles only")
    first = 1 if kind == "obj" else 0
    return joined(np.asarray(found.points, dtype=float), np.concatenate(blocks).astype(np.int64), length, first)


def joined(points: Array, triangles: Integers, length: float, first: int = 0) -> PeriodicMesh:
    """A cut tube as a periodic mesh: points a period apart become one vertex.

    Args:
        points, triangles: shapes (P, 3) and (T, 3).
        length: the period.
        first: number of the first point and triangle in messages, as the file counts them.

    Raises:
        InputError: the result is no tube.
    """
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(f"vertices: points of shape {points.shape} are not (P, 3); give x, y, z of each")
    if (triangles < 0).any() or (triangles >= len(points)).any():
        last = len(points) - 1 + first
        raise InputError(
            f"triangles: a corner is none of the {len(points)} vertices; number them from {first} to {last}"
        )
    used = np.unique(triangles)
    wrong = used[~np.isfinite(points[used]).all(axis=1)]
    if len(wrong):
        raise InputError(
            f"vertices: vertex {wrong[0] + first} (of the file, from {first} on) at {points[wrong[0]]} is not finite; "
            "give ordinary numbers"
        )
    vertex, wrap, kept = _merged(points, triangles, used, length)
    low, high = points[used, 0].min(), points[used, 0].max()
    if not wrap.any():
        raise InputError(
            f"length: no two points of the file lie {length:g} apart along x, which runs from {low:.6g} to {high:.6g}; "
            "give the tube's period, its axis along x"
        )
    try:
        return PeriodicMesh(points[kept], vertex[triangles], wrap[triangles], length)
    except MeshError as error:
        if (periods := round((high - low) / length)) > 1:  # then triangles that lie a period apart have become one
            raise InputError(
                f"length: the file runs from x = {low:.6g} to {high:.6g}, {periods} periods of {length:g}; "
                "give the period of the whole, or a file of one period"
            ) from None
        raise error.renumbered(triangles, first) from None


def _merged(points: Array, triangles: Integers, used: Integers, length: float) -> tuple[Integers, Integers, Integers]:
    """Number and period of each point as a vertex, and the points that vertices are taken from."""
    edges = points[triangles] - points[np.roll(triangles, -1, axis=1)]
    near = SAME * float(np.linalg.norm(edges, axis=2).mean())
    angle = 2 * np.pi * points[used, 0] / length
    circle = length / (2 * np.pi)
    places = np.column_stack((circle * np.cos(angle), circle * np.sin(angle), points[used, 1:]))
    first = np.arange(len(points))
    for i, j in sorted(cKDTree(places).query_pairs(near)):
        first[used[j]] = min(first[used[j]], first[used[i]])
    kept, number = np.unique(first[used], return_inverse=True)
    vertex, wrap = np.zeros(len(points), dtype=np.int64), np.zeros(len(points), dtype=np.int64)
    vertex[used] = number
    wrap[used] = np.round((points[used, 0] - points[first[used], 0]) / length).astype(np.int64)
    return vertex, wrap, kept
