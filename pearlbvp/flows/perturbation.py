"""Shapes near an equilibrium, to start a flow from: a bump, or the most unstable vector (paper, eqs. (flp1), (flp2))."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError
from pearlbvp.flows.problem import FlowProblem

SUBSTEPS = 8

EQUAL = 1e-5
"""Relative difference of growth rates that are the same; meshes split pairs by a part of their error."""


def displaced(problem: FlowProblem, q: Array, speed: Callable[[Array], Array]) -> Array:
    """A surface moved along its outward normal at given speeds for a unit of time, in a few Runge-Kutta steps.

    To first order that is ``X + u N`` of the paper, and it does not cross itself at a neck. Where the speed is a function
    of the place in space, all discretizations move the surface to the same one.

    Args:
        problem: the discretization.
        q: the surface.
        speed: of the surface ``q``, at its sampled points, as ``problem.velocity`` returns them.

    Raises:
        InputError: the surface closes on the way, or can no longer be described.
    """
    begun = q

    def moved(shape: Array) -> Array:
        return problem.moved_by(shape, speed(shape)) / SUBSTEPS

    try:
        with np.errstate(all="ignore"):
            for _ in range(SUBSTEPS):
                first = moved(q)
                second = moved(q + first / 2)
                third = moved(q + second / 2)
                fourth = moved(q + third)
                q = q + (first + 2 * second + 2 * third + fourth) / 6
            if np.isfinite(problem.constraints(q)).all() and (problem.trouble(q) is None or problem.trouble(begun)):
                return q
    except (InputError, np.linalg.LinAlgError):  # triangles that are none any more, a surface of no area
        pass
    raise InputError("delta", "the perturbed surface closes, crosses itself or is too steep", "perturb it less")


def bump(problem: FlowProblem, q: Array, delta: float, xi: float = 1.0, centre: float = 0.0) -> Array:
    """The shape ``X + delta u N`` with ``u = cos(phi)/(1 + xi x^2)`` and the inner normal ``N`` (paper, eq. (flp1)).

    Graphs, which are axisymmetric, get the bump without ``cos(phi)``. It is a function in space, in which the surface moves
    (``displaced``): to second order in ``delta`` its points meet other values than they started with.

    Args:
        problem, q: the shape.
        delta: size; negative ones move the surface outwards at ``phi = 0``.
        xi: how narrow it is, 0 or more.
        centre: axial position of its middle.
    """
    length = problem.length

    def speed(shape: Array) -> Array:
        x, phi = problem.places(shape)
        distance = (x - centre + length / 2) % length - length / 2
        return np.asarray(-delta / (1 + xi * distance**2) * (1.0 if phi is None else np.cos(phi)))

    return displaced(problem, q, speed)


def along_critical(problem: FlowProblem, q: Array, multipliers: Array, delta: float) -> tuple[Array, float]:
    """An equilibrium moved by ``delta`` times its most unstable vector, whose largest size is 1 (paper, eq. (flp2)).

    Its phase and sign are those of ``central``.

    Returns:
        The shape, and the vector's growth rate.
    """
    rates, vectors = problem.growth_rates(q, multipliers)
    same = np.abs(rates - rates[0]) <= EQUAL * np.abs(rates[0])
    vector = central(problem, q, np.array([problem.velocity(q, v) for v in vectors.T[same]]))
    return displaced(problem, q, lambda shape: delta * vector / np.abs(vector).max()), float(rates[0])


def central(problem: FlowProblem, q: Array, vectors: Array) -> Array:
    """Of all combinations of equally unstable vectors, at the sampled points, shape (d, points), the one centred at 0.

    Waves that shift or turn into each other come in any phase. Their combination of unit norm is taken that is largest and
    positive at ``x = 0, phi = 0``, as branches have it; where all vanish there, at the nearest place, ``x`` and ``phi`` not
    negative, where they are half as large as anywhere.
    """
    x, phi = problem.places(q)
    x = (x + problem.length / 2) % problem.length - problem.length / 2
    phi = np.zeros_like(x) if phi is None else np.angle(np.exp(1j * phi))
    size = np.linalg.norm(vectors, axis=0)
    eligible = (size > size.max() / 2) & (np.minimum(x, phi) > -1e-9)
    place = int(np.where(eligible, np.hypot(x, phi), np.inf).argmin())
    return np.asarray(vectors[:, place] @ vectors)
