"""Folds and branch points followed in two parameters: against the branches of the tubes that they lead to."""

import pytest

from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.localized import localized_pearls
from pearlbvp.studies.onward import STRAIGHT_WAVE, followed


def test_a_fold_followed_in_c0_is_the_fold_of_the_other_branch():
    """The first fold in v at c0 = 0.75, followed to c0 = 0.65, is the first fold of the branch at c0 = 0.65."""
    here = family_branch(Tube(0.75, 10), "pearl", (1, 0), branch_options({"v": 0.99}))
    curve = followed(here, "fold:v", 1, "c0", branch_options({"c0": 0.65}, step=0.02, max_step=0.2), upwards=False)
    assert curve.complete
    there = family_branch(Tube(0.65, 10), "pearl", (1, 0), branch_options({"v": 0.99}))
    expected = there.at(there.find("fold:v")[0]).observables
    found = curve.points[-1].observables
    for name in ("lambda1", "lambda2", "v", "E", "r_min"):
        assert found[name] == pytest.approx(expected[name], abs=1e-7)


def test_a_branch_point_followed_in_length_stays_one():
    """Where two pearls of period 7.5 give way (L = 15), followed to L = 14: the localized table of period 7."""
    here = family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.01}))
    curve = followed(here, "bp", 1, "L", branch_options({"L": 14.0}, step=0.05, max_step=0.3), upwards=False)
    assert curve.complete
    expected = localized_pearls(0.48, 7.0, 14).iloc[0]
    found = curve.points[-1].observables
    for name in ("lambda2", "v", "E"):
        assert found[name] == pytest.approx(expected[name], abs=1e-8)


def test_stability_along_a_followed_fold_is_that_of_the_branch():
    """Where the energy turns without the volume (lambda2 = 0) no growth rate is zero, so none is left out."""
    here = family_branch(Tube(0.75, 10), "pearl", (1, 0), branch_options({"v": 1.02}))
    special = here.find("fold:E")[0]
    assert here.at(special).observables["lambda2"] == pytest.approx(0, abs=1e-9)
    away = branch_options({"c0": 0.9}, max_points=30, step=0.05, max_step=0.2)  # whose value lies the other way
    curve = followed(here, "fold:E", 1, "c0", away, upwards=False)
    assert "c0 moved away" in curve.reason
    assert curve.points[0].spectrum.n_unstable == here.at(special).spectrum.n_unstable == 6
    # The shapes become straight where pearls begin at lambda2 = 0, and the curve ends there.
    assert "straight tube" in curve.reason
    last = curve.points[-1].observables
    assert last["v"] == pytest.approx(1, abs=STRAIGHT_WAVE**2)
    assert last["amplitude"] == pytest.approx(STRAIGHT_WAVE / 2, rel=1e-6)
    # v is even in the amplitude: to fourth order, it extrapolates to that of the straight tube.
    squares, volumes = ([entry.observables[name] for entry in curve.points[-2:]] for name in ("amplitude", "v"))
    squares = [value**2 for value in squares]
    slope = (volumes[1] - volumes[0]) / (squares[1] - squares[0])
    assert volumes[1] - slope * squares[1] == pytest.approx(1, abs=squares[0] * squares[1])


def test_the_first_fold_leaves_its_branch_where_c0_turns():
    """c0 = 0.5906: the pearls' branch exchanges its parts with that of two unequal pearls, and c0 turns on the fold's curve."""
    here = family_branch(Tube(0.6, 10), "pearl", (1, 0), branch_options({"v": 0.99}))
    curve = followed(here, "fold:v", 1, "c0", branch_options(max_points=22, step=0.01, max_step=0.05), upwards=False)
    turn = curve.at(curve.find("fold:c0")[0]).observables
    assert turn["c0"] == pytest.approx(0.59064, abs=5e-5)
    # Just above, the branch still has its fold; just below it goes on to two unequal pearls of larger volume.
    above = family_branch(Tube(0.5907, 10), "pearl", (1, 0), branch_options({"v": 0.99}))
    below = family_branch(Tube(0.5905, 10), "pearl", (1, 0), branch_options({"v": 1.02}))
    assert len(above.find("fold:v")) == 1
    assert (above.table().n_unstable > 0).all()
    assert below.find("fold:v") == []
    assert below.points[-1].observables["r_max"] > 1.4
