"""Collocation on textbook problems: orders, exact solutions, adaptivity, failures."""

import math

import numpy as np
import pytest
from scipy.special import ellipe, ellipk
from support.problems import BRATU_FOLD, bratu, bratu_exact, elastica, van_der_pol

from pearlbvp.collocation import Discretization, error_estimate, gauss_scheme, solve_bvp
from pearlbvp.collocation.elimination import transfer_pencil
from pearlbvp.collocation.polynomial import all_points


@pytest.mark.parametrize("m", [2, 3, 4, 5])
def test_order_2m_at_mesh_points(m):
    exact = bratu_exact(3.5)
    meshes = {2: (20, 28, 40), 3: (12, 17, 24), 4: (6, 8, 12), 5: (6, 8, 10)}[m]
    errors = []
    for intervals in meshes:
        mesh = np.linspace(0, 1, intervals + 1)
        solved = solve_bvp(bratu(), mesh, np.zeros((intervals + 1, 2)), np.array([3.5]), m=m, tolerance=1.0)
        errors.append(np.abs(solved.solution.values[::m, 0] - exact(mesh)).max())
    assert -np.polyfit(np.log(meshes), np.log(errors), 1)[0] == pytest.approx(2 * m, abs=0.5)


@pytest.mark.parametrize("m", [2, 4, 6, 7])
def test_adapted_solution_is_as_good_as_it_says(m):
    tolerance = 1e-7
    solved = solve_bvp(bratu(), np.linspace(0, 1, 5), np.zeros((5, 2)), np.array([3.3]), m=m, tolerance=tolerance)
    assert solved.success
    t = np.linspace(0, 1, 801)
    size = 1 + np.abs(solved.solution.values[:, 0]).max()
    error = np.abs(solved.solution(t)[:, 0] - bratu_exact(3.3)(t)).max() / size
    assert error < 2 * tolerance
    assert solved.error < tolerance


def test_the_error_estimate_has_the_size_of_the_error():
    solved = solve_bvp(bratu(), np.linspace(0, 1, 11), np.zeros((11, 2)), np.array([2.0]), m=3, tolerance=1.0)
    t = np.linspace(0, 1, 2001)
    size = 1 + np.abs(solved.solution.values[:, 0]).max()
    error = np.abs(solved.solution(t)[:, 0] - bratu_exact(2.0)(t)).max() / size
    assert 0.3 < error_estimate(solved.solution).max() / error < 5


def test_van_der_pol_period_and_multipliers():
    def reference(t):
        return 2 * np.pi * np.column_stack((np.cos(2 * np.pi * t), -np.sin(2 * np.pi * t)))

    mesh = np.linspace(0, 1, 21)
    guess = 2 * np.column_stack((np.sin(2 * np.pi * mesh), np.cos(2 * np.pi * mesh)))
    solved = solve_bvp(van_der_pol(reference), mesh, guess, np.array([6.5, 1.0]), ("T",), m=4, tolerance=1e-9)
    assert solved.success
    # M. B. Amore, High order analysis of the limit cycle of the van der Pol oscillator (2018); T(mu = 1) to all digits.
    assert solved.parameters["T"] == pytest.approx(6.663286859323130, abs=1e-11)
    d = solved.discretization
    by_y, _ = d.problem.rhs_jacobian(d.gauss_points, d.at_gauss_points(solved.u), d.all_parameters(solved.u))
    a0, a1 = transfer_pencil(d.scheme, d.h, by_y)
    multipliers = np.sort(np.linalg.eigvals(-np.linalg.solve(a1, a0)).real)
    assert multipliers[1] == pytest.approx(1, abs=1e-9)
    # Liouville: the product is exp of the integral of the trace of the Jacobian.
    trace = d.gauss_weights @ np.trace(by_y, axis1=1, axis2=2)
    assert multipliers[0] == pytest.approx(math.exp(trace), rel=1e-8)


def test_elastica_against_elliptic_integrals():
    # One arch with psi = 0 at both ends: a full wave of the pendulum with modulus k. Force 16 K(k)^2, shortening
    # 2 (1 - E/K) (A. E. H. Love, A Treatise on the Mathematical Theory of Elasticity, art. 263).
    modulus = 0.5
    force, shortening = 16 * ellipk(modulus**2) ** 2, 2 * (1 - ellipe(modulus**2) / ellipk(modulus**2))
    mesh = np.linspace(0, 1, 17)
    guess = np.column_stack((0.9 * np.sin(2 * np.pi * mesh), 6 * np.cos(2 * np.pi * mesh)))
    solved = solve_bvp(elastica(), mesh, guess, np.array([40.0, shortening]), ("force",), m=5, tolerance=1e-9)
    assert solved.success
    assert solved.parameters["force"] == pytest.approx(force, rel=1e-11)


@pytest.mark.parametrize("build", [bratu, elastica])
def test_jacobian_is_the_residual_s_derivative(build):
    rng = np.random.default_rng(1)
    problem = build()
    mesh = np.array([0.0, 0.2, 0.7, 1.0])
    free = () if build is bratu else ("force",)
    d = Discretization(problem, gauss_scheme(3), mesh, rng.uniform(1, 2, len(problem.parameters)), free)
    u, direction = rng.standard_normal(d.size), rng.standard_normal(d.size)
    eps = 1e-6
    derivative = (d.residual(u + eps * direction) - d.residual(u - eps * direction)) / (2 * eps)
    np.testing.assert_allclose(d.solve(u, derivative), direction, rtol=1e-6, atol=1e-6)


def test_moving_to_another_mesh_keeps_polynomials():
    d = Discretization(bratu(), gauss_scheme(4), np.linspace(0, 1, 4), np.array([1.0]), ())
    t = all_points(d.mesh, d.scheme)
    u = d.pack(np.column_stack((t**3 - t, 1 - t**3)), d.parameters)
    other, (moved,) = d.on_mesh(np.array([0, 0.1, 0.5, 0.9, 1.0]), u)
    t = all_points(other.mesh, other.scheme)
    np.testing.assert_allclose(other.values(moved), np.column_stack((t**3 - t, 1 - t**3)), atol=1e-14)
    assert d.inner(u, u) == pytest.approx(other.inner(moved, moved), rel=1e-12)


def test_beyond_the_fold_the_failure_is_a_result():
    solved = solve_bvp(bratu(), np.linspace(0, 1, 9), np.zeros((9, 2)), np.array([BRATU_FOLD + 0.1]))
    assert not solved.success
    assert "iterations" in solved.message or "Jacobian" in solved.message


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mesh": np.array([0, 0.5, 0.4, 1.0])}, "mesh: "),
        ({"guess": np.zeros((7, 2))}, "guess: "),
        ({"free": ("lam",)}, "free: .* unknowns"),
        ({"free": ("nu",)}, "free: .*nu"),
    ],
)
def test_unusable_input_is_named(change, message):
    mesh = change.pop("mesh", np.linspace(0, 1, 4))
    arguments = {"guess": np.zeros((4, 2)), "parameters": np.array([1.0])} | change
    with pytest.raises(ValueError, match=message):
        solve_bvp(bratu(), mesh, **arguments)
