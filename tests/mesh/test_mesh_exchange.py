"""Tubes in files of other programs: area, volume, nodes and period are those of the exact polyhedron, whatever the way of writing."""

import re
from pathlib import Path

import numpy as np
import pytest
from support.commands import run
from support.tubes import L, Polygons, bent, cut, grid, helix, known, soup
from support.writers import POLYGONS, QUADS, TRIANGLES

from pearlbvp.errors import InputError
from pearlbvp.mesh.files import MOST_BYTES, read_mesh, read_tube

DATA = Path(__file__).parents[1] / "data" / "meshes"


def rows(around, along, bulge):
    """Area and volume of quads on ``r = 1 + bulge cos(2 pi x/L)``, each row of which is a frustum of a regular polygon."""
    r = 1 + bulge * np.cos(2 * np.pi * np.arange(along + 1) / along)
    step, a, b = L / along, r[:-1], r[1:]
    height = np.hypot(step, (b - a) * np.cos(np.pi / around))
    area = around * ((a + b) * np.sin(np.pi / around) * height).sum()
    return area, around * np.sin(2 * np.pi / around) / 2 * (step / 3 * (a * a + a * b + b * b)).sum()


def is_close(mesh, count, area, volume, digits=6):
    assert mesh.count == count
    assert mesh.length == L
    assert (mesh.area, mesh.volume) == pytest.approx((area, volume), rel=10.0**-digits)


def message(path, length=L):
    with pytest.raises(InputError) as caught:
        read_mesh(path, length)
    text = str(caught.value)
    assert "\n" not in text
    assert "; " in text
    return text


@pytest.mark.parametrize("name", sorted(POLYGONS | QUADS | TRIANGLES))
def test_a_bent_tube_of_triangles_is_read_whatever_the_way_it_is_written(name, tmp_path):
    mesh = known(bent, 120, jitter=0.1)
    (tmp_path / name).write_bytes((POLYGONS | QUADS | TRIANGLES)[name](cut(mesh, (0.3, -0.2), ragged=0.3)))
    read, said = read_tube(tmp_path / name, L)
    is_close(read, mesh.count, mesh.area, mesh.volume)
    doubled = "stl" in name or "negative" in name or "pieces" in name or name == "appended.vtp"
    assert bool(said) == doubled
    assert ("duplicate vert" in said) == doubled


@pytest.mark.parametrize("name", sorted(POLYGONS | QUADS))
def test_quads_are_split_and_said(name, tmp_path):
    (tmp_path / name).write_bytes((POLYGONS | QUADS)[name](grid(around=8, along=11)))
    read, said = read_tube(tmp_path / name, L)
    is_close(read, 88, *rows(8, 11, 0.15))
    assert said.startswith(f"{name}: split 88 quads")
    assert len(read.triangles) == 176


@pytest.mark.parametrize("name", sorted(POLYGONS))
def test_concave_polygons_are_filled_inside(name, tmp_path):
    """Each row of a straight tube's faces is an L and the rest; cut from the first corner, an L covers what is not in it."""
    around, along = 10, 12
    x, phi = np.meshgrid(
        np.arange(2 * along + 1) * L / (2 * along), 2 * np.pi * np.arange(around) / around, indexing="ij"
    )
    points = np.column_stack((x.ravel(), np.cos(phi).ravel(), np.sin(phi).ravel()))
    middle = np.column_stack(
        (x.ravel(), *(np.cos(np.pi / around) * f(phi + np.pi / around).ravel() for f in (np.cos, np.sin)))
    )
    faces, n = [], len(points)
    for i in range(0, 2 * along, 2):
        for j in range(around):
            a, b, c = ((i + k) * around + j for k in range(3))
            d, e, f = ((i + k) * around + (j + 1) % around for k in range(3))
            notch, foot, top = n + b, n + a, n + c
            if i % 4 == 0:
                faces += [[a, foot, notch, e, f, top, c, b], [foot, d, e, notch]]
            else:  # begins elsewhere
                faces += [[notch, e, f, top, c, b, a, foot], [foot, d, e, notch]]
    (tmp_path / name).write_bytes(POLYGONS[name](Polygons(np.vstack((points, middle)), faces)))
    read, said = read_tube(tmp_path / name, L)
    area = 2 * around * np.sin(np.pi / around) * L
    assert (read.area, read.volume) == pytest.approx((area, around * np.sin(2 * np.pi / around) / 2 * L), rel=1e-6)
    assert f"split {along * around} quads, split {along * around} polygons" in said


