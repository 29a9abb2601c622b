"""Functions that tubes and their perturbations are sums of, and their ten fields.

A cross-section is ``P(x, phi) = e^{i kappa x} (d(x) + sigma(x, phi) e^{i phi})``: its centre ``d = d_y + i d_z`` and the radius
``sigma`` about it, without its first harmonic, which the centre carries (design, §7).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.representation import brief

Part = Literal["sigma", "y", "z"]


class Mode(NamedTuple):
    """One function: of ``sigma``, or of the centre's coordinate ``y`` or ``z``.

    Attributes:
        part: what it is a part of.
        p: wave number along the tube, in units of the basis; a float where it is a Bloch wave.
        along: ``cos``, ``sin`` or ``exp``.
        b: wave number around the tube; 0 for a part of the centre.
        around: ``cos`` or ``sin``.
    """

    part: Part
    p: float
    along: str = "cos"
    b: int = 0
    around: str = "cos"

    @property
    def harmonic(self) -> int:
        """Wave number around the tube of what it moves points by: 1 for the centre."""
        return self.b if self.part == "sigma" else 1

    @property
    def is_even(self) -> bool:
        """Whether it is even in ``phi``."""
        return self.around == "cos" if self.part == "sigma" else self.part == "y"


def _trigonometric(name: str, frequency: float, t: Array) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """A function of ``frequency * t`` and its first two derivatives by ``t``."""
    if name == "exp":
        f = np.exp(1j * frequency * t)
        return f, 1j * frequency * f, -(frequency**2) * f
    cosine, sine = np.cos(frequency * t), np.sin(frequency * t)
    if name == "cos":
        return cosine, -frequency * sine, -(frequency**2) * cosine
    return sine, frequency * cosine, -(frequency**2) * sine


def _fields(mode: Mode, k: float, kappa: float, x: Array, phi: Array) -> NDArray[Any]:
    """The ten fields of a mode at points, shape (10, K): ``a, b, p, q, s`` turned by ``e^{-i(kappa x + phi)}``."""
    f, f1, f2 = _trigonometric(mode.along, mode.p * k, x)
    zero = 0 * f
    if mode.part == "sigma":
        g, g1, g2 = _trigonometric(mode.around, mode.b, phi)
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
    """Modes on a grid.

    Attributes:
        modes: the functions.
        k: unit of their wave numbers along the tube.
        kappa: rate at which the frame turns.
        x, phi: the grid's points, shape (K,).
        fields: of each mode at each point, shape (K, 10, N).
    """

    __repr__ = brief

    modes: tuple[Mode, ...]
    k: float
    kappa: float
    x: Array
    phi: Array
    fields: NDArray[Any]

    @classmethod
    def of(cls, modes: Iterable[Mode], k: float, kappa: float, x: Array, phi: Array) -> Basis:
        """The basis of some modes."""
        modes = tuple(modes)
        fields = np.stack([_fields(mode, k, kappa, x, phi) for mode in modes], axis=-1)
        return cls(modes, k, kappa, x, phi, np.ascontiguousarray(np.moveaxis(fields, 0, 1)))

    def state(self, coefficients: Array) -> Array:
        """The ten fields of a sum, shape (10, K)."""
        return np.ascontiguousarray((self.fields @ coefficients).T)

    def displacement(self) -> NDArray[Any]:
        """What a mode moves points by in the plane, turned as the fields are: shape (K, 2, N)."""
        moved = np.zeros((len(self.x), 2, len(self.modes)), dtype=self.fields.dtype)
        for i, mode in enumerate(self.modes):
            f = _trigonometric(mode.along, mode.p * self.k, self.x)[0]
            if mode.part == "sigma":
                moved[:, 0, i] = f * _trigonometric(mode.around, mode.b, self.phi)[0]
            else:
                cosine, sine = f * np.cos(self.phi), f * np.sin(self.phi)
                moved[:, :, i] = np.stack((cosine, -sine) if mode.part == "y" else (sine, cosine), axis=-1)
        return moved

    def norms(self) -> Array:
        """Mean square of each mode, shape (N,)."""
        return np.array(
            [(1.0 if m.p == 0 or m.along == "exp" else 0.5) * (1.0 if m.b == 0 else 0.5) for m in self.modes]
        )


def sections(known: Mapping[Mode, float], k: float, kappa: float, x: Array, phi: Array) -> NDArray[np.complex128]:
    """Points ``P(x, phi)`` of a sum of modes on a grid, in the plane across the axis: shape (len(x), len(phi)).

    Args:
        known: coefficients by mode, none of them a Bloch wave.
        k, kappa: unit of the wave numbers along the tube, and the rate at which the frame turns.
        x, phi: places along and around the tube.
    """
    most_p, most_b = (
        max(int(number) for number in numbers) for numbers in zip(*((m.p, m.b) for m in known), strict=True)
    )
    centre = np.zeros((2, most_p + 1), dtype=complex)
    radius = np.zeros((2, most_p + 1, 2, most_b + 1))
    for mode, value in known.items():
        place = int(mode.along == "sin"), int(mode.p)
        if mode.part == "sigma":
            radius[(*place, int(mode.around == "sin"), mode.b)] = value
        else:
            centre[place] += value if mode.part == "y" else 1j * value
    angles = [np.outer(np.arange(most_p + 1), k * x), np.outer(np.arange(most_b + 1), phi)]
    along, around = (np.concatenate((np.cos(angle), np.sin(angle))) for angle in angles)
    radii = along.T @ radius.reshape(len(along), len(around)) @ around
    moved = (centre.ravel() @ along)[:, None] + radii * np.exp(1j * phi)
    return np.asarray(np.exp(1j * kappa * x)[:, None] * moved)


def grid(points_x: int, points_phi: int, length_x: float, length_phi: float, *, halved: bool) -> tuple[Array, Array]:
    """Points of a trapezoidal sum over a period, or over half of it both ways for integrands even in ``x`` and ``phi``.

    Args:
        points_x, points_phi: on a whole period.
        length_x, length_phi: the periods.
        halved: whether to take the half periods only, at midpoints.
    """
    share = 2 if halved else 1
    x, phi = (
        (np.arange(max(1, points // share)) + 0.5) / max(1, points // share) * length / share
        if points > 1
        else np.zeros(1)
        for points, length in ((points_x, length_x), (points_phi, length_phi))
    )
    xs, phis = np.meshgrid(x, phi, indexing="ij")
    return xs.ravel(), phis.ravel()
