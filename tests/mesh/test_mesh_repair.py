"""What is repaired in a tube from a file, and what is refused: against the exact area, volume and nodes of the polyhedron."""

import re

import numpy as np
import pytest
from support.tubes import (
    L,
    Polygons,
    bent,
    capped,
    cut,
    ends,
    grid,
    helix,
    known,
    pearl,
    rotation,
    row_of_three,
    soup,
    spoiled,
    turned_round,
    wrapped,
)

from pearlbvp.errors import InputError
from pearlbvp.mesh.families import tube_mesh
from pearlbvp.mesh.formats.soup import Soup
from pearlbvp.mesh.polygons import split
from pearlbvp.mesh.tube import tube_of

AXES = {
    "x": np.eye(3), "y": np.eye(3)[[2, 0, 1]], "z": np.eye(3)[[1, 2, 0]], "back": np.diag([-1.0, -1, 1]), "any": rotation(3),
    "steep": rotation(11),
}  # fmt: skip


def cylinder(x, phi):
    return np.column_stack((x, np.cos(phi), np.sin(phi)))


def read(polygons, length=L):
    return tube_of(Soup.of(polygons.points, polygons.faces), length)


def is_exact(found, mesh, tolerance=1e-9):
    tube, said = found
    assert tube.count == mesh.count
    assert len(tube.triangles) == len(mesh.triangles)
    assert (tube.area, tube.volume) == pytest.approx((mesh.area, mesh.volume), rel=tolerance)
    return said


def refusal(polygons, length=L):
    with pytest.raises(InputError) as caught:
        read(polygons, length)
    text = str(caught.value)
    assert "\n" not in text
    assert "; " in text
    return text


@pytest.mark.parametrize("seed", [1])
@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("surface", [pearl, helix, bent, None])
def test_a_tube_anywhere_cut_anyhow_with_all_that_is_repaired(surface, axis, seed):
    rng = np.random.default_rng(seed)
    mesh = known(surface, 150, 0.12)
    whole = cut(mesh, rng.uniform(-0.6, 0.6, 2), rng.uniform(0, 0.4), rng.uniform(0, L), seed)
    place = 20 * rng.normal(size=3)
    said = is_exact(read(whole.moved(AXES[axis], place)), mesh)
    assert any("turned the axis" in words for words in said) == (axis not in ("x", "back"))
    said = is_exact(read(turned_round(spoiled(whole, seed), 0.3, seed).moved(AXES[axis], place)), mesh)
    text = ", ".join(said)
    for words in (
        "left out 4 vertices of no face",
        "that are there twice",
        "left out 2 faces without area",
        "faces round",
    ):
        assert words in text
    said = is_exact(read(soup(turned_round(whole, 1)).moved(AXES[axis], place)), mesh)
    assert any(words.startswith("merged") for words in said)
    assert ("turned all faces outwards" in said) == (np.linalg.det(AXES[axis]) > 0)
    is_exact(read(Polygons(np.round(whole.moved(AXES[axis], place).points, 5), whole.faces)), mesh, 1e-4)


@pytest.mark.parametrize("axis", AXES)
def test_a_turned_tube_is_no_mirror_image(axis):
    """The helix of the centre line keeps its hand: its wave e^{ikx} is 0.5 one way, and nothing the other."""
    mesh = known(helix, 300)
    for polygons in (cut(mesh, ragged=0.2), wrapped(mesh)):
        tube, _ = read(polygons.moved(AXES[axis], [1.0, 2, 3]))
        x, y, z = tube.vertices.T
        k = 2 * np.pi / L
        line = (y - y.mean()) + 1j * (z - z.mean())
        one, other = (abs((line * np.exp(sign * 1j * k * x)).mean()) for sign in (-1, 1))
        assert (one, other) == pytest.approx((0.5, 0.0), abs=1e-3)


