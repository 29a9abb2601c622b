"""Energy, area and volume of a mesh as functions of displacements, by one of two discretizations.

- ``subdivision``: the surface is the limit of Loop's subdivision of the mesh. Conforming, of fourth order in the mesh
  width where all valences are 6 and the vertices are smooth functions of those of a lattice. Its parametrization is as rough as
  the mesh: where vertices are jittered by a fixed share of an edge, or a fixed share of the valences is not 6, it does not
  converge.
- ``cotangent``: the surface is the polyhedron, its mean curvature that of the cotangent Laplacian with lumped mass: the
  paper's own (Appendix B). Of second order on every family of meshes tried (``families``), jittered and edited ones too, where
  its curvature is wrong pointwise by as much as a third on all meshes: the energy's minimum is another, smoothed by
  displacements of second order, and its branch points and energies are right.

Both sum exact derivatives, and hand on one sparse symmetric Hessian.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from scipy import sparse

from pearlbvp.arrays import Array, Integers
from pearlbvp.bordered import spread
from pearlbvp.held import Quantities
from pearlbvp.mesh.limit import limit_hessian, limit_mass, limit_sums
from pearlbvp.mesh.operators import barycentric_mass, vertex_normals, volume_gradient
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.polyhedron import star_sums
from pearlbvp.mesh.subdivision import Patches, limit_matrix
from pearlbvp.mesh.subdivision import patches as patches_of
from pearlbvp.representation import brief

Kind = Literal["subdivision", "cotangent"]


class Sums(NamedTuple):
    """Sums over one period.

    Attributes:
        values: energy, area, volume, shape (3,).
        gradients: of these, shape (3, V).
        curvature: integral of the mean curvature.
    """

    values: Array
    gradients: Array
    curvature: float


@dataclass(frozen=True, eq=False)
class Stencils:
    """Which vertices the terms of a sum over a mesh depend on, wherever they lie.

    Attributes:
        mesh: any with these triangles.
        kind: the discretization.
    """

    __repr__ = brief

    mesh: PeriodicMesh
    kind: Kind

    @cached_property
    def patches(self) -> Patches:
        """Points of the limit surface, with the vertices that each depends on."""
        return patches_of(self.mesh)

    @cached_property
    def stars(self) -> tuple[Integers, Integers, Array]:
        """Of each vertex where its neighbours begin, all of them, and by how much they are shifted."""
        start, order = self.mesh.star
        return start, self.mesh.head[order], self.mesh.length * self.mesh.shift[order].astype(float)

    @cached_property
    def groups(self) -> tuple[Integers, Integers]:
        """Vertices that one term of the sums depends on: where each group starts, and all."""
        if self.kind == "subdivision":
            return self.patches.start, self.patches.index
        start, head, _ = self.stars
        return start + np.arange(len(start)), np.insert(head, start[:-1], np.arange(self.mesh.count))

    @cached_property
    def pattern(self) -> tuple[Integers, Integers, Integers]:
        """Where each pair of each group goes among the Hessian's nonzeros; its row indices and column starts."""
        start, index = self.groups
        sizes = np.diff(start)
        members = sparse.csr_matrix((np.ones(len(index), dtype=np.int64), index, start), (len(sizes), self.mesh.count))
        together = (members.T @ members).tocsc()
        together.sort_indices()
        together.data = np.arange(together.nnz)
        place = np.empty(int((sizes**2).sum()), dtype=np.int64)
        places = np.concatenate(([0], np.cumsum(sizes**2)))
        for size in np.unique(sizes):
            chosen = np.flatnonzero(sizes == size)
            group = index[start[chosen][:, None] + np.arange(size)]
            found = together[np.repeat(group, size, axis=1).ravel(), np.tile(group, size).ravel()]
            place[places[chosen][:, None] + np.arange(size**2)] = found.reshape(len(chosen), -1)
        return place, together.indices, together.indptr

    @cached_property
    def limit(self) -> tuple[sparse.csr_matrix, Array]:
        """Points of the surface at the vertices by the vertices: matrix and shifts along the axis."""
        if self.kind == "cotangent":
            return sparse.eye(self.mesh.count, format="csr"), np.zeros(self.mesh.count)
        return limit_matrix(self.mesh)[1:]


NOWHERE = np.zeros(0, dtype=np.int64)
"""Places in a matrix that is not wanted."""

PINS = 16
"""Vertices held in a factorization: more than there are near kernels, few enough to cost nothing."""


