"""The branches about unduloids, of which closed forms tell: where they cross, end, and pass through infinite multipliers."""

import numpy as np
import pytest

import pearlbvp as pb
from pearlbvp.shapes.unduloid import unduloid_of
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.onward import HALVED, followed
from pearlbvp.studies.shape import shape_branch
from tests.support.unduloids import neutral_tensions


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


def test_two_unequal_small_pearls_pass_through_three_equal_ones():
    """At c0 = 0.75 a branch crosses the pearls of period 10/3 where the volume and the energy turn, too: no end of a branch."""
    waves = [0.158, 0.124, 0.465, -0.07, -0.069, -0.124, 0.042, 0.038, 0.039]
    branch = shape_branch(0.75, 10, 0.861, waves, branch_options({"v": 0.8612}, max_step=2.0))
    assert branch.complete, branch.reason
    (crossing,) = branch.find("bp")
    assert str(crossing.block) == "n=0 j=0/1 odd"
    profile = branch.at(crossing).problem.profile(branch.at(crossing).u)
    radii = profile.radii_at(np.arange(3) * 10 / 3)
    assert np.ptp(radii) < 1e-6


def test_a_curve_of_folds_ends_where_the_period_halves():
    """The second fold of one pearl at c0 = 0.6 is followed to the unduloid of half the period, of energy zero."""
    here = family_branch(pb.Tube(0.6, 10), "pearl", (1, 0), branch_options({"fold:v": 2}))
    curve = followed(here, "fold:v", 2, "c0", branch_options(max_points=40, step=0.02, max_step=0.2), upwards=False)
    assert curve.reason == HALVED
    last = curve.points[-1].observables
    assert last["c0"] == pytest.approx(unduloid_of(5).mean, abs=1e-3)
    assert last["v"] == pytest.approx(unduloid_of(5).v, abs=1e-4)
