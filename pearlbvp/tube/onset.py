"""The straight tube where a family of tubes branches off, and the direction in which it does."""

from __future__ import annotations

from functools import partial
from typing import Literal, get_args

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError
from pearlbvp.held import AREA_AND_VOLUME, Held
from pearlbvp.helfrich import Tube, WaveNumbers
from pearlbvp.membrane import Family, Start
from pearlbvp.theory.amplitude import amplitude_equation
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.problem import PLANE_TOLERANCE, TubeProblem
from pearlbvp.tube.symmetry import buckle_symmetry, coil_symmetry, pearl_symmetry, ring_symmetry

Kind = Literal["pearl", "ring", "coil", "buckle"]


def onset(
    tube: Tube, family: Kind, m: int, n: int, *, size: tuple[int, int] | None = None, held: Held = AREA_AND_VOLUME
) -> tuple[TubeProblem, Array, Array]:
    """The straight tube where a family branches off, and the direction in which it does.

    Args:
        tube: the straight tube.
        family: of the branch.
        m, n: waves along and around the tube.
        size: largest wave numbers at first, in periods and folds; more are taken where needed.
        held: what is held while stability is judged.

    Raises:
        InputError: the family does not branch off at that mode, or is not built for it.
    """
    equation = amplitude_equation(tube, (m, n))
    equation.cubic(family)  # refuses a family that does not branch off there
    symmetry = {
        "pearl": lambda: pearl_symmetry(m),
        "ring": lambda: ring_symmetry(n),
        "coil": lambda: coil_symmetry(m, n),
        "buckle": lambda: buckle_symmetry(m, n),
    }[family]()
    sizes = {"pearl": (16, 0), "ring": (0, 16), "coil": (10, 10) if symmetry.period else (0, 16), "buckle": (10, 10)}
    tolerance = PLANE_TOLERANCE if symmetry.period and symmetry.fold else TubeProblem.tolerance
    problem = TubeProblem(symmetry, tube.c0, tube.length, size or sizes[family], tolerance=tolerance, held=held)
    u, direction = np.zeros(len(problem.modes) + 3), np.zeros(len(problem.modes) + 3)
    u[problem.modes.index(Mode("sigma", 0))] = 1.0
    u[-3:] = equation.lambda1, equation.lambda2, 1.0
    direction[problem.modes.index(symmetry.onset_mode)] = 1.0
    if family == "coil" and symmetry.period:  # cos(m k x - n phi)
        direction[problem.modes.index(Mode("sigma", m, "sin", n, "sin"))] = 1.0
    return problem, u, direction


def tube_start(kind: Kind, tube: Tube, mode: WaveNumbers, held: Held, tolerance: float | None) -> Start:
    """The straight tube where a kind of tubes leaves it, in reduced modes.

    Raises:
        InputError: it does not leave there, or an accuracy is given, which modes have none of.
    """
    if tolerance is not None:
        raise InputError("tolerance", "it is for pearls and rings", f"leave it out with {kind}s")
    others = amplitude_equation(tube, mode).families
    if kind not in others:
        raise InputError(
            "mode", f"{mode[0]},{mode[1]} is none of a {kind}, but of a {' and a '.join(others)}", "give another"
        )
    return onset(tube, kind, *mode, held=held)


FAMILIES = tuple(Family(kind, (1, 1), "m,n", partial(tube_start, kind), TubeProblem) for kind in ("coil", "buckle"))

IN_MODES = {kind: partial(tube_start, kind) for kind in get_args(Kind)}
"""Where tubes of every kind leave the straight one, in reduced modes: pearls and rings, too."""
