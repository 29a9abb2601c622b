"""Amplitudes of waves on a triangulated tube, by projecting its surface onto the straight one (paper, Appendix B).

``A`` and ``B`` of ``r - 1 = A e^{i(kx + n phi)} + B e^{i(kx - n phi)} + c.c. + other waves``, ``k = 2 pi m/L``, as the
amplitude equations take them (``theory.amplitude``): integrals over the cylinder at each point's own ``x`` and ``phi``. For
``n = 0`` or ``m = 0`` there is one wave, and ``A`` and ``B`` are its amplitude or that turned round.
"""

from __future__ import annotations

import math

import numpy as np

from pearlbvp.errors import InputError
from pearlbvp.mesh.periodic import Array, PeriodicMesh
from pearlbvp.mesh.problem import MeshProblem
from pearlbvp.mesh.subdivision import patches


def amplitudes(surface: PeriodicMesh, m: int, n: int) -> tuple[complex, complex]:
    """``A`` and ``B`` of a polyhedron, functions being linear on its projected triangles: of second order in their size.

    Raises:
        InputError: the surface is no graph over the cylinder, so that waves on it have no amplitude.
    """
    corners = surface.corners
    phi = np.arctan2(corners[..., 2], corners[..., 1])
    phi = phi[:, :1] + np.angle(np.exp(1j * (phi - phi[:, :1])))  # without a jump in a triangle
    x = corners[..., 0]
    area = ((phi[:, 1] - phi[:, 0]) * (x[:, 2] - x[:, 0]) - (phi[:, 2] - phi[:, 0]) * (x[:, 1] - x[:, 0])) / 2
    return _projected(corners.reshape(-1, 3), np.repeat(area / 3, 3), 3, surface.length, m, n)


def amplitudes_at(problem: MeshProblem, u: Array, m: int, n: int) -> tuple[complex, complex]:
    """``A`` and ``B`` of a solution, to the order of its discretization: fourth on a limit surface, second on a polyhedron.

    Raises:
        InputError: the surface is no graph over the cylinder.
    """
    if problem.kind == "cotangent":
        return amplitudes(problem.surface(u), m, n)
    p, vertices = patches(problem.mesh), problem.vertices(u)
    fields = [np.add.reduceat(p.weights[k][:, None] * vertices[p.index], p.start[:-1]) for k in range(3)]
    for field, offset in zip(fields, p.offsets, strict=False):
        field[:, 0] += offset
    point, a, b = fields
    turn_a, turn_b = ((point[:, 1] * t[:, 2] - point[:, 2] * t[:, 1]) / (point[:, 1:] ** 2).sum(axis=1) for t in (a, b))
    return _projected(point, p.weight * (turn_a * b[:, 0] - turn_b * a[:, 0]), 3, problem.length, m, n)


def _projected(points: Array, area: Array, each: int, length: float, m: int, n: int) -> tuple[complex, complex]:
    """Means of ``(r - 1) e^{-i(kx +- n phi)}`` over the cylinder: points stand for some ``area`` of it, ``each`` a triangle."""
    if abs(area.sum()) < 0.99 * np.abs(area).sum():
        folded = int(np.argmin(area * np.sign(area.sum()))) // each
        raise InputError(
            f"surface: triangle {folded} is folded over as seen from the axis; amplitudes need a graph over it"
        )
    r, phi = np.hypot(points[:, 1], points[:, 2]), np.arctan2(points[:, 2], points[:, 1])
    weights = np.abs(area) / np.abs(area).sum() * (r - 1)
    k = 2 * math.pi * m / length
    first, second = (complex((weights * np.exp(-1j * (k * points[:, 0] + s * n * phi))).sum()) for s in (1, -1))
    return first, second
