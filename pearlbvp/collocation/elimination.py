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
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.collocation.scheme import Scheme
from pearlbvp.compiled import compiled


class LinearSystem(NamedTuple):
    """A linearised collocation problem: ``N`` intervals, ``m`` Gauss points, ``n`` states, ``k`` parameters.

    Of all parameters only ``f`` are unknowns: ``free`` says which.

    Attributes:
        h: lengths of the intervals, shape (N,).
        jacobian: derivative of the ODE's right-hand side at the Gauss points, shape (N*m, n, n).
        parameter_jacobian: its derivative by the parameters there, shape (N*m, n, k).
        mass: factors of the derivatives ``y'`` in the ODE's equations, shape (n,).
        at_start, at_end, boundary_p: derivatives of the boundary conditions by ``y_0``, ``y_N`` and the parameters, shapes
            (b, n), (b, n), (b, k).
        densities, densities_p: derivatives of the integral conditions' integrands at the Gauss points, shapes (N*m, c, n)
            and (N*m, c, k).
        free: places of the unknown parameters, shape (f,), integers.
        rows: further borders, shape (r, (N*m + 1)*n + f): unknowns whose inner product with the solution is given,
            ``integral of row_y . y dt + row_p . p``.
    """

    h: Array
    jacobian: Array
    parameter_jacobian: Array
    mass: Array
    at_start: Array
    at_end: Array
    boundary_p: Array
    densities: Array
    densities_p: Array
    free: NDArray[np.intp]
    rows: Array


@compiled
def _eliminate(matrix, columns, rows):  # type: ignore[no-untyped-def]
    """LU in place of the first ``columns`` columns, pivots among the first ``rows`` rows; those below are reduced too.

    Returns the sign of the determinant of what was factorised.
    """
    height, width = matrix.shape
    copy = np.empty(width)  # it overlaps nothing: so the compiler vectorizes the inner loop, which counts from zero
    sign = 1.0
    for k in range(columns):
        best, largest = k, abs(matrix[k, k])
        for row in range(k + 1, rows):
            size = abs(matrix[row, k])
            if size > largest:
                best, largest = row, size
        pivot, source, target = copy[k:], matrix[best, k:], matrix[k, k:]
        for column in range(pivot.size):
            pivot[column] = source[column]
            source[column] = target[column]
            target[column] = pivot[column]
        if (best != k) != (pivot[0] < 0.0):
            sign = -sign
        reciprocal = 1.0 / pivot[0]
        for row in range(k + 1, height):
            factor, target = matrix[row, k] * reciprocal, matrix[row, k:]
            for column in range(1, pivot.size):
                target[column] -= factor * pivot[column]
    return sign


@compiled
def _reflect(stack, n):  # type: ignore[no-untyped-def]
    """Upper triangle of the first ``n`` columns of ``2n`` rows by Householder reflections, in place.

    Returns the sign of the determinant of the reflections and of the triangle's diagonal together.
    """
    width = stack.shape[1]
    reflector, products = np.empty(2 * n), np.empty(width)
    sign = 1.0
    for k in range(n):
        norm = 0.0
        for row in range(k, 2 * n):
            norm += stack[row, k] ** 2
        norm = np.sqrt(norm)
        alpha = -norm if stack[k, k] > 0.0 else norm
        if alpha > 0.0:  # a reflection, and a negative entry of the diagonal, each change the determinant's sign
            sign = -sign
        square = 0.0
        for row in range(k, 2 * n):
            reflector[row] = stack[row, k] - (alpha if row == k else 0.0)
            square += reflector[row] ** 2
        if square == 0.0:
            continue
        for column in range(width):
            products[column] = 0.0
        for row in range(k, 2 * n):
            factor, source = reflector[row], stack[row]
            for column in range(width):
                products[column] += factor * source[column]
        for row in range(k, 2 * n):
            factor, target = 2.0 * reflector[row] / square, stack[row]
            for column in range(width):
                target[column] -= factor * products[column]
        for row in range(k + 1, 2 * n):
            stack[row, k] = 0.0
    return sign


