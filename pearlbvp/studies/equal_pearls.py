"""All equal pearls of a period that are known how to reach, and the stretches of them on which one period is stable.

The branch from the straight tube is followed through its folds up to the unduloid of the period, where multipliers pass
through infinity, or to thin necks; likewise the branch that has the unduloid at its start, where that is another; those of
thin necks at any ``c0``, which hardly depend on it; and those on which random and smooth shapes come to rest. Behind an
unduloid, at large negative tension, short waves grow on every shape, and branches turn wherever one of them fits the period:
nothing is followed there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from pearlbvp.continuation.branch import Branch, SpecialPoint
from pearlbvp.continuation.following import BranchOptions, continue_branch
from pearlbvp.continuation.solution import Solution
from pearlbvp.helfrich import SMALLEST_AMPLITUDE, Tube
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.shapes.unduloid import unduloid_pearl
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.pearl_starts import FAR, LONG, SHORT, THIN, stable_downhill, thin_necked
from pearlbvp.studies.starts import branch_of
from pearlbvp.studies.stretches import NEAR, pieces
from pearlbvp.studies.unduloids import beside
from pearlbvp.theory.unduloid import Unduloid, unduloid_of

STARTS = 6
"""Random shapes of a period that are relaxed."""

MOST_UNSTABLE = 6
"""Unstable directions at which a branch that is not the straight tube's ends: what is stable beyond has starts of its own."""

AROUND = 1e-2
"""Difference of the volumes of an unduloid and of pearls with large multipliers that belong to it."""

LARGE = 12.0
"""Tension from which on multipliers are large, and pearls near an unduloid in volume may be those beside it."""


class Limit(NamedTuple):
    """What a stable stretch ends at.

    Attributes:
        kind: ``straight tube``, ``wave``, ``fold`` of the volume, ``unduloid``, ``thin neck``, or ``not followed``.
        n: azimuthal number of the neutral wave.
        theta: its phase per period; of 0 on a tube of any length it is infinitely long.
        observed: numbers of the shape there.
    """

    kind: str
    n: int | None
    theta: float
    observed: Mapping[str, float]

    def columns(self, side: str) -> dict[str, Any]:
        """As tables have it, by the end that it is: ``from`` or ``to``."""
        return {
            f"v_{side}": self.observed["v"],
            f"{side}_limit": self.kind,
            f"n_{side}": self.n,
            f"theta_{side}": self.theta,
        }


@dataclass(frozen=True, eq=False)
class Stretch:
    """Consecutive stable pearls, along which the volume grows or falls.

    Attributes:
        points: in order along the branch.
        ends: what they end at, first and last.
    """

    points: list[Solution[PearlProblem]]
    ends: tuple[Limit, Limit]


def equal_pearls(c0: float, period: float, *, starts: int = STARTS, seed: int = 0) -> list[Branch[PearlProblem]]:
    """The branches of equal pearls of a period.

    Args:
        c0: spontaneous curvature.
        period: of one pearl.
        starts: random shapes that are relaxed.
        seed: of these.

    Raises:
        InputError: an argument that cannot be used; no pearls of the period leave the straight tube.
    """
    tube, unduloid = Tube(c0, period), unduloid_of(period)
    options = replace(_options(period, unduloid, SHORT), until={"r_min": THIN, "lambda1": LARGE})
    branches = [_onward(family_branch(tube, "pearl", (1, 0), options), unduloid)]
    if unduloid is not None and not comes_to_unduloid(branches[0]):
        shape = beside(tube, 1, unduloid, 1 / FAR)
        if shape is not None:
            away = shape if shape.slopes["lambda1"] < 0 else shape.turned()
            branches.append(continue_branch(away, _options(period, unduloid, LONG)))
    known = [piece for branch in branches for piece in pieces("known", branch)]
    v = 1.0 if unduloid is None else unduloid.v
    for shape in (*thin_necked(c0, period), *stable_downhill(tube, v, starts, seed)):
        if not branch_of(shape, known):
            branches.append(_both_ways(shape, unduloid))
            known += pieces("known", branches[-1])
    return branches


