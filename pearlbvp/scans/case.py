"""A case of a scan: which question is asked of which tube. It has one canonical form, by which it is known in a store."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

Value = float | int | str
"""A parameter of a case."""

Row = Mapping[str, object]
"""A row of a table, by the names of its columns."""


@dataclass(frozen=True, order=True)
class Case:
    """A question and its parameters, in radii, in the order of the question's.

    Cases of one question are ordered as its tables are: by their parameters, words behind numbers.

    Examples:
        >>> Case("dispersion", (0.48, 10.0)).canonical({}, "1.0")
        '["dispersion", [0.48, 10.0], {}, "1.0"]'
    """

    question: str
    parameters: tuple[Value, ...]

    def canonical(self, settings: Mapping[str, Value], version: str) -> str:
        """The text that is the same for the same case, settings and version only: numbers with all their digits."""
        values = [value + 0.0 if isinstance(value, float) else value for value in self.parameters]  # -0.0 is 0.0
        return json.dumps([self.question, values, dict(sorted(settings.items())), version])

    def key(self, settings: Mapping[str, Value], version: str) -> str:
        """A hash of the canonical form."""
        return hashlib.sha256(self.canonical(settings, version).encode()).hexdigest()

    def place(self) -> tuple[tuple[bool, float, str], ...]:
        """What cases are sorted by."""
        return tuple(
            (True, 0.0, value) if isinstance(value, str) else (False, float(value), "") for value in self.parameters
        )


class Outcome(NamedTuple):
    """What became of a case.

    Attributes:
        rows: of the question's table; one with a message where the case failed.
        status: ``done`` or ``failed``.
        message: why it failed.
    """

    rows: tuple[Row, ...]
    status: str = "done"
    message: str = ""


def coarse_first(count: int) -> Iterable[int]:
    """The numbers from 0 to ``count - 1`` in an order whose beginnings are coarse maps: both ends, the middle, the quarters.

    Examples:
        >>> list(coarse_first(9))
        [0, 8, 4, 2, 6, 1, 3, 5, 7]
    """
    if count > 0:
        yield 0
    if count > 1:
        yield count - 1
    step = 1 << max(count - 2, 0).bit_length()
    while step > 1:
        yield from range(step // 2, count - 1, step)
        step //= 2