@pytest.mark.parametrize("digits", [3, 4, 6])
@pytest.mark.parametrize("axis", ["x", "z", "any"])
def test_coordinates_of_few_digits_close_their_seam(axis, digits):
    """Decimals, and significant digits as %g writes them, are both rounded differently at the two ends."""
    mesh = known(bent, 150)
    moved = cut(mesh, ragged=0.2, start=0.37).moved(AXES[axis])
    rounded = np.round(moved.points, digits)
    is_exact(read(Polygons(rounded, moved.faces)), mesh, 10.0**-digits * 3)
    significant = np.array([[float(f"{value:.{digits + 1}g}") for value in point] for point in moved.points])
    is_exact(read(Polygons(significant, moved.faces)), mesh, 10.0**-digits * 30)


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("surface", [pearl, helix, bent])
def test_tubes_without_ends_lead_on_into_the_next_period(surface, axis):
    """Along a coordinate the period is exact; along anything else its direction is as smooth as the mesh is."""
    mesh = known(surface, 350)
    place = [3.0, -4, 5]
    said = is_exact(
        read(turned_round(wrapped(mesh), 0.4).moved(AXES[axis], place)),
        mesh,
        1e-5 if axis in ("any", "steep") else 1e-9,
    )
    assert any("triangles lead on into the next period (by the mesh 10" in words for words in said)
    noisy = known(surface, 350, 0.12)
    is_exact(
        read(spoiled(wrapped(noisy)).moved(AXES[axis], place)), noisy, 1e-9 if axis not in ("any", "steep") else 5e-4
    )
    for length in (9.5, 11.0):
        assert "smoothly after 10 along" in refusal(wrapped(mesh).moved(AXES[axis], place), length)
    assert "2 periods of 5; give 10" in refusal(wrapped(mesh).moved(AXES[axis], place), 5.0)


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("kind", ["polygon", "middle", "fan"])
@pytest.mark.parametrize("only", [1, 2])
def test_flat_caps_are_removed(axis, kind, only):
    """Straight across, and across a slope: there the tube is sheared, which keeps its ends flat."""
    for surface in (helix,):
        mesh = known(surface, 120)
        slope = np.array([0.3, -0.5])
        sheared = mesh.moved(mesh.vertices + np.outer(mesh.vertices[:, 1:] @ slope, [1, 0, 0]))
        for exact, whole in ((mesh, cut(mesh)), (sheared, cut(sheared, -slope, start=-1e-6))):
            closed = turned_round(capped(whole, kind, only), 0.3).moved(AXES[axis], [1.0, 2, 3])
            said = is_exact(read(closed), exact)
            assert any(words.startswith("removed caps" if only == 2 else "removed a cap") for words in said)
            assert len(refusal(closed, 7.0)) > 0


@pytest.mark.parametrize("axis", AXES)
def test_caps_that_bulge_or_are_made_of_many_triangles_are_removed(axis):
    quads = grid(cylinder, 10, 15)
    points, faces, rings = quads.points, list(quads.faces), 3
    for x, height, first in ((0.0, 0.0, 0), (L, 0.0, 150)):
        ring = [first + j for j in range(10)]
        for k in range(1, rings):
            r, phi = 1 - k / rings, 2 * np.pi * np.arange(10) / 10
            points = np.vstack(
                (points, np.column_stack((np.full(10, x + 0.2 * k + height), r * np.cos(phi), r * np.sin(phi))))
            )
            inner = list(range(len(points) - 10, len(points)))
            faces += [[ring[j], ring[(j + 1) % 10], inner[(j + 1) % 10], inner[j]] for j in range(10)]
            ring = inner
        points = np.vstack((points, [[x + 0.5 + height, 0, 0]]))
        faces += [[ring[j], ring[(j + 1) % 10], len(points) - 1] for j in range(10)]
    tube, said = read(Polygons(points, faces).moved(AXES[axis]))
    assert tube.count == 150
    assert (tube.area, tube.volume) == pytest.approx((200 * np.sin(np.pi / 10), 50 * np.sin(np.pi / 5)), rel=1e-9)
    assert "removed caps of 60 faces" in said


def test_three_vertices_in_a_row_split_the_triangle_beside_them():
    mesh = known(bent, 150)
    tube, said = read(row_of_three(cut(mesh)))
    assert tube.count == mesh.count + 1
    assert (tube.area, tube.volume) == pytest.approx((mesh.area, mesh.volume), rel=1e-12)
    assert said == ("left out 1 face without area",)


def test_polygons_of_any_form_are_filled():
    """Stars in any plane from any corner on: the area by the shoelace formula, and triangles that all turn alike."""
    rng = np.random.default_rng(5)
    for _ in range(150):
        n = int(rng.integers(4, 25))
        angles = (np.arange(n) + rng.uniform(0, 0.8, n)) * 2 * np.pi / n
        r = rng.uniform(0.1, 1, n)
        x, y = np.roll(r * np.cos(angles), s := int(rng.integers(n))), np.roll(r * np.sin(angles), s)
        area = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2
        points = np.column_stack((x, y, 0 * x)) @ rotation(n).T + rng.normal(size=3)
        triangles = points[split(points, np.arange(n), np.array([n]))[:, :3]]
        vectors = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) / 2
        assert len(triangles) == n - 2
        assert np.linalg.norm(vectors, axis=1).sum() == pytest.approx(area, rel=1e-9)
        assert np.linalg.norm(vectors.sum(axis=0)) == pytest.approx(area, rel=1e-9)


