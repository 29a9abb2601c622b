"""Amplitudes of waves on a triangulated tube, by projecting its vertices onto the straight one (paper, Appendix B)."""

from __future__ import annotations

import math

import numpy as np

from pearlbvp.errors import InputError
from pearlbvp.mesh.periodic import PeriodicMesh


def amplitudes(surface: PeriodicMesh, m: int, n: int) -> tuple[complex, complex]:
    """``A`` and ``B`` of ``r - 1 = A e^{i(kx + n phi)} + B e^{i(kx - n phi)} + c.c. + other waves``, ``k = 2 pi m/L``.

    A vertex is projected onto the cylinder at its own ``x`` and ``phi``; integrals over the cylinder are those of piecewise
    linear functions on the projected triangles. For ``n = 0`` or ``m = 0`` there is one wave, and ``A`` and ``B`` are its
    amplitude or that turned round.

    Raises:
        InputError: the surface is no graph over the cylinder, so that waves on it have no amplitude.
    """
    corners = surface.corners
    r = np.hypot(corners[..., 1], corners[..., 2])
    phi = np.arctan2(corners[..., 2], corners[..., 1])
    phi = phi[:, :1] + np.angle(np.exp(1j * (phi - phi[:, :1])))  # without a jump in a triangle
    x = corners[..., 0]
    area = ((phi[:, 1] - phi[:, 0]) * (x[:, 2] - x[:, 0]) - (phi[:, 2] - phi[:, 0]) * (x[:, 1] - x[:, 0])) / 2
    if abs(area.sum()) < 0.99 * np.abs(area).sum():
        folded = int(np.argmin(area * np.sign(area.sum())))
        raise InputError(
            f"surface: triangle {folded} is folded over as seen from the axis; amplitudes need a graph over it"
        )
    k = 2 * math.pi * m / surface.length
    shares = np.abs(area)[:, None] / (3 * np.abs(area).sum())
    found = [complex((shares * (r - 1) * np.exp(-1j * (k * x + s * n * phi))).sum()) for s in (1, -1)]
    return found[0], found[1]
