"""Shapes that flows start from: points of branches, in a flow's coordinates, and perturbed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.solution import Solution
from pearlbvp.errors import InputError
from pearlbvp.flows.axisymmetric import GraphFlow
from pearlbvp.flows.driver import FlowOptions, constrained, flow
from pearlbvp.flows.perturbation import along_critical, bump
from pearlbvp.flows.problem import FlowProblem, Law
from pearlbvp.flows.record import Equilibrium, FlowResult
from pearlbvp.flows.steady import polished
from pearlbvp.flows.tube import TubeFlow
from pearlbvp.helfrich import SMALLEST_AMPLITUDE, Tube, choice, finite, mode_numbers, whole
from pearlbvp.representation import brief
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.studies.branch import known_point
from pearlbvp.tube.problem import TubeProblem

if TYPE_CHECKING:
    from pearlbvp.mesh.functional import Kind

UNLIKE = 1e-5
"""Relative difference of the energies of a branch's shape and of the flow's, beyond which the modes are too few."""

DELTA = 0.02
"""Size of a perturbation where none is given, in radii."""

Perturbation = Literal["none", "bump", "critical"]

POINTS = 128
"""Of an axisymmetric shape, where no number is given."""


def known_points(points: int | None) -> int:
    """How many points an axisymmetric shape has.

    Raises:
        InputError: that is no number of points.
    """
    return POINTS if points is None else whole("points", points, 8)


Idle = tuple[bool, str, str]
"""Whether an argument says nothing beside the others, its name, and why."""


def refuse_idle(*found: Idle) -> None:
    """Refuse an argument that would say nothing.

    Raises:
        InputError: the first one, and why it says nothing.
    """
    for idle, name, why in found:
        if idle:
            raise InputError(name, why, "leave it out")


@dataclass(frozen=True)
class FlowStart:
    """An equilibrium in a flow's coordinates.

    Attributes:
        problem: the semi-discrete flow.
        q, multipliers: the shape, as exact an equilibrium of the discretization as Newton's method makes it.
    """

    __repr__ = brief

    problem: FlowProblem
    q: Array
    multipliers: Array

    def perturbed(
        self,
        kind: Perturbation,
        delta: float | None = None,
        *,
        xi: float | None = None,
        centre: float | None = None,
        keep: bool = False,
    ) -> Array:
        """The shape perturbed as the paper does it.

        Args:
            kind: ``bump`` (eq. (flp1)), ``critical`` (eq. (flp2): along the most unstable vector) or ``none``.
            delta: size, in radii, ``DELTA`` by default; a negative bump moves the surface outwards.
            xi, centre: of the bump, ``xi`` positive or 0; 1 and 0 by default.
            keep: move the perturbed shape back to the area and volume it had before.

        Raises:
            InputError: an argument that cannot be used or says nothing, or the surface closes.
        """
        choice("perturb", kind, get_args(Perturbation))
        for name, value in {"delta": delta, "keep": keep or None, "xi": xi, "centre": centre}.items():
            given, of_bumps = value is not None, name in ("xi", "centre")
            refuse_idle(
                (given and kind == "none", name, "nothing is perturbed"),
                (given and kind == "critical" and of_bumps, name, "it is for bumps"),
            )
        delta = DELTA if delta is None else finite("delta", delta)
        xi, centre = 1.0 if xi is None else finite("xi", xi), 0.0 if centre is None else finite("centre", centre)
        if not xi >= 0:
            raise InputError("xi", "it must not be negative, or the bump is infinite somewhere", "give 0 or more")
        if kind == "none":
            return self.q
        if kind == "bump":
            q = bump(self.problem, self.q, delta, xi, centre)
        else:
            q = along_critical(self.problem, self.q, self.multipliers, delta)[0]
        if not keep:
            return q
        whole = replace(self.problem, law="area and volume")  # whatever the flow keeps
        return constrained(whole, q, whole.constraints(self.q), normally=True)

    def flow(self, q: Array, options: FlowOptions | None = None) -> FlowResult:
        """The flow from a shape on."""
        return flow(self.problem, q, options)


def pearl_start(problem: PearlProblem, u: Array, *, points: int = POINTS, law: Law = "area and volume") -> FlowStart:
    """Pearls of a branch, on the whole tube, as a graph that can flow; the first point of the profile is at ``x = 0``.

    Args:
        problem, u: a point of a branch of pearls.
        points: on the whole tube, to begin with; more are taken where the shape needs them.
        law: what the flow keeps.

    Raises:
        InputError: the shape overhangs or cannot be resolved, or an argument cannot be used.
    """
    found = problem.observables(u)
    graph = GraphFlow(found["c0"], found["L"], points, law, found["lambda2"] if law == "area" else 0.0)
    profile = problem.profile(u)
    while True:
        q = graph.coordinates(profile.radii_at(graph.x))
        if graph.resolution(q) < graph.wanted_resolution:
            break
        finer = graph.refined(q)
        if finer is None:
            raise InputError(
                "point", f"{graph.points} points do not resolve its shape", "choose one with a thicker neck"
            )
        graph = finer[0]
    # Interpolation leaves some 1e-10 of the area and volume that the branch has exactly.
    kept = np.array([1.0, found["v"] / 2])
    q = constrained(replace(graph, law="area and volume"), q, kept)
    multipliers = np.array([found["lambda1"], found["lambda2"]][: len(graph.constraints(q))])
    return FlowStart(graph, q, multipliers)


def profile_start(
    c0: float,
    length: float,
    x: Array,
    r: Array,
    *,
    points: int = POINTS,
    law: Law = "area and volume",
    pressure: float = 0.0,
) -> tuple[GraphFlow, Array]:
    """Any axisymmetric graph, given by radii at some places, as a flow and its coordinates; no equilibrium is asked for.

    Args:
        c0, length: the tube's.
        x, r: places along one period and radii there; a periodic cubic spline goes through them. The last row may be the
            first one again, a period later, to the precision of the table.
        points: of the flow.
        law, pressure: what the flow keeps, and the pressure difference where that is the area alone.

    Raises:
        InputError: an argument that cannot be used.
    """
    from pearlbvp.studies.profiles import one_period  # with scipy.interpolate, which only profiles need

    tube = Tube(c0, length)
    spline = one_period(x, r, tube.length)
    graph = GraphFlow(tube.c0, tube.length, points, law, pressure)
    return graph, graph.coordinates(spline(graph.x))


def tube_start(
    problem: TubeProblem, u: Array, *, size: tuple[int, int] = (12, 12), law: Law = "area and volume"
) -> FlowStart:
    """A ring, coil, buckle or mixed tube of a branch among modes without symmetry, polished there.

    Args:
        problem, u: a point of a branch of tubes.
        size: largest wave numbers along and around.
        law: what the flow keeps.

    Raises:
        InputError: so few modes hold no such equilibrium, or an argument cannot be used.
    """
    found = problem.observables(u)
    problem, u = problem.freeing(u, *problem.free)  # c0 and the length may vary on the branch
    tube = TubeFlow(problem.c0, problem.length, size, law, found["lambda2"] if law == "area" else 0.0)
    q = tube.coordinates(problem.modes, problem.coefficients(u), problem.k, problem.kappa)
    return _settled(tube, q, found)


def pearl_tube_start(
    problem: PearlProblem, u: Array, *, size: tuple[int, int] = (24, 6), law: Law = "area and volume"
) -> FlowStart:
    """Pearls of a branch among the modes of tubes without symmetry; see ``tube_start``."""
    found = problem.observables(u)
    tube = TubeFlow(found["c0"], found["L"], size, law, found["lambda2"] if law == "area" else 0.0)
    x = (np.arange(16 * size[0]) / (16 * size[0]) - 0.5) * tube.length
    return _settled(tube, tube.of_radii(x, problem.profile(u).radii_at(x)), found)


def _settled(tube: TubeFlow, q: Array, found: Mapping[str, float]) -> FlowStart:
    kept = np.array([1.0, found["v"] / 2])[: 1 if tube.law == "area" else 2]
    multipliers = np.array([found["lambda1"], found["lambda2"]])[: len(kept)]
    if found["amplitude"] < SMALLEST_AMPLITUDE:  # the straight tube is exact, and Newton's method singular there
        return FlowStart(tube, q, multipliers)
    there = polished(tube, q, multipliers, kept)
    if not there.converged or abs(there.observables["E"] - found["E"]) > UNLIKE * found["E"]:
        raise InputError("size", f"{tube.size[0]} x {tube.size[1]} modes do not hold a branch's shape", "take more")
    return FlowStart(tube, there.q, there.multipliers)


def solution_start(
    point: Solution[Any],
    *,
    law: Law = "area and volume",
    size: tuple[int, int] | None = None,
    points: int | None = None,
    symmetric: bool = True,
    nodes: int | None = None,
    discretization: Kind | None = None,
) -> FlowStart:
    """A solution of any family in the coordinates that suit it: an axisymmetric one as a graph, a mesh as it is, else modes.

    Args:
        point: of a branch of any family.
        law: what the flow keeps.
        size: largest wave numbers along and around, of tubes in modes; 12 and 12 by default, 24 and 6 of pearls.
        points: of an axisymmetric graph, 128 by default.
        symmetric: whether an axisymmetric shape is to stay one; others flow among all tubes anyway.
        nodes: on a triangulated tube of about so many vertices.
        discretization: of that, ``subdivision`` by default.

    Raises:
        InputError: the shape cannot be described so, or an argument cannot be used or says nothing.
    """
    problem = known_point(point).problem.shapes
    own, outline = problem.own_mesh(point.u) is not None, problem.drawn == "outline"
    meshes, graph = own or nodes is not None, outline and symmetric
    its_own = "the branch is on a mesh, which is taken as it is"
    refuse_idle(
        (own and nodes is not None, "nodes", its_own),
        (own and discretization is not None, "discretization", its_own),
        (not meshes and discretization is not None, "discretization", "it is for triangulated tubes, which (nodes) asks for"),
        *((meshes and given, name, "it says nothing of a triangulated tube")
          for name, given in (("symmetric", not symmetric), ("points", points is not None), ("size", size is not None))),
        (not graph and points is not None, "points", "it is for axisymmetric shapes, and tubes have (size)"),
        (graph and size is not None, "size", "it is for tubes, and axisymmetric shapes have (points)"),
    )  # fmt: skip
    if meshes:
        from pearlbvp.studies.mesh import NODES
        from pearlbvp.studies.mesh_flow import mesh_start  # the room of meshes is large, and only meshes need it

        count = NODES if nodes is None else whole("nodes", nodes)
        return mesh_start(point, count, kind=discretization or "subdivision", law=law)
    size = None if size is None else mode_numbers("size", size)
    if not outline:
        tube, u, _ = problem.in_modes(point.u, point.tangent)
        return tube_start(tube, u, law=law, size=size or (12, 12))
    if not symmetric:
        return pearl_tube_start(problem, point.u, law=law, size=size or (24, 6))
    return pearl_start(problem, point.u, points=known_points(points), law=law)


def known_end(result: FlowResult) -> Equilibrium:
    """Where a flow came to rest.

    Raises:
        InputError: it did not.
    """
    if result.equilibrium is None or not result.equilibrium.converged:
        raise InputError("flow", f"it ended as {result.status!r} and is no equilibrium", "let it rest first")
    return result.equilibrium


def end_start(result: FlowResult) -> FlowStart:
    """The shape on which a flow rests, in that flow's coordinates: to be perturbed and to flow on, by the same law.

    Raises:
        InputError: it did not come to rest.
    """
    end, state = known_end(result), result.state
    return FlowStart(state.problem, end.q, end.multipliers[: len(state.multipliers)])