@pytest.mark.parametrize("path", sorted(p for p in DATA.iterdir() if p.is_file()), ids=lambda p: p.name)
def test_samples_are_read(path):
    six = "ply_" in path.name or "obj_uv" in path.name
    around, along, bulge = (6, 10, 0.05) if six else (12, 18, 0.15)
    read, said = read_tube(path, L)
    area, volume = rows(around, along, bulge)
    is_close(read, around * along, area, volume)
    expected = {
        "axis_z.obj": "turned the axis from z to x", "blender.ply": "split 216 quads", "quads.obj": "split 216 quads",
        "dupface.obj": "left out 1 face that is there twice", "flipped.obj": "turned all faces outwards",
        "soup.stl": "merged 1068 duplicate vertices",
    }  # fmt: skip
    assert said == (f"{path.name}: {expected[path.name]}" if path.name in expected else "")


@pytest.mark.parametrize("path", sorted((DATA / "programs").glob("[tv]*")), ids=lambda p: p.name)
def test_files_that_vtk_and_trimesh_wrote_are_read(path):
    if "refused" in path.name:
        assert "LZ4" in message(path)
        return
    is_close(read_mesh(path, L), 80, *rows(8, 10, 0.15))


@pytest.mark.parametrize("path", sorted((DATA / "programs").glob("gmsh*")), ids=lambda p: p.name)
def test_cylinders_that_gmsh_meshed_lose_their_caps(path):
    """The side's triangles, taken from the text of one of the files: those that do not lie at either end along y."""
    values = (DATA / "programs" / "gmsh.off").read_text().split()[1:]
    count, faces = int(values[0]), int(values[1])
    points = np.array(values[3 : 3 + 3 * count], float).reshape(-1, 3)
    corners = points[np.array(values[3 + 3 * count :], int).reshape(faces, 4)[:, 1:]]
    side = corners[np.ptp(corners[..., 1], axis=1) > 1e-9]
    cross = np.cross(side[:, 1] - side[:, 0], side[:, 2] - side[:, 0])
    volume = abs((side.mean(axis=1)[:, ::2] * cross[:, ::2]).sum() / 4)
    read, said = read_tube(path, L)
    assert (read.area, read.volume) == pytest.approx((np.linalg.norm(cross, axis=1).sum() / 2, volume), rel=1e-6)
    assert len(read.triangles) == len(side)
    assert f"removed caps of {faces - len(side)} faces, turned the axis from y to x" in said


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("many.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\n"
         b"property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n" + bytes(100)),
        ("many_faces.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
         b"property float z\nelement face 4000000000\nproperty list uint int vertex_indices\nend_header\n" + b"\xff" * 100),
        ("text.ply", b"ply\nformat ascii 1.0\nelement vertex 1000000000\nproperty float x\nend_header\n1\n"),
        ("many.off", b"OFF\n1000000000 1000000000 0\n0 0 0\n"),
        ("many.stl", bytes(80) + b"\xff\xff\xff\x7f" + bytes(100)),
        ("many.vtk", b"# vtk DataFile Version 3.0\n\nBINARY\nDATASET POLYDATA\nPOINTS 1000000000000 float\n" + bytes(100)),
        ("many.vtu", b'<VTKFile type="UnstructuredGrid" header_type="UInt64"><UnstructuredGrid><Piece NumberOfPoints="1000000000" '
         b'NumberOfCells="1"><Points><DataArray type="Float64" format="appended" offset="0"/></Points></Piece></UnstructuredGrid>'
         b'<AppendedData encoding="raw">_' + b"\xff" * 7 + b"\x0f</AppendedData></VTKFile>"),
        ("entities.vtu", b'<!DOCTYPE a [<!ENTITY b "cccc">]><VTKFile type="UnstructuredGrid">&b;</VTKFile>'),
        ("many.msh", b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 1000000000000 1 1\n$EndNodes\n$Elements\n$EndElements\n"),
        ("empty.obj", b""), ("empty.ply", b""), ("empty.stl", b""), ("empty.off", b""), ("empty.vtk", b""), ("empty.msh", b""),
        ("words.obj", b"no mesh at all"), ("surface.obj", b"v 0 0 0\nsurf 0 1 0 1 1\n"), ("other.obj", b"call other.obj\n"),
        ("grid.vtk", b"# vtk DataFile Version 3.0\n\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 3 3 1\n"),
    ],
)  # fmt: skip
def test_files_that_declare_what_they_do_not_hold_are_one_sentence(name, text, tmp_path):
    (tmp_path / name).write_bytes(text)
    assert "cannot be read as" in message(tmp_path / name)


