"""Flow of axisymmetric tubes that are graphs over their axis, in the coordinate ``y = r^2/2``.

With ``p = r sqrt(1 + r'^2)`` everything is a function of ``y, y', y''`` without division by the radius::

    p^2 = 2y + y'^2      dS = 2 pi p dx      V = 2 pi integral of y dx
    H = (y + y'^2 - y y'')/p^3               (inner normal; 1/2 on the cylinder y = 1/2)

``2 pi dy dx`` is the volume that a displacement adds, hence the normal velocity is ``y_t/p``, the variation of an energy by the
outward normal is its variation by ``y``, and the three flows read (primes by ``x``)::

    L^2:    y_t/p = -(E_y + lambda1 A_y + lambda2)
    H^-1:   y_t = ((2y/p) (E_y + lambda1 A_y)')'      since Lap g = ((2y/p) g')'/p

The volume is linear in ``y``: the ``H^-1`` flow keeps it exactly. Fourier collocation in ``x`` on the whole period; energy and
area are trapezoidal sums, gradients and second derivatives are the exact ones of these sums.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, get_args

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.compiled import compiled
from pearlbvp.errors import InputError
from pearlbvp.flows.problem import Law, Trouble, check_law
from pearlbvp.flows.spectrum import growth_rates
from pearlbvp.last import Last
from pearlbvp.representation import brief
from pearlbvp.units import Sentence

MOST_POINTS = 1024


@compiled
def gradients(y, y1, y2, c0):  # type: ignore[no-untyped-def]
    """Densities of energy and area, (2, K), and their derivatives by ``y, y', y''``, (2, 3, K)."""
    count = y.size
    values, slopes = np.empty((2, count)), np.zeros((2, 3, count))
    for k in range(count):
        m, g = y[k] + y1[k] ** 2 - y[k] * y2[k], 2 * y[k] + y1[k] ** 2
        if y[k] <= 0:
            g = np.nan
        root = np.sqrt(g)
        values[0, k], values[1, k] = m**2 / (g**2 * root) - 2 * c0 * m / g + c0**2 * root, root
        by_m = 2 * m / (g**2 * root) - 2 * c0 / g
        by_g = -2.5 * m**2 / (g**3 * root) + 2 * c0 * m / g**2 + c0**2 / (2 * root)
        slopes[0, 0, k] = by_m * (1 - y2[k]) + 2 * by_g
        slopes[0, 1, k] = 2 * y1[k] * (by_m + by_g)
        slopes[0, 2, k] = -by_m * y[k]
        slopes[1, 0, k], slopes[1, 1, k] = 1 / root, y1[k] / root
    return values, slopes


@compiled
def hessians(y, y1, y2, c0, lambda1):  # type: ignore[no-untyped-def]
    """Second derivatives of energy plus ``lambda1`` times area: 00, 01, 02, 11, 12, 22 by ``y, y', y''``, shape (6, K)."""
    count = y.size
    second = np.empty((6, count))
    for k in range(count):
        m, g = y[k] + y1[k] ** 2 - y[k] * y2[k], 2 * y[k] + y1[k] ** 2
        root = np.sqrt(g)
        by_m = 2 * m / (g**2 * root) - 2 * c0 / g
        by_g = -2.5 * m**2 / (g**3 * root) + 2 * c0 * m / g**2 + (c0**2 + lambda1) / (2 * root)
        mm = 2 / (g**2 * root)
        mg = -5 * m / (g**3 * root) + 2 * c0 / g**2
        gg = 8.75 * m**2 / (g**4 * root) - 4 * c0 * m / g**3 - (c0**2 + lambda1) / (4 * g * root)
        m0, m1, m2, g0, g1 = 1 - y2[k], 2 * y1[k], -y[k], 2.0, 2 * y1[k]
        second[0, k] = mm * m0 * m0 + 2 * mg * m0 * g0 + gg * g0 * g0
        second[1, k] = mm * m0 * m1 + mg * (m0 * g1 + m1 * g0) + gg * g0 * g1
        second[2, k] = mm * m0 * m2 + mg * m2 * g0 - by_m
        second[3, k] = mm * m1 * m1 + 2 * mg * m1 * g1 + gg * g1 * g1 + 2 * by_m + 2 * by_g
        second[4, k] = mm * m1 * m2 + mg * m2 * g1
        second[5, k] = mm * m2 * m2
    return second


