"""Branches of every family on disk."""

from __future__ import annotations

import os
from typing import Any

from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.storage import KIND, UNDEFINED, branch_of_tree, branch_tree
from pearlbvp.errors import InputError
from pearlbvp.files import shortened
from pearlbvp.hdf5 import load_tree, save_tree
from pearlbvp.studies import families
from pearlbvp.studies.branch import known_branch
from pearlbvp.units import RADII, Units


def save(branch: Branch[Any], path: str | os.PathLike[str], name: str = "path", units: Units = RADII) -> None:
    """Save a branch as HDF5, whole or not at all.

    Args:
        branch: any.
        path: where to.
        name: the argument's name, for the message.
        units: in which it is shown when it is loaded.

    Raises:
        InputError: the place cannot be written to.
    """
    save_tree(name, path, KIND, branch_tree(known_branch(branch)) | {"units": units.to_tree()})


def load(path: str | os.PathLike[str], name: str = "path") -> Branch[Any]:
    """Load a branch that ``save`` saved. Nothing in the file is executed.

    Args:
        path: of the file.
        name: the argument's name, for the message.

    Raises:
        InputError: the file is no saved branch, or is not whole.
    """
    writer = "pearlbvp branch --save"

    def made(tree: dict[str, Any]) -> Branch[Any]:
        kind = tree["kind"]
        problem = families.problem(kind) if isinstance(kind, str) else None
        if isinstance(kind, str) and problem is None:
            raise InputError(
                name,
                f"{shortened(path)} holds shapes of a family that is not here, {kind!r}",
                "install or register what adds it",
            )
        return branch_of_tree(tree, {kind: problem})

    return load_tree(name, path, KIND, made, writer=writer, undefined=UNDEFINED)


def kind_of(branch: Branch[Any]) -> str:
    """``pearl``, ``ring``, ``tube`` (coils, buckles, and what branches off from those and from rings) or ``mesh``."""
    return str(branch.points[-1].problem.stored_as)


def family_of(branch: Branch[Any]) -> str:
    """``pearl``, ``ring``, ``coil`` (and what branches off from coils), ``buckle`` (and all other tubes) or ``mesh``."""
    return str(branch.points[-1].problem.family)
