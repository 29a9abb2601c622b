"""Pearls of all periods from those of a few, against a continuation each; what the stated error is worth; where there are none."""

import math
from dataclasses import replace

import numpy as np
import pytest

from pearlbvp.helfrich import Tube
from pearlbvp.studies import pearl_series
from pearlbvp.studies.first_pearls import first_pearls
from pearlbvp.studies.localized import SQUARE, V, losses_at
from pearlbvp.studies.pearl_series import PearlSeries, band, losses, scaled
from pearlbvp.theory.dispersion import stable_interval, stable_wave_numbers


def wanted(c0, lengths):
    """Periods and numbers of the first pearls, where there are several."""
    modes = [(length, stable_interval(Tube(c0, length)).lower_mode) for length in lengths]
    found = [(length / mode[0], mode[0]) for length, mode in modes if mode is not None and mode[0] > 1]
    return np.array([period for period, _ in found]), np.array([pearls for _, pearls in found])


def numbers(outcomes):
    return np.array([outcome.values or [math.nan] * 5 for outcome in outcomes])


@pytest.fixture(scope="module")
def series():
    return PearlSeries.over(0.45, *band(0.45))


@pytest.mark.parametrize("seed", [0, 1])
def test_series_give_what_a_continuation_each_gives(seed):
    random = np.random.default_rng(seed)
    c0 = random.uniform(0.28, 0.47)
    periods, pearls = wanted(c0, random.uniform(20, 300, 80))
    found, pieces = losses(c0, periods, pearls)
    assert pieces
    assert sum(piece.continuations for piece in pieces) < 30
    chosen = random.choice(len(periods), 12, replace=False)
    alone = [losses_at(c0, periods[i], [int(pearls[i])])[0] for i in chosen]
    assert [(found[i].status, found[i].message) for i in chosen] == [(one.status, one.message) for one in alone]
    np.testing.assert_allclose(numbers(found)[chosen], numbers(alone), atol=1e-10)


@pytest.mark.parametrize("c0", [0.26, 0.4, 0.49])
@pytest.mark.parametrize("pearls", [2, 3, 12])
def test_at_the_ends_of_the_band_other_pearls_come_first(c0, pearls):
    ends = [2 * math.pi / k for k in stable_wave_numbers(c0, pearls)]
    short, long = sorted(ends)
    for period, first in (
        (short * (1 - 1e-6), False),
        (short * (1 + 1e-6), True),
        (long * (1 - 1e-6), True),
        (long * (1 + 1e-6), False),
    ):
        assert (stable_interval(Tube(c0, pearls * period)).lower_mode == (pearls, 0)) is first


def test_the_stated_error_is_that_of_the_series():
    """Degrees 4 and 8 in the period against continuations: an error that is stated, and that falls with the degree."""
    low, high = scaled(np.array(7.8)), scaled(np.array(8.8))
    periods, pearls = np.array([7.93, 8.31, 8.52]), np.array([2, 4, 3])
    exact = numbers([losses_at(0.45, *case)[0] for case in zip(periods, pearls[:, None].tolist(), strict=True)])
    errors, stated = [], []
    for degree in (4, 8):
        found = PearlSeries.over(0.45, float(low), float(high), degrees=(degree, degree), tolerance=1.0)
        errors.append(np.abs(found.values(periods, pearls)[:, :4] - exact[:, :4]).max())
        stated.append(found.error)
    assert errors[0] < 10 * stated[0]
    assert 1e-12 < errors[1] < min(10 * stated[1], errors[0] / 30)


def test_at_the_ends_of_the_band_two_pearls_lose_stability_at_onset(series):
    """There the two neutral waves that change sign from cell to cell come next to each other, and to onset."""
    short, long = sorted(2 * math.pi / k for k in stable_wave_numbers(0.45, 2))
    periods = np.array([short + 1e-3, long - 1e-3, long - 1e-5])
    found = series.values(periods, np.full(3, 2))
    alone = numbers([losses_at(0.45, period, [2])[0] for period in periods])
    np.testing.assert_allclose(found[:, V], alone[:, 2], atol=1e-10)
    assert (found[:, V] > 1).all()
    assert found[2, V] < 1 + 1e-4


def test_where_v_turns_or_waves_are_around_a_series_does_not_decide(series):
    periods, pearls = np.array([8.4, 8.4]), np.array([2, 4])
    two, four = series.values(periods, pearls)[:, SQUARE]
    assert two > 1.3 * four
    near = replace(series, clear=two)  # four pearls lose stability well before, two too close to it
    assert np.isnan(near.values(periods, pearls)).all(axis=1).tolist() == [True, False]
    c = series.coefficients.copy()
    c[:, :, V] = 0
    c[0, 0, V], c[0, 1, V], c[0, 2, V] = 1.0, 1e-3, -5e-4  # turns at half of the amplitude that is reached
    folded = replace(series, coefficients=c)
    assert np.isnan(folded.values(periods, pearls)).all(axis=1)[0]


def test_what_is_known_is_not_computed_again(series, monkeypatch):
    periods, pearls = wanted(0.45, np.linspace(20, 100, 30))
    first, _ = losses(0.45, periods, pearls, [series])

    def refuse(*arguments):
        raise AssertionError("a continuation")

    monkeypatch.setattr(PearlSeries, "over", refuse)
    monkeypatch.setattr(pearl_series, "losses_at", refuse)
    again, new = losses(0.45, periods, pearls, [PearlSeries.from_bytes(series.to_bytes())])
    assert (again, new) == (first, [])
    assert len(first_pearls(0.45, [5.0, 8.0, *np.linspace(20, 100, 30)], [series])[0]) == 32


def test_few_periods_take_a_continuation_each():
    periods, pearls = wanted(0.45, [20.0, 40.0])
    found, new = losses(0.45, periods, pearls)
    assert new == []
    assert found == [losses_at(0.45, *case)[0] for case in zip(periods, pearls[:, None].tolist(), strict=True)]
