"""Energies as differences from a reference: curves that lie on one another by their energy come apart."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.branch import Branch
from pearlbvp.errors import InputError
from pearlbvp.helfrich import cylinder_energy
from pearlbvp.studies.names import name_of
from pearlbvp.studies.stretches import Piece, pieces

if TYPE_CHECKING:
    import pandas as pd

TUBE = "tube"
"""How the straight tube is named as a reference."""


@dataclass(frozen=True)
class Reference:
    """What energies are compared with at the same reduced volume.

    Attributes:
        words: what it is called.
        branch: of several energies at a volume the least counts; None for the straight tube, which has one only.
    """

    words: str
    branch: Branch[Any] | None = None

    @property
    def difference(self) -> str:
        """What an axis says of energies."""
        return f"E/A less E/A of {self.words}"

    @classmethod
    def of(cls, named: str | Branch[Any], branches: Mapping[str, Branch[Any]] | None = None) -> Reference:
        """A reference by its name.

        Args:
            named: ``tube``, the name of one of the branches, or a branch.
            branches: that are there.

        Raises:
            InputError: there is no such branch.
        """
        if named == TUBE:
            return cls("the straight tube")
        if isinstance(named, str):
            if named not in (branches or {}):
                there = ", ".join([TUBE, *(branches or {})])
                raise InputError("reference", f"there is no {named!r}", f"give one of {there}, or a saved branch")
            named = (branches or {})[named]
        return cls(name_of(named).text, named)

    def above(self, curves: pd.DataFrame) -> pd.DataFrame:
        """A table of points or curves with the differences as ``E``; not a number where the reference has no such volume.

        ``E`` between the reference's points is a cubic in ``v`` with the slopes ``dE/dv = -lambda2/2`` (``studies.stretches``).

        Raises:
            InputError: there is no such volume at all.
        """
        if self.branch is None:
            return curves.assign(E=curves["E"] - curves["c0"].map(cylinder_energy))
        least = self._least(curves["v"].to_numpy(float))
        if not np.isfinite(least).any():
            raise InputError("reference", f"{self.words} has none of the volumes that are drawn", "take another")
        return curves.assign(E=curves["E"] - least)

    def _least(self, v: Array) -> Array:
        """The reference's least energy at some volumes."""
        found = [piece.energies(v) for piece in self._pieces]
        return np.asarray(np.fmin.reduce(found)) if found else np.full(len(v), np.nan)

    @cached_property
    def _pieces(self) -> list[Piece]:
        return [] if self.branch is None else pieces("", self.branch, judged=False)

    def misses(self, branch: Branch[Any]) -> bool:
        """Whether a branch has volumes that the reference does not have."""
        v = np.array([point.value("v") for point in branch.points])
        return self.branch is not None and bool(np.isnan(self._least(v)).any())
