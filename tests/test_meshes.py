"""Meshes by public names: their examples, what they agree with, and what is said of mistakes at their doors."""

import doctest
import importlib
import pickle

import numpy as np
import pytest

import pearlbvp as pb
from pearlbvp.continuation.branch import Status
from pearlbvp.mesh import periodic

meshes = pb.meshes


@pytest.mark.parametrize("module", ["meshes", "mesh.families", "mesh.operators", "mesh.adaptation"])
def test_examples_are_true(module):
    failed, tried = doctest.testmod(importlib.import_module(f"pearlbvp.{module}"))
    assert failed == 0 < tried


@pytest.fixture(scope="module")
def mesh():
    return meshes.tube_mesh(10, 300)


@pytest.fixture(scope="module")
def coil():
    return pb.branch(pb.Tube(0, 10), "coil", until={"v": 0.99})[-1]


def test_every_public_name_is_there():
    assert all(getattr(meshes, name) is not None for name in meshes.__all__)


def test_a_branch_point_is_a_straight_tube_on_which_the_mode_is_neutral(mesh):
    """Kept orthogonal to the mode, it is regular: along its branch, that of the straight tubes, the volume is all but constant."""
    found = meshes.branch_point(mesh, 0.0, (1, 1))
    exact = float(pb.theory.critical_lambda2(2 * np.pi / 10, 1, 0.0))
    assert found.observables["lambda2"] == pytest.approx(exact, abs=1e-2)
    assert found.observables["amplitude"] < 1e-3
    assert found.slopes["lambda1"] / found.slopes["lambda2"] == pytest.approx(
        -1, abs=1e-2
    )  # lambda1 + lambda2 is constant
    assert abs(found.slopes["v"] / found.slopes["lambda2"]) < 1e-3


def test_a_coil_on_a_mesh_has_one_wave_of_its_amplitude(coil):
    """That which the amplitude equation predicts, whose relative error is of the square of it."""
    on_mesh = coil.meshed(600)
    waves = np.abs(meshes.amplitudes(on_mesh, (1, 1)))
    predicted = pb.theory.amplitude_equation(pb.Tube(0, 10), (1, 1)).amplitude_at("coil", 0.99)
    assert waves.max() / predicted == pytest.approx(1, abs=predicted**2)
    assert waves.min() < 1e-3 * waves.max()
    assert np.abs(meshes.amplitudes(on_mesh.surface(), (1, 1))).max() == pytest.approx(
        waves.max(), rel=2e-2
    )  # a polyhedron


def test_a_mesh_is_read_in_the_unit_that_it_was_written_in(mesh, tmp_path, capsys):
    units = pb.Units.of(radius="50 nm")
    meshes.write(mesh, tmp_path / "t.obj", units)
    again = meshes.read(tmp_path / "t.obj", 10, units)
    assert (again.count, again.area) == (mesh.count, pytest.approx(mesh.area, rel=1e-9))
    assert capsys.readouterr().err == ""
    with pytest.raises(pb.InputError, match=r"^(length|radius): "):
        meshes.read(tmp_path / "t.obj", 10)  # a tube of 50 radii


def test_what_was_repaired_is_said(mesh, tmp_path, capsys):
    meshes.write(mesh, tmp_path / "t.obj")
    lines = (tmp_path / "t.obj").read_text().splitlines()
    turned = [line if line[:2] != "f " else "f " + " ".join(reversed(line[2:].split())) for line in lines]
    (tmp_path / "t.obj").write_text("\n".join(turned))
    assert meshes.read(tmp_path / "t.obj", 10).volume > 0
    assert capsys.readouterr().err == "pearlbvp: t.obj: turned all faces outwards\n"


