"""Branches: a path with its special points located and its stability known at every point.

Folds are turning points of named observables. Branch points are found by the number of positive growth rates in each
symmetry block, never by a determinant: every rate that changes its sign in a step is located for itself, so several in
one step are all found.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Generic, Protocol

import numpy as np

from pearlbvp.continuation.description import described, described_point
from pearlbvp.continuation.events import Event, events_between, first_wanted, has_value, value_of
from pearlbvp.continuation.path import P, Path, PathEnd, PathOptions, Point, steps
from pearlbvp.continuation.problem import Array, Problem
from pearlbvp.continuation.segment import Segment
from pearlbvp.errors import SpectrumError, interrupted

if TYPE_CHECKING:
    import pandas as pd


class Spectrum(Protocol):
    """What a branch asks of the growth rates of a solution."""

    @property
    def rates(self) -> Mapping[Any, Array]:
        """Largest growth rates of each symmetry block, exact kernels left out, largest first."""

    @property
    def n_unstable(self) -> int:
        """Dimension of the unstable space."""

    @property
    def complete(self) -> bool:
        """Whether all unstable perturbations were counted."""

    @property
    def mu_crit(self) -> float:
        """The largest growth rate."""

    @property
    def residual(self) -> float:
        """Error of the growth rates, as the exact kernels show it."""


class StableProblem(Problem, Protocol):
    """A problem that knows the stability of its solutions."""

    @property
    def own_block(self) -> Hashable:
        """The block of perturbations that keep the symmetry of the problem's solutions."""

    @property
    def conserved(self) -> str:
        """The one observable that perturbations keep and the branch does not; empty where there are none or several.

        Where it turns, a growth rate of ``own_block`` changes its sign, and nowhere else on a smooth branch.
        """

    def wave(self, u: Array) -> float:
        """``2 A`` of the largest wave over the straight tube (``projection``)."""

    def poles(self, u: Array) -> Mapping[str, float]:
        """Named functions at whose zeros growth rates pass through infinity; those that are regular there."""

    def spectrum(self, u: Array) -> Spectrum:
        """Growth rates in all symmetry blocks."""

    def block_rates(self, u: Array, block: Any, like: Any) -> Array:
        """Growth rates in one block, largest first, resolved as in another spectrum."""


@dataclass(frozen=True)
class SpecialPoint(Generic[P]):
    """A point of a branch at which something happens.

    Attributes:
        kind: ``start``, ``bp``, ``fold:NAME``, ``stop``, ``end``, or the name of one of the problem's poles.
        index: place among the branch's points.
        block: symmetry block of the neutral perturbation, for ``bp``.
        change: by how much the number of unstable perturbations of that block changes there.
        converged: whether it was located; if not, it is the computed point that comes after.
        interval: arclength from the computed point before in which it was looked for, and found.
    """

    kind: str
    index: int
    block: Any = None
    change: int = 0
    converged: bool = True
    interval: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class UnknownSpectrum:
    """In the place of growth rates that could not be computed: a start is shown, and saved, all the same."""

    rates: Mapping[Any, Array] = field(default_factory=dict)
    n_unstable: int = 0
    complete: bool = False
    mu_crit: float = math.nan
    residual: float = math.nan
    critical: str = ""

    def to_tree(self) -> dict[str, Any]:
        """Nothing, to be saved."""
        return {}


@dataclass(frozen=True)
class BranchPoint(Generic[P]):
    """A point with its spectrum."""

    point: Point[P]
    spectrum: Any

    def __repr__(self) -> str:
        return f"BranchPoint({described_point(self)})"

    @property
    def observables(self) -> dict[str, float]:
        """Named numbers of the solution."""
        return self.point.observables


