"""Cross-sections of a mesh at planes across the axis: their centres, and radii measured from them."""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg import toeplitz

from pearlbvp.arrays import Array, Complex
from pearlbvp.compiled import compiled
from pearlbvp.mesh.functional import Functional
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.subdivision import Patches

PLANES = 48
"""Sections of a period whose centres are computed; between them they are a trigonometric sum."""

EDGES = 3.0
"""Length of the shortest wave of a limit surface's centres, in mean edges."""

FARTHEST = 2.0
"""Distance of quadrature points in the parameters of their patches."""


def centres(mesh: PeriodicMesh, x: Array) -> Array:
    """Centroids of the sections at some places along the tube, shape (K, 2): y and z."""
    moments = np.zeros((len(x), 3))
    _moments(
        mesh.corners, np.ascontiguousarray(x, dtype=np.float64), mesh.length, np.empty(3), np.empty((2, 2)), moments
    )
    return moments[:, 1:] / moments[:, :1]


@compiled
def _moments(corners, places, period, h, p, found):  # type: ignore[no-untyped-def]
    """Areas and first moments of the sections, shape (K, 3), by Green's formulas: each triangle adds a segment.

    ``h`` and ``p``, shapes (3,) and (2, 2), are room to work in.
    """
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


def one_period(mesh: PeriodicMesh) -> Array:
    """Corners of the triangles of the period between the planes ``x = 0`` and ``x = L``, cut off there, shape (T', 3, 3)."""
    corners, length = mesh.reduced().corners, mesh.length
    x, step = corners[..., 0], np.array([length, 0.0, 0.0])
    images = np.concatenate((corners, corners[x.min(axis=1) < 0] + step, corners[x.max(axis=1) > length] - step))
    return _above(_above(images, 0.0, 1.0), -length, -1.0)


def _above(corners: Array, height: float, side: float) -> Array:
    """The parts of triangles where ``side x > height``, as triangles that are oriented alike."""
    h = side * corners[..., 0] - height
    number = (h > 0).sum(axis=1)
    # the one corner that differs from both others first
    odd = np.where(number == 1, h.argmax(axis=1), h.argmin(axis=1))
    places = np.arange(len(h))[:, None], (odd[:, None] + np.arange(3)) % 3
    h, turned = h[places], corners[places]
    a, b, c = turned[:, 0], turned[:, 1], turned[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):  # where the plane does not pass
        ab, ac = (
            (h[:, 0, None] * other - h[:, i, None] * a) / (h[:, 0] - h[:, i])[:, None] for i, other in ((1, b), (2, c))
        )
    one, two = number == 1, number == 2
    pieces = [
        np.stack(piece, axis=1)[rows] for rows, piece in ((one, (a, ab, ac)), (two, (ab, b, c)), (two, (ab, c, ac)))
    ]
    return np.concatenate((corners[number == 3], *pieces))


