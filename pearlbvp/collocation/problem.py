"""What a boundary-value problem with parameters is, before any discretization."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.representation import brief


def _no_mass(p: Array) -> tuple[Array | None, Array | None]:
    return None, None


def _no_integrals(t: Array, y: Array, p: Array) -> Array:
    return np.zeros((len(t), 0))


def _no_integrals_jacobian(t: Array, y: Array, p: Array) -> tuple[Array, Array]:
    return np.zeros((len(t), 0, y.shape[1])), np.zeros((len(t), 0, len(p)))


@dataclass(frozen=True)
class BoundaryValueProblem:
    """``M(p) y' = f(t, y, p)`` on [0, 1] with ``b(y(0), y(1), p) = 0`` and ``integral of g(t, y, p) dt = 0``.

    Callbacks take many points at once: ``t`` of shape (K,), ``y`` (K, n), ``p`` (k,), numpy or compiled alike.

    Attributes:
        states: names of the ``n`` components of ``y``.
        parameters: names of the ``k`` components of ``p``; which of them are free is said on discretization.
        rhs: ``f``, shape (K, n).
        rhs_jacobian: its derivatives by ``y`` and ``p``, shapes (K, n, n) and (K, n, k).
        boundary: ``b(ya, yb, p)``, shape (b,).
        boundary_jacobian: its derivatives by ``ya``, ``yb``, ``p``, shapes (b, n), (b, n), (b, k).
        integrand: ``g``, shape (K, c); none by default.
        integrand_jacobian: its derivatives by ``y`` and ``p``, shapes (K, c, n) and (K, c, k).
        mass: diagonal of ``M``, shape (n,), and its derivatives by ``p``, shape (n, k); ``None, None`` for the identity.
            Entries may pass through zero, where an equation becomes algebraic.
    """

    __repr__ = brief

    states: tuple[str, ...]
    parameters: tuple[str, ...]
    rhs: Callable[[Array, Array, Array], Array]
    rhs_jacobian: Callable[[Array, Array, Array], tuple[Array, Array]]
    boundary: Callable[[Array, Array, Array], Array]
    boundary_jacobian: Callable[[Array, Array, Array], tuple[Array, Array, Array]]
    integrand: Callable[[Array, Array, Array], Array] = _no_integrals
    integrand_jacobian: Callable[[Array, Array, Array], tuple[Array, Array]] = _no_integrals_jacobian
    mass: Callable[[Array], tuple[Array | None, Array | None]] = _no_mass
