"""Axial force, torque and integrated mean curvature: each against differences of the energy, closed forms, first integrals."""

import math
from dataclasses import replace

import numpy as np
import pytest
from support.other_tubes import derivative, on_tube, stretched
from support.shapes import SHAPES, pearl, shape

import pearlbvp as pb
from pearlbvp.force import axial_force
from pearlbvp.held import coefficients
from pearlbvp.helfrich import cylinder_force
from pearlbvp.mesh.families import tube_mesh
from pearlbvp.mesh.functional import Functional
from pearlbvp.shapes import axisymmetric
from pearlbvp.studies.branch import straight_values
from pearlbvp.studies.mesh import meshed
from pearlbvp.theory.dispersion import critical_lambda2


@pytest.mark.parametrize("name", SHAPES)
def test_the_force_is_the_derivative_of_the_energy_by_the_length(name):
    problem, u = SHAPES[name]()
    force = problem.observables(u)["force"]
    length = problem.observables(u)["L"]
    slope = derivative(lambda factor: stretched(problem, u, factor)[1], 1.0, 3e-4) / length
    assert slope == pytest.approx(force, rel=1e-8)


@pytest.mark.parametrize("name", SHAPES)
def test_the_integrated_mean_curvature_is_the_derivative_of_the_energy_by_c0(name):
    problem, u = SHAPES[name]()
    known = problem.observables(u)
    area = 2 * math.pi * known["L"]
    slope = derivative(lambda c0: area * on_tube(problem, u, c0, known["L"], known["v"])["E"], known["c0"], 2e-3)
    assert slope == pytest.approx(2 * (known["c0"] * area - known["M"]), rel=1e-8)


@pytest.mark.parametrize("s", [0.8, 1.3])
def test_a_similar_shape_of_another_area_has_the_force_of_its_size(s):
    """Energies of similar shapes are equal, so that forces are theirs by lengths; ``area`` and ``v`` count by ``2 pi L``."""
    problem, u = SHAPES["pearl"]()
    known = problem.observables(u)
    powers = {"lambda1": -2, "lambda2": -3, "c0": -1, "L": 1, "M": 1, "v": 2}
    similar = {name: known[name] * s**power for name, power in powers.items()} | {"area": s}
    assert axial_force(similar) == pytest.approx(known["force"] / s, rel=1e-12)


def test_a_known_pearl_has_its_known_force():
    problem, u = pearl(0.0, 10, 1.05)
    assert problem.observables(u)["force"] * 10 == pytest.approx(69.28254735, abs=5e-9)


def test_the_force_is_the_first_integral_of_the_axisymmetric_equations():
    for name in ("pearl", "short pearl", "pearl of negative c0"):
        problem, u = SHAPES[name]()
        d = problem.discretization
        along = 2 * math.pi * axisymmetric.axial_force(d.values(u)[:: d.scheme.m], d.all_parameters(u))
        assert np.abs(along - problem.observables(u)["force"]).max() < 1e-8


@pytest.mark.parametrize("family", ["pearl", "ring", "coil", "buckle"])
def test_the_force_on_the_straight_tube(family):
    start = shape(family, 0.3, 8, {"pearl": 1.001}.get(family, 0.999))  # the branch's first point is the tube
    first = pb.branch(pb.Tube(0.3, 8), family, max_points=2)[0]
    assert start.observables["L"] == 8
    lambda2 = first.observables["lambda2"]
    assert first.observables["force"] == pytest.approx(math.pi * (1 - lambda2 - 2 * 0.3), abs=1e-11)
    assert first.observables["M"] == pytest.approx(math.pi * 8, rel=1e-12)


def test_coils_and_buckles_begin_at_the_force_of_a_beam():
    """Euler: a beam of bending stiffness pi buckles at the force -pi k^2 by (kappa/R), half of it by ours."""
    for c0 in (-1.0, 0.0, 0.48, 2.0):
        for m in range(1, 6):
            tube = pb.Tube(c0, 10)
            k = tube.wave_number(m)
            assert cylinder_force(float(critical_lambda2(k, 1, c0)), c0) == pytest.approx(
                -math.pi * k**2 / 2, abs=1e-10
            )
    table = pb.dispersion(pb.Tube(0.48, 15)).query("n == 1")
    assert len(table) > 2
    assert (table["force"] + math.pi * table["k"] ** 2 / 2).abs().max() < 1e-10
    for family in ("coil", "buckle"):
        first = pb.branch(pb.Tube(0.3, 8), family, max_points=2)[0]
        assert first.observables["force"] == pytest.approx(-math.pi * (2 * math.pi / 8) ** 2 / 2, abs=1e-10)


