"""Newton's method for systems whose linear solves are somebody else's: one corrector for all discretizations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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
        message: empty, or why it failed and what to try.
    """

    u: Array
    converged: bool
    iterations: int
    correction: float
    message: str = ""


def newton(
    residual: Callable[[Array], Array],
    correct: Callable[[Array, Array], Array],
    u: Array,
    options: NewtonOptions | None = None,
) -> NewtonResult:
    """Solve ``residual(u) = 0``; ``correct(u, f)`` returns ``J(u)^{-1} f``.

    Convergence is quadratic: after the correction ``d`` the error is ``C d**2``, with ``C = d / previous**2`` estimated
    (P. Deuflhard, Newton Methods for Nonlinear Problems (Springer 2004), §2.1). The iteration ends when that is below
    the tolerance, without computing one more correction to see it. A first correction alone tells nothing of ``C``; it
    is taken as 1e4.
    """
    options = options or NewtonOptions()
    correction = np.inf
    with np.errstate(all="ignore"):
        f = residual(u)
        for iteration in range(1, options.max_iterations + 1):
            if not np.isfinite(f).all():
                return NewtonResult(u, False, iteration - 1, correction, "the residual is not finite; start nearer")
            try:
                step = correct(u, f)
            except np.linalg.LinAlgError as error:
                return NewtonResult(u, False, iteration, correction, f"singular Jacobian ({error}); start elsewhere")
            previous, correction = correction, float(np.max(np.abs(step) / (1 + np.abs(u))))
            rate = 1e4 if iteration == 1 else max(1.0, correction / previous**2)
            stalled = correction > previous / 2 and correction < options.rounding
            if rate * correction**2 < options.tolerance or stalled:
                return NewtonResult(u - step, True, iteration, correction)
            if options.damping == 0 and iteration > 2 and correction > 2 * previous:
                return NewtonResult(u, False, iteration, correction, "Newton's method diverges; take a smaller step")
            size = np.linalg.norm(f)
            for halving in range(options.damping + 1):
                trial = u - step / 2**halving
                f = residual(trial)
                if np.linalg.norm(f) < size:
                    break
            u = trial
    message = f"no convergence in {options.max_iterations} iterations; take a smaller step or a better guess"
    return NewtonResult(u, False, options.max_iterations, correction, message)
