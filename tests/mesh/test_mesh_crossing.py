"""Meshes that pass through themselves: outlines in closed form turned about the axis, and every pair of triangles by hand."""

import numpy as np
import pytest

from pearlbvp.continuation.branch import Status
from pearlbvp.helfrich import Tube
from pearlbvp.mesh.crossing import crossing_triangles
from pearlbvp.mesh.families import tube_mesh
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.theory.elastica import touching_ring

LENGTH = 2 * np.pi


def overhanging(a, nodes=1500, turn=0.0, shift=0.0):
    """``x = t + a sin 2t``, ``r = 2 - cos t``: it overhangs for a > 1/2, and meets its mirror image where x has its maximum at pi."""
    mesh = tube_mesh(LENGTH, nodes)
    t, phi = mesh.vertices[:, 0], np.arctan2(mesh.vertices[:, 2], mesh.vertices[:, 1]) + turn
    r = 2 - np.cos(t)
    return mesh.moved(np.column_stack((t + a * np.sin(2 * t) + shift, r * np.cos(phi), r * np.sin(phi))))


def farthest(a):
    """Where ``x`` has its maximum in the half period, less half the period."""
    t = np.arccos(-1 / (2 * a)) / 2
    return t + a * np.sin(2 * t) - np.pi


@pytest.mark.parametrize("a", [0.3, 1.6, 1.9, 2.4])
@pytest.mark.parametrize(("turn", "shift"), [(0.0, 0.0), (0.7, 2.0), (2.0, -4.1)])
def test_an_outline_meets_its_image_where_it_reaches_the_plane_between_them(a, turn, shift):
    touches = a > 0.5 and farthest(a) > 0
    assert (crossing_triangles(overhanging(a, turn=turn, shift=shift)) is not None) == touches


def test_that_place_is_where_it_should_be():
    """At it both triangles are on the circle in which the outline and its image cross."""
    a = 2.4
    mesh = overhanging(a)
    one, other = crossing_triangles(mesh)
    x = mesh.corners[[one, other], :, 0]
    assert (np.abs(np.mod(x + np.pi / 2, np.pi) - np.pi / 2).min(axis=1) < 0.3).all()  # beside a plane of reflection


def meet(one, other):
    """Of pairs of triangles, shape (N, 3, 3), which meet: an edge of either passes through the other.

    Each is a linear system in one coordinate of the edge and two of the plane.
    """
    found = np.zeros(len(one), dtype=bool)
    for triangle, edges in ((one, other), (other, one)):
        for k in range(3):
            p, q = edges[:, k], edges[:, (k + 1) % 3]
            a, b, c = triangle.transpose(1, 0, 2)
            t, u, v = np.linalg.solve(np.stack((q - p, a - b, a - c), axis=-1), (a - p)[..., None])[..., 0].T
            found |= (t > 0) & (t < 1) & (u > 0) & (v > 0) & (u + v < 1)
    return found


def test_every_pair_of_triangles_by_hand():
    """Coarse tubes with a dent of random depth from two sides: some triangles meet, or none."""
    counts = []
    mesh = tube_mesh(3.0, 60)
    i, j = np.triu_indices(len(mesh.triangles), 1)
    apart = ~(mesh.triangles[i][:, :, None] == mesh.triangles[j][:, None, :]).any(axis=(1, 2))
    i, j = i[apart], j[apart]
    for seed in range(12):
        random = np.random.default_rng(seed)
        v = mesh.vertices + 0.02 * random.standard_normal((mesh.count, 3))
        v[:, 2] *= 1 - random.uniform(0.6, 1.4) * np.exp(-2 * (v[:, 0] - random.uniform(0, 3)) ** 2)
        dented = mesh.moved(v)
        corners = dented.corners
        images = [corners[j] + np.array([k * 3.0, 0, 0]) for k in (-1, 0, 1)]
        meeting = np.any([meet(corners[i], image) for image in images], axis=0)
        pairs = set(zip(i[meeting].tolist(), j[meeting].tolist(), strict=True))
        found = crossing_triangles(dented)
        assert (tuple(sorted(found)) in pairs) if pairs else found is None
        counts.append(bool(pairs))
    assert 2 < sum(counts) < 10


def test_a_ring_on_a_mesh_ends_before_the_elastic_ring_touches_itself():
    branch = family_branch(Tube(-1.0, 3.0), "ring", (0, 2), branch_options({"v": 0.2}), nodes=200)
    assert branch.status is Status.CONTACT
    assert -0.005 < branch.points[-1].value("v") - touching_ring(2).v < 0.03
    assert crossing_triangles(branch.points[-1].problem.own_mesh(branch.points[-1].u)) is None
