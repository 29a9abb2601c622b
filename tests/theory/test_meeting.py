"""Where wrinkles and coiling waves meet: the three amplitude equations against elasticae, reduced modes and a mesh."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.meeting import COLUMNS, meeting_table
from pearlbvp.studies.mesh import meshed
from pearlbvp.studies.onward import varied
from pearlbvp.studies.ring_onsets import neutral_rings
from pearlbvp.theory.amplitude import amplitude_equation
from pearlbvp.theory.codimension_two import meeting_c0
from pearlbvp.theory.meeting import WRINKLES, WrinklesAndCoils, meeting_curvature

L = 10.0
K = 2 * math.pi / L
AT = meeting_curvature(K**2)
TABLE = Path(__file__).parents[2] / "data" / "wrinkles_and_coils.csv"


def test_the_meeting_is_where_both_onsets_are_one():
    assert pytest.approx(meeting_c0((0, 2), (1, 1), L), abs=1e-14) == AT
    both = WrinklesAndCoils(Tube(AT, L))
    assert both.onset == pytest.approx(WRINKLES, abs=1e-14)
    assert both.force() == pytest.approx(1.5 * K**4, abs=1e-14)


def test_beside_the_meeting_the_wrinkles_are_slaves_again():
    """With ``C`` eliminated the coefficients are those of the coiling waves alone, and of the wrinkles alone."""
    both, alone = WrinklesAndCoils(Tube(0.1, L)), amplitude_equation(Tube(0.1, L), (1, 1))
    b1, b2, _, b = both.cubic
    assert b1 == pytest.approx(alone.b1, rel=1e-12)
    rate = both.a[1] * (both.onset - WRINKLES)  # of the wrinkles where the coiling waves are neutral
    assert b2 - both.force(both.onset) ** 2 / rate == pytest.approx(alone.b2, rel=1e-12)
    assert b == pytest.approx(amplitude_equation(Tube(0.1, L), (0, 2)).b1, rel=1e-12)


def test_wrinkles_exchange_stability_with_buckles_where_elasticae_do():
    """The exact ring's neutral volume: relative errors fall with the square of the amplitude."""
    errors, amplitudes = [], []
    for offset in (0.004, 0.002, 0.001, 0.0005):
        both = WrinklesAndCoils(Tube(AT + offset, L))
        C = both.wrinkles_exchange()
        exact = float(neutral_rings(both.tube.c0, 2, [K])["v"].iloc[0])
        errors.append(abs((1 - float(both.volume(0, 0, C))) / (1 - exact) - 1))
        amplitudes.append(C)
    orders = np.diff(np.log(errors)) / np.diff(np.log(amplitudes))
    assert errors[-1] < 1e-3
    assert (np.diff(orders) > 0).all()  # towards 2
    assert 1.85 < orders[-1] < 2.05


def predicted(both, v):
    """``C``, ``lambda2`` and ``A`` of the buckles of a volume, by bisection."""
    low, high = 1e-6, 0.02
    for _ in range(60):
        C = (low + high) / 2
        lambda2, square = both.buckles(C)
        A = math.sqrt(max(float(square), 0.0))
        low, high = (C, high) if both.volume(A, A, C) > v else (low, C)
    return C, float(lambda2), A


def test_at_the_meeting_buckles_are_stable_as_predicted():
    """Reduced modes at fixed volume, brought to the meeting from beside it; rates of their own waves, too."""
    both, errors, volumes = WrinklesAndCoils(Tube(AT, L)), [], (0.9995, 0.99988)
    for v in volumes:
        beside = family_branch(Tube(AT + 0.002, L), "buckle", (1, 1), branch_options({"v": v}))
        end = varied(beside, -1, "c0", branch_options({"c0": AT}), upwards=False).points[-1]
        C, lambda2, A = predicted(both, v)
        assert end.spectrum.n_unstable == 0
        errors.append(abs(lambda2 - end.observables["lambda2"]))
        own = both.growth_rates(lambda2, A, A, C)
        np.testing.assert_allclose(own[:2], 0, atol=1e-14)  # a shift and a turn
        assert own[2] < 0
        found = np.concatenate(list(end.spectrum.rates.values()))
        for rate in own[2:]:
            assert np.abs(found / rate - 1).min() < 8 * math.sqrt(1 - v)
    assert errors[1] < 1e-5
    assert math.log(errors[1] / errors[0]) / math.log((1 - volumes[1]) / (1 - volumes[0])) > 1.3  # 3/2 as v tends to 1


