"""A user's functions as collocation takes them: on [0, 1], their shapes checked, differences for derivatives not given."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation import BoundaryValueProblem
from pearlbvp.errors import InputError

Function = Callable[[Array, Array, Array], Any]
"""``f(t, y, p)`` of many points, or ``b(ya, yb, p)`` of the two ends."""

STEP = float(np.cbrt(np.finfo(float).eps))
"""Of central differences, relative to one plus the size: rounding and the third derivative spoil them equally."""


class Functions(NamedTuple):
    """What a user gives, as ``solve_bvp`` takes it."""

    rhs: Function
    boundary: Function
    integral: Function | None
    rhs_jacobian: Function | None
    boundary_jacobian: Function | None
    integral_jacobian: Function | None


def as_problem(
    given: Functions, interval: tuple[float, float], n: int, parameters: Sequence[str], b: int, c: int
) -> BoundaryValueProblem:
    """The problem on [0, 1] for ``n`` states, ``b`` boundary and ``c`` integral conditions.

    Its functions raise ``InputError`` where the user's return what does not fit.
    """
    start, length, k = interval[0], interval[1] - interval[0], len(parameters)

    def f(s: Array, y: Array, p: Array) -> Array:
        return length * _array("rhs", given.rhs(start + length * s, y, p), (len(s), n))

    def f_jacobian(s: Array, y: Array, p: Array) -> Any:
        if given.rhs_jacobian is None:
            return differences(f, (s, y, p), (1, 2))
        parts = _arrays("rhs_jacobian", given.rhs_jacobian(start + length * s, y, p), (len(s), n), (n, k))
        return tuple(length * part for part in parts)

    def ends(ya: Array, yb: Array, p: Array) -> Array:
        return _array("boundary", given.boundary(ya, yb, p), (b,))

    def ends_jacobian(ya: Array, yb: Array, p: Array) -> Any:
        if given.boundary_jacobian is None:
            return differences(ends, (ya, yb, p), (0, 1, 2))
        return _arrays("boundary_jacobian", given.boundary_jacobian(ya, yb, p), (b,), (n, n, k))

    def mean(s: Array, y: Array, p: Array) -> Array:
        if given.integral is None:
            return np.zeros((len(s), 0))
        return _array("integral", given.integral(start + length * s, y, p), (len(s), c))

    def mean_jacobian(s: Array, y: Array, p: Array) -> Any:
        if given.integral_jacobian is None:
            return differences(mean, (s, y, p), (1, 2))
        return _arrays("integral_jacobian", given.integral_jacobian(start + length * s, y, p), (len(s), c), (n, k))

    states = tuple(f"y{i}" for i in range(n))
    return BoundaryValueProblem(
        states, tuple(parameters), f, f_jacobian, ends, ends_jacobian, integrand=mean, integrand_jacobian=mean_jacobian
    )


def differences(function: Callable[..., Array], at: tuple[Array, ...], by: Sequence[int]) -> tuple[Array, ...]:
    """Derivatives of a function of several arrays by some of them, by central differences, all points at once.

    Args:
        function: its values have the shape (K, r), or (r,).
        at: its arguments; those to differentiate by have the shape (K, j) or (j,).
        by: places of these among the arguments.

    Returns:
        For each an array (K, r, j), or (r, j). The error is about 1e-11, relative to the function and its third derivative.
    """

    def by_one(place: int) -> Array:
        x, values = at[place], []
        for j in range(x.shape[-1]):
            ahead, behind = x.copy(), x.copy()
            ahead[..., j] += STEP * (1 + np.abs(x[..., j]))
            behind[..., j] -= STEP * (1 + np.abs(x[..., j]))
            rise = function(*at[:place], ahead, *at[place + 1 :]) - function(*at[:place], behind, *at[place + 1 :])
            values.append(rise / (ahead - behind)[..., j, None])
        return np.stack(values, axis=-1) if values else np.zeros((*function(*at).shape, 0))

    return tuple(np.ascontiguousarray(by_one(place)) for place in by)


def doubts(problem: BoundaryValueProblem, s: Array, y: Array, p: Array) -> str:
    """Which derivatives are not those of their functions; nothing if all are."""
    ends = y[0], y[-1], p
    functions: dict[str, tuple[Any, Any, Any, Any]] = {
        "rhs_jacobian": (problem.rhs_jacobian, problem.rhs, (s, y, p), (1, 2)),
        "boundary_jacobian": (problem.boundary_jacobian, problem.boundary, ends, (0, 1, 2)),
        "integral_jacobian": (problem.integrand_jacobian, problem.integrand, (s, y, p), (1, 2)),
    }
    wrong = []
    for name, (jacobian, function, at, by) in functions.items():
        with np.errstate(all="ignore"):
            parts = zip(jacobian(*at), differences(function, at, by), strict=True)
            gaps = [np.abs(a - b).max(initial=0) / (1 + np.abs(b).max(initial=0)) for a, b in parts]
        if max(gaps) > 1e-4:
            wrong.append(f"{name} differs from differences by {max(gaps):.1e}: correct it, or leave it out")
    return "; ".join(wrong)


def _array(name: str, value: Any, shape: tuple[int, ...]) -> Array:
    """A copy of a user's numbers, if they are real and of the shape that is needed."""
    remedy = f"return real numbers of shape {shape}" + (", a row a point" if len(shape) > 1 else "")
    try:
        array = np.array(value).astype(float, order="C", casting="same_kind")
    except (TypeError, ValueError):
        raise InputError(name, "its value is no array of real numbers", remedy) from None
    if array.shape != shape:
        raise InputError(name, f"its value has the shape {array.shape}", remedy)
    return array


def _arrays(name: str, value: Any, rows: tuple[int, ...], columns: tuple[int, ...]) -> tuple[Array, ...]:
    """A user's derivatives, one array for each number of columns; None stands for zeros."""
    if not isinstance(value, (tuple, list)) or len(value) != len(columns):
        raise InputError(name, f"it must return {len(columns)} arrays, one by each argument", "None stands for zeros")
    shapes = [(*rows, count) for count in columns]
    pairs = zip(value, shapes, strict=True)
    return tuple(np.zeros(shape) if part is None else _array(name, part, shape) for part, shape in pairs)