@dataclass(frozen=True)
class Branch(Generic[P]):
    """A branch of solutions with its special points.

    Attributes:
        points: in order along the branch, special points among them.
        special: what happens at some of them.
        reason: why the branch ends.
        complete: whether it ends where it was asked to.
    """

    points: list[BranchPoint[P]]
    special: list[SpecialPoint[P]]
    reason: str
    complete: bool

    def __repr__(self) -> str:
        return described(self)

    def kinds(self, index: int) -> list[str]:
        """All that is special at a point."""
        return [special.kind for special in self.special if special.index == index]

    def find(self, kind: str) -> list[SpecialPoint[P]]:
        """The special points of a kind, in order; ``fold`` finds all folds."""
        return [special for special in self.special if _is_of_kind(special.kind, kind)]

    def at(self, special: SpecialPoint[P]) -> BranchPoint[P]:
        """The point of a special point."""
        return self.points[special.index]

    def table(self) -> pd.DataFrame:
        """A row a point: ``point, special``, the observables, ``n_unstable, mu_crit, critical, mu_error, wave``.

        ``n_unstable`` is empty where more waves grow than were counted; ``mu_error`` is the error of growth rates, as the
        exact kernels show it; ``wave`` is ``2 A`` of the largest wave (``projection``), empty where the axis is not inside.
        """
        import pandas as pd

        rows = []
        for index, entry in enumerate(self.points):
            stability = {
                "n_unstable": entry.spectrum.n_unstable if entry.spectrum.complete else None,
                "mu_crit": entry.spectrum.mu_crit,
                "critical": str(entry.spectrum.critical),
                "mu_error": entry.spectrum.residual,
                "wave": value_of(entry.point, "wave"),
            }
            rows.append({"point": index, "special": ",".join(self.kinds(index))} | entry.observables | stability)
        return pd.DataFrame(rows).astype({"n_unstable": "Int64"})

    @property
    def ends_at_bifurcation(self) -> bool:
        """Whether what follows the last point leaves a place where branches cross or turn, which is no event ahead of it.

        A branch of one point is its start, of which nothing tells where it lies.
        """
        kinds = self.kinds(len(self.points) - 1)
        return len(self.points) == 1 or any(kind == "bp" or kind.startswith("fold") for kind in kinds)

    def reversed(self) -> Branch[P]:
        """The branch from its last point to its first, tangents turned round. Where it ended, it starts: an ``end``."""
        last = len(self.points) - 1
        points = [
            BranchPoint(replace(entry.point, tangent=-entry.point.tangent), entry.spectrum)
            for entry in self.points[::-1]
        ]
        special = [replace(s, index=last - s.index, change=-s.change) for s in self.special[::-1]]
        return Branch(points, special, self.reason, self.complete)

    def without_last(self) -> Branch[P]:
        """The branch without its last point, and what is special there but the end."""
        last = len(self.points) - 2
        kept = [s for s in self.special if s.index <= last] + [SpecialPoint[P]("end", last)]
        return Branch(self.points[:-1], kept, self.reason, self.complete)

    def extended(self, further: Branch[P]) -> Branch[P]:
        """This branch and one that starts at its last point, as one."""
        offset = len(self.points) - 1
        kept = [s for s in self.special if s.kind not in ("end", "stop") or s.index < offset]
        added = [replace(s, index=s.index + offset) for s in further.special if s.kind != "start"]
        return Branch(self.points + further.points[1:], kept + added, further.reason, further.complete)


@dataclass(frozen=True)
class BranchOptions:
    """How a branch is followed.

    Attributes:
        path: steps and tolerances.
        until: stop exactly where an observable, ``mu_crit`` or ``wave`` has a value.
        until_special: stop at the special point of a number (the first is 1) of a kind, as ``Branch.find`` takes it, counted
            from the start, which is none.
        folds: observables whose turning points are located, besides those of ``until_special``.
        limit: a reason to end at a point with its spectrum, or None.
        progress: called with the branch so far after each point, special ones too, to show or to save it.
        locating: called while the special points of a step are located, with how many are and how many there are.
    """

    path: PathOptions = field(default_factory=PathOptions)
    until: Mapping[str, float] = field(default_factory=dict)
    until_special: Mapping[str, int] = field(default_factory=dict)
    folds: Sequence[str] = ("lambda1", "lambda2", "v", "E")
    limit: Callable[[BranchPoint[Any]], str | None] = lambda point: None
    progress: Callable[[Branch[Any]], None] = lambda branch: None
    locating: Callable[[int, int], None] = lambda done, of: None

    @property
    def watched(self) -> Sequence[str]:
        """Observables whose turning points are located."""
        asked = (kind.partition(":")[2] for kind in self.until_special if kind.startswith("fold:"))
        return tuple(dict.fromkeys((*self.folds, *asked)))


