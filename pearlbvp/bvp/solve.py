"""Solve one boundary-value problem of a user's own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pearlbvp import collocation
from pearlbvp.arrays import Array
from pearlbvp.bvp.functions import Function, Functions, as_problem, doubts
from pearlbvp.collocation import BoundaryValueProblem, Discretization, PiecewisePolynomial, error_estimate
from pearlbvp.collocation.polynomial import all_points, extremes
from pearlbvp.errors import InputError
from pearlbvp.representation import brief


@dataclass(frozen=True)
class BvpSolution:
    """A solution of a user's problem, or the best that was reached.

    Called with ``t`` of shape (K,) it returns the states there, shape (K, n).

    Attributes:
        success: whether Newton's method converged, the error estimate is below the tolerance, and derivatives given look right.
        message: empty, or why not and what to try.
        discretization: problem and mesh, on [0, 1].
        u: the unknown on it.
        interval: where ``t`` begins and ends.
        tolerance: as ``solve_bvp`` took it.
        max_intervals: the same.
        iterations: Newton iterations on all meshes together.
        tangent: of the branch that it is of, with the varied parameter the last unknown; None where it is of none.
    """

    __repr__ = brief

    success: bool
    message: str
    discretization: Discretization
    u: Array
    interval: tuple[float, float]
    tolerance: float
    max_intervals: int
    iterations: int = 0
    tangent: Array | None = None

    def __call__(self, t: Array) -> Array:
        """The states at ``t`` inside the interval."""
        start, end = self.interval
        return self.polynomial((np.asarray(t, dtype=float) - start) / (end - start))

    @property
    def polynomial(self) -> PiecewisePolynomial:
        """The states as a function on [0, 1]."""
        return self.discretization.polynomial(self.u)

    @property
    def t(self) -> Array:
        """Where ``y`` stands: ``m`` points an interval, and the end, shape (N*m + 1,). Every ``m``-th is the mesh's."""
        start, end = self.interval
        return start + (end - start) * all_points(self.discretization.mesh, self.discretization.scheme)

    @property
    def y(self) -> Array:
        """The states at the points ``t``, shape (N*m + 1, n)."""
        return self.discretization.values(self.u)

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name."""
        values = self.discretization.all_parameters(self.u)
        return dict(zip(self.discretization.problem.parameters, map(float, values), strict=True))

    @property
    def error(self) -> float:
        """Estimated largest error of a state, relative to one plus its size (at mesh points it is much smaller)."""
        return float(error_estimate(self.polynomial).max())

    def extremes(self, state: int) -> tuple[float, float]:
        """Smallest and largest value of a state: of the function, not only at its points."""
        return extremes(self.polynomial, state)

    def mean(self, function: Callable[[Array, Array, Array], Array]) -> Array:
        """The mean over the interval of a function ``g(t, y, p)`` of shape (K,) or (K, ...), by Gauss quadrature."""
        d, (start, end) = self.discretization, self.interval
        t = start + (end - start) * d.gauss_points
        values = function(t, d.at_gauss_points(self.u), d.all_parameters(self.u))
        return np.asarray(np.tensordot(d.gauss_weights, values, 1))


def solve_bvp(
    rhs: Function,
    boundary: Function,
    mesh: Sequence[float] | Array | None,
    guess: Sequence[float] | Array | Callable[[Array], Array],
    parameters: Mapping[str, float] | None = None,
    free: Sequence[str] = (),
    *,
    integral: Function | None = None,
    rhs_jacobian: Function | None = None,
    boundary_jacobian: Function | None = None,
    integral_jacobian: Function | None = None,
    m: int = 4,
    tolerance: float = 1e-8,
    max_intervals: int = 1000,
) -> BvpSolution:
    """Solve ``y' = f(t, y, p)`` with ``b(y(start), y(end), p) = 0`` and the mean of ``g(t, y, p)`` zero; the mesh adapts.

    Functions take many points at once, a row a point: ``t`` has the shape (K,), ``y`` (K, n), ``p`` (k,) in the order of
    ``parameters``. (SciPy's ``solve_bvp`` has ``y`` the other way round, (n, K).) States and parameters should be of size
    one or so: tolerances and differences are relative to one plus their size.

    Args:
        rhs: ``f``, shape (K, n).
        boundary: ``b(ya, yb, p)`` with ``ya`` and ``yb`` of shape (n,), shape (b,).
        mesh: the first mesh, increasing, shape (N + 1,); None for an even one on [0, 1].
        guess: of the states: at the mesh's points, shape (N + 1, n), or everywhere alike, shape (n,), or a function of ``t``,
            such as another solution.
        parameters: all parameters by name; those in ``free`` are first guesses.
        free: names of the parameters that the conditions determine: as many as there are conditions beyond ``n``.
        integral: ``g``, shape (K, c); none by default.
        rhs_jacobian: derivatives of ``f`` by ``y`` and ``p``, shapes (K, n, n) and (K, n, k). Here and below None in the place
            of an array stands for zeros, and central differences for what is not given.
        boundary_jacobian: derivatives of ``b`` by ``ya``, ``yb``, ``p``, shapes (b, n), (b, n), (b, k).
        integral_jacobian: derivatives of ``g`` by ``y`` and ``p``, shapes (K, c, n) and (K, c, k).
        m: Gauss points an interval, 2 to 7: the error is of order ``2m`` at mesh points.
        tolerance: for the estimated error of the states.
        max_intervals: give up beyond.

    Returns:
        The solution; where there is none to be found, ``success`` is false and ``message`` says why.

    Raises:
        InputError: an argument that cannot be used, or a function whose values have the wrong shape or are not finite at the
            guess.

    Source: U. Ascher, R. Mattheij, R. Russell, Numerical Solution of Boundary Value Problems for ODEs (SIAM 1995), ch. 5, 9.

    Examples:
        Bratu's problem, ``y'' + lam e^y = 0`` with ``y(0) = y(1) = 0``.

        >>> import numpy as np
        >>> solution = solve_bvp(
        ...     lambda t, y, p: np.column_stack((y[:, 1], -p[0] * np.exp(y[:, 0]))),
        ...     lambda ya, yb, p: np.array([ya[0], yb[0]]),
        ...     None,
        ...     [0.0, 0.0],
        ...     {"lam": 1.0},
        ... )
        >>> print(f"{solution(np.array([0.5]))[0, 0]:.8f}")
        0.14053921
    """
    if m not in range(2, 8):
        raise InputError("m", f"{m!r} is no whole number from 2 to 7", "leave it out for 4")
    for name, value in (("tolerance", tolerance), ("max_intervals", max_intervals)):
        if not value > 0:
            raise InputError(name, f"{value!r} must be positive", "leave it out for what is usual")
    points, values = _mesh_and_guess(mesh, guess)
    if not isinstance(parameters or {}, Mapping):
        raise InputError("parameters", "they must have names", 'give a dictionary such as {"lam": 1.0}')
    names, p = tuple(parameters or {}), _numbers("parameters", list((parameters or {}).values()))
    interval = float(points[0]), float(points[-1])
    unit = (points - points[0]) / (points[-1] - points[0])
    given = Functions(rhs, boundary, integral, rhs_jacobian, boundary_jacobian, integral_jacobian)
    b, c = _conditions(given, points, values, p)
    _count(values.shape[1], names, tuple(free), b, c)
    problem = as_problem(given, interval, values.shape[1], names, b, c)
    _finite(problem, interval, unit, values, p)
    found = collocation.solve_bvp(
        problem, unit, values, p, tuple(free), m=m, tolerance=tolerance, max_intervals=max_intervals
    )
    d, u = found.discretization, found.u
    if found.success:
        unit, values, p = d.mesh, d.values(u)[::m], d.all_parameters(u)
    wrong = doubts(problem, unit, values, p)
    message = "; ".join(part for part in (found.message, wrong) if part)
    return BvpSolution(found.success and not wrong, message, d, u, interval, tolerance, max_intervals, found.iterations)


DEFAULT_INTERVALS = 16
"""Of the first mesh, where neither mesh nor guess tells."""


def _mesh_and_guess(mesh: object, guess: object) -> tuple[Array, Array]:
    """The first mesh (N + 1,) and the guess at its points (N + 1, n)."""
    given = None if callable(guess) else _numbers("guess", guess)
    if mesh is None:
        count = len(given) if given is not None and given.ndim == 2 else DEFAULT_INTERVALS + 1
        points = np.linspace(0.0, 1.0, count)
    else:
        points = _numbers("mesh", mesh)
    if points.ndim != 1 or len(points) < 2 or not (np.diff(points) > 0).all():
        raise InputError("mesh", "it must be two or more increasing numbers", "None is an even mesh on [0, 1]")
    values = _numbers("guess", guess(points)) if callable(guess) else given
    assert values is not None
    if values.ndim == 1 and not callable(guess):
        values = np.tile(values, (len(points), 1))
    if values.ndim != 2 or len(values) != len(points) or not values.shape[1]:
        raise InputError(
            "guess",
            f"shape {values.shape} does not fit the {len(points)} points of the mesh",
            "give a row for each point, or one number for each state",
        )
    return points, values


def _numbers(name: str, value: object) -> Array:
    try:
        numbers = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise InputError(name, "it is no array of numbers", "give one, a row a point") from None
    if not np.isfinite(numbers).all():
        raise InputError(name, "it has entries that are not finite", "give numbers")
    return numbers


def _conditions(given: Functions, points: Array, values: Array, p: Array) -> tuple[int, int]:
    """How many boundary and integral conditions there turn out to be."""
    with np.errstate(all="ignore"):
        b = np.shape(given.boundary(values[0].copy(), values[-1].copy(), p.copy()))
        c = (0, 0) if given.integral is None else np.shape(given.integral(points.copy(), values.copy(), p.copy()))
    if len(b) != 1:
        raise InputError("boundary", f"its value has the shape {b}", "return one number a condition, shape (b,)")
    if len(c) != 2:
        raise InputError("integral", f"its value has the shape {c}", f"return a row a point, shape ({len(points)}, c)")
    return b[0], c[1]


def _count(n: int, names: tuple[str, ...], free: tuple[str, ...], b: int, c: int) -> None:
    """As many conditions as unknowns."""
    unknown = [name for name in free if name not in names]
    if unknown or len(set(free)) < len(free):
        which = f"no parameter is called {unknown[0]!r}" if unknown else f"{free} names one twice"
        raise InputError("free", which, f"choose among {', '.join(names) or 'none'}")
    if b + c != n + len(free):
        remedy = "name a parameter in free for each condition beyond" if b + c > n + len(free) else "add conditions"
        raise InputError(
            "boundary",
            f"{b} boundary and {c} integral conditions for {n} states and {len(free)} free parameters",
            remedy,
        )


def _finite(problem: BoundaryValueProblem, interval: tuple[float, float], unit: Array, values: Array, p: Array) -> None:
    """All functions have numbers at the guess, inside the mesh's intervals: none is needed at its points."""
    s, y = (unit[1:] + unit[:-1]) / 2, (values[1:] + values[:-1]) / 2
    with np.errstate(all="ignore"):
        found = {"rhs": problem.rhs(s, y, p), "integral": problem.integrand(s, y, p)}
        ends = problem.boundary(values[0], values[-1], p)
    for name, value in found.items():
        for place in s[~np.isfinite(value).all(axis=1)]:
            t = interval[0] + (interval[1] - interval[0]) * float(place)
            raise InputError(name, f"not finite at the guess, at t = {t:.6g}", "give a guess where it is defined")
    if not np.isfinite(ends).all():
        raise InputError("boundary", "not finite at the guess", "give a guess where it is defined")
