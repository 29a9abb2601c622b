"""Rings, coils, buckles and mixed tubes in reduced modes: derivatives, amplitude equations, other discretizations."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh, null_space
from support.graphs import Graphs, all_waves, graphs_of
from support.sums import Basis, grid, second_variation

from pearlbvp.continuation.path import correct
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.newton import NewtonOptions
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.onward import switched
from pearlbvp.theory.amplitude import amplitude_equation
from pearlbvp.theory.dispersion import growth_rate
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.onset import onset
from pearlbvp.tube.problem import TubeProblem
from pearlbvp.tube.symmetry import TubeSymmetry, buckle_symmetry, coil_symmetry, product_modes, ring_symmetry
from pearlbvp.tube.waves import (
    Cell,
)

MODES = {"ring": (0, 2), "coil": (1, 1), "buckle": (1, 1), "pearl": (1, 0)}


def followed(c0, family, v, step=0.3, mode=None):
    return family_branch(
        Tube(c0, 10),
        family,
        mode or MODES[family],
        branch_options({"v": v}, step=min(0.05, step), max_step=step),
        discretization="modes",
    )


def all_rates(spectrum):
    """All growth rates that were kept, each as often as it occurs, largest first."""
    rates = [np.repeat(found, block.multiplicity) for block, found in spectrum.rates.items()]
    return np.sort(np.concatenate(rates))[::-1]


@pytest.fixture(scope="module")
def coil():
    return followed(0.0, "coil", 0.85)


@pytest.fixture(scope="module")
def buckle():
    return followed(0.0, "buckle", 0.95)


@pytest.fixture(scope="module")
def ring():
    return followed(0.0, "ring", 0.85)


@pytest.fixture(scope="module")
def coils():
    return followed(0.48, "coil", 0.9)


@pytest.fixture(scope="module")
def buckles():
    return followed(0.48, "buckle", 0.91, step=0.15)


@pytest.fixture(scope="module")
def between(coils):
    """What branches off the coils where they become stable."""
    return switched(coils, 1, branch_options())


@pytest.mark.parametrize(
    ("family", "m", "n"),
    [
        ("ring", 0, 2),
        ("ring", 0, 3),
        ("coil", 1, 1),
        ("coil", 2, 1),
        ("buckle", 1, 1),
        ("buckle", 1, 2),
        ("pearl", 1, 0),
    ],
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
    np.testing.assert_allclose(found, step, atol=2e-4)  # differences of size 1e-10, divided by small curvatures


@pytest.mark.parametrize(
    ("c0", "family", "n"), [(0.0, "coil", 1), (0.48, "coil", 1), (0.0, "buckle", 1), (0.0, "ring", 2), (0.0, "ring", 3)]
)
def test_branches_are_those_of_graphs_over_the_cylinder(c0, family, n):
    """A section about its own centre, and a graph about the axis: the same shapes at the same volume."""
    m = 0 if family == "ring" else 1
    equation = amplitude_equation(Tube(c0, 10), (m, n))
    graphs, place, factor = graphs_of(equation, family, 8)
    _, lambda1, lambda2, v, energy = graphs.solve(place, 0.05 * factor, equation.lambda1, equation.lambda2)
    last = followed(c0, family, float(v), step=0.05, mode=(m, n)).points[-1].observables
    assert (last["lambda1"], last["lambda2"], last["E"]) == pytest.approx((lambda1, lambda2, energy), abs=1e-8)


def test_pearls_are_those_of_arclength():
    """Reduced modes against collocation of the profile, with all growth rates that both count."""
    one = followed(0.0, "pearl", 1.03)
    other = family_branch(Tube(0.0, 10), "pearl", (1, 0), branch_options({"v": 1.03}))
    for name in ("lambda1", "lambda2", "E", "r_min", "r_max"):
        assert one.points[-1].observables[name] == pytest.approx(other.points[-1].observables[name], abs=1e-9)
    rates = [all_rates(branch.points[-1].spectrum)[:12] for branch in (one, other)]
    np.testing.assert_allclose(*rates, atol=1e-6)


def test_the_cylinder_s_spectrum_is_the_dispersion_relation():
    problem, u, _ = onset(Tube(0.2, 10), "coil", 1, 1)
    lambda2 = u[-2]
    spectrum = problem.spectrum(u)
    # In the frame of the coil the wave (j, b) of the tube is seen at j - b; all rates are there.
    found = np.sort(np.concatenate([rates for block, rates in spectrum.rates.items()]))
    for k, n in ((0.0, 2), (2 * math.pi / 10, 0), (2 * math.pi / 10, 2), (4 * math.pi / 10, 1)):
        expected = growth_rate(k, n, lambda2, 0.2)
        assert np.abs(found - expected).min() < 1e-10


@pytest.mark.parametrize(
    ("family", "m", "n"), [("ring", 0, 2), ("ring", 0, 3), ("coil", 1, 1), ("buckle", 1, 1), ("buckle", 2, 1)]
)
def test_blocks_hold_every_perturbation_once(family, m, n):
    """The straight tube's rates by blocks and multiplicities: those of ``e^{i(jkx + b phi)}``, each counted once."""
    problem, u, _ = onset(Tube(0.1, 10), family, m, n)
    spectrum = problem.spectrum(u)
    found = all_rates(spectrum)
    k = 2 * math.pi / 10
    expected = [
        growth_rate(k * j, b, u[-2], 0.1)
        for j in range(-8, 9)
        for b in range(-8, 9)
        if (j, b) not in ((0, 0), (0, 1), (0, -1))  # the constraints, and shifts across the axis
    ]
    expected = np.sort(expected)[::-1][:24]
    np.testing.assert_allclose(found[:24], expected, atol=1e-9)


