"""The straight tube at a given tension with solute in it: its radius, and the waves that grow on it, in closed form.

Lengths are in radii of the straight tube without a pressure difference, so that ``lambda1 = 1/4 - c0^2``. A tube of volume
``v pi L`` with solute in it feels van 't Hoff's pressure ``lambda2 = osmolarity - solute / v``, both measured as pressures are
(``docs/theory/osmotic.md``). A tube of radius ``s`` is in equilibrium where ``lambda2 = (1 - s^2)/(4 s^3)`` (paper, eq. (4)
with ``H = 1/(2s)``, ``K = 0``), and similar to one of radius 1 with ``c0 s``, ``lambda2 s^3`` and waves ``k s``.
"""

from __future__ import annotations

import math

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.helfrich import finite, positive
from pearlbvp.theory.dispersion import growth_rate

MOST_WAVES = 8
"""Waves around the tube up to which growing ones are counted; those of ``n > 2`` would need a large ``c0``."""


def osmotic_work(v: float, solute: float, osmolarity: float) -> float:
    """Potential of the pressure by length, ``pi (osmolarity v - solute log v)``: ``lambda2`` is its derivative by ``pi v``."""
    return math.pi * (osmolarity * v - solute * math.log(v))


def straight_size(solute: float, osmolarity: float) -> float:
    """Radius of the straight tube that the law allows; there is one, at which a change of radius costs energy.

    ``4 osmolarity s^3 + s^2 - 4 solute s - 1 = 0``, whose coefficients change their sign once (Descartes).
    """
    return float(_positive_roots(4 * osmolarity, 1.0, -4 * solute, -1.0)[-1])


def straight_potential(c0: float, solute: float, osmolarity: float) -> float:
    """Energy, tension times area and ``osmotic_work`` of that tube by length."""
    size = straight_size(solute, osmolarity)
    bending = (1 / (2 * size) - c0) ** 2 + 0.25 - c0**2
    return 2 * math.pi * size * bending + osmotic_work(size**2, solute, osmolarity)


def onset_sizes(c0: float, period: float) -> Array:
    """Radii of the straight tube between which waves of a period grow, smaller first: two, or none where they never grow.

    Roots of the growth rate on the similar tube of radius 1 (paper, eq. (eigs)):

        mu = -(k^2 s^2 - 1)^2/2 + (1 - s^2)(k^2 s^2 - 1)/4 - (1 - 2 c0 s) k^2 s^2

    Raises:
        InputError: the curvature is no number, or the period no positive one.

    Examples:
        >>> onset_sizes(0.4, 8).round(4).tolist()
        [1.2431, 1.6662]
    """
    c0, period = finite("c0", c0), positive("period", period)
    kappa = (2 * math.pi / period) ** 2
    return _positive_roots(-kappa / 4 - kappa**2 / 2, 2 * c0 * kappa, (kappa + 1) / 4, 0.0, -0.75)


def straight_unstable(c0: float, size: float, length: float) -> int:
    """How many waves grow on a straight tube of a radius and a length; shifts and the one change of radius do not."""
    lambda2, c0 = (1 - size**2) / 4, c0 * size
    per_k = length / (2 * math.pi * size)
    largest = 2 + 2 * math.sqrt(abs(lambda2) + abs(1 - 2 * c0))  # all waves beyond this wave number decay
    m, n = np.meshgrid(np.arange(1 + math.ceil(largest * per_k)), np.arange(MOST_WAVES + 1), indexing="ij")
    grows = growth_rate(m / per_k, n, lambda2, c0) > 1e-12
    grows[0, :2] = False
    return int((np.where(m == 0, 1, 2) * np.where(n == 0, 1, 2))[grows].sum())


def _positive_roots(*coefficients: float) -> Array:
    """Positive real roots of a polynomial, highest power first, in order."""
    roots = np.roots(coefficients)
    real = roots[np.abs(roots.imag) < 1e-9 * np.abs(roots)].real
    return np.sort(real[real > 0])
