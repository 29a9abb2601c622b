"""Axisymmetric tubes by the angle of their outline, a sine series in arclength: an energy to be minimised, overhangs included.

Half a period between two planes of reflection, as ``shapes.cells`` has it: with ``sigma`` in [0, 1] and ``s = S sigma``

    psi = sum of b_k sin(pi k sigma)    r = r_0 + S integral of sin psi    h = (cos psi / r - psi' / S) / 2

and means over ``sigma``, divided by the half period ``l``: of ``S r (h - c0)^2`` the energy by area, and of ``S cos psi``,
``S r``, ``S r^2 cos psi`` what is to be 1, 1 and ``v``. All are even about both planes, so that sums over midpoints are
spectrally accurate; gradients and second derivatives are the exact ones of these sums.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation import Discretization, gauss_scheme
from pearlbvp.collocation.mesh import equidistribute
from pearlbvp.collocation.polynomial import PiecewisePolynomial, all_points
from pearlbvp.continuation.path import PathEnd
from pearlbvp.helfrich import Tube
from pearlbvp.minimum import least
from pearlbvp.newton import NewtonOptions, newton
from pearlbvp.shapes.cells import HALF_CELL
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.shapes.sphere_on_tether import sphere_on_tether

TRIALS, ROUGHNESS, STRAIGHTEST, NARROWEST = 64, (0.3, 4.0), 0.3, 0.05
"""Of random outlines: how many are tried, the sizes of the angle's waves, the least mean cosine and radius."""


@lru_cache(maxsize=8)
def _matrices(waves: int) -> tuple[Array, Array, Array]:
    """At ``4 waves`` midpoints: sines and their derivatives, shape (M, waves), and the integral of an odd function, (M, M)."""
    points = 4 * waves
    sigma = (np.arange(points) + 0.5) / points
    k = np.pi * np.arange(1, points + 1)
    sines, cosines = np.sin(np.outer(sigma, k)), np.cos(np.outer(sigma, k))
    transform = 2 * sines.T / points
    transform[-1] /= 2
    return sines[:, :waves], (cosines * k)[:, :waves], ((1 - cosines) / k) @ transform


