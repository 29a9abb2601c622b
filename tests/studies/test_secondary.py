"""Branches that leave rings in reduced modes: branch points located twice, stability by exchange, resolved kernels."""

import math

import numpy as np
import pytest

from pearlbvp.continuation.path import correct, steps
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.newton import NewtonOptions
from pearlbvp.stability.planar import PlanarVariation
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.diagram import diagram, join_the_same
from pearlbvp.studies.onward import switched
from pearlbvp.studies.ring_onsets import exact_profile, neutral_rings
from pearlbvp.theory.elastica import ring_at
from pearlbvp.tube.symmetry import ODD_PHI

K = 2 * math.pi / 10


@pytest.fixture(scope="module")
def ring():
    """The wrinkled tubes of the paper's Fig. c00f, D."""
    return family_branch(Tube(0.0, 10), "ring", (0, 2), branch_options({"v": 0.88}))


@pytest.fixture(scope="module")
def wrinkled():
    """Those of its Fig. cmf1, in reduced modes."""
    return family_branch(Tube(-1.0, 10), "ring", (0, 2), branch_options({"v": 0.86}), discretization="modes")


@pytest.fixture(scope="module")
def secondary(ring):
    """What leaves D, to where it differs clearly."""
    ends = {1: 0.952, 2: 0.922, 3: 0.88}
    return {number: switched(ring, number, branch_options({"v": v})) for number, v in ends.items()}


@pytest.fixture(scope="module")
def oblate():
    """Oblates embedded in wrinkling: what leaves the rings at c0 = -1."""
    rings = family_branch(Tube(-1.0, 10), "ring", (0, 2), branch_options({"v": 0.87}))
    return switched(rings, 1, branch_options({"v": 0.868}))


def test_branch_points_of_rings_are_those_of_tubes_and_of_elasticae(ring, wrinkled):
    """By collocation of the ring, on the tube in reduced modes, and on the exact curve."""
    exact = neutral_rings(0.0, 2, [K])
    found = [ring.at(special).observables for special in ring.find("bp")]
    np.testing.assert_allclose([o["v"] for o in found], exact["v"][: len(found)], atol=1e-9)
    np.testing.assert_allclose([o["lambda2"] for o in found], exact["lambda2"][: len(found)], atol=1e-9)
    (special,) = wrinkled.find("bp")
    first = neutral_rings(-1.0, 2, [K]).iloc[0]
    observed = wrinkled.at(special).observables
    for name in ("v", "lambda1", "lambda2", "E"):
        assert observed[name] == pytest.approx(first[name], abs=1e-8)
    assert observed["lambda2"] == pytest.approx(1.6136, abs=5e-5)  # the paper: about 1.6
    assert special.change == 2


def test_rings_in_reduced_modes_are_neutral_where_elasticae_are(ring):
    """Every branch point of the rings, in the block of the tube that the new branch is taken from."""
    for special in ring.find("bp"):
        problem, u, _ = ring.at(special).problem.in_modes(ring.at(special).u, ring.at(special).tangent)
        parity = ODD_PHI if special.block.parity == "odd" else 0
        block = problem.symmetry.block(special.block.j, special.block.c, parity)
        rates = problem.block_rates(u, block, None)
        assert np.abs(rates).min() < 1e-8


def exact_rate(c0, block, v):
    """The growth rate nearest to zero of a block of the exact ring of a volume."""
    variation = PlanarVariation.of(exact_profile(ring_at(2, "v", v), c0))
    rates = variation.rates_at(block.c, block.parity, np.array([K * block.j]))[0]
    return float(rates[np.abs(rates).argmin()])


def test_secondary_branches_exchange_stability_with_the_rings(ring, secondary):
    """At the same volume, a pitchfork's own growth rate is -2 times that of the branch it leaves, to leading order."""
    for number, branch in secondary.items():
        special = ring.find("bp")[number - 1]
        at = ring.at(special).observables["v"]
        errors, distances = [], []
        for entry in branch.points[1:]:
            rates = entry.spectrum.rates[entry.problem.trivial_block]
            own = rates[np.abs(rates).argmin()]
            v = entry.observables["v"]
            errors.append(own / exact_rate(0.0, special.block, v) + 2)
            distances.append(at - v)
        # Linear in the distance: the ratio's error by it is bounded, and the ratio tends to -2.
        assert abs(errors[0]) < 0.05
        assert np.abs(np.array(errors) / np.array(distances)).max() < 60


