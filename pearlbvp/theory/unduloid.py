"""Unduloids, tubes of constant mean curvature, in closed form: where multipliers of pearls are infinite.

With mean curvature ``H`` and shape ``B`` in (0, 1) (K. Kenmotsu, Tohoku Math. J. 32 (1980) 147), ``t = 2 H s`` from a neck at
``t = -pi/2``::

    r = sqrt(1 + B^2 + 2 B sin t) / (2 H)      dx/ds = (1 + B sin t) / sqrt(1 + B^2 + 2 B sin t)

One period is ``t`` from ``-pi/2`` to ``3 pi/2``. Gradients of area and volume are parallel there, so that an unduloid is an
equilibrium of infinite multipliers whatever ``c0``, and pearls on either side have large ones (``shapes.unduloid``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pearlbvp.helfrich import positive
from pearlbvp.roots import NoRoot, root

SAMPLES = 4096
"""Points of a period: sums over them are spectrally accurate but for the thinnest necks."""

THINNEST, ROUNDEST = 1e-6, 0.995
"""Range of ``B``: nearly a cylinder, and nearly a string of spheres."""


@dataclass(frozen=True)
class Unduloid:
    """An unduloid of given period whose area is that of a cylinder of radius 1.

    Attributes:
        period: along the axis.
        shape: ``B``.
        mean: ``H``.
        v: reduced volume.
    """

    period: float
    shape: float
    mean: float
    v: float

    @property
    def r_min(self) -> float:
        """Radius of the neck."""
        return (1 - self.shape) / (2 * self.mean)


def _integrals(shape: float) -> tuple[float, float, float]:
    """Of one period where ``H = 1``: its length, and the integrals of ``r`` and ``r^2`` along arclength and axis."""
    t = 2 * math.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES
    root_of = np.sqrt(1 + shape**2 + 2 * shape * np.sin(t))
    slope, r = (1 + shape * np.sin(t)) / root_of, root_of / 2
    return tuple(math.pi * float(part.mean()) for part in (slope, r, r**2 * slope))  # type: ignore[return-value]


def unduloid_of(period: float) -> Unduloid | None:
    """The unduloid of a period and the cylinder's area, or None where there is none: ``x^2/a`` is the period at ``H = x/l``.

    Raises:
        InputError: the period is no positive number.

    Examples:
        >>> unduloid = unduloid_of(5)
        >>> round(unduloid.mean, 6), round(unduloid.v, 6)  # where c0 is this mean curvature, the energy is zero
        (0.580587, 0.971825)
        >>> unduloid_of(6.3) is None  # longer than the circumference of the cylinder
        True
    """
    period = positive("period", period)

    def excess(shape: float) -> float:
        length, area, _ = _integrals(shape)
        return length**2 / area - period

    try:
        shape = root(excess, THINNEST, ROUNDEST, 1e-13)
    except NoRoot:
        return None
    length, _, volume = _integrals(shape)
    mean = length / period
    return Unduloid(period, shape, mean, volume / mean**3 / period)
