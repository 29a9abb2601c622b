"""Does the flow get there? The ends of flows as points of branches: which family, how stable, and on from there.

Branches live at area ``2 pi L``. A flow keeps the area it starts with: its end is similar to a shape of that area on a tube of
length ``L/s`` with spontaneous curvature ``c0 s``, ``s = A/(2 pi L)``: lengths measured in a unit of ``s`` radii. That shape is
the point of a branch; its growth rates are ``s^4`` times those in the flow's own units.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.branch import Branch, SpecialPoint, Status
from pearlbvp.continuation.following import BranchOptions, continue_branch
from pearlbvp.continuation.path import correct_at
from pearlbvp.continuation.problem import Problem
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.switching import tangent_along
from pearlbvp.errors import InputError
from pearlbvp.flows.axisymmetric import GraphFlow
from pearlbvp.flows.record import Equilibrium, FlowResult
from pearlbvp.flows.tube import TubeFlow
from pearlbvp.held import Held
from pearlbvp.helfrich import SMALLEST_AMPLITUDE
from pearlbvp.membrane import MembraneProblem
from pearlbvp.newton import NewtonOptions
from pearlbvp.shapes.outline import Outline, pearl_of_outline
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.studies.branch import known_options
from pearlbvp.studies.flow_start import UNLIKE, known_end
from pearlbvp.tube.isotropy import NEGLIGIBLE, StandardPosition, standard_position
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.problem import PLANE_TOLERANCE, TubeProblem
from pearlbvp.tube.symmetry import TubeSymmetry
from pearlbvp.units import Units

if TYPE_CHECKING:
    from pearlbvp.flows.mesh import MeshFlow
    from pearlbvp.mesh.problem import MeshProblem

M = TypeVar("M", bound=MembraneProblem)

FEWEST_WAVES = 8
"""Periods or folds that a tube has at first; more are taken where the shape needs them."""

MOST_REMESHES = 6

MOST_SINES = 256
"""Of an outline's angle from which Newton's method starts: their matrices grow with the square."""

ROUNDING = 1e-11
"""Relative differences of areas that are rounding: constraints are kept to 1e-14 of each step."""

STRAIGHT = (
    "flow",
    "its end is the straight tube, where branches cross and tension and pressure are not told apart",
    "pearlbvp dispersion has its stability",
)


def recognized(end: Equilibrium) -> StandardPosition:
    """Which symmetry and family the end of a flow of tubes has, and how it lies: in the flow's own units.

    Raises:
        InputError: the end is no tube in reduced modes, or no equilibrium.
    """
    _check(end)
    if not isinstance(end.problem, TubeFlow):
        raise InputError(
            "flow", "its end is no tube in reduced modes, of which alone symmetries are recognized", "see solution_of"
        )
    return standard_position(end.problem.known(end.q), end.problem.length)


def described(end: Equilibrium) -> str:
    """What the end of a flow is, in a few words: ``a right-handed coil``."""
    if isinstance(end.problem, GraphFlow):
        return "an axisymmetric tube"
    if not isinstance(end.problem, TubeFlow):
        return f"a triangulated tube of {_on_mesh(end).reference.mesh.count} nodes"
    position = recognized(end)
    hand = {1: "right-handed ", -1: "left-handed ", 0: ""}[position.handedness]
    return {
        "cylinder": "the straight tube",
        "ring": f"a ring of {position.symmetry.fold} lobes",
        "pearl": "an axisymmetric tube",
    }.get(position.family, f"a {hand}{position.family}{' tube' if position.family == 'mixed' else ''}")


def solution_of(
    end: Equilibrium, unlike: float = UNLIKE, judged: bool = False
) -> tuple[PearlProblem | TubeProblem | MeshProblem, Array]:
    """The end of a flow as a point of a branch of its family, by Newton's method in the space of its symmetry.

    Axisymmetric shapes with a plane of reflection become pearls in arclength, triangulated tubes stay what they are, and all
    others become tubes in reduced modes; a tube with fewer reflections gets a phase condition for each rigid motion that its
    space leaves free. Coils of the other handedness become their mirror images, which the model does not tell apart.

    Args:
        end: where the flow came to rest.
        unlike: relative difference of the energies of both that its few modes explain, of tubes in modes.
        judged: whether its stability is to be computed, of tubes in modes.

    Raises:
        InputError: it is no equilibrium, or the straight tube, or an axisymmetric graph without a plane of reflection, or
            Newton's method fails.
        SpectrumError: its stability would take too many modes.
    """
    _check(end)
    held = Held(volume=end.problem.law != "area")
    if isinstance(end.problem, GraphFlow):
        pearls, u = pearls_of(end)
        return replace(pearls, held=held), u
    if not isinstance(end.problem, TubeFlow):
        return _meshes(end)
    position = recognized(end)
    if position.family == "cylinder":
        raise InputError(*STRAIGHT)
    if position.family == "pearl":
        cosines = [position.known.get(Mode("sigma", p), 0.0) for p in range(end.problem.size[0] + 1)]
        pearls, u = _pearls(end, np.array(cosines), 1e-10)
        return replace(pearls, held=held), u
    return _tubes(end, position, held, unlike, judged)


def similarity(end: Equilibrium) -> Units:
    """What leads from the end of a flow to the similar shape of area ``2 pi L``: the unit in which that is measured.

    A flow from a branch keeps the area of the tube it is on, where that is asked for. Where only rounding tells the areas
    apart, its end is on the very tube that was given, with the digits that it was given by.
    """
    area = end.observables["area"]
    return Units(1.0 if abs(area - 1) < ROUNDING else area)


def _check(end: Equilibrium) -> None:
    if not end.converged:
        raise InputError("flow", "its last shape is no equilibrium", "let it rest first")


def _tubes(
    end: Equilibrium, position: StandardPosition, held: Held, unlike: float = UNLIKE, judged: bool = False
) -> tuple[TubeProblem, Array]:
    """The similar tube of area ``2 pi L`` in the modes of its symmetry, by Newton's method at its reduced volume."""
    found, symmetry = end.observables, position.symmetry
    similar = similarity(end)
    known = {mode: similar.from_user("r", value) for mode, value in position.known.items()}
    along, around = _size(known, symmetry)
    tolerance = PLANE_TOLERANCE if along and around else TubeProblem.tolerance
    tube = similar.tube(end.problem.c0, end.problem.length)
    problem = TubeProblem(symmetry, tube.c0, tube.length, (along, around), tolerance=tolerance, held=held)
    problem = problem.pinned_at(dict(zip(problem.modes, problem.packed(known), strict=True)))
    u = _at_its_volume(problem, np.append(problem.packed(known), _parameters(found, similar)))
    problem, u = resolved(problem, u, judged)
    energy = problem.observables(u)["E"]
    if abs(energy - similar.from_user("E", found["E"])) > unlike * abs(energy):
        raise InputError("flow", "Newton's method left its end for another equilibrium", "let it flow on more modes")
    return problem, u


