"""Meshes in files: what is wrong with one is said in one line, by the numbers of the file."""

import re

import meshio
import numpy as np
import pytest

from pearlbvp.errors import InputError
from pearlbvp.mesh.families import tube_mesh
from pearlbvp.mesh.files import joined, read_mesh, read_tube, write_mesh

L = 10.0


def helix(x, phi):
    """A tube that is nowhere its own image half a period on."""
    k = 2 * np.pi / L
    return np.column_stack((x, 0.5 * np.cos(k * x) + np.cos(phi), 0.5 * np.sin(k * x) + np.sin(phi)))


@pytest.fixture
def file(tmp_path):
    """Writes a tube, changed, into a file of some format."""

    def written(ending, change=None, surface=helix):
        path = tmp_path / f"tube{ending}"
        write_mesh(tube_mesh(L, 400, surface), path)
        if change is not None:
            found = meshio.read(path)
            points, triangles = found.points.copy(), found.cells[0].data.copy()
            change(points, triangles)
            meshio.Mesh(points, [("triangle", triangles)]).write(path)
        return path

    return written


def message(path, length=L):
    with pytest.raises(InputError) as caught:
        read_mesh(path, length)
    assert "\n" not in str(caught.value)
    assert "; " in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("part", [2, 3])
@pytest.mark.parametrize("surface", [helix, None])
def test_a_whole_fraction_of_the_period_is_refused(file, part, surface):
    """A tube of period 10 taken for one of period 5: sections half a period apart differ, or are the same points."""
    text = message(file(".vtu", surface=surface), L / part)
    assert text.startswith("length: ")
    assert re.search(f"{part} periods of {L / part:g}.*; give", text), text


@pytest.mark.parametrize("length", [11.0, 9.9])
def test_a_period_at_which_nothing_repeats_is_named_beside_the_file_s_extent(file, length):
    assert f"{length:g} apart along x, which runs from 0 to 10" in message(file(".ply"), length)


def test_a_tube_along_z_is_turned_to_x(file):
    def turn(points, _):
        points[:] = points[:, [1, 2, 0]]

    read, said = read_tube(file(".ply", turn), L)
    assert said == "tube.ply: turned the axis from z to x"
    np.testing.assert_allclose(read.vertices, read_mesh(file(".ply"), L).vertices, atol=1e-12)


@pytest.mark.parametrize(("ending", "first"), [(".vtu", 0), (".ply", 0), (".obj", 1)])
def test_messages_number_as_the_file_does(file, ending, first):
    """A hole: the edge that is named is one of the missing triangle's, read here by its text or by meshio."""

    def remove(_, triangles):
        missing.extend(triangles[77])
        triangles[77] = triangles[77, 0]

    missing = []
    path = file(ending, remove)
    tail, head, triangle = map(
        int, re.search(r"edge from vertex (\d+) to (\d+) \(triangle (\d+)\)", message(path)).groups()
    )
    if ending == ".obj":
        lines = path.read_text().splitlines()
        faces = [[int(word.split("/")[0]) for word in line.split()[1:]] for line in lines if line[:2] == "f "]
        vertices = [line.split()[1:] for line in lines if line[:2] == "v "]
        assert len(vertices) > tube_mesh(L, 400).count
    else:
        faces = meshio.read(path).cells[0].data
    corners = list(faces[triangle - first])
    assert corners[(corners.index(tail) + 1) % 3] == head
    assert {tail - first, head - first} <= set(missing)
    assert f"from {first} on" in message(path)


@pytest.mark.parametrize(("ending", "number"), [(".vtu", 5), (".obj", 6)])
def test_a_vertex_that_is_not_finite_is_named(file, ending, number):
    def spoil(points, _):
        points[5, 1] = np.nan

    path = file(ending, spoil)
    assert message(path).startswith(f"path: {path}: vertex {number} (of the file")


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("f 0 1 2", "line 3 has a face with the corner 0; OBJ counts its vertices from 1"),
        ("f 1/1 2/1 0/1", "line 3 has a face with the corner 0; OBJ counts its vertices from 1"),
        ("f -1 -2 -9", "line 3 has a face with the corner -9, and 2 vertices are before it"),
        ("f 1 2", "line 3 begins with 'f' and is not a face of three or more whole numbers"),
        ("f 1 2 x", "line 3 begins with 'f' and is not a face of three or more whole numbers"),
        ("v 1 2", "line 3 begins with 'v' and is not a vertex of three coordinates"),
        ("surf 1 2", "line 3 begins with 'surf', which is none of its statements"),
        ("f 1 2 7", "a corner is none of its 2 vertices (in face 1; both are numbered from 1)"),
    ],
)
def test_lines_of_obj_that_cannot_be_used_say_why(tmp_path, line, said):
    path = tmp_path / "t.obj"
    path.write_text(f"v 0 0 0\nv 1 0 0\n{line}\n")
    assert message(path) == f"path: {path} cannot be read as OBJ ({said}); export it again"


def test_what_is_wrong_with_triangles_is_said_of_the_argument_that_has_them():
    mesh = tube_mesh(L, 100)
    corners, triangles = mesh.corners.reshape(-1, 3), np.arange(3 * len(mesh.triangles)).reshape(-1, 3)
    for points, faces, said in (
        (np.where(np.arange(len(corners))[:, None] == 7, np.nan, corners), triangles, "points: vertex 7"),
        (corners, triangles[:-1], "triangles: the edge from vertex"),
        (corners, triangles + 9, "triangles: a corner is none of"),
    ):
        with pytest.raises(InputError, match=f"^{said}"):
            joined(points, faces, L)


def test_points_that_no_triangle_has_are_passed_over():
    mesh = tube_mesh(L, 100)
    corners, triangles = mesh.corners.reshape(-1, 3), np.arange(3 * len(mesh.triangles)).reshape(-1, 3)
    read = joined(np.vstack((corners, [np.nan] * 3)), triangles, L)
    assert (read.count, read.volume) == (mesh.count, pytest.approx(mesh.volume, rel=1e-12))


@pytest.mark.parametrize("ending", [".vtu", ".ply", ".obj"])
@pytest.mark.parametrize("share", np.linspace(0.01, 0.97, 17))
def test_a_file_that_is_cut_off_is_one_plain_sentence(file, ending, share):
    path = file(ending)
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    text = message(path)
    assert not re.search("shape|buffer|codec|element|dtype|array", text), text
