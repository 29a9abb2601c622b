"""Strings of equal spheres on tethers, known in closed form: a way to pearls of thin necks, which few random starts come to."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.path import PathEnd
from pearlbvp.continuation.solution import Solution
from pearlbvp.errors import SpectrumError
from pearlbvp.helfrich import Tube
from pearlbvp.shapes.outline import Outline, downhill
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.studies.search import Search
from pearlbvp.studies.starts import branch_of, computed

HALF_WAY = 0.5
"""From the straight tube's volume to that of spheres that fill the area: there necks are no thinner than need be."""


def strings_of_spheres(
    tube: Tube, found: Search, low: float, high: float, unstable: int,
    follow: Callable[[Solution[PearlProblem]], Branch[PearlProblem]],
) -> None:  # fmt: skip
    """Follow branches that strings of spheres come to downhill, called ``spheres 2`` of two of them.

    Args:
        tube: the straight tube. So many spheres of its area fit where it is longer than their diameters, two radii each.
        found: what is known, to which they are added: shapes on that are left out.
        low, high: range of volumes.
        unstable: directions that are unstable at most on what is followed.
        follow: makes of a shape the branch through it.
    """
    for count in range(1, math.ceil(tube.length / 2)):
        v = 1 + HALF_WAY * (2 / 3 * math.sqrt(tube.length / (2 * count)) - 1)
        shape = _string(tube, count, min(max(v, low), high))
        if shape is not None and shape.spectrum.n_unstable <= unstable and not branch_of(shape, found.pieces):
            found.add(f"spheres {count}", follow(shape))


def _string(tube: Tube, count: int, v: float) -> Solution[PearlProblem] | None:
    """The pearls that so many spheres of a volume come to downhill, as equal ones; None if to none."""
    outline = Outline.on(Tube(tube.c0, tube.length / count), v)
    try:
        return computed(*downhill(outline, outline.sphere_on_tether(), cells=count))
    except (ValueError, PathEnd, SpectrumError, np.linalg.LinAlgError):
        return None