def test_minus_twice_the_slope_of_the_energy_is_the_pressure(ring, coil, buckle, between):
    for branch in (ring, coil, buckle, between):
        for place in (2, len(branch.points) - 2):
            point = branch.points[place]
            problem, u = point.problem, point.u
            tangent = problem.solve(u, np.append(np.zeros(u.size - 1), 1.0), point.tangent)
            ahead, behind = (problem.observables(u + h * tangent)["E"] for h in (1e-5, -1e-5))
            slope = (ahead - behind) / 2e-5 / tangent[-1]
            assert -2 * slope == pytest.approx(point.observables["lambda2"], abs=1e-7)


def refined(point, size, symmetry=None):
    """A solution at the same volume on other modes."""
    problem = point.problem.resized(size) if symmetry is None else replace(point.problem, symmetry=symmetry, size=size)
    u = problem.transfer(point.problem, point.u)
    along_v = np.zeros(u.size)
    along_v[-1] = 1.0
    result, _ = correct(problem, u, along_v, u, 0.0, NewtonOptions())
    assert result.converged
    return problem, result.u


def test_more_modes_change_nothing(ring, coil, buckle):
    for branch, accuracy in ((ring, 1e-10), (coil, 1e-10), (buckle, 1e-9)):
        point = branch.points[-1]
        size = tuple(most + 8 if most else 0 for most in point.problem.size)
        problem, u = refined(point, size)
        assert problem.observables(u)["lambda2"] == pytest.approx(point.observables["lambda2"], abs=accuracy)
        rates, finer = (
            s.rates[point.problem.trivial_block] for s in (point.problem.spectrum(point.u), problem.spectrum(u))
        )
        np.testing.assert_allclose(rates[:2], finer[:2], atol=1e-7)


def test_a_coil_in_the_frame_at_rest_is_the_same(coils):
    """One dimension in a turning frame, and two in one at rest."""
    point = coils.points[2]
    problem = TubeProblem(TubeSymmetry(1, 1, 0, frozenset({0, 3, 12, 15})), 0.48, 10, (20, 20))
    known, u = point.problem.known(point.u), np.zeros(len(problem.modes) + 3)
    for i, mode in enumerate(problem.modes):
        if mode.p == mode.harmonic:  # e^{i kx} d and sigma(phi - kx): as many waves along the tube as around it
            u[i] = known[Mode("y", 0) if mode.part != "sigma" else Mode("sigma", 0, "cos", mode.b)]
    u[-3:] = point.u[-3:]
    assert np.abs(problem.residual(u)).max() < 1e-10
    observed = problem.observables(u)
    for name in ("E", "r_min", "r_max"):
        assert observed[name] == pytest.approx(point.observables[name], abs=1e-10)
    one, other = (all_rates(p.spectrum(w))[:12] for p, w in ((problem, u), (point.problem, point.u)))
    np.testing.assert_allclose(one, other, atol=1e-8)


