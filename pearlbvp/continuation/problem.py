"""What continuation asks of a problem, whatever it is and however it is discretized."""

from __future__ import annotations

from typing import Any, Protocol

from pearlbvp.arrays import Array


class Problem(Protocol):
    """An underdetermined system ``residual(u) = 0``: one equation fewer than unknowns, so its solutions are curves."""

    def residual(self, u: Array) -> Array:
        """The equations at ``u``, shape (size - 1,)."""

    def solve(self, u: Array, rhs: Array, row: Array | None = None) -> Array:
        """Solve with the residual's Jacobian at ``u``, bordered below by the row ``inner(row, .)``, or by several.

        ``rhs`` has shape (size,) or (size, s), ``row`` (size,) or (k, size).
        Raises ``numpy.linalg.LinAlgError`` where the matrix is singular.
        """

    def inner(self, u: Array, v: Array) -> float:
        """Inner product of two unknowns, much the same on every mesh."""

    def observables(self, u: Array) -> dict[str, float]:
        """Named numbers of a solution, for tables and stopping conditions."""

    def remesh(self, u: Array, *others: Array) -> tuple[Any, list[Array]] | None:
        """The same problem on a mesh fitted to ``u``, all vectors moved there; None where there is no need."""

    def adopt(self, other: Any, u: Array) -> Array:
        """An unknown that lives on the mesh of ``other``, the same problem, moved onto this one's mesh."""
