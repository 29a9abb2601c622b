"""Special points of branches: folds, branch points and surfaces of constant mean curvature, against second computations."""

import math

import numpy as np
import pytest
from support.curves import Curve

from pearlbvp.continuation.following import BranchOptions, continue_branch
from pearlbvp.continuation.path import PathOptions
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.shapes.pearling import pearling_onset
from pearlbvp.stability.spectrum import Block
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.onward import switched, varied


def test_c0_075_has_two_folds_in_v_where_the_paper_says():
    branch = family_branch(Tube(0.75, 10), "pearl", (1, 0), branch_options({"lambda2": -4.0}))
    folds = [branch.at(special).observables["v"] for special in branch.find("fold:v")]
    assert folds == [pytest.approx(1.045, abs=1e-3), pytest.approx(0.98, abs=2e-3)]
    # At a turning point of v an unstable perturbation at fixed v is gained or lost: no branch points there.
    for special in branch.find("fold:v"):
        before, after = branch.points[special.index - 1], branch.points[special.index + 1]
        own = Block(0, 0, 1, "even")
        change = (after.spectrum.rates[own] > 0).sum() - (before.spectrum.rates[own] > 0).sum()
        assert abs(change) == 1
    assert all(special.block != Block(0, 0, 1, "even") for special in branch.find("bp"))


class Spectral(Curve):
    """A curve with two made-up blocks of growth rates, whose zeros are known."""

    trivial_block = "own"
    conserved = "y"

    def poles(self, u):
        return {}

    def spectrum(self, u):
        blocks = {
            Block(0, 0, 1, None): np.array([u[1] - 0.3, u[1] - 0.31, -1.0]),
            Block(1, 0, 1, None): np.array([0.305 - u[1], -2.0]),
        }
        return Spectrum.of(blocks, 0.0)

    def block_rates(self, u, block, like):
        return self.spectrum(u).rates[block]


def test_several_special_points_in_one_step_are_all_found():
    circle = Spectral(lambda x, y: x**2 + y**2 - 1, lambda x, y: np.array([2 * x, 2 * y]))
    start = Solution.along(
        circle, np.array([math.cos(0.28), math.sin(0.28)]), np.array([-math.sin(0.28), math.cos(0.28)])
    )
    options = BranchOptions(PathOptions(step=0.2), {"x": -0.5}, folds=("x", "y"))
    branch = continue_branch(start, options)
    bps = branch.find("bp")
    heights = [branch.at(special).observables["y"] for special in bps]
    assert heights[:3] == [pytest.approx(y, abs=1e-12) for y in (0.3, 0.305, 0.31)]
    assert [special.change for special in bps[:3]] == [1, -2, 1]
    assert branch.find("fold")[0].kind == "fold:y"
    assert branch.at(branch.find("fold")[0]).observables["y"] == pytest.approx(1, abs=1e-9)
    assert branch.points[-1].observables["x"] == pytest.approx(-0.5, abs=1e-12)


def test_through_a_surface_of_constant_mean_curvature():
    """c0 = 0.75, m = 2: multipliers pass through infinity near v = 0.9719, while shape, v and E stay smooth."""
    branch = family_branch(Tube(0.75, 10), "pearl", (2, 0), branch_options(max_points=70))
    (special,) = branch.find("cmc")
    entry = branch.at(special)
    assert entry.observables["v"] == pytest.approx(0.9719, abs=1e-4)
    assert abs(entry.observables["lambda1"]) > 1e9
    # An unduloid: the mean curvature is the same everywhere, and r cos psi - H r^2 is a first integral.
    profile = entry.problem.profile(entry.u)
    r, psi, h, _ = profile.states.values.T
    assert np.ptp(h) < 1e-10
    assert np.ptp(r * np.cos(psi) - h[0] * r**2) < 1e-10
    after = branch.points[special.index + 1].observables
    assert after["lambda1"] < 0 < branch.points[special.index - 1].observables["lambda1"]
    assert after["E"] == pytest.approx(entry.observables["E"], abs=1e-3)
    # Under large compression short waves grow, and more of them the larger it is; all are counted.
    compressed = [entry for entry in branch.points[special.index + 1 :] if entry.observables["lambda1"] < 0]
    around = [max(b.n for b, rates in entry.spectrum.rates.items() if rates[0] > 0) for entry in compressed]
    assert around[0] > 12
    assert all(entry.spectrum.complete for entry in compressed)


def test_turning_points_of_c0_are_folds_and_no_branch_points():
    here = family_branch(Tube(0.75, 10), "pearl", (1, 0), branch_options({"lambda2": -1.0}))
    moved = varied(here, -1, "c0", branch_options(max_points=40), upwards=False)
    (fold,) = moved.find("fold:c0")
    assert moved.at(fold).observables["c0"] == pytest.approx(0.5843949, abs=1e-7)
    # It runs into a branch of more symmetric shapes and ends there.
    assert moved.kinds(len(moved.points) - 1) == ["bp", "end"]
    assert "pitchfork" in moved.reason
    with pytest.raises(InputError, match="^point: point 0 is the cylinder"):
        varied(here, 0, "c0", branch_options())


def test_at_given_pressure_stability_changes_where_lambda2_turns():
    options = branch_options({"v": 1.06})
    pressure = family_branch(Tube(-0.8, 25), "pearl", (3, 0), options, fix="area,pressure")
    volume = family_branch(Tube(-0.8, 25), "pearl", (3, 0), options)
    (fold,) = pressure.find("fold:lambda2")
    own = Block(0, 0, 3, "even")
    before, after = (pressure.points[fold.index + i].spectrum.rates[own] for i in (-1, 1))
    assert abs(int((after > 0).sum()) - int((before > 0).sum())) == 1
    assert all(special.block != own for special in pressure.find("bp"))
    # One more constraint takes away at most one unstable direction.
    difference = pressure.table().n_unstable.iloc[-1] - volume.table().n_unstable.iloc[-1]
    assert difference in (0, 1)


def test_folds_that_belong_together_are_one_point():
    """``dE = -lambda2/2 dv``: energy and volume turn together, whatever the steps."""
    for max_step in (0.05, 0.5):
        branch = family_branch(Tube(0.75, 10), "pearl", (1, 0), branch_options({"lambda2": -4.0}, max_step=max_step))
        for special in branch.find("fold:v"):
            assert {"fold:v", "fold:E"} <= set(branch.kinds(special.index))
        last = branch.at(branch.find("fold:v")[-1]).observables
        assert last["lambda2"] == pytest.approx(-3.7122828, abs=5e-7)


def test_special_points_beside_a_nearly_neutral_mode_are_located():
    """On L = 60 the branch at j = 3 of eight pearls turns twice, sharply: three discretizations agree on where."""
    found = []
    for degree, tolerance in ((5, 1e-8), (6, 1e-9)):
        problem, u, tangent = pearling_onset(Tube(0.48, 60), 8, degree=degree, tolerance=tolerance)
        pearls = continue_branch(Solution.along(problem, u, tangent), branch_options({"v": 1.008}), at_bifurcation=True)
        beyond = switched(pearls, 3, branch_options(max_points=40))
        assert all(special.converged for special in beyond.special)
        found.append([beyond.at(special).observables["v"] for special in beyond.find("fold:v")])
    assert found[0] == pytest.approx([1.119707819, 1.115454677], abs=2e-8)
    assert found[1] == pytest.approx(found[0], abs=2e-8)
