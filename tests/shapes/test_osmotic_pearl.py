"""Pearls in an osmotic bath: against another parametrization and solver, pearls of fixed area, graphs, and their own folds."""

import math

import numpy as np
import pytest
from support import graphs, shape_equations

from pearlbvp.collocation import Discretization
from pearlbvp.continuation import PathOptions, follow
from pearlbvp.continuation.segment import Segment
from pearlbvp.shapes.cells import HALF_CELL
from pearlbvp.shapes.osmotic import osmotic_onset
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.stability.bloch import SecondVariation
from pearlbvp.studies.osmotic import OsmoticTube, at_periods, pearls_of_period, pearls_of_periods
from pearlbvp.theory.osmotic import onset_sizes

AXON = 120 * math.sqrt(3) / 2 * 2 * math.pi / 16
"""Length of a simulated axon in its radii."""


def axon(tension, osmolarity, kappa):
    """One of ``data/axon_pearls.csv``: mN/m, mOsm and kT of 310 K in SI units, energy ``kappa (H - c0)^2``."""
    kappa, radius, gas = kappa * 1.380649e-23 * 310, 50e-9, 8.31446261815324 * 310 / 700
    lambda1 = 1e-3 * tension * radius**2 / kappa
    return OsmoticTube(
        math.sqrt(0.25 - lambda1), 900 * gas * radius**3 / kappa, osmolarity * gas * radius**3 / kappa, AXON
    )


# tension, osmolarity, rigidity, spacing in nm
TEN = [(0.001, 100, 20, 578), (0.001, 200, 30, 483), (0.001, 300, 40, 360), (0.001, 400, 50, 346), (0.001, 500, 70, 316),
       (0.001, 600, 80, 289), (0.01, 100, 90, 387), (0.01, 400, 50, 490), (0.01, 500, 70, 393), (0.01, 600, 90, 393)]  # fmt: skip


@pytest.mark.parametrize(("tension", "osmolarity", "kappa", "spacing"), TEN)
def test_agrees_with_hamilton_s_equations_solved_by_scipy(tension, osmolarity, kappa, spacing):
    tube, period = axon(tension, osmolarity, kappa), spacing / 50
    # pearls shorter than the straight tube is around leave it nowhere: they come from longer ones
    pearl = (
        next(iter(pearls_of_period(tube, period)), None) or at_periods(tube, pearls_of_period(tube, 8)[0], [period])[0]
    )
    x, r = pearl.problem.profile(pearl.u).outline()
    half = (len(x) + 1) // 2
    places = np.linspace(0, period / 2, 30)
    expected = shape_equations.pearl(
        tube.c0, tube.solute, tube.osmolarity, period, (places, np.interp(places, x[:half], r[:half]))
    )
    for name, value in expected.items():
        assert pearl.observables[name] == pytest.approx(value, rel=1e-9)


def test_is_similar_to_a_pearl_of_fixed_area():
    pearl = pearls_of_period(axon(0.01, 400, 100), 8.0)[0]
    d, o = pearl.problem.discretization, pearl.observables
    s = (
        1 / o["area"]
    )  # lengths times s: the area, by s^2, is then that of a straight tube of radius 1 on the length, by s
    values = d.values(pearl.u) * np.array([s, 1, 1 / s, 1 / s**2])
    p = d.all_parameters(pearl.u)[:6] * np.array([s, s**-2, s**-3, 1 / s, s, s**2])
    free = ("arclength", "lambda1", "lambda2", "v")
    fixed = PearlProblem(Discretization(HALF_CELL, d.scheme, d.mesh, p, free), None, 1e-9)
    u = fixed.discretization.pack(values, p)
    assert np.abs(fixed.residual(u)).max() < 1e-9
    assert fixed.observables(u)["E"] == pytest.approx(o["E"] / s**2, rel=1e-12)


def test_force_is_the_derivative_of_the_potential_by_length():
    # At fixed tension and pressure d(potential of one period)/d(period) is the force; here the pressure follows the law, whose
    # work by length is to be taken for the pressure times volume that it is at the equilibrium.
    tube, step = axon(0.01, 300, 80), 1e-3
    pearl = pearls_of_period(tube, 8.0)[0]
    before, here, after = at_periods(tube, pearls_of_period(tube, 8.5)[0], [8 - step, 8, 8 + step])
    assert here.observables["v"] == pytest.approx(pearl.observables["v"], rel=1e-9)
    slope = (after.observables["potential"] - before.observables["potential"]) / (2 * step)
    o = here.observables
    at_pressure = 2 * math.pi * o["area"] * (o["E"] + o["lambda1"]) + o["lambda2"] * math.pi * o["v"]
    # The whole tube's length is kept, so that more length for one pearl is less for the others: what is least by length
    # has the slope (force - potential at that pressure)/period.
    assert slope == pytest.approx((o["force"] - at_pressure) / 8, rel=1e-5)


