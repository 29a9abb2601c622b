"""Meshes whose coordinates have few digits: smooth again, within their rounding.

Forces are fourth derivatives of the surface. On a tube of 3,000 vertices whose coordinates have four decimals, rounding is most
of them: pressures have the wrong sign. Vertices are moved to where their fourth differences along the mesh - the square of the
graph's Laplacian, coordinate by coordinate - have the least sum of squares among all places that are as far from the written
ones as rounding leaves them on the average (V. A. Morozov's discrepancy principle), and none farther than a unit of the last
digit. Where vertices are no smooth function along the mesh, fourth differences are the mesh's own, and nothing is done.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from pearlbvp.arrays import Array
from pearlbvp.factorization import factorized
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.rounding import NEGLIGIBLE, deviation

WEIGHTS = (-6.0, 6.0)
"""Decimal logarithms of the weight of fourth differences between which it is sought: rounding alone needs about 1."""

HALVINGS = 8
"""Of these; then the weight is known to a tenth."""


def without_rounding(mesh: PeriodicMesh, step: float) -> tuple[PeriodicMesh, float]:
    """The mesh, smooth within its rounding where that matters, and how far vertices were moved at most: 0 where it does not.

    Args:
        mesh: of a tube, in its own unit.
        step: to which its coordinates were rounded.
    """
    laplacian = _laplacian(mesh)
    differences = laplacian @ _pulls(mesh)
    squared = (laplacian @ laplacian).tocsc()
    noise = deviation(step) * np.sqrt(squared.multiply(squared).sum() / mesh.count)
    seen = float(np.sqrt((differences**2).mean()))
    if not noise > NEGLIGIBLE * seen or seen < 1e-14 * mesh.length:
        return mesh, 0.0
    matrix, load = (squared @ squared).tocsc(), squared @ differences
    unit = sparse.eye(mesh.count, format="csc")
    best, (low, high) = np.zeros_like(load), WEIGHTS
    for _ in range(HALVINGS):
        weight = 10 ** ((low + high) / 2)
        factors = factorized((unit + weight * matrix).tocsc())
        moves = -np.column_stack([factors.solve(np.ascontiguousarray(weight * column)) for column in load.T])
        if np.sqrt((moves**2).mean()) > deviation(step) or np.abs(moves).max() > step:
            high = np.log10(weight)
        else:
            low, best = np.log10(weight), moves
    return mesh.moved(mesh.vertices + best), float(np.abs(best).max())


def _laplacian(mesh: PeriodicMesh) -> sparse.csc_matrix:
    """The graph's: the number of neighbours on the diagonal, -1 for each of them."""
    edges = mesh.edges
    i, j, ones = mesh.tail[edges], mesh.head[edges], np.ones(len(edges))
    entries = np.concatenate((ones, ones, -ones, -ones)), (np.concatenate((i, j, i, j)), np.concatenate((i, j, j, i)))
    return sparse.csc_matrix(entries, shape=(mesh.count, mesh.count))


def _pulls(mesh: PeriodicMesh) -> Array:
    """What the Laplacian makes of the vertices, neighbours in the next period being there: minus the sum of the edges."""
    sums = [np.bincount(mesh.tail, mesh.edge_vectors[:, x], minlength=mesh.count) for x in range(3)]
    return np.asarray(-np.column_stack(sums), dtype=np.float64)
