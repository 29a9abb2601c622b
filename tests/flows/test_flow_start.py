"""Perturbed starts of flows: one perturbation is one surface, however that is discretized."""

from functools import cache

import numpy as np
import pytest

from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.flow_start import pearl_start, pearl_tube_start
from pearlbvp.studies.mesh_flow import mesh_start

L = 10.0
ALONG, AROUND = 192, 24


@cache
def pearls(c0=0.0, length=L, m=1, v=1.1):
    return family_branch(Tube(c0, length), "pearl", (m, 0), branch_options({"v": v})).points[-1]


def seen(start, q):
    return start.problem.observables(q, start.multipliers)


def changes(start, q):
    """Of area and reduced volume, by a perturbation."""
    before, after = seen(start, start.q), seen(start, q)
    return np.array([after[name] - before[name] for name in ("area", "v")])


def derivative(values, period, axis):
    count = values.shape[axis]
    waves = 2j * np.pi * np.fft.fftfreq(count, 1 / count) / period
    waves[count // 2] = 0
    shape = [1, 1, 1]
    shape[axis] = count
    return np.fft.ifft(np.fft.fft(values, axis=axis) * waves.reshape(shape), axis=axis).real


def normals(points, x):
    """Outward normals times area elements of a parametrized tube, shape (3, ALONG, AROUND)."""
    along = derivative(points - x, L, 1) + np.array([1.0, 0, 0])[:, None, None]
    return np.cross(derivative(points, 2 * np.pi, 2), along, axis=0)


def measures(points, x):
    """Area and volume of it, by those of the straight tube (area ``2 pi L``, volume ``pi L``)."""
    weighted = normals(points, x)
    across = points[1] * weighted[1] + points[2] * weighted[2]
    return np.array([np.linalg.norm(weighted, axis=0).mean(), across.mean()])


def marked(delta):
    """Changes of area and volume by the bump, by markers that go with the surface in space, and along fixed normals."""
    start = pearl_start(pearls().problem, pearls().u, points=ALONG)
    r, phi = start.problem.radii(start.q)[:, None], 2 * np.pi * np.arange(AROUND) / AROUND
    x = np.zeros((3, ALONG, AROUND))
    x[0] = start.problem.x[:, None]
    first = x + np.array([0 * r * phi, r * np.cos(phi), r * np.sin(phi)])

    def velocity(points):
        weighted = normals(points, x)
        radius = np.hypot(points[1], points[2])
        return -delta * points[1] / radius / (1 + points[0] ** 2) * weighted / np.linalg.norm(weighted, axis=0)

    points, steps = first, 16
    for _ in range(steps):
        middle = points + velocity(points) / (2 * steps)
        points = points + velocity(middle) / steps
    before = measures(first, x)
    return measures(points, x) - before, measures(first + velocity(first), x) - before


def test_a_bump_is_the_same_on_tubes_and_meshes():
    """Against markers on the surface. To second order the normals' turning counts: a tenth of the change, no more."""
    expected, fixed = marked(-0.1)
    assert expected[1] == pytest.approx(0.000894, abs=2e-6)
    np.testing.assert_allclose(expected, fixed, rtol=0.12)
    tube = pearl_tube_start(pearls().problem, pearls().u, size=(16, 6))
    np.testing.assert_allclose(changes(tube, tube.perturbed("bump", -0.1)), expected, rtol=1e-4)
    errors = []
    for nodes in (500, 1500):
        mesh = mesh_start(pearls(), nodes)
        errors.append(np.abs(changes(mesh, mesh.perturbed("bump", -0.1)) / expected - 1))
    assert errors[1].max() < 2e-3
    assert (errors[1] < errors[0] / 2.5).all()  # the second order of the mesh's normals


def test_the_most_unstable_vector_is_centred_in_all_discretizations():
    """Four pearls in any phase: two equally unstable vectors, of which the sum is largest at x = 0."""
    point = pearls(0.48, 30.0, 4, 1.015)
    graph = pearl_start(point.problem, point.u)
    tube = pearl_tube_start(point.problem, point.u, size=(28, 2))
    mesh = mesh_start(point, 1000)
    for keep in (False, True):
        shapes = [start.perturbed("critical", 0.02, keep=keep) for start in (graph, tube)]
        one, two = (seen(start, q) for start, q in zip((graph, tube), shapes, strict=True))
        assert one["E"] == pytest.approx(two["E"], rel=1e-6)
        assert one["v"] == pytest.approx(two["v"], abs=1e-8)
    r = graph.problem.radii(graph.perturbed("critical", 0.02)) - graph.problem.radii(graph.q)
    assert r.argmax() == graph.problem.points // 2
    np.testing.assert_allclose(r[1:], r[:0:-1], atol=1e-8)
    rates, vectors = mesh.problem.growth_rates(mesh.q, mesh.multipliers)
    assert rates[0] == pytest.approx(rates[1], rel=5e-6)
    x = (mesh.problem.places(mesh.q)[0] + 15) % 30 - 15
    moved = mesh.problem.velocity(mesh.q, mesh.perturbed("critical", 0.02))
    assert abs(x[moved.argmax()]) < 1e-6
    assert moved.max() == pytest.approx(0.02, rel=1e-2)
    falls = [seen(s, s.q)["E"] - seen(s, s.perturbed("critical", 0.02, keep=True))["E"] for s in (graph, mesh)]
    assert falls[1] == pytest.approx(falls[0], rel=0.02), falls
    assert not np.allclose(vectors[:, 0], vectors[:, 1])


def test_the_straight_tube_starts_flows_in_all_discretizations():
    """Its first wave, and a bump: area and volume of a wave on a cylinder to second order, and a bump's on tube and mesh."""
    branch = family_branch(Tube(0.0, L), "pearl", (1, 0), branch_options({"v": 1.01}))
    point = branch.points[0]
    starts = [
        pearl_start(point.problem, point.u),
        pearl_tube_start(point.problem, point.u, size=(12, 5)),
        mesh_start(point, 800),
    ]
    for start, tolerance in zip(starts, (1e-6, 1e-6, 2e-3), strict=True):
        area, v = changes(start, start.perturbed("critical", 0.05))
        k = 2 * np.pi / L
        assert v == pytest.approx(0.05**2 / 2, rel=1e-3 + 2 * tolerance)
        assert area == pytest.approx((k * 0.05) ** 2 / 4, rel=5e-3)
    tube, mesh = (changes(start, start.perturbed("bump", -0.1)) for start in starts[1:])
    np.testing.assert_allclose(mesh, tube, rtol=5e-3)


@pytest.mark.parametrize("law", ["area and volume", "area", "diffusion"])
def test_kept_is_area_and_volume_by_any_law(law):
    point = pearls(0.48, 15.0, 2, 1.02)
    start = pearl_start(point.problem, point.u, law=law)
    one = seen(start, start.perturbed("critical", 0.05, keep=True))
    assert (one["area"], one["v"]) == pytest.approx((1.0, 1.02), abs=1e-10)
    same = pearl_start(point.problem, point.u)
    assert one["E"] == pytest.approx(seen(same, same.perturbed("critical", 0.05, keep=True))["E"], rel=1e-3)


@pytest.mark.parametrize("start", [pearl_start, pearl_tube_start])
def test_a_negative_width_is_refused(start):
    with pytest.raises(InputError, match="^xi: it must not be negative, .*; give"):
        start(pearls().problem, pearls().u).perturbed("bump", -0.1, xi=-1.0)
