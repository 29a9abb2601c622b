"""Bloch growth rates and Floquet multipliers: each against closed forms on the cylinder, against each other on pearls."""

import math

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st
from support import pearls

from pearlbvp.collocation import PiecewisePolynomial
from pearlbvp.collocation.elimination import transfer_pencil
from pearlbvp.held import Held
from pearlbvp.stability.bloch import SecondVariation, growth_rates
from pearlbvp.stability.floquet import alternating_determinants, jacobi_matrices, multipliers, neutral_cosines
from pearlbvp.stability.isothermal import Isothermal
from pearlbvp.stability.profile import Profile
from pearlbvp.stability.spectrum import spectrum
from pearlbvp.theory.dispersion import growth_rate

NOTHING_HELD = Held(area=False, volume=False)


def cylinder(c0, lambda2, period, half=True, intervals=12):
    length = period / 2 if half else period
    values = np.tile([1.0, 0.0, 0.5, 0.0], (6 * intervals + 1, 1))
    states = PiecewisePolynomial(np.linspace(0, 1, intervals + 1), values)
    return Profile(states, length, half, c0, 0.25 - lambda2 - c0**2, lambda2, period)


@given(st.floats(-1, 1), st.floats(-2, 2), st.floats(0, 2 * math.pi), st.integers(0, 4))
def test_bloch_on_the_cylinder_is_the_dispersion_relation(c0, lambda2, theta, n):
    period = 7.0
    rates = SecondVariation.of(cylinder(c0, lambda2, period), 32).growth_rates(n, theta, held=NOTHING_HELD)
    k = (theta + 2 * np.pi * np.arange(-16, 16)) / period
    expected = np.sort(growth_rate(k, n, lambda2, c0))[::-1]
    np.testing.assert_allclose(rates[:5], expected[:5], atol=1e-9 * (1 + np.abs(expected).max()))


@given(st.floats(-1, 1), st.floats(-1, 1), st.integers(0, 2))
def test_floquet_on_the_cylinder_gives_the_roots_of_the_dispersion_relation(c0, lambda2, n):
    # mu(kappa) = 0 is quadratic in kappa = k^2: (kappa + n^2 - 1)^2/2 - lambda2 (kappa + n^2 - 1) + (1 - 2 c0) kappa = 0
    e = n**2 - 1
    kappa = np.roots([0.5, e - lambda2 + 1 - 2 * c0, e**2 / 2 - lambda2 * e]).astype(complex)
    period = 5.0
    expected = 2 * np.cos(np.sqrt(kappa) * period)
    cosines = neutral_cosines(cylinder(c0, lambda2, period), n)
    expected = expected[np.argsort(np.abs(expected - 2))]
    # Two values that nearly coincide are known to the square root of rounding only: compare sum and product.
    size = 1 + np.abs(expected).max()
    assert abs(cosines.sum() - expected.sum()) < 1e-8 * size
    assert abs(cosines.prod() - expected.prod()) < 1e-8 * size**2


def test_multipliers_of_a_stable_cylinder():
    c0, lambda2, period = 0.48, -0.2, 7.5
    kappa = np.roots([0.5, -1 - lambda2 + 1 - 2 * c0, 0.5 + lambda2]).astype(complex)
    expected = np.exp(1j * period * np.concatenate((np.sqrt(kappa), -np.sqrt(kappa))))
    found = multipliers(cylinder(c0, lambda2, period, half=False, intervals=20), 0)
    for rho in expected:
        assert np.abs(found - rho).min() < 1e-9 * abs(rho)


PEARLS = [(0.0, 10.0, 1.3, 1.05), (0.0, 10.0, 1.3, 1.19), (0.48, 7.5, 1.03, 1.006)]


