"""Triangulated tubes as branches: against pearls, coils and buckles computed otherwise, adaptation, spectra, files."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import eigh
from support.pearls import at, path

from pearlbvp.continuation.solution import Solution
from pearlbvp.errors import InputError
from pearlbvp.figures.mesh import draw_mesh
from pearlbvp.helfrich import Tube
from pearlbvp.mesh.adaptation import AdaptOptions
from pearlbvp.mesh.families import jittered, tube_mesh
from pearlbvp.mesh.files import joined, read_mesh, write_mesh
from pearlbvp.mesh.problem import MeshProblem
from pearlbvp.mesh.start import onset, solved, straight
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.mesh import branch_from, meshed
from pearlbvp.studies.onward import switched
from pearlbvp.studies.saved import load, save
from pearlbvp.theory.dispersion import growth_rate

L = 10.0
COMPARED = ("lambda1", "lambda2", "E")


@pytest.fixture(scope="module")
def pearl():
    """The paper's point A2: lambda2 = -3.165 at c0 = 0, L = 10."""
    problem, u = at(path(0.0, L, 1.2), "lambda2", -3.165)
    return problem, u


def point_of(problem, u):
    return Solution(problem, u, u)


@pytest.fixture(scope="module")
def coil():
    return family_branch(Tube(0.0, L), "coil", (1, 1), branch_options({"v": 0.95}))


@pytest.fixture(scope="module")
def mesh_coil():
    return family_branch(Tube(0.0, L), "coil", (1, 1), branch_options({"v": 0.95}), nodes=500)


def test_pearls_are_those_of_the_profile(pearl):
    """Three digits at 500 nodes, and errors that fall with the fourth power of the mesh width."""
    problem, u = pearl
    exact, rate = problem.observables(u), problem.spectrum(u).mu_crit
    errors = []
    for nodes in (500, 1000):
        found, w = meshed(point_of(problem, u), nodes)
        observables = found.observables(w)
        errors.append(max(abs(observables[name] - exact[name]) for name in COMPARED))
        assert np.abs(found.multipliers(w)).max() < 1e-10
        assert observables["v"] == pytest.approx(exact["v"], abs=1e-12)
        _, area, volume = found.functional.sums(found.vertices(w), found.directions, 0.0).values
        assert (area, volume) == pytest.approx((2 * np.pi * L, np.pi * L * exact["v"]), abs=1e-10)
        spectrum = found.spectrum(w)
        assert spectrum.complete
        assert spectrum.n_unstable == 0
        assert spectrum.mu_crit == pytest.approx(rate, rel=1e-2)
    assert errors[0] < 2e-3
    assert errors[1] < errors[0] / 3
    assert exact["lambda1"] == pytest.approx(3.734, abs=3e-3)  # the paper's, on its mesh


def test_coils_from_the_cylinder_on(coil, mesh_coil):
    """A branch on a mesh, from its discrete branch point to a volume, is the coil of reduced modes."""
    assert mesh_coil.complete, mesh_coil.reason
    exact, found = coil.points[-1], mesh_coil.points[-1]
    for name in COMPARED:
        assert found.observables[name] == pytest.approx(exact.observables[name], rel=3e-3)
    assert found.observables["r_min"] == pytest.approx(exact.observables["r_min"], abs=0.01)
    assert [entry.spectrum.n_unstable for entry in mesh_coil.points[1:]] == [0] * (len(mesh_coil.points) - 1)
    assert found.spectrum.mu_crit == pytest.approx(exact.spectrum.mu_crit, rel=0.1)
    assert all(np.abs(e.problem.multipliers(e.u)).max() < 1e-5 for e in mesh_coil.points)
    energies = [entry.observables["E"] for entry in mesh_coil.points]
    volumes = [entry.observables["v"] for entry in mesh_coil.points]
    pressures = [entry.observables["lambda2"] for entry in mesh_coil.points]
    slope = -2 * np.diff(energies) / np.diff(volumes)  # -2 d(E/A)/dv = lambda2
    np.testing.assert_allclose(slope, (np.array(pressures[1:]) + pressures[:-1]) / 2, rtol=3e-3)


