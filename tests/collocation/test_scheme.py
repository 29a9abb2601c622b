"""The collocation scheme: exactness on polynomials, and its constants."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pearlbvp.collocation.scheme import derivative_matrix, gauss_scheme, lagrange_matrix

DEGREES = range(2, 8)


@pytest.mark.parametrize("m", DEGREES)
def test_basis_is_exact_on_polynomials_of_degree_m(m):
    scheme = gauss_scheme(m)
    p = np.polynomial.Polynomial(np.arange(1.0, m + 2))
    np.testing.assert_allclose(scheme.values @ p(scheme.points), p(scheme.nodes), rtol=1e-13)
    np.testing.assert_allclose(scheme.derivatives @ p(scheme.points), p.deriv()(scheme.nodes), rtol=1e-12)
    # The m-th derivative of a polynomial of degree m is m! times its leading coefficient, m + 1 here.
    assert scheme.leading @ p(scheme.points) == pytest.approx(math.factorial(m) * (m + 1), rel=1e-11)


@pytest.mark.parametrize("m", DEGREES)
def test_quadrature_is_exact_to_degree_2m_minus_1_and_no_further(m):
    scheme = gauss_scheme(m)
    for degree in range(2 * m):
        assert scheme.weights @ scheme.nodes**degree == pytest.approx(1 / (degree + 1), rel=1e-13)
    assert abs(scheme.weights @ scheme.nodes ** (2 * m) - 1 / (2 * m + 1)) > 1e-9


def test_error_constant_of_two_points_in_closed_form():
    # K(t) = (1/2) integral of (s^2 - s + 1/6) = t (2t - 1)(t - 1)/12, largest at t = (1 - 1/sqrt 3)/2
    assert gauss_scheme(2).error_constant == pytest.approx(1 / (72 * math.sqrt(3)), rel=1e-3)


@given(st.lists(st.floats(-5, 5), min_size=3, max_size=3), st.floats(0, 1))
def test_lagrange_matrix_reproduces_parabolas(coefficients, at):
    p = np.polynomial.Polynomial(coefficients)
    points = np.array([0.0, 0.3, 1.0])
    np.testing.assert_allclose(lagrange_matrix(points, np.array([at])) @ p(points), p(at), atol=1e-12)
    np.testing.assert_allclose(derivative_matrix(points) @ p(points), p.deriv()(points), atol=1e-11)


@pytest.mark.parametrize("m", [1, 8, 2.5, "4"])
def test_only_two_to_seven_points(m):
    with pytest.raises(ValueError, match=r"^m: .*2 to 7"):
        gauss_scheme(m)
