"""Unduloids (``theory.unduloid``) as solutions among pearls, in the chart of large multipliers: theirs are infinite."""

from __future__ import annotations

import math

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation import Discretization, gauss_scheme
from pearlbvp.collocation.polynomial import all_points
from pearlbvp.shapes import large_multipliers
from pearlbvp.shapes.cells import HALF_CELL_LARGE
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.theory.unduloid import Unduloid


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