def distances(mesh: PeriodicMesh) -> Array:
    """Distance of each vertex from the centre of its section, shape (V,)."""
    first = 1e-9 * mesh.length  # not through the rows of a structured mesh
    known = centres(mesh, first + np.arange(PLANES) / PLANES * mesh.length)
    coefficients = np.fft.rfft(known, axis=0)[: PLANES // 2] / PLANES
    coefficients[1:] *= 2
    return np.sqrt(_squares(mesh.vertices - [first, 0.0, 0.0], coefficients, 2 * math.pi / mesh.length))


def radii(functional: Functional, vertices: Array) -> tuple[float, float]:
    """Smallest and largest distance of a surface from the centres of its sections.

    Centres are centroids. Of a polyhedron at its vertices; of a limit surface between its quadrature points, too: of fourth
    order in the mesh width. (Reduced modes take the centre about which a section's radius has no first wave.)

    Args:
        functional: the discretization.
        vertices: shape (V, 3).
    """
    if functional.kind == "cotangent":
        found = distances(functional.mesh.moved(vertices))
        return float(found.min()), float(found.max())
    length, p = functional.mesh.length, functional.quadrature
    waves = int(np.clip(length / (EDGES * functional.mesh.edge_lengths.mean()), 1, PLANES // 2))
    points, volumes, moments = _volumes(p, vertices, 2 * math.pi / length, waves)
    centre = _projected_centres(volumes, moments)
    squares = _squares(points, centre, 2 * math.pi / length)
    thin, thick = (
        sign * _extreme(vertices, p, int((sign * squares).argmin()), sign, centre, length) for sign in (1.0, -1.0)
    )
    return math.sqrt(max(thin, 0.0)), math.sqrt(thick)


def _projected_centres(volumes: Complex, moments: Complex) -> Complex:
    """Waves of the centres ``c(x)``, shape (K + 1, 2), from those of the sections' areas ``A`` and first moments ``M``.

    ``A c = M`` in the mean against every wave up to the K-th: a matrix that is positive definite, as ``A > 0``, even where
    necks are so thin that the sum of waves of ``A`` is not.
    """
    areas = toeplitz(volumes, volumes.conj())
    waves = len(moments) - 1
    both = np.concatenate((moments[:0:-1].conj(), moments))
    found = np.linalg.solve(areas, both)[waves:]
    found[1:] *= 2  # with its conjugate
    return np.asarray(found)


def _volumes(p: Patches, vertices: Array, k: float, waves: int) -> tuple[Array, Complex, Complex]:
    """Quadrature points of a limit surface, and waves of the areas and first moments of its sections.

    ``int A e^{-ijkx} dx`` is the integral of ``e^{-ijkx}`` over the volume, and by the theorem of Gauss one over the surface,
    which needs no section: of ``(y, z)/2`` times the wave, for first moments of ``y (y, z)/3`` and ``z (y, z)/3``.
    """
    points, a, b = p.tangents(vertices)
    y, z = points[:, 1], points[:, 2]
    flux = p.weight * (y * (a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]) + z * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))
    densities = np.vstack((flux / 2, flux * y / 3, flux * z / 3))
    step = np.exp(-1j * k * points[:, 0])
    found, wave = np.empty((2 * waves + 1, 3), dtype=complex), np.ones_like(step)
    for j in range(2 * waves + 1):
        found[j] = (densities @ _parts(wave)).view(complex)[:, 0]
        wave *= step
    return points, found[:, 0], found[: waves + 1, 1:]


def _parts(wave: Complex) -> Array:
    """Real and imaginary parts as columns: products with real matrices take half as long so."""
    return wave.view(np.float64).reshape(-1, 2)


def _squares(points: Array, centre: Complex, k: float) -> Array:
    """Squared distances of points from the centres."""
    step = np.exp(1j * k * points[:, 0])
    wave, apart = step.copy(), points[:, 1:] - centre[0].real
    for c in centre[1:]:
        apart -= _parts(wave) @ np.vstack((c.real, -c.imag))
        wave *= step
    return np.einsum("ij,ij->i", apart, apart)


def _extreme(vertices: Array, p: Patches, q: int, sign: float, centre: Complex, length: float) -> float:
    """Least of ``sign`` times the squared distance near a quadrature point: of its parabola, in the patch's parameters.

    Along a line of equal distances the parabola is flat, and a step that would lead further than the next point is cut off.
    """
    terms = slice(p.start[q], p.start[q + 1])
    fields = p.weights[:, terms] @ vertices[p.index[terms]]
    fields[:, 0] += p.offsets[:, q]
    x, across = fields[:, 0], fields[:, 1:]
    k = 2j * math.pi / length * np.arange(len(centre))
    c, c1, c2 = (((k**order * np.exp(k * x[0])) @ centre).real for order in range(3))
    e, e_v, e_w = across[0] - c, across[1] - c1 * x[1], across[2] - c1 * x[2]
    second = [across[row] - c1 * x[row] - c2 * x[one] * x[two] for row, one, two in ((3, 1, 1), (4, 1, 2), (5, 2, 2))]
    gradient = 2 * sign * np.array([e @ e_v, e @ e_w])
    vv, vw, ww = (e_a @ e_b + e @ s for e_a, e_b, s in zip((e_v, e_v, e_w), (e_v, e_w, e_w), second, strict=True))
    curvatures, directions = np.linalg.eigh(2 * sign * np.array([[vv, vw], [vw, ww]]))
    slopes = np.abs(directions.T @ gradient)
    steps = np.minimum(slopes / np.maximum(curvatures, 1e-300), FARTHEST)
    return float(sign * (e @ e) - slopes @ steps + curvatures @ steps**2 / 2)