def test_textbook_thresholds():
    """A pulled tether: 2 pi kappa/R; pearling of long waves at Sigma R^2 = 3/2 kappa; wrinkling at 3 kappa/R^3 (Lévy)."""
    assert 2 * cylinder_force(0.0, 0.0) == pytest.approx(2 * math.pi)
    long_wave = straight_values(pb.Tube(0.0, 1e5), float(critical_lambda2(2 * math.pi / 1e5, 0, 0.0)))
    assert 2 * long_wave["lambda1"] == pytest.approx(1.5, abs=1e-8)
    assert 2 * float(critical_lambda2(0.0, 2, 0.0)) == pytest.approx(3.0)


def test_the_torque_is_the_derivative_of_the_energy_by_the_twist():
    """By length, a coil's energy depends on its length only by the rate at which it turns."""
    coil = shape("coil", 0.3, 10, 0.93)
    known = coil.observables

    def energy(rate):
        return 2 * math.pi * on_tube(coil.problem, coil.u, known["c0"], 2 * math.pi / rate, known["v"])["E"]

    assert derivative(energy, 2 * math.pi / 10, 1e-3) == pytest.approx(known["torque"], rel=1e-8)
    assert known["torque"] > 0.05
    assert "torque" not in shape("buckle", 0.3, 8, 0.97).observables


def test_a_mesh_has_the_force_of_the_smooth_shape():
    point = shape("coil", 0.3, 10, 0.93)
    errors = []
    for nodes in (200, 450):
        problem, u = meshed(point, nodes)
        found = problem.observables(u)
        errors.append([abs(found[name] - point.observables[name]) for name in ("force", "M")])
    assert max(errors[0]) < 2e-2
    assert (np.array(errors[1]) < np.array(errors[0]) / 3).all()  # fourth order: (450/200)^2 is 5


@pytest.mark.parametrize("kind", ["subdivision", "cotangent"])
def test_the_curvature_of_a_mesh_is_the_slope_of_its_energy_in_c0(kind):
    """``E(c0) = E(0) - 2 c0 M + c0^2 A``, exactly."""
    functional = Functional(tube_mesh(6.0, 150), kind)
    shape = 0.05 * np.random.default_rng(3).standard_normal(functional.mesh.count)
    vertices = functional.mesh.vertices + shape[:, None] * functional.directions
    (above, area, _), (below, *_) = (functional.sums(vertices, functional.directions, c0).values for c0 in (1.3, -0.7))
    curvature = functional.sums(vertices, functional.directions, 0.3).curvature
    assert curvature == pytest.approx(((1.3**2 - 0.7**2) * area - above + below) / 4, rel=1e-12)


@pytest.mark.parametrize("kind", ["subdivision", "cotangent"])
def test_the_curvature_of_a_mesh_has_its_gradient(kind):
    functional = Functional(tube_mesh(6.0, 150), kind)
    rng = np.random.default_rng(3)
    shape, way = (0.05 * rng.standard_normal(functional.mesh.count) for _ in range(2))
    directions = functional.directions

    def quantities(step, c0=0.3):
        vertices = functional.mesh.vertices + (shape + step * way)[:, None] * directions
        sums = functional.sums(vertices, directions, c0)
        return functional.quantities(vertices, directions, sums, coefficients(0.0, 0.0, c0))

    slopes = derivative(lambda step: quantities(step).values, 0.0, 1e-3)
    assert slopes == pytest.approx(quantities(0.0).gradients @ way, rel=1e-8)
    assert quantities(0.0, c0=-2.0).gradients[2] @ way == pytest.approx(slopes[2], rel=1e-8)


@pytest.mark.parametrize("kind", ["subdivision", "cotangent"])
def test_a_similar_mesh_has_the_same_energy(kind):
    """What the force's formula is made of: so it is that of the mesh's own energy, a polyhedron's too."""
    mesh, factor = tube_mesh(6.0, 150), 1.1
    near = Functional(mesh, kind)
    vertices = mesh.vertices + 0.05 * np.random.default_rng(3).standard_normal(mesh.count)[:, None] * near.directions
    larger = Functional(replace(mesh, vertices=vertices * factor, length=6.0 * factor), kind)
    energies = near.sums(vertices, near.directions, 0.3).values
    of_larger = larger.sums(vertices * factor, near.directions, 0.3 / factor).values
    assert of_larger == pytest.approx(energies * [1, factor**2, factor**3], rel=1e-12)