def test_rigid_motions_are_kernels_where_the_modes_resolve_the_shape(ring, coil, buckle, between):
    for branch in (ring, coil, buckle, between):
        assert branch.points[-1].spectrum.residual <= 1e-7
    point = buckle.points[-1]
    coarse, u = refined(point, (6, 6))
    assert coarse.spectrum(u).residual > 1e-7


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
    last = followed(0.48, "coil", float(v), step=0.05).points[-1].spectrum
    found = all_rates(last)
    np.testing.assert_allclose(found[:6], expected, atol=2e-6)


def test_the_spectrum_of_a_mixed_tube_is_that_of_all_modes_at_once(between):
    """No blocks, no waves: every mode on the tube, forms summed point by point, rigid motions found as kernels."""
    point = between.points[1]
    problem, u = point.problem, point.u
    assert problem.symmetry.period == 2  # all of the tube, in modes of half its length
    most = 9
    modes = tuple(product_modes([(p, b) for p in range(most + 1) for b in range(most + 1)], problem.symmetry.turns))
    x, phi = grid((48, 48), problem.length)
    basis = Basis.of(modes, problem.k, problem.kappa, x, phi)
    known = problem.known(u)
    state = basis.state(np.array([known.get(mode, 0.0) for mode in modes]))
    second, mass, constraints = second_variation(basis, state, problem.c0, u[-3], u[-2])
    allowed = null_space(constraints / np.linalg.norm(constraints, axis=1)[:, None])
    rates = -eigh(allowed.T @ second @ allowed, allowed.T @ mass @ allowed, eigvals_only=True)[:16]
    rates = rates[np.abs(rates) > 2e-5]  # without the rigid motions
    spectrum = problem.spectrum(u)
    found = all_rates(spectrum)
    np.testing.assert_allclose(found[:6], rates[:6], atol=5e-5)


def test_the_branch_between_coils_and_buckles(coils, buckles, between):
    """c0 = 0.48, L = 10: coils gain, buckles lose stability where one stable branch joins them, followed from either end."""
    (gained,), (lost,) = coils.find("bp"), buckles.find("bp")
    assert (gained.change, lost.change) == (-2, 1)
    assert between.points[-1].observables["v"] == pytest.approx(buckles.at(lost).observables["v"], abs=1e-8)
    assert between.points[0].observables["v"] == pytest.approx(coils.at(gained).observables["v"], abs=1e-12)
    for name in ("lambda1", "lambda2", "E"):
        assert between.points[-1].observables[name] == pytest.approx(buckles.at(lost).observables[name], abs=1e-8)
    assert (between.table().n_unstable == 0).all()
    back = switched(buckles, 1, branch_options())
    assert back.points[-1].observables["v"] == pytest.approx(coils.at(gained).observables["v"], abs=1e-8)
    # Two frames, and at the same volume one shape.
    v = between.points[2].observables["v"]
    again = switched(buckles, 1, branch_options({"v": v}))
    assert again.points[-1].observables["E"] == pytest.approx(between.points[2].observables["E"], abs=1e-10)


def test_lambda2_turns_on_the_buckles(coils, buckles):
    (fold,) = buckles.find("fold:lambda2")
    assert buckles.at(fold).observables["v"] == pytest.approx(0.979822, abs=1e-5)
    assert coils.find("fold:lambda2") == []


def test_a_switch_back_to_what_is_more_symmetric_is_refused(between):
    with pytest.raises(InputError, match="^number: .*more symmetric"):
        switched(between, 1, branch_options())


