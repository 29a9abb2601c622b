"""Where do wrinkled tubes lose stability to waves along the tube? (Paper: oblates embedded in wrinkling.)

The rings of ``n`` lobes are one curve of exact solutions (``theory.elastica``), the same for every tube; a wave grows or
decays by its wave number ``k`` alone. So one family of matrices along that curve answers for tubes of every length, with no
continuation: a branch on a tube of length ``L`` has its branch points at ``k = 2 pi j/L``.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, finite
from pearlbvp.numbers import as_numbers
from pearlbvp.representation import brief
from pearlbvp.roots import root
from pearlbvp.stability.planar import MOST_WAVES, PlanarBlock, PlanarVariation, PlaneProfile, classes_of, resolved
from pearlbvp.theory.elastica import ElasticRing, lobes, ring_at_angle, touching_ring

if TYPE_CHECKING:
    import pandas as pd

SHAPE = ["lambda1", "lambda2", "v", "E", "amplitude", "r_min", "r_max"]
COLUMNS = ["c0", "n", "L", "status", "j", "k", "block", *SHAPE, "message"]
NEUTRAL_COLUMNS = ["c0", "n", "k", "block", "change", *SHAPE]

SAMPLES = 48
"""Rings from the circle to self-contact among which signs of growth rates are compared; a wave that grows only between two
neighbours is not seen."""


@dataclass(frozen=True)
class Neutral:
    """A ring at which a wave is neutral.

    Attributes:
        ring: the ring.
        block: its class; ``j`` is 0 where only the wave number counts.
        k: wave number.
        change: by how much the number of growing waves of that class changes there, towards self-contact.
    """

    ring: ElasticRing
    block: PlanarBlock
    k: float
    change: int


def exact_profile(ring: ElasticRing, c0: float) -> PlaneProfile:
    """An exact ring as what stability is computed of."""
    return PlaneProfile(ring.states, ring.n, c0, ring.lambda1(c0), ring.lambda2)


def shape_of(ring: ElasticRing, c0: float) -> dict[str, float]:
    """The columns ``SHAPE`` of an exact ring."""
    tip, waist = np.abs(ring.position(np.array([0.0, math.pi / ring.n])))
    radii = sorted((float(tip), float(waist)))
    return {
        "lambda1": ring.lambda1(c0), "lambda2": ring.lambda2, "v": ring.v, "E": ring.energy(c0),
        "amplitude": (radii[1] - radii[0]) / 2, "r_min": radii[0], "r_max": radii[1],
    }  # fmt: skip


@dataclass(frozen=True)
class ExactRings:
    """The rings of ``n`` lobes from the circle to self-contact, sampled for the growth rates of all waves.

    Attributes:
        c0: spontaneous curvature.
        n: number of lobes.
    """

    __repr__ = brief

    c0: float
    n: int
    _matrices: dict[tuple[int, str | None], tuple[Array, Array]] = field(default_factory=dict, repr=False)

    @cached_property
    def angles(self) -> Array:
        """``theta`` of the samples, the circle first: growth rates are smooth in it, even there."""
        least, most = math.asin(1 / self.n), touching_ring(self.n).theta
        return np.asarray(least + (most - least) * np.linspace(0, 1, SAMPLES) ** 2)

    @cached_property
    def points(self) -> int:
        """Points of a lobe that resolve the ring at self-contact, and all before it."""
        return len(resolved(exact_profile(touching_ring(self.n), self.c0))[0].psi)

    @cached_property
    def variations(self) -> list[PlanarVariation]:
        """The second variations of the samples."""
        return [self._variation(theta) for theta in self.angles]

    def _variation(self, theta: float) -> PlanarVariation:
        return PlanarVariation.of(exact_profile(ring_at_angle(self.n, float(theta)), self.c0), self.points)

    def rates(self, c: int, parity: str | None, k: float) -> Array:
        """Largest growth rates of a class at a wave number on each sample, largest first, shape (SAMPLES, 6).

        At ``k = 0`` the circle, where the rings' own wave is neutral and a rotation is none, has those of the ring next to it.
        """
        if k == 0:
            resting = [self._at(variation, c, parity, k) for variation in self.variations[1:]]
            return np.array([resting[0], *resting])
        key = c, parity
        if key not in self._matrices:
            pairs = [variation.matrices(c, parity) for variation in self.variations]
            self._matrices[key] = np.array([pair[0] for pair in pairs]), np.array([pair[1] for pair in pairs])
        at_rest, by_square = self._matrices[key]
        found = np.linalg.eigvalsh(at_rest + k**2 * by_square)[:, ::-1][:, :6] - k**4 / 2
        return np.asarray(found)

    @staticmethod
    def _at(variation: PlanarVariation, c: int, parity: str | None, k: float) -> Array:
        return variation.rates_at(c, parity, np.array([k]))[0][:6]

    def neutral(self, c: int, parity: str | None, k: float, first: bool = False) -> list[Neutral]:
        """The rings at which a wave of a class is neutral, from the circle on; only those in the first step, if wanted."""
        rates = self.rates(c, parity, k)
        count = (rates > 0).sum(axis=1)
        found: list[Neutral] = []
        for step in np.flatnonzero(np.diff(count)):
            for place in range(*sorted((int(count[step]), int(count[step + 1])))):

                def rate(theta: float, place: int = place) -> float:
                    return float(self._at(self._variation(theta), c, parity, k)[place])

                theta = root(rate, float(self.angles[step]), float(self.angles[step + 1]), 1e-14)
                block = PlanarBlock(0, c, self.n, parity)
                waves = (2 if k else 1) * block.multiplicity
                change = waves if count[step + 1] > count[step] else -waves
                found.append(Neutral(ring_at_angle(self.n, float(theta)), block, k, change))
            if first:
                break
        return sorted(found, key=lambda neutral: neutral.ring.theta)

    def first_loss(self, length: float) -> tuple[str, Neutral | None, str]:
        """Status, neutral ring and message of the first loss of stability on a tube of a length."""
        growing, candidates = [], []
        most = max(variation.most_waves(length) for variation in self.variations)
        if most > MOST_WAVES:
            raise InputError(
                "lengths", f"on L = {length:g} more than {MOST_WAVES} waves may grow", "take a shorter tube"
            )
        for c, parity in classes_of(self.n):
            for j in range(most + 1):
                k = 2 * math.pi * j / length
                largest_rates = self.rates(c, parity, k)[:, 0]
                block = PlanarBlock(j, c, self.n, parity)
                if largest_rates[0] > 0:
                    growing.append((float(largest_rates[0]), block))
                elif (largest_rates > 0).any():
                    candidates.append((int(np.argmax(largest_rates > 0)), block, k))
        if growing:
            rate, block = max(growing)
            return "unstable_at_onset", None, f"waves {block} grow from the beginning, at a rate of {rate:.3g}"
        if not candidates:
            return "none_in_range", None, "the rings are stable to self-contact"
        earliest = min(step for step, *_ in candidates)
        lost = []
        for step, block, k in candidates:
            if step == earliest:
                neutral = self.neutral(block.c, block.parity, k, first=True)[0]
                lost.append(Neutral(neutral.ring, block, k, block.multiplicity))
        return "found", min(lost, key=lambda neutral: neutral.ring.theta), ""


def ring_onsets(c0: float, n: int, lengths: float | str | Iterable[float]) -> pd.DataFrame:
    """Where the rings of ``n`` lobes lose stability, for tubes of all lengths.

    Args:
        c0: spontaneous curvature.
        n: number of lobes, from 2 on.
        lengths: tube lengths in radii: a number, several, or a text like ``5:50:2.5``.

    Returns:
        A row a length with the columns ``COLUMNS``. ``status`` is ``found`` (``j`` waves of wave number ``k`` along the tube
        become unstable at these ``v`` and ``lambda2``, the first to do so), ``unstable_at_onset`` or ``none_in_range`` (stable
        to self-contact).

    Raises:
        InputError: an argument that cannot be used.
    """
    import pandas as pd

    rings = ExactRings(finite("c0", c0), lobes(n))
    rows = []
    for length in as_numbers("lengths", lengths):
        tube = Tube(rings.c0, length)
        status, neutral, message = rings.first_loss(tube.length)
        row: dict[str, Any] = {"c0": tube.c0, "n": rings.n, "L": tube.length, "status": status, "message": message}
        if neutral is not None:
            row |= {
                "j": neutral.block.j,
                "k": neutral.k,
                "block": str(neutral.block),
                **shape_of(neutral.ring, tube.c0),
            }
        rows.append(row)
    return pd.DataFrame(rows, columns=COLUMNS).astype({"j": "Int64"})


def neutral_rings(c0: float, n: int, wave_numbers: float | str | Iterable[float]) -> pd.DataFrame:
    """All rings of ``n`` lobes, to self-contact, at which a wave of given wave number along the tube is neutral.

    Args:
        c0: spontaneous curvature.
        n: number of lobes, from 2 on.
        wave_numbers: ``k``, above 0.

    Returns:
        A row a neutral wave with the columns ``NEUTRAL_COLUMNS``; ``change`` is that of the number of growing waves, both
        directions along the tube counted, towards self-contact.

    Raises:
        InputError: an argument that cannot be used.
    """
    import pandas as pd

    rings = ExactRings(finite("c0", c0), lobes(n))
    rows: list[dict[str, Any]] = []
    for k in as_numbers("wave_numbers", wave_numbers):
        if k <= 0:
            raise InputError("wave_numbers", f"{k:g} must be above 0", "give some like 0.1:1:0.1")
        for c, parity in classes_of(rings.n):
            for neutral in rings.neutral(c, parity, k):
                name = str(neutral.block).split(" ", 1)[1]
                row = {"c0": rings.c0, "n": rings.n, "k": k, "block": name, "change": neutral.change}
                rows.append(row | shape_of(neutral.ring, rings.c0))
    return pd.DataFrame(rows, columns=NEUTRAL_COLUMNS).sort_values(
        ["k", "v"], ascending=[True, False], ignore_index=True
    )
