"""Functions along a path as Chebyshev series: values, derivatives and crossings between the computed points.

Solutions of ``residual(u) = 0`` form an analytic curve, so any smooth function of a solution is resolved to rounding by
a few solutions. At a pitchfork the branch is even in its arclength ``s``, and ``s^2`` is the variable.
Source: L. N. Trefethen, Approximation Theory and Approximation Practice (SIAM 2013), chapters 3, 8 and 18.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import TypeVar

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.continuation.interpolation import interpolate
from pearlbvp.continuation.leja import ROUGH, Samples, Until, never, sampled
from pearlbvp.continuation.path import SAFETY, correct
from pearlbvp.continuation.problem import P
from pearlbvp.continuation.solution import Solution
from pearlbvp.newton import NewtonOptions
from pearlbvp.representation import brief

Function = Callable[[P, Array], Array]
Piece = TypeVar("Piece")


class Unresolved(ArithmeticError):
    """A path's functions could not be resolved; the message says where and what to try."""


@dataclass(frozen=True)
class PathFunctions:
    """Functions of the solutions along a path, one Chebyshev series a piece.

    The coordinate ``x`` runs from 0 to the number of pieces; it has no meaning beyond its order.

    Attributes:
        coefficients: for each piece, shape (degree + 1, functions), in Chebyshev polynomials of ``2 (x - piece) - 1``.
        error: what the series without it misses of the last solution, relative to one plus the function's size.
        solutions: number of solutions that they rest on.
    """

    __repr__ = brief

    coefficients: tuple[NDArray[np.float64], ...]
    error: float
    solutions: int

    def __call__(self, x: Array) -> Array:
        """Values at ``x``, shape (K,): shape (K, functions)."""
        x = np.atleast_1d(x)
        piece = np.clip(x.astype(int), 0, len(self.coefficients) - 1)
        values = np.empty((len(x), self.coefficients[0].shape[1]))
        for i, c in enumerate(self.coefficients):
            here = piece == i
            values[here] = chebyshev.chebval(2 * (x[here] - i) - 1, c).T
        return values

    def crossings(self, function: int, level: float = 0.0, derivative: int = 0) -> Array:
        """All ``x``, increasing, at which a function (or a derivative of it by ``x``) takes the value ``level``."""
        found: list[float] = []
        for i, c in enumerate(self.coefficients):
            series = chebyshev.chebder(c[:, function], derivative, scl=2.0) if derivative else c[:, function].copy()
            series[0] -= level
            significant = np.flatnonzero(np.abs(series) > 1e-15 * np.abs(series).max(initial=0.0))
            if significant.size == 0 or significant[-1] == 0:
                continue
            roots = chebyshev.chebroots(series[: significant[-1] + 1])
            real = roots.real[(np.abs(roots.imag) < 1e-8) & (np.abs(roots.real) <= 1 + 1e-12)]
            found.extend(i + (np.clip(np.sort(real), -1, 1) + 1) / 2)
        return np.asarray(found)

    def first_crossings(self, function: int, levels: Array) -> Array:
        """For each level, shape (K,), the first ``x`` at which a function takes it; not a number where it never does.

        Between its extrema the function is monotone: one iteration, of all levels at once, finds each in the first stretch
        whose ends lie on both sides of it.
        """
        pieces, levels = len(self.coefficients), np.asarray(levels)
        knots = np.unique(np.concatenate((np.arange(pieces + 1.0), self.crossings(function, derivative=1))))
        above = self(knots)[:, function] - levels[:, None] > 0
        passed = above[:, :-1] != above[:, 1:]
        reached = passed.any(axis=1)
        found = np.full(len(levels), np.nan)
        stretch, rising = passed.argmax(axis=1)[reached], ~above[reached, passed.argmax(axis=1)[reached]]
        found[reached] = between(
            self._with_slope(function),
            levels[reached],
            knots[stretch],
            knots[stretch + 1],
            rising,
            STEP * pieces,
        )
        return found

    def _with_slope(self, function: int) -> Callable[[Array], tuple[Array, Array]]:
        """A function and its derivative, of ``x``, shape (K,)."""
        alone = [c[:, function] for c in self.coefficients]
        both = tuple(np.column_stack((c, np.append(chebyshev.chebder(c, scl=2.0), np.zeros(1)))) for c in alone)
        functions = replace(self, coefficients=both)

        def value_and_slope(x: Array) -> tuple[Array, Array]:
            value, slope = functions(x).T
            return value, slope

        return value_and_slope


