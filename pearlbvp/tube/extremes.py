"""Smallest and largest radius of a tube's sections, of the function and not only on a grid."""

from __future__ import annotations

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.tube.waves import Cell, ModeWaves


def extremes(modes: ModeWaves, cell: Cell, coefficients: Array, iterations: int = 6) -> tuple[float, float]:
    """Smallest and largest ``sigma`` of a sum of modes, by Newton's method from the best points of a grid.

    Args:
        modes: the modes.
        cell: a period.
        coefficients: of the modes.
        iterations: of Newton's method; only steps that improve are taken.
    """
    waves = modes.waves
    own = np.abs(waves.b) != 1
    amplitude = (modes.coefficients @ coefficients)[own]
    q = np.stack((waves.p[own] * waves.k, waves.b[own]))  # (2, Q)
    points = tuple(4 * n if n > 1 else 1 for n in cell.points)
    grid = Cell(cell.period, cell.fold, (points[0], points[1]))
    radii = modes.state(grid, coefficients, range(3, 4)).reshape(points)  # sigma is the field b_1
    steps = [2 * np.pi / (unit * n) if unit else 0.0
             for unit, n in zip((cell.period * waves.k, cell.fold), points, strict=True)]  # fmt: skip
    found = []
    for sign in (1.0, -1.0):
        place = np.unravel_index((sign * radii).argmin(), points)
        at, best = np.array(place) * steps, float(sign * radii[place])
        for _ in range(iterations):
            terms = sign * amplitude * np.exp(1j * (at @ q))
            slope = -(q @ terms.imag)
            curvature = -(q * terms.real) @ q.T
            bends, directions = np.linalg.eigh(curvature)
            curved = np.abs(bends) > 1e-8 * np.abs(bends).max(
                initial=1e-300
            )  # not along what the tube does not depend on
            at = at - directions[:, curved] @ (directions.T[curved] @ slope / bends[curved])
            value = float((sign * amplitude * np.exp(1j * (at @ q))).real.sum())
            if not value < best:
                break
            best = value
        found.append(sign * best)
    return found[0], found[1]
