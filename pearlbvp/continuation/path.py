"""Path following by pseudo-arclength: predictor from the last tangents, Newton corrector, step control.

Source: H. B. Keller, in: Applications of Bifurcation Theory (Academic Press 1977), 359-384; step control as in
E. J. Doedel, H. B. Keller, J. P. Kernevez, Int. J. Bifurcation Chaos 1 (1991) 493, by the corrector's iterations.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Generic

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.interpolation import interpolate
from pearlbvp.continuation.problem import P, Problem
from pearlbvp.continuation.solution import DIFFERENCE, Solution
from pearlbvp.newton import NewtonOptions, NewtonResult, newton
from pearlbvp.representation import brief


@dataclass(frozen=True)
class PathOptions:
    """How a path is followed. Steps are lengths in the problem's inner product.

    Attributes:
        step, min_step, max_step: first, smallest and largest step.
        max_points: stop after so many.
        max_angle: largest turn of the tangent in one step, in degrees; a larger one halves the step.
        newton: options of the corrector.
    """

    step: float = 0.05
    min_step: float = 1e-6
    max_step: float = 0.5
    max_points: int = 200
    max_angle: float = 30.0
    newton: NewtonOptions = field(default_factory=lambda: NewtonOptions(max_iterations=8))

    def __post_init__(self) -> None:
        if not 0 < self.min_step <= self.step <= self.max_step:
            raise ValueError(
                f"step: need 0 < min_step <= step <= max_step, not {self.min_step, self.step, self.max_step}"
            )


@dataclass(frozen=True)
class Path(Generic[P]):
    """Consecutive points and why there are no more.

    Attributes:
        points: in order, the start first.
        reason: why it ended: what ``stop`` said, ``max_points``, or what went wrong and what to try.
        complete: whether it ended because ``stop`` said so.
    """

    __repr__ = brief

    points: list[Solution[P]]
    reason: str
    complete: bool


LARGEST_KINK = 0.05
"""Beyond, a step has left its curve. Steps of 20 degrees along a smooth curve have 0.02, jumps 0.1 to 1."""


class PathEnd(ArithmeticError):
    """A path cannot go on; the message says why and what to try."""


def correct(
    problem: Problem,
    guess: Array,
    direction: Array,
    base: Array,
    distance: float,
    options: NewtonOptions,
    rate: float = 1e4,
) -> tuple[NewtonResult, Array]:
    """Newton's method on ``residual(u) = 0, inner(direction, u - base) = distance``; ``rate`` as ``newton`` takes it.

    Returns:
        The result, and the unnormalised tangent ``t`` with ``inner(direction, t) = 1`` at the last iterate but one.
    """  # fmt: skip
    tangent = direction

    def residual(u: Array) -> Array:
        f = np.empty(u.size)
        f[:-1] = problem.residual(u)
        f[-1] = problem.inner(direction, u - base) - distance
        return f

    def solve(u: Array, f: Array) -> Array:
        nonlocal tangent
        both = np.zeros((f.size, 2))
        both[:, 0] = f
        both[-1, 1] = 1.0
        solution = problem.solve(u, both, direction)
        tangent = solution[:, 1]
        return solution[:, 0]

    return newton(residual, solve, guess, options, rate), tangent


def correct_to(
    problem: Problem, guess: Array, direction: Array, excess: Callable[[Array], float], options: NewtonOptions
) -> tuple[NewtonResult, Array]:
    """Newton's method on ``residual(u) = 0, excess(u) = 0``: where on its curve a number of the solution has a value.

    The step to the curve, perpendicular to ``direction``, is followed by one along it by the number's slope, a central
    difference: exact where the number is one of the unknowns.

    Args:
        problem, guess, options: as ``correct`` takes them.
        direction: along the curve, roughly.
        excess: of the number over its value; where it turns along the curve, no solution is found.

    Returns:
        The result, and the unnormalised tangent ``t`` with ``inner(direction, t) = 1`` at the last iterate but one.
    """
    tangent = direction

    def residual(u: Array) -> Array:
        return np.append(problem.residual(u), 0.0)

    def solve(u: Array, f: Array) -> Array:
        nonlocal tangent
        unit = np.zeros_like(f)
        unit[-1] = 1.0
        onto, tangent = problem.solve(u, np.column_stack((f, unit)), direction).T
        ahead, behind = (excess(u + step * tangent) for step in (DIFFERENCE, -DIFFERENCE))
        slope = np.float64(ahead - behind) / (2 * DIFFERENCE)  # of a plain 0 the quotient below would be an error
        return np.asarray(onto + excess(u - onto) / slope * tangent)

    return newton(residual, solve, guess, options), tangent


def correct_at(problem: Problem, u: Array, options: NewtonOptions, unknown: int = -1) -> tuple[NewtonResult, Array]:
    """Newton's method with one unknown as it is; the last is the reduced volume, in every family of shapes.

    Returns:
        The result, and the unnormalised tangent along which that unknown grows at the rate 1.
    """
    direction = np.zeros_like(u)
    direction[unknown] = 1.0
    return correct(problem, u, direction, u, 0.0, options)


def steps(start: Solution[P], options: PathOptions) -> Iterator[Solution[P]]:
    """Points of the path beyond ``start``, one at a time, each corrected and on a mesh that fits it.

    The start may be a simple bifurcation point with the tangent of the branch wanted. No step is taken at which the
    tangent turns by ``max_angle`` or more, or at which the chord is not the mean of the tangents at its ends to within
    ``LARGEST_KINK`` of its length, as it is on a smooth curve to third order in the step: so the path neither turns back
    nor jumps to another branch unnoticed.

    Raises:
        PathEnd: the smallest step fails, or a new mesh does.
    """
    step, point = start.step or options.step, start
    past = {0.0: start.u}  # points on the same mesh by arclength, counted from the latest
    rate = 1e4
    while True:
        problem, inner = point.problem, point.problem.inner
        predicted = _predicted(point, past, step)
        result, tangent = correct(problem, predicted, point.tangent, predicted, 0.0, options.newton, rate)
        if result.converged:
            tangent = tangent / math.sqrt(inner(tangent, tangent))
            chord = result.u - point.u
            length = math.sqrt(inner(chord, chord))
            turn = math.degrees(math.acos(min(1.0, inner(tangent, point.tangent))))
            kink = chord / length - (point.tangent + tangent) / 2
            size = math.sqrt(inner(kink, kink))
        if not result.converged or turn > options.max_angle or size > LARGEST_KINK:
            why = result.message or f"the path turns by {turn:.0f} degrees, with a kink of {size:.2f}"
            step /= 2
            if step < options.min_step:
                what = why.partition(";")[0]  # whose remedy, a smaller step, has been tried
                raise PathEnd(
                    f"the step fell below min_step = {options.min_step:g}: {what}; stop before, or try another max_step"
                )
            continue
        u = result.u
        if result.iterations > 1:
            rate = SAFETY * result.rate
        past = {s - length: before for s, before in past.items() if len(past) < ORDER or s > min(past)} | {0.0: u}
        moved = problem.remesh(u, tangent)
        if moved is not None:
            problem, (u, tangent) = moved
            again, tangent = correct(problem, u, tangent, u, 0.0, options.newton)
            if not again.converged:
                what = again.message.partition(";")[0]
                raise PathEnd(f"no convergence on a renewed mesh: {what}; stop before, or take a smaller max_step")
            u = again.u
            tangent = tangent / math.sqrt(problem.inner(tangent, tangent))
            past, rate = {0.0: u}, 1e4
        if result.iterations <= 4 and turn < options.max_angle / 2:
            step = min(2 * step, options.max_step)
        elif result.iterations >= 6:
            step = max(step / 2, options.min_step)
        point = Solution(problem, u, tangent, result.iterations, step)
        yield point


ORDER = 5
"""Points that the predictor looks back on."""

SAFETY = 10.0
"""By how much the Jacobian may vary faster at the next point than here, for the corrector's first step to suffice."""


def _predicted(point: Solution[P], past: dict[float, Array], step: float) -> Array:
    """The polynomial through past points with the latest one's tangent, a step beyond: ``u + s t + s^2 q(s)``."""
    remainder = {s: (before - point.u - s * point.tangent) / s**2 for s, before in past.items() if s != 0}
    predicted: Array = point.u + step * point.tangent
    if remainder:
        predicted += step**2 * interpolate(step, remainder)
    return predicted


def follow(start: Solution[P], options: PathOptions, stop: Callable[[Solution[P]], str | None]) -> Path[P]:
    """Follow the path from ``start`` along its tangent until ``stop`` returns a reason or it cannot go on."""
    points = [start]
    try:
        for point in steps(start, options):
            points.append(point)
            reason = stop(point)
            if reason is not None:
                return Path(points, reason, True)
            if len(points) >= options.max_points:
                return Path(points, f"max_points = {options.max_points} reached", False)
    except PathEnd as end:
        return Path(points, str(end), False)
    raise AssertionError("steps() ends by PathEnd only")
