"""What people call branches: pearls m = 2, localized pearl, coils (1,1), oblates in wrinkles.

A branch that begins at the straight tube is called by the mode in which it leaves it; another by what it branches off from,
which is its first shape, and by what becomes of that.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.solution import Solution
from pearlbvp.mesh.amplitudes import projected
from pearlbvp.mesh.problem import MeshProblem
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.tube.isotropy import StandardPosition, standard_position
from pearlbvp.tube.shapes import TubeShapes
from pearlbvp.tube.torus import TorusFunction

STRAIGHT = 1e-3
"""Amplitude up to which a first shape is the straight tube: that of a mesh is a polyhedron."""

EQUAL = 1e-4
"""Part of a wave, by the largest, that is none."""

WORDS = {
    "pearl": "pearls m = {m}",
    "ring": "wrinkles n = {n}",
    "coil": "coils ({m},{n})",
    "buckle": "buckles ({m},{n})",
}

OFF = {"pearl": "from pearls m = {m}", "coil": "from coils ({m},{n})", "buckle": "from buckles ({m},{n})"}
"""What branches off from others is called, but for that of wrinkles."""


@dataclass(frozen=True)
class Name:
    """What a branch is called.

    Attributes:
        text: in a legend.
        kind: ``pearl, ring, coil, buckle``; ``unequal`` for pearls of several sizes; ``mixed`` for what else branches off; or
            the name of an added family.
    """

    text: str
    kind: str

    def __str__(self) -> str:
        return self.text


def names(branches: Mapping[str, Branch[Any]]) -> dict[str, Name]:
    """Names of branches, each with the key behind it where another is called the same."""
    found = {key: name_of(branch) for key, branch in branches.items()}
    alike = Counter(name.text for name in found.values())
    return {
        key: Name(f"{name.text}, {key}", name.kind) if alike[name.text] > 1 else name for key, name in found.items()
    }


def name_of(branch: Branch[Any]) -> Name:
    """What people call a branch.

    Example:
        ``name_of(family_branch(Tube(0.48, 15), "pearl", (2, 0)))`` is ``pearls m = 2``.
    """
    first, last = branch.points[0], branch.points[-1]
    problem = last.problem.shapes
    straight = first.observables["amplitude"] < STRAIGHT and len(branch.points) > 1
    if isinstance(problem, PearlProblem):
        return _of_pearls(first, last, straight)
    if isinstance(problem, MeshProblem):
        return _of_a_mesh(problem, last.u) if straight else Name("triangulated tubes", "mixed")
    if isinstance(problem, TubeShapes):
        return _of_modes(first, last, straight)
    m, n = problem.repeats
    return Name(WORDS.get(problem.family, f"{problem.family} ({m},{n})").format(m=m, n=n), problem.family)


def _of_pearls(first: Solution[Any], last: Solution[Any], straight: bool) -> Name:
    """Equal pearls by their number; unequal ones by how many are large."""
    cells, _ = last.problem.shapes.repeats
    if straight:
        return Name(f"pearls m = {cells}", "pearl")
    radii = _radii(last)
    tops = radii[(radii > np.roll(radii, 1)) & (radii >= np.roll(radii, -1))]
    before, large = cells * _equal_parts(_radii(first)), cells * int((tops > (tops.min() + tops.max()) / 2).sum())
    if before == cells and (len(tops) < 2 or np.ptp(tops) < EQUAL * tops.max()):
        return Name(f"pearls m = {cells * max(len(tops), 1)}", "pearl")
    if large == 1:
        return Name("localized pearl", "unequal")
    all_of_them = max(before, cells * len(tops))
    return Name(f"{large} localized pearls" if 2 * large <= all_of_them else f"{all_of_them} unequal pearls", "unequal")


SAMPLES = 256
"""Places on a period of the pearls."""


def _radii(point: Solution[Any]) -> Array:
    """Radius along one period of an axisymmetric shape."""
    problem = point.problem.shapes
    return np.asarray(problem.curve(point.u, SAMPLES)["r"][:SAMPLES])


def _equal_parts(radii: Array) -> int:
    """How many equal parts a period has: the largest number that divides those of all its waves."""
    waves = np.abs(np.fft.rfft(radii)[1 : SAMPLES // 4])
    return math.gcd(*(int(number) + 1 for number in np.flatnonzero(waves > EQUAL * waves.max()))) or 1


def _of_modes(first: Solution[Any], last: Solution[Any], straight: bool) -> Name:
    """By their symmetry, and that of the first shape."""
    after, before = _position(last), _position(first)
    m, n = _mode(after)
    if straight or after.symmetry == before.symmetry:
        return Name(WORDS.get(after.family, "mixed tubes").format(m=m, n=n), after.family)
    m, n = _mode(before)
    if before.family == "ring":
        return Name("oblates in wrinkles" if n == 2 else f"from wrinkles n = {n}", "mixed")
    if before.family == "pearl" and after.symmetry.fold == 1:
        return Name(f"bent pearls m = {m}", "mixed")
    return Name(OFF.get(before.family, "mixed tubes").format(m=m, n=n), "mixed")


def _position(point: Solution[Any]) -> StandardPosition:
    problem = point.problem.shapes
    at_rest = TorusFunction.of(problem.known(point.u)).in_frame(-problem.symmetry.turns)
    return standard_position(at_rest.modes(), problem.parameters(point.u).length)


def _mode(tube: StandardPosition) -> tuple[int, int]:
    """Waves along and around in which tubes of a symmetry leave the straight one."""
    symmetry = tube.symmetry
    return symmetry.period or symmetry.turns * symmetry.fold, symmetry.fold


MOST = (9, 5)
"""Waves along and around a triangulated tube by which it is called."""


def _of_a_mesh(problem: MeshProblem, u: Array) -> Name:
    """By the largest wave over the straight tube: of coils that of one handedness is alone."""
    surface = projected(problem.functional, problem.vertices(u))
    both = np.abs(
        surface.amplitudes(2 * math.pi / problem.functional.mesh.length, np.arange(MOST[0]), np.arange(MOST[1]))
    )
    both[:, 0, :2] = 0  # the mean radius and a shift
    m, n = (int(number) for number in np.unravel_index(both.max(axis=0).argmax(), MOST))
    small, large = np.sort(both[:, m, n])
    family = "pearl" if n == 0 else "ring" if m == 0 else "coil" if small < large / 2 else "buckle"
    return Name(WORDS[family].format(m=m, n=n), family)
