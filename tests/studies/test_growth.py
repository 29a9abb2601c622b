"""The table of growth rates: which waves it lists, which is the fastest, and the tensions between which the tube rests."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pearlbvp as pb
from pearlbvp.studies.growth import COLUMNS, growth, stable_tensions
from pearlbvp.theory.stokes import Fluids, stokes_rate


def test_each_wave_is_listed_once_with_its_rates():
    table = growth(0.2, 0.9, 40, max_n=3, viscosity_ratio=5.0, membrane_viscosity=2.0)
    assert list(table) == COLUMNS
    assert not table.duplicated(["m", "n"]).any()
    assert set(table.n) == {0, 1, 2, 3}
    assert ((table.m > 0) | (table.n > 1)).all()
    np.testing.assert_allclose(table.k, 2 * np.pi * table.m.astype(float) / 40)
    np.testing.assert_allclose(table.lambda2, 0.25 - 0.9 - 0.04)
    q = table.k**2 + table.n**2
    mu = -(q**2) / 2 + (table.lambda2 + 1) * q - (table.lambda2 + 0.5) - (1 - 2 * 0.2) * table.k**2  # paper, eq. (eigs)
    np.testing.assert_allclose(table.mu, mu, atol=1e-12)
    np.testing.assert_allclose(table.mu_diffusion, q * mu, atol=1e-11)
    for row in table.itertuples():
        assert row.rate == pytest.approx(float(stokes_rate(row.k, row.n, row.lambda2, 0.2, Fluids(5.0, 2.0))))


@settings(max_examples=25)
@given(st.floats(-1, 0.6), st.floats(-4, 20), st.one_of(st.none(), st.floats(8, 60)), st.floats(0.05, 20))
def test_no_wave_is_faster_than_the_fastest(c0, tension, length, ratio):
    table = growth(c0, tension, length, viscosity_ratio=ratio)
    found = table[table.role == "fastest"]
    k = np.linspace(0, 6, 1201) if length is None else 2 * np.pi / length * np.arange(int(length))
    best = max(stokes_rate(k, n, 0.25 - tension - c0**2, c0, Fluids(ratio)).max() for n in range(6))
    if found.empty:
        assert best < 1e-12
    else:
        assert found.rate.item() == pytest.approx(best, rel=1e-12 if length else 2e-3, abs=1e-9)
        assert found.rate.item() >= best - 1e-12 * abs(best)


@settings(max_examples=8)
@given(st.floats(-1, 0.48), st.one_of(st.none(), st.floats(8, 60)))
def test_between_the_two_tensions_nothing_grows_and_beyond_them_something_does(c0, length):
    lower, pearl = stable_tensions(c0, None if length is None else pb.Tube(c0, length))
    if not lower < pearl:
        return
    near = 1e-3 * (pearl - lower)
    for tension, grows in ((lower - near, True), (lower + near, False), (pearl - near, False), (pearl + near, True)):
        table = growth(c0, tension, length)
        assert (table.role == "fastest").any() == grows
        if grows:
            wave = table[table.role == "fastest"].iloc[0]
            assert (wave.n == 0 and wave.k < 1) == (tension > pearl)


@pytest.mark.parametrize("c0", [-0.9, 0.0, 0.45])
def test_at_either_tension_one_wave_is_neutral(c0):
    """By the growth rate as the paper prints it, eq. (eigs), over all waves that fit."""
    m, n = np.meshgrid(np.arange(40), np.arange(12), indexing="ij")
    kk, around = (2 * np.pi * m / 11) ** 2, n**2
    waves = (m > 0) | (n > 1)
    for tension in stable_tensions(c0, pb.Tube(c0, 11)):
        q, lambda2 = kk + around, 0.25 - tension - c0**2
        mu = -(q**2) / 2 + (lambda2 + 1) * q - (lambda2 + 0.5) - (1 - 2 * c0) * kk
        assert mu[waves].max() == pytest.approx(0, abs=1e-12)


@settings(max_examples=10)
@given(st.floats(-1, 0.6), st.floats(-4, 20))
def test_waves_are_listed_up_to_where_none_grows(c0, tension):
    """And a fifth beyond, by the growth rate on a fine grid."""
    table = growth(c0, tension, max_n=6)
    k = np.linspace(0.02, 12, 600)
    grow = [stokes_rate(k, n, 0.25 - tension - c0**2, c0) > 0 for n in range(7)]
    growing = k[np.any(grow, axis=0)]
    assert table.k.max() >= max(1.5, 1.19 * growing.max(initial=0))


@given(st.floats(-1, 1), st.floats(-2, 5))
def test_the_force_is_the_slope_of_the_energy_by_the_length(c0, tension):
    """At given area and volume, over straight tubes whose multipliers take up what changes besides."""
    table = growth(c0, tension, wave_numbers=[0.5], max_n=0)

    def potential(length, radius):  # by pi: the energy, and the work of tension and pressure
        return 2 * radius * length * ((1 / (2 * radius) - c0) ** 2 + tension) + table.lambda2[0] * radius**2 * length

    h = 1e-4
    assert potential(1, 1 + h) == pytest.approx(potential(1, 1 - h), abs=1e-9)
    by_length = (potential(1 + h, 1) - potential(1 - h, 1)) / (2 * h)
    assert table.force[0] == pytest.approx(math.pi * by_length, rel=1e-9, abs=1e-9)


def test_textbook_onsets():
    # Sigma = 2 kappa lambda1/R^2: pearls of long waves at 3 kappa/(2 R^2) (Bar-Ziv, Moses, Phys. Rev. Lett. 73 (1994) 1392)
    table = growth(0.0, 1.0)
    assert 2 * table.lambda1_pearl[0] == 1.5
    # and stiff tubes rest at any length below
    assert growth(0.0, 1.0, 40).lambda1_pearl[0] > 0.75
    # beyond 1/2 no tension makes a long tube stable
    assert growth(0.6, 0.0).lambda1_pearl.isna().all()
    assert (growth(0.6, 0.0).role == "fastest").any()


def test_waves_that_a_user_asks_for():
    table = growth(0.0, 0.0, wave_numbers=[0.0, 0.5, 0.25], max_n=2)
    assert table[table.n == 0].k.tolist() == [0.25, 0.5]
    assert table[table.n == 2].k.tolist() == [0.0, 0.25, 0.5]
    assert table.m.isna().all()
    assert (table.role == "").all()
    assert growth(0.0, 0.0, 20, max_m=3, max_n=0).m.tolist() == [1, 2, 3]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"tension": math.inf}, "^tension: inf is not finite"),
        ({"tension": 1e13}, "^tension: .* check its unit"),
        ({"tension": -1e4}, r"^tension: .* more waves around .*; give more than -999\.75"),
        ({"c0": 1e5}, "^c0: .* check its unit"),
        ({"length": -1}, "^length: "),
        ({"max_m": 3}, "^max_m: it goes with a length"),
        ({"length": 20, "max_m": 10**7}, "^max_m: .* too many"),
        ({"length": 20, "max_n": 10**7}, "^max_n: .* too many"),
        ({"length": 20, "wave_numbers": [0.1]}, "^wave_numbers: .* leave one of the two out"),
        ({"wave_numbers": [-0.1]}, "^wave_numbers: .* negative"),
        ({"wave_numbers": []}, "^wave_numbers: the list is empty"),
        ({"viscosity_ratio": 0}, "^viscosity_ratio: .* positive"),
        ({"membrane_viscosity": -1}, "^membrane_viscosity: .* negative"),
    ],
)
def test_mistakes(arguments, said):
    with pytest.raises(pb.InputError, match=said):
        pb.growth(**({"c0": 0.0, "tension": 1.0} | arguments))
