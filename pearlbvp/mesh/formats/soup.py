"""Points and polygons as a file has them, and what every reader of text needs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from pearlbvp.arrays import Array, Integers

Polygons = tuple[Integers, Integers]
"""Corners of polygons, one after the other, and their number for each."""


class Unreadable(Exception):
    """Why a file cannot be read as its format, in words that go on from "it cannot be read as ...: "."""


@dataclass(frozen=True)
class Soup:
    """Polygons on points, nothing of them checked but that corners are points.

    Attributes:
        points: shape (P, 3).
        corners: points of the polygons' corners, one polygon after the other, shape (C,).
        sizes: corners of each polygon, shape (F,).
        first: number of the first point and polygon in messages, as the file counts them.

    Raises:
        Unreadable: a corner is none of the points, or there is no polygon.
    """

    points: Array
    corners: Integers
    sizes: Integers
    first: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", np.ascontiguousarray(self.points, dtype=np.float64).reshape(-1, 3))
        for name in ("corners", "sizes"):
            object.__setattr__(self, name, np.ascontiguousarray(getattr(self, name), dtype=np.int64))
        if not len(self.sizes):
            raise Unreadable("it has no faces")
        if (wrong := np.flatnonzero((self.corners < 0) | (self.corners >= len(self.points)))).size:
            face = int(np.searchsorted(np.cumsum(self.sizes), wrong[0], side="right")) + self.first
            raise Unreadable(
                f"a corner is none of its {len(self.points)} vertices (in face {face}; both are numbered from {self.first})"
            )

    @classmethod
    def of(cls, points: Array, faces: Sequence[Sequence[int]], first: int = 0) -> Soup:
        """From a list of polygons."""
        sizes = np.fromiter((len(face) for face in faces), np.int64, len(faces))
        corners = np.fromiter((corner for face in faces for corner in face), np.int64, int(sizes.sum()))
        return cls(points, corners, sizes, first)

    @classmethod
    def joined(cls, points: Array, parts: Sequence[Polygons]) -> Soup:
        """Several lists of polygons on the same points."""
        if not parts:
            raise Unreadable("it has no faces")
        corners, sizes = zip(*parts, strict=True)
        return cls(points, np.concatenate(corners), np.concatenate(sizes))


def numbers(words: Iterable[str]) -> list[float]:
    """Words as numbers.

    Raises:
        ValueError: one is none; ``1_0``, which Python would take for 10, is none either.
    """
    found = []
    for word in words:
        if "_" in word:
            raise ValueError(word)
        found.append(float(word))
    return found


def integers(words: Iterable[str]) -> list[int]:
    """Words as whole numbers; ``3.0`` is one.

    Raises:
        ValueError: one is none.
    """
    found = []
    for word in words:
        if not word.lstrip("+-").isdecimal():
            value = numbers([word])[0]
            if not value.is_integer():
                raise ValueError(word)
            found.append(int(value))
        else:
            found.append(int(word))
    return found


def text_of(data: bytes) -> str:
    """Bytes as text: names and comments may have any encoding, numbers and keywords are ASCII."""
    return data.removeprefix(b"\xef\xbb\xbf").decode("latin-1").replace("\r\n", "\n").replace("\r", "\n")


def strips(runs: Iterable[Sequence[int]]) -> list[tuple[int, int, int]]:
    """Triangles of strips, all oriented as the first of each is."""
    return [
        (run[i], run[i + 1], run[i + 2]) if i % 2 == 0 else (run[i + 1], run[i], run[i + 2])
        for run in runs
        for i in range(len(run) - 2)
    ]
