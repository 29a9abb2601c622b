"""The axisymmetric equation on one cell: the half between two planes of reflection, and the whole period (design, §4).

The half cell ends in planes of reflection (``psi = w = 0``): four states and the unknowns ``arclength, lambda1, lambda2, v``
against four boundary conditions and three integrals leave a curve of solutions, with no redundancy and no phase. On the
full cell the shift along the axis needs a phase condition, and the conserved axial force makes one of the periodicity
conditions redundant: an unfolding parameter takes its place and must stay at rounding level (F. J. Munoz-Almaraz et al.,
Physica D 181 (2003) 1).
"""

from __future__ import annotations

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation import BoundaryValueProblem, PiecewisePolynomial
from pearlbvp.shapes import axisymmetric, tension

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


HALF_CELL_TENSION = BoundaryValueProblem(
    states=tension.STATES,
    parameters=tension.PARAMETERS,
    rhs=tension.rhs,
    rhs_jacobian=tension.rhs_jacobian,
    boundary=HALF_CELL.boundary,
    boundary_jacobian=HALF_CELL.boundary_jacobian,
    integrand=axisymmetric.constraints,
    integrand_jacobian=axisymmetric.constraints_jacobian,
    mass=tension.mass,
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