@pytest.mark.parametrize(("pearl", "n"), [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)])
@pytest.mark.parametrize("theta", [0.4, 1.7])
def test_bloch_and_floquet_agree_on_pearls(pearl, n, theta):
    """The largest Bloch growth rate, put into the Floquet problem, gives a multiplier ``e^{i theta}``: above zero and below.

    Multipliers beside them are as large as 1e16. (Where they reach 1e23, n = 2 at v = 1.19, Floquet has no digits left.)
    """
    c0, period, v_end, v = PEARLS[pearl]
    problem, u = pearls.at(pearls.path(c0, period, v_end), "v", v)
    profile = problem.profile(u)
    mu = growth_rates(profile, n, theta, points=96)[0]

    def miss(mu):
        """Angle between ``e^{i theta}`` and the multiplier nearest to it."""
        rho = multipliers(profile, n, mu) * np.exp(-1j * theta)
        return np.angle(rho[np.abs(rho - 1).argmin()])

    # Newton's step from the Bloch growth rate to the Floquet one is their difference.
    slope = (miss(mu + 1e-5) - miss(mu - 1e-5)) / 2e-5
    assert abs(miss(mu) / slope) < 1e-9 * (1 + abs(mu))


def test_half_period_and_whole_period_give_the_same_angle():
    problem, u = pearls.at(pearls.path(0.48, 7.5, 1.03), "v", 1.006)
    profile = problem.profile(u)
    rho = multipliers(profile, 0)
    by_half = neutral_cosines(profile, 0)[1].real
    assert np.abs(rho + 1 / rho - by_half).min() < 1e-9


@pytest.mark.parametrize(("c0", "period", "v_end", "v"), PEARLS)
def test_alternating_waves_are_those_of_the_profile_s_own_equations(c0, period, v_end, v):
    """The equations of ``(r, psi, h, w)``, linearised, against those of ``(w, w', D, D')``; and against the cosine."""
    problem, u = pearls.at(pearls.path(c0, period, v_end), "v", v)
    profile = problem.profile(u)
    found = np.array(alternating_determinants(*problem.discretization.transfer_pencil(u)))
    a0, a1 = transfer_pencil(profile.states.scheme, np.diff(profile.states.mesh), jacobi_matrices(profile, 0))
    maps = np.linalg.solve(a1, -a0), np.linalg.solve(a0, -a1)
    for determinant, block in zip(found, (m[::2, ::2] for m in maps), strict=True):
        assert determinant == pytest.approx(np.linalg.det(block), abs=1e-12 * np.linalg.norm(block) ** 2)
    assert 4 * found.prod() - 2 == pytest.approx(neutral_cosines(profile, 0)[1].real, rel=1e-7)


def test_alternating_waves_in_the_chart_of_large_multipliers_are_the_same():
    problem, u = pearls.at(pearls.path(0.48, 7.5, 1.03), "v", 1.006)
    other, (moved,) = problem.change_chart(True, u)
    expected = alternating_determinants(*problem.discretization.transfer_pencil(u))
    assert alternating_determinants(*other.discretization.transfer_pencil(moved)) == pytest.approx(expected, rel=1e-9)


def test_multipliers_of_several_n_are_those_of_each():
    problem, u = pearls.at(pearls.path(0.48, 7.5, 1.03), "v", 1.006)
    profile = problem.profile(u)
    for one in profile, profile.mirrored():
        np.testing.assert_array_equal(multipliers(one, [1, 2]), [multipliers(one, 1), multipliers(one, 2)])


@pytest.mark.parametrize("n", [0, 1, 2])
def test_multipliers_of_a_half_period_are_those_of_the_whole_by_qz(n):
    """On the Riemann sphere, where eigenvalues of a pencil live (Stewart and Sun, Matrix Perturbation Theory, §VI.1)."""
    problem, u = pearls.at(pearls.path(0.48, 7.5, 1.03), "v", 1.006)
    whole = problem.profile(u).mirrored()
    a0, a1 = transfer_pencil(whole.states.scheme, np.diff(whole.states.mesh), jacobi_matrices(whole, n))
    expected = scipy.linalg.eigvals(-a0, a1)
    for profile in problem.profile(u), whole:
        found = multipliers(profile, n)
        for rho in expected:
            chordal = np.abs(found - rho) / np.sqrt((1 + np.abs(found) ** 2) * (1 + abs(rho) ** 2))
            # The double multiplier of translations is known to the square root of rounding only.
            assert chordal.min() < (1e-5 if abs(rho - 1) < 1e-3 else 1e-12)


