"""Branches: solutions along a path, and what happens on it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import TYPE_CHECKING, Any, Generic

from pearlbvp.continuation.problem import P
from pearlbvp.continuation.solution import Solution
from pearlbvp.representation import span

if TYPE_CHECKING:
    import pandas as pd


MOST_SPECIAL = 14
"""Special points that are named one by one where a branch is described."""


class Status(Enum):
    """How a branch ends. A reason says it of this one, in words."""

    RUNNING = "running"
    """It has not ended."""
    REACHED = "reached"
    """Where it was asked to."""
    GIVEN = "given"
    """It was not followed: a prediction, or the end of a flow."""
    POINTS = "max_points"
    """It has as many points as were allowed; it can go on."""
    LIMIT = "limit"
    """Where its shapes end, or can be described no further."""
    CONTACT = "contact"
    """Where the surface touches itself; beyond, it would pass through itself."""
    PITCHFORK = "pitchfork"
    """Where it meets a more symmetric branch; beyond, it would repeat its own mirror images."""
    FAILED = "failed"
    """Where something could not be computed."""
    INTERRUPTED = "interrupted"
    """Where somebody stopped it."""


@dataclass(frozen=True)
class SpecialPoint:
    """A point of a branch at which something happens.

    Attributes:
        kind: ``start``, ``bp``, ``fold:NAME``, ``stop``, ``end``, or the name of one of the problem's poles.
        index: place among the branch's points.
        block: symmetry block of the neutral perturbation, for ``bp``.
        change: by how much the number of unstable perturbations of that block changes there.
        converged: whether it was located; if not, it is the computed point that comes after.
        interval: arclength from the computed point before in which it was looked for, and found.
    """

    kind: str
    index: int
    block: Any = None
    change: int = 0
    converged: bool = True
    interval: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Branch(Generic[P]):
    """A branch of solutions with its special points.

    Attributes:
        points: in order along the branch, special points among them.
        special: what happens at some of them.
        reason: why the branch ends.
        complete: whether it ends where it was asked to.
    """

    points: list[Solution[P]]
    special: list[SpecialPoint]
    status: Status
    reason: str
    astray: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return self.described()

    def described(
        self,
        said: Callable[[str], str] = str,
        in_units: Callable[[str, float], float] = lambda _, value: value,
        symbol: Callable[[str], str] = str,
    ) -> str:
        """What it is of, where it leads, what happens on it, why it ends: a few lines.

        Args:
            said: puts a sentence into a user's units.
            in_units: the same of a number, by its name.
            symbol: what the number is called in them.
        """
        problem, count = self.points[-1].problem, len(self.points)
        words = [f"{problem.family} branch", f"{count} point{'s' if count > 1 else ''}"]
        words += [
            f"{symbol(name)} = {span([in_units(name, point.observables[name]) for point in self.points])}"
            for name in problem.headline
        ]
        within = [special for special in self.special if special.kind not in ("start", "stop", "end")]
        lines = [", ".join(words), *(f"  {self._said_of(special)}" for special in within[:MOST_SPECIAL])]
        if len(within) > MOST_SPECIAL:
            lines.append(f"  and {len(within) - MOST_SPECIAL} more special points")
        return "\n".join([*lines, f"  end: {said(self.reason)}"])

    def _said_of(self, special: SpecialPoint) -> str:
        words, solution = [f"point {special.index}: {special.kind}"], self.at(special)
        words += [f"{name} = {solution.observables[name]:.8g}" for name in solution.problem.headline[-1:]]
        words += [str(special.block)] if special.block is not None else []
        words += [f"{special.change:+d} unstable"] if special.change else []
        return ", ".join(words if special.converged else [*words, "not located"])

    @property
    def complete(self) -> bool:
        """Whether it ends where it was asked to."""
        return self.status in (Status.REACHED, Status.GIVEN)

    @property
    def failed(self) -> bool:
        """Whether it ends because something could not be computed, neither by request nor with its shapes."""
        return self.status is Status.FAILED

    def kinds(self, index: int) -> list[str]:
        """All that is special at a point."""
        return [special.kind for special in self.special if special.index == index]

    def find(self, kind: str) -> list[SpecialPoint]:
        """The special points of a kind, in order; ``fold`` finds all folds."""
        return [special for special in self.special if is_of_kind(special.kind, kind)]

    def asked(self, until: Mapping[str, int]) -> SpecialPoint | None:
        """The first of the special points that are wanted, by kind and number, if it is among the branch's."""
        of_kinds = (self.find(kind)[number - 1 : number] for kind, number in until.items())
        return min((s for found in of_kinds for s in found), key=lambda s: s.index, default=None)

    def at(self, special: SpecialPoint) -> Solution[P]:
        """The point of a special point."""
        return self.points[special.index]

    def table(self) -> pd.DataFrame:
        """A row a point: ``point, special``, the observables, ``n_unstable, mu_crit, critical, mu_error``, further numbers.

        ``n_unstable`` is empty where more waves grow than were counted; ``mu_error`` is the error of growth rates, as the
        exact kernels show it.
        """
        import pandas as pd

        rows = []
        for index, entry in enumerate(self.points):
            stability = {
                "n_unstable": entry.spectrum.n_unstable if entry.spectrum.complete else None,
                "mu_crit": entry.spectrum.mu_crit,
                "critical": str(entry.spectrum.critical),
                "mu_error": entry.spectrum.residual,
            }
            what = {"point": index, "special": ",".join(self.kinds(index))}
            rows.append({**what, **entry.observables, **stability, **entry.further})
        return pd.DataFrame(rows).astype({"n_unstable": "Int64"})

    @property
    def ends_at_bifurcation(self) -> bool:
        """Whether what follows the last point leaves a place where branches cross or turn, which is no event ahead of it.

        A branch of one point is its start, of which nothing tells where it lies.
        """
        kinds = self.kinds(len(self.points) - 1)
        return len(self.points) == 1 or any(kind == "bp" or kind.startswith("fold") for kind in kinds)

    def reversed(self) -> Branch[P]:
        """The branch from its last point to its first, tangents turned round. Where it ended, it starts: an ``end``."""
        last = len(self.points) - 1
        points = [entry.turned() for entry in self.points[::-1]]
        special = [replace(s, index=last - s.index, change=-s.change) for s in self.special[::-1]]
        return replace(self, points=points, special=special)

    def without_last(self) -> Branch[P]:
        """The branch without its last point, and what is special there but the end."""
        last = len(self.points) - 2
        kept = [s for s in self.special if s.index <= last] + [SpecialPoint("end", last)]
        return replace(self, points=self.points[:-1], special=kept)

    def extended(self, further: Branch[P]) -> Branch[P]:
        """This branch and one that starts at its last point, as one."""
        offset = len(self.points) - 1
        kept = [s for s in self.special if s.kind not in ("end", "stop") or s.index < offset]
        added = [replace(s, index=s.index + offset) for s in further.special if s.kind != "start"]
        return replace(further, points=self.points + further.points[1:], special=kept + added)


def is_of_kind(kind: str, wanted: str) -> bool:
    """Whether a special point's kind is the wanted one; ``fold`` are all folds."""
    return kind == wanted or kind.split(":")[0] == wanted
