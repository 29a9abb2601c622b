"""Triangulated tubes that flow: from branches of any family, or from files."""

from __future__ import annotations

from typing import Any, get_args

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.solution import Solution
from pearlbvp.flows.mesh import MeshFlow, check_nodes, mesh_flow
from pearlbvp.flows.problem import Law
from pearlbvp.helfrich import SMALLEST_AMPLITUDE, choice, finite
from pearlbvp.mesh.adaptation import smoothed
from pearlbvp.mesh.functional import Functional, Kind
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.problem import MeshProblem
from pearlbvp.mesh.start import straight
from pearlbvp.studies.flow_start import FlowStart
from pearlbvp.studies.mesh import NODES, meshed, shape_mesh


def mesh_start(
    point: Solution[Any], nodes: int | PeriodicMesh = NODES, *, kind: Kind = "subdivision", law: Law = "area and volume"
) -> FlowStart:
    """A solution of any family on a triangulated tube, an equilibrium of that discretization.

    Args:
        point: of a branch of any family; of a branch on meshes it is taken as it is, and ``nodes`` and ``kind`` are not used.
        nodes: vertices of the mesh, or a mesh of the straight tube that is mapped onto the shape.
        kind: the discretization.
        law: what the flow keeps.

    Raises:
        InputError: the mesh is too coarse for the shape, or an argument cannot be used.
    """
    found = point.observables
    choice("discretization", kind, get_args(Kind))
    if isinstance(nodes, int):
        check_nodes(law, nodes)  # before the mesh is made
    if isinstance(point.problem, MeshProblem):
        problem, u = point.problem, point.u
    elif found["amplitude"] < SMALLEST_AMPLITUDE:
        problem, u = straight(shape_mesh(point, nodes), found["c0"], found["lambda2"], kind)
    else:
        problem, u = meshed(point, nodes, kind=kind)
    pressure = float(u[-2]) if law == "area" else 0.0
    mesh = problem.mesh.moved(problem.vertices(u))
    start = mesh_flow(mesh, problem.c0, problem.kind, law, pressure, problem.functional, adapt=problem.adapt)
    q = np.zeros(mesh.count)
    return FlowStart(start, q, u[-3:-1][: len(start.constraints(q))])


def surface_start(
    c0: float, mesh: PeriodicMesh, *, kind: Kind = "subdivision", law: Law = "area and volume", pressure: float = 0.0
) -> tuple[MeshFlow, Array]:
    """Any triangulated tube, read from a file say, as a flow and its coordinates; no equilibrium is asked for.

    Rough meshes are smoothed first where the discretization needs it: ``mesh.adaptation.smoothed``.

    Args:
        c0: spontaneous curvature.
        mesh: vertices on the surface; they are spread out along it for subdivision surfaces.
        kind: the discretization.
        law, pressure: what the flow keeps, and the pressure difference where that is the area alone.

    Raises:
        InputError: an argument that cannot be used.
    """
    choice("discretization", kind, get_args(Kind))
    mesh = smoothed(mesh) if kind == "subdivision" else mesh
    functional = Functional(mesh, kind)
    reference = mesh.moved(functional.vertices_near(mesh.vertices))
    return mesh_flow(reference, finite("c0", c0), kind, law, pressure, functional), np.zeros(mesh.count)
