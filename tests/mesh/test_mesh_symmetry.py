"""Symmetry of meshes, phases, and shapes projected onto meshes."""

import numpy as np
import pytest

from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.mesh.amplitudes import amplitudes
from pearlbvp.mesh.families import divisions, jittered, tube_mesh
from pearlbvp.mesh.functional import Functional
from pearlbvp.mesh.problem import about
from pearlbvp.mesh.samples import Samples
from pearlbvp.mesh.spectrum import MeshBlock
from pearlbvp.mesh.subdivision import limit_matrix
from pearlbvp.mesh.symmetry import mean, orbits
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.mesh import meshed
from pearlbvp.theory.amplitude import amplitude_equation

L = 10.0


def test_amplitudes_by_projection():
    """Of a graph with known waves; and of a pearl near its onset, against the amplitude equation."""
    k = 2 * np.pi / L

    def waves(x, phi):
        r = 1 + 2 * np.real(0.05 * np.exp(1j * (k * x + phi + 0.3)) + 0.02 * np.exp(1j * (k * x - phi)))
        return np.column_stack((x, r * np.cos(phi), r * np.sin(phi)))

    for mesh in (tube_mesh(L, 2000, waves), jittered(tube_mesh(L, 2000), 0.1, 0, waves)):
        a, b = amplitudes(mesh, 1, 1)
        assert (a, b) == pytest.approx((0.05 * np.exp(0.3j), 0.02), abs=3e-4)
    branch = family_branch(Tube(0.0, L), "pearl", (1, 0), branch_options({"v": 1.002}, step=0.02), nodes=600)
    entry = branch.points[-1]
    a, _ = amplitudes(entry.problem.surface(entry.u), 1, 0)
    predicted = amplitude_equation(Tube(0.0, L), (1, 0)).amplitude_at("pearl", entry.observables["v"])
    assert abs(a) == pytest.approx(predicted, rel=0.02)

    def folded(x, phi):
        return np.column_stack((x, 2 + np.cos(phi), np.sin(phi)))

    with pytest.raises(InputError, match="surface: triangle .* folded"):
        amplitudes(tube_mesh(L, 200, folded), 1, 1)


def test_orbits_are_those_of_the_group():
    """Sizes of the orbits by counting: of a pearl, a ring, a buckle and nothing, on 28 rows of 16 vertices."""
    rows, around = divisions(L, 450)
    mesh = tube_mesh(L, 450)
    assert (rows, around, mesh.count) == (28, 16, 448)
    x, phi = 2 * np.pi * mesh.vertices[:, 0] / L, np.arctan2(mesh.vertices[:, 2], mesh.vertices[:, 1])
    for wave, generic in (
        (np.cos(x), 2 * around),  # turns, and x to -x
        (np.cos(2 * phi), 4 * rows // 2),  # shifts by two rows, and phi to -phi, pi - phi, pi + phi
        (np.cos(x) * np.cos(phi), 8),  # x to -x, phi to -phi, (x + L/2, phi + pi)
        (np.cos(x + 0.1) + np.sin(phi + 0.2) + np.sin(2 * x - 3 * phi), 1),
    ):
        labels = orbits(mesh, wave[None])
        assert np.bincount(labels).max() == generic
        np.testing.assert_allclose(mean(labels, wave), wave, atol=1e-12)
        np.testing.assert_allclose(mean(labels, mean(labels, mesh.vertices)), mean(labels, mesh.vertices), atol=1e-12)
    assert len(np.unique(orbits(jittered(mesh), np.zeros((1, mesh.count))))) == mesh.count


def test_symmetry_splits_the_spectrum():
    """Growth rates with and without the symmetry of a buckle are the same, and the modes are what their block says."""
    point = family_branch(Tube(0.0, L), "buckle", (1, 1), branch_options({"v": 0.98})).points[-1]
    plain, u = meshed(point, 700)
    problem = plain.symmetric(u)
    apart = problem.block_modes(u, {problem.trivial_block: 6, MeshBlock("breaking"): 6})
    together, _ = apart.together()
    rates, _, unstable = plain.modes(u)
    assert apart.complete
    assert apart.unstable == unstable == 1
    np.testing.assert_allclose(together[:6], rates[:6], atol=1e-7)
    for block, vectors in apart.vectors.items():
        share = np.linalg.norm(mean(problem.orbits, vectors)) / np.linalg.norm(vectors)
        assert share == pytest.approx(1.0 if block == problem.trivial_block else 0.0, abs=1e-8)


def test_surfaces_are_projected_onto():
    """Points of a finer surface are on the coarser one's samples to third order, and mirror images stay mirror images."""

    def points(x, phi):
        r = 1 + 0.2 * np.cos(2 * np.pi * x / L)
        return np.column_stack((x, 0.5 * np.cos(2 * np.pi * x / L) + r * np.cos(phi), r * np.sin(phi)))

    errors = []
    for nodes in (400, 1600):
        mesh = tube_mesh(L, nodes, points)
        _, matrix, offsets = limit_matrix(mesh, 3)
        on_surface = matrix @ mesh.vertices
        on_surface[:, 0] += offsets
        samples = Samples.of(mesh)
        errors.append(np.abs(samples.feet(on_surface).offsets).max())
        beside, mirror = on_surface + 0.03, np.array([1, 1, -1])
        np.testing.assert_allclose(samples.project(beside * mirror), samples.project(beside) * mirror, atol=1e-13)
    assert errors[1] < errors[0] / 5 < 1e-5


def test_phases_are_those_that_move_the_surface():
    """None but translations across on the straight tube; the shift along it on a pearl; both on a buckle."""

    def surface(x, phi, wave):
        r = 1 + 0.2 * wave(2 * np.pi * x / L, phi)
        return np.column_stack((x, r * np.cos(phi), r * np.sin(phi)))

    for wave, count in (
        (lambda x, phi: 0 * x, 2),
        (lambda x, phi: np.cos(x), 3),
        (lambda x, phi: np.cos(2 * phi), 3),
        (lambda x, phi: np.cos(x - 2 * phi), 3),
        (lambda x, phi: np.cos(x) * np.cos(2 * phi), 4),
    ):
        mesh = tube_mesh(L, 600, lambda x, phi, wave=wave: surface(x, phi, wave))
        assert len(about(Functional(mesh), 0.0, np.array([0.0, 0.25, 1.0]))[0].phases) == count
