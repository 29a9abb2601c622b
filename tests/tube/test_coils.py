"""Helical tubes of several lobes: against the amplitude equation, another frame, and triangles."""

import numpy as np
import pytest

from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.mesh import meshed
from pearlbvp.theory.amplitude import amplitude_equation

TUBE = Tube(-1.0, 10)


def coil(mode, until, tube=TUBE):
    return family_branch(tube, "coil", mode, branch_options(until)).points


@pytest.mark.parametrize("mode", [(2, 2), (1, 2), (2, 3)])
def test_coils_leave_the_straight_tube_as_the_amplitude_equation_says(mode):
    """Where the mode is neutral, with its cubic coefficient; and their own waves grow as it says, in both places twice."""
    equation, branch = amplitude_equation(TUBE, mode), coil(mode, {"wave": 0.008})
    start, end = branch[0].observables, branch[-1].observables
    assert start["lambda2"] == pytest.approx(equation.lambda2, abs=1e-12)
    square = (branch[-1].value("wave") / 2) ** 2
    assert (end["lambda2"] - start["lambda2"]) / square == pytest.approx(-equation.b1 / equation.a, rel=2e-3)
    assert (end["v"] - 1) / square == pytest.approx(-2 * equation.a, rel=2e-3)
    own = [
        rate for block, rates in branch[-1].spectrum.rates.items() for rate in np.repeat(rates, block.multiplicity)
        if abs(rate / square / equation.own_rate("coil") - 1) < 0.02
    ]  # fmt: skip
    assert len(own) == 2


def test_at_rest_they_are_those_of_the_turning_frame_on_a_longer_tube():
    """Half a turn on L is a whole one on 2L: two dimensions and one, with the same energy by area, pressure and torque."""
    at_rest, turning = coil((1, 2), {"v": 0.95}), coil((2, 2), {"v": 0.95}, Tube(-1.0, 20))
    assert at_rest[-1].problem.symmetry.turns == 0 < turning[-1].problem.symmetry.turns == 1
    for name in ("lambda1", "lambda2", "E", "r_min", "r_max", "force", "torque"):
        assert at_rest[-1].observables[name] == pytest.approx(turning[-1].observables[name], abs=1e-8), name
    few, more = (branch[-1].spectrum for branch in (at_rest, turning))
    assert few.n_unstable < more.n_unstable
    rates = np.concatenate(list(more.rates.values()))
    for rate in np.concatenate(list(few.rates.values())):
        if rate > -1:  # what fits the tube fits the longer one
            assert np.abs(rates - rate).min() < 1e-6


@pytest.mark.parametrize("mode", [(2, 2), (1, 2)])
def test_coils_of_two_lobes_conserve_and_are_those_of_meshes(mode):
    end = coil(mode, {"v": 0.96})[-1]
    assert end.problem.family == "coil"
    assert -2 * end.slopes["E"] / end.slopes["v"] == pytest.approx(end.observables["lambda2"], abs=1e-7)
    misses = []
    for nodes in (600, 2400):
        problem, u = meshed(end, nodes)
        misses.append([abs(problem.observables(u)[name] - end.observables[name]) for name in ("lambda2", "E")])
    assert (np.array(misses[1]) < [1e-3, 2e-5]).all()
    assert (np.array(misses[1]) < np.array(misses[0]) / 4).all()


def test_a_branch_of_coils_on_a_mesh_begins_where_the_mode_does():
    branch = family_branch(TUBE, "coil", (1, 2), branch_options({"v": 0.99}), nodes=600).points
    assert branch[0].observables["lambda2"] == pytest.approx(amplitude_equation(TUBE, (1, 2)).lambda2, rel=1e-2)
    same = coil((1, 2), {"v": 0.99})[-1].observables
    assert branch[-1].observables["lambda2"] == pytest.approx(same["lambda2"], rel=2e-2)
