"""A user's own boundary-value problems against closed forms, matrix exponentials and SciPy."""

import doctest
import importlib
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_bvp as scipy_bvp
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.special import ellipk
from support.problems import BRATU_FOLD, bratu, elastica, van_der_pol

from pearlbvp.bvp import continue_bvp, solve_bvp
from pearlbvp.bvp.functions import differences
from pearlbvp.errors import InputError

PEAK = {"peak": lambda s: s.extremes(0)[1]}


def bratu_rhs(t, y, p):
    return np.column_stack((y[:, 1], -p[0] * np.exp(y[:, 0])))


def zero_ends(ya, yb, p):
    return np.array([ya[0], yb[0]])


def solved_bratu(lam=1.0, **options):
    return solve_bvp(bratu_rhs, zero_ends, None, [0.0, 0.0], {"lam": lam}, **options)


def rod(t, y, p):
    return np.column_stack((y[:, 1], -p[0] * np.sin(y[:, 0])))


def straight_rod(force):
    """A rod with free ends under a force: ``angle'' = -F sin angle``, no moment at the ends."""
    return solve_bvp(rod, lambda ya, yb, p: np.array([ya[1], yb[1]]), None, [0.0, 0.0], {"F": force})


def test_bratu_turns_at_its_fold_and_has_two_solutions():
    upwards = continue_bvp(solved_bratu(), "lam", until={"fold:lam": 1}, observables=PEAK)
    (fold,) = upwards.find("fold:lam")
    assert upwards.complete
    assert upwards.at(fold).parameters["lam"] == pytest.approx(BRATU_FOLD, abs=1e-11)
    on = continue_bvp(upwards.at(fold), "lam", until={"lam": 1.0}, observables=PEAK)
    for solution, bracket in ((upwards.points[0], (0, 1.19)), (on.points[-1], (1.2, 5))):
        a = brentq(lambda a: a - math.sqrt(1 / 8) * math.cosh(a), *bracket, xtol=1e-15)
        t = np.linspace(0, 1, 401)
        exact = 2 * np.log(np.cosh(a) / np.cosh(a * (1 - 2 * t)))
        assert np.abs(solution(t)[:, 0] - exact).max() < 1e-8 * (1 + solution.y[:, 1].max())
        np.testing.assert_allclose(solution(np.array([0.5]))[0, 0], 2 * math.log(math.cosh(a)), rtol=1e-10)
    table = on.table()
    assert list(table) == ["point", "special", "lam", "peak"]
    assert table["special"].iloc[-1] == "stop"
    assert not on.find("bp")
    # The whole way at once: the first fold is met again, and an observable is a stop as well as a parameter.
    far = continue_bvp(solved_bratu(), "lam", until={"peak": 12.0}, observables=PEAK, max_step=2.0)
    assert [s.kind for s in far.special] == ["start", "fold:lam", "stop"]
    assert far.points[-1].extremes(0)[1] == pytest.approx(12.0, abs=1e-10)
    assert far.points[-1].parameters["lam"] == pytest.approx(8 * (math.acosh(math.exp(6)) / math.exp(6)) ** 2, abs=1e-9)
    assert max(s.error for s in far.points) < 1.01e-8


@pytest.mark.parametrize("k", [1, 2, 5])
def test_an_eigenvalue_follows_from_a_normalisation(k):
    solution = solve_bvp(
        lambda t, y, p: np.column_stack((y[:, 1], -p[0] * y[:, 0])), zero_ends, np.linspace(0, 1, 21),
        lambda t: np.column_stack((np.sin(k * np.pi * t), k * np.pi * np.cos(k * np.pi * t))),
        {"mu": 9.0 * k**2}, free=["mu"], integral=lambda t, y, p: y[:, :1] ** 2 - 1, tolerance=1e-9,
    )  # fmt: skip
    assert solution.success
    assert solution.parameters["mu"] == pytest.approx((k * math.pi) ** 2, rel=1e-11)
    assert solution.mean(lambda t, y, p: y[:, 0] ** 2) == pytest.approx(1, abs=1e-13)
    t = np.linspace(0, 1, 301)
    assert np.abs(solution(t)[:, 0] - math.sqrt(2) * np.sin(k * math.pi * t)).max() < 1e-8 * k * 4