def test_symmetry_groups_by_what_breaks_them():
    ring = ring_symmetry(2)
    buckle_on_it = ring.broken_by(ring.block(1, 1, 0))
    assert (buckle_on_it.period, buckle_on_it.fold) == (1, 1)
    assert buckle_on_it.group == buckle_symmetry(1, 1).group  # even both ways, unchanged by half a wave both ways
    coil = coil_symmetry(1)
    assert coil.broken_by(coil.block(2, 0, 0)).period == 2
    buckle = buckle_symmetry(2, 1)
    assert buckle.broken_by(buckle.block(1, 0, 0)).period == 1


def test_a_rigid_motion_that_the_symmetry_leaves_free_is_pinned(buckle):
    """Even in x but not in phi: the buckle turned about its axis is a solution too, and Newton's method needs a phase."""
    point = buckle.points[-1]
    block = point.problem.symmetry.block(0, 0, 2)
    problem, (u, _) = point.problem.lift(block, "pearl", point.u, point.tangent)
    assert problem.pinned is not None
    along_v = np.zeros(u.size)
    along_v[-1] = 1.0
    guess = u + 1e-3 * np.append(problem.pinned[0], np.zeros(3))  # turned a little
    result, _ = correct(problem, guess, along_v, u, 0.0, NewtonOptions())
    assert result.converged
    assert problem.observables(result.u)["E"] == pytest.approx(point.observables["E"], abs=1e-9)
    assert np.abs(problem.pinned @ result.u[:-3]).max() < 1e-10


def test_extremes_are_those_of_the_function(between):
    point = between.points[1]
    _, y, z = point.problem.surface(point.u, np.linspace(0, 5, 50), 50)
    basis = Basis.of(point.problem.modes, point.problem.k, point.problem.kappa, np.zeros(1), np.zeros(1))
    assert basis.fields.shape[2] == len(point.problem.modes)
    fine = Cell(2, 1, (200, 200))
    radii = point.problem.waves.state(fine, point.u[:-3])[3]
    assert point.observables["r_max"] == pytest.approx(radii.max(), abs=1e-3)
    assert point.observables["r_max"] >= radii.max() - 1e-14
    assert point.observables["r_min"] <= radii.min() + 1e-14
    assert np.isfinite(y + z).all()


def test_surface_has_the_area_and_the_volume(between):
    """The points of the surface as flat triangles: second order in their size."""
    errors = []
    for n in (60, 120):
        point = between.points[1]
        x, y, z = point.problem.surface(point.u, np.linspace(0, 10, n + 1), n)
        corners = np.stack((x, y, z), axis=-1)
        a, b, c, d = corners[:-1, :-1], corners[1:, :-1], corners[:-1, 1:], corners[1:, 1:]
        area = sum(np.linalg.norm(np.cross(q - p, r - p), axis=-1).sum() / 2 for p, q, r in ((a, b, c), (d, c, b)))
        sections = (y[:-1, :-1] * z[:-1, 1:] - y[:-1, 1:] * z[:-1, :-1]).sum() / 2
        errors.append((area / (20 * math.pi) - 1, sections * 10 / n / (10 * math.pi) / point.observables["v"] - 1))
    assert np.abs(errors[1]).max() < 1e-3
    np.testing.assert_allclose(np.divide(*errors), 4, rtol=0.02)


def test_what_is_no_family_of_the_mode_is_refused():
    with pytest.raises(InputError, match="^family: "):
        onset(Tube(0.0, 10), "ring", 1, 1)
    with pytest.raises(InputError, match="^family: "):
        onset(Tube(0.0, 10), "coil", 0, 2)


def test_growth_rates_of_slender_coils_are_not_rounding():
    """Some displacements of a steep section hardly move the surface along its normal: rates must not feel their lightness."""
    point = followed(0.48, "coil", 0.4).points[-1]
    problem, u = refined(point, (0, point.problem.size[1] + 40))
    noise = 1 + 1e-15 * np.random.default_rng(4).standard_normal(point.u.size)
    rates = [
        s.mu_crit
        for s in (point.problem.spectrum(point.u), point.problem.spectrum(point.u * noise), problem.spectrum(u))
    ]
    assert np.ptp(rates) < 1e-9
    assert rates[0] == pytest.approx(-2.3e-3, abs=2e-4)  # stable, as all along from v = 0.906 down
