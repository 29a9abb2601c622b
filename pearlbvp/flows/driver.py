"""The flow's differential-algebraic system, stepped by SUNDIALS IDA (scikit-sundae), for every discretization.

``M(q) q_t + grad E + lambda grad c = 0``, ``c(q) - c(q(0)) = epsilon lambda``. With ``epsilon = 0`` the system has index 2.
A tiny ``epsilon`` makes it the gradient flow of ``E + |c - c(q(0))|^2/(2 epsilon)``: the energy still falls, and where the
constraints' gradients become parallel (surfaces of constant mean curvature, the straight tube), the multiplier of what they
no longer tell apart stays bounded, where that of the index-2 system is undetermined. (J. W. Barrett, H. Garcke, R. Nürnberg,
SIAM J. Sci. Comput. 31 (2008) 225, eq. (2.8) drop one constraint there.)

IDA's error test is made for index 1: the multipliers get an absolute tolerance at which it ignores them (L. Petzold, SIAM J.
Sci. Stat. Comput. 3 (1982) 367). Its Newton iteration stops when the shape is good to a fraction of ``atol``, which leaves the
constraints at the square of the last correction, some 1e-8: every accepted shape is moved by that much back onto them. The
solver never raises: its status is looked at after every single step.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError, Interruption
from pearlbvp.flows.integrator import Tolerances, integrator
from pearlbvp.flows.problem import FlowProblem
from pearlbvp.flows.record import Equilibrium, FlowResult, FlowState, Record, Status
from pearlbvp.flows.steady import polished
from pearlbvp.units import Sentence


@dataclass(frozen=True)
class FlowOptions:
    """When a flow ends and how it is stepped.

    Attributes:
        until: time at which it ends.
        velocity: largest normal velocity at which a stable shape is steady.
        rtol, atol, max_order: of IDA's error test, and the highest order of its formulas. Order 4 takes a tenth fewer steps to
            rest than 3, and for errors below 1e-7 a third fewer; of order 5 some flows take more.
        max_steps, max_seconds: it gives up after these.
        resolution: finest details, as the discretization estimates them, beyond which it is refined (None: its own choice).
        compliance: ``epsilon`` above; the constraints are kept to this times the multipliers.
        checkpoint: called with the state so far, now and then, to show or to save it.
        every: seconds between its calls.
    """

    until: float = math.inf
    velocity: float = 1e-6
    rtol: float = 1e-6
    atol: float = 1e-8
    max_order: int = 4
    max_steps: int = 20000
    max_seconds: float = 600.0
    resolution: float | None = None
    compliance: float = 1e-14
    checkpoint: Callable[[FlowState], None] = lambda state: None
    every: float = 10.0

    def __post_init__(self) -> None:
        for name in ("until", "velocity", "rtol", "atol", "max_steps", "max_seconds", "resolution", "every"):
            if getattr(self, name) is not None and not getattr(self, name) > 0:
                raise InputError(name, f"{getattr(self, name)!r} must be positive", "give a number above 0")
        if not 1 <= self.max_order <= 5:
            raise InputError("max_order", f"{self.max_order} is not between 1 and 5", "the formulas have no others")


PARALLEL = 1e-14
"""Ratio of the singular values of the constraints' Gram matrix below which their gradients are parallel to rounding."""

UNRESOLVED = 1e-5
"""Size of the finest details at which a flow ends that cannot be refined any more."""

SLOW = 1e3
"""Velocities below this many times that of a steady shape are looked at without rigid motions, which takes a while."""

NEXT = 1e-13
"""Relative difference of two times that IDA can tell apart."""

STANDING, MOST_STANDING = 1e-12, 200
"""Length of steps by the time reached, and how many of such in a row are no progress: before a shape that cannot be evaluated
IDA may creep on for ever."""

RESTARTS = 4
"""Failures of IDA in a row, each followed by a fresh start at low order, after which a flow is stalled."""


