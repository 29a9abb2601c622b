"""On from a branch: further along it, along another that crosses it, with another parameter, or along its special points."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Literal, get_args

import numpy as np

from pearlbvp.continuation.branch import Branch, SpecialPoint, Status
from pearlbvp.continuation.following import WALL, BranchOptions, continue_branch
from pearlbvp.continuation.path import correct
from pearlbvp.continuation.problem import LiftError
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.switching import switch, tangent_along
from pearlbvp.continuation.two_parameters import NOISE, CurveOnSurface, follow
from pearlbvp.errors import InputError
from pearlbvp.held import Held, known_held
from pearlbvp.helfrich import choice, whole
from pearlbvp.membrane import MembraneProblem
from pearlbvp.messages import counted
from pearlbvp.newton import NewtonOptions
from pearlbvp.studies.branch import SPECIAL, TURNS, known_branch, known_options
from pearlbvp.units import Sentence

Centre = Literal["pearl", "neck"]


def resumed(branch: Branch[Any], options: BranchOptions) -> Branch[Any]:
    """A branch continued from its last point; that and what follows as one branch.

    Args:
        branch: of any family.
        options: where to stop and how to step; wanted special points are numbered from the branch's start.

    Returns:
        The longer branch; the branch as it is where a wanted special point is on it.

    Raises:
        InputError: nothing can follow, or the wanted special point is on the branch, but not located.
    """
    options = known_options(options)
    if wanted_there(branch, options) is not None:
        return branch
    last = branch.points[-1]
    at_wall = (why for name, (at, why) in last.problem.walls.items() if abs(last.value(name) - at) < WALL)
    ended = branch.reason if branch.status is Status.CONTACT else next(at_wall, "")
    if ended:
        raise InputError(
            "resume", f"the branch ends where {ended.partition(';')[0]}, so nothing follows", "branch off before"
        )
    if len(branch.points) == 1 and branch.complete:  # where a flow ended: it has no direction yet
        branch = replace(branch, points=[_towards(last, options.until)])
    further = continue_branch(branch.points[-1], options.beyond(branch), at_bifurcation=branch.ends_at_bifurcation)
    return branch.extended(further)


def led_away(branch: Branch[Any], options: BranchOptions) -> list[str]:
    """Columns that move away from their wanted values where a branch ends: what is resumed reaches those after a turn only."""
    if len(branch.points) == 1:  # it has no direction yet
        return []
    last = branch.points[-1]
    varying = [name for name in options.until if name in last.slopes and name not in last.problem.constant]
    return [name for name in varying if (options.until[name] - last.value(name)) * last.slopes[name] < 0]


def wanted_there(branch: Branch[Any], options: BranchOptions) -> SpecialPoint | None:
    """The special point that is wanted of a branch, where that has it already.

    Raises:
        InputError: it was not located.
    """
    there = known_branch(branch).asked(options.until_special)
    if there is not None and not there.converged:
        raise InputError(
            "until",
            f"the {there.kind} at point {there.index} was not located",
            "follow the branch in shorter steps (max_step)",
        )
    return there


def held_from(branch: Branch[Any], index: int, fix: str | Held | None) -> Branch[Any]:
    """A branch that holds something else at one of its points, from which another is to start.

    Args:
        branch: of any family.
        index: of the point.
        fix: what is held from there on, as ``held.known_held`` takes it; None for what is held already.

    Raises:
        InputError: that is nothing to hold, or no reservoir holds the shape.
    """
    if fix is None:
        return branch
    held, point, points = known_held(fix), branch.points[index], list(branch.points)
    if not isinstance(point.problem, MembraneProblem):
        raise InputError(
            "fix", "a curve of special points keeps what is held", "go on from the branch that it was found on"
        )
    held.check(point.observables)
    points[index] = replace(point, problem=point.problem.holding(held), known=None)
    return replace(branch, points=points)


def _towards(entry: Solution[Any], until: Mapping[str, float]) -> Solution[Any]:
    """A point with its tangent turned to where the first of some wanted values lies, if it is not one of stability.

    Where branches cross, every observable turns, and their two directions have the same shapes.
    """
    for name, value in until.items():
        if name in entry.observables:
            ahead, behind = (entry.problem.observables(entry.u + s * entry.tangent)[name] for s in (1e-5, -1e-5))
            turned = abs(ahead - behind) > TURNING and (ahead - behind) * (value - entry.observables[name]) < 0
            return entry.turned() if turned else entry
    return entry


TURNING = 1e-12
"""Difference of an observable over 2e-5 of arclength that is the rounding of one that turns."""


def varied(
    branch: Branch[Any],
    index: int,
    vary: str,
    options: BranchOptions,
    *,
    keep: str = "v",
    upwards: bool | None = None,
    fix: str | Held | None = None,
) -> Branch[Any]:
    """The branch through a point of another on which ``c0`` or the length changes.

    Args:
        branch: a branch of pearls, or of coils, buckles and what branches off from them.
        index: which of its points (negative: from the end).
        vary: ``c0`` or ``L``.
        options: where to stop and how to step.
        keep: what stays as it is at that point: ``v`` or ``lambda2``.
        upwards: whether ``vary`` is to grow at first; None: towards its value in ``options.until``, or growing.
        fix: what is held from there on while stability is judged, as ``family_branch`` takes it; by default what is already.

    Raises:
        InputError: a name or number that cannot be used, or a branch of rings.
    """
    parameter, options, index = _varying(branch, vary), known_options(options), whole("point", index, -math.inf)
    choice("keep", keep, ("v", "lambda2"))
    if not -len(branch.points) <= index < len(branch.points):
        raise InputError("point", f"there is no point {index}", f"the branch has points 0 to {len(branch.points) - 1}")
    index %= len(branch.points)
    point = held_from(branch, index, fix).points[index]
    if point.observables["amplitude"] < 1e-9:
        raise InputError("point", f"point {index} is the cylinder, where branches cross", "choose a point further on")
    other = "lambda2" if keep == "v" else "v"
    problem, u = point.problem.freeing(point.u, "lambda1", other, parameter)
    direction = np.zeros_like(u)
    direction[problem.place(parameter)] = 1.0 if _growing(upwards, options, vary, point) else -1.0
    try:
        tangent = tangent_along(problem, u, direction)
    except np.linalg.LinAlgError:
        raise InputError("vary", f"{vary} turns just at point {index}", "start from a point beside it") from None
    options = replace(options, folds=(vary, *options.folds))
    return continue_branch(Solution.along(problem, u, tangent), options, at_bifurcation="bp" in branch.kinds(index))


def _growing(upwards: bool | None, options: BranchOptions, vary: str, point: Solution[Any]) -> bool:
    """Whether what varies is to grow at first: as asked, or towards its wanted value."""
    if upwards is not None:
        return upwards
    return options.until.get(vary, math.inf) >= point.observables.get(vary, -math.inf)


def _varying(branch: Branch[Any], vary: str) -> str:
    """The problems' name of ``c0`` or the length, where the branch's shapes depend on it.

    Raises:
        InputError: another name, or a branch of rings.
    """
    problem = known_branch(branch).points[0].problem.shapes
    if vary in tuple(problem.may_vary):  # what is no name is refused below
        return str(problem.may_vary[vary])
    if vary not in ("c0", "L"):
        raise InputError("vary", f"{vary!r} cannot be varied", "choose c0 or L (lambda2 and v vary on every branch)")
    raise InputError("vary", problem.why_fixed.format(name=vary))


def followed(
    branch: Branch[Any],
    kind: str,
    number: int,
    vary: str,
    options: BranchOptions,
    *,
    upwards: bool | None = None,
    fix: str | Held | None = None,
) -> Branch[CurveOnSurface]:
    """The curve of a fold or a branch point of a branch while ``c0`` or the length varies.

    Args:
        branch: a branch of pearls, or of coils, buckles and what branches off from them.
        kind: ``bp``, or ``fold:NAME`` of a column.
        number: which of them (the first is 1).
        vary: ``c0`` or ``L``.
        options: where to stop and how to step. Turning points of ``c0`` and ``L`` (cusps of a fold) are watched too.
        upwards: whether ``vary`` is to grow at first; None: towards its value in ``options.until``, or growing.
        fix: what is held from there on while stability is judged, as ``family_branch`` takes it; by default what is already.

    Raises:
        InputError: there is no such special point, or it was not located, or ``vary`` is another name, or the branch is one
            of rings.
    """
    parameter, options, number = _varying(branch, vary), known_options(options), whole("number", number)
    if kind != "bp" and not str(kind).startswith("fold:"):
        raise InputError("kind", f"{kind!r} is no kind of point to follow", "give bp, or fold:NAME like fold:v")
    if kind not in SPECIAL:
        names = ", ".join(TURNS)
        raise InputError("kind", f"{kind!r} is no turning point of a column", f"choose one of {names} after fold:")
    found = branch.find(kind)
    if not 1 <= number <= len(found):
        raise InputError(
            "number",
            f"the branch has {counted(len(found), f'special point {kind}', f'special points {kind}')}, so there is none of "
            f"number {number}",
            "follow it further",
        )
    if not found[number - 1].converged:
        raise InputError("number", f"{kind} number {number} was not located", "follow the branch in shorter steps")
    branch = held_from(branch, found[number - 1].index, fix)
    start = branch.at(found[number - 1])
    if parameter in start.problem.free:
        other = "c0" if vary == "L" else "L"
        raise InputError(
            "vary", f"{vary} varies along the branch itself", f"follow its special points while {other} varies"
        )
    sign = math.copysign(1.0, start.problem.signed_amplitude(start.u))

    def excess(point: Solution[CurveOnSurface]) -> float:
        base: Any = point.problem.base
        return sign * float(base.signed_amplitude(point.u)) - STRAIGHT_WAVE

    def bounded(point: Solution[CurveOnSurface]) -> str | None:
        if excess(point) >= 0:
            return options.limit(point)
        return STRAIGHT if point.observables["amplitude"] < STRAIGHT_WAVE else HALVED

    grows, bounds = _growing(upwards, options, vary, start), replace(options, folds=(vary, "v"), limit=bounded)
    curve = follow(branch, found[number - 1], parameter, bounds, upwards=grows)
    return _up_to_straight(curve, excess) if excess(curve.points[-1]) < 0 else curve


STRAIGHT = "the shapes become the straight tube; beyond, the curve would repeat their mirror images"

HALVED = "the shapes come to have half the period; beyond, the curve would repeat their mirror images"

STRAIGHT_WAVE = 0.02
"""``signed_amplitude`` of shapes that are straight, or of half the period, up to its square.

