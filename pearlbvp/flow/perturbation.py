"""Shapes near an equilibrium, to start a flow from: a bump, or the most unstable vector (paper, eqs. (flp1), (flp2))."""

from __future__ import annotations

import numpy as np

from pearlbvp.errors import InputError
from pearlbvp.flow.problem import Array, FlowProblem

SUBSTEPS = 8


def displaced(problem: FlowProblem, q: Array, displacement: Array) -> Array:
    """A surface moved along its outward normal by given distances.

    The surface moves with a normal velocity equal to the displacement for a unit of time, in a few Runge-Kutta steps; to
    first order that is ``X + u N`` of the paper, and it does not cross itself at a neck.

    Args:
        problem: the discretization.
        q: the surface.
        displacement: at the sampled points, as ``problem.velocity`` returns them.

    Raises:
        InputError: the surface closes on the way.
    """
    step = displacement / SUBSTEPS
    with np.errstate(all="ignore"):
        for _ in range(SUBSTEPS):
            first = problem.moved_by(q, step)
            second = problem.moved_by(q + first / 2, step)
            third = problem.moved_by(q + second / 2, step)
            fourth = problem.moved_by(q + third, step)
            q = q + (first + 2 * second + 2 * third + fourth) / 6
    if not np.isfinite(problem.constraints(q)).all():
        raise InputError("delta: the perturbed surface closes or crosses itself; perturb it less")
    return q


def bump(problem: FlowProblem, q: Array, delta: float, xi: float = 1.0, centre: float = 0.0) -> Array:
    """The shape ``X + delta u N`` with ``u = cos(phi)/(1 + xi x^2)`` and the inner normal ``N`` (paper, eq. (flp1)).

    Axisymmetric shapes get the bump without ``cos(phi)``.

    Args:
        problem, q: the shape.
        delta: size; negative ones move the surface outwards at ``phi = 0``.
        xi: how narrow it is.
        centre: axial position of its middle.
    """
    x, phi = problem.places(q)
    length = problem.length
    distance = (x - centre + length / 2) % length - length / 2
    return displaced(problem, q, -delta / (1 + xi * distance**2) * (1.0 if phi is None else np.cos(phi)))


def along_critical(problem: FlowProblem, q: Array, multipliers: Array, delta: float) -> tuple[Array, float]:
    """An equilibrium moved by ``delta`` times its most unstable vector, whose largest entry is 1 (paper, eq. (flp2)).

    Returns:
        The shape, and the vector's growth rate.
    """
    rates, vectors = problem.growth_rates(q, multipliers)
    vector = problem.velocity(q, vectors[:, 0])
    largest = vector[int(np.abs(vector).argmax())]
    return displaced(problem, q, delta * vector / largest), float(rates[0])
