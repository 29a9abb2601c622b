"""The end of a flow: Newton's method from its last shape, and the spectrum there."""

from __future__ import annotations

import numpy as np
from scipy.sparse import issparse

from pearlbvp.arrays import Array
from pearlbvp.bordered import Pinned
from pearlbvp.flows.problem import FlowProblem
from pearlbvp.flows.record import Equilibrium
from pearlbvp.newton import NewtonOptions, newton

FARTHEST = 0.1
"""Change of the coordinates, in radii of the tube, beyond which Newton's method has left for another equilibrium."""

PINS = 16
"""Coordinates at which a sparse matrix is held while it is factorized: more than there are rigid motions."""


def polished(problem: FlowProblem, q: Array, multipliers: Array, kept: Array) -> Equilibrium:
    """The equilibrium near a shape with the same constraints, and its largest growth rates.

    Rigid motions leave a family of equilibria: each gets a phase condition, and a velocity as its multiplier. That is zero at
    a solution but on meshes, whose error lets a shape creep along or turn.

    Args:
        problem: the flow.
        q, multipliers: its last shape.
        kept: values of the constraints.
    """
    form, start = problem.equilibrium(q, multipliers)
    size, k = len(q), len(start)
    kept = np.append(kept, form.constraints(q)[len(kept) :])  # the volume that the H^-1 flow kept by itself
    motions = _independent(form.kernels(q, start) @ form.metric(q), 1e-9 * float(np.linalg.norm(q)))
    still = np.zeros(size)

    def residual(u: Array) -> Array:
        shape, forces, drags = u[:size], u[size : size + k], u[size + k :]
        balance = form.residual(shape, still, forces) + drags @ motions
        return np.concatenate((balance, form.constraints(shape) - kept, motions @ (shape - q)))

    def correct(u: Array, f: Array) -> Array:
        shape = u[:size]
        border = np.hstack((form.columns(shape), motions.T))
        rows = np.vstack((form.constraint_rows(shape), motions))
        inner = form.jacobian(shape, still, u[size : size + k], 0.0)
        corner = np.zeros((border.shape[1],) * 2)
        if issparse(inner):  # held at some points, for the rigid motions all but make it singular
            pins = np.linspace(0, size - 1, PINS).astype(np.int64)
            bordered = Pinned.of(inner.tocsc(), pins).bordered(border, rows, corner)
            return bordered.solve(f[:size, None], f[size:, None])[:, 0]
        return np.asarray(np.linalg.solve(np.block([[inner, border], [rows, corner]]), f))

    found = newton(
        residual, correct, np.concatenate((q, start, np.zeros(len(motions)))), NewtonOptions(tolerance=1e-15)
    )
    shape, forces = found.u[:size], found.u[size : size + k]
    near = found.converged and float(np.abs(shape - q).max()) < FARTHEST
    if not near:
        shape, forces = q, start
    rates = problem.growth_rates(shape, forces[: len(multipliers)])[
        0
    ]  # of this flow, not of another with the same equilibria
    message = found.message if not found.converged else "" if near else "Newton's method left for another equilibrium"
    return Equilibrium(form, shape, forces, near, rates, message)


def _independent(motions: Array, smallest: float) -> Array:
    """An orthonormal basis of some vectors: those that move nothing dropped, and, on a helix, a shift that is a turn."""
    norms = np.linalg.norm(motions, axis=1)
    units = motions[norms > smallest] / norms[norms > smallest, None]
    if not len(units):
        return units
    _, singular, vectors = np.linalg.svd(units, full_matrices=False)
    return np.asarray(vectors[singular > 1e-4])
