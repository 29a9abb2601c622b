"""Sparse symmetric matrices with dense borders, regular or nearly singular: one factorization of the pinned matrix.

A tube's Hessian has the rigid motions as near kernels, and more at branch points; so it cannot be eliminated first. In two
dimensions a fourth-order problem may be held at points: the matrix without the rows and columns of a few pinned vertices
is far from singular. These join the borders in a small dense Schur complement, which is all that a kernel can make
singular. Inertia adds up over the elimination (E. V. Haynsworth, Linear Algebra Appl. 1 (1968) 73).
"""

from __future__ import annotations

import weakref
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from pearlbvp.arrays import Array, Integers
from pearlbvp.factorization import Factors, factorized
from pearlbvp.representation import brief


def spread(points: Array, count: int) -> Integers:
    """Indices of ``count`` points far from each other: each new one is the farthest from those chosen, shape (count,)."""
    chosen = [0]
    distance = np.linalg.norm(points - points[0], axis=1)
    for _ in range(min(count, len(points)) - 1):
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return np.sort(np.array(chosen, dtype=np.int64))


@dataclass(frozen=True)
class Pinned:
    """A sparse symmetric matrix, factorized but for some rows and columns.

    Attributes:
        matrix: shape (V, V).
        pins: rows and columns that join the borders, shape (P,).
        free: the others.
        factors: those of the matrix at ``free``.
    """

    __repr__ = brief

    matrix: sparse.csc_matrix
    pins: Integers
    free: Integers
    factors: Factors

    @classmethod
    def of(cls, matrix: sparse.csc_matrix, pins: Integers) -> Pinned:
        """Factorize.

        Raises:
            numpy.linalg.LinAlgError: the pinned matrix is singular, or not finite.
        """
        free = np.setdiff1d(np.arange(matrix.shape[0]), pins)
        factors = factorized(matrix[free][:, free].tocsc() if len(pins) else matrix)
        return cls(matrix, pins, free, factors)

    def _eliminated(self, borders: Array) -> Array:
        """``K_ff^{-1} (K_fp, borders_f)``, shape (F, P + s)."""
        return self.factors.solve(np.column_stack((self.matrix[:, self.pins].toarray()[self.free], borders[self.free])))

    def bordered(self, columns: Array, rows: Array, corner: Array) -> Bordered:
        """The matrix ``(K, columns; rows, corner)``; shapes (V, q), (q, V), (q, q).

        Raises:
            numpy.linalg.LinAlgError: it is singular.
        """
        pins, free = self.pins, self.free
        borders = self._eliminated(columns)
        wide = np.column_stack((self.matrix[:, pins].toarray(), columns))  # columns of pins and borders
        lower = np.vstack((self.matrix[pins].toarray(), rows))
        schur = np.vstack((wide[pins], np.column_stack((rows[:, pins], corner)))) - lower[:, free] @ borders
        return Bordered(
            self, columns, rows, corner, borders, lower[:, free], np.asarray(np.linalg.inv(schur), dtype=np.float64)
        )

    def negative(self, rows: Array, corner: Array) -> int:
        """Negative eigenvalues of the matrix ``(K, rows^T; rows, corner)`` beyond one a row.

        Those of the matrix on the vectors that all ``rows``, shape (q, V) and independent, annihilate, where ``corner`` is 0;
        a row whose diagonal entry there is -1 adds its outer product to the matrix instead.

        Raises:
            numpy.linalg.LinAlgError: the factors do not tell.
        """
        borders = self._eliminated(rows.T)
        lower = np.vstack((self.matrix[self.pins].toarray(), rows))
        count = len(self.pins)
        schur = -lower[:, self.free] @ borders
        schur[count:, count:] += corner
        schur[:count, :count] += self.matrix[self.pins][:, self.pins].toarray()
        schur[count:, :count] += rows[:, self.pins]
        schur[:count, count:] += rows[:, self.pins].T
        return self.factors.negative + int((np.linalg.eigvalsh((schur + schur.T) / 2) < 0).sum()) - len(rows)


