"""Polynomials through samples that are added one at a time, each where the polynomial is known least.

Source: F. Leja, Ann. Polon. Math. 4 (1957) 8; A. Narayan, J. D. Jakeman, SIAM J. Sci. Comput. 36 (2014) A2952.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from pearlbvp.arrays import Array

PLACES = (1 - np.cos(np.pi * np.arange(97) / 96)) / 2
"""Where the next sample may lie, by the length of what is looked at."""

SHORTEST = 1e-4
"""The least ``t`` that samples are to cover."""

TINY = 1e-150
"""A distance that is none."""

ROUGH = 1e3
"""What may be left unresolved, by the tolerance, where more samples do not help: it is rounding."""

Until = Callable[[Array], Array]
"""Of functions, shape (K, functions): negative beyond where they are wanted, shape (K,)."""


def never(found: Array) -> Array:
    """Wanted everywhere."""
    return np.ones(len(found))


class Samples(NamedTuple):
    """Functions at some places, and the polynomial through them.

    Attributes:
        at: the places, distinct, shape (n,).
        values: shape (n, functions).
        end: the polynomial holds from 0 to here.
        error: what it missed of the last sample, relative to one plus the functions' size.
    """

    at: Array
    values: Array
    end: float
    error: float

    def __call__(self, t: Array) -> Array:
        """The polynomial at ``t``, shape (K,): shape (K, functions)."""
        return through(self.at, self.values, t)[0]


def through(at: Array, values: Array, t: Array) -> tuple[Array, Array]:
    """The polynomial through values, shape (n, functions), at places, (n,), and the product of the distances from them.

    Both at ``t``, (K,): shapes (K, functions) and (K,). The form is the one that is stable beyond the places, too (N. J.
    Higham, IMA J. Numer. Anal. 24 (2004) 547).
    """
    distances, differences = t[:, None] - at, at[:, None] - at
    distances[distances == 0] = TINY  # all other terms vanish
    np.fill_diagonal(differences, 1.0)
    product = distances.prod(axis=1)
    return product[:, None] * ((1 / differences.prod(axis=1) / distances) @ values), np.abs(product)


def sampled(
    sample: Callable[[float], Array], known: dict[float, Array], tolerance: float, most: int, until: Until = never
) -> Samples:
    """Functions of ``t`` from 0 on, sampled until they are resolved, where the product of the distances is largest.

    Whatever samples there are, none is wasted, and each new one measures the error of the polynomial through the others where
    that is about largest.

    Args:
        sample: the functions at a ``t``, shape (functions,).
        known: those known already: at 0, at 1, and in between.
        tolerance: for the error.
        most: samples, the known ones included.
        until: the end is 1, or a little beyond where this turns negative.
    """
    at, values, end, errors = np.array(list(known)), np.array(list(known.values())), 1.0, [math.inf]
    while True:
        grid = min(1.0, 2 * end) * PLACES
        found, product = through(at, values, grid)
        # A polynomial through a few samples may run wild: it is believed from the last one on that is wanted.
        first_beyond = at[until(values) < 0].min(initial=math.inf)
        beyond = (until(found) < 0) & (grid > at[at < first_beyond].max(initial=0.0))
        end = max(float(grid[beyond.argmax() + 1]), SHORTEST) if beyond[:-1].any() else float(grid[-1])
        rounding = errors[-1] < ROUGH * tolerance and min(errors[-2:]) > min(errors[:-2], default=math.inf)
        resolved = (errors[-1] < tolerance or rounding) and (beyond.any() or end == 1)
        if resolved or len(at) >= most:
            return Samples(at, values, end, errors[-1])
        new = int(np.where(grid <= end, product, 0.0).argmax())
        here = sample(float(grid[new]))
        size = 1 + np.abs(values[at <= end]).max(axis=0)
        errors.append(float((np.abs(here - found[new]) / size).max()))
        at, values = np.append(at, grid[new]), np.vstack((values, here))