@pytest.mark.parametrize(("c0", "period", "v_end", "v"), PEARLS)
def test_translations_are_neutral(c0, period, v_end, v):
    problem, u = pearls.at(pearls.path(c0, period, v_end), "v", v)
    profile = problem.profile(u)
    for n in (0, 1):
        rates = growth_rates(profile, n, 0.0, points=96)
        assert np.abs(rates).min() < 1e-9
        rho = multipliers(profile, n)
        pair = rho[np.argsort(np.abs(rho - 1))][:2]
        assert np.abs(pair - 1).max() < 1e-5  # a double multiplier: the square root of the error
        assert abs(pair.prod() - 1) < 1e-6
        assert abs(pair.sum() / 2 - 1) < 1e-6


def test_growth_rate_at_the_paper_s_sample_a2():
    # A2 of table ptab1, at lambda2 = -3.165. Printed is -2.22; recomputed twice -2.1192376, in n = 1.
    problem, u = pearls.at(pearls.path(0.0, 10.0, 1.3), "lambda2", -3.165)
    variation = SecondVariation.of(problem.profile(u), 96)
    worst = {n: max(mu for mu in variation.growth_rates(n, 0.0) if abs(mu) > 1e-7) for n in range(5)}
    assert max(worst, key=worst.get) == 1
    assert worst[1] == pytest.approx(-2.1192376, abs=2e-6)


def test_second_variation_is_the_second_derivative_of_the_energy():
    """Move a pearl along its normal by ``eps w``: F changes by ``-eps^2/2 * <w, mu w>``, E, A, V by their definitions."""
    problem, u = pearls.at(pearls.path(0.0, 10.0, 1.3), "v", 1.1)
    profile = problem.profile(u).mirrored()
    count = 128
    variation = SecondVariation.of(profile, count)
    total = Isothermal.of(profile).period
    r, psi, _, _ = profile.at(Isothermal.of(profile).points(count)).T
    xi = (np.arange(count) + 0.5) / count
    w = 0.6 + np.cos(2 * np.pi * xi) + 0.4 * np.cos(4 * np.pi * xi + 0.3)
    x0 = _integral(np.cos(psi) * r * total)

    def free_energy(eps):
        radius = r + eps * w * np.cos(psi)
        x1 = np.cos(psi) * r * total + eps * _derivative(-w * np.sin(psi))
        r1 = _derivative(radius)
        speed = np.hypot(x1, r1)
        bend = (r1 * _derivative(x1) - x1 * _derivative(r1)) / speed**3
        mean = (bend + x1 / speed / radius) / 2
        density = ((mean - profile.c0) ** 2 + profile.lambda1) * 2 * np.pi * radius * speed
        return np.mean(density + profile.lambda2 * np.pi * radius**2 * x1)

    eps = 2e-3
    second = (
        -free_energy(2 * eps)
        + 16 * free_energy(eps)
        - 30 * free_energy(0)
        + 16 * free_energy(-eps)
        - free_energy(-2 * eps)
    ) / (12 * eps**2)
    first = (-free_energy(2 * eps) + 8 * free_energy(eps) - 8 * free_energy(-eps) + free_energy(-2 * eps)) / (12 * eps)
    scaled = r * w
    expected = -(scaled @ variation.matrix(0, 0.0).real @ scaled) * 2 * np.pi * total / count
    assert abs(first) < 1e-7
    assert second == pytest.approx(expected, rel=1e-8)
    assert x0 == pytest.approx(profile.period, rel=1e-10)


