"""What a flow leaves behind: a row for every accepted step, shapes along the way, how it ended."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.flows.problem import FlowProblem
from pearlbvp.force import with_force
from pearlbvp.quantities import NUMBER
from pearlbvp.representation import brief
from pearlbvp.units import RADII, Units, headed

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ("t", "E", "lambda1", "lambda2", "area_error", "volume_error", "velocity", "v", "amplitude", "r_min", "r_max", "M",
           "force")  # fmt: skip


Status = Literal[
    "steady",
    "saddle",
    "time",
    "pinch",
    "overhang",
    "unresolved",
    "stalled",
    "steps",
    "seconds",
    "interrupted",
    "saved",
]

MOST_FRAMES = 400


@dataclass(frozen=True)
class Frame:
    """A shape on the way.

    Attributes:
        t: when.
        problem, q: its discretization and coordinates.
    """

    __repr__ = brief

    t: float
    problem: FlowProblem
    q: Array


@dataclass
class Record:
    """Rows of all accepted steps, and shapes at some of them, thinned out evenly when they become many.

    Attributes:
        start: area and volume that the flow started with.
        rows: named as ``COLUMNS``.
        frames: shapes, the first and the last among them.
    """

    start: tuple[float, float]
    rows: dict[str, list[float]] = field(default_factory=lambda: {name: [] for name in COLUMNS})
    frames: list[Frame] = field(default_factory=list)

    def __repr__(self) -> str:
        return f"Record({len(self.rows['t'])} rows, {len(self.frames)} frames)"

    def add(self, t: float, problem: FlowProblem, q: Array, multipliers: Array, velocity: float) -> dict[str, float]:
        """Write down a step; returns its observables."""
        found = problem.observables(q, multipliers)
        area, volume = self.start
        row = with_force(found) | {
            "t": t, "velocity": velocity, "area_error": found["area"] / area - 1,
            "volume_error": found["volume"] / volume - 1,
        }  # fmt: skip
        for name, values in self.rows.items():
            values.append(row[name])
        if len(self.frames) >= MOST_FRAMES:
            self.frames[:] = self.frames[::2]
        self.frames.append(Frame(t, problem, q.copy()))
        return found

    def copy(self) -> Record:
        """A record that can grow by itself."""
        return Record(self.start, {name: list(values) for name, values in self.rows.items()}, list(self.frames))

    def table(self) -> pd.DataFrame:
        """A row for every accepted step: ``COLUMNS``, and ``area, v_reduced`` before ``M, force``.

        The area is by that of the straight tube, ``s = A/(2 pi L)``; ``v/s^2`` is the reduced volume of the similar shape at
        ``s = 1``, as branches have it (``studies.flow_end``).
        """
        import pandas as pd

        table = pd.DataFrame(self.rows)
        last = {name: table.pop(name) for name in ("M", "force")}
        area = self.start[0] * (1 + table["area_error"])
        return table.assign(area=area, v_reduced=table["v"] / area**2, **last)


@dataclass(frozen=True)
class Equilibrium:
    """The steady state that Newton's method finds from a flow's last shape.

    Attributes:
        problem, q, multipliers: the shape.
        converged: whether it is one; else it is the flow's last shape.
        growth_rates: the largest, in the space of the discretization, rigid motions left out.
        message: empty, or why Newton's method failed.
    """

    __repr__ = brief

    problem: FlowProblem
    q: Array
    multipliers: Array
    converged: bool
    growth_rates: Array
    message: str = ""

    @property
    def stable(self) -> bool:
        """Whether no perturbation in the discretization's space grows."""
        return bool(self.growth_rates[0] < NEUTRAL)

    @property
    def observables(self) -> Mapping[str, float]:
        """As the problem has them, and the axial force."""
        return with_force(self.problem.observables(self.q, self.multipliers))


NEUTRAL = 1e-7
"""Growth rates of this size are zero to the accuracy of a polished steady state."""


@dataclass(frozen=True)
class FlowState:
    """Everything that a flow needs to go on.

    Attributes:
        problem: the discretization at this time.
        t: time.
        q, rate, multipliers: coordinates, their rates, multipliers.
        kept: values of the constraints that the flow keeps.
        record: all that came before.
    """

    __repr__ = brief

    problem: FlowProblem
    t: float
    q: Array
    rate: Array
    multipliers: Array
    kept: Array
    record: Record

    def columns(self, units: Units) -> pd.DataFrame:
        """Its table in the user's unit (``Units.columns``); the area is by that of the straight tube."""
        return units.of_flow(self.problem.law).columns(self.record.table(), area=NUMBER)


@dataclass(frozen=True)
class FlowResult:
    """How a flow went.

    Attributes:
        state: the last one, whatever happened.
        status: ``steady`` (velocity and spectrum say so), ``saddle`` (at rest on an unstable shape), ``time``, ``pinch``,
            ``overhang``, ``unresolved`` (no more points to be had), ``stalled``, ``steps``, ``seconds``, ``interrupted``;
            ``saved`` of one that a file holds.
        reason: one line for a reader: what happened, when, where; a ``Sentence``, which can be read in any unit of length.
        advice: what to try, or empty.
        equilibrium: the polished end state, where the flow came to rest.
    """

    state: FlowState
    status: Status
    reason: str
    advice: str = ""
    equilibrium: Equilibrium | None = None

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.status} at t = {self.state.t:.6g}, {self.state.record!r}: {self.reason})"

    def table(self, units: Units = RADII) -> pd.DataFrame:
        """A row for every accepted step.

        Args:
            units: of the numbers; physical ones stand in the names of the columns: ``t[nm/Pa]``.
        """
        return headed(self.state.columns(units))

    def uninterrupted(self) -> FlowResult:
        """The same, for who builds on how a flow ends.

        Raises:
            KeyboardInterrupt: somebody interrupted it, which says nothing of that.
        """
        if self.status == "interrupted":
            raise KeyboardInterrupt
        return self

    @property
    def complete(self) -> bool:
        """Whether the flow ended as flows should: at rest on a stable shape, or at the time asked for."""
        return self.status in ("steady", "time")

    def largest_rise(self) -> float:
        """Largest rise of the energy from one step to the next, relative to the energy; remeshing or refining is no step."""
        return float(self._changes(steps=True).max(initial=0.0))

    def largest_jump(self) -> float:
        """Largest change of the energy by remeshing or refining, up or down, relative to the energy."""
        return float(np.abs(self._changes(steps=False)).max(initial=0.0))

    def _changes(self, steps: bool) -> Array:
        """Relative changes of the energy in time steps, or at one time."""
        energy, t = (np.array(self.state.record.rows[name]) for name in ("E", "t"))
        return np.asarray(np.diff(energy)[(np.diff(t) > 0) == steps] / np.abs(energy).max())
