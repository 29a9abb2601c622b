"""Cross-sections of a mesh at planes across the axis: their centres, and radii measured from them."""

from __future__ import annotations

import numpy as np

from pearlbvp.compiled import compiled
from pearlbvp.mesh.periodic import Array, PeriodicMesh

PLANES = 48
"""Sections of a period whose centres are computed; between them they are a trigonometric sum."""


def centres(mesh: PeriodicMesh, x: Array) -> Array:
    """Centroids of the sections at some places along the tube, shape (K, 2): y and z."""
    moments = _moments(mesh.corners, np.ascontiguousarray(x, dtype=np.float64), mesh.length)
    return moments[:, 1:] / moments[:, :1]


@compiled
def _moments(corners, places, period):  # type: ignore[no-untyped-def]
    """Areas and first moments of the sections, shape (K, 3), by Green's formulas: each triangle adds a segment."""
    found = np.zeros((places.size, 3))
    h, p = np.empty(3), np.empty((2, 2))
    for t in range(corners.shape[0]):
        low = min(corners[t, 0, 0], corners[t, 1, 0], corners[t, 2, 0])
        high = max(corners[t, 0, 0], corners[t, 1, 0], corners[t, 2, 0])
        for row in range(places.size):
            # the triangle's first image whose lower end lies below the plane
            shift = period * np.ceil((places[row] - high) / period)
            if low + shift >= places[row]:
                continue
            for a in range(3):
                h[a] = corners[t, a, 0] + shift - places[row]
            for a in range(3):
                b = a + 1 if a < 2 else 0
                rises, falls = h[a] < 0 <= h[b], h[b] < 0 <= h[a]
                if rises or falls:
                    share = h[a] / (h[a] - h[b])
                    end = 0 if rises else 1
                    for y in range(2):
                        p[end, y] = corners[t, a, y + 1] + share * (corners[t, b, y + 1] - corners[t, a, y + 1])
            twice = p[0, 0] * p[1, 1] - p[0, 1] * p[1, 0]
            found[row, 0] += twice / 2
            found[row, 1] += twice * (p[0, 0] + p[1, 0]) / 6
            found[row, 2] += twice * (p[0, 1] + p[1, 1]) / 6
    return found


def distances(mesh: PeriodicMesh) -> Array:
    """Distance of each vertex from the centre of its section, shape (V,)."""
    first = 1e-9 * mesh.length  # not through the rows of a structured mesh
    known = centres(mesh, first + np.arange(PLANES) / PLANES * mesh.length)
    waves = np.exp(2j * np.pi * np.outer((mesh.vertices[:, 0] - first) / mesh.length, np.arange(PLANES // 2)))
    coefficients = np.fft.rfft(known, axis=0)[: PLANES // 2] / PLANES
    coefficients[1:] *= 2
    return np.linalg.norm(mesh.vertices[:, 1:] - (waves @ coefficients).real, axis=1)


def radii(mesh: PeriodicMesh) -> tuple[float, float]:
    """Smallest and largest distance of the vertices from the centres of their sections."""
    found = distances(mesh)
    return float(found.min()), float(found.max())