def van_der_pol_rhs(t, y, p):
    return p[1] * np.column_stack((y[:, 1], p[0] * (1 - y[:, 0] ** 2) * y[:, 1] - y[:, 0]))


def test_a_periodic_orbit_with_its_period_is_followed():
    """Van der Pol from nearly a circle to relaxation; the phase is that of the largest ``x``, by a boundary condition."""
    start = solve_bvp(
        van_der_pol_rhs, lambda ya, yb, p: np.append(ya - yb, ya[1]), np.linspace(0, 1, 21),
        lambda t: 2 * np.column_stack((np.cos(2 * np.pi * t), -np.sin(2 * np.pi * t))), {"mu": 0.1, "T": 6.3}, ["T"],
    )  # fmt: skip
    series = 2 * math.pi * (1 + 0.1**2 / 16 - 5 * 0.1**4 / 3072)  # the next term is of order mu^6
    assert start.parameters["T"] == pytest.approx(series, abs=1e-7)
    one = continue_bvp(start, "mu", until={"mu": 1.0})
    assert one.points[-1].parameters["T"] == pytest.approx(6.663286859323130, abs=1e-10)
    three = continue_bvp(one.points[-1], "mu", until={"mu": 3.0}).points[-1]
    orbit = solve_ivp(
        lambda t, y: van_der_pol_rhs(t, y[None], [3.0, 1.0])[0],
        (0, three.parameters["T"]), three.y[0], method="DOP853", rtol=1e-12, atol=1e-12,
    )  # fmt: skip
    np.testing.assert_allclose(orbit.y[:, -1], three.y[0], atol=1e-8)
    assert three.parameters["T"] == pytest.approx(8.859095499, abs=1e-8)


@pytest.mark.parametrize("m", [2, 3, 4])
def test_order_2m_at_mesh_points_of_any_interval(m):
    """``y' = -y^3/2, y(1) = 1`` up to ``t = 3``: ``y = 1/sqrt(t)``."""
    counts = {2: (10, 14, 20), 3: (6, 9, 13), 4: (4, 6, 8)}[m]
    errors = []
    for count in counts:
        mesh = np.linspace(1, 3, count + 1)
        solution = solve_bvp(lambda t, y, p: -(y**3) / 2, lambda ya, yb, p: ya - 1, mesh, [1.0], m=m, tolerance=1.0)
        np.testing.assert_allclose(solution.t[::m], mesh, rtol=1e-15)
        errors.append(np.abs(solution.y[::m, 0] - mesh**-0.5).max())
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(2 * m, abs=0.6)


def reference(t):
    return np.column_stack((np.cos(2 * np.pi * t), -np.sin(2 * np.pi * t)))


@pytest.mark.parametrize("build", [bratu, elastica, lambda: van_der_pol(reference)])
def test_differences_are_the_derivatives(build):
    problem, rng = build(), np.random.default_rng(3)
    n, k = len(problem.states), len(problem.parameters)
    t, y, p = np.linspace(0, 1, 7), rng.standard_normal((7, n)), rng.uniform(0.5, 1.5, k)
    for exact, found in zip(problem.rhs_jacobian(t, y, p), differences(problem.rhs, (t, y, p), (1, 2)), strict=True):
        np.testing.assert_allclose(found, exact, atol=1e-9)
    ends = y[0], y[1], p
    pairs = zip(problem.boundary_jacobian(*ends), differences(problem.boundary, ends, (0, 1, 2)), strict=True)
    for exact, found in pairs:
        np.testing.assert_allclose(found, exact, atol=1e-9)
    by_y, by_p = problem.integrand_jacobian(t, y, p)
    found_y, found_p = differences(problem.integrand, (t, y, p), (1, 2))
    np.testing.assert_allclose(found_y, by_y, atol=1e-9)
    np.testing.assert_allclose(found_p, by_p, atol=1e-9)