def test_buckles_have_one_unstable_direction():
    """From reduced modes onto a mesh, and the same growth rate there."""
    branch = family_branch(Tube(0.0, L), "buckle", (1, 1), branch_options({"v": 0.98}))
    exact = branch.points[-1]
    problem, u = meshed(exact, 700)
    found, spectrum = problem.observables(u), problem.spectrum(u)
    for name in COMPARED:
        assert found[name] == pytest.approx(exact.observables[name], rel=1e-3)
    assert spectrum.n_unstable == exact.spectrum.n_unstable == 1
    assert spectrum.mu_crit == pytest.approx(exact.spectrum.mu_crit, abs=3e-4)
    assert len(problem.phases) == 4


def test_growth_rates_of_the_straight_tube():
    """All leading rates against the dispersion relation, with their multiplicities."""
    lambda2 = 1.6
    problem, u = straight(tube_mesh(L, 1000), 0.0, lambda2)
    rates, _, unstable = problem.modes(u, 8)
    exact = []
    for m in range(5):
        for n in range(4):
            if (m, n) not in ((0, 0), (0, 1)):
                rate = float(growth_rate(2 * np.pi * m / L, n, lambda2, 0.0))
                exact += [rate] * ((2 if m else 1) * (2 if n else 1))
    exact = np.sort(exact)[::-1]
    assert unstable == (exact > 0).sum()
    np.testing.assert_allclose(rates, exact[: len(rates)], atol=8e-3)  # of fourth order: less for longer waves
    np.testing.assert_allclose(rates[2:6], exact[2:6], atol=3e-4)


def test_leading_rates_are_those_of_dense_algebra(mesh_coil):
    """Lanczos and inertia against all eigenvalues of the projected pencil, on a deformed tube."""
    entry = mesh_coil.points[-1]
    problem, u = entry.problem, entry.u
    rates, vectors, unstable = problem.modes(u)
    vertices = problem.vertices(u)
    second, sums = problem.hessian(u), problem.functional.sums(vertices, problem.directions, 0.0)
    mass, motions = problem.functional.normal_mass(vertices, problem.directions)
    rows = np.vstack((sums.gradients[1:], motions[1:3], motions[0]))  # a coil turns where it is shifted
    allowed = np.linalg.svd(rows)[2][5:].T
    all_rates = -eigh(allowed.T @ second @ allowed, allowed.T @ (mass @ allowed), eigvals_only=True)
    assert unstable == (all_rates > 0).sum()
    np.testing.assert_allclose(rates[:6], all_rates[:6], rtol=1e-3, atol=1e-4)
    nearest = all_rates[np.abs(all_rates - rates[:, None]).argmin(axis=1)]  # few keep the symmetry, and lie far below
    np.testing.assert_allclose(rates, nearest, rtol=1e-3, atol=1e-4)
    np.testing.assert_allclose(rows[:4] @ vectors / np.linalg.norm(rows[:4], axis=1)[:, None], 0, atol=1e-9)


@pytest.mark.parametrize("kind", ["subdivision", "cotangent"])
def test_the_jacobian_is_the_residual_s(kind):
    problem, u, direction = onset(Tube(0.3, L), "buckle", 1, 1, tube_mesh(L, 150), kind)
    rng = np.random.default_rng(1)
    u = u + 0.1 * direction
    u[-3:] += 0.01 * rng.standard_normal(3)
    u[problem.mesh.count : -3] = 0.01
    step, row, h = rng.standard_normal(u.size), rng.standard_normal(u.size), 1e-6
    change = (problem.residual(u + h * step) - problem.residual(u - h * step)) / (2 * h)
    found = problem.solve(u, np.append(change, problem.inner(row, step)), row)
    np.testing.assert_allclose(found, step, atol=1e-4)


