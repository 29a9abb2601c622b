"""Rings, coils and buckles in reduced modes: derivatives, amplitude equations, other discretizations, invariances."""

import math
from dataclasses import replace

import numpy as np
import pytest
from graphs import Graphs, all_waves
from test_amplitude import graphs_of

from pearlbvp.continuation.branch import BranchOptions, continue_branch, start_point
from pearlbvp.continuation.path import PathOptions, correct
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.newton import NewtonOptions
from pearlbvp.studies.branch import branch_options
from pearlbvp.studies.tube import tube_branch
from pearlbvp.theory.amplitude import amplitude_equation
from pearlbvp.theory.dispersion import growth_rate
from pearlbvp.tube.density import gradients, hessians
from pearlbvp.tube.problem import onset


def followed(c0, length, family, m, n, v, step=0.3):
    problem, u, direction = onset(Tube(c0, length), family, m, n)
    path = PathOptions(step=min(0.05, step), max_step=step, max_points=60)
    return continue_branch(
        start_point(problem, u, direction), BranchOptions(path=path, until={"v": v}), at_bifurcation=True
    )


@pytest.fixture(scope="module")
def coil():
    return followed(0.0, 10, "coil", 1, 1, 0.95)


@pytest.fixture(scope="module")
def buckle():
    return followed(0.0, 10, "buckle", 1, 1, 0.97)


@pytest.fixture(scope="module")
def ring():
    return followed(0.0, 10, "ring", 0, 2, 0.85)


def test_the_densities_derivatives():
    """Central differences of the densities, and of their gradients."""
    rng = np.random.default_rng(0)
    z = rng.standard_normal((10, 4)) + np.array([0, 0, 0, 2, 0, 0, 0, 0, -2, 0])[:, None]
    _, slopes = gradients(z, 0.3)
    second = hessians(z, 0.3, 0.7)
    h = 1e-6
    for j in range(10):
        ahead, behind = z.copy(), z.copy()
        ahead[j] += h
        behind[j] -= h
        (values_ahead, slopes_ahead), (values_behind, slopes_behind) = gradients(ahead, 0.3), gradients(behind, 0.3)
        np.testing.assert_allclose((values_ahead - values_behind) / (2 * h), slopes[:, j], atol=1e-8)
        change = (slopes_ahead - slopes_behind) / (2 * h)
        np.testing.assert_allclose((change[0] + 0.7 * change[1]).T, second[:, j], atol=1e-7)


@pytest.mark.parametrize(
    ("family", "m", "n"), [("ring", 0, 2), ("ring", 0, 3), ("coil", 1, 1), ("buckle", 1, 1), ("buckle", 1, 2)]
)
def test_the_jacobian_is_the_residual_s(family, m, n):
    problem, u, direction = onset(Tube(0.3, 10), family, m, n, size=(4, 5))
    rng = np.random.default_rng(1)
    u = u + 0.1 * direction + 0.01 * rng.standard_normal(u.size)
    row = rng.standard_normal(u.size)
    step = rng.standard_normal(u.size)
    h = 1e-5
    change = (problem.residual(u + h * step) - problem.residual(u - h * step)) / (2 * h)
    found = problem.solve(u, np.append(change, problem.inner(row, step)), row)
    np.testing.assert_allclose(found, step, atol=5e-5)  # differences of size 1e-10, divided by small curvatures


@pytest.mark.parametrize(
    ("c0", "family", "n"), [(0.0, "coil", 1), (0.48, "coil", 1), (0.0, "buckle", 1), (0.0, "ring", 2), (0.0, "ring", 3)]
)
def test_branches_are_those_of_graphs_over_the_cylinder(c0, family, n):
    """A section about its own centre, and a graph about the axis: the same shapes at the same volume."""
    m = 0 if family == "ring" else 1
    equation = amplitude_equation(Tube(c0, 10), (m, n))
    graphs, place, factor = graphs_of(equation, family, 8)
    _, lambda1, lambda2, v, energy = graphs.solve(place, 0.05 * factor, equation.lambda1, equation.lambda2)
    branch = followed(c0, 10, family, m, n, float(v), step=0.05)
    last = branch.points[-1].observables
    assert (last["lambda1"], last["lambda2"], last["E"]) == pytest.approx((lambda1, lambda2, energy), abs=1e-8)


def test_the_cylinder_s_spectrum_is_the_dispersion_relation():
    problem, u, _ = onset(Tube(0.2, 10), "coil", 1, 1)
    lambda2 = u[-2]
    spectrum = problem.spectrum(u)
    # In the frame of the coil the wave (j, b) of the tube is seen at j - b; all rates are there.
    found = np.sort(np.concatenate([rates for block, rates in spectrum.rates.items()]))
    for k, n in ((0.0, 2), (2 * math.pi / 10, 0), (2 * math.pi / 10, 2), (4 * math.pi / 10, 1)):
        expected = growth_rate(k, n, lambda2, 0.2)
        assert np.abs(found - expected).min() < 1e-10


