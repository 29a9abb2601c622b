"""Convergence of triangulated tubes on families of meshes, and amplitudes against the amplitude equations."""

from functools import cache

import numpy as np
import pytest
from scipy.linalg import eigh
from support.pearls import at, path

from pearlbvp.continuation.solution import Solution
from pearlbvp.helfrich import Tube
from pearlbvp.mesh.amplitudes import amplitudes_at
from pearlbvp.mesh.families import edited, graded, jittered, mapped, straightened, tube_mesh
from pearlbvp.mesh.operators import mean_curvature
from pearlbvp.mesh.start import branch_point, straight
from pearlbvp.mesh.subdivision import subdivided
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.mesh import meshed
from pearlbvp.theory.amplitude import amplitude_equation
from pearlbvp.theory.dispersion import critical_lambda2, growth_rate

L = 10.0
COARSE, FINE = 400, 1600


def swept(nodes):
    return graded(tube_mesh(L, nodes), 2.0, 1.0)


def rough(nodes, share=0.1):
    return jittered(tube_mesh(L, nodes), share)


def smoother(nodes):
    """Jittered by a share of an edge that falls with the edge."""
    return jittered(tube_mesh(L, nodes), 0.1 * np.sqrt(COARSE / nodes))


@cache
def irregular(nodes):
    return edited(graded(tube_mesh(L, nodes), 3.0))


def error(mesh, m, n, kind="subdivision"):
    return abs(branch_point(mesh, 0.0, m, n, kind)[1][-2] - critical_lambda2(2 * np.pi * m / L, n, 0.0))


@pytest.mark.parametrize(
    ("kind", "family", "order"),
    [
        ("subdivision", swept, 4), ("subdivision", smoother, 2),
        ("subdivision", rough, 0), ("cotangent", swept, 2), ("cotangent", rough, 2),
        ("cotangent", irregular, 2),
    ],
)  # fmt: skip
def test_orders_of_branch_points(kind, family, order):
    """In the mesh width, as on structured meshes (``test_mesh_energy``); random meshes and the error's next term leave 0.4."""
    coarse, fine = family(COARSE), family(FINE)
    for m, n in ((1, 1),) if kind == "subdivision" else ((1, 0), (1, 1)):
        found = 2 * np.log(error(coarse, m, n, kind) / error(fine, m, n, kind)) / np.log(fine.count / coarse.count)
        assert found == pytest.approx(order, abs=0.4), (m, n)


def test_roughness_costs_subdivision_surfaces_its_square():
    """And irregular valences of a fixed share an error that does not fall; a fixed number of them costs less and less."""
    assert error(rough(600, 0.08), 1, 0) == pytest.approx(4 * error(rough(600, 0.04), 1, 0), rel=0.05)
    coarse = irregular(60)
    finer = straightened(subdivided(coarse)[0])
    finest = straightened(subdivided(finer)[0])
    assert error(finest, 1, 1) < error(finer, 1, 1) / 4
    assert error(finest, 1, 1) < error(irregular(COARSE), 1, 1) / 4


def test_curvatures_by_cotangents_do_not_converge_where_branch_points_do():
    """Pointwise, on jittered and on edited meshes, where the test of orders finds the second for their branch points."""
    for family in (rough, irregular):
        coarse, fine = (np.abs(mean_curvature(family(nodes)) - 0.5).max() for nodes in (COARSE, 4 * COARSE))
        assert fine > 0.05
        assert fine > coarse / 2


@pytest.mark.parametrize(("m", "n", "multiplicity"), [(1, 0, 2), (1, 1, 4), (0, 2, 2)])
def test_branch_points_are_where_growth_rates_change_sign(m, n, multiplicity):
    """Rates by Lanczos' method on both sides, where the tube is regular, linear in between; all waves alike on a lattice."""
    slope, apart = growth_rate(2 * np.pi * m / L, n, 1.0, 0.3) - growth_rate(2 * np.pi * m / L, n, 0.0, 0.3), 0.2
    mesh = tube_mesh(L, 400)
    problem, u = branch_point(mesh, 0.3, m, n)
    both = []
    for side in (apart, -apart):
        found, w = straight(mesh, 0.3, u[-2] + side)
        rates = found.modes(w, 12)[0]
        both.append(rates[np.argsort(np.abs(rates - slope * side))[:multiplicity]])
    np.testing.assert_allclose(both[0], -both[1], atol=1e-9)
    assert np.abs(problem.multipliers(u)).max() < 1e-12