def test_refinement_as_a_whole_leaves_the_surface_alone(mesh_coil):
    """Four triangles for one of a subdivision surface: the same surface, observables and tangent."""
    entry = mesh_coil.points[-1]
    problem, u = entry.problem, entry.u
    eager = replace(problem, adapt=AdaptOptions(area=float(problem.mesh.areas.mean()), largest=0.5))
    finer, (moved, tangent) = eager.remesh(u, entry.tangent)
    assert finer.mesh.count == 4 * problem.mesh.count
    before, after = problem.observables(u), finer.observables(moved)
    assert after["E"] == pytest.approx(before["E"], abs=2e-4)  # finer quadrature of the same surface
    assert problem.inner(entry.tangent, entry.tangent) == pytest.approx(finer.inner(tangent, tangent), rel=0.1)
    at_home = solved(finer, moved)
    assert np.abs(at_home[: finer.mesh.count]).max() < 5e-3
    back = problem.transfer(finer, at_home)
    np.testing.assert_allclose(back[: problem.mesh.count], u[: problem.mesh.count], atol=0.01)


def test_adaptation_by_edits(pearl):
    """Splits, collapses and flips of a pearl's mesh: all valid, on the surface, and the equilibrium is as near as before."""
    spectral, w = pearl
    exact = spectral.observables(w)
    problem, u = meshed(point_of(spectral, w), 700, kind="cotangent")
    options = AdaptOptions(area=float(2 * np.pi * L / len(problem.mesh.triangles)), largest=1.5, worst=5.0)
    changed, (moved, tangent) = replace(problem, adapt=options).remesh(u, np.ones_like(u))
    surface = changed.surface(moved)
    assert changed.mesh.count != problem.mesh.count
    assert set(np.diff(changed.mesh.star[0])) != {6}
    assert surface.areas.max() < 1.6 * options.area < problem.surface(u).areas.max()
    assert np.abs(tangent[: changed.mesh.count] - 1).max() < 0.2
    at_home = solved(changed, moved)
    found = changed.observables(at_home)
    for name in COMPARED:
        assert found[name] == pytest.approx(exact[name], rel=0.05)
    assert changed.remesh(at_home) is None  # not adapted again at every point


def test_branches_go_on_through_adaptation():
    """Pearls with cotangents, the mesh edited on the way: the branch stays that of the profile, to the mesh's accuracy."""
    branch = family_branch(Tube(0.0, L), "pearl", (1, 0), branch_options({"v": 1.05}), adapt=AdaptOptions(largest=1.3, worst=8.0), nodes=700, discretization="cotangent")  # fmt: skip
    assert branch.complete, branch.reason
    assert len({entry.problem.mesh.count for entry in branch.points}) > 1
    assert [entry.spectrum.n_unstable for entry in branch.points[1:]] == [0] * (len(branch.points) - 1)
    spectral, w = at(path(0.0, L, 1.2), "v", 1.05)
    for name in COMPARED:
        assert branch.points[-1].observables[name] == pytest.approx(spectral.observables(w)[name], rel=0.03)


def test_branches_go_on_from_a_meshed_shape(pearl):
    """Both ways from a computed pearl, against the profile's branch at another volume."""
    problem, u = meshed(point_of(*pearl), 500)
    for v, upwards in ((1.2, True), (1.18, False)):
        branch = branch_from(problem, u, branch_options({"v": v}), upwards=upwards)
        assert branch.complete, branch.reason
        spectral, w = at(path(0.0, L, 1.2), "v", v)
        for name in COMPARED:
            assert branch.points[-1].observables[name] == pytest.approx(spectral.observables(w)[name], rel=1e-3)


