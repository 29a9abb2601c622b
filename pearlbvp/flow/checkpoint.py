"""States of a flow in HDF5 files, from which a run goes on that was killed. No pickle: opening one executes nothing.

Layout: attributes ``format, version, t, start``; datasets ``q, rate, multipliers, kept``; groups ``problems/0 ...`` (what
describes a discretization), ``record`` (a dataset for each column) and ``frames/0 ...`` (``t`` and ``q`` of the shapes on one
discretization).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from pearlbvp.continuation.storage import read_tree, write_tree
from pearlbvp.errors import InputError
from pearlbvp.flow.record import COLUMNS, FlowState, Frame, Record

FORMAT, VERSION = "pearlbvp flow", 1


def write_state(state: FlowState, path: Path) -> None:
    """Write a state into a new file."""
    problems = list(dict.fromkeys([*(frame.problem for frame in state.record.frames), state.problem]))
    with h5py.File(path, "w") as file:
        file.attrs.update({"format": FORMAT, "version": VERSION, "t": state.t, "start": state.record.start})
        file.attrs["problem"] = problems.index(state.problem)
        for name in ("q", "rate", "multipliers", "kept"):
            file[name] = getattr(state, name)
        for i, problem in enumerate(problems):
            write_tree(file.create_group(f"problems/{i}"), problem.to_tree())
            shapes = [frame for frame in state.record.frames if frame.problem == problem]
            if shapes:
                file[f"frames/{i}/t"] = [frame.t for frame in shapes]
                file[f"frames/{i}/q"] = [frame.q for frame in shapes]
        for name in COLUMNS:
            file[f"record/{name}"] = state.record.rows[name]


def read_state(path: Path, problem_from: Callable[[Mapping[str, Any]], Any]) -> FlowState:
    """Read a state.

    Args:
        path: a file that ``write_state`` wrote.
        problem_from: the inverse of the problems' ``to_tree``.

    Raises:
        InputError: the file cannot be opened, is no saved flow, or is not whole.
    """
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != FORMAT or int(file.attrs.get("version", 0)) != VERSION:
                raise InputError(f"resume: {path} is no flow saved by this version; save one with --save")
            return _read(file, problem_from)
    except (OSError, RuntimeError, KeyError, IndexError, ValueError, TypeError, AttributeError) as error:
        if isinstance(error, InputError):
            raise
        broken = isinstance(error, OSError)
        reason = "it is no HDF5 file, or cut off" if broken else "something is missing or misplaced in it"
        raise InputError(f"resume: {path} cannot be read as a saved flow: {reason}; save it again") from None


def _read(file: Any, problem_from: Callable[[Mapping[str, Any]], Any]) -> FlowState:
    problems = [problem_from(read_tree(file[f"problems/{i}"])) for i in range(len(file["problems"]))]
    area, volume = (float(value) for value in file.attrs["start"])
    record = Record((area, volume), {name: [float(value) for value in file["record"][name]] for name in COLUMNS})
    for i, problem in enumerate(problems):
        if f"frames/{i}" in file:
            group = file[f"frames/{i}"]
            record.frames += [
                Frame(float(t), problem, np.array(q, float)) for t, q in zip(group["t"], group["q"], strict=True)
            ]
    record.frames.sort(key=lambda frame: frame.t)
    q, rate, multipliers, kept = (np.array(file[name][()], float) for name in ("q", "rate", "multipliers", "kept"))
    problem = problems[int(file.attrs["problem"])]
    if (
        q.shape != rate.shape
        or problem.residual(q, rate, multipliers).shape != q.shape
        or multipliers.shape != kept.shape
    ):
        raise ValueError("the state does not fit its discretization")
    if len({len(values) for values in record.rows.values()}) != 1 or not np.isfinite(q).all():
        raise ValueError("columns of different lengths")
    return FlowState(problem, float(file.attrs["t"]), q, rate, multipliers, kept, record)