@dataclass(frozen=True)
class Outline:
    """Half a period of an axisymmetric tube of given length, area and volume; coordinates are ``b_1, b_2, ..., r_0, S``.

    Attributes:
        c0: spontaneous curvature.
        half: half the period.
        v: reduced volume.
        waves: sines of the angle.
    """

    c0: float
    half: float
    v: float
    waves: int = 32

    @classmethod
    def on(cls, tube: Tube, v: float) -> Outline:
        """Outlines of one period of a tube, with waves enough for pearls."""
        return cls(tube.c0, tube.length / 2, v, max(32, math.ceil(2.4 * tube.length)))

    @cached_property
    def scales(self) -> Array:
        """Bending energy has the squares of the angle's derivatives."""
        k = np.pi * np.arange(1, self.waves + 1) / self.half
        return np.concatenate((1 / (1 + k), [1.0, self.half]))

    def _points(self, q: Array) -> tuple[Array, Array, Array, float]:
        """``psi``, its derivative by ``sigma``, ``r`` and ``S``."""
        sines, slopes, integral = _matrices(self.waves)
        b, length = q[:-2], float(q[-1])
        psi = sines @ b
        return psi, slopes @ b, q[-2] + length * (integral @ np.sin(psi)), length

    def radii(self, q: Array) -> Array:
        """At the points, shape (M,)."""
        return self._points(q)[2]

    def _curvature(self, q: Array) -> tuple[Array, Array]:
        """``h - c0`` and its derivatives by ``psi, psi', r, S``, shape (4, M)."""
        psi, turn, r, length = self._points(q)
        cosine, sine = np.cos(psi), np.sin(psi)
        bend = cosine / (2 * r) - turn / (2 * length) - self.c0
        first = np.array([-sine / r, np.full_like(r, -1 / length), -cosine / r**2, turn / length**2]) / 2
        return bend, first

    def energy(self, q: Array) -> float:
        """Energy by area; infinite where the outline meets the axis."""
        _, _, r, length = self._points(q)
        if r.min() <= 0 or length <= 0:
            return math.inf
        bend, _ = self._curvature(q)
        return float((r * bend**2).mean()) * length / self.half

    def constraints(self, q: Array) -> Array:
        """Length, area and volume, less what they are to be; not numbers where the outline meets the axis."""
        psi, _, r, length = self._points(q)
        if r.min() <= 0 or length <= 0:
            return np.full(3, np.nan)
        means = np.array([np.cos(psi).mean(), r.mean(), (r**2 * np.cos(psi)).mean()])
        return np.asarray(length / self.half * means - [1.0, 1.0, self.v])

    def _slopes(self, q: Array) -> tuple[Array, Array]:
        """Derivatives by ``psi, psi', r, S`` of the densities of the energy, (4, M), and of the constraints, (3, 4, M)."""
        psi, _, r, length = self._points(q)
        cosine, sine = np.cos(psi), np.sin(psi)
        bend, first = self._curvature(q)
        energy = 2 * length * r * bend * first
        energy[2] += length * bend**2
        energy[3] += r * bend**2
        rows = np.zeros((3, 4, len(r)))
        rows[0, 0], rows[0, 3] = -length * sine, cosine
        rows[1, 2], rows[1, 3] = length, r
        rows[2, 0], rows[2, 2], rows[2, 3] = -length * r**2 * sine, 2 * length * r * cosine, r**2 * cosine
        return energy / self.half, rows / self.half

    def _by_coordinates(self, q: Array) -> tuple[Array, Array, Array]:
        """Derivatives of ``psi, psi', r`` by the coordinates, (M, N) each."""
        psi, _, _, length = self._points(q)
        sines, slopes, integral = _matrices(self.waves)
        none = np.zeros((len(psi), 2))
        by_r = length * (integral * np.cos(psi)) @ sines
        ends = np.column_stack((np.ones(len(psi)), integral @ np.sin(psi)))
        return np.hstack((sines, none)), np.hstack((slopes, none)), np.hstack((by_r, ends))

    def _gathered(self, q: Array, slopes: Array) -> Array:
        """Mean of slopes times the derivatives by the coordinates, for slopes (..., 4, M): shape (..., N)."""
        found = sum(slopes[..., i, :] @ by for i, by in enumerate(self._by_coordinates(q)))
        found = np.asarray(found)
        found[..., -1] += slopes[..., 3, :].sum(axis=-1)
        return found / slopes.shape[-1]

    def gradient(self, q: Array) -> Array:
        """Of the energy."""
        return self._gathered(q, self._slopes(q)[0])

    def constraint_rows(self, q: Array) -> Array:
        """Of the constraints."""
        return self._gathered(q, self._slopes(q)[1])

    def hessian(self, q: Array, multipliers: Array) -> Array:
        """Of energy and constraints."""
        psi, turn, r, length = self._points(q)
        cosine, sine = np.cos(psi), np.sin(psi)
        bend, first = self._curvature(q)
        energy, rows = self._slopes(q)
        force, tension, pressure = multipliers
        second = np.zeros((4, 4, len(r)))
        second += 2 * length * r * first[:, None] * first  # of S r u^2, u = h - c0
        for i, by in ((2, length), (3, r)):
            second[i] += 2 * by * bend * first
            second[:, i] += 2 * by * bend * first
        weight = length * r * bend  # of u's own second derivatives, twice
        second[0, 0] += -weight * cosine / r - length * (force + pressure * r**2) * cosine
        second[2, 2] += 2 * weight * cosine / r**3 + 2 * pressure * length * cosine
        second[3, 3] += -2 * weight * turn / length**3
        mixed = {
            (0, 2): weight * sine / r**2 - 2 * pressure * length * r * sine,
            (0, 3): -(force + pressure * r**2) * sine,
            (1, 3): weight / length**2,
            (2, 3): bend**2 + tension + 2 * pressure * r * cosine,
        }
        for (i, j), value in mixed.items():
            second[i, j] += value
            second[j, i] += value
        second /= self.half * len(r)
        jacobians = np.array([*self._by_coordinates(q), np.zeros((len(r), len(q)))])
        jacobians[3, :, -1] = 1.0
        result = np.zeros((len(q), len(q)))
        for i in range(4):
            weighted = sum(second[i, j][:, None] * jacobians[j] for j in range(4))
            result += jacobians[i].T @ weighted
        # r itself is curved: by the angle's sine, and by S times that.
        sines, _, integral = _matrices(self.waves)
        pull = (energy + np.tensordot(multipliers, rows, 1))[2] @ integral / len(r)
        result[:-2, :-2] -= length * (sines.T * (pull * sine)) @ sines
        by_length = sines.T @ (pull * cosine)
        result[:-2, -1] += by_length
        result[-1, :-2] += by_length
        return result

    def random(self, random: np.random.Generator) -> Array:
        """Coordinates of a random smooth outline of the right length and area: of several that of the nearest volume."""
        sines, _, integral = _matrices(self.waves)
        k = np.pi * np.arange(1, self.waves + 1) / self.half
        found = []
        for _ in range(TRIALS):
            b = random.uniform(*ROUGHNESS) * random.standard_normal(self.waves) / (1 + k**2)
            psi = sines @ b
            if np.cos(psi).mean() < STRAIGHTEST:
                continue
            length = self.half / float(np.cos(psi).mean())
            r = length * (integral @ np.sin(psi))
            q = np.concatenate((b, [self.half / length - r.mean(), length]))
            if r.min() + q[-2] > NARROWEST:
                found.append(q)
        return min(
            found,
            key=lambda q: abs(float(self.constraints(q)[2])),
            default=np.append(np.zeros(self.waves), [1.0, self.half]),
        )

    def of_radius(self, cosines: Array) -> Array:
        """Coordinates of the graph ``r = a_0 + sum of a_k cos(pi k x / l)``, as far as the waves hold it.

        Args:
            cosines: ``a_1, a_2, ...``; the mean radius ``a_0`` is that of the right volume, where there is one.
        """
        from scipy.interpolate import CubicSpline  # a tenth of a second to import, and only this needs it

        x = np.linspace(0, self.half, 8 * self.waves + 1)
        k = np.pi * np.arange(1, len(cosines) + 1) / self.half
        mean = math.sqrt(max(self.v - float(cosines @ cosines) / 2, NARROWEST))
        slope = -np.sin(np.outer(x, k)) @ (k * cosines)
        s = CubicSpline(x, np.hypot(1, slope)).antiderivative()(x)
        sines = _matrices(self.waves)[0]
        middles = (np.arange(len(sines)) + 0.5) / len(sines)
        psi = np.arctan(CubicSpline(s / s[-1], slope)(middles))
        return np.concatenate((2 / len(sines) * (psi @ sines), [mean + cosines.sum(), s[-1]]))

    def sphere_on_tether(self) -> Array:
        """Coordinates of a sphere at the first plane of reflection, and a tether to the other (``shapes.sphere_on_tether``).

        The angle, which jumps at the neck, is smoothed by Lanczos' factors.

        Raises:
            ValueError: there is none of this volume.
        """
        belly, angle = sphere_on_tether(self.half, self.v)
        sines, _, integral = _matrices(self.waves)
        points = len(sines)
        arc = (np.arange(points) + 0.5) / points * (belly * angle + self.half - belly * math.sin(angle))
        k = np.arange(1, self.waves + 1)
        b = np.sinc(k / (self.waves + 1)) * (2 / points * np.where(arc < belly * angle, -arc / belly, 0.0) @ sines)
        psi = sines @ b
        length = self.half / float(np.cos(psi).mean())
        return np.concatenate((b, [self.half / length - (length * integral @ np.sin(psi)).mean(), length]))

    def finer(self, q: Array) -> tuple[Outline, Array]:
        """The same on twice as many sines."""
        return replace(self, waves=2 * self.waves), np.concatenate((q[:-2], np.zeros(self.waves), q[-2:]))

    def states(self, q: Array, sigma: Array) -> Array:
        """``r, psi, h, w`` at places, shape (K, 4)."""
        psi, _, _, length = self._points(q)
        k = np.pi * np.arange(1, self.waves + 1)
        points = len(psi)
        angle = np.outer(sigma, k)
        b = q[:-2]
        at = np.sin(angle) @ b
        by, by2 = np.cos(angle) @ (k * b) / length, -np.sin(angle) @ (k**2 * b) / length**2
        sines = _matrices(self.waves)[0]
        waves = np.pi * np.arange(1, points + 1)
        middles = (np.arange(points) + 0.5) / points
        coefficients = 2 * np.sin(np.outer(waves, middles)) @ np.sin(sines @ b) / points
        coefficients[-1] /= 2
        r = q[-2] + length * (1 - np.cos(np.outer(sigma, waves))) @ (coefficients / waves)
        cosine, sine = np.cos(at), np.sin(at)
        h = (cosine / r - by) / 2
        w = (-sine * by / r - cosine * sine / r**2 - by2) / 2
        return np.column_stack((r, at, h, w))


