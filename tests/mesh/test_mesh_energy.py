"""Discrete energy, area and volume: derivatives, dispersion of the straight tube, orders of convergence on mesh families."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy import sparse

from pearlbvp import bordered
from pearlbvp.bordered import Kept, Pinned, spread
from pearlbvp.factorization import by_superlu, factorized
from pearlbvp.mesh.adaptation import smoothed
from pearlbvp.mesh.edits import apart, flipped
from pearlbvp.mesh.families import jittered, tube_mesh
from pearlbvp.mesh.functional import Functional
from pearlbvp.mesh.operators import vertex_normals
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.start import branch_point
from pearlbvp.mesh.subdivision import limit_matrix, spline_values
from pearlbvp.theory.dispersion import critical_lambda2

L = 10.0
KINDS = ("subdivision", "cotangent")


def rough(nodes=120, seed=0):
    """A bent and jittered tube, and directions that are not its normals."""

    def surface(x, phi):
        k = 2 * np.pi / L
        r = 1 + 0.2 * np.cos(k * x) + 0.1 * np.cos(2 * phi + 1)
        return np.column_stack((x, 0.4 * np.sin(k * x) + r * np.cos(phi), r * np.sin(phi)))

    mesh = jittered(tube_mesh(L, nodes), 0.1, seed, surface)
    tilt = 0.2 * np.random.default_rng(seed).standard_normal((mesh.count, 3))
    return mesh, vertex_normals(mesh) + tilt


def irregular(nodes=120):
    """A mesh with valences other than 6, by flips."""
    mesh, directions = rough(nodes)
    changed = flipped(mesh, apart(mesh, mesh.edges[::17], rings=True))
    assert set(np.diff(changed.star[0])) >= {5, 6, 7}
    return changed, directions


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("make", [rough, irregular])
def test_gradients_and_hessian_are_exact_derivatives(kind, make):
    mesh, directions = make()
    functional, c0, lambda1, lambda2 = Functional(mesh, kind), 0.3, 0.7, -0.4
    step = np.random.default_rng(1).standard_normal(mesh.count)
    h = 1e-5
    ahead, behind = (
        functional.sums(mesh.vertices + s * h * step[:, None] * directions, directions, c0) for s in (1, -1)
    )
    hessian = functional.hessian(mesh.vertices, directions, c0, lambda1, lambda2)
    sums = functional.sums(mesh.vertices, directions, c0)
    size = np.abs(sums.gradients).max()
    np.testing.assert_allclose((ahead.values - behind.values) / (2 * h), sums.gradients @ step, atol=1e-6 * size)
    weights = np.array([1, lambda1, lambda2])
    change = weights @ (ahead.gradients - behind.gradients) / (2 * h)
    np.testing.assert_allclose(hessian @ step, change, atol=1e-6 * np.abs(change).max())
    assert abs(hessian - hessian.T).max() < 1e-12 * abs(hessian).max()


def summed(functional, vertices, c0):
    """Energy, area and volume of a subdivision surface at complex vertices, from the formulas for whole arrays."""
    patches = functional.quadrature
    X = vertices[patches.index]
    jets = [np.add.reduceat(w[:, None] * X, patches.start[:-1]) for w in patches.weights]
    for jet, moved in zip(jets, patches.offsets, strict=True):
        jet[:, 0] += moved
    x, a, b, p, q, r = jets
    E, F, G, c = (a * a).sum(1), (a * b).sum(1), (b * b).sum(1), np.cross(a, b)
    root = np.sqrt(E * G - F * F)
    H = -((G[:, None] * p - 2 * F[:, None] * q + E[:, None] * r) * c).sum(1) / (2 * root**3)
    return patches.weight * np.array([((H - c0) ** 2 * root).sum(), root.sum(), (x[:, 1:] * c[:, 1:]).sum() / 2])


@pytest.mark.parametrize("make", [rough, irregular])
def test_derivatives_of_subdivision_surfaces_to_all_digits(make):
    """Values, first and second derivatives along a line are Taylor coefficients: Cauchy's integrals on a circle about it."""
    mesh, directions = make()
    functional, c0, weights = Functional(mesh), 0.3, np.array([1, 0.7, -0.4])
    hessian = functional.hessian(mesh.vertices, directions, c0, *weights[1:])
    sums = functional.sums(mesh.vertices, directions, c0)
    rng = np.random.default_rng(1)
    for _ in range(3):
        step = rng.standard_normal(mesh.count)
        radius, angles = 0.01, 2 * np.pi * np.arange(32) / 32
        circle = [
            summed(functional, mesh.vertices + z * step[:, None] * directions, c0) for z in radius * np.exp(1j * angles)
        ]
        coefficients = np.fft.fft(circle, axis=0)[:3].real / len(angles) / radius ** np.arange(3)[:, None]
        np.testing.assert_allclose(sums.values, coefficients[0], rtol=1e-12)
        np.testing.assert_allclose(sums.gradients @ step, coefficients[1], rtol=1e-12, atol=1e-12)
        assert step @ hessian @ step == pytest.approx(2 * weights @ coefficients[2], rel=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_rigid_motions_and_scaling(kind):
    """Translations and the rotation about the axis change nothing; a scaled tube has the same bending energy at c0 = 0."""
    mesh, directions = rough()
    functional = Functional(mesh, kind)
    values = functional.sums(mesh.vertices, directions, 0.3).values
    turn = np.array([[1, 0, 0], [0, np.cos(1.0), -np.sin(1.0)], [0, np.sin(1.0), np.cos(1.0)]])
    moved = functional.sums(mesh.vertices @ turn.T + [0.3, -0.2, 5.0], directions, 0.3).values
    np.testing.assert_allclose(moved, values, rtol=1e-11)
    energy, area, volume = functional.sums(mesh.vertices, directions, 0.0).values
    larger = Functional(replace(mesh, vertices=2 * mesh.vertices, length=2 * L), kind)
    assert larger.sums(2 * mesh.vertices, directions, 0.0).values == pytest.approx(
        (energy, 4 * area, 8 * volume), rel=1e-12
    )


def test_polyhedra_have_their_own_area_and_volume():
    mesh, directions = rough()
    _, area, volume = Functional(mesh, "cotangent").sums(mesh.vertices, directions, 0.0).values
    assert (area, volume) == pytest.approx((mesh.area, mesh.volume), rel=1e-13)


def test_the_box_spline():
    """A partition of unity that reproduces quadratic polynomials up to their known shift."""
    u = np.array([0.2, 0.5, 0.3])
    values = spline_values(tuple(u))
    np.testing.assert_allclose(values.sum(axis=1), [1, 0, 0, 0, 0, 0], atol=1e-13)
    # the patch's vertices in the coordinates (v, w), in the order of the functions
    places = np.array(
        [(0, 0), (1, 0), (0, 1), (-1, 1), (-1, 0), (0, -1), (1, -1), (2, -1), (2, 0), (1, 1), (0, 2), (-1, 2)],
        dtype=float,
    )
    np.testing.assert_allclose(values @ places[:, 0], [u[1], 1, 0, 0, 0, 0], atol=1e-13)
    np.testing.assert_allclose(values @ places[:, 1], [u[2], 0, 1, 0, 0, 0], atol=1e-13)
    product = values @ (places[:, 0] * places[:, 1])
    np.testing.assert_allclose(product[1:], [u[2], u[1], 0, 1, 0], atol=1e-13)
    square = values @ places[:, 0] ** 2
    np.testing.assert_allclose(square[1:], [2 * u[1], 0, 2, 0, 0], atol=1e-13)


def test_patches_are_the_limit_of_subdivision():
    """Integrals over the patches against the polyhedron of a mesh subdivided four times, at valences 5, 6 and 7."""
    mesh, directions = irregular(60)
    fine, matrix, offsets = limit_matrix(mesh, 4)
    points = matrix @ mesh.vertices
    points[:, 0] += offsets
    surface = PeriodicMesh(points, fine.triangles, fine.wraps, L)
    _, area, volume = Functional(mesh).sums(mesh.vertices, directions, 0.0).values
    assert (area, volume) == pytest.approx((surface.area, surface.volume), rel=3e-3)
    regular = tube_mesh(L, 60)
    fine, matrix, offsets = limit_matrix(regular, 4)
    points = matrix @ regular.vertices
    points[:, 0] += offsets
    surface = PeriodicMesh(points, fine.triangles, fine.wraps, L)
    _, area, volume = Functional(regular).sums(regular.vertices, vertex_normals(regular), 0.0).values
    assert (area, volume) == pytest.approx((surface.area, surface.volume), rel=2e-3)


@pytest.mark.parametrize(("kind", "order"), [("subdivision", 4), ("cotangent", 2)])
@pytest.mark.parametrize(("m", "n"), [(1, 0), (0, 2), (1, 1)])
def test_branch_points_converge_to_the_dispersion_relation(kind, order, m, n):
    """By the mesh width, on structured meshes of one shape (exact doublings)."""
    exact = critical_lambda2(2 * np.pi * m / L, n, 0.0)
    errors, sizes = [], []
    for nodes in (330, 1330):
        mesh = tube_mesh(L, nodes)
        errors.append(abs(branch_point(mesh, 0.0, m, n, kind)[1][-2] - exact))
        sizes.append(mesh.count)
    found = np.log(errors[0] / errors[1]) / np.log(np.sqrt(sizes[1] / sizes[0]))
    assert found == pytest.approx(order, abs=0.35)


def test_branch_points_to_four_digits():
    """At 3,000 nodes."""
    mesh = tube_mesh(L, 3000)
    assert branch_point(mesh, 0.0, 1, 1)[1][-2] == pytest.approx(critical_lambda2(2 * np.pi / L, 1, 0.0), rel=5e-5)


def test_cotangents_converge_on_jittered_meshes_too():
    """Where vertices are moved at random by a fixed part of an edge, the energy's minimum smooths what curvatures do not."""
    exact = critical_lambda2(2 * np.pi / L, 0, 0.0)
    errors = []
    for nodes in (1000, 3000):
        errors.append(branch_point(jittered(tube_mesh(L, nodes), 0.1), 0.0, 1, 0, "cotangent")[1][-2] - exact)
    assert 0 < errors[1] < 0.6 * errors[0] < 0.6 * 0.01


def test_smoothed_meshes_are_all_but_as_good_as_structured_ones():
    """Subdivision surfaces do not converge on jittered meshes; springs along the edges give them back what they need."""
    exact = critical_lambda2(2 * np.pi / L, 1, 0.0)
    mesh = tube_mesh(L, 700)
    structured, rough_one, again = (
        abs(branch_point(some, 0.0, 1, 1)[1][-2] - exact)
        for some in (mesh, jittered(mesh, 0.1), smoothed(jittered(mesh, 0.1)))
    )
    assert again < 2 * structured < 0.1 * rough_one


def test_pinned_elimination_with_borders():
    """Against dense algebra, on a singular matrix that only its borders make regular; and the inertia."""
    rng = np.random.default_rng(0)
    size = 60
    laplacian = sparse.diags([-np.ones(size - 1), 2 * np.ones(size), -np.ones(size - 1)], [-1, 0, 1]).tolil()
    laplacian[0, -1] = laplacian[-1, 0] = -1
    matrix = (laplacian.tocsc() @ laplacian.tocsc() - 0.02 * laplacian.tocsc()).tocsc()  # a kernel and negative values
    dense = matrix.toarray()
    rows, columns = rng.standard_normal((3, size)), rng.standard_normal((size, 3))
    corner = rng.standard_normal((3, 3))
    pins = spread(np.column_stack((np.arange(size), np.zeros(size), np.zeros(size))).astype(float), 5)
    f, g = rng.standard_normal((size, 2)), rng.standard_normal((3, 2))
    pinned = Pinned.of(matrix, pins)
    found = pinned.bordered(columns, rows, corner).solve(f, g)
    whole = np.block([[dense, columns], [rows, corner]])
    np.testing.assert_allclose(found, np.linalg.solve(whole, np.vstack((f, g))), rtol=1e-9, atol=1e-9)
    allowed = np.linalg.svd(rows)[2][3:].T
    negative = int((np.linalg.eigvalsh(allowed.T @ dense @ allowed) < 0).sum())
    assert negative > 0
    assert pinned.negative(rows, np.zeros((3, 3))) == negative
    stiff = np.diag([0.0, 0.0, -1.0])  # the last row is no constraint, but a spring
    allowed = np.linalg.svd(rows[:2])[2][2:].T
    stiffened = allowed.T @ (dense + np.outer(rows[2], rows[2])) @ allowed
    assert pinned.negative(rows, stiff) == int((np.linalg.eigvalsh(stiffened) < 0).sum())


@pytest.mark.parametrize("factorize", [by_superlu, factorized])
def test_factors_of_a_matrix_that_is_near_serve_and_of_one_that_is_far_do_not(factorize, monkeypatch):
    """Along a line of matrices: the solutions are those of dense algebra, and fewer matrices are factorized."""
    size, count, made = 60, 3, []
    rng = np.random.default_rng(1)
    off = np.ones(size - 1)
    matrix = sparse.diags([-off, 3 + rng.random(size), -off], [-1, 0, 1], format="csc")
    change = sparse.diags([0 * off, rng.standard_normal(size), 0 * off], [-1, 0, 1], format="csc")
    rows, corner = rng.standard_normal((count, size)), rng.standard_normal((count, count))
    f, g = rng.standard_normal((size, 2)), rng.standard_normal((count, 2))
    monkeypatch.setattr(bordered, "factorized", lambda matrix: made.append(1) or factorize(matrix))
    kept, pins = Kept(), np.array([3, 30])
    for step in (0.0, 1e-3, 2e-2, 1.0, 1.001):
        here = (matrix + step * change).tocsc()
        found = kept.solve(here, pins, (rows.T, rows, corner), f, g)
        whole = np.block([[here.toarray(), rows.T], [rows, corner]])
        np.testing.assert_allclose(found, np.linalg.solve(whole, np.vstack((f, g))), rtol=1e-10, atol=1e-11)
    assert len(made) == (2 if factorize(matrix).dear else 5)
    other = Kept()
    other.solve(matrix, pins, (rows.T, rows, corner), f, g)
    made.clear()
    kept.solve(matrix, pins, (rows.T, rows, corner), f, g)
    assert len(made) == 1  # the other one's factors took the place of its own


@pytest.mark.parametrize("kind", KINDS)
def test_each_pair_of_a_term_has_its_place_in_the_hessian(kind):
    stencils = Functional(irregular()[0], kind).stencils
    place, rows, columns = stencils.pattern
    start, index = stencils.groups
    assert len(np.unique(np.diff(start))) > 1
    column, at = np.repeat(np.arange(stencils.mesh.count), np.diff(columns)), 0
    for low, high in pairwise(start):
        group = index[low:high]
        pairs = place[at : at + len(group) ** 2].reshape(len(group), -1)
        assert np.array_equal(np.broadcast_to(group[:, None], pairs.shape), rows[pairs])
        assert np.array_equal(np.broadcast_to(group, pairs.shape), column[pairs])
        at += len(group) ** 2
    assert at == len(place)


@pytest.mark.parametrize("kind", KINDS)
def test_the_mass_times_a_displacement_is_that_of_the_matrix(kind):
    mesh, directions = irregular()
    functional = Functional(mesh, kind)
    rate = np.random.default_rng(2).standard_normal(mesh.count)
    mass, _ = functional.normal_mass(mesh.vertices, directions)
    expected = mass @ rate
    assert (
        np.abs(functional.mass_times(mesh.vertices, directions, rate) - expected).max() < 1e-13 * np.abs(expected).max()
    )
