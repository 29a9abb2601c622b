"""Tubes summed point by point: no waves, no blocks, every mode and all its fields at every point."""

from dataclasses import dataclass

import numpy as np

from pearlbvp.tube.density import areas, hessians


def trigonometric(name, frequency, t):
    """A function of ``frequency * t`` and its first two derivatives by ``t``."""
    cosine, sine = np.cos(frequency * t), np.sin(frequency * t)
    if name == "cos":
        return cosine, -frequency * sine, -(frequency**2) * cosine
    return sine, frequency * cosine, -(frequency**2) * sine


def fields_of(mode, k, kappa, x, phi):
    """The ten fields of a mode at points, shape (10, K): ``a, b, p, q, s`` turned by ``e^{-i(kappa x + phi)}``."""
    f, f1, f2 = trigonometric(mode.along, mode.p * k, x)
    zero = 0 * f
    if mode.part == "sigma":
        g, g1, g2 = trigonometric(mode.around, mode.b, phi)
        v, vx, vp, vxx, vxp, vpp = f * g, f1 * g, f * g1, f2 * g, f1 * g1, f * g2
        return np.array(
            [vx, kappa * v, vp, v, vxx - kappa**2 * v, 2 * kappa * vx,
             vxp - kappa * v, vx + kappa * vp, vpp - v, 2 * vp]
        )  # fmt: skip
    cosine, sine = np.cos(phi), np.sin(phi)
    first, second = (f1, kappa * f), (f2 - kappa**2 * f, 2 * kappa * f1)
    turned = [(u * cosine + w * sine, -u * sine + w * cosine) for u, w in (first, second)]
    if mode.part == "z":  # times i in the plane
        turned = [(-im, re) for re, im in turned]
    (a0, a1), (p0, p1) = turned
    return np.array([a0, a1, zero, zero, p0, p1, zero, zero, zero, zero])


@dataclass(frozen=True)
class Basis:
    """Modes at points ``x``, ``phi`` of shape (K,), and their fields there, shape (K, 10, N)."""

    modes: tuple
    k: float
    x: np.ndarray
    phi: np.ndarray
    fields: np.ndarray

    @classmethod
    def of(cls, modes, k, kappa, x, phi):
        """The basis of some modes: ``k`` is the unit of their wave numbers along, ``kappa`` the rate of their frame."""
        modes = tuple(modes)
        fields = np.stack([fields_of(mode, k, kappa, x, phi) for mode in modes], axis=-1)
        return cls(modes, k, x, phi, np.ascontiguousarray(np.moveaxis(fields, 0, 1)))

    def state(self, coefficients):
        """The ten fields of a sum, shape (10, K)."""
        return np.ascontiguousarray((self.fields @ coefficients).T)

    def displacement(self):
        """What a mode moves points by in the plane, turned as the fields are: shape (K, 2, N)."""
        moved = np.zeros((len(self.x), 2, len(self.modes)))
        for i, mode in enumerate(self.modes):
            f = trigonometric(mode.along, mode.p * self.k, self.x)[0]
            if mode.part == "sigma":
                moved[:, 0, i] = f * trigonometric(mode.around, mode.b, self.phi)[0]
            else:
                cosine, sine = f * np.cos(self.phi), f * np.sin(self.phi)
                moved[:, :, i] = np.stack((cosine, -sine) if mode.part == "y" else (sine, cosine), axis=-1)
        return moved


def grid(points, length):
    """A number of points on each period, along and around, from ``x = phi = 0`` on: ``x`` and ``phi``, each of shape (K,)."""
    along, around = points
    x, phi = np.arange(along) * length / along, np.arange(around) * 2 * np.pi / around
    return tuple(t.ravel() for t in np.meshgrid(x, phi, indexing="ij"))


def second_variation(basis, fields, c0, lambda1, lambda2):
    """Matrices of the second variation and of the normal displacement's mean square, and gradients of area and volume."""
    hessian = hessians(fields, c0, lambda1)
    hessian[:, 3, 3] += lambda2
    count = fields.shape[1]
    second = np.einsum("kin,kij,kjm->nm", basis.fields, hessian, basis.fields, optimize=True) / count
    a0, a1, b0, b1 = fields[:4]
    moved = basis.displacement()
    normal = -moved[:, 0] * b1[:, None] + moved[:, 1] * b0[:, None]
    root = np.sqrt(b0**2 + b1**2 + (a0 * b1 - a1 * b0) ** 2)
    mass = normal.T @ (normal / root[:, None]) / count
    area = np.einsum("jk,kjn->n", areas(fields)[1], basis.fields[:, :4]) / count
    return second, mass, np.array([area, fields[3] @ basis.fields[:, 3] / count])