MISTAKES = {
    "length: 'x' is not a number": lambda m, c: meshes.tube_mesh("x", 300),
    "nodes: 'x' must be a whole number": lambda m, c: meshes.tube_mesh(10, "x"),
    "surface: str must be a function": lambda m, c: meshes.tube_mesh(10, 300, "x"),
    "surface: it returns an array of shape .. for 312 points": lambda m, c: meshes.tube_mesh(10, 300, lambda x, phi: 1),
    "mesh: int must be a triangulated tube": lambda m, c: meshes.graded(5),
    "ratio: 0 must be positive": lambda m, c: meshes.graded(m, 0),
    "sweep: 'x' is not a number": lambda m, c: meshes.graded(m, 2, "x"),
    "amount: nan is not finite": lambda m, c: meshes.jittered(m, float("nan")),
    "seed: -1 must be a whole number": lambda m, c: meshes.jittered(m, 0.1, -1),
    "mesh: NoneType must be": lambda m, c: meshes.edited(None),
    "options: int must be AdaptOptions": lambda m, c: meshes.edited(m, 5),
    "mesh: str must be": lambda m, c: meshes.smoothed("a"),
    "steps: -1 must be a whole number": lambda m, c: meshes.smoothed(m, -1),
    "mesh: float must be": lambda m, c: meshes.straightened(1.0),
    "surface: NoneType must be a function": lambda m, c: meshes.mapped(m, None),
    "mesh: list must be": lambda m, c: meshes.subdivided([]),
    "mode: .0,1. is no bifurcation": lambda m, c: meshes.branch_point(m, 0, (0, 1)),
    "mode: .40, 0. has waves shorter than two edges": lambda m, c: meshes.branch_point(m, 0, (40, 0)),
    "mode: 3 must be two whole numbers": lambda m, c: meshes.branch_point(m, 0, 3),
    "c0: 'x' is not a number": lambda m, c: meshes.branch_point(m, "x", (1, 0)),
    "discretization: 'modes' is unknown": lambda m, c: meshes.branch_point(m, 0, (1, 0), "modes"),
    "mesh: tuple must be": lambda m, c: meshes.mean_curvature(()),
    "mesh: dict must be": lambda m, c: meshes.gaussian_curvature({}),
    "shape: Solution must be a mesh, or a solution on one": lambda m, c: meshes.amplitudes(c, (1, 1)),
    "mode: 1 must be two whole numbers": lambda m, c: meshes.amplitudes(m, 1),
    "mesh: set must be": lambda m, c: meshes.table(set()),
    "path: there is no file": lambda m, c: meshes.read("none.obj", 10),
    "path: 5 is no name of a file": lambda m, c: meshes.read(5, 10),
    "path: b.xyz has none of the endings": lambda m, c: meshes.read("b.xyz", 10),
    "length: 'y' is not a number": lambda m, c: meshes.read("none.obj", "y"),
    "path: x.foo has none of the endings": lambda m, c: meshes.write(m, "x.foo"),
    "mesh: bytes must be": lambda m, c: meshes.write(b"", "x.obj"),
    "c0: 'a' is not a number": lambda m, c: meshes.write(m, "x.fe", c0="a"),
    "values: an array of shape .2,. is none": lambda m, c: meshes.plot(m, [1, 2]),
    "values: 'x' is no number": lambda m, c: meshes.plot(m, "x"),
    "mesh: complex must be": lambda m, c: meshes.plot(1j),
}


@pytest.mark.parametrize("said", MISTAKES)
def test_mistakes_are_one_line(mesh, coil, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(pb.InputError, match=f"^{said}") as refused:
        MISTAKES[said](mesh, coil)
    assert "\n" not in str(refused.value)


def test_a_branch_on_triangles_goes_to_another_process_and_back(coil):
    """Factors of matrices that solutions keep do not, so that what is computed there is what is computed here."""
    branch = pb.Branch.through(coil.meshed(300), {"v": 0.985}, down=True)
    there = pickle.loads(pickle.dumps(branch))
    assert there[-1].observables == branch[-1].observables
    solved = [
        each[-1].problem.solve(each[-1].u, np.eye(len(each[-1].u))[-1], each[-1].tangent) for each in (branch, there)
    ]
    np.testing.assert_allclose(*solved, atol=1e-12)


def test_a_branch_whose_triangles_become_slivers_says_so_and_is_kept(coil, monkeypatch):
    point = coil.meshed(300)
    monkeypatch.setattr(periodic, "WORST", 1.1 * point.problem.surface(point.u).quality.max())
    branch = pb.Branch.through(point, {"v": 0.9}, down=True)
    assert branch.status is Status.FAILED
    assert "no longer describe the surface: triangle" in branch.reason
    assert len(branch) > 1
