"""What does a shape fall to where it loses its stability? Flows at fixed area and volume from just beside the limit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from pearlbvp.continuation.path import PathEnd
from pearlbvp.continuation.solution import Solution
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.studies.flow_end import end_point
from pearlbvp.studies.flow_start import solution_start
from pearlbvp.studies.stretches import Piece

BEYOND = 0.1
"""Share of the unstable stretch of the branch by which the flow starts from the limit."""

FARTHEST = 1e-3
"""Largest distance of volumes between the limit and there."""

PUSH = 0.02
"""Size of the perturbation, in radii, to either side."""

SADDLES = 3
"""Flows, one after another, of which each begins at the saddle where the one before stopped."""

COARSE = 0.01
"""Relative difference of energies, which are small near unduloids, that the few modes of a flow explain."""

ALONG, AROUND = 2.6, 6
"""Largest wave numbers of flows of pearls that lose their axis: along, by the length, and around."""

ENERGY, OTHERS = 1e-8, 1e-5
"""Differences of ``E``, and of ``lambda2`` and ``r_max``, of the end of a flow and a shape of a branch that are one."""


def falls_to(piece: Piece, upper: bool, unstable: Sequence[Piece], stretches: Sequence[Piece]) -> list[str]:
    """Names of the stable shapes that a shape flows to at an end of its stretch; none where no unstable shapes follow there.

    The flow starts from the unstable shapes of its branch beside the limit: beyond a branch point, inside of a fold. They are
    pushed along their most unstable perturbation, to either side, and moved back to their area and volume.

    Args:
        piece: a stable stretch.
        upper: whether its end of largest volume is meant.
        unstable: pieces of branches, that of the piece among them.
        stretches: stable pieces of all branches, for the names.

    Raises:
        InputError: the shape cannot flow, or a flow does not come to rest at a point of a branch.
        PathEnd: a shape could not be computed.
    """
    start = _start(piece, upper, unstable)
    if start is None:
        return []
    names: dict[str, None] = {}
    for push in (PUSH, -PUSH):
        name = _named(_at_rest(start, push), [piece, *stretches])
        if name != piece.name:  # beside a fold one side leads back
            names[name] = None
    return list(names)


def _at_rest(start: Solution[Any], push: float) -> Solution[Any]:
    """Where a shape that is pushed comes to rest: a flow that stops at a saddle, where symmetry leads it, is pushed on."""
    end = start
    bends = isinstance(start.problem, PearlProblem) and start.spectrum.critical.n > 0
    size = (max(12, math.ceil(ALONG * start.value("L"))), AROUND) if bends else None
    for _ in range(SADDLES):
        begun = solution_start(end, symmetric=not bends, size=size)
        end = end_point(begun.flow(begun.perturbed("critical", push, keep=True)).uninterrupted(), unlike=COARSE)
        if end.spectrum.n_unstable == 0:
            break
    return end


def _start(piece: Piece, upper: bool, unstable: Sequence[Piece]) -> Solution[Any] | None:
    """The unstable shape from which to flow."""
    number = piece.ends[1 if upper else 0]
    for other in unstable:
        if other.branch is piece.branch and number in other.ends:
            v = piece.branch.points[number].value("v")
            far = other.low + other.high - v
            return other.at(v + math.copysign(min(BEYOND * abs(far - v), FARTHEST), far - v))
    return None


def _named(end: Solution[Any], stretches: Sequence[Piece]) -> str:
    """The name of the branch that the end of a flow is on."""
    v = end.value("v")
    for piece in stretches:
        if piece.low <= v <= piece.high:
            try:
                shape = piece.at(v)
            except PathEnd:
                continue
            if are_one(shape.observables, end.observables):
                return piece.name
    return (
        f"another {end.problem.family} of E = {end.value('E'):.8g} with {end.spectrum.n_unstable} unstable directions"
    )


def are_one(one: Mapping[str, float], other: Mapping[str, float]) -> bool:
    """Whether two shapes of one volume are one, to the accuracy of flows."""
    gaps = {name: abs(one[name] - other[name]) for name in ("E", "lambda2", "r_max")}
    return gaps["E"] < ENERGY and gaps["lambda2"] < OTHERS and gaps["r_max"] < OTHERS
