"""Symmetry of a tube as a set of modes, and the blocks of perturbations that go with it.

See ``docs/theory/symmetry_and_blocks.md``. Modes are products of a cosine or sine of ``p k x`` and one of ``b phi``. Two of
them excite a third whose features are the sum of theirs modulo 2::

    odd in x,   odd in phi,   p/period odd,   b/fold odd

so the modes of a symmetric tube are those of one period and fold whose features lie in a group of sums, and perturbations
split into its cosets: one of them can grow without the others. A tube that branches off a tube by a perturbation of a coset has
the modes of both: its group is that which the two generate. No table of symmetry groups is needed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import gcd
from typing import NamedTuple

from pearlbvp.tube.modes import Mode, Part

ODD_X, ODD_PHI, ODD_P, ODD_B = 1, 2, 4, 8
"""Bits of a feature."""

PARITIES = ODD_X | ODD_PHI


class TubeBlock(NamedTuple):
    """A symmetry block of perturbations.

    Attributes:
        name: what it is called in tables.
        j: their wave numbers along the tube are ``j`` or ``-j`` modulo the period of the tube's shape.
        c: their wave numbers around it are ``c`` or ``-c`` modulo its fold.
        coset: features of one of its modes, the smallest of its coset.
        multiplicity: how often each of its growth rates occurs: other blocks are images of this one, shifted or turned.
    """

    name: str
    j: int = 0
    c: int = 0
    coset: int = 0
    multiplicity: int = 1

    def __str__(self) -> str:
        return self.name


def product_modes(waves: Iterable[tuple[int, int]], turns: int, *, gauge: bool = False) -> Iterator[Mode]:
    """All products of a cosine or sine along the tube and one around it; those with ``b = 1`` move the centre.

    Args:
        waves: wave numbers along and around.
        turns: of the frame on the tube's length.
        gauge: leave out the modes that shifts across the axis can be made to cancel: a shift adds a centre that stands
            still, ``e^{-i turns k x}`` in the turning frame, so one of its two coordinates can always be made zero.
    """
    for p, b in waves:
        for x in ("cos", "sin") if p else ("cos",):
            if b == 1:
                parts: tuple[Part, ...] = ("y", "z")
                if gauge and p == turns:
                    parts = ("y",) if p else ()
                yield from (Mode(part, p, x) for part in parts)
            else:
                yield from (Mode("sigma", p, x, b, phi) for phi in (("cos", "sin") if b else ("cos",)))


def ellipse(period: int, fold: int, size: tuple[int, int]) -> list[tuple[int, int]]:
    """Multiples ``(p, b)`` of a period and a fold with ``(p/period/size_x)^2 + (b/fold/size_phi)^2 <= 1``.

    Coefficients of strongly bent tubes are of one size about on ellipses: those beyond are all as small as the last.
    """
    along = range(size[0] + 1) if period else (0,)
    around = range(size[1] + 1) if fold else (0,)
    return [
        (period * i, fold * a) for i in along for a in around
        if (i / max(size[0], 1)) ** 2 + (a / max(size[1], 1)) ** 2 <= 1 + 1e-9
    ]  # fmt: skip


@dataclass(frozen=True)
class TubeSymmetry:
    """The modes that a symmetric tube is a sum of.

    Attributes:
        period: wave numbers along the tube are multiples of this (unit ``2 pi/L``); 0 if nothing depends on ``x``.
        fold: wave numbers around it are multiples of this; 0 if nothing depends on ``phi``.
        turns: of the frame on the tube's length: 0 but for coils.
        group: features of its modes, closed under sums modulo 2 (exclusive or).
    """

    period: int
    fold: int
    turns: int
    group: frozenset[int]

    def features(self, mode: Mode) -> int | None:
        """Features of a mode, or None if its wave numbers do not fit the period and the fold."""
        p, b = mode.p, mode.harmonic
        if p % self.period if self.period else p:
            return None
        if b % self.fold if self.fold else b:
            return None
        odd_p = p // self.period % 2 if self.period else 0
        odd_b = b // self.fold % 2 if self.fold else 0
        return (mode.along == "sin") * ODD_X + (not mode.is_even) * ODD_PHI + odd_p * ODD_P + odd_b * ODD_B

    def modes(self, size: tuple[int, int]) -> tuple[Mode, ...]:
        """Its modes up to ``size`` periods along the tube and folds around it."""
        waves = ellipse(self.period, self.fold, size)
        return tuple(mode for mode in product_modes(waves, self.turns, gauge=True) if self.features(mode) in self.group)

    @cached_property
    def _parity_group(self) -> frozenset[int]:
        """What couples parities where wave numbers are not multiples of the period and the fold."""
        return frozenset(element & PARITIES for element in self.group)

    @property
    def is_coil(self) -> bool:
        """Whether it is that in which coils leave the straight tube."""
        m, n = self.period or self.turns * self.fold, self.fold
        return m > 0 and n > 0 and self == coil_symmetry(m, n)

    @property
    def onset_mode(self) -> Mode | None:
        """The mode in which tubes of this symmetry leave the straight one; None where they do not."""
        if not self.is_coil and self not in (
            ring_symmetry(self.fold), buckle_symmetry(self.period, self.fold), pearl_symmetry(self.period),
        ):  # fmt: skip
            return None
        return Mode("y", self.period) if self.fold == 1 else Mode("sigma", self.period, "cos", self.fold)

    def block(self, j: int, c: int, features: int) -> TubeBlock:
        """The block of perturbations with given classes of wave numbers and features of the symmetry."""
        whole = j == 0 and c == 0
        group = self.group if whole else self._parity_group
        coset = min((features if whole else features & PARITIES) ^ element for element in group)
        # A shift along the tube, or a turn about it, exchanges cosines and sines of waves that are their own mirror images
        # in no other way: those parities are one block.
        merged = (ODD_X if (2 * j % self.period if self.period else j) else 0) | (
            ODD_PHI if (2 * c % self.fold if self.fold else c) else 0
        )
        images = {min(coset ^ part ^ element for element in group) for part in range(4) if part & merged == part}
        coset = min(images)
        return TubeBlock(self._name(j, c, coset, merged, group), j, c, coset, len(images))

    def _name(self, j: int, c: int, coset: int, merged: int, group: frozenset[int]) -> str:
        words = [f"j={j}" if self.period < 2 else f"j={j}/{self.period}"] if self.period != 1 else []
        words += [f"c={c}" if self.fold < 2 else f"c={c}/{self.fold}"] if self.fold != 1 else []
        if not merged:
            for name, part in (("x", ODD_X), ("phi", ODD_PHI)):
                if not any(element & part for element in group) and not (part == ODD_X and self.period == 0):
                    words.append(f"{name} {'odd' if coset & part else 'even'}")
            if PARITIES in {element & PARITIES for element in group} and not any(
                element & PARITIES in (ODD_X, ODD_PHI) for element in group
            ):
                words.append("odd" if coset & PARITIES else "even")
        elif merged == ODD_X and not any(element & ODD_PHI for element in group):
            words.append(f"phi {'odd' if coset & ODD_PHI else 'even'}")
        elif merged == ODD_PHI and self.period and not any(element & ODD_X for element in group):
            words.append(f"x {'odd' if coset & ODD_X else 'even'}")
        if j == c == 0 and any(element & (ODD_P | ODD_B) for element in group):
            halves = {coset ^ element for element in group}
            if not any(element & (ODD_P | ODD_B) == 0 for element in halves):
                words.append("1")
        return " ".join(words)

    def blocks(self, waves: Iterable[tuple[int, int]]) -> dict[TubeBlock, list[Mode]]:
        """All blocks of perturbations with some wave numbers along and around the tube, each with its modes."""
        found: dict[TubeBlock, list[Mode]] = {}
        for mode in product_modes(waves, self.turns):
            block, coset = self._block_of(mode)
            if block.coset == coset:
                found.setdefault(block, []).append(mode)
        return found

    def wave_class(self, block: TubeBlock) -> tuple[int, int, frozenset[int]]:
        """What blocks have in common whose modes are sums of the same waves: they differ in parities alone."""
        if block.j or block.c:
            return block.j, block.c, frozenset()
        return 0, 0, frozenset((block.coset ^ element) & ~PARITIES for element in self.group)

    def _block_of(self, mode: Mode) -> tuple[TubeBlock, int]:
        """The block of a mode, and its own coset, which differs where the block stands for several that are alike."""
        j, c = _class(mode.p, self.period), _class(mode.harmonic, self.fold)
        features = self.features(mode)
        if features is None:
            features = (mode.along == "sin") * ODD_X + (not mode.is_even) * ODD_PHI
        group = self.group if j == c == 0 else self._parity_group
        coset = min((features if j == c == 0 else features & PARITIES) ^ element for element in group)
        return self.block(j, c, features), coset

    def broken_by(self, block: TubeBlock) -> TubeSymmetry:
        """The symmetry of tubes that branch off by a perturbation of a block."""
        # gcd(0, j) = j: what depended on x not at all has the perturbation's period.
        lower = TubeSymmetry(gcd(self.period, block.j), gcd(self.fold, block.c), self.turns, frozenset({0}))
        known = {lower.features(mode) for mode in self.modes((8, 8))}
        few = range(4 * max(lower.period, self.period) + 1), range(4 * max(lower.fold, self.fold) + 1)
        new = {lower.features(mode) for mode in self.blocks(product(*few)).get(block, [])}
        group = {0}
        for element in (known | new) - {None}:
            group |= {element ^ other for other in group}  # type: ignore[operator]
        return TubeSymmetry(lower.period, lower.fold, self.turns, frozenset(group))


def _class(number: int, unit: int) -> int:
    """A wave number modulo a unit, up to its sign."""
    return number if unit == 0 else min(number % unit, -number % unit)


def ring_symmetry(n: int) -> TubeSymmetry:
    """Independent of ``x``, ``n``-fold, even in ``phi``."""
    return TubeSymmetry(0, n, 0, frozenset({0, ODD_B}))


def coil_symmetry(m: int, n: int = 1) -> TubeSymmetry:
    """Unchanged by half a turn about an axis across it, as helical tubes ``r(m k x - n phi)`` are.

    Where their lobes turn whole times on the length, it is independent of ``x`` in a frame that turns as often, whose turning
    is itself odd in ``x`` and in ``phi``. Else no frame of the tube's own length turns with them, and they are tubes of two
    dimensions, among others that are not helical.
    """
    if m % n:
        return TubeSymmetry(m, n, 0, frozenset({0, PARITIES, ODD_P | ODD_B, ODD_P | ODD_B | PARITIES}))
    return TubeSymmetry(0, n, m // n, frozenset({0, PARITIES, ODD_B, ODD_B | PARITIES}))


def buckle_symmetry(m: int, n: int) -> TubeSymmetry:
    """Even in ``x`` and ``phi``, unchanged by a shift by half a wave both ways."""
    return TubeSymmetry(m, n, 0, frozenset({0, ODD_P | ODD_B}))


def pearl_symmetry(m: int) -> TubeSymmetry:
    """Independent of ``phi``, even in ``x``."""
    return TubeSymmetry(m, 0, 0, frozenset({0, ODD_P}))


def axisymmetric_symmetry(m: int) -> TubeSymmetry:
    """Independent of ``phi``, without planes of reflection."""
    return TubeSymmetry(m, 0, 0, frozenset({0, ODD_X, ODD_P, ODD_X | ODD_P}))
