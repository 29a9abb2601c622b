"""Following a branch: its special points are located, and the stability of every point is known.

Folds are turning points of named observables. Branch points are found by the number of positive growth rates in each
symmetry block, never by a determinant: every rate that changes its sign in a step is located for itself, so several in
one step are all found.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from pearlbvp.continuation.branch import Branch, SpecialPoint, is_of_kind
from pearlbvp.continuation.events import Event, events_between, first_wanted, has_value
from pearlbvp.continuation.path import PathEnd, PathOptions, steps
from pearlbvp.continuation.problem import P, Problem
from pearlbvp.continuation.segment import Segment
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.errors import SpectrumError, interrupted


@dataclass(frozen=True)
class BranchOptions:
    """How a branch is followed.

    Attributes:
        path: steps and tolerances.
        until: stop exactly where an observable, ``mu_crit`` or ``wave`` has a value.
        until_special: stop at the special point of a number (the first is 1) of a kind, as ``Branch.find`` takes it, counted
            from the start, which is none.
        folds: observables whose turning points are located, besides those of ``until_special``.
        limit: a reason to end at a solution besides those of its problem, or None.
        progress: called with the branch so far after each step, to show or to save it.
    """

    path: PathOptions = field(default_factory=PathOptions)
    until: Mapping[str, float] = field(default_factory=dict)
    until_special: Mapping[str, int] = field(default_factory=dict)
    folds: Sequence[str] = ("lambda1", "lambda2", "v", "E")
    limit: Callable[[Solution[Any]], str | None] = lambda point: None
    progress: Callable[[Branch[Any]], None] = lambda branch: None

    @property
    def watched(self) -> Sequence[str]:
        """Observables whose turning points are located."""
        asked = (kind.partition(":")[2] for kind in self.until_special if kind.startswith("fold:"))
        return tuple(dict.fromkeys((*self.folds, *asked)))


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
        The branch. It is whole up to its end whatever happens: a failing step is a ``reason``, an interruption too. Where
        the start has a wanted value, it is the start alone.
    """
    points: list[Solution[P]] = []
    special: list[SpecialPoint] = [SpecialPoint("start", 0)]

    def end(reason: str, kind: str = "end", advice: str = "") -> Branch[P]:
        if kind == "end" and reason != INTERRUPTED:
            reason += "".join(f"; {name} {MOVED_AWAY}" for name in _left_behind(points, options.until)) or advice
        points.extend([] if points else [replace(start, known=Spectrum.unknown())])
        special.append(SpecialPoint(kind, len(points) - 1))
        return Branch(points, special, reason, kind == "stop")

    try:
        points.append(start.computed())
        if any(has_value(points[0], name, value, exact or {}) for name, value in options.until.items()):
            return end("the start has the wanted value", "stop")
        path, tried = steps(start, options.path), math.inf
        while True:
            before, at_start = points[-1], at_bifurcation and len(points) == 1
            point = next(path)
            walls = point.problem.walls
            wanted = first_wanted(
                before, point, {**options.until, **{name: value for name, (value, _) in walls.items()}}
            )
            if wanted is not None and not wanted.converged:
                return end("a wanted value lies just ahead, but could not be reached; take shorter steps")
            latest = (point if wanted is None else wanted.point).computed()
            events = events_between(before, latest, options.watched, at_start)
            length = _length(before, latest)
            shorter = min(length, tried) / 4  # a new mesh may add to the length what no shorter step takes away
            doubtful = any(_is_doubtful(event, point.problem, options.until_special) for event in events)
            if doubtful and shorter > 10 * options.path.min_step:
                path, tried = steps(replace(before, step=shorter), options.path), shorter
                continue
            if doubtful or length > 4 * tried:  # beyond the place of doubt
                tried = math.inf
            so_far = list(points)

            def tick(new: Solution[P], so_far: list[Solution[P]] = so_far, known: Any = special) -> None:
                so_far.append(new)
                options.progress(Branch(so_far, known, "unfinished", False))

            new, found = _placed(events, len(points), length, tick)
            points += [*new, latest]
            special += found
            asked = _asked(special, options.until_special)
            if asked is not None:
                del points[asked.index + 1 :]
                special = [s for s in special if s.index <= asked.index]
            options.progress(Branch(points, special, "unfinished", False))
            if asked is not None and asked.converged:
                return end("the wanted special point is reached", "stop")
            if asked is not None:
                return end(f"the wanted {asked.kind} lies just before, but could not be located; take shorter steps")
            if any(event.kind == "bp" and event.change == 0 for event in events):
                del points[-1]
                return end(
                    "it meets a more symmetric branch at a pitchfork; beyond, it would repeat its own mirror images"
                )
            if wanted is not None:
                wall = next((why for name, (at, why) in walls.items() if abs(latest.value(name) - at) < WALL), None)
                return end("the wanted value is reached", "stop") if wall is None else end(wall)
            reason = latest.problem.limit(latest.observables, latest.spectrum) or options.limit(latest)
            if reason is not None:
                return end(reason)
            if len(points) >= options.path.max_points:
                advice = "; resume the branch or ask for more"
                return end(f"max_points = {options.path.max_points} reached", advice=advice)
    except (PathEnd, SpectrumError) as failure:
        return end(str(failure))
    except np.linalg.LinAlgError as error:
        return end(f"a spectrum could not be computed ({error}); stop before, or take shorter steps")
    except KeyboardInterrupt:
        return end(INTERRUPTED)
    except SystemError as error:  # what an interruption inside compiled code turns into
        if not interrupted(error):
            raise
        return end(INTERRUPTED)


WALL = 1e-9
"""Distance of an observable from its wall that is none."""

INTERRUPTED = "interrupted"
"""Reason of a branch that somebody stopped."""

MOVED_AWAY = "moved away from its wanted value from the start on"


def _left_behind(points: Sequence[Solution[Any]], until: Mapping[str, float]) -> list[str]:
    """Observables that are nowhere as near to their wanted values as at the first of several points."""
    found = []
    for name, value in until.items():
        values = [point.value(name) for point in points]
        gaps = [abs(at - value) for at in values]
        if len(gaps) > 1 and min(gaps[1:]) > gaps[0]:
            found.append(name)
    return found


def _asked(special: Sequence[SpecialPoint], until: Mapping[str, int]) -> SpecialPoint | None:
    """The first special point at which the branch was asked to stop, if it is among those so far."""
    of_kinds = ([s for s in special if is_of_kind(s.kind, kind)][number - 1 : number] for kind, number in until.items())
    return min((s for found in of_kinds for s in found), key=lambda s: s.index, default=None)


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


def _placed(
    events: list[Event[P]], count: int, length: float, tick: Callable[[Solution[P]], None]
) -> tuple[list[Solution[P]], list[SpecialPoint]]:
    """Located events as points of a branch of ``count`` points, and as special points; one point for those at one place.

    What was not located is attached to the computed point that comes after.
    """
    points: list[Solution[P]] = []
    reached = -math.inf
    places = []
    for event in events:
        if event.converged and event.s - reached > SAME_PLACE:
            points.append(event.point.computed())
            tick(points[-1])  # there may be dozens in a step, and each takes a spectrum
            reached = event.s
        places.append(count + len(points) - 1 if event.converged else None)
    after = count + len(points)
    special = [
        SpecialPoint(
            event.kind, after if place is None else place, event.block, event.change, event.converged, (0.0, length)
        )
        for event, place in zip(events, places, strict=True)
    ]
    return points, special


SAME_PLACE = 1e-6
"""Special points nearer to each other than this in arclength are one (energy and volume turn together, say)."""
