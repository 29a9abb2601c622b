"""Least energy at fixed constraints: a trust-region Newton method, one for all discretizations.

Each step lies in the constraints' tangent space and solves the quadratic model of the Lagrangian exactly in a ball, by the
eigenvalues of the reduced Hessian (J. Nocedal, S. J. Wright, Numerical Optimization (Springer 2006), §4.3): what grows is
left along its most unstable direction, so that the end is a minimum and no saddle. The shape is then moved back to the
constraints along their gradients, which changes the energy at third order only (P.-A. Absil, J. Malick, SIAM J. Optim. 22
(2012) 135), so that the last steps converge quadratically.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.representation import brief
from pearlbvp.roots import root

FEASIBLE = 1e-13
"""Constraints that are met."""

ROUNDED, SHORTEST = 1e-11, 1e-3
"""Size of constraints at which rounding may keep them from falling, and share of Newton's step that is given up."""

FLAT = 1e-9
"""Eigenvalue of the scaled Hessian, by 1, below which a direction is a rigid motion's."""

ACCEPTED, GOOD = 0.1, 0.75
"""Share of the predicted fall of the energy at which a step is taken, and at which the next may be longer."""

ROUNDING = 1e-13
"""Predicted fall of the energy that rounding hides: there steps are Newton's, without comparing energies."""


class Landscape(Protocol):
    """An energy and constraints as functions of ``N`` coordinates; not a number where the coordinates are no shape."""

    @property
    def scales(self) -> Array:
        """Sizes of the coordinates, shape (N,), in which the energy's second derivatives are alike."""

    def energy(self, q: Array) -> float:
        """The energy."""

    def gradient(self, q: Array) -> Array:
        """Its derivatives, shape (N,)."""

    def constraints(self, q: Array) -> Array:
        """What is to vanish, shape (m,)."""

    def constraint_rows(self, q: Array) -> Array:
        """Their derivatives, shape (m, N)."""

    def hessian(self, q: Array, multipliers: Array) -> Array:
        """Second derivatives of the energy plus multipliers times constraints, shape (N, N)."""


@dataclass(frozen=True)
class Minimum:
    """What the method came to.

    Attributes:
        q, multipliers: coordinates and multipliers of the last iterate.
        energy: its energy.
        steps: how many were tried.
        reason: empty where it is a minimum, else why it is none.
    """

    __repr__ = brief

    q: Array
    multipliers: Array
    energy: float
    steps: int
    reason: str = ""


def onto_constraints(landscape: Landscape, q: Array, longest: float = 0.3, most: int = 60) -> Array | None:
    """The coordinates moved along the constraints' gradients until these are met; None where that fails.

    Args:
        landscape, q: where to start.
        longest: scaled length of a step, for starts that are far from meeting them.
        most: steps.
    """
    squares = landscape.scales**2
    lack = landscape.constraints(q)
    for _ in range(most):
        if not np.isfinite(lack).all():
            return None
        if np.abs(lack).max() < FEASIBLE:
            return q
        rows = landscape.constraint_rows(q)
        along = np.linalg.lstsq((rows * squares) @ rows.T, lack, rcond=1e-12)[0] @ rows
        share = min(1.0, longest / max(float(np.linalg.norm(along * landscape.scales)), 1e-300))
        before = float(np.linalg.norm(lack))
        while True:
            trial = q - share * squares * along
            lack = landscape.constraints(trial)
            if np.linalg.norm(lack) < before or (before < ROUNDED and np.isfinite(lack).all()):
                break
            share /= 2
            if share < SHORTEST:
                return None
        q = trial
    return None


def least(
    landscape: Landscape, q: Array, *, tolerance: float = 1e-9, most: int = 200, trust: float = 0.2, widest: float = 1.0
) -> Minimum:
    """The minimum that lies downhill.

    Args:
        landscape: the energy.
        q: where to start; it need not meet the constraints.
        tolerance: of the reduced gradient, in the scaled coordinates.
        most: steps that are tried at most.
        trust, widest: first and largest length of a step, in the scaled coordinates.
    """
    scales = landscape.scales
    start = onto_constraints(landscape, q)
    if start is None:
        return Minimum(q, np.zeros(0), np.nan, 0, "no shape of these constraints was reached")
    q, energy = start, landscape.energy(start)
    model = None
    for step in range(most):
        if model is None:
            rows, gradient = landscape.constraint_rows(q) * scales, landscape.gradient(q) * scales
            multipliers = np.asarray(np.linalg.lstsq(rows.T, -gradient, rcond=1e-12)[0], dtype=np.float64)
            normals = np.linalg.qr(rows.T, mode="complete")[0]
            tangents = normals[:, len(rows) :]
            second = landscape.hessian(q, multipliers) * scales * scales[:, None]
            bends, directions = np.linalg.eigh(tangents.T @ second @ tangents)
            slopes = directions.T @ (tangents.T @ gradient)
            model = tangents @ directions
            slopes[(np.abs(bends) < FLAT) & (np.abs(slopes) < tolerance)] = 0.0
        if np.linalg.norm(slopes) < tolerance and bends[0] > -FLAT:
            return Minimum(q, multipliers, energy, step)
        if trust < 1e-9:
            return Minimum(
                q, multipliers, energy, step, "no step lowers the energy: the shape is not resolved, or closes"
            )
        along = step_within(bends, slopes, trust)
        predicted = -float(slopes @ along + bends @ along**2 / 2)
        trial = onto_constraints(landscape, q + scales * (model @ along), most=12)
        found = np.nan if trial is None else landscape.energy(trial)
        ratio = 1.0 if abs(predicted) < ROUNDING and np.isfinite(found) else (energy - found) / predicted
        length = float(np.linalg.norm(along))
        if not ratio > ACCEPTED:  # also where it is no number
            trust = length / 4
            continue
        if ratio > GOOD and length > 0.8 * trust:
            trust = min(2 * trust, widest)
        assert trial is not None
        q, energy, model = trial, float(found), None
    return Minimum(q, multipliers, energy, most, f"no minimum in {most} steps")


def step_within(bends: Array, slopes: Array, trust: float) -> Array:
    """The least of ``slopes . y + bends . y^2 / 2`` in a ball, shape (N,).

    Args:
        bends: eigenvalues, the smallest first.
        slopes: derivatives along the eigenvectors.
        trust: of the ball.
    """
    flat = np.abs(slopes) == 0

    def at(shift: float) -> Array:
        return np.asarray(np.where(flat, 0.0, -slopes / np.where(flat, 1.0, bends + shift)))

    if bends[0] > -FLAT:
        inside = at(max(0.0, 2 * FLAT - bends[0]))
        if np.linalg.norm(inside) <= trust:
            return inside
    lowest = max(0.0, -bends[0])
    low, high = lowest + 1e-12 * max(1.0, lowest), lowest + float(np.linalg.norm(slopes)) / trust + 1e-12
    along = at(low)
    if (
        np.linalg.norm(along) < trust
    ):  # nothing pushes along the most unstable direction: the rest of the way is along that
        along[0] += np.sqrt(trust**2 - float(np.linalg.norm(along)) ** 2)
        return along
    shift = root(lambda t: 1 / float(np.linalg.norm(at(t))) - 1 / trust, low, high, 1e-6 * high)
    return at(shift)
