"""Solve one boundary-value problem on meshes that adapt to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation.discretization import Discretization
from pearlbvp.collocation.mesh import equidistribute, error_estimate, intervals_for
from pearlbvp.collocation.polynomial import PiecewisePolynomial, all_points
from pearlbvp.collocation.problem import BoundaryValueProblem
from pearlbvp.collocation.scheme import gauss_scheme
from pearlbvp.newton import NewtonOptions, newton
from pearlbvp.representation import brief


@dataclass(frozen=True)
class BoundaryValueSolution:
    """A solved problem, or the best that was reached.

    Attributes:
        success: whether Newton's method converged and the error estimate is below the tolerance.
        message: empty, or why not and what to try.
        discretization: problem and mesh.
        u: the unknown on it.
        error: estimated largest error of the piecewise polynomial (at mesh points it is much smaller).
        iterations: Newton iterations on all meshes together.
    """

    __repr__ = brief

    success: bool
    message: str
    discretization: Discretization
    u: Array
    error: float
    iterations: int

    @property
    def solution(self) -> PiecewisePolynomial:
        """The states as a function on [0, 1]."""
        return self.discretization.polynomial(self.u)

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name."""
        values = self.discretization.all_parameters(self.u)
        return dict(zip(self.discretization.problem.parameters, map(float, values), strict=True))


def solve_bvp(
    problem: BoundaryValueProblem,
    mesh: Array,
    guess: Array,
    parameters: Array,
    free: tuple[str, ...] = (),
    *,
    m: int = 4,
    tolerance: float = 1e-8,
    max_intervals: int = 1000,
    newton_options: NewtonOptions | None = None,
) -> BoundaryValueSolution:
    """Solve ``problem`` with Gauss collocation, refining and moving the mesh until the error estimate is small.

    Args:
        problem: the boundary-value problem.
        mesh: first mesh, from 0 to 1, shape (N + 1,).
        guess: first values of the states at the mesh's points, shape (N + 1, n), or at all ``N*m + 1`` points.
        parameters: all parameters, shape (k,); free ones are first guesses.
        free: names of the parameters to be found; there must be as many as conditions exceed states.
        m: Gauss points an interval, 2 to 7.
        tolerance: for the estimated error of the piecewise polynomial, relative to one plus the solution.
        max_intervals: give up beyond.
        newton_options: by default damped, because a guess may be far.

    Raises:
        ValueError: an array of the wrong shape, a mesh that does not increase, an unknown name.
    """
    scheme = gauss_scheme(m)
    mesh = np.asarray(mesh, dtype=float)
    guess = np.asarray(guess, dtype=float)
    discretization = Discretization(problem, scheme, mesh, np.asarray(parameters, dtype=float), tuple(free))
    if guess.shape == (len(mesh), discretization.n):
        points = all_points(mesh, scheme)
        guess = np.column_stack([np.interp(points, mesh, column) for column in guess.T])
    if guess.shape != ((len(mesh) - 1) * m + 1, discretization.n):
        raise ValueError(f"guess: shape {guess.shape} fits neither the mesh nor its collocation points")
    u = discretization.pack(guess, discretization.parameters)
    if discretization.residual(u).size != discretization.size:
        raise ValueError(
            f"free: {len(discretization.free)} free parameters leave {discretization.size} unknowns for "
            f"{discretization.residual(u).size} equations; free one parameter for each condition beyond the states"
        )
    options = newton_options or NewtonOptions(damping=10, max_iterations=40)
    iterations = 0
    for _ in range(20):
        result = newton(discretization.residual, discretization.solve, u, options)
        u, iterations = result.u, iterations + result.iterations
        error = float(error_estimate(discretization.polynomial(u)).max())
        if not result.converged:
            return BoundaryValueSolution(False, result.message, discretization, u, error, iterations)
        if error < tolerance:
            return BoundaryValueSolution(True, "", discretization, u, error, iterations)
        now = len(discretization.h)
        # Never fewer than now, and not far more than twice as many: the estimate may be poor on a coarse mesh.
        intervals = min(max(intervals_for(discretization.polynomial(u), tolerance), now + 1), 2 * now + 8)
        if intervals > max_intervals:
            break
        discretization, (u,) = discretization.on_mesh(equidistribute(discretization.polynomial(u), intervals), u)
    message = (
        f"the error estimate stays at {error:.1e} with {len(discretization.h)} intervals; raise m or max_intervals"
    )
    return BoundaryValueSolution(False, message, discretization, u, error, iterations)
