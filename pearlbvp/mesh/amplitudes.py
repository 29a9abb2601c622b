"""Amplitudes of waves on a triangulated tube, by projecting its surface onto the straight one (paper, Appendix B).

``A`` and ``B`` as ``projection`` has them: integrals over the cylinder at each point's own ``x`` and ``phi``. For ``n = 0`` or
``m = 0`` there is one wave, and ``A`` and ``B`` are its amplitude or that turned round.
"""

from __future__ import annotations

import math

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError
from pearlbvp.mesh.functional import Functional
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.subdivision import patches
from pearlbvp.projection import Projection


def amplitudes(surface: PeriodicMesh, m: int, n: int) -> tuple[complex, complex]:
    """``A`` and ``B`` of a polyhedron, functions being linear on its projected triangles: of second order in their size.

    Raises:
        InputError: the surface is no graph over the cylinder, so that waves on it have no amplitude.
    """
    return _of_graph(of_polyhedron(surface), surface.length, m, n)


def amplitudes_at(functional: Functional, vertices: Array, m: int, n: int) -> tuple[complex, complex]:
    """``A`` and ``B`` of a surface, to the order of its discretization: fourth on a limit surface, second on a polyhedron.

    Raises:
        InputError: the surface is no graph over the cylinder.
    """
    return _of_graph(projected(functional, vertices), functional.mesh.length, m, n)


def largest_wave(functional: Functional, vertices: Array) -> float:
    """``2 A`` of the largest wave of a surface, among those of four edges and more; see ``Projection.wave``."""
    mesh = functional.mesh
    edge = 4 * math.sqrt(mesh.area / mesh.count)
    most = int(mesh.length / edge), int(2 * math.pi / edge)
    return projected(functional, vertices).wave(2 * math.pi / mesh.length, (max(most[0], 1), max(most[1], 2)))


def of_polyhedron(surface: PeriodicMesh) -> Projection:
    """A polyhedron over the straight tube: each triangle's corners stand for a third of it."""
    corners = surface.corners
    phi = np.arctan2(corners[..., 2], corners[..., 1])
    phi = phi[:, :1] + np.angle(np.exp(1j * (phi - phi[:, :1])))  # without a jump in a triangle
    x = corners[..., 0]
    area = ((phi[:, 1] - phi[:, 0]) * (x[:, 2] - x[:, 0]) - (phi[:, 2] - phi[:, 0]) * (x[:, 1] - x[:, 0])) / 2
    return _projection(corners.reshape(-1, 3), np.repeat(area / 3, 3), surface.length)


def projected(functional: Functional, vertices: Array) -> Projection:
    """A surface over the straight tube: a limit surface at three points of each of its patches, or a polyhedron."""
    mesh = functional.mesh
    if functional.kind == "cotangent":
        return of_polyhedron(mesh.moved(vertices))
    p = patches(mesh)
    fields = [np.add.reduceat(p.weights[k][:, None] * vertices[p.index], p.start[:-1]) for k in range(3)]
    for field, offset in zip(fields, p.offsets, strict=False):
        field[:, 0] += offset
    point, a, b = fields
    turn_a, turn_b = ((point[:, 1] * t[:, 2] - point[:, 2] * t[:, 1]) / (point[:, 1:] ** 2).sum(axis=1) for t in (a, b))
    return _projection(point, p.weight * (turn_a * b[:, 0] - turn_b * a[:, 0]), mesh.length)


def _projection(points: Array, area: Array, length: float) -> Projection:
    """Points that stand for some area of the straight tube, whose sign is that of most of it."""
    share = area / math.copysign(2 * math.pi * length, area.sum())
    return Projection(points[:, 0], np.arctan2(points[:, 2], points[:, 1]), np.hypot(points[:, 1], points[:, 2]), share)


def _of_graph(projection: Projection, length: float, m: int, n: int) -> tuple[complex, complex]:
    """``A`` and ``B`` of a graph over the cylinder; three points in a row belong to a triangle."""
    share = projection.share
    if abs(share.sum()) < 0.99 * np.abs(share).sum():
        raise InputError(
            "surface",
            f"triangle {int(share.argmin()) // 3} is folded over as seen from the axis",
            "amplitudes need a graph over it",
        )
    first, second = projection.amplitudes(2 * math.pi / length, np.array([m]), np.array([n])).ravel()
    return complex(first), complex(second)
