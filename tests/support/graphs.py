"""Tubes as graphs ``r = 1 + u(x, phi)`` in double Fourier sums: small, exact, and nothing of the package's own.

The energy is a trapezoidal sum; gradient and Hessian are its exact derivatives, from the density differentiated by computer
algebra. It serves as the second way to the numbers of the amplitude equations, for pearls, rings, coils and buckles alike.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import sympy
from scipy.linalg import eigh, null_space

FIELDS = sympy.symbols("r rx rp rxx rxp rpp")


@cache
def densities():
    """Energy (with ``c0``), area and volume by unit area of the cylinder: values, gradients, Hessians in the six fields."""
    r, rx, rp, rxx, rxp, rpp = FIELDS
    c0 = sympy.Symbol("c0")
    g = r**2 * (1 + rx**2) + rp**2
    second = -r * rxx * (r**2 + rp**2) + 2 * rx * rp * (r * rxp - rx * rp) + (1 + rx**2) * (r**2 + 2 * rp**2 - r * rpp)
    mean_curvature = second / (2 * g ** sympy.Rational(3, 2))
    found = []
    for density in ((mean_curvature - c0) ** 2 * sympy.sqrt(g), sympy.sqrt(g), r**2 / 2):
        gradient = [sympy.diff(density, field) for field in FIELDS]
        hessian = [sympy.diff(gradient[i], FIELDS[j]) for i in range(6) for j in range(i + 1)]
        found.append(sympy.lambdify((*FIELDS, c0), [density, *gradient, *hessian], cse=True))
    return found


def all_waves(most):
    """Products of a cosine or sine along the tube and one around it, up to a wave number each way."""
    functions = [(f, g) for f in (np.cos, np.sin) for g in (np.cos, np.sin)]
    numbers = [(a, b) for a in range(most + 1) for b in range(most + 1)]
    return [(a, b, f, g) for a, b in numbers for f, g in functions if (a or f is np.cos) and (b or g is np.cos)]


@dataclass(frozen=True)
class Graphs:
    """Waves ``cos`` or ``sin`` of ``a k x + b n phi``, or products: their six fields on a grid.

    Attributes:
        k, n, c0: wave numbers and spontaneous curvature.
        fields: of each basis function, shape (functions, 6, points).
    """

    k: float
    n: float
    c0: float
    fields: np.ndarray

    @classmethod
    def of(cls, k, n, c0, waves, points):
        """Basis of ``(a, b, f, g)``: the function ``f(a k x) g(b n phi)``, or ``f(a k x + b n phi)`` where g is None."""
        across = np.arange(points[1]) / points[1] * 2 * np.pi
        xi, eta = (q.ravel() for q in np.meshgrid(np.arange(points[0]) / points[0] * 2 * np.pi, across, indexing="ij"))
        derivative = {np.cos: (np.cos, lambda t: -np.sin(t), lambda t: -np.cos(t)),
                      np.sin: (np.sin, np.cos, lambda t: -np.sin(t))}  # fmt: skip
        fields = []
        for a, b, f, g in waves:
            p, q = a * k, b * n
            if g is None:
                f0, f1, f2 = (d(a * xi + b * eta) for d in derivative[f])
                fields.append([f0, p * f1, q * f1, p**2 * f2, p * q * f2, q**2 * f2])
            else:
                f0, f1, f2 = (d(a * xi) for d in derivative[f])
                g0, g1, g2 = (d(b * eta) for d in derivative[g])
                fields.append([f0 * g0, p * f1 * g0, q * f0 * g1, p**2 * f2 * g0, p * q * f1 * g1, q**2 * f0 * g2])
        return cls(k, n, c0, np.array(fields))

    def state(self, u):
        """The six fields of the surface."""
        fields = np.tensordot(u, self.fields, 1)
        fields[0] += 1
        return fields

    def parts(self, u, basis=None):
        """Energy, area and volume by unit area of the cylinder, each with gradient and Hessian in a basis's coefficients."""
        basis = self.fields if basis is None else basis
        fields, count = self.state(u), basis.shape[2]
        found = []
        for function in densities():
            values = [np.broadcast_to(value, count) for value in function(*fields, self.c0)]
            gradient = sum(basis[:, i] @ values[1 + i] for i in range(6)) / count
            pairs = [(i, j) for i in range(6) for j in range(i + 1)]
            hessian = np.zeros((len(basis), len(basis)))
            for (i, j), value in zip(pairs, values[7:], strict=True):
                block = (basis[:, i] * value) @ basis[:, j].T
                hessian += block if i == j else block + block.T
            found.append((values[0].mean(), gradient, hessian / count))
        return found

    def solve(self, place, amplitude, lambda1, lambda2):
        """The equilibrium of the cylinder's area in which the coefficient at ``place`` is given.

        Returns:
            The coefficients, ``lambda1, lambda2, v, E`` by area.
        """
        size = len(self.fields)
        z = np.append(np.zeros(size), [lambda1, lambda2])
        z[place] = amplitude
        for _ in range(30):
            (_, e1, e2), (a0, a1, a2), (_, v1, v2) = self.parts(z[:size])
            residual = np.concatenate((e1 + z[-2] * a1 + z[-1] * v1, [a0 - 1, z[place] - amplitude]))
            matrix = np.zeros((size + 2, size + 2))
            matrix[:size, :size] = e2 + z[-2] * a2 + z[-1] * v2
            matrix[:size, -2], matrix[:size, -1], matrix[size, :size], matrix[-1, place] = a1, v1, a1, 1
            step = np.linalg.solve(matrix, residual)
            z -= step
            if np.abs(step).max() < 1e-14:
                break
        assert np.abs(step).max() < 1e-11
        (energy, *_), _, (volume, *_) = self.parts(z[:size])
        return z[:size], z[-2], z[-1], 2 * volume, energy

    def rates(self, u, lambda1, lambda2, perturbations, fixed=("area", "volume")):
        """Growth rates of perturbations (another basis on the same grid), the kept quantities' gradients projected out."""
        basis = perturbations.fields
        (_, _, e2), (_, a1, a2), (_, v1, v2) = self.parts(u, basis)
        r, rx, rp = self.state(u)[:3]
        # A displacement u along the radius moves the surface by u r / sqrt(g) along its normal.
        mass = (basis[:, 0] * (r**2 / np.sqrt(r**2 * (1 + rx**2) + rp**2))) @ basis[:, 0].T / basis.shape[2]
        allowed = null_space(np.array([{"area": a1, "volume": v1}[name] for name in fixed]))
        hessian = e2 + lambda1 * a2 + lambda2 * v2
        return -eigh(allowed.T @ hessian @ allowed, allowed.T @ mass @ allowed, eigvals_only=True)


def graphs_of(equation, family, most=6):
    """Small graphs that hold a family's branch, the place of its amplitude, and that coefficient by ``A``."""
    if family == "buckle":
        even = [(a, b) for a in range(most + 1) for b in range(most + 1) if (a + b) % 2 == 0]
        waves = [(a, b, np.cos, np.cos) for a, b in even]
        return Graphs.of(equation.k, equation.n, equation.tube.c0, waves, (24, 24)), even.index((1, 1)), 4.0
    along, around = min(equation.m, 1), min(equation.n, 1)
    waves = [(a * along, a * around, np.cos, None) for a in range(13)]
    points = (48, 1) if along else (1, 48)
    return Graphs.of(equation.k, equation.n, equation.tube.c0, waves, points), 1, 2.0
