"""The branches about unduloids, of which closed forms tell: where they cross, end, and pass through infinite multipliers."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import solve_bvp
from scipy.optimize import brentq
from support.unduloids import neutral_tensions

import pearlbvp as pb
from pearlbvp.figures.branch import draw_branch
from pearlbvp.shapes.unduloid import unduloid_pearl
from pearlbvp.stability.floquet import neutral_cosines
from pearlbvp.stability.spectrum import Block
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.onward import HALVED, followed, resumed
from pearlbvp.studies.shape import shape_branch
from pearlbvp.theory.unduloid import unduloid_of

DATA = Path(__file__).parents[2] / "data"
GRAPH = pd.read_csv(DATA / "graph_c0_075.csv", comment="#")
IN_C0 = pd.read_csv(DATA / "graph_in_c0.csv", comment="#")


def node(branch, to):
    """The row of the stretch of a branch that ends at a node."""
    return GRAPH[(GRAPH.branch == branch) & (GRAPH.to == to)].iloc[0]


def test_where_c0_is_its_mean_curvature_pearls_cross_the_unduloid_at_a_tension_that_its_jacobi_operator_knows():
    """A spectral method for a linear operator on a known surface, against the branch of a nonlinear problem."""
    unduloid = unduloid_of(5)
    branch = family_branch(pb.Tube(unduloid.mean, 5), "pearl", (1, 0), branch_options(max_points=13))
    place = branch.at(branch.find("fold:v")[0]).observables
    assert place["E"] == pytest.approx(0, abs=1e-15)
    assert place["v"] == pytest.approx(unduloid.v, abs=1e-12)
    assert place["lambda1"] == pytest.approx(neutral_tensions(unduloid, "equal")[0], abs=1e-5)
    assert place["lambda2"] == pytest.approx(-2 * unduloid.mean * place["lambda1"], abs=1e-9)


@pytest.mark.parametrize(("beside", "reaches"), [(-3e-4, False), (3e-4, True)])
def test_above_that_c0_alone_they_reach_infinite_multipliers(beside, reaches):
    c0 = unduloid_of(5).mean + beside
    branch = family_branch(pb.Tube(c0, 5), "pearl", (1, 0), branch_options({"cmc": 1}, max_points=30, max_step=1.0))
    assert branch.complete == reaches
    assert reaches or "c0 is above its mean curvature, 0.580587" in branch.reason


def test_pearls_of_long_periods_say_that_there_is_no_unduloid():
    branch = family_branch(pb.Tube(0.0, 7), "pearl", options=branch_options({"cmc": 1}, max_points=4))
    assert "no unduloid has this area and a period of 2 pi radii or more" in branch.reason


def test_the_wanted_unduloid_is_reached_though_beyond_it_more_waves_grow_than_are_counted():
    branch = family_branch(pb.Tube(0.672, 4), "pearl", (1, 0), branch_options({"cmc": 1}, max_step=1.0))
    assert branch.complete
    assert branch.points[-1].value("v") == pytest.approx(unduloid_of(4).v, abs=1e-10)
    row = branch.table().iloc[-1]
    assert pd.isna(row.n_unstable)
    assert not branch.points[-1].spectrum.stable
    axes = draw_branch(branch).axes[1]
    drawn = np.concatenate([line.get_ydata() for line in axes.lines])
    assert np.nanmax(np.abs(drawn)) < 1e5 < abs(row.lambda2)  # what is infinite is left out


def test_two_unequal_small_pearls_pass_through_three_equal_ones():
    """At c0 = 0.75 a branch crosses the pearls of period 10/3 where the volume and the energy turn, too: no end of a branch."""
    waves = [0.158, 0.124, 0.465, -0.07, -0.069, -0.124, 0.042, 0.038, 0.039]
    branch = shape_branch(0.75, 10, 0.861, waves, branch_options({"bp": 1, "v": 0.862}, max_step=2.0))
    assert branch.complete, branch.reason
    (crossing,) = branch.find("bp")
    assert str(crossing.block) == "n=0 j=0/1 odd"
    assert branch.at(crossing).value("v") == pytest.approx(node("R", "R x T").v_to, abs=1e-8)
    profile = branch.at(crossing).problem.profile(branch.at(crossing).u)
    radii = profile.radii_at(np.arange(3) * 10 / 3)
    assert np.ptp(radii) < 1e-6


def test_a_curve_of_folds_ends_where_the_period_halves():
    """The second fold of one pearl at c0 = 0.592 is followed to the unduloid of half the period, of energy zero."""
    here = family_branch(pb.Tube(0.592, 10), "pearl", (1, 0), branch_options({"fold:v": 2}))
    curve = followed(here, "fold:v", 2, "c0", branch_options(max_points=40, step=0.02, max_step=0.2), upwards=False)
    assert curve.reason == HALVED
    last = curve.points[-1].observables
    assert last["c0"] == pytest.approx(unduloid_of(5).mean, abs=1e-3)
    assert last["v"] == pytest.approx(unduloid_of(5).v, abs=1e-4)


@pytest.mark.parametrize(("wave", "kind"), [(0, "equal"), (1, "belly"), (1, "neck")])
def test_waves_on_an_unduloid_of_energy_zero_are_neutral_where_its_jacobi_operator_says(wave, kind):
    """The package's growth rates at finite multipliers, against eigenvalues of a product of second-order operators."""
    unduloid = unduloid_of(5)
    problem, u = unduloid_pearl(unduloid.mean, unduloid, cells=2, intervals=40)
    place = len(u) + problem.place("compliance")
    block = Block(0, wave, 2, {"belly": "even", "neck": "odd", "equal": "even"}[kind])
    for tension in neutral_tensions(unduloid, kind)[:2]:
        at, above = u.copy(), u.copy()
        at[place], above[place] = 1 / tension, 1 / (tension + 0.01)
        spectrum = problem.spectrum(at)
        small, away = (float(np.abs(problem.block_rates(x, block, spectrum)).min()) for x in (at, above))
        assert small < 1e-5 * away or small < 1e-7


