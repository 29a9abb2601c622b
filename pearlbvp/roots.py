"""The zero of a function of one variable between two points at which its signs differ.

scipy has such, but its ``optimize`` takes a quarter of a second to import.
"""

from __future__ import annotations

import math
from collections.abc import Callable

MOST = 100
"""Evaluations after which the search is given up: bisection alone would need some sixty."""


class NoRoot(ArithmeticError):
    """The function has one sign at both ends, is not a number somewhere, or its zero was not found in time."""


def root(
    function: Callable[[float], float], first: float, last: float, absolute: float, relative: float = 1e-14
) -> float:
    """A zero between two points, to ``absolute + relative |x|``, by inverse quadratic interpolation and bisection.

    Source: T. R. Chandrupatla, Advances in Engineering Software 28 (1997) 145: interpolate through the last three points where
    that is monotone between them (the condition on ``xi`` and ``phi``), else bisect.

    Raises:
        NoRoot: there is none to be found.

    Examples:
        >>> root(lambda x: x * x - 2, 0.0, 2.0, 1e-15)
        1.4142135623730951
    """
    # b and a enclose the zero, a is the newest, c the one before it.
    a, b = first, last
    fa, fb = function(a), function(b)
    if fa == 0 or fb == 0:
        return a if fa == 0 else b
    if not fa * fb < 0:
        raise NoRoot(f"the function does not change its sign between {first:g} and {last:g}")
    share = 0.5
    for _ in range(MOST):
        x = a + share * (b - a)
        fx = function(x)
        if math.isnan(fx):
            raise NoRoot(f"the function is not a number at {x:g}")
        if (fx > 0) == (fa > 0):
            c, fc = a, fa
        else:
            c, fc, b, fb = b, fb, a, fa
        a, fa = x, fx
        best, size = (a, fa) if abs(fa) < abs(fb) else (b, fb)
        least = (absolute + relative * abs(best)) / abs(b - a)
        if size == 0 or least > 0.5:
            return best
        xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
        share = 0.5
        if phi**2 < xi and (1 - phi) ** 2 < 1 - xi:
            share = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        share = min(max(share, least), 1 - least)
    raise NoRoot(f"no zero found within {MOST} evaluations between {first:g} and {last:g}")