def test_minus_twice_the_slope_of_the_energy_is_the_pressure(ring, coil, buckle):
    for branch in (ring, coil, buckle):
        for place in (2, len(branch.points) - 1):
            point = branch.points[place].point
            problem, u = point.problem, point.u
            tangent = problem.solve(u, np.append(np.zeros(u.size - 1), 1.0), point.tangent)
            ahead, behind = (problem.observables(u + h * tangent)["E"] for h in (1e-5, -1e-5))
            slope = (ahead - behind) / 2e-5 / tangent[-1]
            assert -2 * slope == pytest.approx(point.observables["lambda2"], abs=1e-7)


def test_more_modes_change_nothing(ring, coil, buckle):
    for branch in (ring, coil, buckle):
        point = branch.points[-1].point
        larger = [size + 6 if size else 0 for size in point.problem.size]
        problem = replace(point.problem, size=tuple(larger))
        u = problem.adopt(point.problem, point.u)
        along_v = np.zeros(u.size)
        along_v[-1] = 1.0
        result, _ = correct(problem, u, along_v, u, 0.0, NewtonOptions())
        assert result.converged
        assert problem.observables(result.u)["lambda2"] == pytest.approx(point.observables["lambda2"], abs=1e-8)


def test_rigid_motions_are_kernels_where_the_modes_resolve_the_shape(ring, coil, buckle):
    for branch in (ring, coil, buckle):
        assert branch.points[-1].spectrum.kernel < 1e-7


def test_stability_at_onset_is_that_of_the_amplitude_equations(coil, buckle):
    equation = amplitude_equation(Tube(0.0, 10), (1, 1))
    for branch, family, unstable in ((coil, "coil", 0), (buckle, "buckle", 1)):
        entry = branch.points[1]
        square = equation.amplitude_at(family, entry.observables["v"]) ** 2
        assert entry.spectrum.n_unstable == unstable
        assert entry.spectrum.mu_crit == pytest.approx(equation.own_rate(family) * square, rel=0.02)


def test_the_spectrum_of_a_coil_is_that_of_its_graph():
    """Growth rates by another discretization, about the axis and in two dimensions."""
    equation = amplitude_equation(Tube(0.48, 10), (1, 1))
    waves = all_waves(5)
    graphs, place, factor = graphs_of(equation, "coil", 6)
    u, lambda1, lambda2, v, _ = graphs.solve(place, 0.05 * factor, equation.lambda1, equation.lambda2)
    fine = Graphs.of(equation.k, 1, 0.48, waves, (24, 24))
    shape = Graphs.of(equation.k, 1, 0.48, [(j, j, np.cos, None) for j in range(len(u))], (24, 24))
    expected = np.sort(shape.rates(u, lambda1, lambda2, fine))[::-1]
    expected = expected[np.abs(expected) > 1e-5][:6]  # without the rigid motions
    last = followed(0.48, 10, "coil", 1, 1, float(v), step=0.05).points[-1].spectrum
    found = np.sort(np.concatenate([np.repeat(rates, block.multiplicity) for block, rates in last.rates.items()]))[
        ::-1
    ][:6]
    np.testing.assert_allclose(found, expected, atol=2e-6)


def test_what_is_no_family_of_the_mode_is_refused():
    with pytest.raises(InputError, match="^family: "):
        onset(Tube(0.0, 10), "ring", 1, 1)
    with pytest.raises(InputError, match="^mode: "):
        onset(Tube(0.0, 10), "coil", 1, 2)


def test_the_paper_s_secondary_branch_points():
    """c0 = -1: wrinkles lose stability to oblates near lambda2 = 1.61. c0 = 0.48: lambda2 turns on the buckles."""
    wrinkles = tube_branch(-1.0, 10, "ring", (0, 2), branch_options({"v": 0.85}))
    (lost,) = wrinkles.find("bp")
    assert wrinkles.at(lost).observables["lambda2"] == pytest.approx(1.61, abs=0.005)
    assert (lost.change, str(lost.block)) == (2, "j=1 even")
    buckles = tube_branch(0.48, 10, "buckle", (1, 1), branch_options({"v": 0.975}, max_step=0.1))
    (fold,) = buckles.find("fold:lambda2")
    assert buckles.at(fold).observables["v"] == pytest.approx(0.979822, abs=1e-5)
    assert (buckles.table().n_unstable.iloc[1:] == 0).all()
    coils = tube_branch(0.48, 10, "coil", (1, 1), branch_options({"v": 0.9}, max_step=0.3))
    assert coils.find("fold:lambda2") == []
    (regained,) = coils.find("bp")
    assert regained.change == -2
