"""What random starts came to, and the branches that they and others led to beside those that are known."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from pearlbvp.continuation.branch import Branch
from pearlbvp.studies.stretches import Piece, pieces

UNSTABLE = "unstable"
"""Among what random starts came to: shapes on no known branch that perturbations of lower symmetry lead away from."""


@dataclass
class Search:
    """It grows from start to start.

    Attributes:
        branches: those that are known, by name; what starts lead to is called ``start 1``, ``start 2`` and so on.
        pieces: of all branches.
        rested: how many starts came to rest on each branch, and on none (``UNSTABLE``).
        restless: why others came not to rest, and how many.
        origins: where the branches that starts lead to meet others; empty where that is not known.
    """

    branches: dict[str, Branch[Any]]
    pieces: list[Piece]
    rested: Counter[str] = field(default_factory=Counter)
    restless: Counter[str] = field(default_factory=Counter)
    origins: dict[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, branches: Mapping[str, Branch[Any]]) -> Search:
        """Branches from which to begin."""
        found = cls({}, [])
        for name, branch in branches.items():
            found.add(name, branch)
        return found

    def add(self, name: str, branch: Branch[Any]) -> None:
        """One more branch."""
        self.branches[name] = branch
        self.pieces += pieces(name, branch)

    @property
    def relaxed(self) -> int:
        """How many starts were relaxed."""
        return self.rested.total() + self.restless.total()