STEP, ROUNDING = 1e-9, 4e-16
"""Step of Newton's method, by the number of pieces, whose square is rounding; rounding of a value by one plus its size."""


def between(
    with_slope: Callable[[Array], tuple[Array, Array]],
    levels: Array,
    low: Array,
    high: Array,
    rising: NDArray[np.bool_],
    step: float,
) -> Array:
    """Where functions that are monotone between two ends take their levels, all at once, shape (K,).

    Newton's method, by bisection where it leaves what is left.

    Args:
        with_slope: values and derivatives of the K functions at K places.
        levels: that lie between the values at the ends.
        low, high: the ends.
        rising: whether the functions do.
        step: of Newton's method whose square is rounding.
    """
    x, left, right = (low + high) / 2, low, high
    for _ in range(54):
        value, slope = with_slope(x)
        beyond = (value > levels) == rising
        left, right = np.where(beyond, left, x), np.where(beyond, x, right)
        change = (value - levels) / np.where(slope == 0, np.nan, slope)
        found = (np.abs(change) < step) | (np.abs(value - levels) < ROUNDING * (1 + np.abs(levels)))
        if found.all():
            break
        inside = (left < x - change) & (x - change < right)
        x = np.where(found, x, np.where(inside, x - change, (left + right) / 2))
    return np.clip(np.where(np.abs(change) < step, x - change, x), low, high)


@cache
def _to_coefficients(degree: int) -> Array:
    """Matrix from values at the points ``cos(pi j / degree)``, ``j = degree .. 0``, to Chebyshev coefficients."""
    j = np.arange(degree + 1)
    matrix = np.cos(np.pi * np.outer(j, degree - j) / degree) * (2 / degree)
    matrix[:, [0, -1]] /= 2
    matrix[[0, -1]] /= 2
    return matrix


