"""Events between two consecutive points of a branch: wanted values, turning points of observables, and branch points.

Branch points are sign changes of growth rates, block by block, each located for itself; folds are sign changes of slopes.
In the problem's own block a rate changes its sign where the conserved quantity turns: the two are one event.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Generic

import numpy as np

from pearlbvp.continuation.path import PathEnd
from pearlbvp.continuation.problem import P
from pearlbvp.continuation.segment import Segment
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.errors import SpectrumError
from pearlbvp.representation import brief


@dataclass(frozen=True)
class Event(Generic[P]):
    """Something found between two points: where, and what to write of it."""

    __repr__ = brief

    s: float
    kind: str
    point: Solution[P]
    block: Any = None
    change: int = 0
    converged: bool = True


EIGENVALUE = 2e-13
"""Accuracy of the arclength at zeros of growth rates, which have the rounding of their derivatives."""

JUMP = 0.01
"""Size of a growth rate at its zero, by the larger one at the ends, beyond which it is no zero: the path has jumped."""

DIFFERENCE = 1e-9
"""Size of slopes, as differences know them, by that at the ends of a step."""


def _located(
    segment: Segment[P],
    kind: str,
    function: Callable[[Solution[P]], float],
    ends: tuple[float, float],
    tolerance: float = EIGENVALUE,
    noise: float = 0.0,
    smooth: bool = False,
    **what: Any,
) -> Event[P]:
    """An event at a function's sign change; at the segment's end, unconverged, where that cannot be located."""
    try:
        point = (segment.where(function, ends) if smooth else None) or segment.root(function, ends[0], tolerance, noise)
    except PathEnd:
        return Event(segment.length, kind, segment.last, converged=False, **what)
    s = point.problem.inner(segment.first.tangent, point.u - segment.first.u)
    return Event(s, kind, point, **what)


def _crossing_rates(before: Spectrum, after: Spectrum, neutral: float) -> list[tuple[Any, int, float, float]]:
    """Blocks and positions of the growth rates that change sign between two points, with their values there.

    Rates that are smaller than ``neutral`` at the first point belong to the bifurcation that the branch starts at.

    Raises:
        SpectrumError: more do than are known at either point.
    """
    found = []
    for block in before.rates.keys() & after.rates.keys():
        rates, later = before.rates[block], after.rates[block]
        low, high = sorted((int((rates > 0).sum()), int((later > 0).sum())))
        if high > min(len(rates), len(later)):
            raise SpectrumError(
                f"{high - low} growth rates of {block} change their sign in one step; take a smaller max_step"
            )
        found += [(block, k, float(rates[k]), float(later[k])) for k in range(low, high) if abs(rates[k]) > neutral]
    return sorted(found, key=lambda crossing: (str(crossing[0]), crossing[1]))


def _is_symmetric(turn: Event[Any], last: Solution[Any]) -> bool:
    """Whether a growth rate of the solution's own block touches zero at a turning point."""
    problem = turn.point.problem
    if problem.trivial_block not in last.spectrum.rates:
        return False
    rates = problem.block_rates(turn.point.u, problem.trivial_block, last.spectrum)
    return bool(np.abs(rates).min() < 1e-6)


def _own_count(point: Solution[Any], like: Solution[Any]) -> int:
    """How many growth rates of the solution's own block are positive, resolved as at another point."""
    problem = point.problem
    if problem.trivial_block not in like.spectrum.rates:
        return 0
    return int((problem.block_rates(point.u, problem.trivial_block, like.spectrum) > 0).sum())


def has_value(entry: Solution[P], name: str, value: float, exact: Mapping[str, float]) -> bool:
    """Whether a solution has a value to within its accuracy: growth rates have their own, all others that of tables.

    Args:
        entry: the solution.
        name, value: of the number.
        exact: values of the solution that are known, where its own have the error of a discretization.
    """
    accuracy = SAME_VALUE * (1 + abs(value))
    if name == "mu_crit":
        accuracy = max(accuracy, entry.spectrum.residual)
    found = (entry.value(name), exact.get(name, math.inf))
    return min(abs(number - value) for number in found) <= accuracy


SAME_VALUE = 1e-10
"""Difference, by one plus its size, at which two values are one: tables have twelve digits, Newton's method eleven or more."""


def first_wanted(first: Solution[P], last: Solution[P], until: Mapping[str, float]) -> Event[P] | None:
    """The first place between two points where a number has its wanted value."""
    segment = Segment(first, last)
    stops = []
    for name, value in until.items():

        def difference(point: Solution[P], name: str = name, value: float = value) -> float:
            return point.value(name) - value

        ends = difference(first), difference(last)
        if ends[0] != 0 and ends[0] * ends[1] <= 0:
            # The largest growth rate has kinks, and each value of it costs a spectrum.
            found = _located(segment, "stop", difference, ends, tolerance=1e-13, smooth=name != "mu_crit")
            if not found.converged or abs(difference(found.point)) < 1e-3 * (1 + abs(value)):  # else it was a pole
                stops.append(found)
    return min(stops, key=lambda event: event.s, default=None)


