"""Localized-pearl branch points: the corrected values, Bloch against Floquet, direct computation on two cells, statuses."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq
from support import pearls

from pearlbvp.collocation import Discretization, PiecewisePolynomial
from pearlbvp.continuation import PathOptions, Solution, follow
from pearlbvp.continuation.path import correct
from pearlbvp.continuation.segment import Segment
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.newton import NewtonOptions
from pearlbvp.shapes.cells import HALF_CELL
from pearlbvp.shapes.pearling import pearling_onset
from pearlbvp.stability.bloch import SecondVariation
from pearlbvp.stability.floquet import neutral_cosines
from pearlbvp.stability.spectrum import spectrum
from pearlbvp.studies.localized import PeriodicPearls, localized_pearls
from pearlbvp.studies.reference import beside, read_reference
from pearlbvp.theory.dispersion import critical_wave_number

PAPER = Path(__file__).parents[2] / "data" / "paper_localized.csv"


@pytest.fixture(scope="module")
def table():
    return localized_pearls(0.48, 7.5, [15, 30, 45, 60])


def test_the_paper_s_table_as_corrected(table):
    compared = beside(table, read_reference(PAPER))
    assert (compared.status == "found").all()
    np.testing.assert_allclose(compared.v, compared.v_corrected, atol=5.01e-6)
    # errata: the paper's own meshes are within 2e-4 of them
    np.testing.assert_allclose(compared.v, compared.v_paper, atol=2e-4)


@pytest.mark.parametrize(("length", "pearls_"), [(15, 2), (30, 4), (45, 6), (60, 8)])
def test_bloch_finds_the_same_lambda2_to_1e_8(table, length, pearls_):
    """The zero of the Bloch growth rate at ``theta = 2 pi / N``, by another operator, coordinate and discretization."""
    row = table[length == table.L].iloc[0]
    followed = pearls.path(0.48, 7.5, 1.03)

    def growth(lambda2):
        problem, u = pearls.at(followed, "lambda2", lambda2)
        return SecondVariation.of(problem.profile(u), 64).growth_rates(0, 2 * math.pi / pearls_)[0]

    found = brentq(growth, row.lambda2 - 1e-4, row.lambda2 + 1.3e-4, xtol=1e-12)
    assert found == pytest.approx(row.lambda2, abs=1e-8)
    # Below onset of the localized pearl the pearls are stable, beyond they are not.
    assert growth(row.lambda2 + 1e-3) < 0 < growth(row.lambda2 - 1e-3)


def test_just_before_the_branch_point_every_wave_that_fits_decays(table):
    for row in table.itertuples():
        problem, u = pearls.at(pearls.path(0.48, 7.5, 1.03), "lambda2", row.lambda2 + 2e-4)
        variation = SecondVariation.of(problem.profile(u), 64)
        for n in range(4):
            for j in range(row.pearls // 2 + 1):
                rates = variation.growth_rates(n, 2 * math.pi * j / row.pearls)
                neutral = 1 if j == 0 and n < 2 else 0  # translations
                assert rates[neutral] < 0
                assert abs(rates[0]) < 1e-8 if neutral else rates[0] < 0


def test_on_two_cells_the_discretized_problem_is_singular_there(table):
    """L = 15 without Bloch or Floquet: belly to belly, a half cell of a tube of two pearls, at fixed ``lambda2``."""
    followed = pearls.path(0.48, 7.5, 1.03)
    row = table[table.L == 15].iloc[0]

    def inverse_response(lambda2):
        problem, u = pearls.at(followed, "lambda2", lambda2)
        profile = problem.profile(u).mirrored()
        one = problem.discretization.all_parameters(u)
        parameters = np.array([2 * one[0], one[1], lambda2, one[3], 2 * one[4], one[5]])
        d = Discretization(
            HALF_CELL, profile.states.scheme, profile.states.mesh, parameters, ("arclength", "lambda1", "v")
        )
        load = np.zeros(d.size)
        load[: len(d.gauss_points) * 4 : 4] = np.sin(np.pi * d.gauss_points)
        wave = d.pack(
            np.column_stack([np.cos(np.pi * profile.states.points)] + 3 * [0 * profile.states.points]), np.zeros(6)
        )
        response = d.solve(d.pack(profile.states.values, parameters), load)
        return 1 / d.inner(wave, response)

    found = brentq(inverse_response, row.lambda2 - 3e-3, row.lambda2 + 2e-3, xtol=1e-12)
    assert found == pytest.approx(row.lambda2, abs=1e-8)


@pytest.mark.parametrize(("c0", "period", "count"), [(0.48, 7.5, 2), (0.48, 7.5, 8), (0.3, 18.0, 2), (0.38, 10.4, 5)])
def test_the_series_gives_what_a_root_of_the_cosine_gives(c0, period, count):
    """Newton and bisection on solutions of a finer mesh, the cosine from the equations of ``(w, w', D, D')``: to 1e-12."""
    found = localized_pearls(c0, period, [count * period]).iloc[0]
    problem, u, tangent = pearling_onset(Tube(c0, period), intervals=20)
    start = Solution(problem, u, tangent)
    path = follow(start, PathOptions(step=0.03), lambda p: "past" if p.observables["v"] > found.v else None)

    def miss(point):
        return neutral_cosines(point.problem.profile(point.u), 0)[1].real - 2 * math.cos(2 * math.pi / count)

    before, past = path.points[-2:]
    expected = Segment(before, past).root(miss, miss(before)).observables
    for name in ("lambda1", "lambda2", "v", "E", "amplitude"):
        assert found[name] == pytest.approx(expected[name], abs=1e-12)


def test_doubling_the_mesh_changes_nothing_to_1e_8():
    coarse = PeriodicPearls.trace(0.48, 7.5)
    fine = PeriodicPearls.trace(0.48, 7.5, intervals=32)
    others = PeriodicPearls.trace(0.48, 7.5, intervals=24, degree=4)
    for count in (2, 4, 6, 8):
        reference = coarse.row(count)
        for curve in (fine, others):
            row = curve.row(count)
            for name in ("lambda1", "lambda2", "v", "E", "amplitude"):
                assert row[name] == pytest.approx(reference[name], abs=1e-8)


def test_one_length_gets_the_answer_that_it_gets_among_many(table):
    alone = localized_pearls(0.48, 7.5, [45])
    together = table[table.L == 45]
    for name in ("lambda2", "v", "E"):
        assert alone[name].iloc[0] == pytest.approx(together[name].iloc[0], abs=1e-10)


def test_values_belong_together(table):
    """At the branch point the row's own numbers describe one pearl: solve for it at the row's ``lambda2``."""
    for row in table.itertuples():
        problem, u = pearls.at(pearls.path(0.48, 7.5, 1.03), "lambda2", row.lambda2)
        observed = problem.observables(u)
        for name in ("lambda1", "v", "E", "amplitude"):
            assert getattr(row, name) == pytest.approx(observed[name], abs=1e-9)


def test_long_tubes():
    # Period 600/81 is the first to appear on L = 600; period 7.5 is not: 81 waves grow first.
    first = localized_pearls(0.48, 600 / 81, [600]).iloc[0]
    assert (first.status, first.pearls) == ("found", 81)
    assert 1 < first.v < 1.001
    assert localized_pearls(0.48, 7.5, [600]).iloc[0].status == "unstable_at_onset"


@pytest.mark.parametrize(
    ("c0", "period", "length", "status"),
    [
        (0.0, 10.0, 20.0, "unstable_at_onset"),
        (0.6, 10.0, 30.0, "no_stable_cylinder"),
        (0.48, 7.5, 7.5, "none_in_range"),
    ],
)
def test_answers_that_are_no_failures(c0, period, length, status):
    row = localized_pearls(c0, period, [length]).iloc[0]
    assert row.status == status
    assert row.message
    assert math.isnan(row.v)


def test_unstable_at_onset_is_confirmed_by_bloch():
    # c0 = 0, period 10, L = 20: right after onset a wave of theta = pi grows.
    problem, u = pearls.at(pearls.path(0.0, 10.0, 1.3), "v", 1.001)
    assert SecondVariation.of(problem.profile(u), 64).growth_rates(0, math.pi)[0] > 1e-3


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ((0.48, 7.5, [31]), "lengths: 31 radii is no multiple"),
        ((0.48, 7.5, [-15]), "lengths: "),
        ((0.48, 7.5, [float("nan")]), "lengths: "),
        ((0.48, 7.5, []), "lengths: the list is empty"),
        ((0.48, 6.0, [12]), "period: .*2 pi"),
        ((0.48, 2 * math.pi, [12]), "period: .*2 pi"),
        ((float("inf"), 7.5, [15]), "c0: "),
        ((0.48, "seven", [15]), "period: .*not a number"),
    ],
)
def test_mistakes_name_the_argument_and_the_remedy(arguments, name):
    with pytest.raises(InputError, match=f"^{name}") as raised:
        localized_pearls(*arguments)
    assert "\n" not in str(raised.value)


def test_a_row_that_cannot_be_computed_is_a_row(monkeypatch):
    from pearlbvp.continuation.chebyshev import Unresolved
    from pearlbvp.studies import localized

    def fail(*arguments, **options):
        raise Unresolved("the reason")

    monkeypatch.setattr(localized.PeriodicPearls, "trace", fail)
    table = localized_pearls(0.48, 7.5, [7.5, 15])
    assert list(table.status) == ["none_in_range", "failed"]
    assert table.message.iloc[1] == "the reason"


@given(st.integers(2, 46))
def test_longer_tubes_lose_their_pearls_earlier(count):
    # The neutral angle grows along the branch: v falls with N up to N = 46, where period 7.5 still appears first.
    curve = _curve()
    assert curve.row(count + 1)["v"] < curve.row(count)["v"]


def _curve(cache=[]):  # noqa: B006
    if not cache:
        cache.append(PeriodicPearls.trace(0.48, 7.5))
    return cache[0]


def test_a_fold_in_v_before_the_branch_point_is_reported():
    curve = _curve()
    c = curve.functions.coefficients[0].copy()
    c[:, 2] = 0
    c[[0, 2], 2] = 1.0, 1e-3  # v = 1 + 1e-3 T_2: it turns halfway, before two pearls lose stability
    folded = replace(curve, functions=replace(curve.functions, coefficients=(c,)))
    assert folded.row(2)["status"] == "none_in_range"
    assert "fold in v" in folded.row(2)["message"]


CASES = [(0.3, 18.0, 4), (0.3, 18.0, 6), (0.4, 13.45, 2), (0.4, 13.4, 2), (0.3, 24.75, 2), (0.5001, 6.5, 2), (0.45, 8.1, 3),
         (0.48, 7.9, 2), (0.3323, 14.6, 5), (0.4397, 9.1, 7)]  # fmt: skip


@pytest.mark.parametrize(("c0", "period", "count"), CASES)
def test_pearls_are_stable_before_and_unstable_after(c0, period, count):
    """All waves of all n that fit the tube, by Bloch spectra, on either side of the branch point found."""
    curve = PeriodicPearls.trace(c0, period, count)
    row = curve.row(count)
    assert row["status"] == "found"
    first, points = curve.path.points[0], curve.path.points[1:]
    for factor, stable in ((0.7, True), (1.3, False)):
        v = 1 + factor * (row["v"] - 1)
        near = min(points, key=lambda p: abs(p.observables["v"] - v))
        # Towards the cylinder amplitudes fall like the square root of v - 1.
        base = near.problem.transfer(first.problem, first.u)
        guess = base + math.sqrt((v - 1) / (near.observables["v"] - 1)) * (near.u - base)
        direction = np.zeros_like(guess)
        direction[-1] = 1
        guess[-1] = v
        result, _ = correct(near.problem, guess, direction, guess, 0.0, NewtonOptions(max_iterations=20))
        assert result.converged
        assert near.problem.observables(result.u)["amplitude"] > 0.3 * row["amplitude"]
        assert (spectrum(near.problem.profile(result.u), count).n_unstable == 0) is stable


def test_waves_of_ten_thousand_periods():
    # The most critical period of a very long tube: stable at onset for every N, and N = 10^5 loses it last of all.
    period = 2 * math.pi / critical_wave_number(0.48)
    table = localized_pearls(0.48, period, [period * count for count in (10, 1000, 10**5)])
    assert (table.status == "found").all()
    assert table.v.is_monotonic_decreasing
    assert table.v.iloc[2] < 1 + 1e-9


def test_where_two_modes_begin_together_the_branch_point_is_the_onset():
    # c0 = 0.48: 4 and 5 pearls begin at the same lambda2 on this tube.
    row = localized_pearls(0.48, 8.6235978388238035, [34.494391355295214]).iloc[0]
    assert (row.status, row.v) == ("found", pytest.approx(1, abs=1e-9))


def test_so_few_periods_were_not_asked_for():
    with pytest.raises(InputError, match="^pearls: 2 .*fewest"):
        PeriodicPearls.trace(0.48, 7.5, 4).row(2)
    with pytest.raises(InputError, match="^pearls: 0"):
        PeriodicPearls.trace(0.48, 7.5, 0)


def test_lengths_in_every_form():
    one = localized_pearls(0.48, 7.5, 15)
    for lengths in ("15", [15], np.array([15]), (np.float32(15),)):
        assert localized_pearls(0.48, 7.5, lengths).equals(one)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a,b\n1,2\n", "needs columns to match"),
        ("L,v_x\n15,2\n", "lacks c0, period"),
        ("c0,period,length,v_x\n0.48,7.5,15,2\n", "lacks L"),
        ("c0,period,L\n0.48,7.5,15\n", "has none besides"),
        ("c0,period,L,v\n0.48,7.5,15,1\n", "column v is in the table already; rename it, to v_other"),
        ("L,v_x\n15\n", "2 columns but a row of 1"),
        ("L,v_x\n15,1,2\n", "2 columns but a row of 3"),
        ("L,v_x\nlong,2\n", "'long', which is no number"),
        ("L,v_x\n", "no table"),
        ("", "no table"),
        ("c0,period,L,v_x\n0.48,7.5,16,2\n", "no row of the file agrees"),
        ("c0,period,L,v_x\n0.3,7.5,15,2\n", "no row of the file agrees"),
        ("\ufeffc0,period,L,v_x\n0.3,7.5,15,2\n", "no row of the file agrees"),
        ("c0,period,L,v_x\n,7.5,15,2\n", "an empty entry in column c0"),
        ("c0,period,L,v_x\n0.48,7.5,15,2\n0.48,7.5,15,3\n", "two rows"),
    ],
)
def test_reference_tables_that_do_not_fit(tmp_path, table, text, message):
    bad = tmp_path / "bad.csv"
    bad.write_text(text)
    with pytest.raises(InputError, match=f"^compare: .*{message}"):
        beside(table, read_reference(bad))


def test_reference_tables_that_fit(tmp_path, table):
    good = tmp_path / "good.csv"
    good.write_text("# of somebody\nv_x, L ,period,c0\n3,45,7.5,0.3\n2,45.000001,7.5,0.48\n,15,7.5,.48\n", "utf-8-sig")
    assert beside(table, read_reference(good)).v_x.dropna().tolist() == [2]
    with pytest.raises(InputError, match="^compare: no row"):
        beside(table, read_reference(Path(__file__).parents[1] / "data" / "compare_bom_other_c0.csv"))
    with pytest.raises(InputError, match="^compare: there is no file"):
        read_reference(tmp_path / "none.csv")


def test_profiles_of_the_path_are_functions():
    point = _curve().path.points[-1]
    profile = point.problem.profile(point.u)
    assert isinstance(profile.states, PiecewisePolynomial)
    assert profile.period == 7.5