def test_unstable_directions_are_those_that_exchange_of_stability_leaves(ring, secondary, oblate):
    """A branch beside more unstable rings takes over the count before; beside less unstable ones it has one more.

    Waves along the tube come in pairs; on the new branch one of the two is a shift along it, which is neutral.
    """
    for number, branch in secondary.items():
        special = ring.find("bp")[number - 1]
        others = ring.at(special).spectrum.n_unstable  # without what is neutral there
        assert branch.points[1].observables["v"] < branch.points[0].observables["v"]  # where the new branch is
        expected = others if special.change > 0 else others + 1
        assert branch.points[1].spectrum.n_unstable == expected
    # At its first point the wave is neutral, and the sign of its rate that of rounding.
    assert (oblate.table()["n_unstable"].iloc[1:] == 0).all()


def test_minus_twice_the_slope_of_the_energy_is_the_pressure(secondary, oblate):
    for branch in (*secondary.values(), oblate):
        for entry in branch.points[1:]:
            point = entry
            problem, u = point.problem, point.u
            tangent = problem.solve(u, np.append(np.zeros(u.size - 1), 1.0), point.tangent)
            ahead, behind = (problem.observables(u + h * tangent)["E"] for h in (1e-5, -1e-5))
            assert -2 * (ahead - behind) / 2e-5 / tangent[-1] == pytest.approx(entry.observables["lambda2"], abs=1e-7)


def test_rigid_motions_are_kernels(secondary, oblate):
    for branch in (*secondary.values(), oblate):
        assert all(entry.spectrum.residual <= 1e-7 for entry in branch.points)


def test_more_modes_change_nothing(secondary, oblate):
    for branch in (*secondary.values(), oblate):
        point = branch.points[-1]
        problem = point.problem.resized((point.problem.size[0] + 6, point.problem.size[1] + 6))
        u = problem.transfer(point.problem, point.u)
        along_v = np.zeros(u.size)
        along_v[-1] = 1.0
        result, _ = correct(problem, u, along_v, u, 0.0, NewtonOptions())
        assert result.converged
        for name in ("lambda1", "lambda2", "E", "r_min", "r_max"):
            assert problem.observables(result.u)[name] == pytest.approx(point.observables[name], abs=1e-8)


def test_embedded_oblates_become_stable_where_the_paper_stops(secondary):
    """On the branch that leaves D at v = 0.95675, between two volumes on either side of 0.90807; modes do not matter."""
    path = steps(secondary[1].points[-1], branch_options(max_step=0.4).path)
    last = next(point for point in path if point.observables["v"] < 0.912)
    for size, v, unstable in (((20, 28), 0.9082, 1), ((22, 30), 0.9079, 0)):
        problem = last.problem.resized(size)
        u = problem.transfer(last.problem, last.u)
        along_v = np.zeros(u.size)
        along_v[-1] = 1.0
        for volume in np.linspace(u[-1], v, 3)[1:]:
            result, _ = correct(problem, u, along_v, u + (volume - u[-1]) * along_v, 0.0, NewtonOptions())
            assert result.converged
            u = result.u
        spectrum = problem.spectrum(u)
        assert spectrum.residual <= 1e-7
        assert spectrum.n_unstable == unstable


def test_a_branch_found_from_its_other_end_is_the_same(secondary):
    assert join_the_same(secondary[2], secondary[2].reversed())
    assert not join_the_same(secondary[2], secondary[3])


def test_a_diagram_takes_every_family_of_a_range():
    found = diagram(0.0, 10, 0, branch_options({"v": 0.99}, max_points=2), lambda2=(-1.0, 1.6), processes=2)
    assert list(found.branches) == ["1", "coil 1:1", "buckle 1:1", "ring 0:2"]
    table = found.table()
    assert list(table.columns[:3]) == ["branch", "point", "special"]
    assert table.groupby("branch").lambda2.first()["ring 0:2"] == 1.5


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"lambda2": (0, 1), "modes": [(1, 1)]}, "modes"),
        ({"options": {"snake": branch_options()}}, "options"),
        ({"lambda2": (-1, 1e4)}, "lambda2"),
    ],
)
def test_unusable_diagrams_are_refused(arguments, name):
    with pytest.raises(InputError, match=f"^{name}: "):
        diagram(0.0, 10, 0, **arguments)
