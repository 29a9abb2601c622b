"""Branches that leave pearls and break their symmetry about the axis: the lift into reduced modes, and what follows there."""

import numpy as np
import pytest

from pearlbvp.continuation.problem import LiftError
from pearlbvp.helfrich import Tube
from pearlbvp.stability.spectrum import Block
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.mesh import meshed
from pearlbvp.studies.onward import switched, varied


@pytest.fixture(scope="module")
def pearls():
    return family_branch(Tube(0.9, 12), "pearl", (1, 0), branch_options({"bp": 5}))


@pytest.fixture(scope="module")
def bent(pearls):
    """Even and odd about the belly, far from the pearls."""
    return {number: switched(pearls, number, branch_options({"v": 1.04})) for number in (3, 4)}


def leading(spectrum):
    """The largest growth rates as often as they occur."""
    rates = [np.repeat(rates, block.multiplicity) for block, rates in spectrum.rates.items()]
    return np.sort(np.concatenate(rates))[:-13:-1]


def unequal(pearls):
    return switched(pearls, 5, branch_options({"v": 1.055})).points[-1]


def two_periods():
    branch = family_branch(Tube(2, 6), "pearl", (2, 0), branch_options({"bp": 1}))
    return branch.points[-1]


def at_another_curvature():
    branch = family_branch(Tube(0.9, 12), "pearl", (1, 0), branch_options({"v": 1.03}))
    return varied(branch, -1, "c0", branch_options({"c0": 0.95})).points[-1]


@pytest.mark.parametrize("which", ["bp", "unequal", "two periods", "other c0"])
def test_pearls_in_modes_are_those_of_collocation_with_their_growth_rates(pearls, which):
    """Cosines of x and the Hessian of their sum, beside collocation by arclength and Bloch waves: errors are rounding's."""
    point = {
        "bp": lambda: pearls.at(pearls.find("bp")[3]), "unequal": lambda: unequal(pearls), "two periods": two_periods,
        "other c0": at_another_curvature,
    }[which]()  # fmt: skip
    tube, u, tangent = point.problem.in_modes(point.u, point.tangent)
    found, step = tube.observables(u), 1e-5
    for name, value in point.observables.items():
        assert found[name] == pytest.approx(value, abs=1e-8), name
    ahead, behind = (tube.observables(u + s * tangent) for s in (step, -step))
    slopes = {name: (ahead[name] - behind[name]) / (2 * step) for name in ("lambda1", "lambda2", "v", "E", "c0")}
    ratio = slopes["lambda2"] / point.slopes["lambda2"]
    assert ratio > 0
    for name, slope in slopes.items():
        assert slope == pytest.approx(ratio * point.slopes[name], abs=1e-5), name
    spectrum = tube.spectrum(u)
    assert spectrum.n_unstable == point.spectrum.n_unstable
    np.testing.assert_allclose(leading(spectrum), leading(point.spectrum), atol=2e-8)


def test_at_a_branch_point_the_block_that_is_taken_is_the_neutral_one(pearls):
    for special in pearls.find("bp")[:4]:
        point = pearls.at(special)
        lifted, (u, _) = point.problem.lift(special.block, "pearl", point.u, point.tangent)
        rates = lifted.block_rates(u, lifted.trivial_block, None)
        assert np.abs(rates).min() < 1e-8
        assert lifted.symmetry.fold == special.block.n


def test_branches_that_bend_exchange_stability_with_the_pearls(pearls, bent):
    """A pitchfork's own growth rate is -2 times that of the branch it leaves at the same volume, to leading order.

    Of the two neutral waves around the tube, one is a turn about the axis on the new branch: it stays neutral.
    """
    for number, branch in bent.items():
        special = pearls.find("bp")[number - 1]
        left, first = pearls.at(special), branch.points[1]
        v = first.observables["v"]
        assert left.slopes["v"] > 0 > v - left.observables["v"]  # the new branch is beside the pearls before
        before = family_branch(Tube(0.9, 12), "pearl", (1, 0), branch_options({"v": v})).points[-1]
        old = before.spectrum.rates[special.block]
        own = first.spectrum.rates[first.problem.trivial_block]
        ratio = own[np.abs(own).argmin()] / old[np.abs(old).argmin()]
        assert ratio == pytest.approx(-2, abs=0.3)
        assert first.spectrum.n_unstable == left.spectrum.n_unstable


def test_minus_twice_the_slope_of_the_energy_is_the_pressure_where_pearls_bend(bent):
    for branch in bent.values():
        for point in branch.points[1:]:
            assert point.spectrum.residual < 1e-7  # rigid motions are neutral
            ratio = -2 * point.slopes["E"] / point.slopes["v"]
            assert ratio == pytest.approx(point.observables["lambda2"], abs=1e-7)


def test_bent_pearls_are_those_of_meshes(bent):
    """Triangles, refined: the difference falls with a mean edge's square at least."""
    for branch in bent.values():
        point, misses = branch.points[-1], []
        for nodes in (400, 1600):
            problem, u = meshed(point, nodes)
            found = problem.observables(u)
            misses.append([abs(found[name] - point.observables[name]) for name in ("lambda2", "E", "r_min")])
        coarse, fine = np.array(misses)
        assert (fine[:2] < [5e-5, 5e-6]).all()
        assert (fine[:2] < coarse[:2] / 4).all()


def test_pearls_that_overhang_are_refused(pearls):
    """A steeper profile, of no equilibrium: its radius is no function of x."""
    point, block = pearls.points[-1], Block(1, 0, 1, "even")
    d = point.problem.discretization
    states = d.values(point.u)
    steep = d.pack(states * [1, 2 / np.abs(states[:, 1]).max(), 1, 1], d.all_parameters(point.u))
    with pytest.raises(LiftError, match="overhang"):
        point.problem.lift(block, "pearl", steep, point.tangent)


def test_necks_too_thin_for_modes_are_refused():
    thin = family_branch(Tube(1.2, 12), "pearl", (1, 0), branch_options({"r_min": 0.0135})).points[-1]
    with pytest.raises(LiftError, match="256 reduced modes do not resolve"):
        thin.problem.lift(Block(1, 0, 1, "even"), "pearl", thin.u, thin.tangent)


def test_bent_pearls_are_stable_on_a_mesh_too_where_equal_ones_are_not():
    """Pearls of period 4.5 at ``c0 = 0.6``: below ``v = 0.945298`` those that bend to and fro take over."""
    pearls = family_branch(Tube(0.6, 9), "pearl", (2, 0), branch_options({"bp": 7}))
    left, end = pearls.points[-1], switched(pearls, 7, branch_options({"v": 0.92})).points[-1]
    assert left.observables["v"] == pytest.approx(0.94529752, abs=1e-7)
    assert end.spectrum.n_unstable == 0
    problem, u = meshed(end, 1500)
    spectrum = problem.spectrum(u)
    assert spectrum.n_unstable == 0
    assert spectrum.mu_crit == pytest.approx(end.spectrum.mu_crit, rel=0.12)
    assert problem.observables(u)["E"] == pytest.approx(end.observables["E"], abs=1e-5)
