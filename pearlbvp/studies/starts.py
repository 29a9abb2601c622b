"""Random shapes of given area and volume, relaxed to rest: which of them lie on no branch that was followed?

Every other start is an axisymmetric outline, overhangs included, the rest are tubes without any symmetry. Each has a
random volume of its own and its own seed, so that a run can be repeated, in any number of processes. What it comes to is made
exact by Newton's method on the problem of its symmetry, so that it can be compared with branches to many digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.path import PathEnd
from pearlbvp.continuation.problem import P
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.switching import tangent_along
from pearlbvp.errors import InputError, SpectrumError
from pearlbvp.flows.landscape import TubeLandscape
from pearlbvp.flows.record import Equilibrium
from pearlbvp.flows.tube import TubeFlow
from pearlbvp.helfrich import Tube
from pearlbvp.membrane import MembraneProblem
from pearlbvp.minimum import Minimum, least
from pearlbvp.shapes.outline import Outline, downhill
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.studies.falls import are_one
from pearlbvp.studies.flow_end import resolved, solution_of
from pearlbvp.studies.flow_start import solution_start
from pearlbvp.studies.parallel import in_processes
from pearlbvp.studies.search import UNSTABLE, Search
from pearlbvp.studies.stretches import Piece

LONGEST = 16.0
"""Length up to which tubes without symmetry are relaxed, for the work grows with its third power."""

NEAREST = 1e-3
"""Distance from the straight tube's volume, where area and volume are nearly parallel, at which starts are made at least."""

COARSE = 0.02
"""Relative difference of energies that the few modes of a relaxed tube explain."""

NEAR = 1e-3
"""Relative difference of an energy and one interpolated on a branch, at which the shape itself is compared."""


@dataclass(frozen=True)
class Start:
    """A random start.

    Attributes:
        tube: the straight tube.
        v: reduced volume.
        seed: of this start: the run's, and its number.
        axisymmetric: whether it is an outline.
    """

    tube: Tube
    v: float
    seed: tuple[int, int]
    axisymmetric: bool


def starts_within(tube: Tube, low: float, high: float, count: int, seed: int) -> list[Start]:
    """Random starts at random volumes of a range, one in each of ``count`` equal parts of it."""
    found = []
    for i in range(count):
        v = low + (high - low) * (i + float(np.random.default_rng((seed, i, 0)).uniform())) / count
        if abs(v - 1) < NEAREST:
            v = 1 + math.copysign(NEAREST, v - 1)
        found.append(Start(tube, v, (seed, i), i % 2 == 0 or tube.length > LONGEST))
    return found


def at_rest(start: Start) -> Solution[Any] | str:
    """Where a start comes to rest, with its stability, or why it does not."""
    try:
        shape = computed(*(_outline if start.axisymmetric else _tube)(start))
        if not start.axisymmetric:
            shape = _lower(shape, start)
        return "it passes through itself" if shape.clearance < 0 else shape
    except PathEnd as error:
        return str(error.args[0])
    except SpectrumError:
        return "its stability would take too many modes"
    except (InputError, np.linalg.LinAlgError):
        return UNPOLISHED


UNPOLISHED = "no exact shape was computed where it came to rest"


def _minimum(found: Minimum) -> Minimum:
    if found.reason:
        raise PathEnd(found.reason)
    return found


def _outline(start: Start) -> tuple[PearlProblem, Array]:
    outline = Outline.on(start.tube, start.v)
    return resolved(*downhill(outline, outline.random(np.random.default_rng(start.seed))))