Nearer, the conditions of what happens at onset, which are proportional to the amplitude or its square, fade.
"""


def _up_to_straight(
    curve: Branch[CurveOnSurface], excess: Callable[[Solution[CurveOnSurface]], float]
) -> Branch[CurveOnSurface]:
    """A curve that ends beyond the place where a function changes its sign, up to that place, found by secants.

    The conditions' rounding is felt here: Newton's method is content with ``NOISE``, as along the curve.
    """
    beyond = curve.points[-1]
    while len(curve.points) > 1 and excess(curve.points[-1]) <= 0:
        curve = curve.without_last()
    start = curve.points[-1]
    problem, tangent = start.problem, start.tangent
    known = [(problem.inner(tangent, problem.transfer(beyond.problem, beyond.u) - start.u), beyond), (0.0, start)]
    while len(known) < 10 and abs(excess(known[-1][1])) > 1e-10:
        (s0, one), (s1, two) = known[-2:]
        s = s1 - excess(two) * (s1 - s0) / (excess(two) - excess(one))
        guess = two.u + (s - s1) * tangent
        result, direction = correct(problem, guess, tangent, start.u, s, NewtonOptions(rounding=NOISE))
        if not result.converged:
            return curve
        found = Solution.along(problem, result.u, direction)
        known.append((s, found))
    end = known[-1][1]
    return curve.extended(replace(curve, points=[curve.points[-1], end], special=[SpecialPoint("end", 1)]))


def switched(
    branch: Branch[Any],
    number: int,
    options: BranchOptions,
    *,
    centre: Centre | None = None,
    grow: bool = True,
    fix: str | Held | None = None,
) -> Branch[Any]:
    """The branch that crosses ``branch`` at its branch point ``number`` (the first is 1).

    Args:
        branch: of any family.
        number: which of its branch points; on meshes those that shift or turn into each other come in twos, and lead to one
            branch.
        options: where to stop and how to step.
        centre: of pearls: whether the new shapes are centred on a pearl (the default) or on a neck, where both branch off.
        grow: follow the half of a pitchfork on which the tube grows at its centre, or the largest new mode grows.
        fix: what is held from there on while stability is judged, as ``family_branch`` takes it; by default what is already.

    Returns:
        Of rings, and of pearls where the new shapes are not axisymmetric, shapes in reduced modes.

    Raises:
        InputError: there is no such branch point, it was not located, or its new shapes cannot be followed.
    """
    if centre is not None and not known_branch(branch).points[-1].problem.centred:
        raise InputError("centre", "shapes that branch off here leave no choice of it", "leave it out")
    middle = choice("centre", "pearl" if centre is None else centre, get_args(Centre))
    special, options = numbered(branch, number), known_options(options)
    if special.change == 0 and not branch.points[-1].problem.rejoins:
        raise InputError(
            "number", f"at branch point {number} the branch meets a more symmetric one", "follow that from its start"
        )
    try:
        return switch(held_from(branch, special.index, fix), special, options, centre=middle, grow=grow)
    except LiftError as error:
        what, remedy = f"at branch point {number} {error}", _on_a_mesh(branch, special)
        raise InputError("number", what, remedy) from None


def _on_a_mesh(branch: Branch[Any], special: SpecialPoint) -> str:
    """How shapes that are not axisymmetric are followed: from the same pearls on a triangulated tube."""
    place, start = branch.at(special).observables, branch.points[0]
    if start.observables["amplitude"] > 1e-6:
        return (
            "a mesh may follow them, in Python: Branch.through(branch[k].meshed(1000)) goes on from these pearls, its switch "
            "leaves them"
        )
    pearls = round(place["L"] / start.problem.profile(start.u).period)
    return Sentence(
        "a mesh may follow them: pearlbvp branch pearl --c0 {c0:.12g} --length {L:.12g}{radius_option} "
        f"--mode {pearls},0 --nodes 1000 --save FILE.h5, then pearlbvp switch FILE.h5 and the number of the branch point near "
        "lambda2 = {lambda2:.4g}, v = {v:.6g}",
        **{name: place[name] for name in ("c0", "L", "lambda2", "v")},
    )


def numbered(branch: Branch[Any], number: int) -> SpecialPoint:
    """The branch point of a number (the first is 1).

    Raises:
        InputError: there is none, or it was not located.
    """
    found: list[SpecialPoint] = known_branch(branch).find("bp")
    number = whole("number", number)
    if not 1 <= number <= len(found):
        raise InputError(
            "number",
            f"the branch has {counted(len(found), 'branch point')}, so there is none of number {number}",
            "follow it further",
        )
    special = found[number - 1]
    if not special.converged:
        raise InputError(
            "number", f"branch point {number} was not located", "follow the branch in shorter steps (max_step)"
        )
    return special
