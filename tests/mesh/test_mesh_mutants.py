"""Files that were damaged: a tube whose area and volume are those that the file now holds, or one sentence; never a trace."""

import numpy as np
import pytest
from support.tubes import L, Polygons, cut, grid, known, pearl
from support.writers import POLYGONS, QUADS, TRIANGLES

from pearlbvp.errors import InputError
from pearlbvp.mesh.files import read_mesh

WAYS = POLYGONS | QUADS | TRIANGLES
MESH = known(pearl, 90)
TUBE = cut(MESH)
WORDS = [b"1e400", b"nan", b"-1", b"99999999999999999999", b"", b"1_0", b"inf", b"1e300", b"0", b"3"]


def mutant(data, rng):
    """Bytes flipped, digits changed, parts left out or written twice, lines exchanged, words replaced."""
    changed, n = bytearray(data), len(data)
    i, size = int(rng.integers(n)), int(rng.integers(1, 40))
    match rng.integers(6):
        case 0:
            for at in rng.integers(n, size=3):
                changed[at] ^= 1 << int(rng.integers(8))
        case 1:
            digits = [at for at, byte in enumerate(changed) if 48 <= byte < 58] or [i]
            changed[digits[int(rng.integers(len(digits)))]] = 48 + int(rng.integers(10))
        case 2:
            del changed[i : i + size]
        case 3:
            changed[i:i] = changed[i : i + size]
        case 4:
            lines = bytes(changed).split(b"\n")
            a, b = rng.integers(len(lines), size=2)
            lines[a], lines[b] = lines[b], lines[a]
            return b"\n".join(lines)
        case _:
            lines = bytes(changed).split(b"\n")
            at = int(rng.integers(len(lines)))
            words = lines[at].split(b" ")
            words[int(rng.integers(len(words)))] = WORDS[int(rng.integers(len(WORDS)))]
            lines[at] = b" ".join(words)
            return b"\n".join(lines)
    return bytes(changed)


def outcome(path, data):
    """The mesh, or None if it is refused in one sentence."""
    path.write_bytes(data)
    try:
        return read_mesh(path, L)
    except InputError as error:
        assert "\n" not in str(error)
        assert "; " in str(error)
        return None


def is_whole(mesh):
    return mesh.count == MESH.count and (mesh.area, mesh.volume) == pytest.approx((MESH.area, MESH.volume), rel=1e-6)


@pytest.mark.parametrize("name", sorted(WAYS))
def test_a_file_cut_off_anywhere_is_refused_or_whole(name, tmp_path):
    data = WAYS[name](TUBE)
    rng = np.random.default_rng(len(data))
    for end in [*rng.integers(len(data), size=6), len(data) - 1, len(data) - 3]:
        mesh = outcome(tmp_path / name, data[: int(end)])
        assert mesh is None or is_whole(mesh), end


@pytest.mark.parametrize("name", sorted(POLYGONS | QUADS))
def test_damaged_faces_are_refused_or_do_not_matter(name, tmp_path):
    """What follows on the last coordinate, found by writing other ones: no damage there may change the tube."""
    data = WAYS[name](TUBE)
    other = WAYS[name](Polygons(TUBE.points * [1, 1.5, -1.25], TUBE.faces))
    place = next((k for k in range(1, len(data)) if data[-k] != other[-k]), len(data)) - 1
    rng = np.random.default_rng(len(data))
    for _ in range(12):
        mesh = outcome(tmp_path / name, data[:-place] + mutant(data[-place:], rng) if place else data)
        assert mesh is None or is_whole(mesh)


@pytest.mark.parametrize("name", sorted(WAYS))
def test_files_damaged_anywhere_are_tubes_or_one_sentence(name, tmp_path):
    data = WAYS[name](TUBE)
    rng = np.random.default_rng(len(data) + 1)
    for _ in range(10):
        mesh = outcome(tmp_path / name, mutant(data, rng))
        assert mesh is None or np.isfinite([mesh.area, mesh.volume]).all()


@pytest.mark.parametrize(
    "name", ["plain.obj", "index.ply", "big_16.ply", "binary.vtk", "appended.vtu", "four.msh", "plain.off"]
)
def test_a_vertex_elsewhere_is_where_the_file_has_it(name, tmp_path):
    """Area and volume of the polyhedron with one vertex moved, by frusta of which one corner is another."""
    quads = grid(around=8, along=10)
    triangles = [[q[0], q[1], q[2]] for q in quads.faces] + [[q[0], q[2], q[3]] for q in quads.faces]
    rng = np.random.default_rng(7)
    for _ in range(4):
        points = quads.points.copy()
        points[8 + rng.integers(72)] += rng.uniform(-0.1, 0.1, 3)
        corners = points[triangles]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        mesh = outcome(tmp_path / name, WAYS[name](Polygons(points, triangles)))
        assert mesh.area == pytest.approx(np.linalg.norm(cross, axis=1).sum() / 2, rel=1e-6)
        flux = (corners.mean(axis=1)[:, 1:] * cross[:, 1:]).sum() / 4
        assert mesh.volume == pytest.approx(abs(flux), rel=1e-6)
