"""Branches of every family on disk, and on from there."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from pearlbvp.continuation.branch import Branch, BranchOptions, BranchPoint, continue_branch
from pearlbvp.continuation.storage import KIND, UNDEFINED, branch_of_tree, branch_tree
from pearlbvp.hdf5 import load_tree, save_tree
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


def save(branch: Branch[Any], path: str | os.PathLike[str], name: str = "path") -> None:
    """Save a branch as HDF5, whole or not at all.

    Args:
        branch: any.
        path: where to.
        name: the argument's name, for the message.

    Raises:
        InputError: the place cannot be written to.
    """
    save_tree(name, path, KIND, branch_tree(branch))


def load(path: str | os.PathLike[str], name: str = "path") -> Branch[Any]:
    """Load a branch that ``save`` saved. Nothing in the file is executed.

    Args:
        path: of the file.
        name: the argument's name, for the message.

    Raises:
        InputError: the file is no saved branch, or is not whole.
    """
    writer = "pearlbvp branch --save"
    return load_tree(name, path, KIND, lambda tree: branch_of_tree(tree, KINDS), writer=writer, undefined=UNDEFINED)


def kind_of(branch: Branch[Any]) -> str:
    """``pearl``, ``ring``, ``tube`` (coils, buckles, and what branches off from those and from rings) or ``mesh``."""
    return str(branch.points[-1].point.problem.stored_as)


def family_of(branch: Branch[Any]) -> str:
    """``pearl``, ``ring``, ``coil`` (and what branches off from coils), ``buckle`` (and all other tubes) or ``mesh``."""
    return str(branch.points[-1].point.problem.family)


def resumed(branch: Branch[Any], options: BranchOptions) -> Branch[Any]:
    """A branch continued from its last point; that and what follows as one branch.

    Raises:
        InputError: nothing can follow.
    """
    if kind_of(branch) == "ring":
        return rings.ring_resumed(branch, options)
    whole = replace(options, progress=lambda so_far: options.progress(branch.extended(so_far)))
    if len(branch.points) == 1 and branch.complete:  # where a flow ended: it has no direction yet
        branch = replace(branch, points=[_towards(branch.points[0], options.until)])
    return branch.extended(continue_branch(branch.points[-1].point, whole, at_bifurcation=branch.ends_at_bifurcation))


def _towards(entry: BranchPoint[Any], until: Mapping[str, float]) -> BranchPoint[Any]:
    """A point with its tangent turned to where the first of some wanted values lies, if it is not one of stability.

    Where branches cross, every observable turns, and their two directions have the same shapes.
    """
    point = entry.point
    for name, value in until.items():
        if name in point.observables:
            ahead, behind = (point.problem.observables(point.u + s * point.tangent)[name] for s in (1e-5, -1e-5))
            turned = abs(ahead - behind) > TURNING and (ahead - behind) * (value - point.observables[name]) < 0
            return replace(entry, point=replace(point, tangent=-point.tangent)) if turned else entry
    return entry


TURNING = 1e-12
"""Difference of an observable over 2e-5 of arclength that is the rounding of one that turns."""


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
