"""Periodic meshes and their operators: closed forms, libigl, invariances, and every kind of broken mesh."""

from dataclasses import replace

import igl
import numpy as np
import pytest

from pearlbvp.errors import InputError
from pearlbvp.mesh.families import divisions, jittered, tube_mesh
from pearlbvp.mesh.operators import (
    area_gradient,
    barycentric_mass,
    gaussian_curvature,
    mean_curvature,
    stiffness,
    vertex_normals,
    volume_gradient,
    voronoi_mass,
)
from pearlbvp.mesh.periodic import PeriodicMesh

L = 10.0


def bent(nodes=400, seed=0):
    """A tube that no symmetry helps: bent, bulged and jittered."""

    def surface(x, phi):
        k = 2 * np.pi / L
        r = 1 + 0.2 * np.cos(k * x) + 0.1 * np.cos(2 * phi + 1)
        return np.column_stack((x, 0.4 * np.sin(k * x) + r * np.cos(phi), 0.3 * np.cos(k * x) + r * np.sin(phi)))

    return jittered(tube_mesh(L, nodes), 0.1, seed, surface)


@pytest.mark.parametrize("nodes", [60, 500, 3000])
def test_structured_meshes_are_near_the_best_quality(nodes):
    mesh = tube_mesh(L, nodes)
    assert abs(mesh.count / nodes - 1) <= 0.1
    assert 2 * np.sqrt(3) <= mesh.quality.max() < 3.9


def test_area_and_volume_of_prisms():
    """The structured tube's slanted triangles are known in closed form."""
    rows, around = divisions(L, 200)
    mesh = tube_mesh(L, 200)
    chord, sagitta = 2 * np.sin(np.pi / around), 1 - np.cos(np.pi / around)
    height = np.hypot(L / rows, sagitta)
    assert mesh.area == pytest.approx(rows * around * chord * height, rel=1e-13)
    # Between two turned polygons lies an antiprism: Simpson's rule, with the middles of the slanted edges halfway.
    ends = around * chord * np.cos(np.pi / around) / 2
    corners = np.exp(2j * np.pi * np.arange(2 * around) / (2 * around))
    sides = (corners + np.roll(corners, -1)) / 2
    middle = 0.5 * np.abs(np.sum(np.conj(sides) * np.roll(sides, -1)).imag)
    assert mesh.volume == pytest.approx(L * (2 * ends + 4 * middle) / 6, rel=1e-13)


def test_the_seam_is_nowhere():
    """Shifted representatives and a rolled origin change no operator."""
    mesh = bent()
    rng = np.random.default_rng(3)
    periods = rng.integers(-2, 3, mesh.count)
    vertices = mesh.vertices + np.outer(periods, [L, 0, 0]) + [0.37 * L, 0, 0]
    other = replace(mesh, vertices=vertices, wraps=mesh.wraps - periods[mesh.triangles])
    assert other.volume == pytest.approx(mesh.volume, rel=1e-13)
    np.testing.assert_allclose(mean_curvature(other), mean_curvature(mesh), atol=1e-10)
    np.testing.assert_allclose(other.reduced().area, mesh.area, rtol=1e-13)
    assert 0 <= other.reduced().vertices[:, 0].min() <= other.reduced().vertices[:, 0].max() < L
    assert abs(stiffness(other) - stiffness(mesh)).max() < 1e-10


def test_the_ends_of_a_period_are_not_torn():
    """Rows of vertices a little to both sides of ``x = 0``: all triangles end there."""
    mesh = tube_mesh(L, 400)
    aside = 0.02 * np.random.default_rng(0).uniform(-1, 1, mesh.count)
    periods = np.random.default_rng(1).integers(-2, 3, mesh.count)
    vertices = mesh.vertices + np.outer(aside + L * periods, [1, 0, 0])
    shaken = replace(mesh, vertices=vertices, wraps=mesh.wraps - periods[mesh.triangles])
    x = shaken.reduced().corners[..., 0]
    assert -0.02 <= x.min() < 0
    assert L < x.max() <= L + 0.02
    assert shaken.reduced().volume == pytest.approx(shaken.volume, rel=1e-12)


def test_operators_are_those_of_libigl():
    mesh = bent()
    lengths = mesh.edge_lengths[:, [1, 2, 0]]  # libigl: opposite to each corner
    theirs = igl.cotmatrix_intrinsic(lengths, mesh.triangles)
    assert abs(stiffness(mesh) + theirs).max() < 1e-10
    for ours, kind in (
        (voronoi_mass, igl.MASSMATRIX_TYPE_VORONOI),
        (barycentric_mass, igl.MASSMATRIX_TYPE_BARYCENTRIC),
    ):
        theirs = igl.massmatrix_intrinsic(lengths, mesh.triangles, kind)
        np.testing.assert_allclose(ours(mesh), theirs.diagonal(), rtol=1e-10)
    # normals on a mesh cut open: vertices away from the cut
    inside = (mesh.wraps == 0).all(axis=1)
    theirs = igl.per_vertex_normals(mesh.vertices, mesh.triangles[inside], igl.PER_VERTEX_NORMALS_WEIGHTING_TYPE_AREA)
    whole = np.setdiff1d(np.arange(mesh.count), mesh.triangles[~inside])
    np.testing.assert_allclose(vertex_normals(mesh)[whole], theirs[whole], atol=1e-12)


