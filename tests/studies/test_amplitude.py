"""Amplitude equations: against computer algebra, and against computed branches as their amplitude tends to zero."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

sys.path.insert(0, str(Path(__file__).parents[1] / "derivations"))

import amplitude as derived
from support.graphs import Graphs, all_waves, graphs_of

from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.studies.amplitude import (
    COLUMNS,
    coefficients,
    compared,
    exchange_curve,
    instability_map,
    meeting_points,
    predicted_branch,
)
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.theory import amplitude, meeting, resonance
from pearlbvp.theory.amplitude import amplitude_equation
from pearlbvp.theory.codimension_two import exchange_lengths, meeting_c0
from pearlbvp.theory.dispersion import growth_rate
from pearlbvp.theory.resonance import Resonance, resonant_lengths

KAPPA, N, C0, LAMBDA2 = derived.kappa, derived.n, derived.c0, derived.lambda2

SHIPPED = {
    "a": amplitude.linear(KAPPA, N),
    "alpha2": amplitude.tension(KAPPA, N, LAMBDA2),
    "direct1": amplitude.direct1(KAPPA, N, C0, LAMBDA2),
    "direct2": amplitude.direct2(KAPPA, N, C0, LAMBDA2),
    "force22": amplitude.force22(KAPPA, N, LAMBDA2),
    "force20": amplitude.force20(KAPPA, N, C0, LAMBDA2),
    "force02": amplitude.force02(KAPPA, N, C0, LAMBDA2),
    "mean": -KAPPA - N**2,
}


@pytest.mark.parametrize("name", SHIPPED)
def test_the_polynomials_are_those_that_computer_algebra_derives(name):
    difference = sympy.nsimplify(SHIPPED[name], rational=True) - derived.reduced()[name]
    assert sympy.expand(difference) == 0


def test_slaved_waves_decay_at_the_cylinder_s_own_rates():
    point = {KAPPA: sympy.Rational(7, 10), N: 3, C0: sympy.Rational(1, 5), LAMBDA2: sympy.Rational(9, 4)}
    for name, p, q in (("rate22", 2, 6), ("rate20", 2, 0), ("rate02", 0, 6)):
        expected = float(growth_rate(p * math.sqrt(0.7), q, 2.25, 0.2))
        assert float(derived.reduced()[name].subs(point)) == pytest.approx(expected, abs=1e-12)


def test_the_resonant_polynomials_are_those_that_computer_algebra_derives():
    found = derived.resonant()
    shipped = {
        "force": amplitude.force22(KAPPA, 0, LAMBDA2),
        "aa": amplitude.direct1(KAPPA, 0, C0, LAMBDA2),
        "cc_direct": amplitude.direct1(4 * KAPPA, 0, C0, LAMBDA2),
        "force4": amplitude.force22(4 * KAPPA, 0, LAMBDA2),
        "cross": resonance.cross(KAPPA, C0, LAMBDA2),
        "cross_c": resonance.cross(KAPPA, C0, LAMBDA2),
        "force3": resonance.force3(KAPPA, LAMBDA2),
    }
    for name, value in shipped.items():
        assert sympy.expand(sympy.nsimplify(value, rational=True) - found[name]) == 0, name


def test_the_paper_s_coefficients():
    """Its §4.2 and Appendix A, with the misprints that are known put right."""
    wrinkles = amplitude_equation(Tube(0.3, 10), (0, 2))
    assert (wrinkles.a, wrinkles.b1, wrinkles.alpha2) == pytest.approx((3, -243 / 16, 27 / 2), abs=1e-13)
    pearls = amplitude_equation(Tube(0.0, 10), (1, 0))
    assert (pearls.a, pearls.b1) == pytest.approx((-0.605216, -2.955046), abs=1e-6)
    b1, b2 = derived.b1_and_b2()
    q, c, r = KAPPA, C0, sympy.Rational
    paper = (2 * q**2 + 4 * q * c - 6 * q - 4 * c - 1, 6 * q**2 - 4 * q * c - 4 * q - 4 * c + 3)
    paper_b1 = (
        r(5, 4) * q**3
        + 5 * q**2 * c
        + r(3, 4) * q**2
        + 9 * q * c
        - r(33, 4) * q
        - 6 * c
        - r(3, 2)
        + 3 * paper[0] * (-(q**2) / 2 + q * c - r(13, 4) * q - 2 * c - r(1, 2)) / (4 * q**2 + 7 * q + 4 * c + 1)
    )
    paper_b2 = 3 * q**3 + 4 * q**2 * c - 6 * q**2 - 16 * q * c - 3 * q - 12 * c - 3
    paper_b2 += 6 * (4 * q * c + 4 * c + 1) * (-(c + r(1, 4)) * q + q / 2 - r(1, 2) - 2 * c) / (q - 4 * c - 1)
    paper_b2 += 2 * paper[1] * q * (-3 * q / 2 - c + r(3, 4)) / (12 * q**2 - 7 * q - 4 * c + 3)
    assert sympy.simplify(b1.subs(N, 1) - paper_b1) == 0
    assert sympy.simplify(b2.subs(N, 1) - paper_b2) == 0


def limits(equation, family):
    """``b, alpha2`` and ``(v - 1)/A^2`` of computed branches as ``A`` tends to zero: extrapolated in ``A^2``."""
    graphs, place, factor = graphs_of(equation, family)
    A = (
        np.linspace(0.012, 0.05, 8)
        / (1 + equation.n**2 / 4)
        / math.sqrt(max(1, max(map(abs, equation.slaved.values())) / 2))
    )
    rows = [graphs.solve(place, factor * a, equation.lambda1, equation.lambda2)[1:] for a in A]
    lambda1, lambda2, v, _ = np.array(rows).T

    def limit(change):
        return np.polynomial.Polynomial.fit(A**2, change / A**2, 6)(0)

    b = -equation.a * limit(lambda2 - equation.lambda2)
    waves = 2 if family == "buckle" else 1
    return b, (limit(lambda1 - equation.lambda1) - b / equation.a) / waves, limit(v - 1)


@pytest.mark.parametrize(
    ("c0", "length", "mode", "family"),
    [
        (0.0, 10, (1, 0), "pearl"), (0.48, 15, (2, 0), "pearl"), (-1.0, 10, (1, 0), "pearl"),
        (0.0, 10, (0, 2), "ring"), (0.0, 10, (0, 3), "ring"), (0.0, 10, (0, 4), "ring"),
        (0.0, 10, (1, 1), "coil"), (0.48, 10, (1, 1), "coil"), (0.3, 14, (1, 2), "coil"),
        (0.0, 10, (1, 1), "buckle"), (0.48, 10, (1, 1), "buckle"), (-1.0, 10, (1, 1), "buckle"),
        (0.3, 14, (1, 2), "buckle"),
    ],
)  # fmt: skip
def test_computed_branches_have_the_coefficients_as_limits(c0, length, mode, family):
    equation = amplitude_equation(Tube(c0, length), mode)
    b, alpha2, volume = limits(equation, family)
    waves = 2 if family == "buckle" else 1
    close = 1e-6 if family == "buckle" else 1e-8
    assert b == pytest.approx(equation.cubic(family), rel=close)
    assert alpha2 == pytest.approx(equation.alpha2, rel=close)
    assert volume == pytest.approx(-2 * waves * equation.a, rel=close)


@pytest.mark.parametrize(("c0", "length"), [(0.0, 10), (0.48, 10), (-1.0, 10)])
def test_growth_rates_on_coils_and_buckles_are_those_of_the_reduced_equations(c0, length):
    """At fixed area and volume ``(b2 - b1) A^2`` twice on coils and ``2 (b1 - b2) A^2`` on buckles, as ``A`` tends to zero."""
    equation = amplitude_equation(Tube(c0, length), (1, 1))
    waves = all_waves(4)
    for family, count in (("coil", 2), ("buckle", 1)):
        graphs, place, factor = graphs_of(equation, family, 4)
        fine = Graphs.of(equation.k, 1, c0, waves, (20, 20))
        ratios = []
        for A in (0.02, 0.01):
            u, lambda1, lambda2, *_ = graphs.solve(place, factor * A, equation.lambda1, equation.lambda2)
            if family == "coil":
                basis = [(j, j, np.cos, None) for j in range(len(u))]
            else:
                basis = [(a, b, np.cos, np.cos) for a in range(5) for b in range(5) if (a + b) % 2 == 0]
            shape = Graphs.of(equation.k, 1, c0, basis, (20, 20))
            expected = equation.own_rate(family) * A**2
            rates = shape.rates(u, lambda1, lambda2, fine)
            ratios.append(rates[np.argsort(np.abs(rates - expected))][:count] / expected)
        # The error falls like A^2: extrapolated, the ratio is 1.
        assert (4 * ratios[1] - ratios[0]) / 3 == pytest.approx(1, abs=1e-3)
        assert ratios[1] == pytest.approx(1, abs=0.01)


def test_at_given_pressure_pearls_have_the_growth_rate_2bA2():
    tube = Tube(0.0, 10)
    equation = amplitude_equation(tube, (1, 0))
    branch = family_branch(
        Tube(0.0, 10), "pearl", (1, 0), branch_options(step=0.004, max_step=0.004, max_points=12), fix="area,pressure"
    )
    squares, ratios = [], []
    for entry in branch.points[4:]:
        square = equation.amplitude_at("pearl", entry.observables["v"]) ** 2
        own = entry.spectrum.rates[entry.problem.trivial_block]
        squares.append(square)
        ratios.append(own[np.abs(own - 2 * equation.b1 * square).argmin()] / square)
    limit = np.polynomial.Polynomial.fit(squares, ratios, 2)(0)
    assert limit == pytest.approx(2 * equation.b1, rel=1e-3)


def test_coefficients_as_a_table():
    table = coefficients(0.48, 10, [(1, 0), (0, 2), (1, 1)])
    assert list(table.columns) == COLUMNS
    assert table.b1.iloc[2] == pytest.approx(-0.0826585448, abs=1e-9)
    assert table.b2.iloc[2] == pytest.approx(0.5634491393, abs=1e-9)
    assert list(table.stable) == ["pearl", "", "buckle"]  # the paper's §5.3: buckling stable, coiling unstable at onset
    assert table.criticality.iloc[2] == "coil supercritical, buckle subcritical"
    assert table.b.isna().tolist() == [False, False, True]


@pytest.mark.parametrize(
    ("c0", "length", "mode", "word"),
    [
        (0, 10, (0, 0), "no bifurcation"),
        (0, 10, (0, 1), "no bifurcation"),
        (0, 2 * math.pi, (1, 0), "k = 1"),
        (0.4, resonant_lengths(0.4)[1], (1, 0), r"\(2,0\)"),
        (meeting_c0((0, 2), (1, 1), 10), 10, (1, 1), r"\(0,2\)"),
    ],
)
def test_what_is_no_amplitude_equation_is_refused(c0, length, mode, word):
    with pytest.raises(InputError, match=f"^mode: .*{word}"):
        amplitude_equation(Tube(c0, length), mode)


@settings(max_examples=60, deadline=None)
@given(st.floats(-1.5, 0.49), st.floats(3, 60), st.integers(0, 3), st.integers(0, 4))
def test_coefficients_do_not_depend_on_how_often_the_tube_is_repeated(c0, length, m, n):
    try:
        once, twice = amplitude_equation(Tube(c0, length), (m, n)), amplitude_equation(Tube(c0, 2 * length), (2 * m, n))
    except InputError:
        return
    assert twice.b1 == pytest.approx(once.b1, rel=1e-9)
    assert twice.alpha2 == pytest.approx(once.alpha2, rel=1e-9)


def test_a_predicted_branch_is_a_branch():
    """Its table agrees with a computed one to the order in the amplitude that it has; stability at onset agrees too."""
    predicted = predicted_branch(0.48, 15, (1, 0)).table()
    computed = family_branch(
        Tube(0.48, 15), "pearl", (1, 0), branch_options({"v": 1.0003}, step=0.01, max_step=0.01)
    ).table()
    assert list(predicted.columns) == list(computed.columns)
    assert set(predicted.n_unstable) == {2} == set(computed.n_unstable)
    assert predicted.mu_crit.iloc[0] == pytest.approx(computed.mu_crit.iloc[0], abs=1e-9)
    for name in ("amplitude", "r_min", "r_max"):
        at = np.interp(computed.v.iloc[1], predicted.v, predicted[name])
        assert at == pytest.approx(computed[name].iloc[1], abs=3e-4)


@pytest.mark.parametrize(
    ("family", "mode", "v"), [("pearl", (1, 0), 1.002), ("coil", (1, 1), 0.998), ("ring", (0, 2), 0.998)]
)
def test_predicted_force_and_curvature_change_as_computed_ones_do(family, mode, v):
    computed = family_branch(Tube(0.0, 10), family, mode, branch_options({"v": v})).table()
    predicted = predicted_branch(0.0, 10, mode, family, largest=0.05).table()
    for name in ("M", "force"):
        found, expected = (
            np.interp(abs(v - 1), abs(table.v - 1), table[name]) - table[name].iloc[0]
            for table in (predicted, computed)
        )
        assert found == pytest.approx(expected, rel=5e-2, abs=1e-12)


def test_predictions_and_computed_branches_differ_by_the_next_order():
    branch = family_branch(
        Tube(0.0, 10), "pearl", (1, 0), branch_options({"v": 1.01}, step=0.02, max_step=0.02)
    ).table()
    table = compared(branch, amplitude_equation(Tube(0.0, 10), (1, 0)), "pearl")
    assert table.lambda1_order.iloc[1:].to_numpy() == pytest.approx(2, abs=0.12)
    assert table.lambda2_order.iloc[1:].to_numpy() == pytest.approx(2, abs=0.12)
    assert table.E_order.iloc[1:].to_numpy() == pytest.approx(4, abs=0.12)
    with pytest.raises(InputError, match="^compare: "):
        compared(branch[["v"]], amplitude_equation(Tube(0.0, 10), (1, 0)), "pearl")
    with pytest.raises(InputError, match="^compare: .*c0"):
        compared(branch, amplitude_equation(Tube(0.3, 10), (1, 0)), "pearl")
    with pytest.raises(InputError, match="^compare: .*leaves the cylinder"):
        compared(branch, amplitude_equation(Tube(0.0, 10), (1, 1)), "coil")
    with pytest.raises(InputError, match="^compare: .*above 1"):
        compared(branch.assign(v=0.9), amplitude_equation(Tube(0.0, 10), (1, 0)), "pearl")


def test_coils_and_buckles_exchange_stability_where_the_map_says():
    for length in exchange_lengths(0.3):
        equation = amplitude_equation(Tube(0.3, length), (1, 1))
        assert equation.b1 == pytest.approx(equation.b2, rel=1e-9)
    curve = exchange_curve("0:0.4:0.2")
    longest = curve.groupby("c0").L.max()
    grid = instability_map([0.0, 0.2, 0.4], [longest.min() - 0.1, longest.max() + 0.1])
    assert set(grid[longest.min() - 0.1 == grid.L].stable) == {"buckle"}
    assert set(grid[longest.max() + 0.1 == grid.L].stable) == {"coil"}


def test_where_two_modes_meet_both_are_neutral():
    assert meeting_c0((0, 2), (1, 1), 10) == pytest.approx(-0.25 + (2 * math.pi / 10) ** 2 / 4, abs=1e-14)
    table = meeting_points("-1:0.48:0.02", "20,40")
    assert {"0:2"} == set(table[table.end == "upper"]["mode"])
    assert (table.end == "lower").sum() >= 4
    for row in table.itertuples():
        for mode in (row.mode, row.other):
            m, n = map(int, mode.split(":"))
            assert growth_rate(2 * math.pi * m / row.L, n, row.lambda2, row.c0) == pytest.approx(0, abs=1e-12)


def test_the_two_mode_equations_find_the_crossing_of_m_and_2m_pearls():
    """The computed branch point tends to the predicted one as the tube tends to the resonant length: error of first order."""
    resonant = resonant_lengths(0.4)[1]
    assert Resonance(Tube(0.4, resonant)).onset == pytest.approx(Resonance(Tube(0.4, resonant)).onset_double, abs=1e-13)
    errors = []
    for detuning in (0.2, 0.1):
        equations = Resonance(Tube(0.4, resonant + detuning))
        C = equations.crossing()
        predicted = equations.double(C)
        computed = family_branch(
            Tube(0.4, resonant + detuning), "pearl", (2, 0), branch_options({"v": 1.005}, step=0.01, max_step=0.05)
        )
        found = computed.at(computed.find("bp")[0]).observables
        errors.append((predicted["v"] - 1) / (found["v"] - 1) - 1)
        # The mixed branch of the same equations starts there, at A = 0.
        beside = equations.mixed(np.array([0.999, 1.001]) * C)
        assert beside["A"].size == 1
        assert beside["A"][0] < 0.15 * abs(C)
        assert beside["lambda2"][0] == pytest.approx(float(predicted["lambda2"]), abs=1e-4)
    assert abs(errors[0]) < 0.01
    assert errors[1] / errors[0] == pytest.approx(0.5, abs=0.05)
    for length, m in ((10, 0), (10, math.nan), (4 * math.pi, 1), (2 * math.pi, 1)):
        with pytest.raises(InputError, match="^m(ode)?: "):
            Resonance(Tube(0.4, length), m)


def test_the_polynomials_where_wrinkles_and_coiling_waves_meet_are_those_that_computer_algebra_derives():
    found = derived.meeting()
    shipped = {
        "force": amplitude.force02(KAPPA, 1, C0, LAMBDA2),
        "aa": amplitude.direct1(KAPPA, 1, C0, LAMBDA2),
        "ab": amplitude.direct2(KAPPA, 1, C0, LAMBDA2),
        "cross": meeting.cross(KAPPA, C0, LAMBDA2),
        "cross_c": meeting.cross(KAPPA, C0, LAMBDA2),
        "cc": amplitude.direct1(0, 2, C0, sympy.Rational(3, 2)),
        "force13": meeting.force13(KAPPA, C0, LAMBDA2),
    }
    for name, value in shipped.items():
        difference = sympy.expand(sympy.nsimplify(value, rational=True) - found[name])
        assert difference.subs(LAMBDA2, sympy.Rational(3, 2)) == 0 if name == "cc" else difference == 0, name
