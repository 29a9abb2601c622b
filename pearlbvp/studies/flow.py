"""Flows in files; where they begin and end is in ``studies.flow_start`` and ``studies.flow_end``."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pearlbvp.errors import InputError
from pearlbvp.files import writable, write_whole
from pearlbvp.flow.axisymmetric import GraphFlow
from pearlbvp.flow.checkpoint import read_state, write_state
from pearlbvp.flow.mesh import MeshFlow
from pearlbvp.flow.problem import FlowProblem
from pearlbvp.flow.record import FlowState
from pearlbvp.flow.tube import TubeFlow

KINDS: dict[str, Any] = {"graph": GraphFlow, "tube": TubeFlow, "mesh": MeshFlow}


def _problem(tree: Mapping[str, Any]) -> FlowProblem:
    """A discretization from what a file says of it."""
    found: FlowProblem = KINDS[str(tree["kind"])].from_tree(tree)
    return found


def save(state: FlowState, path: str | os.PathLike[str]) -> None:
    """Save a flow's state and record as HDF5, whole or not at all.

    Raises:
        InputError: the place cannot be written to.
    """
    write_whole("save", writable("save", path), lambda temporary: write_state(state, temporary))


def load(path: str | os.PathLike[str]) -> FlowState:
    """Load what ``save`` saved. Nothing in the file is executed.

    Raises:
        InputError: the file is no saved flow, or is not whole.
    """
    if not Path(path).is_file():
        raise InputError(f"resume: there is no file {path}; give one that --save wrote")
    return read_state(Path(path), _problem)
