"""Growth rates of a solution by symmetry block: how many perturbations grow, which fastest, and how well that is known."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol, Self

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.representation import brief


class Block(Protocol):
    """A symmetry block of perturbations: a named tuple of whole numbers, words and None, with a name for people (``str``)."""

    @property
    def multiplicity(self) -> int:
        """How often each growth rate of the block occurs."""

    def __hash__(self) -> int: ...


ROUNDING = 1e-12
"""Error of growth rates by the largest of them."""


def neutral_size(rates: Mapping[Any, Array], residual: float) -> float:
    """Size up to which growth rates are zero to their accuracy: ten times the error of exact kernels, and rounding."""
    largest = max((float(np.abs(of_block).max(initial=0.0)) for of_block in rates.values()), default=0.0)
    return 1e-8 + ROUNDING * largest + 10 * residual


@dataclass(frozen=True)
class Spectrum:
    """The leading growth rates of all blocks that can be unstable.

    Attributes:
        rates: of each block the largest, all positive ones among them, largest first, exact kernels left out.
        residual: error of the rates, as the exact kernels (rigid motions) show it; 0 where there are none, NaN if unknown.
        neutral: growth rates up to this size are zero to their accuracy.
        complete: whether all unstable perturbations were counted.
        points: how finely the perturbations were resolved, for rates of one block that are to be comparable.
    """

    __repr__ = brief

    rates: Mapping[Any, Array]
    residual: float
    neutral: float
    complete: bool = True
    points: int = 0

    @classmethod
    def of(cls, rates: Mapping[Any, Array], residual: float, complete: bool = True, points: int = 0) -> Self:
        """Growth rates whose error the exact kernels show."""
        return cls(rates, residual, neutral_size(rates, residual), complete, points)

    @classmethod
    def unknown(cls) -> Self:
        """In the place of growth rates that could not be computed: a start is shown, and saved, all the same."""
        return cls({}, math.nan, 0.0, complete=False)

    @classmethod
    def not_asked(cls) -> Self:
        """In the place of growth rates that nobody wants to know."""
        return cls({}, math.nan, 0.0)

    @property
    def n_unstable(self) -> int:
        """Dimension of the unstable space; at a branch point its neutral perturbation is not counted."""
        return sum(block.multiplicity * int((rates > self.neutral).sum()) for block, rates in self.rates.items())

    @property
    def stable(self) -> bool:
        """Whether all perturbations decay; not where that is unknown."""
        return self.complete and self.n_unstable == 0

    @property
    def critical(self) -> Any:
        """The block of the largest growth rate; empty if none is known."""
        known = [block for block, rates in self.rates.items() if len(rates)]
        return max(known, key=lambda block: float(self.rates[block][0]), default="")

    @property
    def mu_crit(self) -> float:
        """The largest growth rate; NaN if none is known."""
        return float(self.rates[self.critical][0]) if self.critical != "" else math.nan

    def to_tree(self) -> dict[str, Any]:
        """Everything as arrays, numbers and words, to be saved."""
        return {
            "blocks": json.dumps([list(block) for block in self.rates]),
            "rates": np.concatenate([*self.rates.values(), np.zeros(0)]),
            "sizes": np.array([len(rates) for rates in self.rates.values()], dtype=np.int64),
            "residual": self.residual, "neutral": self.neutral, "complete": self.complete, "points": self.points,
        }  # fmt: skip

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any], block: Any) -> Self:
        """The inverse of ``to_tree``; ``block`` is the named tuple that the blocks are."""
        blocks = [block(*entries) for entries in json.loads(tree["blocks"])]
        pieces = np.split(np.asarray(tree["rates"], dtype=float), np.cumsum(tree["sizes"]))[: len(blocks)]
        rates = dict(zip(blocks, pieces, strict=True))
        numbers = float(tree["residual"]), float(tree["neutral"])
        return cls(rates, *numbers, bool(tree["complete"]), int(tree["points"]))
