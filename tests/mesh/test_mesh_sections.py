"""Centres of sections and radii on meshes: known surfaces, finer polyhedra, coils and buckles in reduced modes."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from pearlbvp.figures.surface import faces_of
from pearlbvp.helfrich import Tube
from pearlbvp.mesh.families import graded, jittered, tube_mesh
from pearlbvp.mesh.functional import Functional
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.sections import centres, distances, radii
from pearlbvp.mesh.subdivision import limit_matrix
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.mesh import meshed

L = 10.0
K = 2 * np.pi / L


def circles(bend, bulge):
    """Circular sections of radius ``1 + bulge cos(kx)`` about a helix of radius ``bend``."""

    def surface(x, phi):
        r = 1 + bulge * np.cos(K * x)
        return np.column_stack((x, bend * np.sin(K * x) + r * np.cos(phi), bend * np.cos(K * x) + r * np.sin(phi)))

    return surface


def through(mesh, kind="subdivision"):
    """A discretization, and vertices whose surface passes near those of a mesh."""
    functional = Functional(mesh, kind)
    return functional, functional.vertices_near(mesh.vertices)


def test_centres_and_radii_of_circles():
    mesh = tube_mesh(L, 3000, circles(0.5, 0.0))
    x = np.array([0.1, 3.3, 9.9])
    np.testing.assert_allclose(centres(mesh, x), 0.5 * np.column_stack((np.sin(K * x), np.cos(K * x))), atol=3e-3)
    assert radii(*through(mesh, "cotangent")) == pytest.approx((1, 1), abs=3e-3)
    assert radii(*through(mesh)) == pytest.approx((1, 1), abs=1e-5)


def test_pictures_show_a_period_between_planes():
    """Whole, plane at both ends, and oriented as the mesh is: area and volume are the polyhedron's, whatever is cut."""
    mesh = jittered(tube_mesh(L, 400), 0.1, 0, circles(1.5, 0.3))
    mesh = replace(mesh, vertices=mesh.vertices + np.array([0.3, 0, 0]))
    corners = faces_of(mesh)
    assert (corners[..., 0].min(), corners[..., 0].max()) == pytest.approx((0, L), abs=1e-14)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    assert np.linalg.norm(normals, axis=1).sum() == pytest.approx(mesh.area, rel=1e-12)
    assert (corners.mean(axis=1)[:, 1:] * normals[:, 1:]).sum() / 2 == pytest.approx(mesh.volume, rel=1e-12)
    ends = np.isclose(corners[..., 0], L, atol=1e-12)
    assert (ends.sum(axis=1) == 2).sum() > 15  # triangles with an edge in the plane: the whole circle
    rim = corners[ends][:, 1:] - centres(mesh, np.array([L - 1e-9]))
    assert np.hypot(*rim.T) == pytest.approx(1.3, abs=0.05)


@pytest.mark.parametrize("bend", [0.0, 2.0])
def test_a_thin_neck_on_a_bent_tube(bend):
    """The centre is that of the sections there, too, which are a hundredth of the largest in area."""
    errors = []
    for nodes in (1500, 3000):
        straight = graded(tube_mesh(L, nodes), 2.0)
        x, phi = straight.vertices[:, 0], np.arctan2(straight.vertices[:, 2], straight.vertices[:, 1])
        mesh = straight.moved(circles(bend, 0.8)(x, phi))
        errors.append(np.abs(np.subtract(radii(*through(mesh)), (0.2, 1.8))))
    assert (errors[1] < (2e-3, 5e-4)).all(), errors
    assert (errors[1] < 0.4 * errors[0] + 1e-6).all(), errors  # fourth order: a quarter


