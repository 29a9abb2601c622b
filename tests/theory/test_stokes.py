"""Growth rates in fluids against the equations of Stokes solved by collocation, closed forms, textbook limits and figures."""

import sys
from pathlib import Path

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import i0e, i1e, k0e, k1e
from support.stokes import growth_rate as by_collocation

from pearlbvp.errors import InputError
from pearlbvp.theory.dispersion import growth_rate
from pearlbvp.theory.stokes import Fluids, fastest_waves, friction, inside, outside, stokes_rate

sys.path.insert(0, str(Path(__file__).parents[1] / "derivations"))
import stokes as derivation

EULER = 0.5772156649015329
WAVES = [(0.3, 0), (1.3, 0), (0.1, 1), (1.3, 1), (0.0, 2), (0.5, 2), (4.0, 2), (0.0, 3), (2.0, 5)]


@pytest.mark.parametrize("kind", ["inside", "outside"])
@pytest.mark.parametrize("n", [0, 1, 2, 5])
def test_the_flows_are_flows(kind, n):
    with mpmath.workdps(30):
        found = derivation.evaluator("residuals", kind)(mpmath.mpf("0.7"), mpmath.mpf("1.3"), n)
        assert max(abs(value) for row in found for value in row) < 1e-24


@pytest.mark.parametrize(("kind", "matrix"), [("inside", inside), ("outside", outside)])
@pytest.mark.parametrize(("k", "n"), [(0.3, 0), (0.1, 1), (0.5, 2), (2.0, 5)])
def test_tractions_are_those_of_the_derived_flows(kind, matrix, k, n):
    with mpmath.workdps(30):
        rows = derivation.evaluator("tractions", kind)(1, mpmath.mpf(k), n)
    phases = np.array([1, -1j, 1j])
    velocity, traction = (np.array([row[part] for row in rows], complex) / phases for part in (slice(3), slice(3, 6)))
    wanted = np.linalg.solve(velocity, traction).T * (1 if kind == "inside" else -1)
    np.testing.assert_allclose(matrix(np.array(k), n), wanted, rtol=0, atol=1e-12 * np.abs(wanted).max())


@given(st.floats(1e-4, 300), st.integers(0, 60))
def test_friction_is_reciprocal_and_dissipates(k, n):
    for matrix in (inside, outside):
        found = matrix(np.array([k]), n)[0]
        largest = np.abs(found).max()
        np.testing.assert_allclose(found, found.T, atol=1e-11 * largest)
        assert np.linalg.eigvalsh((found + found.T) / 2).min() > -1e-13 * largest


@pytest.mark.parametrize(("k", "n"), WAVES)
@pytest.mark.parametrize(
    ("lambda2", "c0", "ratio", "membrane"), [(-0.8, 0.0, 1.0, 0.0), (0.4, 0.45, 0.05, 0.0), (-1.5, -0.6, 20.0, 0.7)]
)
def test_rates_are_those_of_stokes_s_equations_by_collocation(k, n, lambda2, c0, ratio, membrane):
    # Minus the second variation, as the paper has it (eq. (eigs)), is the force by which the membrane pulls.
    q = k**2 + n**2
    force = -(q**2) / 2 + (lambda2 + 1) * q - (lambda2 + 0.5) - (1 - 2 * c0) * k**2
    rate, residual = by_collocation(k, n, force, ratio, membrane)
    assert residual < 1e-6
    assert stokes_rate(k, n, lambda2, c0, Fluids(ratio, membrane)) == pytest.approx(rate.real, rel=1e-7)


@given(st.floats(0.01, 60), st.floats(0.01, 100))
def test_axisymmetric_friction_is_the_known_closed_form(k, ratio):
    I0, I1, K0, K1 = (f(k) for f in (i0e, i1e, k0e, k1e))  # P goes with 1/I and Q with 1/K
    P = (I1 - k * I0) / (2 * I0 * I1 + k * I1**2 - k * I0**2)
    Q = (K1 + k * K0) / (2 * K0 * K1 - k * K1**2 + k * K0**2)
    known = 2 * Q * K0 - 2 * ratio * P * I0 + 2 * ratio * (1 + P * I1 / k) - 2 * (1 - Q * K1 / k)
    assert friction(k, 0, Fluids(ratio)) == pytest.approx(known, rel=1e-10)  # whose terms cancel by k^2


def fastest(rate):
    """Where a function of the wave number is largest, and how large."""
    k = np.linspace(0.02, 0.98, 97)
    for _ in range(4):
        best = k[rate(k).argmax()]
        k = np.linspace(best - (k[1] - k[0]), best + (k[1] - k[0]), 97)
    return best, rate(best)


@pytest.mark.parametrize(("ratio", "wave"), [(1.0, 0.6128), (0.01, 0.5390), (100.0, 0.6358)])
def test_fastest_waves_of_strong_tension(ratio, wave):
    # mu = lambda1 (1 - k^2) for n = 0 as lambda1 grows, lambda2 = 1/4 - lambda1
    at, s = fastest(lambda k: stokes_rate(k, 0, -1e9, 0.0, Fluids(ratio)) / 1e9)
    assert at == pytest.approx(wave, abs=6e-5)
    if ratio == 1:
        assert s == pytest.approx(0.03025, abs=6e-6)