class StraightEnd(PathEnd):
    """Downhill lies the straight tube, of which nothing branches off that way."""


def downhill(outline: Outline, q: Array, *, cells: int = 1, tolerance: float = 1e-9) -> tuple[PearlProblem, Array]:
    """The equilibrium of least energy that lies downhill from an outline.

    Args:
        outline, q: where to start; it need not have the length, area and volume that are wanted.
        cells: such periods on the tube.
        tolerance: of the profile.

    Raises:
        PathEnd: there is none.
        StraightEnd: it is the straight tube.
    """
    found = least(outline, q)
    if not found.reason and np.abs(found.q[-8:-2]).max() > TAIL:
        outline, q = outline.finer(found.q)
        found = least(outline, q)
    # At the straight tube length, area and volume have parallel gradients, so that the method need not end in a minimum.
    if np.ptp(outline.radii(found.q)) < 2 * STRAIGHT:
        raise StraightEnd("it came to the straight tube")
    if found.reason:
        raise PathEnd(found.reason)
    problem, u, why = pearl_of_outline(outline, found.q, found.multipliers, cells=cells, tolerance=tolerance)
    if why:
        raise PathEnd(f"the outline of least energy led to no equilibrium ({why})")
    return problem, u


TAIL = 1e-4
"""Size of an outline's last waves at which it is relaxed on twice as many, once."""

