"""Branches of every family on disk, and on from there."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from pearlbvp.continuation.branch import Branch, BranchOptions, BranchPoint, continue_branch
from pearlbvp.continuation.path import Point
from pearlbvp.continuation.storage import read_branch, write_branch
from pearlbvp.errors import InputError
from pearlbvp.files import writable, write_whole
from pearlbvp.mesh.problem import MeshProblem
from pearlbvp.mesh.spectrum import MeshSpectrum
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.shapes.ring import RingProblem
from pearlbvp.stability.planar import PlanarSpectrum
from pearlbvp.stability.spectrum import Spectrum
from pearlbvp.studies import branch as pearls
from pearlbvp.studies import mesh as meshes
from pearlbvp.studies import ring as rings
from pearlbvp.studies import tube as tubes
from pearlbvp.tube.problem import TubeProblem
from pearlbvp.tube.spectrum import TubeSpectrum

KINDS = {
    "pearl": (PearlProblem.from_tree, Spectrum.from_tree),
    "ring": (RingProblem.from_tree, PlanarSpectrum.from_tree),
    "tube": (TubeProblem.from_tree, TubeSpectrum.from_tree),
    "mesh": (MeshProblem.from_tree, MeshSpectrum.from_tree),
}
"""How problems and spectra of a branch are read, by the kind that its file names."""


def save(branch: Branch[Any], path: str | os.PathLike[str]) -> None:
    """Save a branch as HDF5, whole or not at all.

    Raises:
        InputError: the place cannot be written to.
    """
    write_whole("save", writable("save", path), lambda temporary: write_branch(branch, temporary))


def load(path: str | os.PathLike[str]) -> Branch[Any]:
    """Load a branch that ``save`` saved. Nothing in the file is executed.

    Raises:
        InputError: the file is no saved branch, or is not whole.
    """
    if not Path(path).is_file():
        raise InputError(f"resume: there is no file {path}; give one that --save wrote")
    return read_branch(Path(path), KINDS)


def kind_of(branch: Branch[Any]) -> str:
    """``pearl``, ``ring``, ``tube`` (coils, buckles, and what branches off from those and from rings) or ``mesh``."""
    return str(branch.points[-1].point.problem.stored_as)


def family_of(branch: Branch[Any]) -> str:
    """``pearl``, ``ring``, ``coil`` (and what branches off from coils) or ``buckle`` (and all other tubes)."""
    if kind_of(branch) != "tube":
        return kind_of(branch)
    return "coil" if branch.points[-1].point.problem.symmetry.turns else "buckle"


def resumed(branch: Branch[Any], options: BranchOptions) -> Branch[Any]:
    """A branch continued from its last point; that and what follows as one branch.

    Raises:
        InputError: nothing can follow.
    """
    if kind_of(branch) == "ring":
        return rings.ring_resumed(branch, options)
    whole = replace(options, progress=lambda so_far: options.progress(branch.extended(so_far)))
    last = branch.points[-1]
    if len(branch.points) > 1 or _is_bifurcation(last):
        further = continue_branch(last.point, whole, at_bifurcation=len(branch.points) == 1)
    else:  # where a flow ended: it has no direction yet
        start = _towards(last.point, options.until)
        branch = Branch([replace(last, point=start)], branch.special, branch.reason, branch.complete)
        further = continue_branch(start, whole)
    return branch.extended(further)


def _is_bifurcation(start: BranchPoint[Any]) -> bool:
    """Whether a branch leaves another at its first point: a growth rate of its own kind is zero there."""
    rates = start.spectrum.rates.get(start.point.problem.own_block, np.zeros(0))
    return bool((np.abs(rates) < NEUTRAL).any())


NEUTRAL = 1e-6
"""Growth rates below this, at the first point of a branch, are those of the bifurcation that it starts at."""


def _towards(point: Point[Any], until: Mapping[str, float]) -> Point[Any]:
    """A point with its tangent turned to where the first of some wanted values lies, if it is not one of stability."""
    for name, value in until.items():
        if name in point.observables:
            ahead, behind = (point.problem.observables(point.u + s * point.tangent)[name] for s in (1e-5, -1e-5))
            if (ahead - behind) * (value - point.observables[name]) < 0:
                return replace(point, tangent=-point.tangent)
            break
    return point


def switched(
    branch: Branch[Any], number: int, options: BranchOptions, *, centre: Any = "pearl", grow: bool = True
) -> Branch[Any]:
    """The branch that crosses ``branch`` at its branch point ``number`` (the first is 1).

    Args:
        branch: a branch of any family.
        number: which of its branch points.
        options: where to stop and how to step.
        centre: of pearls: whether the new shapes are centred on a pearl or on a neck.
        grow: which half of a pitchfork is followed.

    Raises:
        InputError: there is no such branch point, or its new shapes cannot be followed.
    """
    kind = kind_of(branch)
    if kind == "pearl":
        return pearls.switched(branch, number, options, centre=centre, grow=grow)
    if kind == "ring":
        return rings.ring_switched(branch, number, options, grow=grow)
    if kind == "mesh":
        return meshes.mesh_switched(branch, number, options, grow=grow)
    return tubes.tube_switched(branch, number, options, grow=grow)
