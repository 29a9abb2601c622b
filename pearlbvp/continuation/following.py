"""Following a branch: its special points are located, and the stability of every point is known.

Folds are turning points of named observables. Branch points are found by the number of positive growth rates in each
symmetry block, never by a determinant: every rate that changes its sign in a step is located for itself, so several in
one step are all found.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Generic

import numpy as np

from pearlbvp.continuation.branch import Branch, SpecialPoint, Status, is_of_kind
from pearlbvp.continuation.events import (
    SAME_VALUE,
    Event,
    contact,
    events_between,
    first_wanted,
    has_value,
    pole_between,
)
from pearlbvp.continuation.path import PathEnd, PathOptions, steps
from pearlbvp.continuation.problem import P, Problem
from pearlbvp.continuation.segment import Segment
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.errors import InputError, Interruption, SpectrumError


@dataclass(frozen=True)
class BranchOptions:
    """How a branch is followed.

    Attributes:
        path: steps and tolerances.
        until: stop exactly where an observable, ``mu_crit`` or ``wave`` has a value.
        until_special: stop at the special point of a number (the first is 1) of a kind, as ``Branch.find`` takes it, counted
            from the start, which is none.
        folds: observables whose turning points are located, besides those of ``until_special``.
        limit: a reason to end at a solution besides those of its problem, or None; it raises ``SpectrumError`` where something
            is not known well enough.
        stability: compute growth rates; without them a branch shows where shapes lead, but neither branch points nor where
            stability ends it.
        progress: called with the branch so far after each point, special ones too, to show or to save it.
        locating: called while the special points of a step are located, with how many are and how many there are.
    """

    path: PathOptions = field(default_factory=PathOptions)
    until: Mapping[str, float] = field(default_factory=dict)
    until_special: Mapping[str, int] = field(default_factory=dict)
    folds: Sequence[str] = ("lambda1", "lambda2", "v", "E")
    limit: Callable[[Solution[Any]], str | None] = lambda point: None
    stability: bool = True
    progress: Callable[[Branch[Any]], None] = lambda branch: None
    locating: Callable[[int, int], None] = lambda done, of: None

    @property
    def watched(self) -> Sequence[str]:
        """Observables whose turning points are located."""
        asked = (kind.partition(":")[2] for kind in self.until_special if kind.startswith("fold:"))
        return tuple(dict.fromkeys((*self.folds, *asked)))

    def beyond(self, branch: Branch[Any]) -> BranchOptions:
        """The same for what follows a branch, whose own special points count, and of which ``progress`` sees the whole."""
        left = {kind: number - len(branch.find(kind)) for kind, number in self.until_special.items()}
        return replace(self, until_special=left, progress=lambda so_far: self.progress(branch.extended(so_far)))


def continue_branch(
    start: Solution[P],
    options: BranchOptions,
    *,
    at_bifurcation: bool = False,
    exact: Mapping[str, float] | None = None,
) -> Branch[P]:
    """Follow a branch from a solution along its tangent, with stability and special points.

    Args:
        start: the first point.
        options: steps, stopping conditions, what to watch.
        at_bifurcation: the start is a bifurcation point, and the tangent that of the branch wanted: its own neutral
            growth rates and turning points are no events.
        exact: values of the start that are known, where its own have the error of a discretization.

    Returns:
        The branch. It is whole up to its end, and a failing step is a ``reason``; an interruption is none, for whoever builds
        on a branch must not take a part of it for the whole (``kept``). Where the start has a wanted value, it is the start
        alone.

    Raises:
        InputError: another value is wanted of something that stays as it is on the branch, or that its solutions do not have,
            or a turning point of that.
    """
    _refuse_unknown(start, options)
    _refuse_constant(start, options)
    run = _Run(start, options, at_bifurcation)
    try:
        return run.to_its_end(exact or {})
    except _PassesThroughItselfError:
        return run.end(Status.CONTACT, CONTACT)
    except (PathEnd, SpectrumError) as error:
        return run.end(Status.FAILED, error.args[0])  # which may be a sentence with units
    except np.linalg.LinAlgError as error:
        reason = f"a spectrum could not be computed ({error}); stop before, or take shorter steps"
        return run.end(Status.FAILED, reason)


def kept(follow: Callable[[BranchOptions], Branch[P]], options: BranchOptions) -> Branch[P]:
    """A branch for its user, up to where that interrupts it.

    Raises:
        KeyboardInterrupt: before its first point.
    """
    latest: list[Branch[P]] = []

    def progress(so_far: Branch[P]) -> None:
        latest[:] = [so_far]
        options.progress(so_far)

    with Interruption():
        return follow(replace(options, progress=progress))
    if not latest:
        raise KeyboardInterrupt
    end = SpecialPoint("end", len(latest[0].points) - 1)
    return replace(latest[0], special=[*latest[0].special, end], status=Status.INTERRUPTED, reason="interrupted")


class _Run(Generic[P]):
    """A branch while it is followed."""

    def __init__(self, start: Solution[P], options: BranchOptions, at_bifurcation: bool) -> None:
        self.start, self.options, self.at_bifurcation = start, options, at_bifurcation
        self.points: list[Solution[P]] = []
        self.special: list[SpecialPoint] = [SpecialPoint("start", 0)]
        watched = [name for name in options.watched if name not in start.problem.constant]
        self.watched = list(dict.fromkeys((*watched, start.problem.conserved) if start.problem.conserved else watched))

    def _whole(self, point: Solution[P]) -> Solution[P]:
        """A point with all computed that the branch shows."""
        return (point if self.options.stability else replace(point, known=Spectrum.not_asked())).computed()

    def _at(self, event: Event[P]) -> Solution[P]:
        """The point of an event with all computed that the branch shows; at a pole growth rates may be beyond computing."""
        try:
            return self._whole(event.point)
        except (SpectrumError, np.linalg.LinAlgError):
            if event.kind not in event.point.problem.poles(event.point.u):
                raise
            return replace(event.point, known=Spectrum.unknown())

    def so_far(self) -> Branch[P]:
        """What there is of it."""
        return Branch(list(self.points), list(self.special), Status.RUNNING, "unfinished")

    def end(self, status: Status, reason: str, advice: str = "") -> Branch[P]:
        """The whole branch; ``advice`` is of use where nothing moved away from what was wanted."""
        points = self.points or [replace(self.start, known=Spectrum.unknown())]
        astray: tuple[str, ...] = ()
        if status is not Status.REACHED:
            astray = tuple(_left_behind(points, self.options.until))
            reason += (
                "".join(f"; {name} moved away from its wanted value from the start on" for name in astray) or advice
            )
        kind = "stop" if status is Status.REACHED else "end"
        return Branch(points, [*self.special, SpecialPoint(kind, len(points) - 1)], status, reason, astray)

    def to_its_end(self, exact: Mapping[str, float]) -> Branch[P]:
        """Step by step; see ``continue_branch``.

        Raises:
            PathEnd, SpectrumError, _PassesThroughItselfError, numpy.linalg.LinAlgError: it cannot go on.
        """
        options, problem = self.options, self.start.problem
        self.points.append(self._whole(self.start))
        options.progress(self.so_far())
        if any(has_value(self.points[0], name, value, exact) for name, value in options.until.items()):
            return self.end(Status.REACHED, "the start has the wanted value")
        path, tried = steps(self.start, options.path), math.inf
        while True:
            before, at_start = self.points[-1], self.at_bifurcation and len(self.points) == 1
            point = next(path)
            walls = {name: value for name, (value, _) in problem.walls.items()}
            wanted = first_wanted(before, point, {**options.until, **walls})
            if wanted is not None and not wanted.converged:
                reason = "a wanted value lies just ahead, but could not be reached; take shorter steps"
                return self.end(Status.FAILED, reason)
            latest = point if wanted is None else wanted.point
            touching = contact(before, latest)
            latest = latest if touching is None else touching.point
            length = _length(before, latest)
            shorter = min(length, tried) / 4  # a new mesh may add to the length what no shorter step takes away
            try:
                if touching is not None and not touching.converged:
                    raise _PassesThroughItselfError
                pole = pole_between(before, latest)
                latest = latest if pole else self._whole(latest)
                events = [pole] if pole else events_between(before, latest, self.watched, at_start, options.locating)
            except (SpectrumError, _PassesThroughItselfError):  # the branch is to be known up to where that begins
                if shorter < FINEST * options.path.step:
                    raise
                path, tried = steps(replace(before, step=shorter), options.path), shorter
                continue
            doubtful = any(_is_doubtful(event, problem, options.until_special) for event in events)
            if doubtful and shorter > 10 * options.path.min_step:
                path, tried = steps(replace(before, step=shorter), options.path), shorter
                continue
            if doubtful or length > 4 * tried:  # beyond the place of doubt
                tried = math.inf
            reached = Status.CONTACT if touching else Status.REACHED if wanted else None
            end = self._take(events, length)
            end = end or self._arrive(events, self._whole(latest), length, reached)
            if end is not None:
                return end

    def _take(self, events: list[Event[P]], length: float) -> Branch[P] | None:
        """The special points of a step, one point for those at one place; the whole branch, if it ends at one of them."""
        most = self.options.path.max_points
        for together in _places(events):
            self.points.append(self._at(together[0]))
            self._name(together, length)
            self.options.progress(self.so_far())
            if self.so_far().asked(self.options.until_special) is not None:
                return self.end(Status.REACHED, "the wanted special point is reached")
            if any(event.kind == "bp" and event.change == 0 for event in together):
                reason = (
                    "it meets a more symmetric branch at a pitchfork; beyond, it would repeat its own mirror images"
                )
                return self.end(Status.PITCHFORK, reason)
            if len(self.points) >= most:
                return self.end(Status.POINTS, f"max_points = {most} reached", MORE)
        return None

    def _name(self, events: list[Event[P]], length: float) -> None:
        """Events as special points at the latest point; what was not located is attached to the computed point beyond."""
        index = len(self.points) - 1
        self.special += [SpecialPoint(e.kind, index, e.block, e.change, e.converged, (0.0, length)) for e in events]

    def _arrive(
        self, events: list[Event[P]], latest: Solution[P], length: float, reached: Status | None
    ) -> Branch[P] | None:
        """The computed point of a step; the whole branch, if it ends there."""
        options, most = self.options, self.options.path.max_points
        self.points.append(latest)
        self._name([event for event in events if not event.converged], length)
        options.progress(self.so_far())
        asked = self.so_far().asked(options.until_special)
        if asked is not None:
            reason = f"the wanted {asked.kind} lies just before, but could not be located; take shorter steps"
            return self.end(Status.FAILED, reason)
        if reached is Status.CONTACT:
            return self.end(reached, CONTACT)
        if reached:
            walls = latest.problem.walls.items()
            wall = next((why for name, (at, why) in walls if abs(latest.value(name) - at) < WALL), None)
            if wall is not None:
                return self.end(Status.LIMIT, wall)
            return self.end(Status.REACHED, "the wanted value is reached")
        limit = latest.problem.limit(latest.observables, latest.spectrum) or options.limit(latest)
        if limit is not None:
            return self.end(Status.LIMIT, limit)
        return self.end(Status.POINTS, f"max_points = {most} reached", MORE) if len(self.points) >= most else None


MORE = "; ask for more (max_points), or go on from its end"
"""Advice where a branch has as many points as it may have."""

FINEST = 0.25
"""Share of the first step up to which steps are shortened where the next point is none, or its stability cannot be known."""

CONTACT = "the surface touches itself; beyond, it would pass through itself"


class _PassesThroughItselfError(ArithmeticError):
    """The next point is no shape of a membrane, and where that begins is not known."""


WALL = 1e-9
"""Distance of an observable from its wall that is none."""

SAME_PLACE = 1e-6
"""Special points nearer to each other than this in arclength are one (energy and volume turn together, say)."""


def _places(events: list[Event[P]]) -> list[list[Event[P]]]:
    """Located events in order, those at one place together."""
    places: list[list[Event[P]]] = []
    for event in events:
        if not event.converged:
            continue
        if places and event.s - places[-1][0].s <= SAME_PLACE:
            places[-1].append(event)
        else:
            places.append([event])
    return places


def _refuse_unknown(start: Solution[Any], options: BranchOptions) -> None:
    """Refuse to look for what solutions of other kinds have.

    Raises:
        InputError: the first such name.
    """
    for name in (*options.until, *options.watched):
        if name in start.observables or name == "mu_crit" or (name in options.until and name in start.further):
            continue
        raise InputError("until", f"a {start.problem.family} has no {name}", "stop at something else")


def _refuse_constant(start: Solution[Any], options: BranchOptions) -> None:
    """Refuse to look for what is nowhere on a branch.

    Raises:
        InputError: what stays as it is there is to have another value, or to turn.
    """
    for name, instead in start.problem.constant.items():
        own = start.observables[name]
        wanted = options.until.get(name, own)
        if abs(wanted - own) > SAME_VALUE * (1 + abs(wanted)) or f"fold:{name}" in options.until_special:
            raise InputError("until", f"{name} stays as it is on this branch", instead)


def _left_behind(points: Sequence[Solution[Any]], until: Mapping[str, float]) -> list[str]:
    """Observables that are nowhere as near to their wanted values as at the first of several points."""
    found = []
    for name, value in until.items():
        gaps = [abs(point.value(name) - value) for point in points]
        if len(gaps) > 1 and min(gaps[1:]) > gaps[0]:
            found.append(name)
    return found


def _is_doubtful(event: Event[Any], problem: Problem, until: Mapping[str, int]) -> bool:
    """Whether a shorter step is to show what an event is that was not located.

    It may be of a kind that is asked for, or speak of a jump: stability to the solution's own kind changed, with no point
    where it does.
    """
    asked = any(is_of_kind(event.kind, kind) for kind in until)
    return not event.converged and (asked or event.block == problem.trivial_block)


def _length(first: Solution[Any], last: Solution[Any]) -> float:
    """Arclength between two points, along the first one's tangent."""
    return abs(Segment(first, last).length)