def test_only_regular_files_of_bounded_size_are_read(tmp_path):
    (tmp_path / "folder.obj").mkdir()
    (tmp_path / "zero.stl").symlink_to("/dev/zero")
    with (tmp_path / "huge.stl").open("wb") as file:
        file.truncate(MOST_BYTES + 1)
    assert "is a folder" in message(tmp_path / "folder.obj")
    assert "a device or a pipe" in message(tmp_path / "zero.stl")
    assert "more than 2.68e+08" in message(tmp_path / "huge.stl")
    assert "endings .vtu, .vtp" in message(tmp_path / "tube.step")


def test_on_the_command_line_repairs_are_one_line_on_standard_error(capsys, tmp_path):
    status, out, said = run(capsys, "flow", "--mesh", DATA / "quads.obj", "--c0", 0, "--length", 10, "--time", 0.1)
    assert (status, said.splitlines()[0]) == (0, "pearlbvp: quads.obj: split 216 quads")
    same = run(capsys, "flow", "--mesh", DATA / "tri_neg.obj", "--c0", 0, "--length", 10, "--time", 0.1)
    assert "tri_neg" not in same[2]
    last, other = ([float(word) for word in text.splitlines()[-1].split(",")] for text in (out, same[1]))
    assert last[1] == pytest.approx(other[1], rel=1e-3)  # the diagonals are others
    assert last[-2:] == pytest.approx(other[-2:], rel=1e-4)


def test_a_mesh_in_another_unit_of_length_asks_for_its_radius(capsys, tmp_path):
    text = re.sub(r"^v (\S+) (\S+) (\S+)", lambda m: "v " + " ".join(f"{50 * float(x):.6f}" for x in m.groups()),
                  (DATA / "tri_neg.obj").read_text(), flags=re.M)  # fmt: skip
    (tmp_path / "nm.obj").write_text(text)
    call = ["flow", "--mesh", tmp_path / "nm.obj", "--c0", 0, "--length", 500, "--time", 1]
    status, out, said = run(capsys, *call)
    assert (status, out) == (2, "")
    assert said == "pearlbvp: --radius: the tube's radius is about 50; give --radius 50\n"
    assert run(capsys, *call, "--radius", 50)[0] == 0
    assert run(capsys, "flow", "--mesh", tmp_path / "nm.obj", "--c0", 0, "--length", 10, "--time", 1)[2].endswith(
        "give 500\n"
    )


def test_a_soup_and_what_it_was_are_one_mesh(tmp_path):
    mesh = known(helix, 150)
    (tmp_path / "soup.ply").write_bytes(POLYGONS["plain.ply"](soup(cut(mesh))))
    (tmp_path / "plain.ply").write_bytes(POLYGONS["plain.ply"](cut(mesh)))
    one, other = (read_mesh(tmp_path / name, L) for name in ("soup.ply", "plain.ply"))
    assert one.count == other.count
    np.testing.assert_array_equal(np.sort(one.areas), np.sort(other.areas))