def continue_branch(
    start: Point[P],
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
    points: list[BranchPoint[P]] = []
    special: list[SpecialPoint[P]] = [SpecialPoint("start", 0)]
    most = f"max_points = {options.path.max_points} reached"

    def end(reason: str, kind: str = "end", advice: str = "") -> Branch[P]:
        if kind == "end" and reason != INTERRUPTED:
            reason += "".join(f"; {name} {MOVED_AWAY}" for name in _left_behind(points, options.until)) or advice
        points.extend([] if points else [BranchPoint(start, UnknownSpectrum())])
        special.append(SpecialPoint(kind, len(points) - 1))
        return Branch(points, special, reason, kind == "stop")

    try:
        points.append(_with_spectrum(start))
        if any(has_value(points[0], name, value, exact or {}) for name, value in options.until.items()):
            return end("the start has the wanted value", "stop")
        path, tried = steps(start, options.path), math.inf
        while True:
            before, at_start = points[-1], at_bifurcation and len(points) == 1
            point = next(path)
            wanted = first_wanted(before, point, options.until)
            if wanted is not None and not wanted.converged:
                return end("a wanted value lies just ahead, but could not be reached; take shorter steps")
            latest = _with_spectrum(point if wanted is None else wanted.point)
            events = events_between(before, latest, options.watched, at_start, options.locating)
            length = _length(before.point, latest.point)
            shorter = min(length, tried) / 4  # a new mesh may add to the length what no shorter step takes away
            doubtful = any(_is_doubtful(event, point.problem, options.until_special) for event in events)
            if doubtful and shorter > 10 * options.path.min_step:
                path, tried = steps(replace(before.point, step=shorter), options.path), shorter
                continue
            if doubtful or length > 4 * tried:  # beyond the place of doubt
                tried = math.inf
            for place in _places(events):
                points.append(_with_spectrum(place[0].point))
                special += [_special(event, len(points) - 1, length) for event in place]
                options.progress(Branch(points, special, "unfinished", False))
                if _asked(special, options.until_special) is not None:
                    return end("the wanted special point is reached", "stop")
                if any(event.kind == "bp" and event.change == 0 for event in place):
                    return end(
                        "it meets a more symmetric branch at a pitchfork; beyond, it would repeat its own mirror images"
                    )
                if len(points) >= options.path.max_points:
                    return end(most, advice=MORE)
            points.append(latest)
            special += [_special(event, len(points) - 1, length) for event in events if not event.converged]
            options.progress(Branch(points, special, "unfinished", False))
            asked = _asked(special, options.until_special)
            if asked is not None:
                return end(f"the wanted {asked.kind} lies just before, but could not be located; take shorter steps")
            if wanted is not None:
                return end("the wanted value is reached", "stop")
            reason = options.limit(latest)
            if reason is not None:
                return end(reason)
            if len(points) >= options.path.max_points:
                return end(most, advice=MORE)
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


INTERRUPTED = "interrupted"
"""Reason of a branch that somebody stopped."""

MOVED_AWAY = "moved away from its wanted value from the start on"

MORE = "; resume the branch or ask for more"
"""Advice where a branch has as many points as it may have."""


def _left_behind(points: Sequence[BranchPoint[Any]], until: Mapping[str, float]) -> list[str]:
    """Observables that are nowhere as near to their wanted values as at the first of several points."""
    found = []
    for name, value in until.items():
        values = [value_of(e.point, name, e.spectrum) for e in points]
        gaps = [abs(at - value) for at in values]
        if len(gaps) > 1 and min(gaps[1:]) > gaps[0]:
            found.append(name)
    return found


def _is_of_kind(kind: str, wanted: str) -> bool:
    """Whether a special point's kind is the wanted one; ``fold`` are all folds."""
    return kind == wanted or kind.split(":")[0] == wanted


def _asked(special: Sequence[SpecialPoint[P]], until: Mapping[str, int]) -> SpecialPoint[P] | None:
    """The first special point at which the branch was asked to stop, if it is among those so far."""
    of_kinds = (
        [s for s in special if _is_of_kind(s.kind, kind)][number - 1 : number] for kind, number in until.items()
    )
    return min((s for found in of_kinds for s in found), key=lambda s: s.index, default=None)


def _is_doubtful(event: Event[Any], problem: Any, until: Mapping[str, int]) -> bool:
    """Whether a shorter step is to show what an event is that was not located.

    It may be of a kind that is asked for, or speak of a jump: stability to the solution's own kind changed, with no point
    where it does.
    """
    asked = any(_is_of_kind(event.kind, kind) for kind in until)
    return not event.converged and (asked or event.block == problem.own_block)


def _length(first: Point[Any], last: Point[Any]) -> float:
    """Arclength between two points, along the first one's tangent."""
    return abs(Segment(first, last).length)


def _places(events: Sequence[Event[P]]) -> list[list[Event[P]]]:
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


def _special(event: Event[P], index: int, length: float) -> SpecialPoint[P]:
    """An event at a point of a branch; one that was not located is attached to the computed point that comes after."""
    return SpecialPoint(event.kind, index, event.block, event.change, event.converged, (0.0, length))


def _with_spectrum(point: Point[P]) -> BranchPoint[P]:
    problem: Any = point.problem
    return BranchPoint(point, problem.spectrum(point.u))


SAME_PLACE = 1e-6
"""Special points nearer to each other than this in arclength are one (energy and volume turn together, say)."""


def start_point(problem: P, u: Array, tangent: Array) -> Point[P]:
    """A point to start from, its tangent made a unit vector."""
    return Point(problem, u, tangent / math.sqrt(problem.inner(tangent, tangent)), problem.observables(u))


__all__ = [
    "Branch",
    "BranchOptions",
    "BranchPoint",
    "Path",
    "SpecialPoint",
    "Spectrum",
    "StableProblem",
    "continue_branch",
    "start_point",
]
