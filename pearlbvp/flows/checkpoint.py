"""States of a flow as trees of arrays, numbers and words, from which a run goes on that was killed; see ``hdf5`` for the files.

Layout: ``t, area, volume`` (those of the start), ``problem`` (its number); arrays ``q, rate, multipliers, kept``;
``problems/0 ...`` (what describes a discretization), ``record`` (each column) and ``frames/0 ...`` (``t`` and ``q`` of the
shapes on one discretization).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from pearlbvp.flows.record import COLUMNS, FlowState, Frame, Record

KIND = "pearlbvp flow"
"""What files of flows call themselves."""

STATE = ("q", "rate", "multipliers", "kept")


def state_tree(state: FlowState) -> dict[str, Any]:
    """A state as a tree."""
    record = state.record
    problems = list(dict.fromkeys([*(frame.problem for frame in record.frames), state.problem]))
    area, volume = record.start
    frames = {}
    for i, problem in enumerate(problems):
        shapes = [frame for frame in record.frames if frame.problem == problem]
        if shapes:
            frames[str(i)] = {"t": np.array([s.t for s in shapes]), "q": np.array([s.q for s in shapes])}
    return {
        "t": state.t,
        "area": area,
        "volume": volume,
        "problem": problems.index(state.problem),
        **{name: getattr(state, name) for name in STATE},
        "problems": {str(i): problem.to_tree() for i, problem in enumerate(problems)},
        "record": {name: np.array(record.rows[name]) for name in COLUMNS},
        "frames": frames,
    }


def state_of_tree(tree: Mapping[str, Any], problem_from: Callable[[Mapping[str, Any]], Any]) -> FlowState:
    """The inverse of ``state_tree``.

    Args:
        tree: as ``state_tree`` makes it.
        problem_from: the inverse of the problems' ``to_tree``.

    Raises:
        ValueError, LookupError, TypeError: something is missing in the tree, or does not fit.
    """
    problems = [problem_from(tree["problems"][str(i)]) for i in range(len(tree["problems"]))]
    rows = {name: [float(value) for value in tree["record"][name]] for name in COLUMNS}
    record = Record((float(tree["area"]), float(tree["volume"])), rows)
    for i, shapes in tree["frames"].items():
        problem = problems[int(i)]
        record.frames += [Frame(float(t), problem, q) for t, q in zip(shapes["t"], shapes["q"], strict=True)]
    record.frames.sort(key=lambda frame: frame.t)
    problem = problems[tree["problem"]]
    q, rate, multipliers, kept = (tree[name] for name in STATE)
    fits = q.shape == rate.shape and multipliers.shape == kept.shape
    if not fits or problem.residual(q, rate, multipliers).shape != q.shape:
        raise ValueError("the state does not fit its discretization")
    if len({len(values) for values in rows.values()}) != 1 or not record.frames:
        raise ValueError("columns of different lengths")
    return FlowState(problem, float(tree["t"]), q, rate, multipliers, kept, record)