@pytest.mark.parametrize(("tension", "wave"), [(3.0, 0.4697), (10.0, 0.5735)])
def test_fastest_waves_of_moderate_tension(tension, wave):
    """``tension`` is Sigma R^2/kappa, so lambda1 is half of it."""
    assert fastest(lambda k: stokes_rate(k, 0, 0.25 - tension / 2, 0.0))[0] == pytest.approx(wave, abs=6e-5)


def test_of_long_waves_that_grow_alike_the_one_that_does_not_vary_is_named():
    assert fastest_waves(0.25 + 10, 0.0)[3] == 0.0  # the rate of wrinkles falls by less than rounding where k^2 does


@pytest.mark.parametrize("c0", [0.0, -0.6, 0.3])
def test_long_pearls_are_slowed_down_by_the_fluid_inside(c0):
    """s = -D k^2/(4 eta_i): Poiseuille's flow against a membrane that moves along with what it encloses."""
    ratio, k, lambda1 = 1e7, 1e-4, 2.0
    lambda2 = 0.25 - lambda1 - c0**2
    # Of 2 kappa: half of (k^2 - 1)^2 - 2 lambda2 (k^2 - 1) + 2 (1 - 2 c0) k^2 as k -> 0.
    D = (1 + 2 * lambda2) / 2
    assert stokes_rate(k, 0, lambda2, c0, Fluids(ratio)) == pytest.approx(-D * k**2 / (4 * ratio), rel=1e-6)


def test_a_shifted_tube_is_a_slender_body():
    """Per length 4 pi eta/(log(2/k) - gamma + 1/2): Cox, J. Fluid Mech. 44 (1970) 791; the wave moves pi of it."""
    for k in (1e-3, 1e-5):
        slender = 4 / (np.log(2 / k) - EULER + 0.5)
        for fluids in (Fluids(), Fluids(50.0, 3.0)):  # nothing flows inside
            assert friction(k, 1, fluids) == pytest.approx(slender, rel=30 * k**2 * (1 - np.log(k)) * 50)
    assert stokes_rate(0.0, 1, -0.7, 0.2) == stokes_rate(0.0, 0, -0.7, 0.2) == 0


@pytest.mark.parametrize("n", [2, 3, 20, 100])
def test_wrinkles_are_flows_in_the_plane(n):
    """Of the stream functions a r^n + b r^(n+2) inside, a r^-n + b r^(2-n) outside: 2 (n - 1/n) by the viscosity on either side."""
    for ratio in (0.3, 1.0):
        wanted = 2 * (1 + ratio) * (n - 1 / n)
        assert friction(0.0, n, Fluids(ratio)) == pytest.approx(wanted, rel=1e-12)
        assert friction(1e-7, n, Fluids(ratio)) == pytest.approx(wanted, rel=1e-9)


def test_short_waves_are_those_of_a_plane_membrane():
    """2 k (eta_i + eta_e): Brochard, Lennon, J. Phys. (Paris) 36 (1975) 1035, and again where n is large."""
    assert friction(2e3, 0, Fluids(3.0)) == pytest.approx(2 * 4 * 2e3, rel=1e-3)
    assert friction(1.2e3, 1600, Fluids(3.0)) == pytest.approx(2 * 4 * 2e3, rel=1e-3)


@given(st.floats(1e-3, 30), st.floats(0, 1e3))
def test_a_viscous_membrane_adds_four_times_its_viscosity_to_pearls(k, viscosity):
    """Rings widen at the rate that the membrane contracts at along them: 2 (1 + 1), whatever the wave."""
    assert friction(k, 0, Fluids(1.0, viscosity)) - friction(k, 0) == pytest.approx(
        4 * viscosity, rel=1e-9, abs=1e-8 / k**2
    )


@pytest.mark.parametrize(("lambda2", "c0"), [(-1.25, 0.0), (-0.45, 0.48), (-0.4, 0.45)])
def test_a_very_viscous_membrane_chooses_long_pearls_or_those_of_spontaneous_curvature(lambda2, c0):
    """J. Lyu et al., arXiv:2110.07026: with the viscosity the wave number goes to zero, or to that of the curvature."""
    waves = [fastest_waves(lambda2, c0, Fluids(1.0, viscosity))[0] for viscosity in (0.0, 1e2, 1e4, 1e7)]
    assert waves == sorted(waves, reverse=True)
    # d mu/d k^2 = -(k^2 - 1) + lambda2 - (1 - 2 c0)
    assert waves[-1] == pytest.approx(np.sqrt(max(0, lambda2 + 2 * c0)), abs=0.02)


@given(st.floats(0, 5), st.integers(0, 6), st.floats(-5, 5), st.floats(-1, 1), st.floats(0.01, 100), st.floats(0, 10))
def test_fluids_decide_how_fast_and_not_whether(k, n, lambda2, c0, ratio, membrane):
    rate, mu = stokes_rate(k, n, lambda2, c0, Fluids(ratio, membrane)), growth_rate(k, n, lambda2, c0)
    assert np.sign(rate) == (0 if k < 1e-8 and n < 2 else np.sign(mu))


def test_impossible_fluids():
    with pytest.raises(InputError, match="^viscosity_ratio: "):
        Fluids(0.0)
    with pytest.raises(InputError, match="^membrane_viscosity: .* negative"):
        Fluids(1.0, -1.0)