def _parameters(found: Mapping[str, float], similar: Units) -> Array:
    """Multipliers and reduced volume of the similar shape: ``V/(pi L)`` is an area."""
    multipliers = [similar.from_user(name, found[name]) for name in ("lambda1", "lambda2")]
    return np.array([*multipliers, similar.from_user("volume_by_length", found["v"])])


def resolved(problem: M, u: Array, judged: bool = False) -> tuple[M, Array]:
    """The solution on as many modes, or as fine a mesh, as it needs, at its reduced volume.

    Args:
        problem, u: the solution.
        judged: whether its stability is to be computed.

    Raises:
        InputError: Newton's method failed on the way.
        SpectrumError: its stability would take too many modes.
    """
    for _ in range(MOST_REMESHES):
        changed = problem.remesh(u)
        if changed is None:
            break
        problem, (u,) = changed
        if judged:
            problem.check_spectrum(u)
        u = _at_its_volume(problem, u)
    return problem, u


def _on_mesh(end: Equilibrium) -> MeshFlow:
    """The flow of triangulated tubes that ended so: the one kind that is left where it is none of the other two."""
    return cast("MeshFlow", end.problem)


def _meshes(end: Equilibrium) -> tuple[MeshProblem, Array]:
    """The similar surface of area ``2 pi L`` on the same triangles, by Newton's method at its reduced volume."""
    from pearlbvp.mesh.problem import about  # the room of meshes is large, and only meshes need it
    from pearlbvp.mesh.start import solved

    flow, found = _on_mesh(end), end.observables
    if found["amplitude"] < SMALLEST_AMPLITUDE:
        raise InputError(*STRAIGHT)
    similar, reference = similarity(end), flow.reference
    mesh = similar.surface_from_user(replace(reference.mesh, vertices=flow.vertices(end.q)))
    c0, parameters = similar.from_user("c0", reference.c0), _parameters(found, similar)
    problem, u = about(reference.functional.on(mesh), c0, parameters, held=reference.held, adapt=reference.adapt)
    return problem, solved(problem, u)


def _size(known: Mapping[Mode, float], symmetry: TubeSymmetry) -> tuple[int, int]:
    """Periods and folds whose ellipse of modes holds all that are not negligible."""
    units = np.array([symmetry.period, symmetry.fold])
    numbers = np.array([(mode.p, mode.harmonic) for mode, value in known.items() if abs(value) > NEGLIGIBLE])
    most = np.maximum(numbers.max(axis=0) / np.maximum(units, 1), FEWEST_WAVES)
    farthest = np.hypot(*(numbers / np.maximum(units, 1) / most).T).max()
    along, around = np.where(units, np.ceil(most * max(farthest, 1.0)), 0)
    return int(along), int(around)