def test_gradients_of_area_and_volume_by_vertices():
    mesh = bent(120)
    step = np.random.default_rng(1).standard_normal((mesh.count, 3))
    h = 1e-6
    ahead, behind = mesh.moved(mesh.vertices + h * step), mesh.moved(mesh.vertices - h * step)
    assert (ahead.area - behind.area) / (2 * h) == pytest.approx((area_gradient(mesh) * step).sum(), abs=1e-7)
    assert (ahead.volume - behind.volume) / (2 * h) == pytest.approx((volume_gradient(mesh) * step).sum(), abs=1e-7)
    np.testing.assert_allclose(stiffness(mesh) @ mesh.vertices[:, 1:], area_gradient(mesh)[:, 1:], atol=1e-12)


def test_gauss_bonnet():
    mesh = bent()
    assert (gaussian_curvature(mesh) * voronoi_mass(mesh)).sum() == pytest.approx(0, abs=1e-10)


def test_curvatures_converge_with_the_mesh_width_squared():
    """On a pearled tube whose curvatures are known."""
    k, a = 2 * np.pi / L, 0.2

    def surface(x, phi):
        r = 1 + a * np.cos(k * x)
        return np.column_stack((x, r * np.cos(phi), r * np.sin(phi)))

    errors = []
    for nodes in (600, 2400):
        mesh = tube_mesh(L, nodes, surface)
        x = mesh.vertices[:, 0]
        r, r1, r2 = 1 + a * np.cos(k * x), -a * k * np.sin(k * x), -a * k**2 * np.cos(k * x)
        root = np.sqrt(1 + r1**2)
        around, along = 1 / (r * root), -r2 / root**3
        errors.append(
            (
                np.abs(mean_curvature(mesh) - (around + along) / 2).max(),
                np.abs(gaussian_curvature(mesh) - around * along).max(),
            )
        )
    orders = np.log(np.array(errors[0]) / errors[1]) / np.log(2)
    assert (orders > 1.8).all(), orders


def broken(change):
    mesh = tube_mesh(L, 100)
    arrays = {
        "vertices": mesh.vertices.copy(),
        "triangles": mesh.triangles.copy(),
        "wraps": mesh.wraps.copy(),
        "length": L,
    }
    change(arrays)
    return arrays


def _turn_one(a):
    a["triangles"][5], a["wraps"][5] = a["triangles"][5, ::-1].copy(), a["wraps"][5, ::-1].copy()


def _turn_all(a):
    a["triangles"], a["wraps"] = a["triangles"][:, ::-1], a["wraps"][:, ::-1]


def _hole(a):
    a["triangles"], a["wraps"] = a["triangles"][1:], a["wraps"][1:]


def _sliver(a):
    i, j, k = a["triangles"][7]
    a["vertices"][i] = (a["vertices"][j] + a["vertices"][k]) / 2


def _not_finite(a):
    a["vertices"][3, 1] = np.nan


def _isolated(a):
    a["vertices"] = np.vstack((a["vertices"], [0, 0, 0]))


def _beyond(a):
    a["triangles"][2, 1] = 10**6


def _period(a):
    a["length"] = 2 * L


def _no_period(a):
    a["length"] = -1.0


def _closed(a):
    a["wraps"] = 0 * a["wraps"]


def _part_of_the_period(part):
    def change(a):
        """Half or a third of the period, with the wraps that go with it: edges cross as many periods as there are."""
        periods = np.floor(part * a["vertices"][:, 0] / L).astype(int)
        a["wraps"] = part * a["wraps"] + periods[a["triangles"]]
        a["vertices"] = a["vertices"] - np.outer(periods, [L / part, 0, 0])
        a["length"] = L / part

    return change


def _two_tubes(a):
    count = len(a["vertices"])
    a["vertices"] = np.vstack((a["vertices"], a["vertices"] + [0, 5, 0]))
    a["triangles"] = np.vstack((a["triangles"], np.roll(a["triangles"] + count, 1, axis=1)))
    a["wraps"] = np.vstack((a["wraps"], np.roll(a["wraps"], 1, axis=1)))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (_turn_one, "triangles: the edge from vertex .* runs the same way"),
        (_turn_all, "clockwise from outside"),
        (_hole, "triangles: the edge from vertex .* no second triangle"),
        (_sliver, "vertices: triangle .* sliver"),
        (_not_finite, "vertices: vertex 3 .* not finite"),
        (_isolated, "vertices: vertex .* belongs to no triangle"),
        (_beyond, "triangles: triangle 2 has corners"),
        (_period, "length: the edge from vertex .* spans"),
        (_no_period, "length: the period -1"),
        (_closed, "wraps: no loop"),
        (_part_of_the_period(2), "length: .* closes only after 2 periods of 5; give 10"),
        (_part_of_the_period(3), "length: .* closes only after 3 periods of 3.33333; give 10"),
        (_two_tubes, "vertices: vertex .* cannot be reached"),
    ],
)
def test_broken_meshes_are_named(change, words):
    with pytest.raises(InputError, match=words) as caught:
        PeriodicMesh(**broken(change))
    assert "\n" not in str(caught.value)