@dataclass(frozen=True, eq=False)
class Functional:
    """Energy, area and volume on the triangles of a mesh, for any positions of its vertices.

    Attributes:
        mesh: the triangles; its vertices are the reference only.
        kind: the discretization.
        known: stencils of these triangles, where another mesh has them already.
    """

    __repr__ = brief

    mesh: PeriodicMesh
    kind: Kind = "subdivision"
    known: Stencils | None = field(default=None, repr=False)

    @cached_property
    def stencils(self) -> Stencils:
        """Which vertices each term depends on."""
        return self.known or Stencils(self.mesh, self.kind)

    def on(self, mesh: PeriodicMesh) -> Functional:
        """The same discretization on another mesh; what depends on triangles and period only is kept if they are the same."""
        same = mesh.connected is self.mesh.connected and mesh.length == self.mesh.length
        return Functional(mesh, self.kind, self.stencils if same else None)

    @property
    def quadrature(self) -> Patches:
        """Points of the limit surface over which energies are summed."""
        return self.stencils.patches

    @cached_property
    def directions(self) -> Array:
        """Normals at the vertices of the reference, shape (V, 3), along which they may be displaced."""
        return vertex_normals(self.mesh)

    @cached_property
    def pins(self) -> Integers:
        """Vertices held while a matrix on the mesh is factorized."""
        return spread(self.mesh.vertices, PINS)

    def _matrix(self, data: Array) -> sparse.csc_matrix:
        _, rows, columns = self.stencils.pattern
        return sparse.csc_matrix((data, rows, columns), shape=(self.mesh.count, self.mesh.count))

    def sums(self, vertices: Array, directions: Array, c0: float) -> Sums:
        """Energy, area, volume and integral of the mean curvature of one period, and gradients along ``directions``."""
        if self.kind == "subdivision":
            values, gradients = limit_sums(self.stencils.patches, vertices, directions, c0)
        else:
            stars, none = self.stencils.stars, np.zeros(0)
            values, gradients = star_sums(vertices, directions, *stars, c0, 0.0, 0.0, NOWHERE, none)
        return Sums(values[:3], gradients, float(values[3]))

    def quantities(self, vertices: Array, directions: Array, sums: Sums, p: Array) -> Quantities:
        """Area, volume and integrated mean curvature, from the sums at the same place, with coefficients ``p``.

        The energy's derivative by ``c0`` is ``2 (c0 A - M)``, on a mesh too, and the energy is a polynomial of degree two in
        ``c0``, with the area as the coefficient of the square, so that the difference of its gradients is exact.
        """
        c0 = -p[2] / 2
        ahead, here, by_area = self.sums(vertices, directions, c0 + 1).gradients[0], *sums.gradients[:2]
        gradients = np.vstack((sums.gradients[1:], c0 * by_area - (ahead - here - by_area) / 2))
        return Quantities(np.append(sums.values[1:], sums.curvature), gradients, p, 1.0)

    def hessian(
        self, vertices: Array, directions: Array, c0: float, lambda1: float, lambda2: float
    ) -> sparse.csc_matrix:
        """Second derivative of ``E + lambda1 A + lambda2 V`` along ``directions``, shape (V, V)."""
        place, rows, _ = self.stencils.pattern
        data = np.zeros(len(rows))
        if self.kind == "subdivision":
            limit_hessian(self.stencils.patches, vertices, directions, c0, lambda1, lambda2, place, data)
        else:
            star_sums(vertices, directions, *self.stencils.stars, c0, lambda1, lambda2, place, data)
        return self._matrix(data)

    def normal_mass(self, vertices: Array, directions: Array) -> tuple[sparse.csc_matrix, Array]:
        """Mean square of normal displacements, and rigid motions in it.

        Returns:
            The mass matrix, shape (V, V), and its product with the normal displacements of the translations along
            ``x, y, z`` and the rotation about ``x``, shape (4, V).
        """
        if self.kind == "subdivision":
            p = self.stencils.patches
            place, rows, _ = self.stencils.pattern
            data = np.zeros(len(rows))
            still = np.zeros(self.mesh.count)
            motions = limit_mass(p, vertices, directions, still, place, data)
            return self._matrix(data), motions[:4]
        normals = volume_gradient(self.mesh.moved(vertices))
        mass = barycentric_mass(self.mesh.moved(vertices))
        moved = np.einsum("ix,ix->i", normals, directions) / mass
        turn = vertices[:, 1] * normals[:, 2] - vertices[:, 2] * normals[:, 1]
        return sparse.diags(mass * moved**2, format="csc"), np.vstack((normals.T, turn)) * moved

    def mass_times(self, vertices: Array, directions: Array, rate: Array) -> Array:
        """The mass matrix times a displacement, both of shape (V,), without the matrix."""
        if self.kind == "cotangent":
            return np.asarray(self.normal_mass(vertices, directions)[0] @ rate)
        p = self.stencils.patches
        return limit_mass(p, vertices, directions, rate, NOWHERE, np.zeros(0))[4]

    @property
    def point_matrix(self) -> sparse.csr_matrix:
        """Displacements of the surface at its vertices by those of the vertices, shape (V, V)."""
        return self.stencils.limit[0]

    def points(self, vertices: Array) -> Array:
        """Where the vertices lie on the surface, shape (V, 3)."""
        matrix, offsets = self.stencils.limit
        points = matrix @ vertices
        points[:, 0] += offsets
        return points

    def vertices_near(self, points: Array) -> Array:
        """Vertices whose surface passes near ``points``, shape (V, 3).

        They leave the points along the normals only. Interpolation would have to displace them along the surface as well,
        which tangles irregular meshes, and what remains Newton's method removes.
        """
        if self.kind == "cotangent":
            return points
        normals = vertex_normals(self.mesh.moved(points))
        vertices = points
        for _ in range(CORRECTIONS):
            gap = np.einsum("ix,ix->i", points - self.points(vertices), normals)
            vertices = vertices + gap[:, None] * normals
        return vertices


CORRECTIONS = 4
"""Of vertices so that the surface meets given points: each leaves at most half of the gap, and little of a smooth one."""
