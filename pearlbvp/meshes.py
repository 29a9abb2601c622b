"""Triangulated tubes by public names: meshes are made, changed, read, measured and drawn; the rooms below do the work.

``pb.meshes.NAME``, or ``from pearlbvp.meshes import NAME``. A mesh is a ``PeriodicMesh``, one period without a seam, with
``vertices``, ``triangles``, ``area``, ``volume`` and ``quality``. Shapes of branches have one, ``branch[3].surface()``, and
``branch[3].meshed()`` is a solution on it.

Examples:
    >>> import pearlbvp as pb
    >>> mesh = pb.meshes.tube_mesh(10, 500)
    >>> [name for name in ("subdivision", "cotangent") if abs(
    ...     pb.meshes.branch_point(mesh, 0, (1, 0), name).observables["lambda2"]
    ...     - pb.theory.critical_lambda2(2 * 3.141592653589793 / 10, 0, 0)) < 1e-3]
    ['subdivision']
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, get_args

from pearlbvp.continuation import solution as solutions
from pearlbvp.errors import InputError
from pearlbvp.helfrich import WaveNumbers, choice, finite, mode_numbers
from pearlbvp.mesh.adaptation import AdaptOptions, smoothed
from pearlbvp.mesh.families import edited, graded, jittered, mapped, straightened, tube_mesh
from pearlbvp.mesh.functional import Kind
from pearlbvp.mesh.operators import gaussian_curvature, mean_curvature
from pearlbvp.mesh.periodic import PeriodicMesh, known_mesh
from pearlbvp.solutions import Solution
from pearlbvp.units import RADII, Units

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

__all__ = [
    "AdaptOptions",
    "PeriodicMesh",
    "amplitudes",
    "branch_point",
    "edited",
    "gaussian_curvature",
    "graded",
    "jittered",
    "mapped",
    "mean_curvature",
    "plot",
    "read",
    "smoothed",
    "straightened",
    "subdivided",
    "table",
    "tube_mesh",
    "write",
]


def _known_kind(discretization: Any) -> Kind:
    choice("discretization", discretization, get_args(Kind))
    return discretization


def subdivided(mesh: PeriodicMesh) -> PeriodicMesh:
    """Four triangles for one, of the same limit surface of Loop's subdivision.

    Raises:
        InputError: it is no triangulated tube.

    Examples:
        >>> mesh = tube_mesh(10, 400)
        >>> len(subdivided(mesh).triangles) / len(mesh.triangles)
        4.0
    """
    from pearlbvp.mesh.subdivision import subdivided as fine

    return fine(known_mesh(mesh))[0]


def branch_point(mesh: PeriodicMesh, c0: float, mode: WaveNumbers, discretization: Kind = "subdivision") -> Solution:
    """The discrete straight tube on which a mode is neutral, also on meshes that break the tube's symmetry.

    Args:
        mesh: of the straight tube.
        c0: spontaneous curvature.
        mode: waves along and around the tube.
        discretization: ``subdivision`` or ``cotangent``.

    Returns:
        A solution; ``observables["lambda2"]`` is where the mode branches off on this mesh. See ``mesh.start.branch_point``.

    Raises:
        InputError: there is no such branch point, the mesh is too coarse for the mode, or an argument cannot be used.

    Examples:
        >>> coarse, fine = (branch_point(tube_mesh(10, nodes), 0, (0, 2)).observables["lambda2"] for nodes in (400, 800))
        >>> round((coarse - 1.5) / (fine - 1.5))  # of fourth order in the mesh width
        4
    """
    from pearlbvp.mesh.start import neutral_tube

    m, n = mode_numbers("mode", mode)
    return Solution.of(neutral_tube(known_mesh(mesh), finite("c0", c0), m, n, _known_kind(discretization)))


def amplitudes(shape: PeriodicMesh | solutions.Solution[Any], mode: WaveNumbers) -> tuple[complex, complex]:
    """Amplitudes ``A`` and ``B`` of a mode's waves ``A e^{i(kx + n phi)} + B e^{i(kx - n phi)} + c.c.`` over the straight tube.

    Args:
        shape: a mesh, taken as a polyhedron, or a solution on a mesh, to the order of its discretization.
        mode: waves along and around the tube. Where it has only one wave, ``A`` and ``B`` are that and its complex conjugate.

    Raises:
        InputError: the surface is no graph over the straight tube, or an argument cannot be used.

    Examples:
        >>> import numpy as np
        >>> def pearl(x, phi):
        ...     r = 1 + 0.2 * np.cos(2 * np.pi * x / 10)
        ...     return np.column_stack((x, r * np.cos(phi), r * np.sin(phi)))
        >>> A, B = amplitudes(tube_mesh(10, 2000, pearl), (1, 0))
        >>> round(abs(A), 2), round(abs(B), 2)  # the wave is 2A
        (0.1, 0.1)
    """
    from pearlbvp.mesh import amplitudes as room
    from pearlbvp.mesh.problem import MeshProblem

    m, n = mode_numbers("mode", mode)
    if isinstance(shape, PeriodicMesh):
        return room.amplitudes(shape, m, n)
    problem = shape.problem if isinstance(shape, solutions.Solution) else None
    if not isinstance(problem, MeshProblem):
        what = f"{type(shape).__name__} must be a mesh, or a solution on one"
        raise InputError("shape", what, "give the surface() of a point, or what its meshed() returns")
    return room.amplitudes_at(problem.functional, problem.vertices(shape.u), m, n)


def table(mesh: PeriodicMesh, c0: float = 0.0, discretization: Kind = "subdivision") -> pd.DataFrame:
    """What there is to know of a mesh before anything is solved on it: the columns of the command ``mesh``.

    Args:
        mesh: its vertices on the surface.
        c0: spontaneous curvature.
        discretization: ``subdivision`` or ``cotangent``, whose energy is given.

    Returns:
        One row: ``nodes, triangles, quality_worst, quality_mean`` (3.46 is best), ``area, volume`` of the flat triangles, ``c0,
        L``, and ``E``, the discretization's energy by area.

    Raises:
        InputError: an argument that cannot be used.

    Examples:
        >>> round(float(table(tube_mesh(10, 2000)).E[0]), 5)  # of the straight tube (1/2 - c0)^2
        0.25
    """
    from pearlbvp.studies.mesh import mesh_table

    return mesh_table(known_mesh(mesh), finite("c0", c0), _known_kind(discretization))


def read(path: str | os.PathLike[str], length: float, units: Units = RADII) -> PeriodicMesh:
    """A mesh of one period of a tube from a file, as ``flow --mesh`` reads it (docs/meshes.md).

    It is repaired where that is no guess, and vertices of few digits are smoothed within their rounding; what was done is one
    line on standard error.

    Args:
        path: a VTU, VTP, VTK, PLY, OBJ, STL, OFF or MSH file.
        length: the period, in radii.
        units: of the file's coordinates.

    Raises:
        InputError: no such file, or it is no tube of that period, or its radius is not about 1.

    Examples:
        >>> import pathlib, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     write(tube_mesh(10, 500), pathlib.Path(folder) / "tube.obj")
        ...     read(pathlib.Path(folder) / "tube.obj", 10).count
        480
    """
    from pearlbvp.mesh.files import read_surface
    from pearlbvp.messages import say

    mesh, said = read_surface(path, length, units)
    if said:
        say(said)
    return mesh


def write(mesh: PeriodicMesh, path: str | os.PathLike[str], units: Units = RADII, *, c0: float = 0.0) -> None:
    """Write a mesh for another program: ``.vtu`` (ParaView), ``.ply``, ``.obj`` (Blender), ``.fe`` (Surface Evolver).

    Args:
        mesh: in radii.
        path: whose ending names the format.
        units: of the file's coordinates.
        c0: spontaneous curvature of the energy that ``.fe`` has, by the tube's radius.

    Raises:
        InputError: another ending, or a place that cannot be written to, or an argument that cannot be used.
    """
    from pearlbvp.mesh.files import write_mesh

    write_mesh(units.surface(known_mesh(mesh)), path, c0=units.to_user("H", finite("c0", c0)), name="path")


def plot(
    mesh: PeriodicMesh, values: ArrayLike | None = None, title: str = "", label: str = "", units: Units = RADII
) -> Figure:
    """A picture of a mesh: one period from its side and a little from above, with its triangles, coloured by some values.

    Args:
        mesh: its vertices on the surface, in radii.
        values: at the vertices, shape (V,); by default the distance from the axis.
        title: above the picture.
        label: of the colours.
        units: of the axes.

    Raises:
        InputError: it is no triangulated tube, or there is not one value for each of its vertices.

    Examples:
        >>> picture = plot(tube_mesh(10, 500), mean_curvature(tube_mesh(10, 500)), label="H")
        >>> len(picture.axes[0].collections[0].get_paths())
        960
    """
    from pearlbvp.arrays import numeric
    from pearlbvp.figures.mesh import draw_mesh

    if values is not None:
        values = numeric("values", values)
        if values.shape != (known_mesh(mesh).count,):
            what = f"an array of shape {values.shape} is none of a value for each of {mesh.count} vertices"
            raise InputError("values", what, "give one of them each")
    return draw_mesh(units.surface(known_mesh(mesh)), values, title, label, units)