def test_where_a_mesh_splits_a_mode_its_mean_rate_vanishes():
    """The pitchfork is imperfect: multipliers of the waves are a force, and the four rates differ."""
    problem, u = branch_point(irregular(250), 0.0, 1, 1, "cotangent")
    second, sums = problem.hessian(u), problem.functional.sums(problem.vertices(u), problem.directions, 0.0)
    mass, motions = problem.functional.normal_mass(problem.vertices(u), problem.directions)
    allowed = np.linalg.svd(np.vstack((sums.gradients[1], motions[1:3])))[2][3:].T
    rates = -eigh(allowed.T @ second @ allowed, allowed.T @ (mass @ allowed), eigvals_only=True)
    neutral = rates[np.argsort(np.abs(rates))[:4]]
    assert abs(neutral.mean()) < np.ptp(neutral) / 20 < 0.005
    assert 1e-5 < np.abs(problem.multipliers(u)).max() < 0.02


def test_phase_multipliers_fall_as_the_discretization_s_error():
    """Those of a coil: none on a lattice, of fourth order on a graded mesh, below the observables' error on both."""
    exact = family_branch(Tube(0.0, L), "coil", (1, 1), branch_options({"v": 0.95})).points[-1]
    found = []
    for mesh in (tube_mesh(L, 500), graded(tube_mesh(L, 500)), graded(tube_mesh(L, 2000))):
        problem, u = meshed(exact, mesh)
        found.append((mesh.count, np.abs(problem.multipliers(u)).max()))
        observables = problem.observables(u)
        assert observables["lambda2"] == pytest.approx(exact.observables["lambda2"], abs=3e-4 * (500 / mesh.count) ** 2)
    assert found[0][1] < 1e-12
    order = 2 * np.log(found[1][1] / found[2][1]) / np.log(found[2][0] / found[1][0])
    assert order == pytest.approx(4, abs=0.4)


def test_meshes_are_carried_over_with_their_periods():
    """Vertices moved across an end of the period stay next to their neighbours, on pearls by arclength too."""
    problem, w = at(path(0.0, L, 1.2), "v", 1.1)
    mesh = jittered(tube_mesh(L, 500), 0.1)
    assert mesh.vertices[:, 0].min() < 0
    found, u = meshed(Solution(problem, w, w), mesh, kind="cotangent")
    assert found.observables(u)["E"] == pytest.approx(problem.observables(w)["E"], rel=0.05)
    again = mapped(mesh, lambda x, phi: np.column_stack((x, np.cos(phi), np.sin(phi))))
    np.testing.assert_allclose(again.vertices, mesh.vertices, atol=1e-14)


@pytest.mark.parametrize("family", ["coil", "buckle"])
def test_amplitudes_of_coils_and_buckles(family):
    """At a volume, the extracted amplitude is that of the amplitude equation up to its square (relative), and its partner."""
    equation = amplitude_equation(Tube(0.0, L), (1, 1))
    start = branch_point(tube_mesh(L, 600), 0.0, 1, 1)[1][-3:]  # the mesh's own straight tube
    cylinder, fourth = equation.at(family, 0.0), {"coil": 2, "buckle": 20}[family]
    found = []
    for v in (0.99, 0.975):
        point = family_branch(Tube(0.0, L), family, (1, 1), branch_options({"v": v}), discretization="modes").points[-1]
        problem, u = meshed(point, 600)
        a, b = np.abs(amplitudes_at(problem.functional, problem.vertices(u), 1, 1))
        A = max(a, b)
        assert min(a, b) == pytest.approx(0 if family == "coil" else A, abs=1e-9)
        found.append((A, A / equation.amplitude_at(family, u[-1] - start[-1] + 1) - 1))
        predicted = equation.at(family, A)
        for name, value, own in zip(("lambda1", "lambda2"), u[-3:-1], start, strict=False):
            # predicted to the square of the amplitude; next comes its fourth power, and the mesh's error
            assert value - own == pytest.approx(predicted[name] - cylinder[name], abs=fourth * A**4 + 2e-3)
    (first, wrong), (last, more) = found
    assert np.log(more / wrong) / np.log(last / first) == pytest.approx(2, abs=0.35)


@pytest.mark.parametrize(("kind", "order"), [("subdivision", 4), ("cotangent", 2)])
@pytest.mark.parametrize("family", ["coil", "buckle"])
def test_rigid_motions_tell_the_error_of_growth_rates(family, kind, order):
    """``mu_error`` beside the true error of ``mu_crit``, from the spectrum in reduced modes: of its size, and of its order."""
    point = family_branch(Tube(0.0, L), family, (1, 1), branch_options({"v": 0.95}), discretization="modes").points[-1]
    known, true = [], []
    for nodes in (500, 1000):
        problem, u = meshed(point, nodes, kind=kind)
        spectrum = problem.spectrum(u)
        known.append(spectrum.residual * problem.mesh.count ** (order / 2))
        true.append(abs(spectrum.mu_crit - point.spectrum.mu_crit))
        assert 0.1 < spectrum.residual / true[-1] < 10
    assert known[1] == pytest.approx(known[0], rel=0.25)
