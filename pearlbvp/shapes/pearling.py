"""Where pearls leave the straight tube (paper, §3), and the family that they are."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation import Discretization, gauss_scheme
from pearlbvp.collocation.polynomial import all_points
from pearlbvp.errors import InputError
from pearlbvp.held import Held
from pearlbvp.helfrich import SHORT_WAVE, Tube, WaveNumbers, cylinder_lambda1
from pearlbvp.membrane import Family, Start, checked_tolerance
from pearlbvp.shapes import large_multipliers
from pearlbvp.shapes.cells import HALF_CELL
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.theory.dispersion import onset_lambda2
from pearlbvp.units import Sentence

LONGEST = 1000.0
"""Longest period of a branch of pearls: its meshes grow with it."""


@cache
def _uniform_mesh(intervals: int) -> Array:
    mesh = np.linspace(0.0, 1.0, intervals + 1)
    mesh.flags.writeable = False
    return mesh


def pearling_onset(
    tube: Tube, m: int = 1, *, intervals: int = 8, degree: int = 6, tolerance: float = 1e-9
) -> tuple[PearlProblem, Array, Array]:
    """The straight cylinder where pearls of period ``L/m`` branch off, and the direction in which they do.

    Args:
        tube: the straight tube.
        m: number of pearls on it; the problem is that of one of them.
        intervals: of the first mesh on the half cell.
        degree: Gauss points an interval.
        tolerance: of the profile, for remeshing.

    Returns:
        The half-cell problem, the unknown at onset and the unit tangent of the pearls, thick at ``sigma = 0``. The
        Jacobian there is singular twice over: pearls and cylinders cross.

    Raises:
        InputError: pearls branch off nowhere there: their period is ``2 pi`` (``k = 1``), or they are far too short.
    """
    k = tube.wave_number(m)
    onset = onset_lambda2(tube, m, 0)
    half = tube.length / m / 2
    parameters = np.array([half, cylinder_lambda1(onset, tube.c0), onset, tube.c0, half, 1.0])
    free = ("arclength", "lambda1", "lambda2", "v")
    short = max(k / SHORT_WAVE, 1.0)
    weights = large_multipliers.weights_of(short, False)
    discretization = Discretization(
        HALF_CELL, gauss_scheme(degree), _uniform_mesh(intervals), parameters, free, weights
    )
    x = half * all_points(discretization.mesh, discretization.scheme)
    one = np.ones_like(x)
    u = discretization.pack(np.column_stack((one, 0 * one, one / 2, 0 * one)), parameters)
    # delta r = cos kx, psi = delta r', delta h = (k^2 - 1)/2 cos kx (errata: remark rerem1), w = delta h'
    bend = (k**2 - 1) / 2
    wave = np.column_stack((np.cos(k * x), -k * np.sin(k * x), bend * np.cos(k * x), -bend * k * np.sin(k * x)))
    tangent = discretization.pack(wave, np.zeros_like(parameters))
    tangent /= math.sqrt(discretization.inner(tangent, tangent))
    return PearlProblem(discretization, None, tolerance, cells=m, wave_number=short), u, tangent


def pearl_start(tube: Tube, mode: WaveNumbers, held: Held, tolerance: float | None) -> Start:
    """The straight tube where pearls of a mode leave it.

    Raises:
        InputError: there are no such pearls, or they are too long.
    """
    m, n = mode
    if n != 0 or m < 1:
        raise InputError("mode", f"pearls have n = 0, so {m},{n} is none of them", f"give {max(m, 1)},0")
    onset_lambda2(tube, m, 0)
    if tube.length / m > LONGEST:
        text = f"pearls of period {{period:g}} are longer than {LONGEST:g} radii"
        raise InputError("length", Sentence(text, period=tube.length / m), "take more of them")
    problem, u, direction = pearling_onset(tube, m, tolerance=checked_tolerance(tolerance, 1e-9))
    return replace(problem, held=held), u, direction


FAMILIES = (Family("pearl", (1, 0), "m,0", pearl_start, PearlProblem, accurate=True),)
