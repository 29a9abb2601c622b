"""A smooth surface as a cloud of points with normals, to project onto: how meshes of one surface find each other."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from pearlbvp.mesh.operators import vertex_normals
from pearlbvp.mesh.periodic import Array, Integers, PeriodicMesh
from pearlbvp.mesh.subdivision import limit_matrix


@dataclass(frozen=True)
class Samples:
    """Sixteen points for each vertex of the limit surface of a mesh.

    Attributes:
        points, normals: shape (M, 3).
        matrix: values at the points of a field given at the vertices, shape (M, V).
        length: the period.
    """

    points: Array
    normals: Array
    matrix: sparse.csr_matrix
    length: float

    @classmethod
    def of(cls, mesh: PeriodicMesh) -> Samples:
        """Samples of the limit surface of a mesh."""
        fine, matrix, offsets = limit_matrix(mesh, 2)
        points = matrix @ mesh.vertices
        points[:, 0] += offsets
        surface = PeriodicMesh(points, fine.triangles, fine.wraps, mesh.length)
        return cls(points, vertex_normals(surface), matrix, mesh.length)

    @cached_property
    def _tree(self) -> tuple[Any, Integers, Array]:
        """Tree of the points of one period and half of both its neighbours, their numbers, and their places."""
        x = self.points[:, 0] % self.length
        inside = np.column_stack((x, self.points[:, 1:]))
        before, after = np.flatnonzero(x > self.length / 2), np.flatnonzero(x <= self.length / 2)
        step = np.array([self.length, 0, 0])
        places = np.concatenate((inside, inside[before] - step, inside[after] + step))
        return cKDTree(places), np.concatenate((np.arange(len(x)), before, after)), places

    def nearest(self, points: Array) -> tuple[Array, Array, Integers]:
        """The nearest sample of each point: its offset from the point and its normal, shape (K, 3), and its number."""
        tree, numbers, places = self._tree
        moved = points.copy()
        moved[:, 0] %= self.length
        _, found = tree.query(moved)
        return places[found] - moved, self.normals[numbers[found]], numbers[found]

    def project(self, points: Array) -> Array:
        """Points moved onto the surface along its normals, shape (K, 3)."""
        offset, normals, _ = self.nearest(points)
        return points + np.einsum("ix,ix->i", offset, normals)[:, None] * normals

    def distance_along(self, points: Array, directions: Array, guess: Array) -> Array:
        """How far from ``points`` along ``directions`` the surface is met, from a guess on, shape (K,)."""
        along = guess
        for _ in range(8):
            offset, normals, _ = self.nearest(points + along[:, None] * directions)
            slope = np.einsum("ix,ix->i", directions, normals)
            along = along + np.einsum("ix,ix->i", offset, normals) / np.where(np.abs(slope) < 0.2, 1.0, slope)
        return along

    def field(self, points: Array, at_vertices: Array) -> Array:
        """Values at the samples nearest to ``points`` of a field given at the mesh's vertices, shape (K, ...)."""
        return np.asarray((self.matrix @ at_vertices)[self.nearest(points)[2]])