def test_growth_rates_are_those_of_the_equations_as_printed():
    """Their right-hand sides for complex amplitudes, differentiated by differences, where the volume stays."""
    both, (lambda2, amplitudes) = WrinklesAndCoils(Tube(AT + 0.01, L)), (1.47, np.array([0.03, 0.05, -0.04]))
    (a_m, a_2), (b1, b2, cross, b), force = both.a, both.cubic, both.force(lambda2)

    def rate(six):
        A, B, C = z = six[:3] + 1j * six[3:]
        squares = abs(z) ** 2
        found = np.array([
            a_m * (lambda2 - both.onset) * A + force * B * C + A * ([b1, b2, cross] @ squares),
            a_m * (lambda2 - both.onset) * B + force * A * C.conj() + B * ([b2, b1, cross] @ squares),
            a_2 * (lambda2 - WRINKLES) * C + force * A * B.conj() + C * ([cross, cross, b] @ squares),
        ])  # fmt: skip
        return np.append(found.real, found.imag)

    def slopes(function, at, h=1e-5):
        return np.array([(function(at + h * one) - function(at - h * one)) / (2 * h) for one in np.eye(len(at))])

    normal = np.append(slopes(lambda z: both.volume(*z), amplitudes), np.zeros(3))
    kept = np.eye(6) - np.outer(normal, normal) / (normal @ normal)
    jacobian = slopes(rate, np.append(amplitudes, np.zeros(3)))
    found = np.linalg.eigvalsh(kept @ (jacobian + jacobian.T) @ kept / 2)
    found = np.delete(found, abs(found).argmin())  # the direction that changes the volume
    np.testing.assert_allclose(both.growth_rates(lambda2, *amplitudes), found[::-1], atol=1e-9)


def test_far_closer_the_law_of_the_square_root_holds():
    """The leading term alone, of the equations themselves: energy's extremes on an ellipsoid."""
    both = WrinklesAndCoils(Tube(AT, L))
    for v in (1 - 1e-8, 1 - 1e-10):
        C, lambda2, A = predicted(both, v)
        assert (WRINKLES - lambda2) / (K**2 * math.sqrt((1 - v) / 8)) == pytest.approx(1, abs=30 * math.sqrt(1 - v))
        assert pytest.approx(1, abs=300 * math.sqrt(1 - v)) == K**2 * A**2 / (3 * C**2)


def test_the_table_of_wrinkles_is_that_of_elasticae():
    """Wrinkles are stable below the last volume at which a wave along them is neutral on the exact curve."""
    table = pd.read_csv(TABLE, comment="#")
    assert list(table.columns) == COLUMNS
    rings = table[table["family"] == "ring"]
    for c0, rows in rings.groupby("c0"):
        volumes = neutral_rings(float(c0), 2, [K, 2 * K])["v"]
        last = volumes[volumes > 0.95].min()  # there are others, below
        stable = rows["n_unstable"] == 0
        assert (stable == ~(rows["v"] > last)).all(), c0


def test_a_row_of_the_table_is_that_of_a_mesh_and_computed_again():
    table = pd.read_csv(TABLE, comment="#")
    row = table[(table["offset"] == 0.005) & (table["v"] == 0.98) & (table["family"] == "buckle")].iloc[0]
    assert row["n_unstable"] == 0
    end = family_branch(Tube(row["c0"], L), "buckle", (1, 1), branch_options({"v": 0.98})).points[-1]
    assert end.observables["E"] == pytest.approx(row["E"], abs=1e-10)
    problem, u = meshed(end, 1000)
    assert problem.observables(u)["E"] == pytest.approx(row["E"], abs=2e-5)
    again = meeting_table(L, 1, [0.005], [0.99])
    known = table[(table["offset"] == 0.005) & (table["v"] == 0.99)]
    np.testing.assert_allclose(again["E"], known["E"], atol=1e-10)
    assert list(again["n_unstable"]) == list(known["n_unstable"])
    assert list(again["family"][again["least"]]) == ["buckle"]
