"""Discrete differential geometry of a periodic mesh: stiffness, masses, normals, curvatures (paper, Appendix B).

Everything comes from edge vectors, which know their period; so the tube is never cut. Curvatures have the package's
signs: ``H = +1/2`` on the unit cylinder.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from pearlbvp.arrays import Array
from pearlbvp.mesh.periodic import PeriodicMesh, known_mesh


def cotangents(mesh: PeriodicMesh) -> Array:
    """Cotangent of the angle at each corner, shape (T, 3)."""
    edges = mesh.edge_vectors.reshape(-1, 3, 3)
    found = np.empty((len(edges), 3))
    for a in range(3):
        found[:, a] = -np.einsum("tx,tx->t", edges[:, a], edges[:, a - 1]) / (2 * mesh.areas)
    return found


def stiffness(mesh: PeriodicMesh) -> sparse.csr_matrix:
    """Cotangent stiffness ``integral of <grad phi_k, grad phi_l>``, positive semidefinite, shape (V, V).

    Source: paper, Appendix B; U. Pinkall, K. Polthier, Experim. Math. 2 (1993) 15.
    """
    opposite = cotangents(mesh)[:, [2, 0, 1]].ravel() / 2  # the edge from corner a is opposite to corner a + 2
    rows = np.concatenate((mesh.tail, mesh.head, mesh.tail, mesh.head))
    columns = np.concatenate((mesh.head, mesh.tail, mesh.tail, mesh.head))
    values = np.concatenate((-opposite, -opposite, opposite, opposite))
    return sparse.csr_matrix((values, (rows, columns)), shape=(mesh.count, mesh.count))


def _at_vertices(mesh: PeriodicMesh, at_corners: Array) -> Array:
    """Sums over the corners at each vertex."""
    return np.bincount(mesh.triangles.ravel(), at_corners.ravel(), minlength=mesh.count).astype(np.float64)


def barycentric_mass(mesh: PeriodicMesh) -> Array:
    """A third of the area of the triangles at each vertex, shape (V,)."""
    return _at_vertices(mesh, np.repeat(mesh.areas / 3, 3))


def voronoi_mass(mesh: PeriodicMesh) -> Array:
    """Mixed Voronoi areas, shape (V,); a right or obtuse triangle gives half to that corner, a quarter to the others.

    Source: M. Meyer, M. Desbrun, P. Schröder, A. Barr, in: Visualization and Mathematics III (Springer 2003), §3.3.
    """
    cot = cotangents(mesh)
    squares = mesh.edge_lengths**2
    # corner a: edges to a + 1 (opposite a + 2) and to a + 2 (opposite a + 1)
    voronoi = (squares * cot[:, [2, 0, 1]] + squares[:, [2, 0, 1]] * cot[:, [1, 2, 0]]) / 8
    obtuse = cot < 0
    halves = np.where(obtuse, mesh.areas[:, None] / 2, mesh.areas[:, None] / 4)
    return _at_vertices(mesh, np.where(np.any(obtuse, axis=1, keepdims=True), halves, voronoi))


def area_gradient(mesh: PeriodicMesh) -> Array:
    """Gradient of the area by the vertices, shape (V, 3): the cotangent Laplacian of the positions."""
    unit = mesh.area_vectors / mesh.areas[:, None]
    edges = mesh.edge_vectors.reshape(-1, 3, 3)
    by_corner = np.cross(unit[:, None], edges[:, [1, 2, 0]]) / 2  # corner a by the edge from a + 1 to a + 2
    return np.column_stack([_at_vertices(mesh, by_corner[..., x]) for x in range(3)])


def volume_gradient(mesh: PeriodicMesh) -> Array:
    """Gradient of the volume by the vertices, shape (V, 3): a third of the area vectors about each."""
    return np.column_stack([_at_vertices(mesh, np.repeat(mesh.area_vectors[:, x] / 3, 3)) for x in range(3)])


def vertex_normals(mesh: PeriodicMesh) -> Array:
    """Outward unit normals, those of the triangles weighted by area, shape (V, 3)."""
    normals = volume_gradient(mesh)
    return np.asarray(normals / np.linalg.norm(normals, axis=1)[:, None])


def mean_curvature(mesh: PeriodicMesh) -> Array:
    """``H`` from ``M H = <L X, N>/2`` with the mixed Voronoi mass, shape (V,) (paper, Appendix B).

    Raises:
        InputError: it is no triangulated tube.

    Examples:
        >>> from pearlbvp.mesh.families import tube_mesh
        >>> errors = [abs(mean_curvature(tube_mesh(10, nodes)) - 0.5).max() for nodes in (500, 2000)]
        >>> round(float(errors[0] / errors[1]))  # of second order in the mesh width
        4
    """
    known_mesh(mesh)
    return np.einsum("ix,ix->i", area_gradient(mesh), vertex_normals(mesh)) / (2 * voronoi_mass(mesh))


def gaussian_curvature(mesh: PeriodicMesh) -> Array:
    """``K`` from the angles about each vertex by Gauss-Bonnet, over the mixed Voronoi mass, shape (V,).

    The integral of ``K`` is 0 on every tube, to rounding.

    Raises:
        InputError: it is no triangulated tube.
    """
    known_mesh(mesh)
    angles = np.arctan2(1.0, cotangents(mesh))
    return (2 * np.pi - _at_vertices(mesh, angles)) / voronoi_mass(mesh)
