"""The cylinder's stability against the paper's formulas, brute force, and its large-L limits."""

import math
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.dispersion import branch_points
from pearlbvp.theory.dispersion import (
    critical_lambda2,
    critical_wave_number,
    growth_rate,
    long_tube_interval,
    onset_lambda2,
    stable_interval,
)
from pearlbvp.units import Units

C0 = st.floats(-2, 1.5)


def paper_growth_rate(k, n, lambda2, c0):
    """Paper, eq. (eigs), r = 1."""
    q = k**2 + n**2
    return -(q**2) / 2 + (lambda2 + 1) * q - (lambda2 + 0.5) - (1 - 2 * c0) * k**2


@given(st.floats(0, 3), st.integers(0, 5), st.floats(-3, 3), C0)
def test_growth_rate_is_the_paper_s(k, n, lambda2, c0):
    assert growth_rate(k, n, lambda2, c0) == pytest.approx(paper_growth_rate(k, n, lambda2, c0), abs=1e-10)


@given(st.floats(0.05, 3), st.integers(0, 5), C0)
def test_growth_rate_vanishes_at_the_critical_lambda2(k, n, c0):
    critical = float(critical_lambda2(k, n, c0))
    if math.isfinite(critical) and abs(critical) < 1e6:
        assert growth_rate(k, n, critical, c0) == pytest.approx(0, abs=1e-9 * (1 + abs(critical)))


@given(C0, st.floats(3, 90))
def test_stable_interval_is_where_no_mode_grows(c0, length):
    tube = Tube(c0, length)
    interval = stable_interval(tube)
    m, n = np.arange(0, int(2 * length) + 10)[:, None], np.arange(0, 8)[None, :]
    modes = (m > 0) | (n > 1)

    def worst(lambda2):
        return growth_rate(2 * np.pi * m / length, n, lambda2, c0)[modes].max()

    if not interval.exists:
        for lambda2 in np.linspace(-4, 4, 41):
            assert worst(lambda2) > -1e-12
        return
    low = max(interval.lower, interval.upper - 5)
    eps = 1e-6 * (interval.upper - low)
    assert worst(interval.upper - eps) < 0
    assert worst(interval.upper + eps) > 0
    if interval.lower_mode is not None:
        eps = 1e-6 * (interval.upper - interval.lower)
        assert worst(interval.lower + eps) < 0
        assert worst(interval.lower - eps) > 0


@pytest.mark.parametrize("c0", [-1.0, -0.25, 0.0, 0.25, 0.3, 0.48, 0.499])
def test_long_tubes_tend_to_the_corollary(c0):
    lower, upper = long_tube_interval(c0)
    interval = stable_interval(Tube(c0, 2e4))
    assert interval.lower == pytest.approx(lower, abs=2e-4)
    assert interval.upper == pytest.approx(upper, abs=2e-6)


def test_the_corollary_s_own_formulas():
    # (a) kappa_- = 1 - sqrt(2 - 4 c0), lambda2_cb = 1 - 2 c0; (b) -1/2; (c) 3/2
    kappa = 1 - math.sqrt(2 - 4 * 0.48)
    assert critical_wave_number(0.48) == pytest.approx(math.sqrt(kappa))
    assert long_tube_interval(0.48) == pytest.approx(((kappa**2 - 4 * 0.48 * kappa + 1) / 2 / (kappa - 1), 0.04))
    assert long_tube_interval(0.0) == pytest.approx((-0.5, 1.0))
    assert long_tube_interval(-0.6) == pytest.approx((-0.5, 1.5))
    assert stable_interval(Tube(-0.6, 100)).upper_mode == (0, 2)
    lower, upper = long_tube_interval(0.51)
    assert lower > upper


