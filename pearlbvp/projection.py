"""Waves of a surface over the straight tube, by projecting it there (paper, Appendix B).

A point at ``x`` whose distance from the axis is ``r`` and whose angle about it is ``phi`` stands for a part of the straight
tube at ``x, phi``. So the displacement is ``r - 1 = A e^{i(kx + n phi)} + B e^{i(kx - n phi)} + c.c. + other waves``, ``A``
and ``B`` being integrals over the straight tube, as the amplitude equations take them (``theory.amplitude``). Parts are
counted with their orientation: where a surface overhangs or folds over, what it covers three times counts once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.representation import brief

COVERED = 0.01
"""Share of the straight tube by which a surface's projection may miss it, by quadrature; else the axis is not inside of it."""


ROUNDING = 1e-14
"""Amplitude, by the largest radius, of waves that are the rounding of their sums."""


@dataclass(frozen=True)
class Projection:
    """Points of a surface, each standing for a part of the straight tube, all of shape (K,).

    Attributes:
        x, phi, r: cylindrical coordinates.
        share: the part's share of the straight tube, negative where it is seen from inside.
    """

    __repr__ = brief

    x: Array
    phi: Array
    r: Array
    share: Array

    @property
    def covers(self) -> bool:
        """Whether the surface goes around the axis once everywhere, as far as its area tells."""
        return abs(self.share.sum() - 1) < COVERED

    def amplitudes(self, k: float, along: NDArray[np.intp], around: NDArray[np.intp]) -> NDArray[np.complex128]:
        """``A`` (first) and ``B`` of waves ``p k`` along the tube and ``n`` around it: shape (2, len(along), len(around))."""
        weighted = (self.share / self.share.sum() * (self.r - 1))[:, None] * np.exp(-1j * k * np.outer(self.x, along))
        turned = np.exp(-1j * np.outer(self.phi, around))
        return np.stack((weighted.T @ turned, weighted.T @ turned.conj()))

    def wave(self, k: float, most: tuple[int, int], *, fold: int = 1, turns: float = 0.0) -> float:
        """``2 A`` of the largest wave of the displacement: it is ``2 A cos(kx + n phi)`` and waves that are not larger.

        A shift across the axis, ``k = 0`` and ``n = 1``, is no wave. Coils have ``B = 0``, buckles ``B = A``.

        Args:
            k: unit of the wave numbers along the tube.
            most: largest wave numbers looked at, along, and around in units of ``fold``.
            fold: waves around the tube are multiples of this.
            turns: of the frame about the axis in which ``phi`` is measured, on the wavelength of ``k``: there a shift has as
                many waves along.

        Returns:
            The amplitude, a length; NaN where the axis is not inside of the surface.
        """
        if not self.covers:
            return math.nan
        along, around = np.arange(most[0] + 1), fold * np.arange(most[1] + 1)
        sizes = np.abs(self.amplitudes(k, along, around))
        sizes[:, 0, 0] = 0.0  # the mean radius
        shift = np.ix_([0, 1] if turns == 0 else [0], along == turns, around == 1)
        sizes[shift] = 0.0
        largest = 2 * float(sizes.max())
        return largest if largest > ROUNDING * np.abs(self.r).max() else 0.0


def of_section(curve: NDArray[np.complex128], step: NDArray[np.complex128], x: float | Array = 0.0) -> Projection:
    """The projection of closed plane sections.

    Args:
        curve: points of each section about the axis, at equal distances of a parameter, shape (..., K).
        step: derivative by that parameter times its distance.
        x: the sections' places, of a shape that goes with ``curve``'s.
    """
    turned = (curve.conj() * step).imag / np.abs(curve) ** 2
    places = np.broadcast_to(x, curve.shape)
    share = turned / (2 * math.pi) / (curve.size / curve.shape[-1])
    return Projection(places.ravel(), np.angle(curve).ravel(), np.abs(curve).ravel(), share.ravel())
