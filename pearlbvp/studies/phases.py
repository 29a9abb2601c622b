"""Which shape does a tube take? All stable shapes that were found at each volume, the least of them, and where that changes.

Branches come from ``studies.diagram``. Every statement rests on them: a shape on a branch that was not followed is not seen.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import pandas as pd

from pearlbvp.continuation.branch import Branch, SpecialPoint, Status
from pearlbvp.continuation.following import BranchOptions
from pearlbvp.continuation.solution import Solution
from pearlbvp.errors import InputError, Interruption
from pearlbvp.helfrich import Tube, WaveNumbers, known_tube, whole
from pearlbvp.numbers import as_numbers
from pearlbvp.studies.branch import branch_options
from pearlbvp.studies.diagram import ENDS, MESH, diagram
from pearlbvp.studies.search import Search
from pearlbvp.studies.shape import both_ways
from pearlbvp.studies.stable_shapes import MOST_UNSTABLE, at_volumes, interrupted, largest_volume
from pearlbvp.studies.stretches import SAME_VOLUME, Piece, curves_of, distinct
from pearlbvp.studies.transitions import Part, least_parts, ranges, transitions
from pearlbvp.theory.dispersion import critical_lambda2

NODES = 3000
"""Vertices of the triangles on which branches go on that reduced modes describe no further."""

MODES = 4
"""Modes of branches that lead to volumes below 1, by increasing ``lambda2``, whose families are followed by default."""

LOWEST_TURN = 0.9
"""Volume down to which pearls are followed even where only larger ones are asked for, for they may turn."""


@dataclass(frozen=True)
class WithinVolumes:
    """A reason to end a branch: its volume leaves a range."""

    low: float
    high: float

    def __call__(self, point: Solution[Any]) -> str | None:
        """Why a branch ends at a point, or None."""
        inside = self.low - SAME_VOLUME <= point.value("v") <= self.high + SAME_VOLUME
        return None if inside else "its volume leaves the range"


@dataclass(frozen=True)
class Phases:
    """Which shapes a tube takes.

    Attributes:
        tube: the straight tube.
        table: a row for each stable shape at each volume, the columns ``COLUMNS``; a row without a shape where none was found.
        transitions: where the least shape changes and where shapes gain and lose stability: ``studies.transitions.COLUMNS``.
        solutions: the shapes of the table by volume and name, the straight tube aside.
        ranges: volumes at which the shapes of a branch are the least, one after another: ``low, high, branch``.
        curves: energies of all branches, dense enough to draw: ``stretches.CURVES``, pieces apart by a row without numbers.
        branches: what was followed, by the names of ``studies.diagram``.
        skipped: branch points that were not followed, by name, and why.
        unfinished: branches that end within the range, and why.
        depth: to which they were followed.
        starts: random shapes that were relaxed.
        rested: how many came to rest on each branch, by name; under ``unstable`` those that came to unstable shapes of none.
        restless: why others did not, and how many.
        origins: of branches that only random starts led to, where they meet others; empty where that is not known.
        lacking: what an interruption left out, in words.
    """

    tube: Tube
    table: pd.DataFrame
    transitions: pd.DataFrame
    solutions: Mapping[tuple[float, str], Solution[Any]]
    ranges: pd.DataFrame
    curves: pd.DataFrame
    branches: Mapping[str, Branch[Any]]
    skipped: Mapping[str, str]
    unfinished: Mapping[str, str]
    depth: int
    starts: int = 0
    rested: Mapping[str, int] = field(default_factory=dict)
    restless: Mapping[str, int] = field(default_factory=dict)
    origins: Mapping[str, str] = field(default_factory=dict)
    lacking: Sequence[str] = ()

    @property
    def complete(self) -> bool:
        """Whether it was not interrupted; else this is what was computed before."""
        return not self.lacking

    def __repr__(self) -> str:
        whole = self.ranges.itertuples(index=False)
        rows = [f"  v = {low:.8g} to {high:.8g}: {name or 'none'}" for low, high, name in whole]
        head = f"phases of c0 = {self.tube.c0:g}, L = {self.tube.length:g}: the least shape of {self.rests_on}"
        return "\n".join([head, *rows])

    @property
    def rests_on(self) -> str:
        """What is meant by the least."""
        words = f"{len(self.branches)} branches to depth {self.depth}"
        if self.starts:
            words += f", and where {sum(self.rested.values())} of {self.starts} random starts came to rest"
        return f"{words}; {interrupted(self.lacking)}" if self.lacking else words

    def shapes(self, v: float) -> dict[str, Solution[Any]]:
        """The stable shapes of a volume of the table by name, the least first."""
        rows = self.table[(self.table["v"] - v).abs() <= SAME_VOLUME].sort_values("E")
        return {name: self.solutions[at, name] for at, name in zip(rows["v"], rows["branch"], strict=True)
                if (at, name) in self.solutions}  # fmt: skip


def phases(
    tube: Tube,
    volumes: float | str | Iterable[float],
    *,
    depth: int = 1,
    modes: Iterable[WaveNumbers] | None = None,
    unstable: int = MOST_UNSTABLE,
    flows: bool = False,
    starts: int = 0,
    seed: int = 0,
    nodes: int = NODES,
    processes: int = 1,
    progress: Callable[[str], None] = lambda name: None,
) -> Phases:
    """Which shape does a tube of given area and length take at which volume?

    Args:
        tube: the straight tube.
        volumes: reduced volumes, in any order, or a text like ``0.6:1.3:0.01``.
        depth: 0 for branches from the straight tube, 1 for those that cross them, too, and so on.
        modes: follow every family of these; by default ``default_modes``.
        unstable: what crosses a branch is followed where so many directions, or fewer, are unstable.
        flows: let shapes flow where they lose their stability, to see what they fall to.
        starts: random shapes that are relaxed, to find shapes on other branches, which are followed, too.
        seed: of the random shapes: the same seed, the same shapes.
        nodes: where reduced modes describe a branch no further, follow it on triangles with about so many vertices; 0 for
            branches that end there.
        processes: how many to work in; 0 for one a core.
        progress: called with the name of each branch before it is followed.

    Returns:
        The answer as tables, and the shapes. Where it is interrupted, what follows from what was computed before.

    Raises:
        InputError: an argument that cannot be used.
        KeyboardInterrupt: before there was any branch.

    Examples:
        >>> found = phases(Tube(0.48, 10), [1.1, 1.2], depth=0)
        >>> list(found.shapes(1.2)), found.transitions.empty
        (['1'], True)
    """
    known_tube(tube)
    starts, seed = whole("starts", starts, 0), whole("seed", seed, 0)
    depth, unstable, wanted = whole("depth", depth, 0), whole("unstable", unstable, 0), known_volumes(tube, volumes)
    low, high = min(1.0, wanted[0]), max(1.0, wanted[-1])
    chosen = default_modes(tube, low < 1, high > 1) if modes is None else modes
    found = diagram(tube.c0, tube.length, depth, _options(low, high), progress, modes=chosen, processes=processes,
                    refused=partial(_too_unstable, unstable), nodes=nodes)  # fmt: skip
    lacking = [] if found.complete else ["not all branches were followed"]
    if not found.branches:
        if lacking:
            raise KeyboardInterrupt
        raise InputError("modes", "no branch could be followed", "choose other modes, or another length")
    begun = Search.of(found.branches)
    if starts:
        with Interruption():
            if not lacking:
                _search(tube, begun, (wanted[0], wanted[-1]), (low, high), unstable, starts, seed, processes, progress)
        lacking += [f"{begun.relaxed} of {starts} random starts were relaxed"] * (begun.relaxed < starts)
    found, everything = replace(found, branches=begun.branches), begun.pieces
    stretches, images = distinct([piece for piece in everything if piece.stable])
    alike = Counter((found.twins | images).values())
    ended = {name: branch for name, branch in found.branches.items() if f"{name} {MESH}" not in found.branches}
    unfinished = {name: branch for name, branch in ended.items() if _ends_within(branch, low, high)}
    said = {name: branch.reason for name, branch in unfinished.items()}
    table, solutions = at_volumes(tube, wanted, stretches, found.branches, unfinished, lacking, processes)
    parts, stopped = list[Part](), Interruption()
    with stopped:
        parts = least_parts(stretches, wanted[0], wanted[-1], lambda what: said.update({what.partition(",")[0]: what}))
    lacking += ["where the least shape changes was not computed"] * stopped.happened
    table = table.assign(c0=tube.c0, L=tube.length, branches=len(found.branches), depth=depth, starts=begun.relaxed)
    here = table["branch"].map(dict(begun.rested)).fillna(0)
    table = table.assign(rest_here=here, origin=table["branch"].map(begun.origins),
                         multiplicity=table["branch"].map({name: 1 + alike[name] for name in found.branches}))  # fmt: skip
    flows, stopped = flows and not lacking, Interruption()  # which take longest
    falls = partial(_falls, everything, stretches) if flows else _no_falls
    events = transitions(tube, parts, stretches, list(found.branches), (wanted[0], wanted[-1]), falls, stopped)
    lacking += ["not all transitions were computed"] * stopped.happened
    curves = curves_of(everything, stretches, wanted[0], wanted[-1])
    table = table.astype(dict.fromkeys(("n_unstable", "rank", "rest_here", "multiplicity"), "Int64"))
    return Phases(
        tube, table, events, solutions, ranges(parts), curves, found.branches, found.skipped, said, depth,
        begun.relaxed, begun.rested, begun.restless, begun.origins, lacking,
    )  # fmt: skip


def _search(
    tube: Tube, found: Search, volumes: tuple[float, float], ends: tuple[float, float],
    unstable: int, starts: int, seed: int, processes: int, progress: Callable[[str], None],
) -> None:  # fmt: skip
    """Pearls beside unduloids, and what spheres and random starts come to: what is on no known branch is followed both ways."""
    from pearlbvp.studies.spheres import strings_of_spheres
    from pearlbvp.studies.starts import meetings, search  # the flow's rooms, which nothing else here needs
    from pearlbvp.studies.unduloids import beside_unduloids

    down, up = (replace(branch_options({"v": v}), limit=WithinVolumes(*ends)) for v in ends)

    def follow(shape: Solution[Any]) -> Branch[Any]:
        return both_ways(shape.problem, shape.u, down, up)

    try:
        beside_unduloids(tube, found, *volumes, unstable, follow)
        strings_of_spheres(tube, found, *volumes, unstable, follow)
        search(tube, found, volumes, starts, seed, follow, processes, progress)
    finally:
        found.origins |= {name: meetings(found.branches[name], found.branches) for name in found.origins}


def _falls(everything: Sequence[Piece], stretches: Sequence[Piece], piece: Piece, upper: bool) -> list[str]:
    from pearlbvp.studies.falls import falls_to  # the flow's rooms, which nothing else here needs

    return falls_to(piece, upper, [other for other in everything if not other.stable], stretches)


def _no_falls(piece: Piece, upper: bool) -> list[str]:
    return []


def known_volumes(tube: Tube, volumes: float | str | Iterable[float]) -> list[float]:
    """Volumes in order, each once.

    Raises:
        InputError: one that no tube has.
    """
    wanted, most = sorted(set(as_numbers("volumes", volumes))), largest_volume(tube)
    if wanted[0] <= 0:
        raise InputError("volumes", f"{wanted[0]:g} must be above 0", "give reduced volumes like 0.6:1.3:0.01")
    if wanted[-1] >= most and wanted[-1] > 1:
        raise InputError("volumes", f"no tube of that area and length has v = {wanted[-1]:g}", f"stay below {most:.6g}")
    return wanted


def default_modes(tube: Tube, below: bool, above: bool) -> list[WaveNumbers]:
    """Modes whose branches matter: pearls lead to volumes above 1, where ``k < 1``, all others below.

    Near the straight tube ``E`` changes by ``-lambda2 (v - 1)/2``: below 1 the modes of smallest ``lambda2`` have the least
    energy, and rings, whose turn may come at smaller volumes, are there in any case. Pearls of ``k > 1`` may turn to larger
    volumes.

    Args:
        tube: the straight tube.
        below, above: whether there are volumes below or above 1.
    """
    waves = [(m, tube.wave_number(m)) for m in range(math.ceil(tube.length / math.pi) + 2)]
    pearls = [(m, 0) for m, k in waves if 0 < k < 1]
    others = [(m, n) for m, k in waves for n in range(5) if (n or k > 1) and (m, n) != (0, 1)]
    others.sort(key=lambda mode: float(critical_lambda2(tube.wave_number(mode[0]), mode[1], tube.c0)))
    first = others[:MODES]
    first += [(0, 2)] * ((0, 2) not in first)
    return pearls * above + [mode for mode in first if below or mode[1] == 0]


def _options(low: float, high: float) -> dict[str, BranchOptions]:
    """Where branches of each family end: at that end of the range to which they lead, or beyond the other."""
    options = {name: replace(branch_options({"v": low}), limit=WithinVolumes(low, high)) for name in ENDS}
    pearls = WithinVolumes(min(low, LOWEST_TURN), high)
    return options | {"pearl": replace(branch_options({"v": high} if high > 1 else None), limit=pearls)}


def _too_unstable(most: int, branch: Branch[Any], special: SpecialPoint) -> str:
    """Why what crosses at a branch point is not followed: it has as many unstable directions as the branch, or more."""
    return f"more than {most} directions are unstable there" if branch.at(special).spectrum.n_unstable > most else ""


def _ends_within(branch: Branch[Any], low: float, high: float) -> bool:
    """Whether a branch ends where it could go on, at a volume within the range."""
    whole = (Status.REACHED, Status.GIVEN, Status.PITCHFORK)
    return branch.status not in whole and low < branch.points[-1].value("v") < high
