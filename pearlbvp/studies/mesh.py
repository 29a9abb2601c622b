"""Triangulated tubes: branches on meshes from the straight tube on, and meshes of shapes that were computed otherwise."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, get_args

import numpy as np
import pandas as pd

from pearlbvp.arrays import Array
from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.following import BranchOptions, continue_branch
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.switching import tangent_along
from pearlbvp.errors import InputError
from pearlbvp.held import Held, known_held
from pearlbvp.helfrich import SMALLEST_AMPLITUDE, choice, whole
from pearlbvp.mesh.families import Surface, mapped, tube_mesh
from pearlbvp.mesh.functional import Functional, Kind
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.problem import MeshProblem
from pearlbvp.mesh.start import equilibrium
from pearlbvp.studies.branch import known_options, known_point

NODES = 3000
"""Vertices of a mesh by default: four digits of the branch points of the straight tube."""


def meshed(
    point: Solution[Any],
    nodes: int | PeriodicMesh = NODES,
    *,
    kind: Kind = "subdivision",
    fix: str | Held | None = None,
) -> tuple[MeshProblem, Array]:
    """The equilibrium on a mesh at the reduced volume of a computed shape; of a shape on a mesh itself.

    Args:
        point: of a branch of any family.
        nodes: vertices of the mesh, or a mesh of the straight tube that is mapped onto the shape. A shape on a mesh has
            its own.
        kind: the discretization; a shape on a mesh has its own.
        fix: what is held while stability is judged, as ``family_branch`` takes it; by default what is on the branch.

    Returns:
        The problem and its unknown: ``problem.observables(u)``, ``problem.spectrum(u)``, ``problem.surface(u)``.

    Raises:
        InputError: the mesh is too coarse for the shape, or that is the straight tube.
    """
    point = known_point(point)
    choice("discretization", kind, get_args(Kind))
    found = point.observables
    if found["amplitude"] < SMALLEST_AMPLITUDE:
        raise InputError(
            "point", "it is the straight tube, which is an equilibrium at any pressure", "choose another point"
        )
    held = point.problem.held if fix is None else known_held(fix)
    held.check(found)
    if isinstance(point.problem, MeshProblem):
        return point.problem.holding(held), point.u
    return equilibrium(
        shape_mesh(point, nodes), found["c0"], found["v"], found["lambda1"], found["lambda2"], kind, held=held
    )


def on_mesh(
    point: Solution[Any],
    nodes: int | PeriodicMesh = NODES,
    *,
    kind: Kind = "subdivision",
    fix: str | Held | None = None,
) -> Solution[MeshProblem]:
    """The same as a solution, whose branch leads to larger ``v``; arguments and errors are those of ``meshed``."""
    problem, u = meshed(point, nodes, kind=kind, fix=fix)
    if u is point.u:
        return replace(point, problem=problem)
    return Solution(problem, u, _towards_larger_volume(problem, u))


def _towards_larger_volume(problem: MeshProblem, u: Array) -> Array:
    """Unit tangent of the branch through an equilibrium."""
    direction = np.zeros_like(u)
    direction[-1] = 1.0
    return tangent_along(problem, u, direction)


def shape_mesh(point: Solution[Any], nodes: int | PeriodicMesh = NODES) -> PeriodicMesh:
    """A mesh with its vertices on a computed shape; of a shape on a mesh its own triangles.

    Args:
        point: of a branch of any family.
        nodes: vertices of the mesh, or a mesh of the straight tube that is mapped onto the shape.

    Raises:
        InputError: so few nodes make no good triangles.
    """
    problem = known_point(point).problem.shapes
    nodes = nodes if isinstance(nodes, PeriodicMesh) else whole("nodes", nodes)
    own: PeriodicMesh | None = problem.own_mesh(point.u)
    if own is not None:
        return own
    surface: Surface = problem.parametrized(point.u)
    if isinstance(nodes, PeriodicMesh):
        return mapped(nodes, surface)
    return tube_mesh(point.observables["L"], nodes, surface, (problem.turns, 1) if problem.turns else None)


def mesh_table(mesh: PeriodicMesh, c0: float, kind: Kind = "subdivision") -> pd.DataFrame:
    """What there is to know of a mesh before anything is solved on it.

    Args:
        mesh: its vertices on the surface.
        c0: spontaneous curvature.
        kind: the discretization whose energy is given.

    Returns:
        One row: ``nodes, triangles, quality_worst, quality_mean`` (paper, eq. (mq); 3.46 is best), ``area, volume`` of the
        flat triangles, ``c0, L``, and ``E``, the discretization's energy by area of a surface through the vertices.
    """
    functional = Functional(mesh, kind)
    vertices = functional.vertices_near(mesh.vertices)
    energy, area, _ = functional.sums(vertices, np.zeros_like(vertices), c0).values
    return _rows(mesh, {"c0": c0, "L": mesh.length, "E": float(energy / area)})


def equilibrium_table(problem: MeshProblem, u: Array) -> pd.DataFrame:
    """The same of an equilibrium, and of the columns of a branch those of shape, stability and force."""
    found, spectrum = problem.observables(u), problem.spectrum(u)
    order = ("c0", "L", "E", "lambda1", "lambda2", "v", "amplitude", "r_min", "r_max")
    last = {name: found[name] for name in ("M", "force")}
    stability = {
        "n_unstable": spectrum.n_unstable if spectrum.complete else None,
        "mu_crit": spectrum.mu_crit,
        "critical": str(spectrum.critical),
        "mu_error": spectrum.residual,
    }
    return _rows(problem.surface(u), {name: found[name] for name in order} | stability | last)


def _rows(mesh: PeriodicMesh, values: dict[str, Any]) -> pd.DataFrame:
    quality = mesh.quality
    shape = {
        "nodes": mesh.count, "triangles": len(mesh.triangles), "quality_worst": quality.max(),
        "quality_mean": quality.mean(), "area": mesh.area, "volume": mesh.volume,
    }  # fmt: skip
    return pd.DataFrame([shape | values])


def branch_from(
    problem: MeshProblem, u: Array, options: BranchOptions, *, upwards: bool = False
) -> Branch[MeshProblem]:
    """The branch through an equilibrium, towards larger or smaller ``v`` at first."""
    problem = problem.symmetric(u)
    tangent = _towards_larger_volume(problem, u)
    start = Solution.along(problem, u, tangent if upwards else -tangent)
    return continue_branch(start, known_options(options))


def taken_over(branch: Branch[Any], options: BranchOptions, nodes: int = NODES) -> Branch[MeshProblem]:
    """What follows the end of a branch that was computed otherwise, on a mesh: in the direction in which it was followed.

    It begins at the last shape's volume, where the energies of both differ by the mesh's error.

    Args:
        branch: of any family.
        options: where to stop and how to step.
        nodes: vertices of the mesh.

    Raises:
        InputError: so few nodes do not hold the last shape, or that is the straight tube.
    """
    last = branch.points[-1]
    return branch_from(*meshed(last, nodes), options, upwards=last.slopes["v"] > 0)
