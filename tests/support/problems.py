"""Textbook boundary-value problems, with what is known about them exactly."""

import math

import numpy as np
from scipy.optimize import brentq

from pearlbvp.collocation import BoundaryValueProblem


def bratu():
    """``u'' + lam e^u = 0``, ``u(0) = u(1) = 0``."""

    def rhs(t, y, p):
        return np.column_stack((y[:, 1], -p[0] * np.exp(y[:, 0])))

    def rhs_jacobian(t, y, p):
        by_y, by_p = np.zeros((len(t), 2, 2)), np.zeros((len(t), 2, 1))
        by_y[:, 0, 1] = 1
        by_y[:, 1, 0] = -p[0] * np.exp(y[:, 0])
        by_p[:, 1, 0] = -np.exp(y[:, 0])
        return by_y, by_p

    ends = np.array([[1.0, 0], [0, 0]]), np.array([[0, 0], [1.0, 0]]), np.zeros((2, 1))
    return BoundaryValueProblem(
        ("u", "du"), ("lam",), rhs, rhs_jacobian, lambda ya, yb, p: np.array([ya[0], yb[0]]), lambda ya, yb, p: ends
    )


def bratu_exact(lam):
    """The lower solution, ``2 log(cosh a / cosh(a (1 - 2t)))`` with ``a = sqrt(lam/8) cosh a``."""
    a = brentq(lambda a: a - math.sqrt(lam / 8) * math.cosh(a), 0, 1.19967864, xtol=1e-15)
    return lambda t: 2 * np.log(np.cosh(a) / np.cosh(a * (1 - 2 * t)))


BRATU_FOLD = 8 / math.sinh(1.199678640257734) ** 2
"""The largest ``lam`` with a solution: ``a tanh a = 1`` there."""


def van_der_pol(reference):
    """Periodic orbit of ``x'' - mu (1 - x^2) x' + x = 0``; ``T`` unknown, phase by an integral with ``reference``."""

    def rhs(t, y, p):
        return p[0] * np.column_stack((y[:, 1], p[1] * (1 - y[:, 0] ** 2) * y[:, 1] - y[:, 0]))

    def rhs_jacobian(t, y, p):
        by_y, by_p = np.zeros((len(t), 2, 2)), np.zeros((len(t), 2, 2))
        by_y[:, 0, 1] = p[0]
        by_y[:, 1, 0] = p[0] * (-2 * p[1] * y[:, 0] * y[:, 1] - 1)
        by_y[:, 1, 1] = p[0] * p[1] * (1 - y[:, 0] ** 2)
        by_p[:, :, 0] = rhs(t, y, p) / p[0]
        by_p[:, 1, 1] = p[0] * (1 - y[:, 0] ** 2) * y[:, 1]
        return by_y, by_p

    ends = np.eye(2), -np.eye(2), np.zeros((2, 2))
    return BoundaryValueProblem(
        ("x", "dx"), ("T", "mu"), rhs, rhs_jacobian, lambda ya, yb, p: ya - yb, lambda ya, yb, p: ends,
        integrand=lambda t, y, p: (reference(t) * y).sum(axis=1, keepdims=True),
        integrand_jacobian=lambda t, y, p: (reference(t)[:, None, :], np.zeros((len(t), 1, 2))),
    )  # fmt: skip


def elastica():
    """A clamped rod of length 1 pushed together: ``psi' = k, k' = -F sin psi``, ``integral of cos psi = 1 - shortening``."""

    def rhs(t, y, p):
        return np.column_stack((y[:, 1], -p[0] * np.sin(y[:, 0])))

    def rhs_jacobian(t, y, p):
        by_y, by_p = np.zeros((len(t), 2, 2)), np.zeros((len(t), 2, 2))
        by_y[:, 0, 1] = 1
        by_y[:, 1, 0] = -p[0] * np.cos(y[:, 0])
        by_p[:, 1, 0] = -np.sin(y[:, 0])
        return by_y, by_p

    def integrand_jacobian(t, y, p):
        by_y, by_p = np.zeros((len(t), 1, 2)), np.zeros((len(t), 1, 2))
        by_y[:, 0, 0] = -np.sin(y[:, 0])
        by_p[:, 0, 1] = 1
        return by_y, by_p

    ends = np.array([[1.0, 0], [0, 0]]), np.array([[0, 0], [1.0, 0]]), np.zeros((2, 2))
    return BoundaryValueProblem(
        ("psi", "k"), ("force", "shortening"), rhs, rhs_jacobian,
        lambda ya, yb, p: np.array([ya[0], yb[0]]), lambda ya, yb, p: ends,
        integrand=lambda t, y, p: np.cos(y[:, :1]) - 1 + p[1], integrand_jacobian=integrand_jacobian,
    )  # fmt: skip
