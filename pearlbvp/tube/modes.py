"""Functions that tubes and their perturbations are sums of.

A cross-section is ``P(x, phi) = e^{i kappa x} (d(x) + sigma(x, phi) e^{i phi})``: its centre ``d = d_y + i d_z`` and the radius
``sigma`` about it, without its first harmonic, which the centre carries (``docs/theory/reduced_modes.md``).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Array

Part = Literal["sigma", "y", "z"]


class Mode(NamedTuple):
    """One function: of ``sigma``, or of the centre's coordinate ``y`` or ``z``.

    Attributes:
        part: what it is a part of.
        p: wave number along the tube, in some unit.
        along: ``cos`` or ``sin``.
        b: wave number around the tube; 0 for a part of the centre.
        around: ``cos`` or ``sin``.
    """

    part: Part
    p: int
    along: str = "cos"
    b: int = 0
    around: str = "cos"

    @property
    def harmonic(self) -> int:
        """Wave number around the tube of what it moves points by: 1 for the centre."""
        return self.b if self.part == "sigma" else 1

    @property
    def is_even(self) -> bool:
        """Whether it is even in ``phi``."""
        return self.around == "cos" if self.part == "sigma" else self.part == "y"


def sections(known: Mapping[Mode, float], k: float, kappa: float, x: Array, phi: Array) -> NDArray[np.complex128]:
    """Points ``P(x, phi)`` of a sum of modes on a grid, in the plane across the axis: shape (len(x), len(phi)).

    Args:
        known: coefficients by mode.
        k, kappa: unit of the wave numbers along the tube, and the rate at which the frame turns.
        x, phi: places along and around the tube.
    """
    most_p, most_b = (max(numbers) for numbers in zip(*((m.p, m.b) for m in known), strict=True))
    centre = np.zeros((2, most_p + 1), dtype=complex)
    radius = np.zeros((2, most_p + 1, 2, most_b + 1))
    for mode, value in known.items():
        place = int(mode.along == "sin"), mode.p
        if mode.part == "sigma":
            radius[(*place, int(mode.around == "sin"), mode.b)] = value
        else:
            centre[place] += value if mode.part == "y" else 1j * value
    angles = [np.outer(np.arange(most_p + 1), k * x), np.outer(np.arange(most_b + 1), phi)]
    along, around = (np.concatenate((np.cos(angle), np.sin(angle))) for angle in angles)
    radii = along.T @ radius.reshape(len(along), len(around)) @ around
    moved = (centre.ravel() @ along)[:, None] + radii * np.exp(1j * phi)
    return np.asarray(np.exp(1j * kappa * x)[:, None] * moved)
