"""What continuation asks of a problem, whatever it is and however it is discretized.

A problem is what it is by its equations; that its solutions have a stability, live in larger spaces or have parameters that may
be freed is up to it: what it does not say, it does without.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, Self, TypeVar

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.errors import InputError


class LiftError(ValueError):
    """Perturbations of a block lead to shapes that the problem cannot describe; the message says which."""


class Problem(ABC):
    """An underdetermined system ``residual(u) = 0``: one equation fewer than unknowns, so its solutions are curves."""

    @property
    def family(self) -> str:
        """What its solutions are, in a word."""
        return "nameless"

    stored_as: ClassVar[str] = ""
    """What files call such problems."""

    block: ClassVar[Any] = None
    """The named tuple that its symmetry blocks are, to read them back."""

    @property
    def shapes(self) -> Any:
        """The problem whose solutions these are: of a curve of special solutions, the one that all are solutions of."""
        return self

    headline: ClassVar[tuple[str, ...]] = ()
    """Observables by which a branch is described in a line; the last says where on it a point is."""

    # The equations.

    @abstractmethod
    def residual(self, u: Array) -> Array:
        """The equations at ``u``, shape (size - 1,)."""

    @abstractmethod
    def solve(self, u: Array, rhs: Array, row: Array | None = None) -> Array:
        """Solve with the residual's Jacobian at ``u``, bordered below by the row ``inner(row, .)``, or by several.

        ``rhs`` has shape (size,) or (size, s), ``row`` (size,) or (k, size).

        Raises:
            numpy.linalg.LinAlgError: the matrix is singular.
        """

    @abstractmethod
    def inner(self, u: Array, v: Array) -> float:
        """Inner product of two unknowns, much the same on every mesh."""

    @abstractmethod
    def observables(self, u: Array) -> dict[str, float]:
        """Named numbers of a solution, for tables and stopping conditions."""

    def further(self, u: Array) -> dict[str, float]:
        """Numbers that tables and stopping conditions may ask for, and no step needs."""
        return {}

    def remesh(self, u: Array, *others: Array) -> tuple[Self, list[Array]] | None:
        """The same problem on a mesh fitted to ``u``, all vectors moved there; None where there is no need."""
        return None

    def transfer(self, other: Self, u: Array) -> Array:
        """An unknown that lives on the mesh of ``other``, the same problem, moved onto this one's mesh."""
        return u

    def limit(self, observed: Mapping[str, float], spectrum: Spectrum) -> str | None:
        """Why a branch ends at a solution with these observables and growth rates: its shapes end there. Else None.

        Raises:
            SpectrumError: the growth rates are not known well enough to go on counting.
        """
        return None

    def clearance(self, u: Array) -> float:
        """How far a surface is from touching itself: negative where it passes through itself, -inf where no more is known.

        Branches end where it is 0, and where it is -inf at the last point before.
        """
        return math.inf

    @property
    def walls(self) -> Mapping[str, tuple[float, str]]:
        """Observables with values at which every branch ends, exactly there, and why."""
        return {}

    # Stability.

    @property
    def trivial_block(self) -> Any:
        """The block of perturbations that keep the symmetry of the problem's solutions."""
        return ""

    @property
    def conserved(self) -> str:
        """The one observable that perturbations keep and the branch does not; empty where there are none or several.

        Where it turns, a growth rate of ``trivial_block`` changes its sign, and nowhere else on a smooth branch.
        """
        return ""

    @property
    def constant(self) -> Mapping[str, str]:
        """Observables that are the same all along the branch, and what to do where they are to vary."""
        return {}

    def poles(self, u: Array) -> Mapping[str, float]:
        """Named functions at whose zeros growth rates pass through infinity; those that are regular there."""
        return {}

    def spectrum(self, u: Array) -> Spectrum:
        """Growth rates in all symmetry blocks."""
        return Spectrum.of({}, 0.0)

    def block_rates(self, u: Array, block: Any, like: Spectrum) -> Array:
        """Growth rates in one block, largest first, resolved as in another spectrum."""
        return self.spectrum(u).rates[block]

    # Larger spaces.

    def lift(self, block: Any, centre: str, *vectors: Array) -> tuple[Problem, list[Array]]:
        """The problem in whose space the perturbations of a block live, and vectors moved into it.

        Args:
            block: one of the problem's symmetry blocks.
            centre: where the new shapes are centred, where the block leaves the choice: ``pearl`` or ``neck``.
            vectors: a solution, then solutions or tangents.

        Raises:
            LiftError: the perturbations of the block cannot be followed.
        """
        return self, list(vectors)

    def is_upper_half(self, direction: Array) -> bool:
        """Which of the two halves of a pitchfork a direction leads to: the one on which the shape grows at its centre."""
        return True

    # Parameters.

    @property
    def free(self) -> tuple[str, ...]:
        """Names of the parameters that end every unknown."""
        return ()

    def place(self, name: str) -> int:
        """Place of a free parameter in every unknown, counted from its end."""
        return self.free.index(name) - len(self.free)

    def plain(self, *vectors: Array) -> tuple[Self, list[Array]]:
        """The problem and vectors of it with the parameters themselves as unknowns, whatever chart it uses."""
        return self, list(vectors)

    def freeing(self, u: Array, *free: str) -> tuple[Self, Array]:
        """The same solution with other parameters free: to vary one while another stays as it is.

        Raises:
            InputError: the problem has no parameters that could be freed.
        """
        raise InputError("vary", f"{' and '.join(free)} cannot vary on this branch", "follow another from another tube")

    def with_one_more_free(self, name: str, u: Array, tangent: Array) -> tuple[Self, list[Array], int]:
        """The problem with one more parameter free, a solution and a tangent of it moved there, and that one's place."""
        if name in self.free:
            raise ValueError(f"second: {name!r} is free already")
        plain, (u, tangent) = self.plain(u, tangent)
        problem, moved = plain.freeing(u, *(other for other in plain.free if other in plain.varied), name)
        place = moved.size + problem.place(name)
        return problem, [moved, np.insert(tangent, place, 0.0)], place

    @property
    def varied(self) -> tuple[str, ...]:
        """Those of ``free`` that ``freeing`` takes; the others are unknowns on every branch."""
        return self.free

    # Files.

    def to_tree(self) -> dict[str, Any]:
        """Everything as arrays, numbers and words, to be saved.

        Raises:
            InputError: such problems are not saved.
        """
        raise InputError("save", "a curve of special points cannot be saved", "write its table")

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> Self:
        """The inverse of ``to_tree``.

        Raises:
            ValueError, LookupError, TypeError: the tree describes no such problem.
        """
        raise ValueError(f"{cls.__name__} is of no kind that is saved")


P = TypeVar("P", bound=Problem)
