"""Growth rates with what blocks share, on half of the points, against complex sums over all points, each by itself."""

import math

import numpy as np
import pytest
from support import bloch, pearls

from pearlbvp.constrained import restricted
from pearlbvp.stability.bloch import SecondVariation, derivatives
from pearlbvp.stability.isothermal import Isothermal
from pearlbvp.stability.spectrum import spectrum

COUNT = 96


@pytest.fixture(scope="module", params=[(0.0, 10.0, 1.3, 1.19), (0.48, 7.5, 1.03, 1.02)])
def profile(request):
    c0, period, v_end, v = request.param
    problem, u = pearls.at(pearls.path(c0, period, v_end), "v", v)
    return problem.profile(u)


def test_series_of_the_coordinate_are_its_quadrature(profile):
    sigma, total = bloch.isothermal_points(profile, COUNT)
    coordinate = Isothermal.of(profile)
    assert coordinate.period == pytest.approx(total, rel=1e-14)
    np.testing.assert_allclose(coordinate.points(COUNT), sigma[: COUNT // 2], atol=1e-14)
    whole = Isothermal.of(profile.mirrored())
    np.testing.assert_allclose(2 * whole.points(COUNT), sigma, atol=1e-13)


@pytest.mark.parametrize("n", [0, 1, 2, 4])
@pytest.mark.parametrize("theta", [0.0, 0.7, math.pi])
@pytest.mark.parametrize("half", [True, False])
def test_rates_are_those_of_complex_sums(profile, n, theta, half):
    given = profile if half else profile.mirrored()
    matrix, rows = bloch.matrix(profile, COUNT, n, theta)
    size = np.abs(np.linalg.eigvalsh(matrix)).max()
    if n == 0 and theta == 0:
        (matrix,) = restricted(rows, matrix)
    expected = np.linalg.eigvalsh(matrix)[::-1]
    found = SecondVariation.of(given, COUNT).growth_rates(n, theta)
    np.testing.assert_allclose(found, expected, atol=1e-14 * size)


@pytest.mark.parametrize("n", [0, 3])
@pytest.mark.parametrize("parity", ["even", "odd"])
def test_waves_of_a_parity_are_folded_sums(profile, n, parity):
    """At ``theta = pi`` waves change their sign from cell to cell, and have one parity about the belly."""
    matrix, _ = bloch.matrix(profile, COUNT, n, math.pi)
    here, beyond = matrix[: COUNT // 2, : COUNT // 2], matrix[: COUNT // 2, COUNT // 2 :][:, ::-1]
    folded = here + beyond if parity == "odd" else here - beyond
    found = SecondVariation.of(profile, COUNT).matrix(n, math.pi, parity)
    np.testing.assert_allclose(found, folded, atol=1e-12 * np.abs(matrix).max())


@pytest.mark.parametrize("theta", [0.0, 0.3, math.pi])
def test_both_parities_are_the_parts_of_complex_waves(theta):
    count, half = 12, 6
    x = (np.arange(count) + 0.5) / count
    value = 0.4 * np.exp(1j * theta * x) + np.exp(1j * (theta + 4 * np.pi) * x)  # real coefficients
    slope = 0.4j * theta * np.exp(1j * theta * x) + 1j * (theta + 4 * np.pi) * np.exp(1j * (theta + 4 * np.pi) * x)
    first, second = derivatives(count, theta, "both")
    parts = np.concatenate((value.real[:half], value.imag[:half]))
    np.testing.assert_allclose(first @ parts, np.concatenate((slope.real[:half], slope.imag[:half])), atol=1e-12)
    whole = derivatives(count, theta, None)[1] @ value
    np.testing.assert_allclose(second @ parts, np.concatenate((whole.real[:half], whole.imag[:half])), atol=1e-11)


def test_rates_near_zero_do_not_change_with_more_points(profile):
    usual, fine = spectrum(profile), spectrum(profile, points=160)
    assert usual.points < 100 < fine.points
    assert usual.n_unstable == fine.n_unstable
    assert usual.rates.keys() == fine.rates.keys()
    for block, rates in usual.rates.items():
        slow = np.abs(rates) < 10
        np.testing.assert_allclose(
            rates[slow], fine.rates[block][: len(rates)][slow], atol=usual.neutral + fine.neutral
        )