STRAIGHT = 1e-3
"""Amplitude up to which an outline of least energy is the straight tube: of others the volume is at least 5e-7 from 1."""


def pearl_of_outline(
    outline: Outline, q: Array, multipliers: Array, *, cells: int = 1, intervals: int = 24, tolerance: float = 1e-9
) -> tuple[PearlProblem, Array, str]:
    """The equilibrium near the outline of least energy, by Newton's method on the half cell at fixed volume.

    Args:
        outline, q, multipliers: a minimum; its multipliers are ``force, lambda1, lambda2/2`` by that of the constraints.
        cells: such periods on the tube.
        intervals: of the first mesh.
        tolerance: of the profile.

    Returns:
        Problem, unknown, and an empty text or why there is no equilibrium.
    """
    scheme = gauss_scheme(6)
    even = np.linspace(0, 1, intervals + 1)
    start = PiecewisePolynomial(even, outline.states(q, all_points(even, scheme)))
    mesh = equidistribute(start, intervals)
    parameters = np.array([q[-1], multipliers[1], 2 * multipliers[2], outline.c0, outline.half, outline.v])
    fixed = Discretization(HALF_CELL, scheme, mesh, parameters, ("arclength", "lambda1", "lambda2"))
    states = outline.states(q, all_points(mesh, scheme))
    states[[0, -1], 1] = states[[0, -1], 3] = 0.0
    found = newton(
        fixed.residual, fixed.solve, fixed.pack(states, parameters), NewtonOptions(max_iterations=40, damping=12)
    )
    free = replace(fixed, parameters=fixed.all_parameters(found.u), free=("arclength", "lambda1", "lambda2", "v"))
    problem = PearlProblem(free, None, tolerance, cells=cells)
    return problem, free.pack(fixed.values(found.u), free.parameters), found.message