def test_values_that_the_paper_quotes():
    # §5: c0 = 0.48, L = 15: -0.243 (m = 2), -0.421 (m = 1); errata: coiling at 0.12773; c0 = -1, L = 10: -2.2595.
    assert float(critical_lambda2(4 * np.pi / 15, 0, 0.48)) == pytest.approx(-0.2432, abs=5e-5)
    assert float(critical_lambda2(2 * np.pi / 15, 0, 0.48)) == pytest.approx(-0.4208, abs=5e-5)
    assert float(critical_lambda2(2 * np.pi / 15, 1, 0.48)) == pytest.approx(0.12773, abs=5e-6)
    assert float(critical_lambda2(2 * np.pi / 10, 0, -1.0)) == pytest.approx(-2.2595, abs=5e-5)
    assert float(critical_lambda2(2 * np.pi / 10, 1, -1.0)) == pytest.approx(3.197, abs=5e-4)
    assert float(critical_lambda2(0, 2, 7.0)) == 1.5


@pytest.mark.parametrize(("length", "exists"), [(30.0, False), (6.0, True)])
def test_above_one_half_only_short_tubes_are_stable(length, exists):
    assert stable_interval(Tube(0.6, length)).exists is exists


def test_table_names_the_ends_and_kernels():
    table = branch_points(0.48, 30)
    lower, upper = table[table.role == "lower"].iloc[0], table[table.role == "upper"].iloc[0]
    assert (lower.m, lower.n, lower.type, lower.kernel) == (4, 0, "pearling", 2)
    assert (upper.m, upper.n, upper.type, upper.kernel) == (1, 1, "coiling/buckling", 4)
    assert table.lambda2.is_monotonic_increasing
    np.testing.assert_allclose(table.lambda1, 0.25 - table.lambda2 - 0.48**2)
    assert set(table[(table.m == 0)].type) == {"wrinkling"}
    assert (branch_points(0.6, 30).role == "").all()


def test_modes_that_meet_share_their_kernel():
    # c0 = -1/4 - k^2/4: coiling (1,1) at k^2/2 + 1 - 2 c0 meets wrinkling (0,2) at 3/2 for k^2 = 1/2 + 2 (c0 + ...)
    length = 10.0
    k = 2 * np.pi / length
    table = branch_points((k**2 / 2 - 0.5) / 2, length)
    meeting = table[np.isclose(table.lambda2, 1.5)]
    assert list(meeting.kernel) == [6, 6]


@pytest.mark.parametrize("arguments", [{"max_m": -1}, {"max_n": -2}, {"max_m": 2.5}, {"max_n": "3"}, {"max_m": 10**7}])
def test_negative_wave_counts(arguments):
    with pytest.raises(InputError, match="^max_"):
        branch_points(0.0, 10.0, **arguments)


def test_a_tube_of_a_hundred_million_radii_costs_what_a_short_one_costs():
    interval = stable_interval(Tube(0.48, 1e8))
    assert interval.lower == pytest.approx(long_tube_interval(0.48)[0], abs=1e-12)


@pytest.mark.parametrize(("c0", "length", "name"), [(1e200, 10, "c0"), (0, 1e200, "length"), (0, 1e-300, "length")])
def test_numbers_beyond_reason(c0, length, name):
    with pytest.raises(InputError, match=f"^{name}: .*check its unit"):
        stable_interval(Tube(c0, length))


def numbers_in(message):
    """``name = number`` of a sentence, and the length that it ends with."""
    named = {name: float(value) for name, value in re.findall(r"(\w+) = ([\d.e+-]*\d)", message)}
    return named | {"like": float(message.rsplit("like ", 1)[1])}


@pytest.mark.parametrize(("c0", "m", "n"), [(0.0, 3, 1), (0.0, 1, 0), (-20.0, 5, 0), (0.48, 2, 7)])
@pytest.mark.parametrize("radius", [1.0, 50.0])
def test_waves_too_short_to_follow_are_refused_with_their_own_numbers_in_the_user_s_unit(c0, m, n, radius):
    length = 0.0023 * m
    with pytest.raises(InputError) as refusal:
        onset_lambda2(Tube(c0, length), m, n)
    said = Units(radius, given=True).said(str(refusal.value))
    found = numbers_in(said)
    assert f"waves ({m},{n})" in said
    assert "k = 1" not in said
    assert "pearls" not in said
    q = (2 * math.pi * m / length) ** 2 + n**2
    assert found["L"] == pytest.approx(length * radius, rel=1e-5)
    # The paper's growth rate is zero there: q^2/2 - q (lambda2 + 1) + lambda2 + 1/2 + (1 - 2 c0) k^2 = 0.
    exact = (q**2 / 2 - q + 0.5 + (1 - 2 * c0) * (q - n**2)) / (q - 1)
    assert found["lambda2"] == pytest.approx(exact / radius**3, rel=5e-3)
    assert f"{2 * math.pi * radius / math.sqrt(q):.3g} long" in said
    assert abs(onset_lambda2(Tube(c0, found["like"] / radius), m, n)) < 1e6