def test_radii_are_those_of_a_finer_polyhedron():
    """Of a tube that no symmetry helps: its limit surface cut into planes at 64 triangles for one, and no parabola."""

    def surface(x, phi):
        r = 1 + 0.2 * np.cos(K * x) + 0.1 * np.cos(2 * phi + 1) + 0.05 * np.cos(3 * phi - K * x)
        return np.column_stack((x, 0.4 * np.sin(K * x) + r * np.cos(phi), 0.3 * np.cos(K * x) + r * np.sin(phi)))

    functional, vertices = through(jittered(tube_mesh(L, 600), 0.05, 0, surface))
    fine, matrix, offsets = limit_matrix(functional.mesh, 3)
    points = matrix @ vertices
    points[:, 0] += offsets
    found = distances(PeriodicMesh(points, fine.triangles, fine.wraps, L))
    assert radii(functional, vertices) == pytest.approx((found.min(), found.max()), abs=3e-4)
    coarse = distances(functional.mesh.moved(functional.points(vertices)))
    assert abs(coarse.max() - found.max()) > 3e-3  # what vertices and planes of the mesh itself say


def of_sections(point, places):
    """Least and largest radius of a shape in reduced modes about the centroids of sections, by points close together."""

    def extremes(x):
        y, z = (part[:-1] for part in point.problem.section(point.u, float(x), 801))
        y1, z1 = np.roll(y, -1), np.roll(z, -1)
        twice = y * z1 - y1 * z
        centre = ((y + y1) * twice).sum() / (3 * twice.sum()), ((z + z1) * twice).sum() / (3 * twice.sum())
        r = np.hypot(y - centre[0], z - centre[1])
        return np.array([r.min(), r.max()])

    known, found = np.array([extremes(x) for x in places]), []
    for which, sign in ((0, 1), (1, -1)):
        best, width = places[(sign * known[:, which]).argmin()], places[-1] / (len(places) - 1 or 1)
        around = (best - width, best + width)
        found.append(minimize_scalar(lambda x: sign * extremes(x)[which], bounds=around, method="bounded"))  # noqa: B023
    return found[0].fun, -found[1].fun


@pytest.fixture(scope="module", params=["coil", "buckle"])
def exact(request):
    """A shape in reduced modes, and what is to be found on meshes: amplitudes about centroids."""
    end = family_branch(
        Tube(0.0, L), request.param, (1, 1), branch_options({"v": 0.95}), discretization="modes"
    ).points[-1]
    thin, thick = of_sections(end, [0.0] if request.param == "coil" else np.linspace(0, L / 2, 21))
    radial = {"r_min": thin, "r_max": thick, "amplitude": (thick - thin) / 2}
    return request.param, end, end.observables | radial | {"mu_crit": end.spectrum.mu_crit}


def test_radii_of_equilibria_are_of_fourth_order(exact):
    """Not of those of the table of reduced modes: these are about where the radius has no first wave, 3e-5 away."""
    _, point, known = exact
    names, errors, counts = ("r_min", "r_max", "amplitude"), [], []
    for nodes in (500, 1000):
        problem, u = meshed(point, nodes)
        found = problem.observables(u)
        assert found["amplitude"] == (found["r_max"] - found["r_min"]) / 2
        errors.append(np.array([abs(found[name] - known[name]) for name in names]))
        counts.append(problem.mesh.count)
    orders = np.log(errors[0] / errors[1]) / np.log(counts[1] / counts[0]) * 2
    assert (orders > 3.5).all(), (errors, orders)
    assert (errors[1] < 1.5e-4).all(), errors


def test_the_docs_say_how_accurate_meshes_are(exact):
    """Its table's rows of 500 and 1,000 nodes (3,000 take longer): errors to the digits that stand there."""
    shape, point, known = exact
    text = (Path(__file__).parents[2] / "docs/meshes.md").read_text()
    rows = re.findall(rf"^\| (500|1000) (subdivision|cotangent) \| {shape} \| (.*) \|$", text, re.MULTILINE)
    assert len(rows) == 4
    for nodes, kind, numbers in rows:
        problem, u = meshed(point, int(nodes), kind=kind)
        found, spectrum = problem.observables(u), problem.spectrum(u)
        errors = [abs(found[name] / known[name] - 1) for name in ("lambda1", "lambda2", "E", "amplitude")]
        errors += [spectrum.mu_crit - known["mu_crit"], spectrum.residual]
        assert [float(word) for word in numbers.split(" | ")] == pytest.approx(errors, rel=0.06), (nodes, kind)
