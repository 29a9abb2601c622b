"""Profiles from elsewhere: one shape, however it is written down."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from pearlbvp.errors import InputError
from pearlbvp.studies.flow_start import profile_start
from pearlbvp.studies.profiles import one_period
from pearlbvp.tables import read_table

DATA = Path(__file__).parents[1] / "data"
L = 10 / 3


def radius_at(x):
    return 1 + 0.1 * np.sin(2 * np.pi * x / L) + 0.03 * np.cos(4 * np.pi * x / L)


def sampled(count=60, start=0.0, closed=False):
    x = start + L * np.arange(count + closed) / count
    return x, radius_at(x)


def distance(spline, count=400):
    x = L * np.arange(count) / count
    return np.abs(spline(x) - radius_at(x)).max()


def energy(r, r1, r2, length):
    """Bending energy by area of a surface of revolution with ``c0 = 0``, by quadrature of the closed form."""

    def area(x):
        return r(x) * np.sqrt(1 + r1(x) ** 2)

    def bending(x):
        q = np.sqrt(1 + r1(x) ** 2)
        return ((1 / (r(x) * q) - r2(x) / q**3) / 2) ** 2 * area(x)

    return quad(bending, 0, length, epsabs=1e-12)[0] / quad(area, 0, length, epsabs=1e-12)[0]


@pytest.mark.parametrize("name", ["profile_closed_10digits.csv", "profile_open_10digits.csv"])
def test_the_energy_of_a_profile_is_its_own_whether_the_last_row_repeats_the_first(name):
    table = read_table("profile", DATA / name, ("x", "r"))
    graph, q = profile_start(0.0, 3.33333333333333, np.array(table["x"]), np.array(table["r"]))
    found = graph.observables(q, np.zeros(2))
    k = 2 * np.pi / L
    expected = energy(
        lambda x: 1 + 0.1 * np.sin(k * x), lambda x: 0.1 * k * np.cos(k * x), lambda x: -0.1 * k**2 * np.sin(k * x), L
    )
    assert found["E"] == pytest.approx(expected, rel=1e-4)  # of the spline through 40 places
    assert found["E"] == pytest.approx(0.2622, abs=5e-5)


@pytest.mark.parametrize("digits", range(4, 18))
@pytest.mark.parametrize("unit", [1.0, 50.0, 0.05, 3.7])
def test_a_closed_profile_is_recognized_within_its_own_precision(digits, unit):
    """Written with 4 to 17 digits, in any unit, divided by the radius again, beginning anywhere."""
    for start in (0.0, -L / 2, 123.4):
        x, r = sampled(start=start, closed=True)
        written = [[float(f"{value * unit:.{digits}g}") for value in values] for values in (x, r)]
        step, precision = L / 60, 10.0 ** (1 - digits) * max(abs(x).max(), 1)
        if precision > 0.05 * step:  # so few digits do not tell the rows apart
            continue
        spline = one_period(np.array(written[0]) / unit, np.array(written[1]) / unit, L)
        assert distance(spline) < 1e-5 + 3 * precision
        x = np.linspace(start, start + L, 7000)
        assert np.abs(spline(x, 2)).max() < 3.0 + 30 * precision / step**2  # no kink where it closes


def test_the_period_may_have_fewer_digits_than_the_profile():
    x, r = sampled(closed=True)
    for length in (3.333, 3.3333, 3.33333333, 3.334):
        spline = one_period(x, r, length)
        assert np.abs(spline(np.linspace(0, length, 5000), 2)).max() < 1.0


@pytest.mark.parametrize("closed", [False, True])
def test_rows_may_fall_begin_anywhere_and_be_given_twice(closed):
    random = np.random.default_rng(1)
    x, r = sampled(start=-1.7, closed=closed)
    twice = np.sort(np.append(np.arange(len(x)), random.integers(len(x), size=9)))
    for rows in (np.arange(len(x))[::-1], twice):
        assert distance(one_period(x[rows], r[rows], L)) < 1e-5
    x, r = sampled()
    for cut in (1, 17, 59):
        assert distance(one_period(np.roll(x, cut), np.roll(r, cut), L)) < 1e-5
        assert distance(one_period(np.roll(x, cut)[::-1], np.roll(r, cut)[::-1], L)) < 1e-5


def test_unevenly_spaced_rows_are_read():
    random = np.random.default_rng(2)
    for _ in range(20):
        x = np.sort(random.uniform(0, L, 120))
        assert distance(one_period(x, radius_at(x), L)) < 1e-2
    x = L * (1 - np.cos(np.pi * np.arange(81) / 80)) / 2  # dense at both ends
    assert distance(one_period(np.round(x, 6), radius_at(x), L)) < 1e-4


def _with(values, row, value):
    changed = values.copy()
    changed[row] = value
    return changed


@pytest.mark.parametrize(
    ("change", "length", "said"),
    [
        (lambda x, r: (x[:3], r[:3]), L, "four or more"),
        (lambda x, r: (_with(x, 5, np.nan), r), L, "row 6 is not finite"),
        (lambda x, r: (x, _with(r, 7, np.inf)), L, "row 8 is not finite"),
        (lambda x, r: (x, _with(r, 3, 0.0)), L, "row 4 is not positive"),
        (lambda x, r: (x, _with(r, 9, -1.0)), L, "row 10 is not positive"),
        (lambda x, r: (_with(x, 4, x[20]), r), L, "must grow from row to row"),
        (lambda x, r: (np.random.default_rng(3).permutation(x), r), L, "must grow from row to row"),
        (lambda x, r: (_with(x, 4, x[3]), _with(r, 4, 1.5)), L, "but different r"),
        (lambda x, r: (np.append(x, L), np.append(r, 1.3)), L, "r differs there"),
        (lambda x, r: (x, r), L / 2, r"more than the period 1.66667 \(about 2 periods\)"),
        (lambda x, r: (np.append(x, L + x), np.append(r, r)), L, "about 2 periods"),
        (lambda x, r: (x[:30], r[:30]), L, "of the period 3.33333 only"),
        (lambda x, r: (x[:58], r[:58]), L, "of the period 3.33333 only"),
        (lambda x, r: (x, r), 1.02 * L, "of the period 3.4 only"),
        (lambda x, r: (x, r), 0.97 * L, "more than the period"),
        (lambda x, r: (50 * x, 50 * r), 50 * L, "radius: the tube's radius is about 5.*; give radius=5"),
        (lambda x, r: (50 * x, 50 * r), L, "radius: the tube's radius is about 5.*; give radius=5"),
        (lambda x, r: (x / 20, r / 20), L / 20, "radius: the tube's radius is about 0.05.*; give radius=0.05"),
    ],
)
def test_what_cannot_be_one_period_of_such_a_tube_is_named(change, length, said):
    x, r = change(*sampled())
    with pytest.raises(InputError, match=said):
        one_period(x, r, length)


def test_deep_pearls_are_no_tubes_of_another_radius():
    x = np.linspace(-5, 5, 200, endpoint=False)
    one_period(x, 1.05 + np.cos(0.2 * np.pi * x), 10.0)
    one_period(x, 0.4 + 2.2 * np.exp(-(x**2)), 10.0)
