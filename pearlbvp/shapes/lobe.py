"""Half a lobe of a plane elastica under pressure, as a boundary-value problem: from tip to waist.

Its unit of length is ``2/n`` radii, in which half a lobe is ``pi/2`` long for every ``n`` and its numbers do not grow with
``n``: states ``psi, kappa, slope`` (turn of the tangent, curvature, its derivative), by ``t = 2 s/pi`` in [0, 1],

    psi' = (pi/2) kappa    kappa' = (pi/2) slope    slope' = (pi/2) (a kappa + p - kappa^3/2),

``psi = slope = 0`` at the tip, ``psi = pi/n, slope = 0`` at the waist. Force balance makes the position times ``p`` the force
turned by a right angle, hence the enclosed area a mean over the arc, with no position among the states:

    mean of (kappa^2/2 - a) = (n/2) p v.

Five conditions for three states and ``a, p, v`` leave a curve of solutions.
"""

from __future__ import annotations

import math

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation import BoundaryValueProblem

QUARTER = math.pi / 2


def _rhs(t: Array, y: Array, p: Array) -> Array:
    _, kappa, slope = y.T
    return QUARTER * np.column_stack((kappa, slope, p[1] * kappa + p[2] - kappa**3 / 2))


def _rhs_jacobian(t: Array, y: Array, p: Array) -> tuple[Array, Array]:
    by_y, by_p = np.zeros((len(y), 3, 3)), np.zeros((len(y), 3, 4))
    by_y[:, 0, 1] = by_y[:, 1, 2] = QUARTER
    by_y[:, 2, 1] = QUARTER * (p[1] - 1.5 * y[:, 1] ** 2)
    by_p[:, 2, 1], by_p[:, 2, 2] = QUARTER * y[:, 1], QUARTER
    return by_y, by_p


def _boundary(ya: Array, yb: Array, p: Array) -> Array:
    return np.array([ya[0], ya[2], yb[0] - math.pi / p[0], yb[2]])


def _boundary_jacobian(ya: Array, yb: Array, p: Array) -> tuple[Array, Array, Array]:
    by_ya, by_yb, by_p = np.zeros((4, 3)), np.zeros((4, 3)), np.zeros((4, 4))
    by_ya[0, 0] = by_ya[1, 2] = by_yb[2, 0] = by_yb[3, 2] = 1.0
    by_p[2, 0] = math.pi / p[0] ** 2
    return by_ya, by_yb, by_p


def _virial(t: Array, y: Array, p: Array) -> Array:
    return np.asarray(y[:, 1:2] ** 2 / 2 - p[1] - p[0] / 2 * p[2] * p[3])


def _virial_jacobian(t: Array, y: Array, p: Array) -> tuple[Array, Array]:
    by_y = np.zeros((len(y), 1, 3))
    by_y[:, 0, 1] = y[:, 1]
    by_p = np.array([-p[2] * p[3] / 2, -1.0, -p[0] / 2 * p[3], -p[0] / 2 * p[2]])
    return by_y, np.broadcast_to(by_p, (len(y), 1, 4))


HALF_LOBE = BoundaryValueProblem(
    states=("psi", "kappa", "slope"),
    parameters=("n", "a", "p", "v"),
    rhs=_rhs,
    rhs_jacobian=_rhs_jacobian,
    boundary=_boundary,
    boundary_jacobian=_boundary_jacobian,
    integrand=_virial,
    integrand_jacobian=_virial_jacobian,
)
