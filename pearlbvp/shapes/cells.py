"""The axisymmetric equation on one cell: the half between two planes of reflection, and the whole period.

See ``docs/theory/axisymmetric.md``. The half cell ends in planes of reflection (``psi = w = 0``): four states and the
unknowns ``arclength, lambda1, lambda2, v`` against four boundary conditions and three integrals leave a curve of solutions,
with no redundancy and no phase. On the full cell the shift along the axis needs a phase condition, and the conserved axial
force makes one of the periodicity conditions redundant: an unfolding parameter takes its place and must stay at rounding
level (F. J. Munoz-Almaraz et al., Physica D 181 (2003) 1).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation import BoundaryValueProblem, Discretization, PiecewisePolynomial
from pearlbvp.shapes import axisymmetric, large_multipliers

_ENDS = np.zeros((4, 4)), np.zeros((4, 4)), np.zeros((4, 6))
_ENDS[0][0, 1] = _ENDS[0][1, 3] = _ENDS[1][2, 1] = _ENDS[1][3, 3] = 1.0

HALF_CELL = BoundaryValueProblem(
    states=axisymmetric.STATES,
    parameters=axisymmetric.PARAMETERS,
    rhs=axisymmetric.rhs,
    rhs_jacobian=axisymmetric.rhs_jacobian,
    boundary=lambda ya, yb, p: np.array([ya[1], ya[3], yb[1], yb[3]]),
    boundary_jacobian=lambda ya, yb, p: _ENDS,
    integrand=axisymmetric.constraints,
    integrand_jacobian=axisymmetric.constraints_jacobian,
)


HALF_CELL_LARGE = BoundaryValueProblem(
    states=large_multipliers.STATES,
    parameters=large_multipliers.PARAMETERS,
    rhs=large_multipliers.rhs,
    rhs_jacobian=large_multipliers.rhs_jacobian,
    boundary=HALF_CELL.boundary,
    boundary_jacobian=HALF_CELL.boundary_jacobian,
    integrand=axisymmetric.constraints,
    integrand_jacobian=axisymmetric.constraints_jacobian,
    mass=large_multipliers.mass,
)
"""The half cell in the chart of large multipliers; its boundary conditions and integrals are the same."""


def full_cell(reference: PiecewisePolynomial) -> BoundaryValueProblem:
    """The periodic problem, its phase fixed against ``reference``.

    Args:
        reference: derivative by ``sigma`` of some profile of the same shape. The phase condition is
            ``integral of reference . y = 0``, which holds for the profile itself.

    The unfolding parameter ``drag`` adds ``drag * r sin psi`` to ``w'``, which would change the axial force by
    ``-drag * (r sin psi)^2`` all along.
    """

    def rhs(t: Array, y: Array, p: Array) -> Array:
        f: Array = axisymmetric.rhs(t, y, p)
        f[:, 3] += p[6] * y[:, 0] * np.sin(y[:, 1])
        return f

    def rhs_jacobian(t: Array, y: Array, p: Array) -> tuple[Array, Array]:
        by_y, by_p = axisymmetric.rhs_jacobian(t, y, p)
        r, sine, cosine = y[:, 0], np.sin(y[:, 1]), np.cos(y[:, 1])
        by_y[:, 3, 0] += p[6] * sine
        by_y[:, 3, 1] += p[6] * r * cosine
        by_drag = np.zeros((len(y), 4, 1))
        by_drag[:, 3, 0] = r * sine
        return by_y, np.concatenate((by_p, by_drag), axis=2)

    def integrand(t: Array, y: Array, p: Array) -> Array:
        return np.column_stack((axisymmetric.constraints(t, y, p), (reference(t) * y).sum(axis=1)))

    def integrand_jacobian(t: Array, y: Array, p: Array) -> tuple[Array, Array]:
        by_y, by_p = axisymmetric.constraints_jacobian(t, y, p)
        by_y = np.concatenate((by_y, reference(t)[:, None, :]), axis=1)
        return by_y, np.pad(by_p, ((0, 0), (0, 1), (0, 1)))

    ends = np.eye(4), -np.eye(4), np.zeros((4, 7))
    return BoundaryValueProblem(
        states=axisymmetric.STATES,
        parameters=(*axisymmetric.PARAMETERS, "drag"),
        rhs=rhs,
        rhs_jacobian=rhs_jacobian,
        boundary=lambda ya, yb, p: ya - yb,
        boundary_jacobian=lambda ya, yb, p: ends,
        integrand=integrand,
        integrand_jacobian=integrand_jacobian,
    )


_MIRROR = np.array([1.0, -1.0, 1.0, -1.0])
"""What a plane of reflection does to ``r, psi, h, w``."""


def mirrored(
    half: Discretization, u: Array, *tangents: Array
) -> tuple[Discretization, PiecewisePolynomial, list[Array]]:
    """The full cell around a solution of the half cell.

    Returns:
        Its discretization; the slopes of the solution, as reference of the phase; the solution and the tangents in it.
    """
    p = half.all_parameters(u)
    mesh = np.append(half.mesh / 2, 1 - half.mesh[-2::-1] / 2)
    parameters = np.append(p * _scale(2), 0.0)

    def whole(values: Array) -> Array:
        return np.vstack((values, (values[::-1] * _MIRROR)[1:]))

    states = PiecewisePolynomial(mesh, whole(half.values(u)))
    slopes = np.asarray(axisymmetric.rhs(states.points, states.values, parameters))
    reference = PiecewisePolynomial(mesh, slopes)
    full = Discretization(full_cell(reference), half.scheme, mesh, parameters, (*half.free, "drag"), half.weights)
    moved = []
    for vector in (u, *tangents):
        free = vector[vector.size - len(half.free) :] * _scale(2)[half.free_index]
        moved.append(np.concatenate((whole(half.values(vector)).ravel(), free, [0.0])))
    return full, reference, moved


def repeated_cells(half: Discretization, cells: int, neck: bool, *vectors: Array) -> tuple[Discretization, list[Array]]:
    """Half-cell solutions as solutions of a period ``cells`` times as long, on the half of that from a plane of reflection.

    Args:
        half: the half cell, from belly to neck.
        cells: how many periods become one.
        neck: whether a neck stands at the first plane of reflection, else a belly.
        vectors: solutions or tangents.
    """
    order = [(i + neck) % 2 for i in range(cells)]  # 0: belly to neck, 1: neck to belly
    meshes = [(i + (half.mesh[1:] if way == 0 else 1 - half.mesh[-2::-1])) / cells for i, way in enumerate(order)]
    mesh = np.concatenate((np.zeros(1), *meshes))
    mesh[-1] = 1.0
    discretization = replace(half, mesh=mesh, parameters=half.parameters * _scale(cells))
    moved = []
    for vector in vectors:
        forth = half.values(vector)
        back = forth[::-1] * _MIRROR
        parts = [(forth, back)[way][min(i, 1) :] for i, way in enumerate(order)]
        free = vector[vector.size - len(half.free) :] * _scale(cells)[half.free_index]
        moved.append(np.concatenate((np.vstack(parts).ravel(), free)))
    return discretization, moved


def _scale(cells: int) -> Array:
    """Factors of the parameters when several cells become one."""
    return np.array([cells if name in ("arclength", "length") else 1.0 for name in axisymmetric.PARAMETERS])
