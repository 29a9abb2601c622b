"""An axisymmetric equilibrium as a function of arclength: what stability is computed of."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation import PiecewisePolynomial
from pearlbvp.compiled import compiled
from pearlbvp.errors import InputError
from pearlbvp.membrane import Surface
from pearlbvp.projection import Projection
from pearlbvp.representation import brief


@dataclass(frozen=True)
class Profile:
    """One period of an axisymmetric surface, or the half of it between two planes of reflection.

    Attributes:
        states: ``r, psi, h, w`` (radius, tangent angle, mean curvature and its derivative by arclength) as functions
            of ``sigma`` in [0, 1], ``s = arclength * sigma``.
        arclength: length of the profile curve given.
        half: whether the profile given is half a period, ending in planes of reflection.
        c0, lambda1, lambda2: the parameters and multipliers with which it is an equilibrium.
        period: axial length of the whole period.
    """

    __repr__ = brief

    states: PiecewisePolynomial
    arclength: float
    half: bool
    c0: float
    lambda1: float
    lambda2: float
    period: float

    def at(self, sigma: Array) -> Array:
        """States at ``sigma``, shape (K,), of the whole period: ``sigma`` from 0 to 1, or to 2 for a half profile.

        Returns:
            Shape (K, 4): ``r, psi, h, w``; past a plane of reflection ``psi`` and ``w`` change sign.
        """
        beyond = sigma > 1
        states = self.states(np.where(beyond, 2 - sigma, sigma))
        states[beyond, 1] *= -1
        states[beyond, 3] *= -1
        return states

    def outline(self) -> tuple[Array, Array]:
        """Axial position and radius along the whole period, from its first point on, each of shape (K,)."""
        whole = self.mirrored()
        slopes = PiecewisePolynomial(whole.states.mesh, np.cos(whole.states.values[:, 1:2]))
        return whole.arclength * slopes.integral()[:, 0], whole.states.values[:, 0]

    @property
    def is_graph(self) -> bool:
        """Whether its radius is a function of the axial position: it overhangs nowhere."""
        return bool(np.cos(self.states.values[:, 1]).min() > 0)

    def radii_at(self, x: Array) -> Array:
        """Radius at axial positions counted from the first point, shape of ``x``.

        Raises:
            InputError: the profile overhangs.
        """
        if not self.is_graph:
            raise InputError(
                "point", "its shape overhangs, so it is no graph over its axis", "choose one nearer to the cylinder"
            )
        whole, (places, _) = self.mirrored(), self.outline()
        along = PiecewisePolynomial(whole.states.mesh, places[:, None])
        targets = np.mod(x, self.period)
        sigma = np.interp(targets, places, whole.states.points)
        for _ in range(30):
            step = (along(sigma)[:, 0] - targets) / (whole.arclength * np.cos(whole.states(sigma)[:, 1]))
            sigma = np.clip(sigma - step, 0.0, 1.0)
            if np.abs(step).max() < 1e-14:
                break
        return whole.states(sigma)[:, 0]

    def clearance(self) -> float:
        """How far the outline is from touching its mirror images, or the period where it overhangs nowhere.

        Negative where it crosses them: then the surface passes through itself. It meets a plane of reflection first where it is
        perpendicular to the axis there, so that between two such planes this is twice the least distance of those places.
        -inf where it crosses itself elsewhere.
        """
        if self.is_graph:
            return self.period
        x, r = self.outline()
        nearest = self._over_planes(x) if self.half else self.period
        return -math.inf if nearest >= 0 and outline_crosses_itself(x, r, self.period) else nearest

    def _over_planes(self, places: Array) -> float:
        """Twice the least distance from the planes of reflection of places where the outline runs perpendicular to the axis."""
        points = self.states.points
        along = PiecewisePolynomial(self.states.mesh, places[: len(points), None])
        r, psi, h, _ = self.states.values.T
        turning = np.flatnonzero(np.cos(psi[:-1]) * np.cos(psi[1:]) < 0)
        sigma = (points[turning] + points[turning + 1]) / 2
        for _ in range(6):  # Newton's method for cos psi = 0
            r, psi, h, _ = self.states(sigma).T
            slope = self.arclength * (np.cos(psi) / r - 2 * h)
            sigma = np.clip(sigma + np.cos(psi) / (np.sin(psi) * slope), points[turning], points[turning + 1])
        x = along(sigma)[:, 0]
        return float(2 * np.minimum(x, self.period / 2 - x).min(initial=self.period / 2))

    def projection(self) -> Projection:
        """The whole period over the straight tube."""
        states, (x, r) = self.mirrored().states, self.outline()
        share = states.weights * np.cos(states.values[:, 1])
        return Projection(x, np.zeros_like(x), r, share / share.sum())

    def surface(self, around: int = 48) -> tuple[Array, Array, Array]:
        """Points of the surface, to draw or to export: ``x, y, z``, each of shape (K, around + 1), closed around."""
        x, r = self.outline()
        angle = np.linspace(0, 2 * np.pi, around + 1)
        return np.repeat(x[:, None], around + 1, axis=1), np.outer(r, np.cos(angle)), np.outer(r, np.sin(angle))

    def parametrized(self) -> Surface:
        """Points by ``x``, the arclength scaled to the length, and ``phi``."""
        states = self.mirrored().states
        along = PiecewisePolynomial(states.mesh, self.outline()[0][:, None])

        def points(x: Array, phi: Array) -> Array:
            period = np.floor(x / self.period)
            sigma = x / self.period - period
            r = states(sigma)[:, 0]
            return np.column_stack((along(sigma)[:, 0] + self.period * period, r * np.cos(phi), r * np.sin(phi)))

        return points

    def curve(self, periods: int, samples: int) -> dict[str, Array]:
        """``x, r, psi, H`` of some periods at equal steps of arclength, ``samples`` a period; the last point closes it."""
        whole = self.mirrored()
        along = PiecewisePolynomial(whole.states.mesh, whole.outline()[0][:, None])
        sigma = np.linspace(0, 1, samples + 1)
        period = np.column_stack((along(sigma), whole.states(sigma)[:, :3]))
        shift = np.array([self.period, 0.0, 0.0, 0.0])
        rows = [period[:-1] + i * shift for i in range(periods)]
        columns = np.concatenate((*rows, period[:1] + periods * shift)).T
        return dict(zip(("x", "r", "psi", "H"), columns, strict=True))

    def mirrored(self) -> Profile:
        """The whole period as one piecewise polynomial."""
        if not self.half:
            return self
        mesh, values = self.states.mesh / 2, self.states.values
        reflected = values[::-1] * np.array([1.0, -1.0, 1.0, -1.0])
        whole = PiecewisePolynomial(np.append(mesh, 1 - mesh[-2::-1]), np.vstack((values, reflected[1:])))
        return Profile(whole, 2 * self.arclength, False, self.c0, self.lambda1, self.lambda2, self.period)


def outline_crosses_itself(x: Array, r: Array, period: float) -> bool:
    """Whether one period of a curve, as a polygon, crosses itself or the next period.

    Args:
        x, r: corners, from one end of the period to the other, shape (K,).
        period: of the curve along ``x``.
    """
    if (np.diff(x) > 0).all():
        return False
    return bool(_crosses(np.append(x[:-1], x + period), np.append(r[:-1], r)))


@compiled
def _turn(x, r, i, j):  # type: ignore[no-untyped-def]
    """On which side of the segment from corner ``i`` on the corner ``j`` lies."""
    return (x[i + 1] - x[i]) * (r[j] - r[i]) - (r[i + 1] - r[i]) * (x[j] - x[i])


@compiled
def _crosses(x, r):  # type: ignore[no-untyped-def]
    """Whether two segments of a polygon cross that are no neighbours: the ends of either on both sides of the other."""
    for i in range(len(x) - 1):
        for j in range(i + 2, len(x) - 1):
            if min(x[j], x[j + 1]) > max(x[i], x[i + 1]) or max(x[j], x[j + 1]) < min(x[i], x[i + 1]):
                continue
            if _turn(x, r, i, j) * _turn(x, r, i, j + 1) < 0 and _turn(x, r, j, i) * _turn(x, r, j, i + 1) < 0:
                return True
    return False


@dataclass(frozen=True)
class Curvatures:
    """Geometry of a profile at points, each of shape (K,). Primes are derivatives by arclength.

    Attributes:
        r: radius.
        b: ``sin psi / r``.
        h, h1, h2, lap: mean curvature, ``H'``, ``H''``, and its surface Laplacian ``H'' + b H'`` (from ``G = 0``).
        along, around: principal curvatures ``kappa_s`` and ``kappa_phi = cos psi / r``.
        gauss: their product.
    """

    __repr__ = brief

    r: Array
    b: Array
    h: Array
    h1: Array
    h2: Array
    lap: Array
    along: Array
    around: Array
    gauss: Array


def curvatures(states: Array, profile: Profile) -> Curvatures:
    """Geometry at given states, shape (K, 4), of a profile."""
    r, psi, h, w = states.T
    b, around = np.sin(psi) / r, np.cos(psi) / r
    along = 2 * h - around
    gauss = along * around
    c0 = profile.c0
    lap = -(2 * h * (h**2 - gauss) + 2 * c0 * gauss - 2 * (c0**2 + profile.lambda1) * h - profile.lambda2)
    return Curvatures(r, b, h, w, lap - b * w, lap, along, around, gauss)
