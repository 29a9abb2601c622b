"""Plane curves that are known exactly, as ``continuation`` takes them."""

from dataclasses import dataclass

import numpy as np

from pearlbvp.continuation.problem import Problem


@dataclass(frozen=True)
class Curve(Problem):
    """The zero set of a function of two variables with known gradient."""

    f: object
    gradient: object

    def residual(self, u):
        return np.array([self.f(*u)])

    def solve(self, u, rhs, row=None):
        return np.linalg.solve(np.vstack((self.gradient(*u), row)), rhs)

    def inner(self, u, v):
        return float(u @ v)

    def observables(self, u):
        return {"x": float(u[0]), "y": float(u[1])}

    def remesh(self, u, *others):
        return None

    def transfer(self, other, u):
        return u
