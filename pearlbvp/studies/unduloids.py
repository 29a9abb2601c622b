"""Pearls beside unduloids, which are known in closed form: a way to their branches from where multipliers are infinite."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.path import correct_at
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.switching import tangent_along
from pearlbvp.errors import SpectrumError
from pearlbvp.helfrich import Tube
from pearlbvp.newton import NewtonOptions
from pearlbvp.shapes.unduloid import unduloid_pearl
from pearlbvp.studies.search import Search
from pearlbvp.theory.unduloid import Unduloid, unduloid_of
from pearlbvp.units import Sentence

BESIDE = 0.05
"""Compliance ``1/lambda1`` at which pearls beside an unduloid are computed: multipliers are large there, and finite."""

MEETING = 1e-6
"""Difference of the volumes of an unduloid and of where a branch passes one."""


def beside_unduloids(
    tube: Tube, found: Search, low: float, high: float, unstable: int, follow: Callable[[Solution[Any]], Branch[Any]]
) -> None:
    """Follow branches of equal pearls through the unduloids that a tube has, called ``unduloid 2`` of two periods.

    Args:
        tube: the straight tube.
        found: the branches that are known, to which they are added: what those pass is left out.
        low, high: range of volumes.
        unstable: directions that are unstable at most on the side that is followed.
        follow: makes of a shape the branch through it.
    """
    pearls = 1
    while (unduloid := unduloid_of(tube.length / pearls)) is not None or tube.wave_number(pearls) <= 1:
        if unduloid is not None and unduloid.v < low:
            break
        if (
            unduloid is not None
            and unduloid.v <= high
            and not any(_passes(b, pearls, unduloid) for b in found.branches.values())
        ):
            # On the second side the tension is large and negative, and many waves grow.
            sides = (beside(tube, pearls, unduloid, side) for side in (BESIDE, -BESIDE))
            shape = next((s for s in sides if s is not None and s.spectrum.n_unstable <= unstable), None)
            if shape is not None:
                found.add(f"unduloid {pearls}", follow(shape))
        pearls += 1


def why_none(tube: Tube, pearls: int) -> str:
    """Why pearls that leave the straight tube pass no unduloid, to be appended to the reason of their end; empty if they may.

    Where ``c0`` is its mean curvature an unduloid is of energy zero, an equilibrium at all multipliers with ``lambda2 = -2 c0
    lambda1``, and the pearls from the straight tube cross it at one of them. At larger ``c0`` they turn there to infinite
    multipliers, at smaller ``c0`` away from them (``docs/theory/unduloids.md``).
    """
    unduloid = unduloid_of(tube.length / pearls)
    if unduloid is None:
        return "; no unduloid has this area and a period of 2 pi radii or more: take more pearls"
    if tube.c0 > unduloid.mean:
        return ""
    return Sentence(
        "; the unduloid of this period lies on other pearls, which phases finds (--starts): those that leave the straight tube "
        "reach it where c0 is above its mean curvature, {c0:.6g}",
        c0=unduloid.mean,
    )


def _passes(branch: Branch[Any], pearls: int, unduloid: Unduloid) -> bool:
    """Whether a branch of as many equal pearls passes an unduloid."""
    return any(
        abs(branch.at(special).value("v") - unduloid.v) < MEETING and branch.at(special).problem.repeats[0] == pearls
        for special in branch.find("cmc")
    )


def beside(tube: Tube, pearls: int, unduloid: Unduloid, compliance: float) -> Solution[Any] | None:
    """Pearls beside an unduloid, at a compliance ``1/lambda1``; None where they cannot be computed.

    Energies are smooth there, and ``-2 dE/dv = lambda2`` is infinite: the volume turns. So the compliance is what to step in.
    """
    problem, guess = unduloid_pearl(tube.c0, unduloid, cells=pearls)
    place = len(guess) - len(problem.free) + problem.free.index("compliance")
    guess[place] = compliance
    result, _ = correct_at(problem, guess, NewtonOptions(), place)
    if not result.converged:
        return None
    plain, (v,) = problem.plain(result.u)
    upwards = np.zeros_like(v)
    upwards[-1] = 1.0
    try:
        return Solution.along(plain, v, tangent_along(plain, v, upwards)).computed()
    except (SpectrumError, np.linalg.LinAlgError):
        return None
