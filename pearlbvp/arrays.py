"""Types of arrays, and arrays of what users give."""

from __future__ import annotations

import contextlib

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pearlbvp.errors import InputError

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Complex = NDArray[np.complex128]


def numeric(name: str, values: ArrayLike) -> Array:
    """A number, or several, as an array of that shape.

    Raises:
        InputError: they are none; the message names the argument.
    """
    if values is not None:  # which numpy takes for not a number
        with contextlib.suppress(TypeError, ValueError):
            return np.asarray(values, dtype=float)
    raise InputError(name, f"{values!r} is no number and no array of them", "give one like 0.48")