def test_switching_to_modulated_rings(tmp_path):
    """Where rings become unstable to waves along the tube, shapes branch off that no other family has.

    They leave in twos, shifted along the tube; the branch has a phase condition against that, keeps
    ``-2 d(E/A)/dv = lambda2``, and lies below the rings.
    """
    rings = family_branch(Tube(0.0, L), "ring", (0, 2), branch_options({"v": 0.948}), nodes=400)
    place = rings.find("bp")[0].index
    assert [special.converged for special in rings.find("bp")] == [True, True]
    assert rings.points[-1].spectrum.n_unstable == rings.points[place - 1].spectrum.n_unstable + 2
    save(rings, tmp_path / "rings.h5")
    from_file = load(tmp_path / "rings.h5")
    assert from_file.find("bp") == rings.find("bp")  # their symmetry blocks, too
    branch = switched(from_file, 1, branch_options(max_points=5, step=0.05))
    assert len(branch.points) >= 4, branch.reason
    last = branch.points[-1]
    assert np.ptp(centres_radius(last)) > 0.02
    assert np.abs(last.problem.multipliers(last.u)).max() < 1e-5
    v, energy, pressure = (np.array([e.observables[name] for e in branch.points]) for name in ("v", "E", "lambda2"))
    slope = -2 * np.diff(energy[1:]) / np.diff(v[1:])  # the first step leads to another reference, with another error
    np.testing.assert_allclose(slope, (pressure[2:] + pressure[1:-1]) / 2, rtol=3e-3)
    at_end = rings.points[-1]
    gaps = [at_volume(at_end, volume)["lambda2"] for volume in v[1:]] - pressure[1:]
    assert (np.diff(v[1:]) < 0).all()
    assert (np.diff(gaps) > 0).all()  # so the energy falls below that of the rings as v does


def at_volume(point, v):
    """Observables at another volume of the same branch."""
    start = point.u.copy()
    start[-1] = v
    return point.problem.observables(solved(point.problem, start))


def centres_radius(point):
    """Largest distance from the axis in the rows along the tube."""
    vertices = point.problem.points(point.u)
    rows = np.round(point.problem.mesh.vertices[:, 0] * 2).astype(int)
    return [np.hypot(vertices[rows == row, 1], vertices[rows == row, 2]).max() for row in np.unique(rows)]


def test_saved_branches_come_back(mesh_coil, tmp_path):
    save(mesh_coil, tmp_path / "coil.h5")
    back = load(tmp_path / "coil.h5")
    assert back.table().equals(mesh_coil.table())
    first, again = mesh_coil.points[-1], back.points[-1]
    np.testing.assert_array_equal(again.problem.residual(again.u), first.problem.residual(first.u))
    assert again.problem.adapt == first.problem.adapt
    with pytest.raises(InputError, match="path: there is no file"):
        load(tmp_path / "none.h5")


@pytest.mark.parametrize("ending", ["vtu", "ply", "obj"])
def test_files(ending, tmp_path):
    mesh = jittered(tube_mesh(L, 200), 0.1)
    where = tmp_path / f"tube.{ending}"
    write_mesh(mesh, where, {"height": mesh.vertices[:, 2]})
    back = read_mesh(where, L)
    assert back.count == mesh.count
    assert (back.area, back.volume) == pytest.approx((mesh.area, mesh.volume), rel=1e-6)
    with pytest.raises(InputError, match="length: no two points of the file lie 9 apart"):
        read_mesh(where, 0.9 * L)
    with pytest.raises(InputError, match="length"):
        read_mesh(where, -1)
    where.write_text("no mesh at all")
    with pytest.raises(InputError, match="path: .*tube"):
        read_mesh(where, L)
    where.write_text("ply\nformat ascii 1.0\n")  # a header without an end
    with pytest.raises(InputError, match="path: .*tube"):
        read_mesh(where, L)


def test_files_that_cannot_be(tmp_path):
    mesh = tube_mesh(L, 100)
    with pytest.raises(InputError, match=r"out: tube.stl has none of the endings"):
        write_mesh(mesh, tmp_path / "tube.stl")
    with pytest.raises(InputError, match="path: there is no file"):
        read_mesh(tmp_path / "none.vtu", L)
    with pytest.raises(InputError, match="triangles: a corner is none"):
        joined(mesh.vertices, np.array([[0, 1, 1000]]), L)


