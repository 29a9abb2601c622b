"""Branches of solutions of a user's own boundary-value problem, in one of its parameters."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.bvp.solve import BvpSolution
from pearlbvp.collocation import Collocated, Discretization, equidistribute, error_estimate, intervals_for
from pearlbvp.continuation.branch import SpecialPoint
from pearlbvp.continuation.crossing import crossing_direction
from pearlbvp.continuation.following import BranchOptions, continue_branch, kept
from pearlbvp.continuation.path import PathEnd, PathOptions
from pearlbvp.continuation.problem import Problem
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.continuation.switching import tangent_along
from pearlbvp.errors import InputError
from pearlbvp.representation import brief

if TYPE_CHECKING:
    import pandas as pd

Observables = Mapping[str, Callable[[BvpSolution], float]]


@dataclass(frozen=True)
class Own:
    """The one block of a problem that knows no symmetry and no stability."""

    multiplicity: int = 1

    def __str__(self) -> str:
        return ""


@dataclass(frozen=True)
class BvpProblem(Collocated, Problem):
    """A user's problem on a mesh, as ``continuation`` takes it; the last free parameter is the one that is varied.

    Attributes:
        discretization: collocation of the problem.
        like: a solution whose interval and tolerances are those of all.
        functions: of a solution, the observables beside the parameters.
    """

    __repr__ = brief

    discretization: Discretization
    like: BvpSolution
    functions: Observables

    @property
    def trivial_block(self) -> Own:
        """The one block."""
        return Own()

    @property
    def conserved(self) -> str:
        """The varied parameter: where it turns, the problem with it fixed is singular, and else at branch points only."""
        return self.discretization.free[-1]

    def at(self, u: Array) -> BvpSolution:
        """The solution with an unknown."""
        return replace(self.like, discretization=self.discretization, u=u, iterations=0, tangent=None)

    def observables(self, u: Array) -> dict[str, float]:
        """All parameters, then what the user asked for."""
        solution = self.at(u)
        return solution.parameters | {name: float(function(solution)) for name, function in self.functions.items()}

    def remesh(self, u: Array, *others: Array) -> tuple[BvpProblem, list[Array]] | None:
        """The problem on a mesh fitted to ``u``, with tangents moved there; None if the mesh will do."""
        d, tolerance = self.discretization, self.like.tolerance
        polynomial = d.polynomial(u)
        if float(error_estimate(polynomial).max()) <= tolerance:
            return None
        intervals = min(max(intervals_for(polynomial, tolerance / 10), len(d.h)), 2 * len(d.h) + 4)
        if intervals > self.like.max_intervals:
            raise PathEnd(f"{intervals} intervals are needed, more than max_intervals = {self.like.max_intervals}")
        discretization, moved = d.on_mesh(equidistribute(polynomial, intervals), u, *others)
        return replace(self, discretization=discretization), moved

    def transfer(self, other: BvpProblem, u: Array) -> Array:
        """An unknown that lives on another problem's mesh, moved onto this one's."""
        if np.array_equal(other.discretization.mesh, self.discretization.mesh):
            return u
        return other.discretization.on_mesh(self.discretization.mesh, u)[1][0]

    def spectrum(self, u: Array) -> Spectrum:
        """The signed distance to singularity, in the form of a growth rate."""
        return Spectrum({self.trivial_block: self._distance(u)}, math.nan, 0.0, complete=False)

    def block_rates(self, u: Array, block: Any, like: Spectrum) -> Array:
        """The one number of the one block, shape (1,)."""
        return self._distance(u)

    def _distance(self, u: Array) -> Array:
        return np.array([self.discretization.signed_distance(u, _of_parameter(u))])


def _of_parameter(u: Array, sign: float = 1.0) -> Array:
    """The row of the varied parameter among the unknowns."""
    row = np.zeros(u.size)
    row[-1] = sign
    return row


@dataclass(frozen=True)
class BvpBranch:
    """A branch of solutions, with what is special on it.

    Attributes:
        points: the solutions in order along the branch, special points among them. What was located between two points is on
            the mesh of the one before: there ``error`` may be somewhat above the tolerance.
        special: what happens at some of them: ``start``, ``fold:NAME``, ``bp``, ``stop``, ``end``.
        reason: why the branch ends.
        complete: whether it ends where it was asked to.
        observed: parameters and observables of each point.
    """

    points: list[BvpSolution]
    special: list[SpecialPoint]
    reason: str
    complete: bool
    observed: list[dict[str, float]] = field(repr=False)

    def __repr__(self) -> str:
        kinds = "".join(
            f"\n  point {s.index}: {s.kind}" for s in self.special if s.kind not in ("start", "stop", "end")
        )
        return f"branch of {len(self.points)} solutions{kinds}\n  end: {self.reason}"

    def find(self, kind: str) -> list[SpecialPoint]:
        """The special points of a kind, in order; ``fold`` finds all folds."""
        return [s for s in self.special if kind in (s.kind, s.kind.split(":")[0])]

    def at(self, special: SpecialPoint) -> BvpSolution:
        """The solution at a special point."""
        return self.points[special.index]

    def table(self) -> pd.DataFrame:
        """A row a point: ``point, special``, all parameters, all observables."""
        import pandas as pd

        kinds = [",".join(s.kind for s in self.special if s.index == index) for index in range(len(self.points))]
        numbered = enumerate(zip(kinds, self.observed, strict=True))
        return pd.DataFrame([{"point": index, "special": kind} | observed for index, (kind, observed) in numbered])


def norm(solution: BvpSolution) -> float:
    """Root of the mean square of all states."""
    return math.sqrt(float(solution.mean(lambda t, y, p: (y**2).sum(axis=1))))


def continue_bvp(
    solution: BvpSolution,
    vary: str,
    *,
    until: Mapping[str, float] | None = None,
    observables: Observables | None = None,
    folds: Sequence[str] = (),
    direction: int = 0,
    across: bool = False,
    step: float | None = None,
    max_step: float = 0.5,
    max_points: int = 200,
) -> BvpBranch:
    """Follow a solution in one parameter, around folds, with folds and branch points located.

    The parameters in ``free`` of the solution follow from the conditions as before; all others keep their values. Branch
    points are those where the determinant of the linearised problem changes its sign though the parameter does not turn:
    two in one step are missed, and so are those at which two branches cross this one at once. Stability is not judged: a
    boundary-value problem has none.

    Args:
        solution: a solution, from ``solve_bvp`` or of a branch.
        vary: name of the parameter.
        until: stop exactly where a parameter or observable has a value, ``{"lam": 2.0}``, or at a special point of a
            number, ``{"fold:lam": 1}``, ``{"bp": 2}``; the start is none.
        observables: named functions of a solution, for the table and for ``until``; ``norm`` by default. They should vary
            smoothly: take ``s.extremes(0)[1]`` rather than ``s.y[:, 0].max()``.
        folds: further parameters and observables whose turning points are located; those of ``vary`` always are.
        direction: 1 or -1, whether the parameter grows at the start (from a fold or branch point of a branch: on along it or
            back). 0 goes on along the branch that the solution is of, or else towards the value in ``until``, or else up.
        across: the solution is a branch point of a branch in ``vary``: follow the branch that crosses it there. On its half
            1 the first state grows where it first changes by more than half as much as anywhere, on -1 it falls.
        step: the first step, in the root mean square of all states and free parameters together.
        max_step: the largest, likewise.
        max_points: stop after so many.

    Returns:
        The branch. A failing step ends it with a ``reason``. Where the start has the wanted value, it is the start alone.

    Raises:
        InputError: an argument that cannot be used.

    Examples:
        ``x^2 = lam - 1`` as a boundary-value problem, with its fold.

        >>> import numpy as np
        >>> from pearlbvp.bvp import solve_bvp
        >>> solution = solve_bvp(
        ...     lambda t, y, p: 0 * y, lambda ya, yb, p: ya**2 - p + 1, None, [1.0], {"lam": 2.0}
        ... )
        >>> branch = continue_bvp(solution, "lam", direction=-1, until={"fold:lam": 1})
        >>> print(f"{branch.points[-1].parameters['lam']:.9f}")
        1.000000000
    """
    if not solution.success:
        raise InputError("solution", f"it is none ({solution.message})", "solve the problem first")
    if direction not in (-1, 0, 1):
        raise InputError("direction", f"{direction!r} is none of 1, -1 and 0", "1 begins towards larger values")
    problem, u = _problem(solution, vary, {"norm": norm} if observables is None else observables)
    options = _options(problem.observables(u), vary, until or {}, folds, step, max_step, max_points)
    singular = abs(problem._distance(u)[0]) < NEUTRAL
    # Only along the parameter that is varied still is it the tangent of this branch.
    along = solution.tangent if solution.discretization.free == problem.discretization.free else None
    if across:
        tangent = _across(problem, u, along if singular else None, direction or 1)
    elif along is not None and (direction == 0 or singular):
        tangent = along * (direction or 1)
    else:
        sign = direction or math.copysign(1.0, options.until.get(vary, math.inf) - u[-1])
        tangent = _towards(problem, u, sign)
    start = Solution.along(problem, u, tangent)
    branch = kept(lambda watched: continue_branch(start, watched, at_bifurcation=bool(singular)), options)
    points = branch.points
    return BvpBranch(
        [replace(p.problem.at(p.u), tangent=p.tangent) for p in points],
        branch.special,
        branch.reason,
        branch.complete,
        [dict(p.observables) for p in points],
    )


NEUTRAL = 1e-6
"""Distance to singularity below which a start is a fold or branch point itself, as ``continuation`` has it for growth rates."""


def _towards(problem: BvpProblem, u: Array, sign: float) -> Array:
    """The tangent along which the varied parameter grows, or falls."""
    try:
        return tangent_along(problem, u, _of_parameter(u, sign))
    except np.linalg.LinAlgError:
        raise InputError(
            "solution", "a fold or branch point, of unknown tangent", "vary another parameter first"
        ) from None


def _across(problem: BvpProblem, u: Array, along: Array | None, half: int) -> Array:
    """The tangent of the branch that crosses, on one of its halves.

    It is ``phi + c t`` with the null vector ``phi`` beside the tangent ``t``, and ``c`` of the branching equation
    ``psi F_uu (phi + c t)^2 = 0``, of which ``t`` is the other solution (H. B. Keller, in: Applications of Bifurcation Theory
    (Academic Press 1977), 359-384). The left null vector ``psi`` is not needed: the solutions of the almost singular system
    for two loads are to each other as its products with them.
    """
    if along is None:
        raise InputError(
            "across", "the solution is no branch point of a branch in this parameter", "take one of find('bp')"
        )
    phi, eps = crossing_direction(problem, u, along), 1e-3

    def second(v: Array, w: Array) -> Array:
        """``F_uu v w``, and a zero for the border."""
        corners = [a * b * problem.residual(u + eps * (a * v + b * w)) for a in (1, -1) for b in (1, -1)]
        return np.append(sum(corners), 0.0) / (4 * eps**2)

    loads = np.column_stack((second(phi, phi), second(phi, along)))
    solutions = problem.solve(u + 1e-8 * along, loads, along)
    curved, tilted = problem.inner(phi, solutions[:, 0]), problem.inner(phi, solutions[:, 1])
    direction = phi - curved / (2 * tilted) * along
    change = problem.discretization.values(direction)[:, 0]
    first = change[int(np.argmax(np.abs(change) > np.abs(change).max() / 2))]
    return direction * math.copysign(half, half * first)


def _problem(solution: BvpSolution, vary: str, observables: Observables) -> tuple[BvpProblem, Array]:
    """The problem with the varied parameter free, and the solution as its unknown."""
    d = solution.discretization
    names, free = d.problem.parameters, d.free if solution.tangent is None else d.free[:-1]
    if vary not in names or vary in free:
        which = "is determined by the conditions" if vary in free else "is no parameter"
        others = ", ".join(name for name in names if name not in free)
        raise InputError("vary", f"{vary!r} {which}", f"choose among {others or 'none'}")
    parameters = d.all_parameters(solution.u)
    problem = BvpProblem(replace(d, parameters=parameters, free=(*free, vary)), solution, observables)
    u = problem.discretization.pack(d.values(solution.u), parameters)
    for name, function in observables.items():
        value = function(problem.at(u))
        if name in names or np.ndim(value) or not math.isfinite(value):
            named = name in names
            which = f"{name} is a parameter's name" if named else f"{name} is not one finite number"
            raise InputError("observables", which, "take another" if named else "return one")
    return problem, u


def _options(
    observed: Mapping[str, float],
    vary: str,
    until: Mapping[str, float],
    folds: Sequence[str],
    step: float | None,
    max_step: float,
    max_points: int,
) -> BranchOptions:
    """A user's wishes in the words of ``continuation``."""
    for name in (*folds, *(kind.removeprefix("fold:") for kind in until if kind not in ("bp", "fold"))):
        if name not in observed:
            raise InputError(
                "until", f"no parameter or observable is called {name!r}", f"there are {', '.join(observed)}"
            )
    special = {kind: number for kind, number in until.items() if kind not in observed}
    for kind, number in special.items():
        if number != int(number) or number < 1:
            raise InputError("until", f"{number:g} is no number of a {kind}", "count them from 1")
    smallest, step = PathOptions.min_step, min(0.1, max_step) if step is None else step
    if max_points < 2:
        raise InputError("max_points", f"{max_points} is less than 2", "allow the start and a point after it")
    if not smallest < step <= max_step:
        what = f"{step:g} must be above {smallest:g} and not above max_step = {max_step:g}"
        raise InputError("step", what, "leave it out for 0.1, or max_step where that is less")
    return BranchOptions(
        path=PathOptions(step=step, max_step=max_step, max_points=max_points),
        until={name: float(value) for name, value in until.items() if name in observed},
        until_special={kind: int(number) for kind, number in special.items()},
        folds=tuple(dict.fromkeys((vary, *folds))),
    )