@lru_cache(maxsize=16)
def differentiation(points: int, length: float) -> tuple[Array, Array]:
    """First and second derivative of a periodic function at evenly spaced points, exact for its interpolant.

    (L. N. Trefethen, Spectral Methods in MATLAB (SIAM 2000), ch. 3; the first derivative of the highest wave is zero.)
    """
    waves = 2j * np.pi * np.fft.fftfreq(points, 1 / points) / length
    first = waves.copy()
    if points % 2 == 0:
        first[points // 2] = 0.0
    one = np.fft.fft(np.eye(points), axis=0)
    matrices = [np.ascontiguousarray(np.fft.ifft(w[:, None] * one, axis=0).real) for w in (first, waves**2)]
    for matrix in matrices:
        matrix.flags.writeable = False
    return matrices[0], matrices[1]


@dataclass(frozen=True)
class GraphFlow:
    """Axisymmetric graphs on evenly spaced points ``x`` from ``-L/2`` on; ``q`` is ``r^2/2`` at them.

    Attributes:
        c0, length: the tube's.
        points: how many, an even number.
        law: what the flow keeps.
        pressure: the given ``lambda2`` where the law keeps the area alone.
        thinnest, steepest: radius of a neck, and slope ``r'``, beyond which a graph is left: a pinch, or an overhang.

    Raises:
        InputError: an argument that cannot be used.
    """

    __repr__ = brief

    c0: float
    length: float
    points: int = 128
    law: Law = "area and volume"
    pressure: float = 0.0
    thinnest: float = 1e-2
    steepest: float = 20.0

    def __post_init__(self) -> None:
        check_law(self.law)
        if self.points % 2 or not 8 <= self.points <= MOST_POINTS:
            raise InputError("points", f"{self.points} is no even number from 8 to {MOST_POINTS}", "give one like 128")

    @cached_property
    def x(self) -> Array:
        """Axial positions of the points."""
        return (np.arange(self.points) / self.points - 0.5) * self.length

    @property
    def d1(self) -> Array:
        """Matrix of the first derivative."""
        return differentiation(self.points, self.length)[0]

    @property
    def d2(self) -> Array:
        """Matrix of the second derivative."""
        return differentiation(self.points, self.length)[1]

    def coordinates(self, r: Array) -> Array:
        """``q`` of radii at the points."""
        return np.asarray(r**2 / 2)

    def radii(self, q: Array) -> Array:
        """Radii at the points."""
        return np.sqrt(2 * q)

    def _fields(self, q: Array) -> tuple[Array, Array, Array]:
        return q, self.d1 @ q, self.d2 @ q

    @cached_property
    def _variations(self) -> Last[tuple[Array, Array, Array]]:
        return Last(self._varied)

    def _varied(self, q: Array) -> tuple[Array, Array, Array]:
        """Energy and area (2,), their variations by ``y`` (2, N), and ``p`` (N,)."""
        values, slopes = gradients(*self._fields(q), self.c0)
        variations = slopes[:, 0] + slopes[:, 1] @ self.d1
        variations[0] += slopes[0, 2] @ self.d2
        return values.mean(axis=1), variations, values[1]

    def _force(self, variations: Array, multipliers: Array) -> Array:
        """``-G``: the variation of ``F``."""
        pressure = 0.0 if self.law == "diffusion" else self.pressure if self.law == "area" else multipliers[1]
        return np.asarray(variations[0] + multipliers[0] * variations[1] + pressure)

    def residual(self, q: Array, rate: Array, multipliers: Array) -> Array:
        """``y_t/p - G``, or ``y_t + ((2y/p) G')'``, at the points."""
        _, variations, p = self._variations(q)
        force = self._force(variations, multipliers)
        if self.law == "diffusion":
            return np.asarray(rate - self.d1 @ (2 * q / p * (self.d1 @ force)))
        return rate / p + force

    def _second(self, q: Array, lambda1: float) -> Array:
        """Derivative of the variation of ``E + lambda1 A`` by ``q``: symmetric, shape (N, N)."""
        h00, h01, h02, h11, h12, h22 = hessians(*self._fields(q), self.c0, lambda1)[:, :, None]
        half = self.d1.T @ (0.5 * h11 * self.d1 + h12 * self.d2) + self.d2.T @ (0.5 * h22 * self.d2)
        half += (h01 * self.d1 + h02 * self.d2).T
        half[np.diag_indices(self.points)] += 0.5 * h00[:, 0]
        return np.asarray(half + half.T)

    def jacobian(self, q: Array, rate: Array, multipliers: Array, factor: float) -> Array:
        """Exact derivative of ``residual``."""
        y, y1, _ = self._fields(q)
        p = np.sqrt(2 * y + y1**2)
        matrix = self._second(q, float(multipliers[0]))
        diagonal = np.diag_indices(self.points)
        if self.law == "diffusion":
            _, variations, _ = self._variations(q)
            slope = self.d1 @ self._force(variations, multipliers)
            # The mobility 2y/p changes by (2/p - 2y/p^3) dy - 2 y y'/p^3 dy'.
            inner = (2 * y / p)[:, None] * (self.d1 @ matrix) - (slope * 2 * y * y1 / p**3)[:, None] * self.d1
            inner[diagonal] += slope * (2 / p - 2 * y / p**3)
            matrix = -self.d1 @ inner
            matrix[diagonal] += factor
        else:
            by_g = -rate / (2 * p**3)  # of 1/p, p^2 = 2y + y'^2
            matrix += (2 * by_g * y1)[:, None] * self.d1
            matrix[diagonal] += 2 * by_g + factor / p
        return matrix

    def metric(self, q: Array) -> Array:
        """``1/p`` at the points, or 1 in the ``H^-1`` flow."""
        return np.eye(self.points) if self.law == "diffusion" else np.diag(1 / self._p(q))

    def columns(self, q: Array) -> Array:
        """What each multiplier adds to the residual, shape (N, k)."""
        by_area = self._variations(q)[1][1]
        if self.law == "diffusion":
            return -(self.d1 @ (2 * q / self._p(q) * (self.d1 @ by_area)))[:, None]
        if self.law == "area":
            return by_area[:, None]
        return np.column_stack((by_area, np.ones(self.points)))

    def _p(self, q: Array) -> Array:
        return self._variations(q)[2]

    def constraints(self, q: Array) -> Array:
        """Area, or area and volume, of the straight tube's area."""
        area = self._variations(q)[0][1]
        return np.array([area, q.mean()]) if self.law == "area and volume" else np.array([area])

    def constraint_rows(self, q: Array) -> Array:
        """Their derivatives."""
        by_area = self._variations(q)[1][1]
        rows = np.vstack((by_area, np.ones(self.points))) / self.points
        return rows if self.law == "area and volume" else rows[:1]

    def moved_by(self, q: Array, speed: Array) -> Array:
        """``y_t = p V_t``."""
        return self._p(q) * speed

    def velocity(self, q: Array, rate: Array) -> Array:
        """``V_t = y_t / p`` at the points."""
        return rate / self._p(q)

    def places(self, q: Array) -> tuple[Array, None]:
        """The points; each is a circle."""
        return self.x, None

    def resistance(self, q: Array, force: Array) -> Array:
        """``p`` times a force, or the force itself in the ``H^-1`` flow."""
        return force if self.law == "diffusion" else np.asarray((force.T * self._p(q)).T)

    def equilibrium(self, q: Array, multipliers: Array) -> tuple[GraphFlow, Array]:
        """This problem, or instead of the ``H^-1`` flow that at fixed area and volume, which has the same equilibria."""
        if self.law != "diffusion":
            return self, multipliers
        pressure = self.observables(q, multipliers)["lambda2"]
        return replace(self, law="area and volume"), np.array([multipliers[0], pressure])

    def kernels(self, q: Array, multipliers: Array) -> Array:
        """The shift along the axis."""
        return (self.d1 @ q)[None, :]

    def growth_rates(self, q: Array, multipliers: Array, count: int = 6) -> tuple[Array, Array]:
        """Growth rates of this flow: of ``w_t/p = -F_yy w``, or of ``w_t = ((2y/p) (F_yy w)')'`` at mean zero."""
        second, p = self._second(q, float(multipliers[0])), self._p(q)
        rows = self._kept(q)
        if self.law != "diffusion":
            return growth_rates(second, np.diag(1 / p), rows, self.kernels(q, multipliers), count)
        # The metric is the inverse of the mobility's operator K = D' (2y/p) D on functions of mean zero, whose kernel is the
        # constants and the highest wave, which it does not see.
        mobility = self.d1.T @ ((2 * q / p)[:, None] * self.d1)
        sawtooth = np.where(np.arange(self.points) % 2, -1.0, 1.0)
        blind = np.vstack((np.ones(self.points), sawtooth)) / np.sqrt(self.points)
        metric = np.linalg.inv(mobility + blind.T @ blind) - blind.T @ blind
        rows = np.vstack((rows, sawtooth))
        return growth_rates(second, metric + blind.T @ blind, rows, self.kernels(q, multipliers), count)

    def _kept(self, q: Array) -> Array:
        """Gradients of all that the flow keeps, the volume of the ``H^-1`` flow too."""
        rows = self.constraint_rows(q)
        return np.vstack((rows, np.ones(self.points) / self.points)) if self.law == "diffusion" else rows

    def observables(self, q: Array, multipliers: Array) -> dict[str, float]:
        """Energy by area, multipliers, reduced volume, radii; ``lambda2`` of the ``H^-1`` flow is that of equilibrium."""
        (energy, area), variations, _ = self._variations(q)
        lambda2 = self.pressure
        if self.law == "area and volume":
            lambda2 = float(multipliers[1])
        elif self.law == "diffusion":
            lambda2 = -float(self._force(variations, multipliers).mean())
        thin, thick = self._extremes(q)
        return {
            "lambda1": float(multipliers[0]), "lambda2": lambda2, "E": float(energy / area), "area": float(area),
            "volume": float(q.mean()), "v": float(2 * q.mean()), "amplitude": float(thick - thin) / 2,
            "r_min": float(thin), "r_max": float(thick), "c0": self.c0, "L": self.length, "M": self._curvature(q),
        }  # fmt: skip

    def _curvature(self, q: Array) -> float:
        """Integral of the mean curvature: the energy is ``E(0) - 2 c0 M + c0^2 A``."""
        (at_zero, area), (at_one, _) = (gradients(*self._fields(q), c0)[0].mean(axis=1) for c0 in (0.0, 1.0))
        return math.pi * self.length * float(at_zero - at_one + area)

    def _extremes(self, q: Array) -> tuple[float, float]:
        """Smallest and largest radius of the interpolant, by parabolas through its values on eight times as many points."""
        fine = 8 * np.fft.irfft(np.fft.rfft(q), 8 * self.points)
        found = []
        for place in (int(fine.argmin()), int(fine.argmax())):
            before, at, after = fine[place - 1], fine[place], fine[(place + 1) % len(fine)]
            bend = after - 2 * at + before
            found.append(at - (after - before) ** 2 / (8 * bend) if bend else at)
        return float(np.sqrt(2 * found[0])), float(np.sqrt(2 * found[1]))

    def trouble(self, q: Array) -> Trouble | None:
        """A pinch or an overhang."""
        r = self.radii(q)
        slope = np.abs(self.d1 @ q) / r
        thin, steep = int(r.argmin()), int(slope.argmax())
        if r[thin] < self.thinnest:
            where = Sentence("the neck at x = {x:.4g} has a radius of {r:.1e}", x=self.x[thin], r=r[thin])
            return Trouble("pinch", where, "the surface is about to touch its axis; stop before, or change the volume")
        if slope[steep] > self.steepest:
            where = Sentence("the profile at x = {x:.4g} has slope {slope:.0f}", x=self.x[steep], slope=slope[steep])
            return Trouble("overhang", where, "it is about to be no graph over the axis; use a triangulated tube")
        return None

    @property
    def space(self) -> str:
        """What it describes."""
        return "axisymmetric shapes"

    @property
    def creeps(self) -> bool:
        """Trigonometric interpolants are shifted exactly."""
        return False

    @property
    def wanted_resolution(self) -> float:
        """Spectral: ten digits cost little more than five."""
        return 1e-9

    def resolution(self, q: Array) -> float:
        """Largest of the last tenth of the Fourier coefficients, relative to the largest."""
        coefficients = np.abs(np.fft.rfft(q))
        return float(coefficients[-max(2, self.points // 20) :].max() / coefficients.max())

    def refined(self, q: Array) -> tuple[GraphFlow, Array] | None:
        """Half as many points again, by trigonometric interpolation."""
        points = 2 * ((3 * self.points) // 4)
        if points > MOST_POINTS:
            return None
        finer = replace(self, points=points)
        return finer, self.interpolated(q, finer.x)

    def remeshed(self, q: Array) -> None:
        """A graph's points stay where they are."""

    def interpolated(self, q: Array, x: Array) -> Array:
        """The trigonometric interpolant at other places."""
        coefficients = np.fft.rfft(q) / self.points
        weights = np.full(len(coefficients), 2.0)
        weights[0] = weights[-1] = 1.0
        phase = 2 * np.pi * np.outer((x + self.length / 2) / self.length, np.arange(len(coefficients)))
        return np.asarray((np.exp(1j * phase) @ (weights * coefficients)).real)

    def surface(self, q: Array, along: int = 161, around: int = 49) -> tuple[Array, Array, Array]:
        """Points to draw: ``x, y, z``, each of shape (along, around), closed around."""
        x, phi = np.linspace(-self.length / 2, self.length / 2, along), np.linspace(0, 2 * np.pi, around)
        r = np.sqrt(2 * self.interpolated(q, x))
        return np.repeat(x[:, None], around, axis=1), np.outer(r, np.cos(phi)), np.outer(r, np.sin(phi))

    def to_tree(self) -> dict[str, Any]:
        """Everything as numbers and words."""
        return {
            "kind": "graph", "c0": self.c0, "length": self.length, "points": self.points, "law": self.law,
            "pressure": self.pressure, "thinnest": self.thinnest, "steepest": self.steepest,
        }  # fmt: skip

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> GraphFlow:
        """The inverse of ``to_tree``."""
        law = str(tree["law"])
        if law not in get_args(Law):
            raise ValueError(f"law: {law!r} is none of {get_args(Law)}")
        numbers = float(tree["c0"]), float(tree["length"]), int(tree["points"])
        limits = float(tree["pressure"]), float(tree["thinnest"]), float(tree["steepest"])
        return cls(*numbers, law, *limits)  # type: ignore[arg-type]