def first_rates(problem: FlowProblem, q: Array) -> tuple[Array, Array, bool]:
    """Rate and multipliers of the flow at a shape, from the ``k x k`` system ``c_q q_t = 0``.

    Returns:
        Rate, multipliers, and whether the constraints are parallel: then the multipliers are the smallest of those that do
        best (least squares).
    """
    still, rows = np.zeros_like(q), problem.constraint_rows(q)
    columns = problem.columns(q)
    zero = np.zeros(columns.shape[1])
    force = problem.residual(q, still, zero)
    gram = rows @ problem.resistance(q, columns)
    singular = np.linalg.svd(gram, compute_uv=False)
    parallel = bool(singular[-1] <= PARALLEL * max(singular[0], 1e-300)) or bool(singular[0] < 1e-12)
    multipliers = np.asarray(np.linalg.lstsq(gram, -rows @ problem.resistance(q, force), rcond=PARALLEL)[0])
    return -problem.resistance(q, force + columns @ multipliers), multipliers, parallel


def start(problem: FlowProblem, q: Array) -> FlowState:
    """The state of a flow at time 0, its constraints those of the shape.

    Args:
        problem, q: the shape.

    Raises:
        InputError: the shape is no surface, or is the straight tube, which rests and where the constraints are parallel.
    """
    q = np.asarray(q, dtype=float)
    if not np.isfinite(q).all() or not np.isfinite(problem.constraints(q)).all():
        raise InputError(
            "q", "the shape is not finite, or has a radius of 0 or below", "start from another, or perturb it less"
        )
    trouble = problem.trouble(q)
    if trouble is not None:
        raise InputError("q", trouble.place, "start from a smoother shape")
    rate, multipliers, parallel = first_rates(problem, q)
    if parallel and np.abs(problem.velocity(q, rate)).max() < 1e-9:
        raise InputError(
            "q",
            "the shape is the straight tube, where area and volume have parallel gradients and nothing moves",
            "perturb it",
        )
    found = problem.observables(q, multipliers)
    record = Record((found["area"], found["volume"]))
    record.add(0.0, problem, q, multipliers, float(np.abs(problem.velocity(q, rate)).max()))
    return FlowState(problem, 0.0, q, rate, multipliers, problem.constraints(q), record)


def constrained(problem: FlowProblem, q: Array, kept: Array, normally: bool = False) -> Array:
    """The shape moved along the constraints' gradients until they have given values, by Newton's method.

    Where the gradients are parallel, what cannot be reached by them stays as it is (least squares). Gradients are those by
    the coordinates, or ``normally`` by normal displacements, which are the same in all discretizations.
    """
    for _ in range(8):
        lack = problem.constraints(q) - kept
        if np.abs(lack).max() < 1e-14:
            break
        ways = problem.columns(q)
        ways = problem.resistance(q, ways) if normally else ways
        q = q - ways @ np.linalg.lstsq(problem.constraint_rows(q) @ ways, lack, rcond=PARALLEL)[0]
    return q


def flow(problem: FlowProblem, q: Array, options: FlowOptions | None = None) -> FlowResult:
    """Let a shape flow until it rests, or until a time, or until it can no longer be described.

    Args:
        problem: the semi-discrete flow.
        q: coordinates of the shape.
        options: when to end and how to step.

    Returns:
        The result: everything up to its end, whatever happened.

    Raises:
        InputError: the start cannot be used.
    """
    return resumed(start(problem, q), options)


def resumed(state: FlowState, options: FlowOptions | None = None) -> FlowResult:
    """The flow from a state on; see ``flow``."""
    run = _Run(replace(state, record=state.record.copy()), options or FlowOptions())
    ending = INTERRUPTED
    with Interruption():
        ending = run.to_its_end()
    status, reason, advice, equilibrium = ending
    said = Sentence.joined(Sentence("at t = {t:.6g} ", t=run.state.t), reason)
    return FlowResult(run.state, status, said, advice, equilibrium)


class _Ending(NamedTuple):
    """How a run ends; see ``FlowResult``."""

    status: Status
    reason: str
    advice: str = ""
    equilibrium: Equilibrium | None = None


INTERRUPTED = _Ending("interrupted", "it was interrupted", "resume it, if it was saved")


