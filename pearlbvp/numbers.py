"""Lists of numbers as users write them: ``15,30,45``, or ``start:stop:step`` with both ends."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from decimal import Decimal
from typing import Any

from pearlbvp.errors import InputError
from pearlbvp.helfrich import finite

MOST = 100_000
"""Longest list that a range may stand for."""


def _number(name: str, text: str) -> Decimal:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise InputError(name, f"{text.strip()!r} is not a finite number", "write numbers like 15 or 7.5")
    return Decimal(repr(number))


def parse_numbers(name: str, text: str) -> list[float]:
    """The numbers that ``text`` stands for, in order.

    Args:
        name: the argument's name, for messages.
        text: comma-separated numbers and ranges ``start:stop:step``. A range contains both its ends.

    Raises:
        InputError: text that is no number, an empty list, a range that does not reach its end.
    """
    numbers: list[float] = []
    if not text.strip():
        raise InputError(name, "the list is empty", "write numbers like 15,30,45 or a range like 7.5:120:0.5")
    for item in text.split(","):
        parts = item.split(":")
        if len(parts) == 1:
            numbers.append(float(_number(name, item)))
            continue
        if len(parts) != 3:
            raise InputError(name, f"{item.strip()!r} is no range", "write start:stop:step, like 7.5:120:0.5")
        start, stop, step = (_number(name, part) for part in parts)
        if step == 0:
            raise InputError(name, f"{item.strip()!r} has a step of 0", "choose one that divides the range")
        if (stop - start) / step < 0:
            raise InputError(name, f"{item.strip()!r} never reaches {stop}", "change the step's sign")
        if (stop - start) / step > MOST:
            raise InputError(name, f"{item.strip()!r} has more than {MOST} numbers", "take a larger step")
        if (stop - start) % step != 0:
            raise InputError(
                name, f"{item.strip()!r} steps past its end {stop}", "choose a step that divides the range"
            )
        numbers.extend(float(start + i * step) for i in range(int((stop - start) / step) + 1))
    return numbers


def as_whole(text: str) -> int | None:
    """The whole number that a text is, of 18 digits at most, with a sign or without; None where it is none."""
    return int(text) if re.fullmatch(r"\s*[+-]?[0-9]{1,18}\s*", text) else None


def several(values: Any) -> list[Any]:
    """Several values, or one alone, which may be an array without an axis."""
    return list(values) if isinstance(values, Iterable) and getattr(values, "ndim", True) else [values]


def as_numbers(name: str, values: float | str | Iterable[float]) -> list[float]:
    """One number, several, or a text for ``parse_numbers``, as a list.

    Raises:
        InputError: something that is no finite number, or nothing at all.
    """
    if isinstance(values, str):
        return parse_numbers(name, values)
    numbers = [finite(name, value) for value in several(values)]
    if not numbers:
        raise InputError(name, "the list is empty", "give at least one number")
    return numbers
