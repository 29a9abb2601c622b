"""Unduloids, tubes of constant mean curvature, in closed form: where multipliers of pearls are infinite.

With mean curvature ``H`` and shape ``B`` in (0, 1) (K. Kenmotsu, Tohoku Math. J. 32 (1980) 147), ``t = 2 H s`` from a neck at
``t = -pi/2``::

    r = sqrt(1 + B^2 + 2 B sin t) / (2 H)      dx/ds = (1 + B sin t) / sqrt(1 + B^2 + 2 B sin t)

One period is ``t`` from ``-pi/2`` to ``3 pi/2``. Gradients of area and volume are parallel there, so that an unduloid is an
equilibrium of infinite multipliers whatever ``c0`` (``shapes.large_multipliers``), and pearls on either side have large ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation import Discretization, gauss_scheme
from pearlbvp.collocation.polynomial import all_points
from pearlbvp.roots import NoRoot, root
from pearlbvp.shapes import large_multipliers
from pearlbvp.shapes.cells import HALF_CELL_LARGE
from pearlbvp.shapes.pearl import PearlProblem

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


def _integrals(shape: float) -> tuple[float, float, float]:
    """Of one period where ``H = 1``: its length, and the integrals of ``r`` and ``r^2`` along arclength and axis."""
    t = 2 * math.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES
    root_of = np.sqrt(1 + shape**2 + 2 * shape * np.sin(t))
    slope, r = (1 + shape * np.sin(t)) / root_of, root_of / 2
    return tuple(math.pi * float(part.mean()) for part in (slope, r, r**2 * slope))  # type: ignore[return-value]


def unduloid_of(period: float) -> Unduloid | None:
    """The unduloid of a period and the cylinder's area, or None where there is none: ``x^2/a`` is the period at ``H = x/l``."""

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


def unduloid_pearl(
    c0: float, unduloid: Unduloid, *, cells: int = 1, intervals: int = 24, tolerance: float = 1e-9
) -> tuple[PearlProblem, Array]:
    """An unduloid as a solution among pearls, from belly to neck, in the chart of large multipliers.

    Args:
        c0: spontaneous curvature.
        unduloid: one period.
        cells: such periods on the tube.
        intervals: of the mesh.
        tolerance: of the profile.
    """
    scheme, mesh = gauss_scheme(6), np.linspace(0, 1, intervals + 1)
    b, h = unduloid.shape, unduloid.mean
    t = math.pi / 2 + math.pi * all_points(mesh, scheme)
    size = np.sqrt(1 + b**2 + 2 * b * np.sin(t))
    r, cosine, sine = size / (2 * h), (1 + b * np.sin(t)) / size, b * np.cos(t) / size
    around = cosine / r
    gauss = (2 * h - around) * around
    g = h * (h - around) ** 2 + c0 * gauss - c0**2 * h
    # d(cos psi/r)/ds = -2 (sin psi/r)(cos psi/r - h), by Codazzi's equation where h is constant.
    by_s = -2 * sine / r * (around - h)
    omega = (-2 * h * (h - around) + c0 * (2 * h - 2 * around)) * by_s
    states = np.column_stack((r, np.arctan2(sine, cosine), g, omega))
    parameters = np.array([math.pi / (2 * h), 0.0, h, c0, unduloid.period / 2, unduloid.v])
    free = ("arclength", "compliance", "mean", "v")
    weights = large_multipliers.weights_of(1.0, True)
    discretization = Discretization(HALF_CELL_LARGE, scheme, mesh, parameters, free, weights)
    return PearlProblem(discretization, None, tolerance, cells=cells), discretization.pack(states, parameters)