def test_force_is_that_of_the_virial():
    # f L = 2 lambda1 A + 3 lambda2 V + 2 c0 (c0 A - M), docs/theory/model.md
    pearl = pearls_of_period(axon(0.001, 300, 40), 7.2)[0]
    d, o = pearl.problem.discretization, pearl.observables
    y, p = d.at_gauss_points(pearl.u), d.all_parameters(pearl.u)
    area, volume = 2 * math.pi * o["area"], math.pi * o["v"]
    curvature = 2 * math.pi * p[0] / p[4] * float(d.gauss_weights @ (y[:, 0] * y[:, 2]))
    c0 = o["c0"]
    assert o["force"] == pytest.approx(
        2 * o["lambda1"] * area + 3 * o["lambda2"] * volume + 2 * c0 * (c0 * area - curvature), rel=1e-9
    )


def test_stability_to_a_change_of_all_pearls_is_lost_at_a_fold_in_the_osmolarity():
    start = osmotic_onset(0.365, 10.0, float(onset_sizes(0.365, 10.0)[0]), 0.02)
    path = follow(start, PathOptions(step=0.1), lambda p: "far" if p.observables["r_min"] < 0.3 else None)
    slope = next(i for i, p in enumerate(path.points) if i and p.tangent[-1] * path.points[i - 1].tangent[-1] < 0)
    before, after = path.points[slope - 1 : slope + 1]
    fold = Segment(before, after).root(lambda p: p.tangent[-1], before.tangent[-1])

    def rate(pearl):
        return pearl.spectrum.rates[pearl.problem.trivial_block][0]

    assert rate(before) * rate(after) < 0
    assert abs(rate(fold)) < 1e-6


@pytest.mark.parametrize(("pearls_on_it", "n_unstable"), [(5, 0), (4, 2)])
def test_unstable_waves_are_those_of_a_graph_s_energy(pearls_on_it, n_unstable):
    tube = axon(0.01, 500, 70)
    period = AXON / pearls_on_it
    (pearl,) = pearls_of_periods(tube, [period])[period]
    assert pearl.spectrum.n_unstable == n_unstable
    assert all(block.n == 0 for block, rates in pearl.spectrum.rates.items() if rates[0] > pearl.spectrum.neutral)
    most = 9 * pearls_on_it
    waves = [(a, 0, f, np.cos) for a in range(most + 1) for f in (np.cos, np.sin) if a or f is np.cos]
    graph = graphs.Graphs.of(2 * math.pi / AXON, 1, tube.c0, waves, (4 * most, 1))
    x, r = pearl.problem.profile(pearl.u).outline()
    places = np.arange(4 * most) / (4 * most) * AXON
    u = np.linalg.lstsq(graph.fields[:, 0].T, np.interp(places % period, x, r) - 1, rcond=None)[0]
    even = np.array([f is np.cos and a % pearls_on_it == 0 for a, _, f, _ in waves])
    for _ in range(8):
        (_, e1, e2), (_, a1, a2), (volume, v1, v2) = graph.parts(u)
        v = 2 * volume
        lambda1, lambda2 = 0.25 - tube.c0**2, tube.osmolarity - tube.solute / v
        gradient = e1 + lambda1 * a1 + lambda2 * v1
        hessian = e2 + lambda1 * a2 + lambda2 * v2 + 2 * tube.solute / v**2 * np.outer(v1, v1)
        u[even] -= np.linalg.solve(hessian[np.ix_(even, even)], gradient[even])
    assert np.abs(gradient).max() < 1e-9
    assert v == pytest.approx(pearl.observables["v"], rel=1e-6)
    values = np.linalg.eigvalsh(hessian)
    assert (values < -1e-6).sum() == n_unstable
    assert (np.abs(values) < 1e-6).sum() == 1  # the shift along the axis


def test_rates_on_pearls_with_thin_necks_are_known():
    # A neck of r = 0.004 has entries of 1e13 in the matrices; to move it all across the axis costs nothing.
    (pearl,) = pearls_of_periods(axon(0.001, 100, 80), [AXON / 6])[AXON / 6]
    assert pearl.observables["r_min"] < 0.004
    usual, fine = (SecondVariation.of(pearl.problem.profile(pearl.u), points) for points in (82, 120))
    assert abs(usual.growth_rates(1, 0.0, "even")[0]) < 1e-6
    for theta in (math.pi / 3, 2 * math.pi / 3):
        expected = fine.growth_rates(1, theta)[:3]
        np.testing.assert_allclose(usual.growth_rates(1, theta)[:3], expected, rtol=1e-5, atol=1e-6)


def test_a_period_is_found_by_whatever_division_it_was_made():
    periods = [AXON / 6, AXON / 6 * (1 + 2e-16), AXON / 6 * (1 - 2e-16)]
    found = pearls_of_periods(axon(0.001, 100, 80), periods)
    assert len(set(periods)) == 3
    assert [len(found[period]) for period in periods] == [1, 1, 1]
