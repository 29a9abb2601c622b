"""A tube as one function on the torus, ``F(x, phi) = sigma + d_y cos phi + d_z sin phi``, and its Fourier coefficients.

The centre takes the place of the first harmonic, which ``sigma`` lacks. Shifts along the axis, turns about it and reflections
move ``F`` as they move points of the torus, and a turning frame is a shear of it::

    e^{i t} P(x - a, phi - t)   is   F(x - a, phi - t)
    P(-x, phi),  conj P(x, -phi)   are   F(-x, phi),  F(x, -phi)
    e^{i kappa x} (d' + sigma' e^{i phi}),  its angle counted in the frame,   is   F'(x, phi - kappa x)

so the wave ``(p, b)`` of a frame of ``m`` turns is the wave ``(p - b m, b)`` at rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Complex, Integers
from pearlbvp.representation import brief
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.symmetry import product_modes


def _exponentials(function: str, number: int) -> dict[int, complex]:
    """Cosine or sine of ``number t`` as a sum of ``e^{i n t}``."""
    if number == 0:
        return {0: 1.0}
    return {number: 0.5, -number: 0.5} if function == "cos" else {number: -0.5j, -number: 0.5j}


def _waves(mode: Mode) -> dict[tuple[int, int], complex]:
    """A mode as a sum of waves ``e^{i (p k x + b phi)}`` of the torus."""
    along = _exponentials(mode.along, mode.p)
    around = _exponentials("cos" if mode.is_even else "sin", mode.harmonic)
    return {(p, b): f * g for p, f in along.items() for b, g in around.items()}


@dataclass(frozen=True)
class TorusFunction:
    """``sum of c e^{i (p k x + b phi)}``, real: with each wave there is its opposite.

    Attributes:
        p, b: wave numbers along and around, shape (M,).
        c: coefficients, shape (M,).
    """

    __repr__ = brief

    p: Integers
    b: Integers
    c: Complex

    @classmethod
    def of(cls, known: Mapping[Mode, float]) -> TorusFunction:
        """From the coefficients of a tube's modes, their wave numbers along the tube whole numbers."""
        found: dict[tuple[int, int], complex] = {}
        for mode, value in known.items():
            for wave, factor in _waves(mode).items():
                found[wave] = found.get(wave, 0.0) + value * factor
        p, b = np.array(list(found), dtype=np.int64).reshape(-1, 2).T
        return cls(p, b, np.array(list(found.values()), dtype=complex))

    def modes(self) -> dict[Mode, float]:
        """The coefficients of the tube's modes: the inverse of ``of``, as modes are orthogonal."""
        known = {(int(p), int(b)): c for p, b, c in zip(self.p, self.b, self.c, strict=True)}
        found = {}
        for mode in product_modes(sorted({(abs(p), abs(b)) for p, b in known}), 0):
            waves = _waves(mode)
            projected = sum((factor.conjugate() * known.get(wave, 0.0)).real for wave, factor in waves.items())
            found[mode] = float(projected / sum(abs(factor) ** 2 for factor in waves.values()))
        return found

    def in_frame(self, turns: int) -> TorusFunction:
        """The same tube seen in a frame that turns by so many turns more than this one, on the tube's length."""
        return TorusFunction(self.p + self.b * turns, self.b, self.c)

    def mirrored(self) -> TorusFunction:
        """Its mirror image ``z -> -z``."""
        return TorusFunction(self.p, -self.b, self.c)

    def moved(self, along: float, around: float) -> TorusFunction:
        """``F(x + along/k, phi + around)``."""
        return TorusFunction(self.p, self.b, self.c * np.exp(1j * (self.p * along + self.b * around)))

    def at(self, p: int, b: int) -> complex:
        """One coefficient."""
        return complex(self.c[(self.p == p) & (self.b == b)].sum())

    def kept(self, which: NDArray[np.bool_]) -> TorusFunction:
        """Some of its waves."""
        return TorusFunction(self.p[which], self.b[which], self.c[which])

    def without(self, *waves: tuple[int, int]) -> TorusFunction:
        """Without some waves."""
        return self.kept(~np.any([(self.p == p) & (self.b == b) for p, b in waves], axis=0))

    def larger_than(self, tolerance: float) -> TorusFunction:
        """Its waves of more than some size."""
        return self.kept(np.abs(self.c) > tolerance)