def _at_its_volume(problem: Problem, u: Array) -> Array:
    """Newton's method at fixed reduced volume.

    Raises:
        InputError: it did not converge; the message says why.
    """
    result, _ = correct_at(problem, u, NewtonOptions(max_iterations=15))
    if not result.converged:
        raise InputError(
            "flow",
            f"its end led to no equilibrium among shapes of its symmetry ({result.message})",
            "let it flow on more points or modes",
        )
    return result.u


def _by_volume(u: Array) -> Array:
    """Direction of the reduced volume, the last unknown of every family."""
    direction = np.zeros_like(u)
    direction[-1] = 1.0
    return direction


def pearls_of(end: Equilibrium, tolerance: float = 1e-10) -> tuple[PearlProblem, Array]:
    """The end of an axisymmetric flow as a point of a branch of pearls, by Newton's method on the arclength problem.

    Args:
        end: the equilibrium.
        tolerance: estimated error of the profile.

    Raises:
        InputError: the shape has no plane of reflection, or Newton's method fails.
    """
    graph = end.problem
    if not isinstance(graph, GraphFlow):
        raise InputError("flow", "its end is no axisymmetric graph", "see solution_of")
    fine = replace(graph, points=min(1024, 4 * graph.points))
    middle = _plane(graph, end.q)
    r = np.sqrt(2 * graph.interpolated(end.q, fine.x + fine.length / 2 + middle))
    waves = np.fft.rfft(r) / fine.points
    if np.abs(waves.imag).max() > 1e-6:
        raise InputError(
            "flow", "its end has no plane of reflection, which a branch of pearls needs", "continue another end"
        )
    cosines = 2 * waves.real[: graph.points // 2]
    cosines[0] /= 2
    return _pearls(end, cosines, tolerance)


def _pearls(end: Equilibrium, cosines: Array, tolerance: float) -> tuple[PearlProblem, Array]:
    """The arclength problem's solution at the reduced volume of an end whose radius is a sum of cosines."""
    found = end.observables
    similar = similarity(end)
    pearls = int(np.gcd.reduce(np.flatnonzero(np.abs(cosines) > NEGLIGIBLE)))  # equal ones, on the whole tube
    if pearls == 0:
        raise InputError(*STRAIGHT)
    tube = similar.tube(end.problem.c0, end.problem.length / pearls)
    lambda1, lambda2, v = _parameters(found, similar)
    cosines = similar.from_user("r", cosines[::pearls])
    last = int(np.flatnonzero(np.abs(cosines) > NEGLIGIBLE).max())
    outline = replace(Outline.on(tube, v), waves=min(max(32, 2 * last), MOST_SINES))
    multipliers = np.array([0.0, lambda1, lambda2 / 2])
    problem, u, why = pearl_of_outline(outline, outline.of_radius(cosines[1:]), multipliers, tolerance=tolerance)
    if why:
        what = f"its end led to no equilibrium of the arclength problem ({why})"
        raise InputError("flow", what, "let it rest to a smaller velocity, or flow on more points")
    return resolved(replace(problem, cells=pearls), u)


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


def stability(end: Equilibrium) -> Any:
    """Growth rates of all perturbations of a flow's end, those that break its symmetry too, at area ``2 pi L``.

    Raises:
        InputError: the end state is no point of a branch; see ``solution_of``.
    """
    problem, u = solution_of(end)
    return problem.spectrum(u)


def end_point(result: FlowResult, *, upwards: bool = True, unlike: float = UNLIKE) -> Solution[Any]:
    """The end of a flow as a point of a branch, its tangent towards larger or smaller volume; ``unlike`` as ``solution_of``.

    Raises:
        InputError: the flow did not come to rest, or its end is no point of a branch.
    """
    problem, u = solution_of(known_end(result), unlike)
    direction = _by_volume(u) if upwards else -_by_volume(u)
    try:
        return Solution.along(problem, u, tangent_along(problem, u, direction))
    except np.linalg.LinAlgError:
        raise InputError(
            "flow", "its end is just where volume turns along its branch", "let another shape flow"
        ) from None


def continued(result: FlowResult, options: BranchOptions | None = None, *, upwards: bool = True) -> Branch[Any]:
    """The branch through the end of a flow, towards larger or smaller volume.

    Raises:
        InputError: the flow did not come to rest, or its end is no point of a branch.
    """
    return continue_branch(end_point(result, upwards=upwards), known_options(options))


def end_branch(result: FlowResult) -> Branch[Any]:
    """The end of a flow as a branch of one point, whole as it is: to be saved, and resumed towards either side.

    ``studies.saved.resumed`` follows it to where the first wanted value lies, without one towards larger volume.

    Raises:
        InputError: as ``end_point``.
    """
    point = end_point(result)
    special: list[SpecialPoint] = [SpecialPoint("start", 0), SpecialPoint("end", 0)]
    return Branch([point], special, Status.GIVEN, "it is the end of a flow")