class _Run:
    """A run of the integrator: its state after the last accepted step, and what it watches."""

    def __init__(self, state: FlowState, options: FlowOptions) -> None:
        self.state, self.options = state, options
        self.begun = self.saved = time.monotonic()
        self.rest, self.least = _Rest(options.velocity), math.inf
        self.failures = self.steps = self.standing = 0
        self._restart(state)

    def _restart(self, state: FlowState) -> None:
        """A new integrator at a state: IDA begins with short steps of low order, some twenty of them."""
        o = self.options
        tolerances = Tolerances(o.rtol, o.atol, o.max_order, o.compliance)
        self.state = state
        self.solver = integrator(state.problem, state.t, state.q, state.rate, state.multipliers, state.kept, tolerances)

    def to_its_end(self) -> _Ending:
        """Step until something ends the flow."""
        if self.options.until <= self.state.t * (1 + NEXT):
            return _Ending("time", "the time asked for is over")
        while True:
            ending = self._step()
            if ending is None:
                ending = self._caps()
            if ending is not None:
                return ending

    def _step(self) -> _Ending | None:
        """One step, or one failure of the solver; why the flow ends here, or None."""
        until = self.options.until if math.isfinite(self.options.until) else None
        found = self.solver.step(until or 2 * self.state.t + 1e12, method="onestep", tstop=until)
        y, yp = np.array(found.y).ravel(), np.array(found.yp).ravel()
        self.steps += 1
        if not found.success or not np.isfinite(y).all() or not np.isfinite(yp).all() or found.t <= self.state.t:
            return self._failed(str(found.message))
        self.failures = 0
        self.standing = self.standing + 1 if found.t - self.state.t < STANDING * found.t else 0
        if self.standing > MOST_STANDING:
            return self._given_up("its steps have become so short that time stands still")
        state, size = self.state, len(self.state.q)
        problem, q = state.problem, constrained(state.problem, y[:size], state.kept)
        self.state = replace(state, t=float(found.t), q=q, rate=yp[:size], multipliers=y[size:])
        velocity = float(np.abs(problem.velocity(q, yp[:size])).max())
        state.record.add(self.state.t, problem, q, y[size:], velocity)
        trouble = problem.trouble(q)
        if trouble is not None:
            return _Ending(trouble.kind, trouble.place, trouble.advice)
        velocity = min(velocity, self._of_the_shape(velocity))
        self.rest.saw(velocity)
        return self._remeshed() or self._resolved() or self._at_rest(velocity)

    def _of_the_shape(self, velocity: float) -> float:
        """Largest normal velocity without rigid motions: a mesh's error lets shapes creep over it long after they rest."""
        if not self.state.problem.creeps or velocity > SLOW * self.options.velocity:
            return velocity
        problem, q, rate = self.state.problem, self.state.q, self.state.rate
        motions = problem.kernels(q, self.state.multipliers)
        moved = problem.metric(q) @ motions.T
        rigid = np.linalg.lstsq(motions @ moved, moved.T @ rate, rcond=1e-12)[0]
        return float(np.abs(problem.velocity(q, rate - rigid @ motions)).max())

    def _failed(self, message: str) -> _Ending | None:
        """After a failure the integrator starts afresh from the last accepted shape, a few times."""
        self.failures += 1
        if self.failures > RESTARTS:
            return self._given_up(message)
        rate, multipliers, _ = first_rates(self.state.problem, self.state.q)
        self._restart(replace(self.state, rate=rate, multipliers=multipliers))
        return None

    def _given_up(self, message: str) -> _Ending:
        """The integrator cannot go on."""
        trouble = self.state.problem.trouble(self.state.q)
        reason = Sentence.joined(f"the solver gave up ({message})", *(("; ", trouble.place) if trouble else ()))
        return _Ending("stalled", reason, "loosen rtol, or take more points")

    def _remeshed(self) -> _Ending | None:
        """Go on in other coordinates where these no longer fit."""
        problem = self.state.problem
        try:
            found = problem.remeshed(self.state.q)
        except InputError as error:
            reason = f"no mesh fits the surface any more ({error})"
            return _Ending("unresolved", reason, "give more nodes")
        if found is not None:
            self._go_on(*found)
        return None

    def _go_on(self, problem: FlowProblem, q: Array) -> None:
        """Another discretization of the shape at the same time: a second row says what that changed."""
        state = _moved(self.state, problem, q)
        velocity = float(np.abs(problem.velocity(state.q, state.rate)).max())
        state.record.add(state.t, problem, state.q, state.multipliers, velocity)
        self._restart(state)

    def _resolved(self) -> _Ending | None:
        """Refine where details grow that the discretization does not resolve."""
        problem = self.state.problem
        detail = problem.resolution(self.state.q)
        self.least = min(self.least, detail)
        wanted = self.options.resolution or problem.wanted_resolution
        # Details of the start that are on their way out need no more points, those of a shape at rest do.
        if detail <= wanted or (detail <= 3 * self.least and not self.rest.reached):
            return None
        finer = problem.refined(self.state.q)
        if finer is not None:
            self._go_on(*finer)
            self.least, self.rest.reached = math.inf, False
        elif detail > UNRESOLVED:
            where = "the shape has finer details than can be described"
            return _Ending("unresolved", where, "stop before, or choose another discretization")
        return None

    def _at_rest(self, velocity: float) -> _Ending | None:
        """Whether the shape rests: the velocity says so, and the spectrum of the polished shape."""
        if not self.rest.due(velocity):
            return None
        state = self.state
        end = polished(state.problem, state.q, state.multipliers, state.kept)
        if end.stable:
            return _Ending("steady", self._rests(end), "", end)
        if self.rest.for_good(velocity):
            return _Ending("saddle", self._rests(end), "perturb that shape by its most unstable vector", end)
        return None

    def _rests(self, end: Equilibrium) -> Sentence:
        """What a flow at rest says of its shape."""
        stable = "stable" if end.stable else "unstable"
        said = Sentence(
            f"it rests on a shape that is {stable} among {self.state.problem.space}: the largest growth rate is {{rate:.3g}}",
            rate=float(end.growth_rates[0]),
        )
        whole = self.state.record.rows["velocity"][-1]
        if whole <= self.options.velocity:
            return said
        return Sentence.joined(
            said, Sentence("; as a whole it creeps at {velocity:.1e}, by the mesh's error", velocity=whole)
        )

    def _caps(self) -> _Ending | None:
        """The limits of time and effort; now and then a checkpoint."""
        o, now = self.options, time.monotonic()
        if self.state.t >= o.until:
            return _Ending("time", "the time asked for is reached")
        if self.steps >= o.max_steps:
            return _Ending("steps", f"max_steps = {self.steps} are done", "resume it, or take more steps")
        if now - self.begun > o.max_seconds:
            return _Ending(
                "seconds",
                f"max_seconds = {o.max_seconds:g} are over",
                "resume it, if it was saved, or give it more time",
            )
        if now - self.saved > o.every:
            self.saved = now
            o.checkpoint(self.state)
        return None


def _moved(state: FlowState, problem: FlowProblem, q: Array) -> FlowState:
    """A state on another discretization; the constraints keep their values."""
    q = constrained(problem, q, state.kept)
    rate, multipliers, _ = first_rates(problem, q)
    return replace(state, problem=problem, q=q, rate=rate, multipliers=multipliers)


@dataclass
class _Rest:
    """When to look whether a slow flow rests: below a velocity, and after a saddle only once it is ten times slower.

    Attributes:
        velocity: below which it may be at rest.
        looked: velocity at the last look, of this visit.
        reached: whether it is slow enough to look now.
    """

    velocity: float
    looked: float = math.inf
    reached: bool = False

    def saw(self, velocity: float) -> None:
        """Take note of a step's velocity."""
        if velocity >= self.velocity:
            self.looked = math.inf
        self.reached = velocity < self.velocity and velocity < self.looked / 10

    def due(self, velocity: float) -> bool:
        """Whether it is time to look; this is the look."""
        if self.reached:
            self.looked = velocity
        return self.reached

    def for_good(self, velocity: float) -> bool:
        """Whether an unstable shape will not be left in reasonable time."""
        return velocity < 1e-4 * self.velocity