def test_with_derivatives_or_without_the_branch_is_the_same():
    problem = elastica()
    mesh = np.linspace(0, 1, 17)
    guess = np.column_stack((0.9 * np.sin(2 * np.pi * mesh), 6 * np.cos(2 * np.pi * mesh)))
    found = []
    for derivatives in (
        {},
        {
            "rhs_jacobian": problem.rhs_jacobian,
            "boundary_jacobian": lambda ya, yb, p: (*problem.boundary_jacobian(ya, yb, p)[:2], None),
            "integral_jacobian": problem.integrand_jacobian,
        },
    ):
        start = solve_bvp(
            problem.rhs, problem.boundary, mesh, guess, {"force": 40.0, "shortening": 0.2}, ["force"],
            integral=problem.integrand, **derivatives,
        )  # fmt: skip
        found.append(continue_bvp(start, "shortening", until={"shortening": 0.3}).points)
    assert len(found[0]) == len(found[1])
    for one, other in zip(*found, strict=True):
        np.testing.assert_allclose(one.u, other.u, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_as_scipy_solves_it(seed):
    """A nonlinear problem of three states with random coefficients, on an interval of its own, with one parameter free."""
    rng = np.random.default_rng(seed)
    a, b = rng.uniform(-0.4, 0.4, (3, 3)), rng.uniform(-0.3, 0.3, (3, 3))
    goal = rng.uniform(-0.5, 0.5, 4)
    interval = 0.5, 2.0

    def f(t, y, p):
        return np.sin(y @ a.T) + y**2 @ b.T + np.column_stack((p[0] * t, t, np.cos(t)))

    def boundary(ya, yb, p):
        return np.array([ya[0], ya[1] + 0.1 * yb[2] ** 2, yb[0] * (1 + 0.1 * ya[1]), ya[2]]) - goal

    mesh = np.linspace(*interval, 30)
    mine = solve_bvp(f, boundary, mesh, np.zeros((30, 3)), {"p": 0.0}, ["p"], tolerance=1e-10)
    his = scipy_bvp(lambda t, y, p: f(t, y.T, p).T, boundary, mesh, np.zeros((3, 30)), [0.0], tol=1e-9, max_nodes=20000)
    assert mine.success
    assert his.success
    assert mine.parameters["p"] == pytest.approx(his.p[0], abs=1e-8)
    np.testing.assert_allclose(mine(mesh), his.sol(mesh).T, atol=1e-8)


@given(
    seed=st.integers(0, 10**6),
    n=st.integers(1, 4),
    start=st.floats(-2, 2),
    length=st.floats(0.1, 3),
    m=st.integers(3, 7),
)
def test_linear_problems_as_matrix_exponentials(seed, n, start, length, m):
    rng = np.random.default_rng(seed)
    matrix = rng.uniform(-1, 1, (n, n))
    at_start, at_end = np.eye(n) + 0.2 * rng.uniform(-1, 1, (n, n)), 0.2 * rng.uniform(-1, 1, (n, n))
    goal, propagator = rng.uniform(-1, 1, n), expm(length * matrix)
    whole = at_start + at_end @ propagator
    if np.linalg.cond(whole) > 1e3:
        return
    exact = np.linalg.solve(whole, goal)
    solution = solve_bvp(
        lambda t, y, p: y @ matrix.T, lambda ya, yb, p: at_start @ ya + at_end @ yb - goal,
        np.linspace(start, start + length, 6), np.zeros(n), m=m, tolerance=1e-9,
    )  # fmt: skip
    assert solution.success
    size = 1 + np.abs(solution.y).max()
    assert np.abs(solution.y[0] - exact).max() < 1e-8 * size
    assert np.abs(solution.y[-1] - propagator @ exact).max() < 1e-8 * size


def test_a_rod_buckles_at_its_branch_points_and_bends_as_elliptic_integrals_say():
    trivial = continue_bvp(straight_rod(5.0), "F", until={"bp": 3}, step=1.0, max_step=10.0)
    found = [trivial.at(s).parameters["F"] / math.pi**2 for s in trivial.find("bp")]
    np.testing.assert_allclose(found, [1, 4, 9], rtol=1e-7)
    first = trivial.at(trivial.find("bp")[0])
    ends = {"angle": lambda s: s.y[0, 0]}
    for half in (1, -1):
        buckled = continue_bvp(first, "F", across=True, direction=half, observables=ends, until={"angle": 2.0 * half})
        assert buckled.complete
        for solution in buckled.points[1:]:
            # Half a swing of the pendulum with the amplitude of the end's angle.
            modulus = math.sin(solution.y[0, 0] / 2)
            assert solution.parameters["F"] == pytest.approx(4 * ellipk(modulus**2) ** 2, rel=1e-10)
    back = continue_bvp(buckled.points[-1], "F", direction=-1)
    assert "symmetric" in back.reason
    assert back.at(back.find("bp")[0]).parameters["F"] == pytest.approx(math.pi**2, rel=1e-9)


def test_a_transcritical_point_is_passed_on_either_branch():
    """``y'' + lam y = y^2``: the positive solution exchanges places with zero at ``lam = pi^2``."""
    zero = solve_bvp(
        lambda t, y, p: np.column_stack((y[:, 1], y[:, 0] ** 2 - p[0] * y[:, 0])),
        zero_ends,
        None,
        [0.0, 0.0],
        {"lam": 8.0},
    )
    trivial = continue_bvp(zero, "lam", until={"lam": 12.0}, max_step=1.0)
    (point,) = trivial.find("bp")
    crossing = continue_bvp(trivial.at(point), "lam", across=True, until={"lam": 12.0})
    assert crossing.complete
    assert not crossing.find("bp")
    back = continue_bvp(crossing.points[-1], "lam", direction=-1, until={"lam": 8.0})
    (again,) = back.find("bp")
    assert back.at(again).parameters["lam"] == pytest.approx(math.pi**2, abs=1e-8)
    assert back.complete
    assert back.points[-1].y[:, 0].min() < -1


def test_another_parameter_can_be_varied_from_a_point_of_a_branch():
    """An imperfect pitchfork ``lam x - x^3 + c = 0``: its fold is at ``lam = 3 (c/2)^(2/3)``."""
    start = solve_bvp(
        lambda t, y, p: 0 * y, lambda ya, yb, p: p[0] * ya - ya**3 + p[1], None, [-1.0], {"lam": 1.0, "c": 0.0}
    )
    raised = continue_bvp(start, "c", until={"c": 0.1}).points[-1]
    branch = continue_bvp(raised, "lam", direction=-1, until={"fold": 1}, folds=["norm"])
    assert branch.points[-1].parameters["lam"] == pytest.approx(3 * 0.05 ** (2 / 3), abs=1e-10)
    assert branch.points[-1].parameters["c"] == pytest.approx(0.1, abs=1e-15)


def test_a_failed_solve_says_why():
    failed = solved_bratu(4.0)
    assert not failed.success
    assert "Jacobian" in failed.message or "iterations" in failed.message
    with pytest.raises(InputError, match="solution: it is none"):
        continue_bvp(failed, "lam")


@pytest.mark.parametrize("lam", [1.0, 4.0])
def test_wrong_derivatives_are_noticed(lam):
    """Newton's method may converge all the same, but tangents would be wrong."""
    solution = solved_bratu(lam, rhs_jacobian=lambda t, y, p: (np.tile([[0, 1], [9.0, 0]], (len(t), 1, 1)), None))
    assert "rhs_jacobian differs" in solution.message
    assert "boundary_jacobian" not in solution.message
    assert not solution.success


def test_a_branch_that_needs_too_fine_a_mesh_says_so():
    branch = continue_bvp(solved_bratu(max_intervals=20), "lam", until={"norm": 100.0})
    assert not branch.complete
    assert "max_intervals = 20" in branch.reason


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"rhs": lambda t, y, p: y.T},
            r"rhs: its value has the shape \(2, 16\); return real numbers of shape \(16, 2\)",
        ),
        ({"rhs": lambda t, y, p: y * 1j}, "rhs: its value is no array of real numbers"),
        ({"rhs": lambda t, y, p: None}, "rhs: its value is no array"),
        ({"rhs": lambda t, y, p: np.log(y)}, "rhs: not finite at the guess, at t = 0.03125"),
        (
            {"boundary": lambda ya, yb, p: np.append(ya, yb)},
            "boundary: 4 boundary and 0 integral conditions .* name a par",
        ),
        ({"boundary": lambda ya, yb, p: ya[:1]}, "boundary: 1 boundary .* for 2 states and 0 free parameters; add"),
        ({"boundary": lambda ya, yb, p: ya[0]}, "boundary: its value has the shape"),
        ({"boundary": lambda ya, yb, p: ya / 0}, "boundary: not finite"),
        ({"integral": lambda t, y, p: y[:, 0]}, "integral: its value has the shape"),
        ({"mesh": [0, 2, 1]}, "mesh: it must be two or more increasing"),
        ({"mesh": [0, math.nan]}, "mesh: it has entries that are not finite"),
        (
            {"mesh": np.linspace(0, 1, 11), "guess": np.zeros((2, 11))},
            r"guess: shape \(2, 11\) does not fit the 11 points",
        ),
        ({"guess": "none"}, "guess: it is no array"),
        ({"parameters": [1.0]}, "parameters: they must have names"),
        ({"parameters": {"lam": "much"}}, "parameters: it is no array of numbers"),
        ({"free": ["nu"]}, "free: no parameter is called 'nu'; choose among lam"),
        ({"free": ["lam", "lam"]}, "free: .* names one twice"),
        ({"rhs_jacobian": lambda t, y, p: y}, "rhs_jacobian: it must return 2 arrays"),
        ({"rhs_jacobian": lambda t, y, p: (y, None)}, "rhs_jacobian: its value has the shape"),
        ({"m": 9}, "m: 9 is no whole number"),
        ({"tolerance": 0.0}, "tolerance: "),
    ],
)
def test_mistakes_in_a_problem_are_named(change, message):
    arguments = {"rhs": bratu_rhs, "boundary": zero_ends, "mesh": None, "guess": [0.0, 0.0], "parameters": {"lam": 1.0}}
    with pytest.raises(InputError, match=message) as caught:
        solve_bvp(**(arguments | change))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("vary", "change", "message"),
    [
        ("mu", {}, "vary: 'mu' is no parameter; choose among lam"),
        ("lam", {"until": {"E": 1}}, "until: no parameter or observable is called 'E'; there are lam, norm"),
        ("lam", {"until": {"fold:E": 1}}, "until: no parameter or observable is called 'E'"),
        ("lam", {"until": {"bp": 0.5}}, "until: 0.5 is no number of a bp"),
        ("lam", {"folds": ["E"]}, "no parameter or observable is called 'E'"),
        ("lam", {"direction": 2}, "direction: 2 is none"),
        ("lam", {"step": 1.0}, "step: "),
        ("lam", {"max_points": 1}, "max_points: 1 is less than 2"),
        ("lam", {"observables": {"lam": lambda s: 1.0}}, "observables: lam is a parameter's name"),
        ("lam", {"observables": {"y": lambda s: s.y}}, "observables: y is not one finite number"),
        ("lam", {"across": True}, "across: the solution is no branch point"),
    ],
)
def test_mistakes_in_a_continuation_are_named(vary, change, message):
    with pytest.raises(InputError, match=message):
        continue_bvp(solved_bratu(), vary, **change)


def test_a_determined_parameter_cannot_be_varied():
    start = solve_bvp(
        lambda t, y, p: 0 * y, lambda ya, yb, p: np.array([ya[0] - 1, p[0] - 2]), None, [1.0], {"q": 0.0}, ["q"]
    )
    with pytest.raises(InputError, match="vary: 'q' is determined by the conditions; choose among none"):
        continue_bvp(start, "q")


@pytest.mark.parametrize("module", ["solve", "branch"])
def test_examples(module):
    results = doctest.testmod(importlib.import_module(f"pearlbvp.bvp.{module}"))
    assert results.attempted > 1
    assert results.failed == 0