@pytest.mark.parametrize("radius", [1.0, 50.0])
@pytest.mark.parametrize(("m", "away"), [(1, 0.0), (4, 0.0), (2, 3e-8)])
def test_pearls_as_long_as_the_tube_is_around_are_refused_as_such(m, away, radius):
    tube = Tube(-1.0, 2 * math.pi * m * (1 + away))
    with pytest.raises(InputError) as refusal:
        onset_lambda2(tube, m, 0)
    said = Units(radius, given=True).said(str(refusal.value))
    found = numbers_in(said)
    assert f"mode ({m},0)" in said
    assert (found["L"], found["k"] * radius) == pytest.approx((tube.length * radius, 1 / (1 + away)), rel=1e-11)
    branch = family_branch(Tube(-1.0, found["like"] / radius), "pearl", (m, 0), branch_options(max_points=3))
    assert len(branch.points) == 3


def test_waves_around_that_are_too_many_are_refused_as_such():
    with pytest.raises(InputError, match=r"waves \(1,2000\) .* fewer waves around"):
        onset_lambda2(Tube(0.0, 10.0), 1, 2000)


def axial_force(lambda2, c0):
    """``dE/dL`` of the straight tube at fixed area and volume: ``f L = 2 lambda1 A + 3 lambda2 V + c0 (2 c0 A - 2 M)``."""
    area, volume, mean_curvature = 2 * np.pi, np.pi, np.pi  # by length, on the unit cylinder, H = 1/2
    lambda1 = 0.25 - lambda2 - c0**2
    return 2 * lambda1 * area + 3 * lambda2 * volume + c0 * (2 * c0 * area - 2 * mean_curvature)


@given(C0, st.floats(-3, 3))
def test_the_axial_force_of_the_straight_tube(c0, lambda2):
    assert axial_force(lambda2, c0) == pytest.approx(np.pi * (1 - lambda2 - 2 * c0), abs=1e-12)


@pytest.mark.parametrize("c0", [-1.0, 0.0, 0.3, 0.48])
def test_coils_and_buckles_begin_at_euler_s_load(c0):
    """A beam of bending stiffness pi kappa R under pi kappa R k^2, which is pi k^2/2 in 2 kappa/R."""
    table = branch_points(c0, 40)
    beams = table[(table.n == 1) & (table.m > 0)]
    assert len(beams) > 5
    np.testing.assert_allclose(axial_force(beams.lambda2, c0), -np.pi * beams.k**2 / 2, rtol=1e-10)


def test_textbook_tubes_without_spontaneous_curvature():
    # Tension 2 kappa lambda1/R^2, pressure inside minus outside -2 kappa lambda2/R^3, force (2 kappa/R) f.
    lambda2_long_pearls = branch_points(0.0, 1e4, 1, 0).query("m == 1 and n == 0").lambda2.item()
    assert 2 * (0.25 - lambda2_long_pearls) == pytest.approx(3 / 2, rel=1e-6)  # Bar-Ziv, Moses, PRL 73 (1994) 1392
    wrinkles = branch_points(0.0, 10).query("m == 0 and n == 2")
    assert -2 * wrinkles.lambda2.item() == -3  # Levy's ring: 3 B/R^3 from outside
    assert 2 * axial_force(0.0, 0.0) == pytest.approx(2 * np.pi)  # a tether: 2 pi kappa/R at kappa/(2 R^2)
    assert 2 * (0.25 - 0.0) == 0.5
