"""Cross-sections of a mesh at planes across the axis: their centres, and radii measured from them."""

from __future__ import annotations

import numpy as np

from pearlbvp.mesh.periodic import Array, PeriodicMesh

PLANES = 48
"""Sections of a period whose centres are computed; between them they are a trigonometric sum."""


def centres(mesh: PeriodicMesh, x: Array) -> Array:
    """Centroids of the sections at some places along the tube, shape (K, 2): y and z."""
    corners = mesh.corners
    found = np.empty((len(x), 2))
    for row, place in enumerate(x):
        heights = corners[..., 0] - place
        heights = heights - mesh.length * np.round(heights.mean(axis=1) / mesh.length)[:, None]
        cut = np.flatnonzero((heights.min(axis=1) < 0) & (heights.max(axis=1) >= 0))
        h, c = heights[cut], corners[cut][..., 1:]
        below = h < 0
        into = np.argmax(below & ~np.roll(below, -1, axis=1), axis=1)  # the edge that rises through the plane
        out = np.argmax(~below & np.roll(below, -1, axis=1), axis=1)  # the one that falls
        ends = []
        for edge in (into, out):
            first, last = np.arange(len(cut)), (edge + 1) % 3
            h0, h1 = h[first, edge], h[first, last]
            ends.append(c[first, edge] + (h0 / (h0 - h1))[:, None] * (c[first, last] - c[first, edge]))
        p, q = ends
        twice = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]  # Green's formulas, a segment a triangle
        found[row] = (twice[:, None] * (p + q)).sum(axis=0) / (3 * twice.sum())
    return found


def radii(mesh: PeriodicMesh) -> tuple[float, float]:
    """Smallest and largest distance of the vertices from the centres of their sections."""
    first = 1e-9 * mesh.length  # not through the rows of a structured mesh
    known = centres(mesh, first + np.arange(PLANES) / PLANES * mesh.length)
    waves = np.exp(2j * np.pi * np.outer((mesh.vertices[:, 0] - first) / mesh.length, np.arange(PLANES // 2)))
    coefficients = np.fft.rfft(known, axis=0)[: PLANES // 2] / PLANES
    coefficients[1:] *= 2
    distance = np.linalg.norm(mesh.vertices[:, 1:] - (waves @ coefficients).real, axis=1)
    return float(distance.min()), float(distance.max())
