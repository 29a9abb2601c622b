"""A smooth surface as a fine mesh with normals, to project onto: how meshes of one surface find each other.

Between the vertices of the fine mesh the surface is curved: the plane of a triangle, bent halfway to the tangent planes at
its corners (T. Boubekeur, M. Alexa, ACM Trans. Graph. 27 (2008) 141, with the share 1/2, which is exact for surfaces of
second degree). It is continuous, so that projections keep the symmetries of what is projected.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from pearlbvp.arrays import Array, Integers
from pearlbvp.mesh.operators import vertex_normals
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.subdivision import limit_matrix
from pearlbvp.representation import brief


class Feet(NamedTuple):
    """Where points meet a surface.

    Attributes:
        offsets: from the points to the surface, shape (K, 3).
        normals: of the surface there, shape (K, 3).
        corners: the fine vertices of the triangle there, shape (K, 3).
        weights: barycentric, shape (K, 3).
    """

    offsets: Array
    normals: Array
    corners: Integers
    weights: Array


@dataclass(frozen=True)
class Samples:
    """The limit surface of a mesh, sixteen triangles for one.

    Attributes:
        surface: the fine mesh, its vertices on the surface.
        matrix: values at its vertices of a field given at the vertices of the mesh, shape (M, V).
    """

    __repr__ = brief

    surface: PeriodicMesh
    matrix: sparse.csr_matrix

    @classmethod
    def of(cls, mesh: PeriodicMesh) -> Samples:
        """Samples of the limit surface of a mesh."""
        fine, matrix, offsets = limit_matrix(mesh, 2)
        points = matrix @ mesh.vertices
        points[:, 0] += offsets
        return cls(PeriodicMesh(points, fine.triangles, fine.wraps, mesh.length), matrix)

    @cached_property
    def _normals(self) -> Array:
        return vertex_normals(self.surface)

    @cached_property
    def _tree(self) -> tuple[Any, Integers, Array]:
        """Tree of the vertices of one period and half of both its neighbours, their numbers, and their places."""
        length = self.surface.length
        x = self.surface.vertices[:, 0] % length
        inside = np.column_stack((x, self.surface.vertices[:, 1:]))
        before, after = np.flatnonzero(x > length / 2), np.flatnonzero(x <= length / 2)
        step = np.array([length, 0, 0])
        places = np.concatenate((inside, inside[before] - step, inside[after] + step))
        return cKDTree(places), np.concatenate((np.arange(len(x)), before, after)), places

    @cached_property
    def _fans(self) -> Integers:
        """Half-edges that leave each fine vertex, shape (M, D), the last one repeated where there are fewer."""
        start, order = self.surface.star
        valences = np.diff(start)
        return order[start[:-1, None] + np.minimum(np.arange(valences.max()), valences[:, None] - 1)]

    def feet(self, points: Array) -> Feet:
        """Where points, shape (K, 3), meet the surface when they are moved onto the nearest triangle's."""
        tree, numbers, places = self._tree
        moved = points.copy()
        moved[:, 0] %= self.surface.length
        _, found = tree.query(moved)
        triangle, corner = np.divmod(self._fans[numbers[found]], 3)  # those about the nearest vertex, (K, D)
        corners = self.surface.corners[triangle]
        corners = corners - self.surface.corners[triangle, corner][:, :, None] + (places[found] - moved)[:, None, None]
        weights = _barycentric(corners)  # of the origin
        flat = np.einsum("kda,kdax->kdx", weights, corners)
        best = np.argmin((flat**2).sum(axis=2), axis=1)
        rows = np.arange(len(points))
        corners, weights, flat, chosen = (a[rows, best] for a in (corners, weights, flat, triangle))
        vertices = self.surface.triangles[chosen]
        normals = self._normals[vertices]
        height = np.einsum("kax,kax->ka", corners - flat[:, None], normals)
        offsets = flat + np.einsum("ka,ka,kax->kx", weights, height, normals) / 2
        normal = np.einsum("ka,kax->kx", weights, normals)
        return Feet(offsets, normal / np.linalg.norm(normal, axis=1)[:, None], vertices, weights)

    def project(self, points: Array) -> Array:
        """Points moved onto the surface, shape (K, 3)."""
        return np.asarray(points + self.feet(points).offsets)

    def distance_along(self, points: Array, directions: Array, guess: Array) -> Array:
        """How far from ``points`` along ``directions`` the surface is met, from a guess on, shape (K,)."""
        along = guess
        for _ in range(8):
            offsets, normals, _, _ = self.feet(points + along[:, None] * directions)
            slope = np.einsum("ix,ix->i", directions, normals)
            along = along + np.einsum("ix,ix->i", offsets, normals) / np.where(np.abs(slope) < 0.2, 1.0, slope)
        return along

    def field(self, points: Array, at_vertices: Array) -> Array:
        """Values at ``points``, shape (K, 3), of a vector field given at the mesh's vertices, shape (V, 3)."""
        _, _, corners, weights = self.feet(points)
        return np.einsum("ka,kax->kx", weights, (self.matrix @ at_vertices)[corners])


def _barycentric(corners: Array) -> Array:
    """Barycentric coordinates of the origin in triangles, shape (..., 3, 3) to (..., 3), cut off at the edges."""
    first, second = corners[..., 1, :] - corners[..., 0, :], corners[..., 2, :] - corners[..., 0, :]
    normal = np.cross(first, second)
    square = (normal**2).sum(axis=-1)
    one = -(np.cross(corners[..., 0, :], second) * normal).sum(axis=-1) / square
    two = -(np.cross(first, corners[..., 0, :]) * normal).sum(axis=-1) / square
    weights = np.stack((1 - one - two, one, two), axis=-1).clip(0, None)
    return np.asarray(weights / weights.sum(axis=-1, keepdims=True))
