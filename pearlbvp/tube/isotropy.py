"""Which symmetry a tube has: its isotropy subgroup, and the rigid motion that brings it into the standard position.

As a function on the torus (``tube.torus``) a tube is invariant under the shifts and turns that leave each of its waves alone:
its wave numbers generate a lattice (M. Golubitsky, I. Stewart, D. G. Schaeffer, Singularities and Groups in Bifurcation Theory
II (Springer 1988), ch. XIII). A frame is sought in which that lattice is one of a period and a fold, and in it the position
in which the features of the modes (``tube.symmetry``) generate the smallest group: then every reflection, pure or with half a
shift or turn, is one of a parity.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from pearlbvp.arrays import Array, Complex, Integers
from pearlbvp.representation import brief
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.symmetry import ODD_B, ODD_P, ODD_PHI, ODD_X, PARITIES, TubeSymmetry
from pearlbvp.tube.torus import TorusFunction

NEGLIGIBLE = 1e-6
"""Coefficients of waves, in radii, below which they are zero: those of an equilibrium are exact to some 1e-10."""

BREAKING = 4 * NEGLIGIBLE
"""Coefficients of modes beyond which they break a symmetry: of two equal waves just at ``NEGLIGIBLE`` one alone may count."""

STRONGEST, LARGEST_DETERMINANT = 8, 4
"""Waves by which positions are tried, two at a time, and the largest area of the cell that their numbers span."""


@dataclass(frozen=True)
class StandardPosition:
    """A tube in the position that its symmetry asks for, and how it lay before.

    The given tube is the standard one, first reflected by ``z -> -z`` if ``mirrored``, then turned about the axis by ``turn``,
    then moved along the axis by ``shift`` and across it by ``across``.

    Attributes:
        symmetry: its symmetry.
        known: coefficients of its modes there, in the symmetry's frame.
        shift: along the axis, in radii.
        turn: about it.
        across: in ``y`` and ``z``, in radii.
        mirrored: whether it is the mirror image: coils of the other handedness are.
    """

    __repr__ = brief

    symmetry: TubeSymmetry
    known: Mapping[Mode, float]
    shift: float
    turn: float
    across: tuple[float, float]
    mirrored: bool

    @property
    def family(self) -> str:
        """``cylinder``, ``ring``, ``coil``, ``pearl``, ``buckle``, or ``mixed``: all the others."""
        s = self.symmetry
        if s.period == s.fold == 0:
            return "cylinder"
        if s.onset_mode is None:
            return "mixed"
        if s.is_coil:
            return "coil" if s.turns or self._is_helical else "mixed"
        if s.period == 0:
            return "ring"
        return "buckle" if s.fold else "pearl"

    @property
    def _is_helical(self) -> bool:
        """Whether all waves are functions of one angle across the axis: their numbers are multiples of those of one."""
        shape = _shape(TorusFunction.of(self.known))
        return not np.any(np.outer(shape.p, shape.b) - np.outer(shape.b, shape.p))

    @property
    def handedness(self) -> int:
        """1 where the frame turns from ``y`` to ``z`` along the axis, -1 in the mirror image, 0 where it does not turn."""
        return 0 if not self.symmetry.turns else -1 if self.mirrored else 1


def standard_position(known: Mapping[Mode, float], length: float) -> StandardPosition:
    """Recognize the symmetry of a tube that lies anyhow.

    Args:
        known: coefficients of its modes, in a frame at rest, their wave numbers in units of ``2 pi/length``.
        length: the tube's.
    """
    given = TorusFunction.of(known)
    turns = _frame(_shape(given))
    mirrored, turns = turns < 0, abs(turns)
    seen = (given.mirrored() if mirrored else given).in_frame(turns)
    period, fold, along, around, group = _position(seen, turns)
    placed = _gauged(seen.moved(along, around), turns)
    # At rest, a shift of the turning frame's function is one that turns with it.
    turn = (around + turns * along) * (-1 if mirrored else 1)
    centre = 2 * placed.at(-turns, -1)
    across = 2 * given.at(0, -1) - np.exp(1j * turn) * (centre.conjugate() if mirrored else centre)
    shift = math.remainder(along, 2 * math.pi) * length / (2 * math.pi)
    turn = math.remainder(turn, 2 * math.pi)
    symmetry = TubeSymmetry(period, fold, turns, group)
    return StandardPosition(symmetry, placed.modes(), shift, turn, (float(across.real), float(across.imag)), mirrored)


def _shape(seen: TorusFunction, turns: int = 0) -> TorusFunction:
    """The waves that say something of the shape, one of each pair: neither the mean radius nor shifts across the axis."""
    shape = seen.larger_than(NEGLIGIBLE).without((0, 0), (turns, 1), (-turns, -1))
    return shape.kept((shape.p > 0) | ((shape.p == 0) & (shape.b > 0)))


def _hull(shape: TorusFunction) -> tuple[int, int]:
    """The smallest period and fold that all wave numbers are multiples of; 0 where all are 0."""
    return int(np.gcd.reduce(shape.p, initial=0)), int(np.gcd.reduce(shape.b, initial=0))


def _is_rectangular(shape: TorusFunction) -> bool:
    """Whether the lattice of the waves is that of a period and a fold, or its half with ``p/period + b/fold`` even."""
    period, fold = _hull(shape)
    if not period or not fold:
        return True
    minors = np.outer(shape.p, shape.b) - np.outer(shape.b, shape.p)
    return int(np.gcd.reduce(minors, axis=None)) in (period * fold, 2 * period * fold)


def _frame(shape: TorusFunction) -> int:
    """Turns of the frame in which a tube varies least along the axis, among those that its lattice has room in.

    Its variation, ``sum of p^2 |c|^2``, is quadratic in the turns. Reflections at rest make it symmetric: then 0 is the least.
    """
    weights = np.abs(shape.c) ** 2
    by_turns, bent = float(weights @ (shape.p * shape.b)), float(weights @ shape.b**2)
    best = -by_turns / bent if bent else 0.0
    at_rest = float(weights @ shape.p**2) or 1.0

    def badness(turns: int) -> tuple[bool, float, int, int]:
        seen = shape.in_frame(turns)
        variation = round(float(weights @ seen.p**2) / at_rest, 9)  # of two alike, the slower frame
        return not _is_rectangular(seen), variation, abs(turns), -turns

    return min({0, math.floor(best), math.ceil(best)}, key=badness)


def _position(seen: TorusFunction, turns: int) -> tuple[int, int, float, float, frozenset[int]]:
    """Period and fold, angles ``k x`` and ``phi`` of the point that becomes the origin, the group that the features generate.

    Where a tube has reflections, its strongest waves are real, or imaginary, about their planes.
    """
    shape = _shape(seen, turns)
    period, fold = _hull(shape)
    units = np.maximum([period, fold], 1)
    i, a = shape.p // units[0], shape.b // units[1]  # periods and folds
    places = _candidates(i, a, shape.c)
    turned = shape.c * np.exp(1j * (places[:, :1] * i + places[:, 1:] * a))  # (candidates, waves)
    groups = [_closure(found, turns) for found in _features(i, a, turned)]
    # Of equal groups the one whose elements are smallest: modes that are cosines both ways, their sum positive.
    order = [
        (len(group), sorted(group), -float(row)) for group, row in zip(groups, turned.real.sum(axis=1), strict=True)
    ]
    best = min(range(len(order)), key=order.__getitem__)
    along, around = (float(angle) for angle in places[best] / units)
    return period, fold, along, around, groups[best]


def _candidates(i: Integers, a: Integers, c: Complex) -> Array:
    """Places where two of the strongest waves are real; where all are waves of one direction, one of them. Shape (C, 2)."""
    found = [np.zeros((1, 2))]
    strongest = np.argsort(-np.abs(c))[:STRONGEST]
    for m, n in combinations(strongest, 2):
        determinant = int(i[m] * a[n] - i[n] * a[m])
        if 0 < abs(determinant) <= LARGEST_DETERMINANT:
            halves = np.arange(2 * abs(determinant)) * math.pi
            first, second = (t.ravel() for t in np.meshgrid(halves - np.angle(c[m]), halves - np.angle(c[n])))
            found.append(np.column_stack((a[n] * first - a[m] * second, i[m] * second - i[n] * first)) / determinant)
    if len(found) == 1 and len(strongest):
        m = strongest[0]
        number = i[m] or a[m]
        places = (np.arange(2 * abs(number)) * math.pi - np.angle(c[m])) / number
        found = [np.column_stack((places, 0 * places) if i[m] else (0 * places, places))]
    return np.concatenate(found)


def _features(i: Integers, a: Integers, turned: Complex) -> list[set[int]]:
    """Features of the modes that a function has at each of some places, its waves given on half of the plane."""
    classes, place = np.unique(np.column_stack((i, np.abs(a))), axis=0, return_inverse=True)
    place = place.ravel()  # of NumPy 2.0 it has another axis
    forward, backward = np.zeros((2, len(turned), len(classes)), dtype=complex)
    forward[:, place[a >= 0]] = turned[:, a >= 0]
    backward[:, place[a < 0]] = turned[:, a < 0].conj()  # of (-i, |a|)
    alike, unlike = forward + backward, forward - backward
    # Coefficients of cos cos, sin cos, cos sin, sin sin: sums over both signs of both numbers.
    parts = 2 * np.abs(np.array([alike.real, unlike.imag, alike.imag, unlike.real]))
    flat = classes == 0
    parts[[1, 3]] *= ~flat[:, 0]
    parts[[2, 3]] *= ~flat[:, 1]
    odd = classes % 2 @ [ODD_P, ODD_B]
    kinds = np.array([0, ODD_X, ODD_PHI, PARITIES])
    return [set((kinds[:, None] | odd)[part > BREAKING].tolist()) for part in np.moveaxis(parts, 1, 0)]


def _closure(features: set[int], turns: int) -> frozenset[int]:
    """The group that features generate; the frame's turning is itself odd both ways."""
    group = {0}
    for element in features | ({PARITIES} if turns else set()):
        group |= {element ^ other for other in group}
    return frozenset(group)


def _gauged(seen: TorusFunction, turns: int) -> TorusFunction:
    """Moved across the axis so that the modes are absent that ``tube.symmetry`` leaves out: ``z`` of the frame's own turns."""
    kept = seen.without((turns, 1), (-turns, -1))
    if not turns:
        return kept
    p, b = np.append(kept.p, (turns, -turns)), np.append(kept.b, (1, -1))
    return TorusFunction(p, b, np.append(kept.c, (kept.at(turns, -1), kept.at(-turns, 1))))
