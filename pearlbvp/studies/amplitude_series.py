"""Where pearls lose stability to a localized one, from series of their functions in the squared amplitude.

Many series at once, in Chebyshev polynomials of ``2 x - 1``, where ``x`` from 0 to 1 is the share of the squared amplitude that
the series reach. What a series does not decide is not a number.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.continuation.chebyshev import STEP, between
from pearlbvp.studies.localized import COSINE, SUM, V

SAMPLES = 48
"""Amplitudes between which a crossing is looked for."""

SLOWEST = 1e-3
"""Of ``v`` with the squared amplitude, relative to onset, below which it is about to turn."""


def first_losses(c: Array, pearls: NDArray[np.int64]) -> Array:
    """The shares ``x``, shape (K,), at which pearls that are stable at onset lose stability to a localized one.

    Args:
        c: coefficients, shape (A, K, 7), of the functions of ``localized.FUNCTIONS``.
        pearls: how many, 2 or more, shape (K,).

    Returns:
        Not a number where ``v`` is about to turn before, where ``2 cos(theta)`` dips before it crosses, or where it does not.
    """
    levels, columns = 2 * np.cos(2 * np.pi / pearls), np.arange(len(pearls))
    x = np.linspace(0.0, 1.0, SAMPLES + 1) ** 2
    cosine, total = (_at_samples(c[:, :, function], x) for function in (COSINE, SUM))
    slope, widening = (_at_samples(chebyshev.chebder(c[:, :, function]), x) for function in (COSINE, V))
    # Two pearls: the factors of 2 cos(theta) + 2 change signs one after the other, and their sum between them.
    turned = (pearls == 2) & (total * total[0] < 0)
    passed = (cosine <= levels + 1e-12) | turned
    end = passed.argmax(axis=0)
    low, high = x[np.maximum(end - 1, 0)], x[end]
    late = turned[end, columns] & (cosine[end, columns] > levels)
    if late.any():
        high[late] = _crossing(c[:, late, SUM], 0 * levels[late], low[late], high[late])
    found = _crossing(c[:, :, COSINE], levels, low, high)
    found[end == 0] = 0.0
    before = np.arange(SAMPLES + 1)[:, None] <= end
    dips = ((slope[:-1] < 0) & (slope[1:] > 0) & before[1:] & ~passed[1:]).any(axis=0)
    rate = np.where(before, widening * np.sign(widening[0]), np.inf).min(axis=0)
    found[~passed.any(axis=0) | dips | (rate <= SLOWEST * np.abs(widening[0]))] = np.nan
    return found


def at_shares(c: Array, x: Array) -> Array:
    """The functions at shares, shape (K,): shape (K, 7)."""
    return np.column_stack([_at(c[:, :, function], x) for function in range(c.shape[2])])


def _crossing(c: NDArray[Any], levels: Array, low: Array, high: Array) -> Array:
    """Where functions with coefficients (A, K) take their levels, each between its ends."""
    slopes = chebyshev.chebder(c, scl=2.0)

    def with_slope(x: Array) -> tuple[Array, Array]:
        return _at(c, x), _at(slopes, x)

    return between(with_slope, levels, low, high, with_slope(low)[0] < levels, STEP)


def _at_samples(c: NDArray[Any], x: Array) -> Array:
    """Values of K series with coefficients (A, K) at the same shares (S,): shape (S, K)."""
    found: Array = chebyshev.chebvander(2 * x - 1, len(c) - 1) @ c
    return found


def _at(c: NDArray[Any], x: Array) -> Array:
    """Values of K series with coefficients (A, K), each at its own share (K,)."""
    found: Array = chebyshev.chebval(2 * x - 1, c, tensor=False)
    return found
