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
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from pearlbvp.continuation.branch import Branch, SpecialPoint
from pearlbvp.continuation.following import BranchOptions, continue_branch
from pearlbvp.continuation.path import correct_at
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.switching import tangent_along
from pearlbvp.errors import SpectrumError
from pearlbvp.helfrich import SMALLEST_AMPLITUDE, Tube
from pearlbvp.newton import NewtonOptions
from pearlbvp.shapes.graph import pearl_of_graph, relaxed
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.shapes.unduloid import Unduloid, unduloid_of, unduloid_pearl
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.starts import Start, at_rest, branch_of
from pearlbvp.studies.stretches import NEAR, pieces
from pearlbvp.studies.unduloids import beside

THIN = 0.03
"""Radius of the neck at which branches end."""

STARTS = 6
"""Random shapes of a period that are relaxed."""

MOST_UNSTABLE = 6
"""Unstable directions at which a branch that is not the straight tube's ends: what is stable beyond has starts of its own."""

SHORT, LONG = 0.5, 1e3
"""Largest steps: where branches turn sharply, and where multipliers grow without bound, ``lambda1`` above ``LARGE``."""

FAR = 1e3
"""Tension, by the square of the wave number, beyond which a branch has come to an unduloid."""

AROUND = 1e-2
"""Difference of the volumes of an unduloid and of pearls with large multipliers that belong to it."""

LARGE = 12.0
"""Tension from which on multipliers are large, and pearls near an unduloid in volume may be those beside it."""

BELOW = 0.1
"""By how much the smallest volume of random shapes lies below those of the straight tube and the unduloid."""


NEARER = 0.03
"""By how much that of smooth pearls does."""

SMOOTH = np.array([0.5, -0.05])
"""Cosines of a pearl's radius to go downhill from."""


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
    for shape in (*_thin_necked(c0, period), *_downhill(tube, v, starts, seed)):
        if not branch_of(shape, known):
            branches.append(_both_ways(shape, unduloid))
            known += pieces("known", branches[-1])
    return branches


def _thin_necked(c0: float, period: float) -> Iterator[Solution[PearlProblem]]:
    """Stable pearls of thin necks, which hardly depend on ``c0``: from those of one at which branches lead to them."""
    known = _reference(period)
    if known is None:
        return
    problem, u = known.problem, known.u
    for value in np.linspace(REFERENCE, c0, 2 + int(abs(c0 - REFERENCE) / STEP)).tolist():
        d = problem.discretization
        parameters = d.parameters.copy()
        parameters[d.problem.parameters.index("c0")] = value
        problem = replace(problem, discretization=replace(d, parameters=parameters))
        result, _ = correct_at(problem, u, NewtonOptions())
        if not result.converged:
            return
        u = result.u
    problem, (u,) = problem.plain(u)
    upwards = np.zeros_like(u)
    upwards[-1] = 1.0
    with suppress(SpectrumError, np.linalg.LinAlgError):
        shape = Solution.along(problem, u, tangent_along(problem, u, upwards)).computed()
        if not shape.spectrum.n_unstable:
            yield shape


@cache
def _reference(period: float) -> Solution[PearlProblem] | None:
    """Pearls of thin necks, on the branch from the unduloid or, of long ones, from the straight tube."""
    tube, unduloid = Tube(REFERENCE, period), unduloid_of(period)
    options = replace(branch_options({"r_min": NARROW, "cmc": 1}, max_points=400, max_step=LONG), stability=False)
    if unduloid is None:
        branch = family_branch(tube, "pearl", (1, 0), options)
    else:
        shape = beside(tube, 1, unduloid, 1 / FAR)
        if shape is None:
            return None
        branch = continue_branch(shape if shape.slopes["lambda1"] < 0 else shape.turned(), options)
    return branch.points[-1] if abs(branch.points[-1].value("r_min") - NARROW) < NEAR else None


REFERENCE, STEP = 0.48, 0.25
"""Spontaneous curvature at which branches lead to thin necks, and largest steps from there."""

NARROW = 0.06
"""Radius of these necks."""


def _downhill(tube: Tube, v: float, starts: int, seed: int) -> Iterator[Solution[PearlProblem]]:
    """Stable pearls downhill from smooth ones, which have others of less energy beside them, and from random shapes.

    Args:
        tube: one period.
        v: volume of the straight tube, or of the unduloid.
        starts: volumes from below that up to that of one sphere a period, the smooth pearls up to the middle of them.
        seed: of the random shapes.
    """
    sphere = math.sqrt(2 * tube.length) / 3
    low, high = min(v, sphere) - BELOW, max(1.0, v, sphere)
    for i in range(starts):
        share = (i + 0.5) / starts
        yield from _stable_equal(at_rest(Start(tube, low + share * (high - low), (seed, i), True)))
        smooth = v - NEARER + share * (max(v, (v + high) / 2) - v + NEARER)
        try:
            amplitudes, why = relaxed(tube, smooth, SMOOTH)
            if why:
                continue
            problem, u, why = pearl_of_graph(tube, smooth, amplitudes)
            if not why:
                yield from _stable_equal(Solution(problem, u, u).computed())
        except (SpectrumError, np.linalg.LinAlgError):
            continue


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


def _stable_equal(shape: Solution[PearlProblem] | str) -> Iterator[Solution[PearlProblem]]:
    """What a shape came to, where that is stable, one pearl a period, and of no thinner neck than branches end at."""
    if isinstance(shape, str) or shape.spectrum.n_unstable or shape.value("r_min") < THIN:
        return
    if shape.problem.cells == 1 and bellies(shape) == 1:
        yield shape


def bellies(point: Solution[PearlProblem]) -> int:
    """Maxima of the radius of one period."""
    r = point.problem.profile(point.u).outline()[1][:-1]
    return int(((r > np.roll(r, 1)) & (r >= np.roll(r, -1))).sum())


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