def test_arguments_that_cannot_be_used():
    with pytest.raises(InputError, match="family: 'worm'"):
        family_branch(Tube(0.0, L), "worm", (1, 1), nodes=100)
    with pytest.raises(InputError, match=r"mode: \(1, 1\) is none of a pearl"):
        family_branch(Tube(0.0, L), "pearl", (1, 1), nodes=100)
    with pytest.raises(InputError, match="nodes"):
        family_branch(Tube(0.0, L), "pearl", (1, 0), nodes=3)
    with pytest.raises(InputError, match="mode: .* shorter than two edges"):
        family_branch(Tube(0.0, L), "ring", (0, 9), nodes=100)


def test_pictures(mesh_coil, tmp_path):
    entry = mesh_coil.points[-1]
    figure = draw_mesh(entry.problem.surface(entry.u), title="coil")
    figure.savefig(tmp_path / "coil.png")
    assert (tmp_path / "coil.png").stat().st_size > 20_000


@pytest.mark.parametrize("family", ["coil", "buckle"])
def test_adaptation_leaves_no_jump(family):
    """Where vertices spread out, the branch goes on to the mesh's accuracy: it is the surface that counts."""
    branch = family_branch(Tube(0.0, L), family, (1, 1), branch_options({"v": 0.9}), nodes=500)
    assert branch.complete, branch.reason
    points = [entry for entry in branch.points]
    changes = [p for p, q in pairwise(points) if p.problem is not q.problem and q.problem.orbits is not None]
    assert changes
    for point in points[1:]:
        exact = (
            family_branch(
                Tube(0.0, L), family, (1, 1), branch_options({"v": point.observables["v"]}), discretization="modes"
            )
            .points[-1]
            .observables
        )
        for name in COMPARED:
            assert point.observables[name] == pytest.approx(exact[name], rel=8e-3), point.observables["v"]


@pytest.mark.parametrize("kind", ["subdivision", "cotangent"])
@pytest.mark.parametrize("where", ["between its branch points", "at one"])
def test_a_straight_tube_is_remeshed_without_a_search_for_an_equilibrium_of_the_same_volume(kind, where, monkeypatch):
    """All straight tubes have v = 1: the matrix is singular there. The new mesh is on the cylinder, and its equilibrium near."""
    mesh = tube_mesh(L, 200)
    problem, u = (
        straight(mesh, 0.0, -1.0, kind) if "between" in where else onset(Tube(0.0, L), "pearl", 1, 0, mesh, kind)[:2]
    )
    options = AdaptOptions(area=float(mesh.areas.mean()), largest=0.5)
    solves = []
    monkeypatch.setattr(MeshProblem, "solve", lambda *arguments: solves.append(arguments))
    finer, (moved,) = replace(problem, adapt=options).remesh(u)
    monkeypatch.undo()
    assert (len(solves), finer.mesh.count > mesh.count) == (0, True)
    radii = np.hypot(*finer.points(moved)[:, 1:].T)
    assert np.ptp(radii) < 5e-3
    assert radii.mean() == pytest.approx(1, abs=0.02)
    if kind == "subdivision" and "between" in where:
        assert np.abs(solved(finer, moved, "lambda2")[: finer.mesh.count]).max() < 0.01


def test_bent_tubes_are_corrected_on_a_new_mesh(mesh_coil):
    """The same remeshing of a coil does solve: its volume tells it from its neighbours."""
    entry = mesh_coil.points[-1]
    eager = replace(entry.problem, adapt=AdaptOptions(area=float(entry.problem.mesh.areas.mean()), largest=0.5))
    finer, (moved,) = eager.remesh(entry.u)
    assert np.abs(finer.residual(moved)).max() < 1e-8
