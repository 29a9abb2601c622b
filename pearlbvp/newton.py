"""Newton's method for systems whose linear solves are somebody else's: one corrector for all discretizations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.representation import brief


@dataclass(frozen=True)
class NewtonOptions:
    """When Newton's method is content and when it gives up.

    Attributes:
        tolerance: for the error after the last correction (largest entry, relative to one plus the unknown's), as
            quadratic convergence predicts it from the last two corrections.
        rounding: corrections below this that no longer shrink are rounding, and the iteration has converged.
        max_iterations: after these it gives up.
        damping: halve a correction up to this many times while the residual does not fall; 0 takes full steps.
    """

    tolerance: float = 1e-13
    rounding: float = 1e-8
    max_iterations: int = 12
    damping: int = 0


@dataclass(frozen=True)
class NewtonResult:
    """What Newton's method found.

    Attributes:
        u: the last iterate.
        converged: whether it is a solution.
        iterations: linear solves made.
        correction: size of the last correction, relative to one plus the unknown.
        rate: the factor ``C`` of quadratic convergence that the last two corrections show, or the one assumed.
        message: empty, or why it failed and what to try.
    """

    __repr__ = brief

    u: Array
    converged: bool
    iterations: int
    correction: float
    rate: float
    message: str = ""


def newton(
    residual: Callable[[Array], Array],
    correct: Callable[[Array, Array], Array],
    u: Array,
    options: NewtonOptions | None = None,
    rate: float = 1e4,
) -> NewtonResult:
    """Solve ``residual(u) = 0``; ``correct(u, f)`` returns ``J(u)^{-1} f``.

    Convergence is quadratic: after the correction ``d`` the error is ``C d**2``, with ``C = d / previous**2`` estimated
    (P. Deuflhard, Newton Methods for Nonlinear Problems (Springer 2004), §2.1). The iteration ends when that is below
    the tolerance, without computing one more correction to see it. A first correction alone tells nothing of ``C``: for
    it ``rate`` is taken, which a neighbouring solution may have shown (§5.1 there).
    """
    options = options or NewtonOptions()
    correction = np.inf

    def failed(iterations: int, message: str) -> NewtonResult:
        return NewtonResult(u, False, iterations, correction, rate, message)

    with np.errstate(all="ignore"):
        f = residual(u)
        for iteration in range(1, options.max_iterations + 1):
            if not np.isfinite(f).all():
                return failed(iteration - 1, "the residual is not finite; start nearer")
            try:
                step = correct(u, f)
            except np.linalg.LinAlgError as error:
                return failed(iteration, f"singular Jacobian ({error}); start elsewhere")
            previous, correction = correction, float((np.abs(step) / (1 + np.abs(u))).max())
            if iteration > 1:
                rate = max(1.0, correction / previous**2)
            stalled = correction > previous / 2 and correction < options.rounding
            if rate * correction**2 < options.tolerance or stalled:
                return NewtonResult(u - step, True, iteration, correction, rate)
            if options.damping == 0 and iteration > 2 and correction > 2 * previous:
                return failed(iteration, "Newton's method diverges; take a smaller step")
            if options.damping == 0:
                u = u - step
                f = residual(u)
            else:
                u, f = _damped(residual, u, f, step, options.damping)
    return failed(
        options.max_iterations,
        f"no convergence in {options.max_iterations} iterations; take a smaller step or a better guess",
    )


def _damped(residual: Callable[[Array], Array], u: Array, f: Array, step: Array, halvings: int) -> tuple[Array, Array]:
    """The first of the corrections ``step, step/2, ...`` that lowers the residual, or the last; the residual there."""
    size = np.linalg.norm(f)
    for halving in range(halvings + 1):
        trial = u - step / 2**halving
        f = residual(trial)
        if np.linalg.norm(f) < size:
            break
    return trial, f
