"""The compiled equation: derivatives, first integral, and the variation of the energy that it stands for."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from pearlbvp.shapes import axisymmetric

STATE = st.tuples(st.floats(0.3, 2), st.floats(-2, 2), st.floats(-1, 2), st.floats(-1, 1))
PARAMETERS = st.tuples(
    *[st.floats(0.5, 3), st.floats(-2, 2), st.floats(-2, 2), st.floats(-1, 1), st.floats(3, 9), st.floats(0.5, 1.5)]
)


@given(STATE, PARAMETERS)
def test_jacobians_against_central_differences(state, parameters):
    y, p, t = np.array([state]), np.array(parameters), np.zeros(1)
    for function, jacobian in (
        (axisymmetric.rhs, axisymmetric.rhs_jacobian),
        (axisymmetric.constraints, axisymmetric.constraints_jacobian),
    ):
        by_y, by_p = jacobian(t, y, p)
        for column, step in enumerate(np.eye(4) * 1e-6):
            difference = (function(t, y + step, p) - function(t, y - step, p))[0] / 2e-6
            np.testing.assert_allclose(by_y[0, :, column], difference, rtol=1e-6, atol=1e-5)
        for column, step in enumerate(np.eye(6) * 1e-6):
            difference = (function(t, y, p + step) - function(t, y, p - step))[0] / 2e-6
            np.testing.assert_allclose(by_p[0, :, column], difference, rtol=1e-6, atol=1e-5)


@pytest.mark.parametrize("start", [(1.0, 0.3, 0.5, 0.1), (0.7, -0.5, 0.9, -0.2), (1.3, 0.0, 0.2, 0.4)])
def test_axial_force_is_conserved_along_any_solution(start):
    p = np.array([1.0, 0.4, -0.6, 0.3, 1.0, 1.0])
    solved = solve_ivp(
        lambda t, y: axisymmetric.rhs(np.array([t]), y[None], p)[0], (0, 1.5), start, rtol=1e-12, atol=1e-13
    )
    force = axisymmetric.axial_force(solved.y.T, p)
    assert np.ptp(solved.y[0]) > 0.05
    np.testing.assert_allclose(force, force[0], atol=1e-10)


def test_a_solution_of_the_equation_makes_the_free_energy_stationary():
    """Perturb a numerical solution in radius with fixed ends: F = E + lambda1 A + lambda2 V changes to second order only.

    E, A and V are computed from the graph r(x) by their definitions, with no use of the equation's terms.
    """
    p = np.array([1.0, 0.4, -0.6, 0.3, 1.0, 1.0])
    solved = solve_ivp(
        lambda x, y: axisymmetric.rhs(np.zeros(1), y[None], p)[0] / math.cos(y[1]), (0, 1.2), [1.0, 0.2, 0.45, 0.1],
        rtol=1e-12, atol=1e-13, dense_output=True,
    )  # fmt: skip
    nodes, weights = np.polynomial.legendre.leggauss(60)
    x, weights = 0.6 * (nodes + 1), 0.6 * weights
    r, psi, h, _ = solved.sol(x)
    slope = np.tan(psi)
    curve = (np.cos(psi) / r - 2 * h) / np.cos(psi) ** 3  # r'' of the graph, from psi' = cos psi / r - 2h

    def free_energy(eps):
        bump, bump1, bump2 = _bump(x, 1.2)
        radius, first, second = r + eps * bump, slope + eps * bump1, curve + eps * bump2
        stretch = np.sqrt(1 + first**2)
        mean = (1 / (radius * stretch) - second / stretch**3) / 2
        density = ((mean - p[3]) ** 2 + p[1]) * 2 * np.pi * radius * stretch + p[2] * np.pi * radius**2
        return weights @ density

    first = (free_energy(1e-4) - free_energy(-1e-4)) / 2e-4
    second = (free_energy(1e-2) - 2 * free_energy(0) + free_energy(-1e-2)) / 1e-4
    assert abs(first) < 1e-7
    assert abs(second) > 0.5


def _bump(x, end):
    """``(x (end - x))^3`` scaled, with its first two derivatives: it vanishes to third order at both ends."""
    p = np.polynomial.Polynomial([0, end, -1]) ** 3
    return p(x), p.deriv()(x), p.deriv(2)(x)
