"""Which shapes branch off, how do they continue, which are stable? Branches of pearls; branches of any family varied."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pearlbvp.continuation.branch import Branch, BranchOptions, BranchPoint, SpecialPoint, continue_branch, start_point
from pearlbvp.continuation.path import PathOptions, Point, correct
from pearlbvp.continuation.switching import switch, tangent_along
from pearlbvp.continuation.two_parameters import NOISE, CurveOnSurface, follow
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, finite, positive
from pearlbvp.newton import NewtonOptions
from pearlbvp.shapes.graph import pearl_of_graph, relaxed
from pearlbvp.shapes.pearl import Centre, PearlProblem, pearling_onset
from pearlbvp.stability.bloch import Fixed
from pearlbvp.studies.ends import limit
from pearlbvp.theory.dispersion import onset_lambda2
from pearlbvp.units import Sentence

COLUMNS = ["point", "special", "lambda1", "lambda2", "v", "E", "amplitude", "r_min", "r_max", "n_unstable", "mu_crit",
           "critical", "c0", "L", "mu_error", "wave"]  # fmt: skip
TURNS = ("lambda1", "lambda2", "v", "E", "amplitude", "r_min", "r_max", "c0", "L")
"""Columns whose turning points can be located."""

STOPS = (*TURNS, "mu_crit", "wave")
"""Columns at a value of which a branch can stop."""

NO_SHAPE = 1e-3
"""Amplitude up to which the shape of least energy is the straight tube: of others the volume is at least 5e-7 from 1."""
SPECIAL = ("bp", "cmc", "fold", *(f"fold:{name}" for name in TURNS))
"""Kinds of special points at which a branch can stop."""

LONGEST_PEARL = 1000.0
"""Longest period of a branch of pearls: its meshes grow with it."""


def branch_options(
    until: Mapping[str, float] | None = None,
    *,
    max_points: int = 200,
    step: float | None = None,
    max_step: float = 0.5,
    progress: Callable[[Branch[Any]], None] = lambda branch: None,
    locating: Callable[[int, int], None] = lambda done, of: None,
) -> BranchOptions:
    """Options of a branch of any family.

    Args:
        until: column and value at which to stop exactly, or kind and number of a special point: ``{"v": 1.1}``,
            ``{"bp": 1}`` for the first branch point, ``{"fold:v": 2}``, ``{"cmc": 1}``, ``{"fold": 1}`` for the first fold of
            any. Special points are counted from where the branch goes on. Several may be given, the first reached counts.
        max_points: end after so many, start and special points among them.
        step, max_step: first (by default 0.1 or ``max_step``) and largest step, in the norm of shape and parameters.
        progress: called with the branch so far after each point.
        locating: called while special points are located, with how many are and how many there are in the step.

    Raises:
        InputError: an argument that cannot be used.
    """
    wanted = {name: finite(f"until {name}", value) for name, value in (until or {}).items()}
    special = {kind: _number(kind, wanted.pop(kind)) for kind in list(wanted) if kind in SPECIAL}
    for name in wanted:
        if name not in STOPS:
            raise InputError(
                f"until: a branch cannot stop at a value of {name!r}; choose one of {', '.join(STOPS)}, or one of the special "
                "points bp, cmc, fold:NAME"
            )
    if max_points < 2:
        raise InputError(f"max_points: {max_points} must be 2 or more; the first is the start")
    if not max_step > 1e-6:
        raise InputError(f"max_step: {max_step:g} must be above 1e-6; give one like 0.5")
    if step is None:
        step = min(0.1, max_step)
    if not 1e-6 < step <= max_step:
        raise InputError(f"step: {step:g} must be above 1e-6 and not above max_step = {max_step:g}; give one between")

    path = PathOptions(step=step, max_step=max_step, max_points=max_points)
    return BranchOptions(
        path=path, until=wanted, until_special=special, limit=limit, progress=progress, locating=locating
    )


def _number(kind: str, value: float) -> int:
    """The number of a special point.

    Raises:
        InputError: it is no whole number from 1 on.
    """
    if value != int(value) or value < 1:
        raise InputError(f"until: {value:g} is no number of a {kind}; count them from 1")
    return int(value)


def pearl_branch(
    c0: float,
    length: float,
    m: int = 1,
    options: BranchOptions | None = None,
    *,
    tolerance: float = 1e-9,
    fixed: Fixed = "area and volume",
) -> Branch[PearlProblem]:
    """The branch of ``m`` equal pearls on a tube, from the straight cylinder on, with stability on the whole tube.

    Args:
        c0: spontaneous curvature.
        length: axial period of the tube, in radii.
        m: number of pearls.
        options: where to stop and how to step, from ``branch_options``.
        tolerance: estimated error of the profile at which the mesh is refined.
        fixed: what the perturbations keep that stability is judged by.

    Returns:
        The branch; ``branch.table()`` has the columns ``COLUMNS``.

    Raises:
        InputError: an argument that cannot be used.
    """
    tube = Tube(c0, length)
    if m != int(m) or m < 1:
        raise InputError(f"mode: {m} pearls are none; give a whole number from 1 on")
    onset_lambda2(tube, int(m), 0)
    if length / m > LONGEST_PEARL:
        text = f"length: pearls of period {{period:g}} are longer than {LONGEST_PEARL:g} radii; take more of them"
        raise InputError(Sentence(text, period=length / m))
    if not 1e-13 <= tolerance <= 1e-3:
        raise InputError(f"tolerance: {tolerance:g} is not between 1e-13 and 1e-3")
    problem, u, tangent = pearling_onset(tube, m, tolerance=tolerance)
    start = start_point(replace(problem, fixed=fixed), u, tangent)
    return continue_branch(start, options or branch_options(), at_bifurcation=True)


def shape_branch(
    c0: float,
    length: float,
    v: float,
    cosines: Sequence[float],
    options: BranchOptions | None = None,
    *,
    cells: int = 1,
    tolerance: float = 1e-9,
    fixed: Fixed = "area and volume",
) -> Branch[PearlProblem]:
    """The branch through the shape of least energy that lies downhill from a guess: a way to isolated branches.

    The shape is symmetric about ``x = 0``; the branch leads from it to smaller and to larger volume. ``until`` holds in
    either direction, and the points run from smaller to larger volume at the shape.

    Args:
        c0: spontaneous curvature.
        length: axial period of the shape, in radii.
        v: reduced volume at which the energy is minimised.
        cosines: the guess ``a_1, a_2, ...``: ``r = 1 + sum of a_k cos(2 pi k x / L)``.
        options: where to stop and how to step, from ``branch_options``.
        cells: how many periods the tube has that stability is judged on.
        tolerance: estimated error of the profile at which the mesh is refined.
        fixed: what the perturbations keep that stability is judged by.

    Raises:
        InputError: an argument that cannot be used, or a guess from which no equilibrium is reached.
    """
    tube, v = Tube(c0, length), positive("volume", v)
    amplitudes, why = relaxed(tube, v, np.array([finite("shape", value) for value in cosines]))
    if why:
        raise InputError(f"shape: {why}")
    near = float(np.abs(amplitudes[1:]).max())
    if near > NO_SHAPE:
        problem, u, why = pearl_of_graph(tube, v, amplitudes, tolerance=tolerance)
        if why:
            raise InputError(f"shape: the shape of least energy led to no equilibrium ({why}); try other cosines")
        near = problem.observables(u)["amplitude"]
    if near <= NO_SHAPE:
        raise InputError(
            "shape: downhill from it at this volume lies the straight tube, where branches cross; give other cosines or "
            "another volume, or leave --shape out for the pearls that leave the tube"
        )
    problem = replace(problem, fixed=fixed, cells=cells)
    upwards = np.zeros_like(u)
    upwards[-1] = 1.0  # v is the last unknown
    tangent = tangent_along(problem, u, upwards)
    options = options or branch_options()
    down = continue_branch(start_point(problem, u, -tangent), options)
    lower, asked = down.reversed(), options
    both = replace(options, progress=lambda so_far: asked.progress(lower.extended(so_far)))
    return lower.extended(continue_branch(start_point(problem, u, tangent), both))


def varied(
    branch: Branch[Any],
    index: int,
    vary: str,
    options: BranchOptions,
    *,
    keep: str = "v",
    upwards: bool = True,
) -> Branch[Any]:
    """The branch through a point of another on which ``c0`` or the length changes.

    Args:
        branch: a branch of pearls, or of coils, buckles and what branches off from them.
        index: which of its points (negative: from the end).
        vary: ``c0`` or ``L``.
        options: where to stop and how to step.
        keep: what stays as it is at that point: ``v`` or ``lambda2``.
        upwards: whether ``vary`` is to grow at first.

    Raises:
        InputError: a name or number that cannot be used, or a branch of rings.
    """
    parameter = _varying(branch, vary)
    if keep not in ("v", "lambda2"):
        raise InputError(f"keep: {keep!r} cannot be kept; choose v or lambda2")
    if not -len(branch.points) <= index < len(branch.points):
        raise InputError(f"point: there is no point {index}; the branch has points 0 to {len(branch.points) - 1}")
    index %= len(branch.points)
    point = branch.points[index].point
    if point.observables["amplitude"] < 1e-9:
        raise InputError(f"point: point {index} is the cylinder, where branches cross; choose a point further on")
    other = "lambda2" if keep == "v" else "v"
    problem, u = point.problem.released(point.u, "lambda1", other, parameter)
    direction = np.zeros_like(u)
    direction[problem.place(parameter)] = 1.0 if upwards else -1.0
    try:
        tangent = tangent_along(problem, u, direction)
    except np.linalg.LinAlgError:
        raise InputError(f"vary: {vary} turns just at point {index}; start from a point beside it") from None
    options = replace(options, folds=(vary, *options.folds))
    return continue_branch(start_point(problem, u, tangent), options, at_bifurcation="bp" in branch.kinds(index))


def _varying(branch: Branch[Any], vary: str) -> str:
    """The problems' name of ``c0`` or the length, where the branch's shapes depend on it.

    Raises:
        InputError: another name, or a branch of rings.
    """
    names = {"c0": "c0", "L": "length"}
    if vary not in names:
        raise InputError(f"vary: {vary!r} cannot be varied; choose c0 or L (lambda2 and v vary on every branch)")
    if branch.points[0].point.problem.stored_as == "mesh":
        raise InputError(
            f"vary: a branch on a mesh keeps its {vary}; follow one from the straight tube at another value"
        )
    if not hasattr(branch.points[0].point.problem, "released"):
        raise InputError(
            f"vary: the shape of rings does not depend on {vary}; for where it exchanges stability, see "
            "pearlbvp.studies.ring_onsets in Python"
        )
    return names[vary]


def followed(
    branch: Branch[Any], kind: str, number: int, vary: str, options: BranchOptions, *, upwards: bool = True
) -> Branch[CurveOnSurface]:
    """The curve of a fold or a branch point of a branch while ``c0`` or the length varies.

    Args:
        branch: a branch of pearls, or of coils, buckles and what branches off from them.
        kind: ``bp``, or ``fold:NAME`` of a column.
        number: which of them (the first is 1).
        vary: ``c0`` or ``L``.
        options: where to stop and how to step. Turning points of ``c0`` and ``L`` (cusps of a fold) are watched too.
        upwards: whether ``vary`` is to grow at first.

    Raises:
        InputError: there is no such special point, or it was not located, or ``vary`` is another name, or the branch is one
            of rings.
    """
    parameter = _varying(branch, vary)
    found = branch.find(kind)
    if not 1 <= number <= len(found):
        raise InputError(
            f"follow: the branch has {len(found)} special points {kind}, so there is none of number {number}"
        )
    if not found[number - 1].converged:
        raise InputError(f"follow: {kind} number {number} was not located; follow the branch in shorter steps")
    start = branch.at(found[number - 1]).point
    sign = math.copysign(1.0, start.problem.straightness(start.u))

    def excess(point: Point[CurveOnSurface]) -> float:
        return sign * float(point.problem.base.straightness(point.u)) - STRAIGHT_WAVE

    def bounded(point: BranchPoint[CurveOnSurface]) -> str | None:
        return STRAIGHT if excess(point.point) < 0 else options.limit(point)

    curve = follow(
        branch, found[number - 1], parameter, replace(options, folds=(vary, "v"), limit=bounded), upwards=upwards
    )
    return _up_to_straight(curve, excess) if curve.reason.startswith(STRAIGHT) else curve


STRAIGHT = "the shapes become the straight tube; beyond, the curve would repeat their mirror images"

STRAIGHT_WAVE = 0.02
"""Amplitude (the problems' ``straightness``) of shapes that are called straight. What the curve leads to differs by its square.

Nearer, the conditions of what happens at onset, which are proportional to the amplitude or its square, fade.
"""


def _up_to_straight(
    curve: Branch[CurveOnSurface], excess: Callable[[Point[CurveOnSurface]], float]
) -> Branch[CurveOnSurface]:
    """A curve that ends beyond the place where a function changes its sign, up to that place, found by secants.

    The conditions' rounding is felt here: Newton's method is content with ``NOISE``, as along the curve.
    """
    beyond = curve.points[-1].point
    while len(curve.points) > 1 and excess(curve.points[-1].point) <= 0:
        curve = curve.without_last()
    start = curve.points[-1].point
    problem, tangent = start.problem, start.tangent
    known = [(problem.inner(tangent, problem.adopt(beyond.problem, beyond.u) - start.u), beyond), (0.0, start)]
    while len(known) < 10 and abs(excess(known[-1][1])) > 1e-10:
        (s0, one), (s1, two) = known[-2:]
        s = s1 - excess(two) * (s1 - s0) / (excess(two) - excess(one))
        guess = two.u + (s - s1) * tangent
        result, direction = correct(problem, guess, tangent, start.u, s, NewtonOptions(rounding=NOISE))
        if not result.converged:
            return curve
        found = start_point(problem, result.u, direction)
        known.append((s, found))
    end = BranchPoint(known[-1][1], problem.spectrum(known[-1][1].u))
    return curve.extended(Branch([curve.points[-1], end], [SpecialPoint("end", 1)], curve.reason, curve.complete))


def switched(
    branch: Branch[PearlProblem],
    number: int,
    options: BranchOptions,
    *,
    centre: Centre = "pearl",
    grow: bool = True,
) -> Branch[PearlProblem]:
    """The branch that crosses ``branch`` at its branch point ``number`` (the first is 1).

    Args:
        branch: a branch of pearls.
        number: which of its branch points.
        options: where to stop and how to step.
        centre: whether the new shapes are centred on a pearl or on a neck, where both branch off.
        grow: follow the half on which the tube grows at its centre.

    Raises:
        InputError: there is no such branch point, or its new shapes are not axisymmetric.
    """
    special = numbered(branch, number)
    if special.block.n != 0:
        what = f"switch: at branch point {number} shapes with n = {special.block.n} branch off, which are no pearls"
        raise InputError(Sentence.joined(what, _on_a_mesh(branch, special)))
    return switch(branch, special, options, centre=centre, grow=grow)


def _on_a_mesh(branch: Branch[PearlProblem], special: SpecialPoint[Any]) -> str:
    """How shapes that are not axisymmetric are followed: from the same pearls on a triangulated tube."""
    place, start = branch.at(special).point.observables, branch.points[0].point
    if start.observables["amplitude"] > 1e-6:
        return (
            "; a mesh may follow them, in Python: studies.mesh.branch_from(*meshed(branch.points[k], 1000), options) "
            "goes on from these pearls, and mesh_switched leaves it"
        )
    pearls = round(place["L"] / start.problem.profile(start.u).period)
    return Sentence(
        "; a mesh may follow them: pearlbvp branch pearl --c0 {c0:.12g} --length {L:.12g}{radius_option} "
        f"--mode {pearls},0 --nodes 1000 --save FILE.h5, then --resume FILE.h5 --switch the branch point that is there near "
        "lambda2 = {lambda2:.4g}, v = {v:.6g}",
        **{name: place[name] for name in ("c0", "L", "lambda2", "v")},
    )


def numbered(branch: Branch[Any], number: int) -> SpecialPoint[Any]:
    """The branch point of a number (the first is 1).

    Raises:
        InputError: there is none, or it was not located.
    """
    found: list[SpecialPoint[Any]] = branch.find("bp")
    if not 1 <= number <= len(found):
        raise InputError(f"switch: the branch has {len(found)} branch points, so there is none of number {number}")
    special = found[number - 1]
    if not special.converged:
        raise InputError(
            f"switch: branch point {number} was not located; follow the branch in shorter steps (--max-step)"
        )
    return special