@compiled
def _condense(derivatives, values, weights, system, rhs):  # type: ignore[no-untyped-def]
    """Steps 1 and 2, and the matrix of step 3 factorised; see the module's docstring.

    Returns:
        The eliminated rows of each interval, those of each inner mesh point, the block row (n, 2n + e) that is left on ``y_0,
        y_N, e``, the dense matrix (2n + k, 2n + e) after its elimination, and the sign of the determinant of all that was
        eliminated. With fewer conditions than unknowns the dense matrix is left as it is.
    """
    h, jacobian, by_p, mass, at_start, at_end, boundary_p, densities, densities_p, free, rows = system
    intervals, m, n, k, s = h.size, weights.size, jacobian.shape[1], free.size, rhs.shape[1]
    b, c, r = at_start.shape[0], densities.shape[1], rows.shape[0]
    gauss, inner, e, ends = intervals * m, n * (m - 1), k + s, 2 * n + k
    width = n * (m + 1) + e
    pivots = np.empty((intervals, inner, width))
    chain = np.empty((intervals, n, 3 * n + e))
    block = np.zeros((n, 2 * n + e))
    border = np.zeros((c + r, 3 * n + e))  # columns: y_i (the current mesh point), y_0, y_{i+1}, e
    local = np.empty((n * m + c + r, width))  # columns: interior values, y_i, y_{i+1}, e
    stack = np.empty((2 * n, 3 * n + e))  # columns: y_i, y_0, y_{i+1}, e
    matrix = np.zeros((ends, 2 * n + e))
    sign = 1.0
    for i in range(intervals):
        for row in range(local.shape[0]):
            for column in range(width):
                local[row, column] = 0.0
        for g in range(m):
            at, weight = i * m + g, h[i] * weights[g]
            for j in range(m + 1):
                first = inner if j == 0 else inner + n if j == m else (j - 1) * n
                for row in range(n):
                    for column in range(n):
                        local[g * n + row, first + column] = -h[i] * values[g, j] * jacobian[at, row, column]
                    local[g * n + row, first + row] += mass[row] * derivatives[g, j]
                for row in range(c):
                    for column in range(n):
                        local[n * m + row, first + column] += weight * values[g, j] * densities[at, row, column]
            for row in range(n):
                for column in range(k):
                    local[g * n + row, inner + 2 * n + column] = -h[i] * by_p[at, row, free[column]]
                for column in range(s):
                    local[g * n + row, inner + 2 * n + k + column] = h[i] * rhs[at * n + row, column]
            for row in range(c):
                for column in range(k):
                    matrix[n + b + row, 2 * n + column] += weight * densities_p[at, row, free[column]]
            for row in range(r):
                for column in range(n):
                    value = 0.0
                    for j in range(m + 1):
                        value += values[g, j] * rows[row, (i * m + j) * n + column]
                    for j in range(m + 1):
                        first = inner if j == 0 else inner + n if j == m else (j - 1) * n
                        local[n * m + c + row, first + column] += weight * values[g, j] * value
        sign *= _eliminate(local, inner, n * m)
        for row in range(inner):
            for column in range(width):
                pivots[i, row, column] = local[row, column]

        if i == 0:
            for column in range(2 * n + e):
                for row in range(n):
                    block[row, column] = local[inner + row, inner + column]
                for row in range(c + r):
                    border[row, n + column] = local[n * m + row, inner + column]
            continue
        for row in range(n):
            for column in range(n):
                stack[row, column] = block[row, n + column]
                stack[row, n + column] = block[row, column]
                stack[row, 2 * n + column] = 0.0
                stack[n + row, column] = local[inner + row, inner + column]
                stack[n + row, n + column] = 0.0
                stack[n + row, 2 * n + column] = local[inner + row, inner + n + column]
            for column in range(e):
                stack[row, 3 * n + column] = block[row, 2 * n + column]
                stack[n + row, 3 * n + column] = local[inner + row, inner + 2 * n + column]
        sign *= _reflect(stack, n)
        for row in range(n):
            for column in range(3 * n + e):
                chain[i, row, column] = stack[row, column]
            for column in range(2 * n + e):
                block[row, column] = stack[n + row, n + column]
        for row in range(c + r):
            for column in range(n):  # the old y_{i+1} is the new y_i
                border[row, column] = border[row, 2 * n + column] + local[n * m + row, inner + column]
                border[row, 2 * n + column] = local[n * m + row, inner + n + column]
            for column in range(e):
                border[row, 3 * n + column] += local[n * m + row, inner + 2 * n + column]
            for pivot in range(n):
                factor = border[row, pivot] / stack[pivot, pivot]
                for column in range(pivot, 3 * n + e):
                    border[row, column] -= factor * stack[pivot, column]

    for column in range(2 * n + e):
        for row in range(n):
            matrix[row, column] = block[row, column]
        for row in range(c + r):
            matrix[n + b + row, column] += border[row, n + column]
    for row in range(b):
        for column in range(n):
            matrix[n + row, column] = at_start[row, column]
            matrix[n + row, n + column] = at_end[row, column]
        for column in range(k):
            matrix[n + row, 2 * n + column] = boundary_p[row, free[column]]
    for row in range(r):
        for column in range(k):
            matrix[n + b + c + row, 2 * n + column] += rows[row, (gauss + 1) * n + column]
    for row in range(b + c + r):
        for column in range(s):
            matrix[n + row, ends + column] += rhs[gauss * n + row, column]
    if n + b + c + r == ends:
        sign *= _eliminate(matrix, ends, ends)
    return pivots, chain, block, matrix, sign