def _derivative(f):
    """Spectral derivative of a periodic function of period 1 on an odd number of points."""
    k = np.fft.fftfreq(len(f), 1 / len(f))
    k[len(f) // 2] = 0
    return np.fft.ifft(2j * np.pi * k * np.fft.fft(f)).real


def _integral(f):
    return np.mean(f)


def test_mirrored_profile_is_the_half_profile_continued():
    problem, u = pearls.at(pearls.path(0.0, 10.0, 1.3), "v", 1.1)
    half = problem.profile(u)
    whole = half.mirrored()
    t = np.linspace(0, 1, 57)
    np.testing.assert_allclose(whole.at(t), half.at(2 * t), atol=1e-13)
    np.testing.assert_allclose(growth_rates(whole, 1, 0.7), growth_rates(half, 1, 0.7), atol=1e-7)


def test_isothermal_points_are_evenly_spaced_in_the_integral_of_ds_over_r():
    problem, u = pearls.at(pearls.path(0.0, 10.0, 1.3), "v", 1.25)
    profile = problem.profile(u)
    coordinate = Isothermal.of(profile)
    total, half = coordinate.period, coordinate.points(42)
    sigma = np.concatenate((half, 2 - half[::-1]))
    np.testing.assert_allclose(Isothermal.of(profile.mirrored()).points(42), sigma / 2, atol=1e-12)
    fine = np.linspace(0, 2, 200_001)
    radius = profile.at(fine)[:, 0]
    xi = np.concatenate(([0], np.cumsum((1 / radius[1:] + 1 / radius[:-1]) / 2 * np.diff(fine)))) * profile.arclength
    assert total == pytest.approx(xi[-1], rel=1e-8)
    np.testing.assert_allclose(np.interp(sigma, fine, xi), (np.arange(42) + 0.5) * total / 42, atol=1e-7)


def test_neutral_cosines_needs_a_half_profile():
    with pytest.raises(ValueError, match="^profile: "):
        neutral_cosines(cylinder(0, 0, 5, half=False), 0)


def test_parities_split_the_spectrum_and_nothing_is_lost():
    problem, u = pearls.at(pearls.path(0.0, 10.0, 1.3), "v", 1.1)
    variation = SecondVariation.of(problem.profile(u), 96)
    for n in range(3):
        for theta in (0.0, math.pi):
            whole = variation.growth_rates(n, theta, held=NOTHING_HELD)
            parts = [variation.growth_rates(n, theta, parity, held=NOTHING_HELD) for parity in ("even", "odd")]
            np.testing.assert_allclose(np.sort(np.concatenate(parts))[::-1][:8], whole[:8], atol=1e-8)


def test_only_symmetric_waves_have_a_parity():
    variation = SecondVariation.of(cylinder(0.1, 0.2, 7.0, half=False))
    for theta in (0.0, 1.0):
        with pytest.raises(ValueError, match="^parity: "):
            variation.matrix(0, theta, "even")


@given(st.floats(-1, 0.45), st.floats(-1.5, 2), st.integers(1, 6))
def test_unstable_count_on_the_cylinder_is_the_dispersion_relation_s(c0, lambda2, cells):
    period = 7.0
    m, n = np.arange(-60, 61)[:, None], np.arange(-12, 13)[None, :]
    rates = growth_rate(2 * np.pi * m / (cells * period), n, lambda2, c0)
    # Without volume and translations: (0, 0) is no perturbation at fixed area, (0, +-1) are shifts.
    counted = (rates > 0) & ~((m == 0) & (np.abs(n) <= 1))
    if np.abs(rates[~((m == 0) & (np.abs(n) <= 1))]).min() < 1e-8:
        return
    assert spectrum(cylinder(c0, lambda2, period), cells).n_unstable == counted.sum()


def test_cells_of_a_tube_are_the_cells_of_a_longer_period():
    """Two pearls as one period of twice the length: the same unstable space, computed in another basis."""
    problem, u = pearls.at(pearls.path(0.48, 7.5, 1.03), "v", 1.02)
    half = problem.profile(u)
    doubled = spectrum(half, 2, points=96)
    one = half.mirrored()
    mesh = np.concatenate((one.states.mesh / 2, one.states.mesh[1:] / 2 + 0.5))
    values = np.vstack((one.states.values, one.states.values[1:]))
    two = Profile(PiecewisePolynomial(mesh, values), 2 * one.arclength, False, one.c0, one.lambda1, one.lambda2, 15.0)
    long = spectrum(two, 1, points=192)
    assert doubled.n_unstable == long.n_unstable > 0
    assert doubled.mu_crit == pytest.approx(long.mu_crit, abs=1e-8)
    assert str(doubled.critical) == "n=0 j=1/2 even"


def test_a2_is_stable_with_its_least_stable_mode_in_n_1():
    problem, u = pearls.at(pearls.path(0.0, 10.0, 1.3), "lambda2", -3.165)
    found = spectrum(problem.profile(u))
    assert found.n_unstable == 0
    assert found.critical.n == 1
    assert found.mu_crit == pytest.approx(-2.1192, abs=1e-4)
    assert found.residual < 1e-7
    # At given pressure the pearl is a saddle: its volume can change (it bifurcates subcritically in lambda2).
    assert spectrum(problem.profile(u), held=Held(volume=False)).n_unstable in (0, 1)
