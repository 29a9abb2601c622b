"""Meshes in files of other programs: one period of a tube, in many formats, repaired where that is no guess."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import meshio
import numpy as np

from pearlbvp.arrays import Array, Integers
from pearlbvp.errors import InputError
from pearlbvp.files import named, read_whole, writable, write_whole
from pearlbvp.helfrich import positive
from pearlbvp.mesh.formats.msh import read_msh
from pearlbvp.mesh.formats.obj import read_obj
from pearlbvp.mesh.formats.plain import read_off, read_stl
from pearlbvp.mesh.formats.ply import read_ply
from pearlbvp.mesh.formats.soup import Soup, Unreadable
from pearlbvp.mesh.formats.surface_evolver import evolver_text
from pearlbvp.mesh.formats.vtk import read_vtk
from pearlbvp.mesh.formats.xml import read_xml
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.rounding import without_rounding
from pearlbvp.mesh.tube import tube_of
from pearlbvp.rounding import steps
from pearlbvp.units import RADII, Sentence, Units

FORMATS = {".vtu": "vtu", ".ply": "ply", ".obj": "obj", ".fe": "fe"}
"""Endings of the formats that are written."""

READERS: dict[str, Callable[[bytes], Soup]] = {
    ".vtu": read_xml, ".vtp": read_xml, ".vtk": read_vtk, ".ply": read_ply, ".obj": read_obj, ".stl": read_stl,
    ".off": read_off, ".coff": read_off, ".noff": read_off, ".msh": read_msh,
}  # fmt: skip
"""Those that are read."""

FAR = 2.0
"""Factor between a tube's radius and the unit beyond which one of them is a mistake: forgotten units differ by ten or more."""

MOST_BYTES = 1 << 28
"""Of a file that is read: a quarter of a gigabyte, a hundred times what flows can use."""


def _format(name: str, path: Path) -> str:
    try:
        return FORMATS[path.suffix.lower()]
    except KeyError:
        raise InputError(
            name, f"{path.name} has none of the endings {', '.join(FORMATS)}", "choose one of these formats"
        ) from None


def writable_mesh(name: str, path: str | os.PathLike[str]) -> Path:
    """``path`` as a Path, checked before a mesh is computed for it.

    Args:
        name: the argument's name, for the message.
        path: ending in ``.vtu``, ``.ply``, ``.obj`` or ``.fe``.

    Raises:
        InputError: another ending, or a place that cannot be written to.
    """
    checked = writable(name, path)
    _format(name, named(name, path))
    return checked


def write_mesh(
    mesh: PeriodicMesh,
    path: str | os.PathLike[str],
    data: Mapping[str, Array] | None = None,
    *,
    c0: float = 0.0,
    name: str = "out",
) -> None:
    """Write one period of a mesh; corners in the next period get vertices of their own, but in Surface Evolver's files.

    Args:
        mesh: its vertices on the surface.
        path: ending in ``.vtu``, ``.ply``, ``.obj`` or ``.fe``.
        data: values at the vertices by name, shape (V,); only VTU and PLY keep them.
        c0: spontaneous curvature of the energy that Surface Evolver's files have, by the unit of the mesh.
        name: the argument's name, for the message.

    Raises:
        InputError: another ending, or a place that cannot be written to.
    """
    path = writable(name, path, locked=True)
    kind = _format(name, path)
    if kind == "fe":
        text = evolver_text(mesh, c0)
        write_whole(name, path, lambda temporary: temporary.write_text(text))
        return
    mesh = mesh.reduced()
    pairs, corners = np.unique(
        np.column_stack((mesh.triangles.ravel(), mesh.wraps.ravel())), axis=0, return_inverse=True
    )
    points = mesh.vertices[pairs[:, 0]]
    points[:, 0] += mesh.length * pairs[:, 1]
    values = {} if kind == "obj" else {key: np.asarray(value)[pairs[:, 0]] for key, value in (data or {}).items()}
    made = meshio.Mesh(points, [("triangle", corners.reshape(-1, 3).astype(np.int32))], point_data=values)
    write_whole(name, path, lambda temporary: meshio.write(temporary, made, file_format=kind))


def read_mesh(path: str | os.PathLike[str], length: float) -> PeriodicMesh:
    """Read one period of a tube, as any program writes it; what was repaired is not said: see ``read_tube``.

    Args:
        path: a VTU, VTP, VTK, PLY, OBJ, STL, OFF or MSH file.
        length: the period.

    Raises:
        InputError: no such file, or it is no tube of that period; the message names the first element as the file
            numbers it.
    """
    return read_tube(path, length)[0]