def series(
    sample: Callable[[float], Array], tolerance: float, degree: int, max_degree: int, hopeless: float = math.inf
) -> tuple[Array, float, int]:
    """Functions of ``t`` from 0 to 1 as Chebyshev series, of a degree that is doubled until they are resolved.

    Args:
        sample: the functions at a ``t``, in the last axis.
        tolerance: for the last coefficients, relative to one plus the functions' size.
        degree, max_degree: first and last; one is a power of two times the other.
        hopeless: error at which a larger degree is not tried.

    Returns:
        Coefficients, shape (degree + 1, ...), in Chebyshev polynomials of ``2 t - 1``; what they leave unresolved; the
        number of samples.
    """
    samples: dict[int, Array] = {}  # by position among the points of the largest degree
    while True:
        at = range(0, max_degree + 1, max_degree // degree)
        for j in at:
            if j not in samples:
                samples[j] = sample((1 - math.cos(math.pi * j / max_degree)) / 2)
        values = np.array([samples[j] for j in at])
        coefficients = np.tensordot(_to_coefficients(degree), values, 1)
        others = tuple(range(values.ndim - 1))
        scale = 1 + np.abs(values).max(axis=others)
        error = float((np.abs(coefficients[-3:]).max(axis=others) / scale).max())
        if error < tolerance or error > hopeless or degree == max_degree:
            return coefficients, error, len(samples)
        degree *= 2


def in_pieces(
    resolved: Callable[[float, float], Piece], low: float, high: float, wanted: Array, fewest: int
) -> list[Piece]:
    """What can be resolved of functions over an interval, which is halved where it cannot be as a whole.

    Args:
        resolved: what there is between two ends; it may raise ``Unresolved``.
        low, high: ends of the interval.
        wanted: places at which values are wanted.
        fewest: nothing is tried for fewer of them.
    """
    inside = wanted[(low <= wanted) & (wanted <= high)]
    if len(inside) < fewest:
        return []
    try:
        return [resolved(low, high)]
    except (Unresolved, np.linalg.LinAlgError):
        middle = (low + high) / 2
        halves = ((low, middle), (middle, high))
        return [piece for half in halves for piece in in_pieces(resolved, *half, inside, fewest)]


def _resolve_piece(
    points: Sequence[Solution[P]],
    function: Function[P],
    values: Sequence[Array],
    tolerance: float,
    pitchfork: bool,
    most: int,
    until: Until,
) -> Samples:
    """The functions on one piece, by a coordinate that is 1 at its last point.

    All solutions are computed on the last point's mesh, at prescribed arclength along one direction: the first tangent
    of a pitchfork, else the chord. Points of the path that are on that mesh serve as they are.
    """
    first, problem = points[0], points[-1].problem
    moved = [problem.transfer(point.problem, point.u) for point in points]
    base, ahead = moved[0], moved[-1]
    if pitchfork:
        ahead = problem.transfer(first.problem, first.u + 1e-4 * first.tangent)
    direction = ahead - base
    direction = direction / math.sqrt(problem.inner(direction, direction))
    places = [problem.inner(direction, u - base) for u in moved]
    if not (np.diff(places) > 0).all():
        raise Unresolved("the path turns back between two points; take shorter steps")
    # Off its tangent the branch of a pitchfork is of second order: that is interpolated, by the square of the arclength.
    order, start, slope = (2, base, direction) if pitchfork else (0, np.zeros_like(base), np.zeros_like(base))
    off = {s: (u - start - s * slope) / s**order for s, u in zip(places, moved, strict=True) if s > 0 or not pitchfork}
    power, reach = max(order, 1), places[-1]
    options, rate = NewtonOptions(max_iterations=8, tolerance=tolerance / 10), 1e4

    def sample(t: float) -> Array:
        nonlocal rate
        s = reach * t ** (1 / power)
        guess = start + s * slope + s**order * interpolate(s, off)
        result, _ = correct(problem, guess, direction, base, s, options, rate)
        rate = SAFETY * result.rate if result.iterations > 1 else rate
        if not result.converged:
            raise Unresolved(f"no solution between two points of the path: {result.message}")
        off[s] = (result.u - start - s * slope) / s**order
        return function(problem, result.u)

    known = {
        (s / reach) ** power: found
        for s, point, found in zip(places, points, values, strict=True)
        if point.problem is problem or s == 0
    }
    return sampled(sample, known, tolerance, most, until)


def resolve(
    points: Sequence[Solution[P]],
    function: Function[P],
    *,
    values: Sequence[Array] | None = None,
    tolerance: float = 1e-11,
    pitchfork: bool = False,
    most: int = 33,
    until: Until = never,
) -> PathFunctions:
    """Resolve smooth functions along a path to ``tolerance``, in as few solutions as that takes.

    The whole path is tried as one piece first, and halved where 33 solutions do not suffice.

    Args:
        points: consecutive points of a path, two at least.
        function: from problem and unknown to a vector of values.
        values: its values at the points, where they are known already.
        tolerance: for the error, relative to one plus the function's size.
        pitchfork: the first point is a bifurcation point at which the branch is even in its arclength.
        most: solutions on one piece.
        until: of values: where it turns negative, the path ends for good.

    Raises:
        Unresolved: two neighbouring points are too far apart, or the functions are not smooth between them.
    """
    if values is None:
        values = [function(point.problem, point.u) for point in points]
    try:
        found = _resolve_piece(points, function, values, tolerance, pitchfork, most, until)
    except Unresolved:
        if len(points) == 2:
            raise
    else:
        if found.error < (tolerance if len(points) > 2 else ROUGH * tolerance):
            degree = len(found.at) - 1
            at_points = found(found.end * (1 - np.cos(np.pi * np.arange(degree + 1) / degree)) / 2)
            return PathFunctions((_to_coefficients(degree) @ at_points,), found.error, degree + 1)
        if len(points) == 2:
            raise Unresolved(f"functions along the path are resolved to {found.error:.1e} only; take shorter steps")
    middle = len(points) // 2
    head, tail = slice(middle + 1), slice(middle, None)
    former = resolve(points[head], function, values=values[head], tolerance=tolerance, pitchfork=pitchfork, most=most)
    latter = resolve(points[tail], function, values=values[tail], tolerance=tolerance, most=most, until=until)
    error, count = max(former.error, latter.error), former.solutions + latter.solutions
    return PathFunctions(former.coefficients + latter.coefficients, error, count)
