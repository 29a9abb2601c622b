"""Does the flow get there? Flows from a branch's shapes, perturbed, and their ends handed back to continuation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np

from pearlbvp.collocation import PiecewisePolynomial
from pearlbvp.collocation.scheme import Array
from pearlbvp.continuation.branch import Branch, BranchOptions, continue_branch, start_point
from pearlbvp.continuation.switching import tangent_along
from pearlbvp.errors import InputError
from pearlbvp.flow.axisymmetric import GraphFlow
from pearlbvp.flow.driver import FlowOptions, constrained, flow
from pearlbvp.flow.perturbation import along_critical, bump
from pearlbvp.flow.problem import Law
from pearlbvp.flow.record import Equilibrium, FlowResult
from pearlbvp.flow.steady import polished
from pearlbvp.flow.tube import TubeFlow
from pearlbvp.helfrich import Tube, finite
from pearlbvp.shapes.graph import pearl_of_graph
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.stability.profile import Profile
from pearlbvp.studies.branch import branch_options
from pearlbvp.tube.problem import TubeProblem

UNLIKE = 1e-5
"""Relative difference of the energies of a branch's shape and of the flow's, beyond which the modes are too few."""

Perturbation = Literal["none", "bump", "critical"]


@dataclass(frozen=True)
class FlowStart:
    """An equilibrium in a flow's coordinates.

    Attributes:
        problem: the semi-discrete flow.
        q, multipliers: the shape, as exact an equilibrium of the discretization as Newton's method makes it.
    """

    problem: Any
    q: Array
    multipliers: Array

    def perturbed(
        self, kind: Perturbation, delta: float, *, xi: float = 1.0, centre: float = 0.0, keep: bool = False
    ) -> Array:
        """The shape perturbed as the paper does it.

        Args:
            kind: ``bump`` (eq. (flp1)), ``critical`` (eq. (flp2): along the most unstable vector) or ``none``.
            delta: size, in radii; a negative bump moves the surface outwards.
            xi, centre: of the bump.
            keep: move the perturbed shape back to the area and volume it had before.

        Raises:
            InputError: an argument that cannot be used, or the surface closes.
        """
        if kind not in get_args(Perturbation):
            raise InputError(f"perturb: {kind!r} is none of {', '.join(get_args(Perturbation))}")
        delta = finite("delta", delta)
        if kind == "none":
            return self.q
        if kind == "bump":
            q = bump(self.problem, self.q, delta, xi, centre)
        else:
            q = along_critical(self.problem, self.q, self.multipliers, delta)[0]
        return constrained(self.problem, q, self.problem.constraints(self.q)) if keep else q

    def flow(self, q: Array, options: FlowOptions | None = None) -> FlowResult:
        """The flow from a shape on."""
        return flow(self.problem, q, options)


def radii_at(profile: Profile, x: Array) -> Array:
    """Radius of a profile that is a graph over its axis, at axial positions counted from its first point.

    Raises:
        InputError: the profile overhangs.
    """
    whole = profile.mirrored()
    if np.cos(whole.states.values[:, 1]).min() <= 0:
        raise InputError(
            "point: its shape overhangs, so it is no graph over its axis; choose one nearer to the cylinder"
        )
    along = PiecewisePolynomial(whole.states.mesh, profile.outline()[0][:, None])
    targets = np.mod(x, profile.period)
    sigma = np.interp(targets, profile.outline()[0], whole.states.points)
    for _ in range(30):
        step = (along(sigma)[:, 0] - targets) / (whole.arclength * np.cos(whole.states(sigma)[:, 1]))
        sigma = np.clip(sigma - step, 0.0, 1.0)
        if np.abs(step).max() < 1e-14:
            break
    return whole.states(sigma)[:, 0]


def pearl_start(
    problem: PearlProblem, u: Array, *, points: int = 128, law: Law = "area and volume", resolution: float = 1e-9
) -> FlowStart:
    """Pearls of a branch, on the whole tube, as a graph that can flow; the first point of the profile is at ``x = 0``.

    Args:
        problem, u: a point of a branch of pearls.
        points: on the whole tube, to begin with; more are taken where the shape needs them.
        law: what the flow keeps.
        resolution: of the graph.

    Raises:
        InputError: the shape overhangs or cannot be resolved, or an argument cannot be used.
    """
    found = problem.observables(u)
    graph = GraphFlow(found["c0"], found["L"], points, law, found["lambda2"] if law == "area" else 0.0)
    profile = problem.profile(u)
    while True:
        q = graph.coordinates(radii_at(profile, graph.x))
        if graph.resolution(q) < resolution:
            break
        finer = graph.refined(q)
        if finer is None:
            raise InputError(f"point: {graph.points} points do not resolve its shape; choose one with a thicker neck")
        graph = finer[0]
    multipliers = np.array([found["lambda1"], found["lambda2"]][: len(graph.constraints(q))])
    return FlowStart(graph, q, multipliers)


def tube_start(
    problem: TubeProblem, u: Array, *, size: tuple[int, int] = (12, 12), law: Law = "area and volume"
) -> FlowStart:
    """A ring, coil or buckle of a branch among modes without symmetry, polished there.

    Args:
        problem, u: a point of a branch of tubes.
        size: largest wave numbers along and around.
        law: what the flow keeps.

    Raises:
        InputError: so few modes hold no such equilibrium, or an argument cannot be used.
    """
    found = problem.observables(u)
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
    return _settled(tube, tube.of_radii(x, radii_at(problem.profile(u), x)), found)


def _settled(tube: TubeFlow, q: Array, found: Mapping[str, float]) -> FlowStart:
    kept = np.array([1.0, found["v"] / 2])[: 2 if tube.law == "area and volume" else 1]
    multipliers = np.array([found["lambda1"], found["lambda2"]])[: len(kept)]
    there = polished(tube, q, multipliers, kept)
    if not there.converged or abs(there.observables["E"] - found["E"]) > UNLIKE * found["E"]:
        raise InputError(f"size: {tube.size[0]} x {tube.size[1]} modes do not hold a branch's shape; take more")
    return FlowStart(tube, there.q, there.multipliers)


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
