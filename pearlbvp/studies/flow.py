"""Does the flow get there? The ends of flows as points of branches, and flows in files."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from pearlbvp.collocation.scheme import Array
from pearlbvp.continuation.branch import Branch, BranchOptions, continue_branch, start_point
from pearlbvp.continuation.switching import tangent_along
from pearlbvp.errors import InputError
from pearlbvp.files import writable, write_whole
from pearlbvp.flow.axisymmetric import GraphFlow
from pearlbvp.flow.checkpoint import read_state, write_state
from pearlbvp.flow.mesh import MeshFlow
from pearlbvp.flow.problem import FlowProblem
from pearlbvp.flow.record import Equilibrium, FlowResult, FlowState
from pearlbvp.flow.tube import TubeFlow
from pearlbvp.helfrich import Tube
from pearlbvp.shapes.graph import pearl_of_graph
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.stability.bloch import Fixed
from pearlbvp.stability.spectrum import Spectrum
from pearlbvp.studies.branch import branch_options

KINDS: dict[str, Any] = {"graph": GraphFlow, "tube": TubeFlow, "mesh": MeshFlow}


def _problem(tree: Mapping[str, Any]) -> FlowProblem:
    """A discretization from what a file says of it."""
    found: FlowProblem = KINDS[str(tree["kind"])].from_tree(tree)
    return found


def save(state: FlowState, path: str | os.PathLike[str]) -> None:
    """Save a flow's state and record as HDF5, whole or not at all.

    Raises:
        InputError: the place cannot be written to.
    """
    write_whole("save", writable("save", path), lambda temporary: write_state(state, temporary))


def load(path: str | os.PathLike[str]) -> FlowState:
    """Load what ``save`` saved. Nothing in the file is executed.

    Raises:
        InputError: the file is no saved flow, or is not whole.
    """
    if not Path(path).is_file():
        raise InputError(f"resume: there is no file {path}; give one that --save wrote")
    return read_state(Path(path), _problem)


def pearls_of(end: Equilibrium, tolerance: float = 1e-10) -> tuple[PearlProblem, Array]:
    """An axisymmetric end state as a point of a branch, by Newton's method on the arclength problem.

    Branches live at area ``2 pi L``. A flow keeps the area it starts with: its end is similar to a shape of that area on a
    tube of length ``L/s`` with spontaneous curvature ``c0 s``, ``s = A/(2 pi L)``; that is the point returned.

    Args:
        end: the equilibrium.
        tolerance: estimated error of the profile.

    Raises:
        InputError: the shape has no plane of reflection, or Newton's method fails.
    """
    graph, found = end.problem, end.observables
    scale = found["area"]
    fine = replace(graph, points=min(1024, 4 * graph.points))
    middle = _plane(graph, end.q)
    r = np.sqrt(2 * graph.interpolated(end.q, fine.x + fine.length / 2 + middle))
    waves = np.fft.rfft(r) / fine.points
    if np.abs(waves.imag).max() > 1e-6:
        raise InputError(
            "flow: its end has no plane of reflection, which a branch of pearls needs; continue another end"
        )
    cosines = 2 * waves.real[: graph.points // 2]
    cosines[0] /= 2
    tube = Tube(graph.c0 * scale, graph.length / scale)
    problem, u, why = pearl_of_graph(tube, found["v"] / scale**2, cosines / scale, tolerance=tolerance)
    if why:
        raise InputError(f"flow: its end led to no equilibrium of the arclength problem ({why})")
    for _ in range(6):
        changed = problem.remesh(u)
        if changed is None:
            break
        problem, (u,) = changed
        u = _corrected(problem, u)
    return problem, u


def _corrected(problem: PearlProblem, u: Array) -> Array:
    """Newton's method at fixed volume."""
    row = np.zeros_like(u)
    row[-1] = 1.0
    for _ in range(8):
        step = problem.solve(u, np.append(problem.residual(u), 0.0), row)
        u = u - step
        if np.abs(step).max() < 1e-12:
            break
    return u


def _plane(graph: GraphFlow, q: Array) -> float:
    """Position of the plane of reflection about which a shape is most nearly even, at a maximum of its largest wave."""
    waves = np.fft.rfft(q)
    numbers = np.arange(len(waves))
    strongest = int(np.abs(waves[1:]).argmax()) + 1
    shift = -np.angle(waves[strongest]) / (2 * np.pi * strongest)
    candidates = shift + np.arange(2 * strongest) / (2 * strongest)

    def oddness(part: float) -> float:
        turned = waves * np.exp(2j * np.pi * numbers * part)
        return float(np.abs(turned.imag).sum() - 1e-9 * turned.real.sum())

    best = min(candidates, key=oddness)
    return float(best * graph.length - graph.length / 2)


def stability(end: Equilibrium) -> Spectrum:
    """Growth rates of all perturbations of an axisymmetric end state, those that break its symmetry too.

    They are those of the similar shape of area ``2 pi L`` (``pearls_of``): in the flow's own units they are ``s^4`` times
    smaller, ``s = A/(2 pi L)``.

    Raises:
        InputError: the end state is no point of a branch; see ``pearls_of``.
    """
    problem, u = pearls_of(end)
    fixed: Fixed = "area" if end.problem.law == "area" else "area and volume"
    return replace(problem, fixed=fixed).spectrum(u)


def continued(
    result: FlowResult, options: BranchOptions | None = None, *, upwards: bool = True
) -> Branch[PearlProblem]:
    """The branch through the end of an axisymmetric flow, towards larger or smaller volume.

    Raises:
        InputError: the flow did not come to rest, or its end has no plane of reflection.
    """
    if result.equilibrium is None or not result.equilibrium.converged:
        raise InputError(f"flow: it ended as {result.status!r} and is no equilibrium; let it rest first")
    problem, u = pearls_of(result.equilibrium)
    direction = np.zeros_like(u)
    direction[-1] = 1.0 if upwards else -1.0
    return continue_branch(start_point(problem, u, tangent_along(problem, u, direction)), options or branch_options())
