"""How precisely numbers were written: what a file was rounded to is to be seen from its digits."""

from __future__ import annotations

import math
from decimal import Decimal
from typing import Any

import numpy as np

from pearlbvp.arrays import Array

SAMPLE = 20_000
"""Numbers whose digits are counted, evenly among all: so many tell how many digits the others have."""

ODD = 0.02
"""Share of numbers that may have more digits than the rest, as a sum in one row of a table has."""

SINGLE = 2e-9
"""Relative difference from single precision that nine digits of it may have; those of other numbers are up to 6e-8."""

NEGLIGIBLE = 1e-3
"""Share of fourth differences that rounding may have before it is smoothed: curvature's forces are fourth derivatives."""


def steps(values: Array) -> Array:
    """The unit of the last place to which each number was rounded, of the shape of ``values``.

    Numbers are written with so many decimals or so many significant digits, and trailing zeros may be left out; so each is
    taken to be as coarse as the coarser of both. Numbers of single precision are rounded to that at least, whatever digits
    they are written in.
    """
    values = np.asarray(values, dtype=np.float64)
    known = values[np.isfinite(values) & (values != 0)]
    if not known.size:
        return np.zeros(values.shape)
    single = bool((np.abs(known) < 1e38).all() and np.allclose(known, known.astype(np.float32), rtol=SINGLE, atol=0))
    some = known[:: -(-known.size // SAMPLE)]
    words = (str(value) for value in (some.astype(np.float32) if single else some.tolist()))
    written = [Decimal(word).normalize().as_tuple() for word in words]
    decimals, digits = (
        int(np.quantile(counts, 1 - ODD, method="higher"))
        for counts in ([-int(number.exponent) for number in written], [len(number.digits) for number in written])
    )
    sizes = np.abs(np.where(np.isfinite(values) & (values != 0), values, 10.0**-decimals))
    found = np.maximum(10.0**-decimals, 10.0 ** (np.floor(np.log10(sizes)) + 1 - digits))
    return np.asarray(np.maximum(found, np.spacing(sizes.astype(np.float32)).astype(float)) if single else found)


def deviation(step: Any) -> Any:
    """Standard deviation of what was rounded to multiples of a step, a number or an array."""
    return step / math.sqrt(12)