def test_the_table_of_c0_has_the_closed_forms():
    for length, row in ((10 / 3, IN_C0.iloc[0]), (5, IN_C0[IN_C0.branches == "C, Q"].iloc[0])):
        unduloid = unduloid_of(length)
        assert (row.c0, row.v) == pytest.approx((unduloid.mean, unduloid.v), abs=1e-8)
        assert row.lambda1 == pytest.approx(neutral_tensions(unduloid, "equal")[0], abs=1e-6)


@pytest.mark.parametrize("piece", [0, 1])
def test_beyond_infinite_multipliers_the_pieces_end_where_another_solver_has_them(piece):
    """``scipy.integrate.solve_bvp`` from the unduloid in closed form, at the tensions of the table, of which E = 0.031."""
    rows = GRAPH[GRAPH.branch.str.startswith("C beyond")].reset_index()
    for end in ("from", "to"):
        v, energy = by_scipy(0.75, 2.5, rows[f"lambda1_{end}"][piece])
        assert v == pytest.approx(rows[f"v_{end}"][piece], abs=2e-7)
        assert energy == pytest.approx(0.031, abs=1e-6)


def by_scipy(c0, half, tension):
    """Reduced volume and energy by area of pearls of a half period, from the unduloid on."""
    unduloid = unduloid_of(2 * half)
    t = np.linspace(0, 1, 200)
    phase = math.pi / 2 + math.pi * t
    size = np.sqrt(1 + unduloid.shape**2 + 2 * unduloid.shape * np.sin(phase))
    guess = np.zeros((8, t.size))
    guess[0], guess[2] = size / (2 * unduloid.mean), unduloid.mean
    guess[1] = np.arctan2(unduloid.shape * np.cos(phase), 1 + unduloid.shape * np.sin(phase))
    guess[4] = guess[5] = half * t

    def rhs(_, y, p):
        r, psi, h, w = y[:4]
        around, b = np.cos(psi) / r, np.sin(psi) / r
        gauss = (2 * h - around) * around
        bend = -b * w - 2 * h * (h - around) ** 2 - 2 * c0 * gauss + 2 * (c0**2 + tension) * h + p[1]
        sums = np.cos(psi), r, r**2 * np.cos(psi), r * (h - c0) ** 2
        return p[0] * np.array([np.sin(psi), around - 2 * h, w, bend, *sums])

    def ends(a, b):
        return np.array([a[1], a[3], b[1], b[3], a[4], a[5], a[6], a[7], b[4] - half, b[5] - half])

    parameters = [math.pi / (2 * unduloid.mean), -2 * unduloid.mean * tension]
    found = solve_bvp(rhs, lambda a, b, p: ends(a, b), t, guess, parameters, tol=1e-8, max_nodes=20000)
    assert found.success
    return found.y[6, -1] / half, found.y[7, -1] / half


@pytest.mark.parametrize(("branch", "spheres"), [("P", 1), ("A", 2), ("Q", 2)])
def test_at_large_tension_pearls_are_spheres_on_tethers(branch, spheres):
    """Tethers of radius ``1/(2 sqrt(lambda1))`` between spheres, of the cylinder's area: no equation of shapes is needed."""
    row = node(branch, f"{branch} tethers")
    tether = 1 / (2 * math.sqrt(row.lambda1_to))
    free = lambda radius: 10 - 2 * spheres * radius  # noqa: E731
    radius = brentq(lambda x: 2 * spheres * x**2 + tether * free(x) - 10, 1, 3)
    volume = (4 / 3 * spheres * radius**3 + tether**2 * free(radius)) / 10
    assert row.v_to == pytest.approx(volume, abs=tether**2)


def test_both_bending_branch_points_of_one_pearl_are_there():
    """Two volumes that lie close to each other: at each Floquet's multipliers have another pair at 1, on two meshes."""
    for tolerance in (None, 1e-11):
        branch = family_branch(pb.Tube(0.75, 10), "pearl", (1, 0), branch_options({"bp": 2}), tolerance=tolerance)
        for number, special in enumerate(branch.find("bp"), start=1):
            point = branch.at(special)
            assert neutral_cosines(point.problem.profile(point.u), 1) == pytest.approx(2, abs=1e-10)
            assert point.value("v") == pytest.approx(node("A", f"A bp {number}").v_to, abs=1e-8)


def test_a_branch_goes_on_to_a_tension_from_where_multipliers_are_large():
    branch = family_branch(pb.Tube(0.75, 5), "pearl", (1, 0), branch_options({"lambda1": 14}, max_step=1.0))
    assert branch.points[-1].problem.in_large_chart
    assert resumed(branch, branch_options({"lambda1": 15})).points[-1].value("lambda1") == pytest.approx(15)