@compiled
def _substitute(pivots, chain, matrix, k):  # type: ignore[no-untyped-def]
    """Back-substitution in what ``_condense`` eliminated: the solutions, shape (N*m*n + n + k, s)."""
    intervals, inner, n, ends = pivots.shape[0], pivots.shape[1], chain.shape[1], matrix.shape[0]
    m, s = inner // n + 1, matrix.shape[1] - ends
    result = np.empty((intervals * m * n + n + k, s))
    y = np.empty((intervals * m + 1, n))
    solved = np.empty(ends)  # y_0, y_N and the parameters
    for side in range(s):
        for row in range(ends - 1, -1, -1):
            value = matrix[row, ends + side]
            for column in range(row + 1, ends):
                value -= matrix[row, column] * solved[column]
            solved[row] = value / matrix[row, row]
        for row in range(n):
            y[0, row] = solved[row]
            y[intervals * m, row] = solved[n + row]
        for i in range(intervals - 1, 0, -1):
            for row in range(n - 1, -1, -1):
                value = chain[i, row, 3 * n + k + side]
                for column in range(k):
                    value -= chain[i, row, 3 * n + column] * solved[2 * n + column]
                for column in range(n):
                    value -= chain[i, row, n + column] * y[0, column]
                    value -= chain[i, row, 2 * n + column] * y[(i + 1) * m, column]
                for column in range(row + 1, n):
                    value -= chain[i, row, column] * y[i * m, column]
                y[i * m, row] = value / chain[i, row, row]
        for i in range(intervals):
            for row in range(inner - 1, -1, -1):
                value = pivots[i, row, inner + 2 * n + k + side]
                for column in range(k):
                    value -= pivots[i, row, inner + 2 * n + column] * solved[2 * n + column]
                for column in range(n):
                    value -= pivots[i, row, inner + column] * y[i * m, column]
                    value -= pivots[i, row, inner + n + column] * y[(i + 1) * m, column]
                for column in range(row + 1, inner):
                    value -= pivots[i, row, column] * y[i * m + 1 + column // n, column % n]
                y[i * m + 1 + row // n, row % n] = value / pivots[i, row, row]
        for row in range((intervals * m + 1) * n):
            result[row, side] = y[row // n, row % n]
        for row in range(k):
            result[(intervals * m + 1) * n + row, side] = solved[2 * n + row]
    return result


def solve(scheme: Scheme, system: LinearSystem, rhs: Array) -> Array:
    """Solve ``mass y' - jacobian y - parameter_jacobian p = defects`` with boundary, integral and border conditions.

    Args:
        scheme: the collocation scheme.
        system: the matrix; ``b + c + r = n + f`` conditions make it square.
        rhs: the defects at the Gauss points, row by row, then the conditions, shape (N*m*n + n + f, s).

    Returns:
        The values at all points, row by row, then the parameters, shape (N*m*n + n + f, s).

    Raises:
        numpy.linalg.LinAlgError: the matrix is singular to working precision, or has entries that are not finite.
    """
    return solve_signed(scheme, system, rhs)[0]


def solve_signed(scheme: Scheme, system: LinearSystem, rhs: Array) -> tuple[Array, float]:
    """As ``solve``; also 1 or -1, whose changes are those of the determinant's sign.

    The order of rows and columns in which it is taken makes it the same on all meshes that resolve the problem: intervals
    count for nothing, because on short ones ``mass y' - jacobian y`` has the sign of ``mass y'``.
    """
    pivots, chain, _, matrix, sign = _condense(scheme.derivatives, scheme.values, scheme.weights, system, rhs)
    diagonal = matrix.diagonal()
    if not (np.isfinite(diagonal) & (diagonal != 0.0)).all():
        raise np.linalg.LinAlgError("the collocation matrix is singular or has entries that are not finite")
    return _substitute(pivots, chain, matrix, system.free.size), float(sign)


def transfer_pencil(scheme: Scheme, h: Array, jacobian: Array, mass: Array | None = None) -> tuple[Array, Array]:
    """Matrices with ``A_0 y(0) + A_1 y(1) = 0`` for all solutions of ``mass y' = jacobian y``, each of shape (n, n).

    The pair stays accurate where the transfer matrix ``-A_1^{-1} A_0`` itself overflows or is ill-conditioned.
    """
    points, n = jacobian.shape[:2]
    shapes = [(0, n), (0, n), (0, 0), (points, 0, n), (points, 0, 0)]
    nothing = (*map(np.empty, shapes), np.empty(0, dtype=np.intp), np.empty((0, points * n + n)))
    mass = np.ones(n) if mass is None else mass
    system = LinearSystem(h, jacobian, np.empty((points, n, 0)), mass, *nothing)
    rhs = np.empty((points * n, 0))
    _, _, block, _, _ = _condense(scheme.derivatives, scheme.values, scheme.weights, system, rhs)
    return block[:, :n].copy(), block[:, n:].copy()
