"""Localized pearls on long tubes: the table in ``data``, energies by two ways, and where two pearls flow."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import pearlbvp as pb

TABLE = pd.read_csv(Path(__file__).parents[2] / "data" / "localized_states.csv")


def energy(length, k, centre, v):
    one = (length == TABLE.L) & (TABLE.k == k) & (TABLE.centre == centre) & (TABLE.v == v)
    return TABLE[one].E.item()


@pytest.fixture(scope="module")
def pearls():
    return pb.branch(pb.Tube(c0=0.48, L=60), "pearl", (8, 0), until={"v": 1.004})


@pytest.fixture(scope="module")
def single(pearls):
    return pearls.switch(1, until={"v": 1.1}, max_step=0.4)


def test_the_energy_is_the_integral_of_the_pressure(single):
    """``dE = -lambda2 dv/2`` between rows, of which the computed energies know nothing: the trapezoidal rule, corrected."""
    table = single.table()
    v, slope = table.v.to_numpy(), -table.lambda2.to_numpy() / 2
    second = np.gradient(slope, v, edge_order=2)
    h = np.diff(v)
    work = (h * (slope[1:] + slope[:-1]) / 2 + h**2 * (second[:-1] - second[1:]) / 12).sum()
    assert table.E.iloc[-1] - table.E.iloc[0] == pytest.approx(work, rel=1e-3)
    assert table.E.iloc[-1] == pytest.approx(energy(60, 1, "pearl", 1.1), rel=1e-8)


def test_the_volume_turns_nowhere_and_one_pearl_stays_stable(single):
    table = single.table()
    assert (np.diff(table.v) > 0).all()
    assert (table.n_unstable == 0).all()


def test_two_pearls_are_a_saddle_from_which_one_grows_at_the_other_s_expense(pearls):
    two = pearls.switch(1, centre="neck", until={"v": 1.05})[-1]
    assert two.spectrum.n_unstable == 1
    assert two.observables["E"] == pytest.approx(energy(60, 1, "neck", 1.05), rel=1e-8)
    end = pb.flow(two).table().iloc[-1]
    # The perturbation has changed the volume a little: what that is worth is lambda2's.
    expected = energy(60, 1, "pearl", 1.05) - end.lambda2 / 2 * (end.v_reduced - 1.05)
    assert pytest.approx(expected, abs=1e-6) == end.E


@pytest.mark.parametrize("v", [1.02, 1.05, 1.1])
def test_two_pearls_attract_and_one_is_less_than_two(v):
    for length in (60, 120):
        one, near, apart = (energy(length, *which, v) for which in ((1, "pearl"), (1, "neck"), (2, "pearl")))
        assert one < near < apart < energy(length, 0, "equal", v)
    # Two pearls at half the length are one on a tube of half the length, twice.
    assert energy(120, 2, "pearl", v) == pytest.approx(energy(60, 1, "pearl", v), rel=1e-8)
