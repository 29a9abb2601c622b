"""Where branches of each family end: what its discretization cannot describe, or not to the accuracy that counts need."""

from __future__ import annotations

from typing import Any

from pearlbvp.continuation.branch import BranchPoint
from pearlbvp.continuation.two_parameters import CurveOnSurface
from pearlbvp.errors import SpectrumError
from pearlbvp.mesh.problem import MeshProblem
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.tube.problem import TubeProblem
from pearlbvp.units import Sentence

THINNEST_NECK = 4e-3
"""Radius of the neck at which a branch of pearls ends: beyond, rounding spoils the count of unstable waves."""

RESOLVED = 1e-4
"""Error of the growth rates of pearls, by the fourth power of their wave number, beyond which a branch ends rather than count
wrongly."""

RESOLVED_TUBE = 1e-6
"""The same of tubes in reduced modes, as rigid motions show it."""


def limit(point: BranchPoint[Any]) -> str | None:
    """Why a branch of pearls, tubes or meshes, or a curve in two parameters, ends at a point with its shapes, or None.

    Raises:
        SpectrumError: its growth rates are not known well enough to go on counting.
    """
    problem = point.point.problem
    base = problem.base if isinstance(problem, CurveOnSurface) else problem
    if isinstance(base, TubeProblem):
        return _tube_limit(base, point)
    if isinstance(base, MeshProblem):
        _check_mesh(point)
        return None
    return _pearl_limit(base, point)


def _check_mesh(point: BranchPoint[Any]) -> None:
    if not point.spectrum.complete:
        raise SpectrumError("not all unstable perturbations were found; take a finer mesh")


def _pearl_limit(problem: PearlProblem, point: BranchPoint[Any]) -> str | None:
    if not point.spectrum.complete:
        n = max(block.n for block in point.spectrum.rates)
        text = f"waves of more than n = {n} around the tube grow: its tension is {{lambda1:.3g}}"
        text += "; stop before, or take fewer pearls"
        raise SpectrumError(Sentence(text, lambda1=point.observables["lambda1"]))
    if point.spectrum.residual > RESOLVED * problem.wave_number**4:
        text = "its spectrum is known to {rate:.0e} only, at a neck of {r_min:.1e}; stop before, at an r_min say"
        raise SpectrumError(Sentence(text, rate=point.spectrum.residual, r_min=point.observables["r_min"]))
    if point.observables["r_min"] < THINNEST_NECK:
        return f"the neck is thinner than {THINNEST_NECK:g} radii: the surface is about to touch its axis"
    return None


def _tube_limit(problem: TubeProblem, point: BranchPoint[Any]) -> str | None:
    if point.observables["r_min"] <= 0:
        return "a cross-section is no longer star-shaped about its centre, as reduced modes need it"
    if point.spectrum.kernel > RESOLVED_TUBE * problem.wave_number**4:
        size = " x ".join(str(most) for most in problem.size if most)
        text = (
            f"its growth rates are known to {{rate:.0e}} only, as its rigid motions show: {size} modes do not resolve it; stop "
            "before, or follow the branch on a mesh (--nodes)"
        )
        raise SpectrumError(Sentence(text, rate=point.spectrum.kernel))
    return None
