"""Pearls: against AUTO-07p, on half and full cells, under mesh doubling, and their onset on the cylinder."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq
from support import pearls

from pearlbvp.continuation.path import correct
from pearlbvp.helfrich import Tube
from pearlbvp.newton import NewtonOptions, newton
from pearlbvp.shapes.pearling import pearling_onset
from pearlbvp.theory.dispersion import critical_lambda2

AUTO = pd.read_csv(Path(__file__).parents[1] / "data" / "auto07p_pearl_c0_0_L10_m1.csv")


@pytest.mark.parametrize("row", list(AUTO[AUTO.v <= 1.3].itertuples()), ids=lambda row: f"v={row.v}")
def test_agrees_with_auto07p(row):
    problem, u = pearls.at(pearls.path(0.0, 10.0, 1.3), "lambda2", row.lambda2)
    observed = problem.observables(u)
    for name in ("lambda1", "v", "E"):
        assert observed[name] == pytest.approx(getattr(row, name), rel=3e-9)


def test_axial_force_is_constant_along_every_pearl():
    for c0, period, v in ((0.0, 10.0, 1.3), (0.48, 7.5, 1.03)):
        for point in pearls.path(c0, period, v).points:
            assert point.problem.axial_force_spread(point.u) < 1e-9


def test_energy_pressure_relation():
    # -2 d(E/A)/dv = lambda2 at fixed A and L (docs/theory/model.md): by central differences along the branch.
    followed = pearls.path(0.0, 10.0, 1.3)
    eps = 1e-4
    energy = {}
    for v in (1.1 - eps, 1.1, 1.1 + eps):
        problem, u = pearls.at(followed, "v", v)
        energy[v] = problem.observables(u)
    slope = (energy[1.1 + eps]["E"] - energy[1.1 - eps]["E"]) / (2 * eps)
    assert -2 * slope == pytest.approx(energy[1.1]["lambda2"], abs=1e-6)


def test_doubling_the_mesh_changes_nothing_to_1e_10():
    problem, u = pearls.at(pearls.path(0.48, 7.5, 1.03), "v", 1.02)
    mesh = problem.discretization.mesh
    fine, (moved,) = problem.discretization.on_mesh(np.sort(np.append(mesh, (mesh[1:] + mesh[:-1]) / 2)), u)
    finer = replace(problem, discretization=fine)
    direction = np.zeros_like(moved)
    direction[-1] = 1
    result, _ = correct(finer, moved, direction, moved, 0.0, NewtonOptions())
    before, after = problem.observables(u), finer.observables(result.u)
    for name in ("lambda1", "lambda2", "E"):
        assert after[name] == pytest.approx(before[name], abs=1e-10)


def test_full_cell_agrees_with_the_half_cell_and_its_unfolding_stays_at_rest():
    half, u = pearls.at(pearls.path(0.0, 10.0, 1.3), "v", 1.15)
    problem, (guess,) = half.whole_cell(u)
    names = problem.discretization.free
    direction = np.zeros_like(guess)
    direction[guess.size - len(names) + names.index("v")] = 1
    disturbed = guess.copy()
    disturbed[guess.size - len(names) + names.index("lambda2")] += 1e-3
    result, _ = correct(problem, disturbed, direction, guess, 0.0, NewtonOptions(max_iterations=20))
    assert result.converged, result.message
    parameters = dict(
        zip(problem.discretization.problem.parameters, problem.discretization.all_parameters(result.u), strict=True)
    )
    assert abs(parameters["drag"]) < 1e-11
    expected, observed = half.observables(u), problem.observables(result.u)
    for name in ("lambda1", "lambda2", "E", "amplitude"):
        assert observed[name] == pytest.approx(expected[name], abs=1e-9)
    assert problem.axial_force_spread(result.u) < 1e-9


@pytest.mark.parametrize(("c0", "period"), [(0.0, 10.0), (0.48, 7.5), (-1.0, 10.0), (0.75, 10.0), (0.0, 5.0)])
def test_discretized_cylinder_branches_where_the_closed_form_says(c0, period):
    """At fixed ``lambda2`` the cylinder's half-cell Jacobian is singular exactly at the pearling points."""
    problem, u, tangent = pearling_onset(Tube(c0, period))
    onset = problem.observables(u)["lambda2"]
    d = problem.discretization

    def inverse_response(lambda2):
        parameters = d.parameters.copy()
        parameters[1:3] = 0.25 - lambda2 - c0**2, lambda2
        fixed = replace(d, parameters=parameters, free=("arclength", "lambda1", "v"))
        cylinder = fixed.pack(d.values(u), parameters)
        load = np.zeros(fixed.size)
        # Derivatives of even states are odd: the load must have the parity of the equations.
        load[: len(d.gauss_points) * d.n] = d.at_gauss_points(tangent)[:, [1, 0, 3, 2]].ravel()
        response = fixed.solve(cylinder, load)
        wave = fixed.pack(d.values(tangent), np.zeros_like(parameters))
        return 1 / fixed.inner(wave, response)

    found = brentq(inverse_response, onset - 0.01, onset + 0.013, xtol=1e-13)
    assert found == pytest.approx(onset, abs=1e-9)
    assert onset == pytest.approx(float(critical_lambda2(2 * np.pi / period, 0, c0)), abs=1e-15)


def test_first_pearls_have_the_amplitude_equation_s_shape():
    # delta r = A cos kx: volume and area change give v - 1 = ... ; here: r(belly) + r(neck) is even in A.
    followed = pearls.path(0.48, 7.5, 1.03)
    point = followed.points[1]
    values = point.problem.discretization.values(point.u)
    x = np.linspace(0, 1, len(values))
    assert values[0, 0] > 1 > values[-1, 0]
    assert np.interp(0.5, x, values[:, 0]) == pytest.approx(1, abs=point.observables["amplitude"] ** 2)


def test_no_pearls_at_k_equal_to_one():
    with pytest.raises(ValueError, match="^mode: .*circumference"):
        pearling_onset(Tube(0.3, 2 * np.pi))


def test_collocation_order_on_pearls():
    """``lambda2`` at ``v = 1.1`` on 6, 9, 13 intervals of degree 3: order 6."""
    errors, meshes = [], (6, 9, 13)
    reference, u = pearls.at(pearls.path(0.0, 10.0, 1.3), "v", 1.1)
    exact = reference.observables(u)["lambda2"]
    for intervals in meshes:
        problem, cylinder, _ = pearling_onset(Tube(0.0, 10.0), degree=3, intervals=intervals)
        d = problem.discretization
        guess = d.pack(
            reference.discretization.polynomial(u)(np.linspace(0, 1, 3 * intervals + 1)),
            np.append(reference.discretization.all_parameters(u)[:5], 1.1),
        )
        guess[: d.size - 4] = reference.discretization.polynomial(u)(d.polynomial(cylinder).points).ravel()
        fixed = replace(d, parameters=np.append(d.parameters[:5], 1.1), free=("arclength", "lambda1", "lambda2"))
        result = newton(fixed.residual, fixed.solve, guess[:-1], NewtonOptions(max_iterations=20))
        assert result.converged
        errors.append(abs(result.u[-1] - exact))
    assert -np.polyfit(np.log(meshes), np.log(errors), 1)[0] == pytest.approx(6, abs=1)