def _both_ways(shape: Solution[PearlProblem], unduloid: Unduloid | None) -> Branch[PearlProblem]:
    """The branch through a shape."""
    period = shape.value("L")
    step = LONG if shape.value("lambda1") > LARGE else SHORT
    options = replace(_options(period, unduloid, step, MOST_UNSTABLE), until={"r_min": THIN, "lambda1": LARGE})
    backwards, onward = (
        _onward(continue_branch(start, options), unduloid, MOST_UNSTABLE) for start in (shape.turned(), shape)
    )
    return backwards.reversed().extended(onward)


def _onward(branch: Branch[PearlProblem], unduloid: Unduloid | None, most: float = math.inf) -> Branch[PearlProblem]:
    """The branch beyond where its multipliers become large, by longer steps, or small, by shorter ones."""
    last = branch.points[-1]
    if not branch.complete or abs(last.value("lambda1") - LARGE) > NEAR:
        return branch
    step = LONG if last.slopes["lambda1"] > 0 else SHORT
    return branch.extended(continue_branch(last, _options(last.value("L"), unduloid, step, most)))


def _options(period: float, unduloid: Unduloid | None, max_step: float, most: float = math.inf) -> BranchOptions:
    """Where branches of equal pearls end."""
    far = FAR * max(1.0, 2 * math.pi / period) ** 2

    def limit(point: Solution[PearlProblem]) -> str | None:
        near = unduloid is not None and abs(point.value("v") - unduloid.v) < AROUND
        if near and point.value("lambda1") > far:
            return "unduloid"
        return "many waves grow" if point.spectrum.n_unstable > most else None

    options = branch_options({"cmc": 1, "r_min": THIN}, max_points=400, max_step=max_step)
    return replace(options, limit=limit)


def comes_to_unduloid(branch: Branch[PearlProblem]) -> bool:
    """Whether a branch comes to the unduloid of its period from the side of positive tension."""
    unduloid = unduloid_of(branch.points[0].value("L"))
    return bool(branch.find("cmc")) or _is_beside(branch.points[-1], unduloid)


def _is_beside(point: Solution[PearlProblem], unduloid: Unduloid | None) -> bool:
    if unduloid is None or abs(point.value("v") - unduloid.v) > AROUND:
        return False
    tension, apart = point.value("lambda1"), abs(point.value("r_min") - unduloid.r_min)
    return tension > LARGE and apart * tension < 2 * (1 + point.value("c0") ** 2)


def stable_alone(branch: Branch[PearlProblem]) -> Iterator[Stretch]:
    """The stretches of a branch on which one period is stable."""
    unduloid = unduloid_of(branch.points[0].value("L"))
    for piece in pieces("", branch):
        if piece.stable:
            first, last = (_end(branch, index, unduloid) for index in (piece.first, piece.last))
            yield Stretch(branch.points[piece.first : piece.last + 1], (first, last))


def _end(branch: Branch[PearlProblem], index: int, unduloid: Unduloid | None) -> Limit:
    """What a stable piece ends at, at a point."""
    point = branch.points[index]
    special = {s.kind: s for s in branch.special if s.index == index and s.converged}
    if point.value("amplitude") < SMALLEST_AMPLITUDE:
        return Limit("straight tube", None, math.nan, point.observables)
    if "fold:v" in special:
        return Limit("fold", 0, 0.0, point.observables)
    if "bp" in special:
        return of_wave(special["bp"], point)
    around = [kind for i in (index - 1, index + 1) if 0 <= i < len(branch.points) for kind in branch.kinds(i)]
    if unduloid is not None and ("cmc" in around or _is_beside(point, unduloid)):
        problem, u = unduloid_pearl(point.value("c0"), unduloid)
        return Limit("unduloid", None, math.nan, problem.observables(u))
    kind = "thin neck" if abs(point.value("r_min") - THIN) < NEAR else "not followed"
    return Limit(kind, None, math.nan, point.observables)


def of_wave(special: SpecialPoint, point: Solution[PearlProblem]) -> Limit:
    """The wave of a branch point."""
    return Limit("wave", special.block.n, special.block.theta, point.observables)
