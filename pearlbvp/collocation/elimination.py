"""Solution of the linear systems of Gauss collocation, with every border kept outside the block structure.

The unknowns are the values ``y`` of a piecewise polynomial (``N`` intervals, ``m + 1`` points each, shared ends) and
the parameters ``p``. Rows and columns, drawn for ``N = 3``; ``e`` are the extra columns (parameters, right-hand sides)::

    y_0 int y_1 int y_2 int y_3 | e
    [ x  x   x                  | x ]   collocation, interval 0: m*n rows
    [        x  x   x           | x ]   collocation, interval 1
    [                x  x   x   | x ]   collocation, interval 2
    [ x                     x   | x ]   boundary conditions
    [ x  x   x  x   x   x   x   | x ]   borders: integral conditions, the row of a continuation

1. In each interval the interior values are eliminated by LU with partial pivoting among its collocation rows: ``n``
   rows remain that couple ``y_i``, ``y_{i+1}`` and ``e``.
2. From left to right ``y_1 ... y_{N-1}`` are eliminated by Householder reflections of two neighbouring blocks (n rows
   each), which is stable whatever grows or decays along the way (S. J. Wright, SIAM J. Sci. Stat. Comput. 13 (1992) 742).
3. What is left is a dense system for ``y_0``, ``y_N`` and ``p``. Its first ``n`` rows, ``A_0 y_0 + A_1 y_N = ...``, hold
   the monodromy matrix ``-A_1^{-1} A_0`` of a periodic problem (T. F. Fairgrieve, A. D. Jepson, SIAM J. Numer. Anal. 28
   (1991) 1446).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pearlbvp.collocation.scheme import Array, Scheme
from pearlbvp.compiled import compiled


class LinearSystem(NamedTuple):
    """A linearised collocation problem: ``N`` intervals, ``m`` Gauss points, ``n`` states, ``k`` parameters.

    Attributes:
        h: lengths of the intervals, shape (N,).
        jacobian: derivative of the ODE's right-hand side at the Gauss points, shape (N*m, n, n).
        parameter_jacobian: its derivative by the parameters there, shape (N*m, n, k).
        boundary: derivatives of the boundary conditions by ``y_0``, ``y_N`` and ``p``, shapes (b, n), (b, n), (b, k).
        borders: densities of the border rows at the Gauss points, shape (N*m, c, n): a row is
            ``integral of density . y dt + borders_p . p``.
        borders_p: their entries in the parameters' columns, shape (c, k).
        mass: factors of the derivatives ``y'`` in the ODE's equations, shape (n,).
    """

    h: Array
    jacobian: Array
    parameter_jacobian: Array
    boundary: tuple[Array, Array, Array]
    borders: Array
    borders_p: Array
    mass: Array


@compiled
def _condense(derivatives, values, weights, h, jacobian, extra, borders, mass):  # type: ignore[no-untyped-def]
    """Step 1 in every interval and step 2 along them; see the module's docstring.

    ``extra`` has shape (N*m, n, e). Returns the eliminated rows of each interval, those of each inner mesh point, the
    last block row (n, 2n + e) on ``y_0, y_N, e``, and the borders (c, 2n + e) on the same.
    """
    intervals, m = h.size, weights.size
    n, e = jacobian.shape[1], extra.shape[2]
    c = borders.shape[1]
    inner = n * (m - 1)
    rows, width = n * m, n * (m + 1) + e
    pivots = np.zeros((intervals, inner, width))
    chain = np.zeros((intervals, n, 3 * n + e))
    block = np.zeros((n, 2 * n + e))
    border = np.zeros((c, 3 * n + e))  # columns: y_i (the current mesh point), y_0, y_{i+1}, e
    local = np.zeros((rows + c, width))  # columns: interior values, y_i, y_{i+1}, e
    stack = np.zeros((2 * n, 3 * n + e))  # columns: y_i, y_0, y_{i+1}, e
    products = np.zeros(3 * n + e)
    for i in range(intervals):
        local[:, :] = 0.0
        for j in range(m + 1):
            if j == 0:
                first = inner
            elif j == m:
                first = inner + n
            else:
                first = (j - 1) * n
            for g in range(m):
                factor = h[i] * values[g, j]
                for row in range(n):
                    for column in range(n):
                        local[g * n + row, first + column] = -factor * jacobian[i * m + g, row, column]
                    local[g * n + row, first + row] += mass[row] * derivatives[g, j]
                factor *= weights[g]
                for row in range(c):
                    for column in range(n):
                        local[rows + row, first + column] += factor * borders[i * m + g, row, column]
        for g in range(m):
            for row in range(n):
                for column in range(e):
                    local[g * n + row, inner + 2 * n + column] = h[i] * extra[i * m + g, row, column]
        for k in range(inner):
            best = k
            for row in range(k + 1, rows):
                if abs(local[row, k]) > abs(local[best, k]):
                    best = row
            if best != k:
                for column in range(k, width):
                    swap = local[k, column]
                    local[k, column] = local[best, column]
                    local[best, column] = swap
            pivot = local[k, k + 1 :]
            for row in range(k + 1, rows + c):
                factor = local[row, k] / local[k, k]
                if factor != 0.0:
                    target = local[row, k + 1 :]
                    for column in range(pivot.size):
                        target[column] -= factor * pivot[column]
        pivots[i] = local[:inner]

        if i == 0:
            block[:, :] = local[inner:rows, inner:]
            border[:, n:] = local[rows:, inner:]
            continue
        stack[:, :] = 0.0
        for row in range(n):
            for column in range(n):
                stack[row, column] = block[row, n + column]
                stack[row, n + column] = block[row, column]
                stack[n + row, column] = local[inner + row, inner + column]
                stack[n + row, 2 * n + column] = local[inner + row, inner + n + column]
            for column in range(e):
                stack[row, 3 * n + column] = block[row, 2 * n + column]
                stack[n + row, 3 * n + column] = local[inner + row, inner + 2 * n + column]
        for k in range(n):
            norm = 0.0
            for row in range(k, 2 * n):
                norm += stack[row, k] ** 2
            norm = np.sqrt(norm)
            alpha = -norm if stack[k, k] > 0.0 else norm
            reflector = stack[k:, k].copy()
            reflector[0] -= alpha
            square = 0.0
            for row in range(2 * n - k):
                square += reflector[row] ** 2
            if square == 0.0:
                continue
            products[:] = 0.0
            for row in range(2 * n - k):
                source = stack[k + row]
                for column in range(source.size):
                    products[column] += reflector[row] * source[column]
            for row in range(2 * n - k):
                source, factor = stack[k + row], 2.0 * reflector[row] / square
                for column in range(source.size):
                    source[column] -= factor * products[column]
            for row in range(k + 1, 2 * n):
                stack[row, k] = 0.0
        chain[i] = stack[:n]
        block[:, :] = stack[n:, n:]

        for row in range(c):
            for column in range(n):  # the old y_{i+1} is the new y_i
                border[row, column] = border[row, 2 * n + column] + local[rows + row, inner + column]
                border[row, 2 * n + column] = local[rows + row, inner + n + column]
            for column in range(e):
                border[row, 3 * n + column] += local[rows + row, inner + 2 * n + column]
            for k in range(n):
                factor = border[row, k] / stack[k, k]
                for column in range(k, 3 * n + e):
                    border[row, column] -= factor * stack[k, column]
    return pivots, chain, block, border[:, n:].copy()


@compiled
def _substitute(pivots, chain, ends, parameters, n, m):  # type: ignore[no-untyped-def]
    """Back-substitution: the values at all points, shape (s, N*m + 1, n), from those at both ends, (s, 2n).

    ``parameters`` has shape (s, k). The last ``s`` of the extra columns are the right-hand sides.
    """
    intervals, inner = pivots.shape[0], pivots.shape[1]
    sides, k = parameters.shape
    y = np.zeros((sides, intervals * m + 1, n))
    for s in range(sides):
        y[s, 0] = ends[s, :n]
        y[s, intervals * m] = ends[s, n:]
        for i in range(intervals - 1, 0, -1):
            for row in range(n - 1, -1, -1):
                value = chain[i, row, 3 * n + k + s]
                for column in range(k):
                    value -= chain[i, row, 3 * n + column] * parameters[s, column]
                for column in range(n):
                    value -= chain[i, row, n + column] * y[s, 0, column]
                    value -= chain[i, row, 2 * n + column] * y[s, (i + 1) * m, column]
                for column in range(row + 1, n):
                    value -= chain[i, row, column] * y[s, i * m, column]
                y[s, i * m, row] = value / chain[i, row, row]
        for i in range(intervals):
            for row in range(inner - 1, -1, -1):
                value = pivots[i, row, inner + 2 * n + k + s]
                for column in range(k):
                    value -= pivots[i, row, inner + 2 * n + column] * parameters[s, column]
                for column in range(n):
                    value -= pivots[i, row, inner + column] * y[s, i * m, column]
                    value -= pivots[i, row, inner + n + column] * y[s, (i + 1) * m, column]
                for column in range(row + 1, inner):
                    value -= pivots[i, row, column] * y[s, i * m + 1 + column // n, column % n]
                y[s, i * m + 1 + row // n, row % n] = value / pivots[i, row, row]
    return y


def solve(scheme: Scheme, system: LinearSystem, defects: Array, conditions: Array) -> tuple[Array, Array]:
    """Solve ``mass y' - jacobian y - parameter_jacobian p = defects``, with boundary and border rows ``= conditions``.

    Args:
        scheme: the collocation scheme.
        system: the matrix; ``b + c = n + k`` conditions make it square.
        defects: right-hand sides at the Gauss points, shape (N*m, n, s).
        conditions: those of the boundary rows, then of the border rows, shape (b + c, s).

    Returns:
        The values, shape (s, N*m + 1, n), and the parameters, shape (s, k).

    Raises:
        numpy.linalg.LinAlgError: the matrix is singular to working precision.
    """
    n, k = system.parameter_jacobian.shape[1:]
    extra = np.ascontiguousarray(np.concatenate((-system.parameter_jacobian, defects), axis=2))
    pivots, chain, block, border = _condense(
        scheme.derivatives, scheme.values, scheme.weights, system.h, system.jacobian, extra, system.borders, system.mass
    )
    ends = 2 * n + k
    borders_from = ends - len(border)
    matrix = np.empty((ends, ends))
    matrix[:n] = block[:, :ends]
    matrix[n:borders_from, :n], matrix[n:borders_from, n : 2 * n], matrix[n:borders_from, 2 * n :] = system.boundary
    matrix[borders_from:] = border[:, :ends]
    matrix[borders_from:, 2 * n :] += system.borders_p
    known = np.empty((ends, defects.shape[2]))
    known[:n] = block[:, ends:]
    known[n:] = conditions
    known[borders_from:] += border[:, ends:]
    if not np.isfinite(matrix).all():
        raise np.linalg.LinAlgError("the collocation matrix has entries that are not finite")
    dense = np.linalg.solve(matrix, known).T
    parameters = np.ascontiguousarray(dense[:, 2 * n :])
    y = _substitute(pivots, chain, np.ascontiguousarray(dense[:, : 2 * n]), parameters, n, scheme.m)
    return y, parameters


def transfer_pencil(scheme: Scheme, h: Array, jacobian: Array) -> tuple[Array, Array]:
    """Matrices with ``A_0 y(0) + A_1 y(1) = 0`` for all solutions of ``y' = jacobian y``, each of shape (n, n).

    The pair stays accurate where the transfer matrix ``-A_1^{-1} A_0`` itself overflows or is ill-conditioned.
    """
    n = jacobian.shape[1]
    empty = np.zeros((len(jacobian), n, 0))
    _, _, block, _ = _condense(
        scheme.derivatives,
        scheme.values,
        scheme.weights,
        h,
        jacobian,
        empty,
        np.zeros((len(jacobian), 0, n)),
        np.ones(n),
    )
    return block[:, :n].copy(), block[:, n:].copy()
