"""Flows in files; where they begin and end is in ``studies.flow_start`` and ``studies.flow_end``."""

from __future__ import annotations

import os
from collections.abc import Mapping
from importlib import import_module
from typing import Any

from pearlbvp.flows.checkpoint import KIND, state_of_tree, state_tree
from pearlbvp.flows.problem import FlowProblem
from pearlbvp.flows.record import FlowResult, FlowState
from pearlbvp.hdf5 import load_tree, save_tree
from pearlbvp.units import RADII, Sentence, Units

KINDS = {"graph": ("axisymmetric", "GraphFlow"), "tube": ("tube", "TubeFlow"), "mesh": ("mesh", "MeshFlow")}
"""Where the discretizations are, so that each is imported only by who needs it."""


def _problem(tree: Mapping[str, Any]) -> FlowProblem:
    """A discretization from what a file says of it."""
    file, name = KINDS[str(tree["kind"])]
    found: FlowProblem = getattr(import_module(f"pearlbvp.flows.{file}"), name).from_tree(tree)
    return found


def save(state: FlowState, path: str | os.PathLike[str], name: str = "path", units: Units = RADII) -> None:
    """Save a flow's state and record as HDF5, whole or not at all.

    Args:
        state: of a flow.
        path: where to.
        name: the argument's name, for the message.
        units: in which it is shown when it is loaded.

    Raises:
        InputError: the place cannot be written to.
    """
    save_tree(name, path, KIND, state_tree(state) | {"units": units.to_tree()})


def load(path: str | os.PathLike[str], name: str = "path") -> FlowState:
    """Load what ``save`` saved. Nothing in the file is executed.

    Args:
        path: of the file.
        name: the argument's name, for the message.

    Raises:
        InputError: the file is no saved flow, or is not whole.
    """
    writer = "pearlbvp flow --save"
    return load_tree(name, path, KIND, lambda tree: state_of_tree(tree, _problem), writer=writer)


def result(state: FlowState) -> FlowResult:
    """A flow that was saved: how far it had got."""
    return FlowResult(state, "saved", Sentence("it was saved at t = {t:.6g}", t=state.t), "resume it")
