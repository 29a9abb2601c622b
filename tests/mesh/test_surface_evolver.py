"""Datafiles for Surface Evolver, read back by the rules of its manual, and beside what the program itself says of one."""

import math

import numpy as np
import pytest

from pearlbvp.mesh.families import tube_mesh
from pearlbvp.mesh.files import write_mesh

L, C0 = 7.0, 0.3


def wavy(x, phi):
    """A tube with waves along it and around it."""
    r = 1 + 0.2 * np.cos(2 * np.pi * x / L) + 0.1 * np.cos(2 * phi)
    return np.column_stack((x, r * np.cos(phi), r * np.sin(phi)))


def read(path):
    """Periods, quantities that are held, ``h_zero`` and the corners of all facets, shape (T, 3, 3), without wraps."""
    lines = [line.split("//")[0].split() for line in path.read_text().splitlines()]
    lines = [line for line in lines if line]
    places = {line[0]: number for number, line in enumerate(lines)}
    periods = np.array(lines[places["periods"] + 1 : places["periods"] + 4], dtype=float)
    held = {line[1]: float(line[4]) for line in lines if line[0] == "quantity" and line[2] == "fixed"}
    h_zero = next(float(line[3]) for line in lines if line[:2] == ["parameter", "h_zero"])
    vertices, edges, faces = (
        lines[places[name] + 1 : end]
        for name, end in (("vertices", places["edges"]), ("edges", places["faces"]), ("faces", len(lines)))
    )
    for section in (vertices, edges, faces):
        assert [int(line[0]) for line in section] == list(range(1, len(section) + 1))
    assert all(line[4:] == ["tension", "0"] for line in faces)
    points = np.array([line[1:] for line in vertices], dtype=float)
    wraps = np.array([[{"-": -1, "*": 0, "+": 1}[sign] for sign in line[3:]] for line in edges])
    ends = np.array([line[1:3] for line in edges], dtype=int) - 1
    vectors = points[ends[:, 1]] - points[ends[:, 0]] + wraps @ periods
    corners = []
    indices = []
    for line in faces:
        oriented = [int(word) for word in line[1:4]]
        tails = [ends[abs(edge) - 1][0 if edge > 0 else 1] for edge in oriented]
        heads = [ends[abs(edge) - 1][1 if edge > 0 else 0] for edge in oriented]
        assert heads == tails[1:] + tails[:1]
        along = [math.copysign(1, edge) * vectors[abs(edge) - 1] for edge in oriented]
        np.testing.assert_allclose(sum(along), 0, atol=1e-12)  # the wraps close up
        start = points[tails[0]]
        corners.append([start, start + along[0], start + along[0] + along[1]])
        indices.append(tails)
    return periods, held, h_zero, np.array(corners), np.array(indices)


def bending(corners, indices, h_zero):
    """``star_perp_sq_mean_curvature`` as the manual has it: gradients of area and volume at each vertex."""
    count = indices.max() + 1
    force, normal, star = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    for corner in range(3):
        a, b, c = (corners[:, (corner + k) % 3] for k in range(3))
        doubled = np.cross(b - a, c - a)
        areas = np.linalg.norm(doubled, axis=1) / 2
        np.add.at(force, indices[:, corner], np.cross(doubled / (4 * areas[:, None]), c - b))
        np.add.at(normal, indices[:, corner], doubled / 6)
        np.add.at(star, indices[:, corner], areas)
    h = (force * normal).sum(axis=1) / (2 * (normal**2).sum(axis=1))
    return ((h - h_zero) ** 2 * star / 3).sum()


def test_a_datafile_says_what_the_mesh_is(tmp_path):
    mesh = tube_mesh(L, 150, wavy)
    path = tmp_path / "tube.fe"
    write_mesh(mesh, path, c0=C0)
    periods, held, h_zero, corners, indices = read(path)
    a, b, c = corners.transpose(1, 0, 2)
    doubled = np.cross(b - a, c - a)
    area = np.linalg.norm(doubled, axis=1).sum() / 2
    volume = (((a + b + c) / 3)[:, 1:] * doubled[:, 1:]).sum() / 4  # of (0, y/2, z/2)
    assert (area, volume) == pytest.approx((mesh.area, mesh.volume), rel=1e-12)
    assert held == {"tube_area": pytest.approx(area, rel=1e-12), "tube_volume": pytest.approx(volume, rel=1e-12)}
    assert h_zero == C0
    assert periods[0, 0] == L
    assert len(indices) == len(mesh.triangles)
    assert periods[1, 1] > 2 * np.abs(corners[:, :, 1:]).max()  # nothing of it reaches the next period across
    assert bending(corners, indices, h_zero) == pytest.approx(EVOLVER["bending"], rel=1e-12)


EVOLVER = {"tube_area": 44.2488224516127, "tube_volume": 21.5746513035067, "bending": 2.78611671905357}
"""What Surface Evolver 2.70 prints of ``test_a_datafile_says_what_the_mesh_is``'s file."""


def test_surface_evolver_reads_the_same_area_and_volume():
    mesh = tube_mesh(L, 150, wavy)
    assert (mesh.area, mesh.volume) == pytest.approx((EVOLVER["tube_area"], EVOLVER["tube_volume"]), rel=1e-12)


def test_its_energy_is_that_of_the_tube_to_second_order(tmp_path):
    """On the straight tube ``(1/2 - c0)² 2πL``: a wrong sign of ``h_zero`` would be nine times and more of it."""
    exact = (0.5 - C0) ** 2 * 2 * np.pi * L
    errors = []
    for nodes in (400, 1600):
        write_mesh(tube_mesh(L, nodes), tmp_path / "t.fe", c0=C0)
        _, _, h_zero, corners, indices = read(tmp_path / "t.fe")
        errors.append(bending(corners, indices, h_zero) / exact - 1)
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.2)