def torus():
    u, v = np.meshgrid(2 * np.pi * np.arange(20) / 20, 2 * np.pi * np.arange(12) / 12, indexing="ij")
    r = 2 + np.cos(v)
    points = np.column_stack(((r * np.cos(u)).ravel(), (r * np.sin(u)).ravel(), np.sin(v).ravel()))
    return Polygons(points, [[i * 12 + j, (i + 1) % 20 * 12 + j, (i + 1) % 20 * 12 + (j + 1) % 12, i * 12 + (j + 1) % 12]
                             for i in range(20) for j in range(12)])  # fmt: skip


def ball(x, phi):
    angle = np.pi * (x + 0.5) / (L + 1)
    return 5 * np.column_stack((np.cos(angle), np.sin(angle) * np.cos(phi), np.sin(angle) * np.sin(phi)))


def sphere():
    return capped(grid(ball), "middle")


def without(polygons, *faces):
    return Polygons(polygons.points, [face for i, face in enumerate(polygons.faces) if i not in faces])


def twice(polygons, by):
    return beside(polygons, polygons.moved(by=by))


def beside(polygons, other):
    more = [[i + len(polygons.points) for i in face] for face in other.faces]
    return Polygons(np.vstack((polygons.points, other.points)), polygons.faces + more)


def with_rings_inside(polygons):
    """At both ends a flat ring inwards, whose inner rims are a period apart: the rings lie twice at the same place."""
    points, faces = polygons.points, list(polygons.faces)
    for loop in ends(polygons):
        inner = list(range(len(points), len(points) + len(loop)))
        points = np.vstack((points, (points[loop] + points[loop].mean(axis=0)) / 2))
        for a, b, c, d in zip(loop, np.roll(loop, -1).tolist(), np.roll(inner, -1).tolist(), inner, strict=True):
            faces += [[a, b, c], [a, c, d]]
    return Polygons(points, faces)


def with_fin(polygons):
    a, b, _ = polygons.faces[50]
    return Polygons(np.vstack((polygons.points, [[5.0, 3, 3]])), [*polygons.faces, [a, b, len(polygons.points)]])


def moebius(polygons):
    """The last row joined to the first one mirrored."""
    points = polygons.points.copy()
    last = points[:, 0] > L - 1e-9
    points[last, 2] *= -1
    return Polygons(points, polygons.faces)


def debris(size, at=4.5):
    """A triangle in the middle of the tube, or elsewhere."""
    return Polygons(np.array([[at, 0, 0], [at + 0.1, 0, 0], [at, 0.03 * size, 0]]), [[0, 1, 2]])


def far(vertex, place):
    points = PEARL.points.copy()
    points[vertex, 1] = place
    return Polygons(points, PEARL.faces)


def coarse(around):
    return grid(cylinder, around, max(6, 2 * around))


STRAIGHT = cut(known(None, 150))
PEARL = cut(known(pearl, 150))