REFINEMENTS, NEAR, REFINED, ROUNDING = 12, 8.0, 1e-13, 1e-9
"""With the factors of another matrix: most refinements, by how much each has to take the error down, where that is done, and
below what the rounding of large matrices may end it."""


@dataclass(frozen=True)
class Bordered:
    """A pinned matrix with its borders, eliminated.

    Attributes:
        pinned: the matrix.
        columns, rows, corner: its borders.
        eliminated: columns of pins and borders solved for at the free rows.
        lower: rows of pins and borders at the free columns.
        inverse: of the dense Schur complement.
    """

    __repr__ = brief

    pinned: Pinned
    columns: Array
    rows: Array
    corner: Array
    eliminated: Array
    lower: Array
    inverse: Array

    def solve(self, f: Array, g: Array, refinements: int = 1) -> Array:
        """Solve for right-hand sides of shapes (V, s) and (q, s): shape (V + q, s)."""
        found = self._once(f, g)
        for _ in range(refinements):
            found = found + self._missing(f, g, found)
        return found

    def beside(self, matrix: sparse.csc_matrix, columns: Array, rows: Array, corner: Array) -> Bordered:
        """Another matrix with its borders, of the same shapes, to be solved with by these factors: ``refined``."""
        return replace(self, pinned=replace(self.pinned, matrix=matrix), columns=columns, rows=rows, corner=corner)

    def refined(self, f: Array, g: Array) -> Array | None:
        """As ``solve``, with the factors of a matrix that is near: refined until that is at rounding, or None if it is far."""
        found, before = self._once(f, g), 1.0
        for _ in range(REFINEMENTS):
            change = self._missing(f, g, found)
            found = found + change
            left = float((np.abs(change).max(axis=0) / np.abs(found).max(axis=0)).max())
            falls = left < before / NEAR
            if left < REFINED or (left < ROUNDING and not falls):
                return found
            if not falls:
                return None
            before = left
        return None

    def _missing(self, f: Array, g: Array, found: Array) -> Array:
        x, y = np.split(found, [len(f)])
        matrix = self.pinned.matrix
        return self._once(f - matrix @ x - self.columns @ y, g - self.rows @ x - self.corner @ y)

    def _once(self, f: Array, g: Array) -> Array:
        free, pins, count = self.pinned.free, self.pinned.pins, len(self.pinned.pins)
        first = self.pinned.factors.solve(f[free])
        y = self.inverse @ (np.vstack((f[pins], g)) - self.lower @ first)
        x = np.empty_like(f)
        x[free], x[pins] = first - self.eliminated @ y, y[:count]
        return np.vstack((x, y[count:]))


_holders: weakref.WeakSet[Kept] = weakref.WeakSet()


@dataclass(eq=False)
class Kept:
    """Solves with one matrix after another, as Newton's method does: by the factors of an earlier one where that is near.

    Where factors cost as much as many solutions, Newton's second step is a few refinements (N. J. Higham, Accuracy and
    Stability of Numerical Algorithms (SIAM 2002), ch. 12), and yet the step that its own matrix gives, unlike a chord's.
    Factors are large: of all such objects only the one that factorized last keeps them.
    """

    _last: Bordered | None = None

    def __getstate__(self) -> dict[str, object]:
        """Nothing: another process makes factors of its own."""
        return {}

    def solve(
        self, matrix: sparse.csc_matrix, pins: Integers, borders: tuple[Array, Array, Array], f: Array, g: Array
    ) -> Array:
        """As ``Pinned.of(matrix, pins).bordered(*borders).solve(f, g)``."""
        if self._last is not None and self._last.corner.shape == borders[2].shape:
            found = self._last.beside(matrix, *borders).refined(f, g)
            if found is not None:
                return found
        for holder in _holders:
            holder._last = None
        _holders.clear()
        bordered = Pinned.of(matrix, pins).bordered(*borders)
        if bordered.pinned.factors.dear:
            self._last = bordered
            _holders.add(self)
        return bordered.solve(f, g)