def contact(first: Solution[P], last: Solution[P]) -> Event[P] | None:
    """Where between two points a surface begins to pass through itself; not located where that is known of the last alone."""
    ends = first.clearance, last.clearance
    if not ends[1] < 0:
        return None
    none = Event(math.inf, "contact", last, converged=False)
    if ends[0] < 0 or not all(map(math.isfinite, ends)):
        return none
    found = _located(Segment(first, last), "contact", lambda point: point.clearance, ends, tolerance=1e-13, smooth=True)
    return found if found.converged and abs(found.point.clearance) < TOUCHING else none


TOUCHING = 1e-9
"""Clearance that is none."""


def _turning(
    behind: Mapping[str, float], ahead: Mapping[str, float], names: Sequence[str]
) -> dict[str, tuple[float, float]]:
    """Slopes that change sign, at both ends."""
    return {name: (behind[name], ahead[name]) for name in names if behind[name] * ahead[name] < 0}


def _fold(segment: Segment[P], name: str, ends: tuple[float, float]) -> Event[P]:
    """The turning point of an observable."""
    noise = DIFFERENCE * max(map(abs, ends))
    return _located(segment, f"fold:{name}", lambda p: p.slopes[name], ends, noise=noise)


def events_between(
    first: Solution[P],
    last: Solution[P],
    folds: Sequence[str],
    at_start: bool,
    locating: Callable[[int, int], None] = lambda done, of: None,
) -> list[Event[P]]:
    """Folds and branch points between two consecutive points, in their order.

    Args:
        first, last: the points.
        folds: observables whose turning points are located.
        at_start: the first point is a bifurcation point, and the branch that which starts there.
        locating: called with the number of growth rates whose zeros were located, and of all that have one.
    """
    segment = Segment(first, last)
    events: list[Event[P]] = []
    problem = first.problem
    for name, before in problem.poles(first.u).items():
        after = problem.poles(problem.transfer(last.problem, last.u))[name]
        if before * after < 0:
            # Growth rates change sign by way of infinity here: their signs tell of no branch points in this step.
            return [_located(segment, name, lambda p, n=name: p.problem.poles(p.u)[n], (before, after))]  # type: ignore[misc]
    # At a pitchfork every observable turns: its slope is that of the branch a little further on.
    behind = segment.point(0.1 * segment.length) if at_start else first
    crossings = _crossing_rates(first.spectrum, last.spectrum, 1e-6 if at_start else 0.0)
    if any(block == problem.trivial_block for block, *_ in crossings):
        segment.refine(segment.length / 2)
    turns = _turning(behind.slopes, last.slopes, folds)
    turn = None
    name = problem.conserved or next(
        iter(turns), ""
    )  # where several things that perturbations keep vary, any that turns
    if name in turns:
        turn = _fold(segment, name, turns.pop(name))
        own = any(block == problem.trivial_block for block, *_ in crossings)
        own = own or (at_start and _own_count(behind, last) != _own_count(last, last))
        if turn.converged and not own and _is_symmetric(turn, last):
            # What turns, turns without a change of stability: the branch passes through a more symmetric solution, and all
            # observables turn with it. It is a pitchfork, met from its side.
            return [Event(turn.s, "bp", turn.point, block=problem.trivial_block)]
        events.append(turn)
    for name, ends in turns.items():
        known = (event.point for event in events if event.converged)
        together = next((p for p in known if abs(p.slopes[name]) < 1e-7 * max(map(abs, ends))), None)
        if together is None:
            events.append(_fold(segment, name, ends))
        else:  # energy and volume, say
            events += [replace(event, kind=f"fold:{name}") for event in events[:] if event.point is together][:1]
    for done, (block, k, before, after) in enumerate(crossings):
        locating(done, len(crossings))
        if block == problem.trivial_block and not problem.conserved:
            continue  # stability changes where the branch neither turns nor meets another

        def rate(point: Solution[P], block: Any = block, k: int = k) -> float:
            return float(point.problem.block_rates(point.u, block, last.spectrum)[k])

        change = block.multiplicity if after > before else -block.multiplicity
        event = _located(segment, "bp", rate, (before, after), block=block, change=change)
        if event.converged and abs(rate(event.point)) > JUMP * max(abs(before), abs(after)):
            event = replace(event, s=segment.length, point=last, converged=False)
        # In the problem's own block a rate changes sign where the conserved quantity turns: that is the fold.
        if block == problem.trivial_block and turn is not None and abs(turn.s - event.s) < 1e-4:
            continue
        events.append(event)
    return sorted(events, key=lambda event: event.s)