def read_tube(path: str | os.PathLike[str], length: float, name: str = "path") -> tuple[PeriodicMesh, str]:
    """As ``read_mesh``, and what was repaired in words, empty where nothing was; ``name`` is what messages call ``path``."""
    _, mesh, said = _read(Path(path), positive("length", length), name)
    return mesh, _said(Path(path), said)


def read_smooth_tube(path: str | os.PathLike[str], length: float, name: str = "path") -> tuple[PeriodicMesh, str]:
    """As ``read_tube``, vertices being moved within the rounding of the file's coordinates where that spoils curvatures.

    See ``mesh.rounding``. Files of enough digits are read as they are.
    """
    soup, mesh, said = _read(Path(path), positive("length", length), name)
    step = float(np.sqrt((steps(soup.points[np.unique(soup.corners)]) ** 2).mean()))
    smooth, moved = without_rounding(mesh, step)
    if moved:
        words = f"coordinates are rounded to {step:.1g}, too few digits for curvatures: smoothed, which moves vertices by up to"
        said = (*said, f"{words} {moved:.2g}")
    return smooth, _said(Path(path), said)


def read_surface(
    path: str | os.PathLike[str], length: float, units: Units = RADII, name: str = "path"
) -> tuple[PeriodicMesh, str]:
    """A triangulated tube in a file as flows start from it, in radii, and what was repaired or smoothed in words.

    Args:
        path: of one period, in the unit of length of ``units``.
        length: the period, in radii.
        units: of the file.
        name: the argument's name, for messages.

    Raises:
        InputError: it cannot be read, or is no tube of that period, or its radius is not about 1.
    """
    found, said = read_smooth_tube(named(name, path), units.to_user("length", positive("length", length)), name)
    surface: PeriodicMesh = units.surface_from_user(found)
    check_radius(surface)
    return surface, said


def _said(path: Path, said: Sequence[str]) -> str:
    return f"{path.name}: {', '.join(said)}" if said else ""


def _read(path: Path, length: float, name: str) -> tuple[Soup, PeriodicMesh, tuple[str, ...]]:
    """What the file has, the tube, and what was repaired."""
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(
            name, f"{path.name} has none of the endings {', '.join(READERS)}", "choose one of these formats"
        )
    data = read_whole(name, path, MOST_BYTES)
    try:
        with np.errstate(invalid="ignore"):  # bytes that are no numbers are named as such later on
            soup = reader(data)
    except Unreadable as error:
        raise InputError(
            name, f"{path} cannot be read as {path.suffix[1:].upper()} ({error})", "export it again"
        ) from None
    except (ValueError, LookupError, OverflowError):  # of words that are no numbers, or numbers beyond all use
        raise InputError(
            name, f"{path} cannot be read as {path.suffix[1:].upper()} (it is broken or cut off)", "export it again"
        ) from None
    try:
        mesh, said = tube_of(soup, length)
    except InputError as error:
        if error.argument == "length":
            raise
        raise error.named(f"{name}: {path}") from None
    return soup, mesh, said


def check_radius(mesh: PeriodicMesh) -> None:
    """Refuse a tube, in radii, whose own radius is not about 1: it was measured in another unit than the rest.

    Raises:
        InputError: the straight tube of its area and period has a radius that differs from 1 by more than a factor of two.
    """
    found = mesh.area / (2 * math.pi * mesh.length)
    if not 1 / FAR < found < FAR:
        what, remedy = "the tube's radius is about {r:.2g}", "give radius={r:.2g}"
        raise InputError("radius", Sentence(what, r=found), Sentence(remedy, r=found))


def joined(points: Array, triangles: Integers, length: float, first: int = 0) -> PeriodicMesh:
    """Triangles on points as a periodic mesh, repaired as those of files are.

    Args:
        points, triangles: shapes (P, 3) and (T, 3).
        length: the period.
        first: number of the first point and triangle in messages, as the file counts them.

    Raises:
        InputError: the result is no tube.
    """
    try:
        soup = Soup.of(points, np.asarray(triangles).tolist(), first)
    except Unreadable as error:
        raise InputError("triangles", str(error), "give triangles of vertices") from None
    try:
        return tube_of(soup, length)[0]
    except InputError as error:
        raise (error.named("points") if error.argument in ("vertices", "mesh") else error) from None