def _tube(start: Start) -> tuple[MembraneProblem, Array]:
    tube = start.tube
    size = max(6, math.ceil(0.8 * tube.length)), 5
    landscape = TubeLandscape(TubeFlow(tube.c0, tube.length, size), start.v)
    found = _minimum(least(landscape, landscape.random(np.random.default_rng(start.seed))))
    try:
        return _of_modes(landscape, found)
    except InputError:  # too few modes: once more, on more of them
        finer = replace(landscape, flow=replace(landscape.flow, size=(3 * size[0] // 2, 8)))
        q = finer.flow.packed(landscape.flow.known(found.q))
        return _of_modes(finer, _minimum(least(finer, q)))


def computed(problem: P, u: Array) -> Solution[P]:
    """A shape with its stability, along growing volume."""
    upwards = np.zeros_like(u)
    upwards[-1] = 1.0
    return Solution.along(problem, u, tangent_along(problem, u, upwards)).computed()


def _lower(shape: Solution[Any], start: Start) -> Solution[Any]:
    """Where an unstable shape, which the few modes of a start may have taken for a minimum, leads on more of them.

    It is pushed along its most unstable perturbation. A shape that these modes do not hold either is left as it is.
    """
    for around in AROUND:
        if shape.spectrum.n_unstable == 0:
            break
        try:
            begun = solution_start(shape, symmetric=False, size=(max(8, math.ceil(0.8 * start.tube.length)), around))
            assert isinstance(begun.problem, TubeFlow)
            landscape = TubeLandscape(begun.problem, start.v)
            found = _minimum(least(landscape, begun.perturbed("critical", PUSH), tolerance=ROUGH))
            shape = computed(*_of_modes(landscape, found))
        except SpectrumError:  # on more modes it would take as many
            break
        except (InputError, PathEnd, np.linalg.LinAlgError):
            continue
    return shape


AROUND, PUSH = (12, 16), 0.1
"""Waves around a tube on which unstable shapes are relaxed once more, and by how many radii they are pushed."""

ROUGH = 1e-6
"""Reduced gradient at which Newton's method takes over from a relaxation on more modes, whose last steps are costly."""


def _of_modes(landscape: TubeLandscape, found: Minimum) -> tuple[MembraneProblem, Array]:
    if landscape.flow.trouble(found.q) is not None:
        raise PathEnd("its sections across the axis no longer describe it")
    end = Equilibrium(landscape.flow, found.q, found.multipliers, True, np.array([0.0]))
    return solution_of(end, COARSE, judged=True)


def search(
    tube: Tube,
    found: Search,
    volumes: tuple[float, float],
    count: int,
    seed: int,
    follow: Callable[[Solution[Any]], Branch[Any]],
    processes: int,
    progress: Callable[[str], None],
) -> None:
    """Relax random starts; stable shapes on no known branch are followed.

    Args:
        tube: the straight tube.
        found: what is known, to which is added what they come to.
        volumes: ends of the range of volumes of the starts.
        count, seed: of the starts.
        follow: makes of a shape the branch through it.
        processes: how many to work in; 0 for one a core.
        progress: called after each start.
    """
    cases = starts_within(tube, *volumes, count, seed)
    for shape in in_processes(at_rest, cases, processes or None, FEWEST):
        progress("start")
        if isinstance(shape, str):
            found.restless[shape] += 1
            continue
        name = branch_of(shape, found.pieces) or UNSTABLE * (shape.spectrum.n_unstable > 0)
        if not name:
            name = f"start {len(found.origins) + 1}"
            found.add(name, follow(shape))
            found.origins[name] = ""
        found.rested[name] += 1


FEWEST = 8
"""Starts from which on several processes are of use."""


def branch_of(shape: Solution[Any], everything: Sequence[Piece]) -> str:
    """The branch that a shape is on, by its energy, pressure and radius; empty if none."""
    v, energy = shape.value("v"), shape.value("E")
    for piece in everything:
        if not piece.low <= v <= piece.high:
            continue
        if abs(float(piece.energies([v])[0]) - energy) > NEAR * abs(energy) + 1e-6:
            continue
        try:
            if are_one(piece.at(v).observables, shape.observables):
                return piece.name
        except PathEnd:
            continue
    return ""


def meetings(branch: Branch[Any], others: Mapping[str, Branch[Any]]) -> str:
    """Where the ends of a branch lie on others: ``3 at bp 2``; empty where on none."""
    return ", ".join(dict.fromkeys(_meetings(branch, others)))


def _meetings(branch: Branch[Any], others: Mapping[str, Branch[Any]]) -> Iterator[str]:
    for end in (branch.points[0].observables, branch.points[-1].observables):
        for name, other in others.items():
            if other is branch:
                continue
            for number, special in enumerate(other.find("bp"), start=1):
                if _meet(end, other.at(special).observables):
                    yield f"{name} at bp {number}"


def _meet(one: Any, other: Any) -> bool:
    """Whether branches end and cross at one place, to the accuracy of both."""
    return all(abs(one[name] - other[name]) < MEETING for name in ("v", "E", "lambda2", "r_max"))


MEETING = 1e-5
"""Differences of observables at one point of two branches."""
