"""Series in ``c0``, the period and the amplitude: how they are computed, kept and evaluated."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.polynomial import chebyshev

from pearlbvp.arrays import Array
from pearlbvp.continuation.chebyshev import Unresolved, in_pieces, series
from pearlbvp.files import write_whole
from pearlbvp.representation import brief
from pearlbvp.studies import pearl_series as periods
from pearlbvp.studies.localized import SQUARE
from pearlbvp.studies.pearl_series import PearlSeries
from pearlbvp.theory.dispersion import stable_wave_numbers

CURVATURES = 0.26, 0.49
"""The values of ``c0`` that the atlas has."""

TOLERANCE = 1e-9
"""Of the last coefficients, relative to one plus the functions' size."""

PERIODS = 24
"""Degree in the period."""

DEGREES = 12, 24
"""In ``c0``, first and last; what the last does not resolve is tried on halves."""

REACH = 1.15
"""By how much the series reach further than the squared amplitude at which two pearls of the middle period lose stability."""

NEGLIGIBLE = 1e-13
"""Size below which coefficients are left out."""

FILE = Path(__file__).with_name("pearls.npz")
"""The series that come with the package."""


def scaled(c0: Array) -> Array:
    """The coordinate ``log((4 c0 - 1)/(2 - 4 c0))``: pearls change evenly with it from ``c0 = 1/4`` to 1/2."""
    found: Array = np.log((4 * c0 - 1) / (2 - 4 * c0))
    return found


def unscaled(w: float) -> float:
    """The ``c0`` at a coordinate."""
    return (1 + 2 * math.exp(w)) / (4 + 4 * math.exp(w))


@dataclass(frozen=True)
class Reach:
    """The largest squared amplitude of a ``c0``: the exponential of a Chebyshev series over the whole atlas.

    Attributes:
        coefficients: of its logarithm, in the scaled ``c0``.
    """

    coefficients: Array

    @classmethod
    def found(cls, degree: int = 8) -> Reach:
        """That of two pearls, with something to spare."""
        low, high = scaled(np.array(CURVATURES))

        def sample(t: float) -> Array:
            c0 = unscaled(low + t * (high - low))
            period = periods.unscaled(sum(periods.band(c0)) / 2)
            return np.log(REACH * periods.stable_up_to(c0, period)[-1:, SQUARE])

        return cls(series(sample, TOLERANCE, degree, degree)[0][:, 0])

    def __call__(self, c0: Array) -> Array:
        """At values of ``c0``."""
        low, high = scaled(np.array(CURVATURES))
        found: Array = np.exp(chebyshev.chebval((2 * scaled(c0) - low - high) / (high - low), self.coefficients))
        return found


@dataclass(frozen=True)
class Piece:
    """The series over an interval of scaled ``c0``, over the band of periods of each, and over amplitudes up to the reach.

    Attributes:
        low, high: ends of the interval.
        coefficients: shape (C, P, A, 7), of ``localized.FUNCTIONS`` in Chebyshev polynomials of the three coordinates.
        error: what they leave unresolved, relative to one plus the functions' size.
    """

    __repr__ = brief

    low: float
    high: float
    coefficients: Array
    error: float

    @classmethod
    def over(cls, low: float, high: float, reach: Reach) -> Piece:
        """The series over an interval.

        Raises:
            Unresolved: the degrees do not suffice, or waves around are near.
        """
        errors = []

        def sample(t: float) -> Array:
            c0 = unscaled(low + t * (high - low))
            end, ends = float(reach(np.array(c0))), periods.band(c0)
            pearls = PearlSeries.over(c0, *ends, reach=end, degrees=(PERIODS, PERIODS), tolerance=TOLERANCE)
            if pearls.clear < np.inf:
                raise Unresolved("there are neutral waves around")
            errors.append(pearls.error)
            return pearls.coefficients

        c, error, _ = series(sample, TOLERANCE, *DEGREES)
        if error > TOLERANCE:
            raise Unresolved(f"pearls between two values of c0 are resolved to {error:.1e} only")
        c[..., SQUARE] = 0.0  # is the reach's share
        c[np.abs(c) < NEGLIGIBLE] = 0.0
        used = np.flatnonzero(np.abs(c).max(axis=(0, 1, 3)))[-1] + 1
        return cls(low, high, c[:, :, :used], max(error, *errors))

    def at(self, c0: Array, period: Array) -> Array:
        """Coefficients in the squared amplitude, shape (A, K, 7), for values of ``c0`` and periods, shape (K,)."""
        degrees = self.coefficients.shape
        short, long = (periods.scaled(2 * np.pi / k) for k in reversed(stable_wave_numbers(c0, 2)))
        y = (2 * scaled(c0) - self.low - self.high) / (self.high - self.low)
        z = (2 * periods.scaled(period) - short - long) / (long - short)
        both = chebyshev.chebvander(y, degrees[0] - 1)[:, :, None] * chebyshev.chebvander(z, degrees[1] - 1)[:, None, :]
        found = both.reshape(len(c0), -1) @ self.coefficients.reshape(degrees[0] * degrees[1], -1)
        return np.asarray(found.reshape(len(c0), *degrees[2:]).transpose(1, 0, 2))


@dataclass(frozen=True)
class Atlas:
    """All of it.

    Attributes:
        reach: the largest squared amplitudes.
        pieces: over intervals of ``c0``, in order.
    """

    __repr__ = brief

    reach: Reach
    pieces: Sequence[Piece]

    @classmethod
    def computed(cls) -> Atlas:
        """From some thousand continuations, in about a minute.

        Raises:
            Unresolved: a part of it is not resolved.
        """
        reach = Reach.found()
        low, high = scaled(np.array(CURVATURES)).tolist()
        pieces = in_pieces(lambda a, b: Piece.over(a, b, reach), low, high, np.linspace(low, high, 9), 2)
        if sum(piece.high - piece.low for piece in pieces) < (high - low) * (1 - 1e-12):
            raise Unresolved("a part of the atlas is not resolved")
        return cls(reach, pieces)

    def save(self, path: Path = FILE) -> None:
        """Write a file that ``load`` reads."""
        arrays = {"reach": self.reach.coefficients}
        for number, piece in enumerate(self.pieces):
            arrays[f"ends{number}"] = np.array([piece.low, piece.high, piece.error])
            arrays[f"coefficients{number}"] = piece.coefficients

        def write(beside: Path) -> None:
            with beside.open("wb") as file:
                np.savez_compressed(file, **arrays)  # type: ignore[arg-type]

        write_whole("atlas", path, write)

    @classmethod
    def load(cls, path: Path = FILE) -> Atlas:
        """Read what ``save`` wrote; nothing in it is executed."""
        with np.load(path, allow_pickle=False) as file:
            pieces = []
            for number in range(sum(name.startswith("ends") for name in file.files)):
                low, high, error = file[f"ends{number}"].tolist()
                pieces.append(Piece(low, high, file[f"coefficients{number}"], error))
            return cls(Reach(file["reach"]), pieces)
