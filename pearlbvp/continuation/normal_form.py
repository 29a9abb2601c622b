"""Normal form of a simple branch point, from residuals and bordered solves alone: for every discretization.

With ``t`` the tangent of the branch, ``phi`` the direction that crosses it and ``psi`` the left null vector, solutions near
``u0`` are ``u = u0 + x t + y phi + y^2 w / 2 + ...`` where ``psi . F(u) = c11 x y + c02 y^2 / 2 + c03 y^3 / 6 + ... = 0``
(Lyapunov and Schmidt; M. Golubitsky, D. G. Schaeffer, Singularities and Groups in Bifurcation Theory I (Springer 1985),
ch. VII). At a pitchfork ``c02 = 0``, and the crossing branch is ``x = -c03 y^2 / (6 c11)``.

``psi`` is never computed: the Jacobian bordered by ``t`` is singular but for rounding, so the solution for any right-hand
side has the part ``(psi . rhs / rounding) phi``, and ratios of such parts are ratios of ``psi . rhs``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.crossing import crossing_direction
from pearlbvp.continuation.problem import Problem
from pearlbvp.representation import brief


@dataclass(frozen=True)
class NormalForm:
    """How the crossing branch leaves a branch point, ``y`` its arclength in the problem's inner product.

    Attributes:
        direction: unit tangent ``phi`` of the crossing branch.
        bend: its second derivative by ``y`` there, the change along the first branch included.
        slope: change along the first branch by ``y``: 0 at a pitchfork, whose halves are images of each other.
        quadratic: of observables their change by ``y^2`` along the crossing branch; empty unless it is a pitchfork.
    """

    __repr__ = brief

    direction: Array
    bend: Array
    slope: float
    quadratic: dict[str, float]

    @property
    def pitchfork(self) -> bool:
        """Whether the crossing branch is its own mirror image."""
        return self.slope == 0


STEPS = (0.02, 0.04, 0.06, 0.08)
"""Lengths at which derivatives are taken, as polynomials through them: errors of order 8."""

SHARP = 10.0
"""Bend of the crossing branch beyond which the lengths shrink with its radius of curvature, as beside a resonance."""

ASYMMETRIC = 1e-5
"""Slope beyond which a branch point is no pitchfork; differences know it to 1e-9 or so."""


def at_zero(values: Callable[[float], Array], scale: float = 1.0) -> Array:
    """The limit at 0 of a function that is even in the step, from its values at ``STEPS`` times ``scale``."""
    squares = np.array(STEPS) ** 2
    weights = [math.prod(q / (q - p) for q in squares if q != p) for p in squares]
    return sum((w * values(scale * h) for w, h in zip(weights, STEPS, strict=True)), start=np.zeros(()))


def normal_form(
    problem: Problem,
    u: Array,
    tangent: Array,
    direction: Array | None = None,
    *,
    symmetric: bool = False,
    names: Sequence[str] = ("lambda1", "lambda2", "v", "E"),
) -> NormalForm:
    """The normal form of a simple branch point.

    Args:
        problem: the problem in whose space both branches live.
        u: the branch point.
        tangent: of the branch known.
        direction: of the one that crosses it; computed where it is not known.
        symmetric: whether the crossing branch breaks a symmetry, so that it must be a pitchfork.
        names: of observables that are smooth functions of the solution.

    Raises:
        numpy.linalg.LinAlgError: the bordered matrix is singular exactly, twice with different perturbations of ``u``.
    """
    inner, residual = problem.inner, problem.residual
    t = tangent / math.sqrt(inner(tangent, tangent))
    phi = crossing_direction(problem, u, t) if direction is None else direction
    phi = phi - inner(t, phi) * t
    phi = phi / math.sqrt(inner(phi, phi))
    here = residual(u)

    def mixed(h: float) -> Array:
        both, apart = h * (t + phi), h * (t - phi)
        return (residual(u + both) + residual(u - both) - residual(u + apart) - residual(u - apart)) / (4 * h**2)

    def curved(h: float) -> Array:
        return (residual(u + h * phi) + residual(u - h * phi) - 2 * here) / h**2

    scale = 1.0
    for _ in range(2):
        c11 = at_zero(mixed, scale)
        solved = _solutions(problem, u, t, np.column_stack((at_zero(curved, scale), c11)))
        by_second, by_mixed = (inner(phi, column) for column in solved.T)
        w = -solved[:, 0] + by_second * phi
        w -= inner(t, w) * t
        scale = min(1.0, SHARP / max(math.sqrt(inner(w, w)), 1e-300))
    slope = -by_second / (2 * by_mixed)
    if not symmetric and abs(slope) > ASYMMETRIC:
        return NormalForm(phi, w, slope, {})

    def third(h: float) -> Array:
        ahead, behind = (residual(u + y * phi + y**2 / 2 * w) for y in (h, -h))
        return (ahead - behind) / (2 * h**3)

    solved = _solutions(problem, u, t, np.column_stack((at_zero(third, scale), c11)))
    along = -inner(phi, solved[:, 0]) / inner(phi, solved[:, 1])
    bend = w + 2 * along * t

    def observed(y: float) -> Array:
        values = problem.observables(u + y * phi + y**2 / 2 * bend)
        return np.array([values[name] for name in names])

    quadratic = at_zero(lambda h: (observed(h) + observed(-h) - 2 * observed(0.0)) / (2 * h**2), scale)
    return NormalForm(phi, bend, 0.0, dict(zip(names, map(float, quadratic), strict=True)))


def _solutions(problem: Problem, u: Array, tangent: Array, loads: Array) -> Array:
    """Solutions of the nearly singular system for several right-hand sides, with one and the same factorization."""
    rhs = np.vstack((loads, np.zeros(loads.shape[1])))
    try:
        return problem.solve(u, rhs, tangent)
    except np.linalg.LinAlgError:
        return problem.solve(u + 1e-12 * tangent, rhs, tangent)