@pytest.mark.parametrize(
    ("polygons", "length", "words"),
    [
        (without(PEARL, 100), L, "triangles: the edge from vertex .* has no second triangle"),
        (without(PEARL, 100).moved(rotation(2)), L, "has no second triangle"),
        (without(PEARL, 30, 100, 150), L, "has no second triangle"),
        (twice(PEARL, [0, 5, 0]), L, r"there are 2 pieces, the largest of 288 triangles, and 288 triangles \(with vertex 155\); delete all but one tube"),
        (twice(PEARL, [0, 5, 0]).moved(rotation(4)), L, "; delete all but one tube"),
        (beside(PEARL, sphere()), L, r"2 pieces, the largest of 456 triangles, and 288 triangles \(with vertex \d+\); delete"),
        (sphere(), L, "length: the surface is closed, of extent"),
        (beside(PEARL, debris(3)), L, r"2 pieces, the largest of 288 triangles, and 1 triangle \(with vertex 153\); delete"),
        (beside(beside(PEARL, debris(3)), debris(7, at=6.0)), L, "3 pieces, the largest of 288 triangles, and 1 .*153.*, 1 .*156"),
        (beside(PEARL.moved(AXES["z"]), debris(3, at=0.2)), L, r"2 pieces, .* and 1 triangle \(with vertex 153\)"),
        (far(17, 1e30), L, r"vertex 17 \(of the file, from 0 on\) at \[.*e\+30.*\] is 1e\+30 away from the middle of all"),
        (far(17, -1e7), L, r"vertex 17 \(of the file, from 0 on\) at .* is 1e\+07 away from the middle of all, half of which"),
        (coarse(3), L, "about 3 vertices lie around the tube beyond .* too few for the shape of a section; mesh it with 5 or"),
        (coarse(4).moved(rotation(6)), L, "about 4 vertices lie around the tube beyond"),
        (torus(), L, "length: the surface is closed, of extent"),
        (torus(), 6.0, "length: the surface is closed, of extent"),
        (with_rings_inside(PEARL), L, "lie at the same place, but for whole periods"),
        (with_fin(PEARL), L, "triangles: 3 triangles meet at the edge from vertex"),
        (Polygons(np.where(PEARL.points[:, :1] > 9.9, PEARL.points * [1, 1.1, 1], PEARL.points), PEARL.faces), L, "length: no two points .* its two ends do not match"),
        (moebius(cut(known(helix, 150))), L, "one side only"),
        (Polygons(PEARL.points * [1.1, 1, 1], PEARL.faces), L, "its ends are the same 11 apart along x; give that as the period"),
        (Polygons(PEARL.points * [1.1, 1, 1], PEARL.faces).moved(AXES["z"]), L, "its ends are the same 11 apart along z"),
        (grid(lambda x, phi: pearl(1.2 * x, phi), 12, 24), L, "length: .* ends do not match"),
        (twice(STRAIGHT, [1.0, 0, 0]), L, "delete all but one tube|lie at the same place|meet at the edge|no second triangle|cannot be reached|do not match"),
        (Polygons(STRAIGHT.points, STRAIGHT.faces[:1]), L, "no two points"),
        (Polygons(STRAIGHT.points * 0, STRAIGHT.faces), L, "no face of the file has an area"),
        (Polygons(STRAIGHT.points * [1e200, 1, 1], STRAIGHT.faces), L, "ordinary size"),
        (Polygons(STRAIGHT.points, [[0, 1, 2, 3, 4, 5, 6, 7, 1, 3, 0, 6, 2]]), L, "crosses itself|no two points|no second"),
    ],
)  # fmt: skip
def test_what_is_no_tube_is_refused(polygons, length, words):
    assert re.search(words, refusal(polygons, length)), refusal(polygons, length)


def test_a_klein_bottle_is_refused():
    """The last row is the first one a period on, but runs around the other way: nothing in space, but a list of triangles."""
    mesh = tube_mesh(L, 150)
    whole = wrapped(mesh)
    rows = np.round(whole.points[:, 0], 9)
    first, last = whole.points[rows == rows.min()], rows == rows.max()
    assert len(first) == last.sum()
    mirror = {tuple(np.round(p[1:], 6)): i for i, p in enumerate(whole.points) if rows[i] == rows.min()}
    swap = {i: mirror[tuple(np.round(whole.points[i, 1:] * [1, -1], 6) + 0.0)] for i in mirror.values()}
    faces = [[swap.get(i, i) if any(last[j] for j in face) else i for i in face] for face in whole.faces]
    assert len(refusal(Polygons(whole.points, faces))) > 0


def test_vertices_that_are_not_finite_and_corners_that_are_none_are_named():
    points = PEARL.points.copy()
    points[PEARL.faces[9][0], 1] = np.nan
    assert f"vertices: vertex {PEARL.faces[9][0]} (of the file, from 0 on)" in refusal(Polygons(points, PEARL.faces))


@pytest.mark.parametrize("around", [5, 6, 7])
def test_five_vertices_around_are_enough_however_they_lie(around):
    for polygons in (coarse(around), coarse(around).moved(AXES["any"])):
        assert read(polygons)[0].count == around * 2 * around


def test_half_and_double_periods_are_refused_by_their_number():
    assert "2 periods of 5; give" in refusal(PEARL, 5.0)
    assert "no two points of the file lie 20 apart along x, which runs from 0 to 10" in refusal(PEARL, 20.0)
