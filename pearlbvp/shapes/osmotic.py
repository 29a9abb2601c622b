"""Pearls of a tube at a given tension with solute in it: membrane and water come from reservoirs (``theory.osmotic``).

The equations are those of ``shapes.axisymmetric``. The area is no longer given, which takes one unknown and one condition
away; the law of the pressure, ``lambda2 = osmolarity - solute / v``, is one more condition. With ``osmolarity`` or ``length``
free, solutions are a curve. See ``docs/theory/osmotic.md``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation import BoundaryValueProblem
from pearlbvp.collocation.polynomial import extremes
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.held import Held
from pearlbvp.helfrich import Tube, cylinder_lambda1
from pearlbvp.representation import brief
from pearlbvp.shapes import axisymmetric
from pearlbvp.shapes.cells import HALF_CELL
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.shapes.pearling import pearling_onset
from pearlbvp.stability.spectrum import spectrum
from pearlbvp.theory.osmotic import osmotic_work

PARAMETERS = (*axisymmetric.PARAMETERS, "solute", "osmolarity")
_V, _LENGTH, _SOLUTE, _OSMOLARITY = (PARAMETERS.index(name) for name in ("v", "length", "solute", "osmolarity"))
_KEPT = [0, 2]
"""Of the integrals of ``axisymmetric``, those of length and volume; the area is as it comes."""


def _padded(derivatives: Array) -> Array:
    """Derivatives by the parameters of ``axisymmetric``, and by those of the law, on which they do not depend."""
    return np.concatenate((derivatives, np.zeros((*derivatives.shape[:-1], 2))), axis=-1)


def _rhs_jacobian(t: Array, y: Array, p: Array) -> tuple[Array, Array]:
    by_y, by_p = axisymmetric.rhs_jacobian(t, y, p)
    return by_y, _padded(by_p)


def _integrand_jacobian(t: Array, y: Array, p: Array) -> tuple[Array, Array]:
    by_y, by_p = axisymmetric.constraints_jacobian(t, y, p)
    return by_y[:, _KEPT], _padded(by_p[:, _KEPT])


def _boundary(ya: Array, yb: Array, p: Array) -> Array:
    return np.append(HALF_CELL.boundary(ya, yb, p), p[2] + p[_SOLUTE] / p[_V] - p[_OSMOLARITY])


def _boundary_jacobian(ya: Array, yb: Array, p: Array) -> tuple[Array, Array, Array]:
    at_a, at_b, by_p = HALF_CELL.boundary_jacobian(ya, yb, p)
    law = np.zeros((1, len(PARAMETERS)))
    law[0, [2, _V, _SOLUTE, _OSMOLARITY]] = 1.0, -p[_SOLUTE] / p[_V] ** 2, 1 / p[_V], -1.0
    none = np.zeros((1, 4))
    return np.vstack((at_a, none)), np.vstack((at_b, none)), np.vstack((_padded(by_p), law))


OSMOTIC_HALF_CELL = BoundaryValueProblem(
    states=axisymmetric.STATES,
    parameters=PARAMETERS,
    rhs=axisymmetric.rhs,
    rhs_jacobian=_rhs_jacobian,
    boundary=_boundary,
    boundary_jacobian=_boundary_jacobian,
    integrand=lambda t, y, p: axisymmetric.constraints(t, y, p)[:, _KEPT],
    integrand_jacobian=_integrand_jacobian,
)


@dataclass(frozen=True)
class OsmoticPearl(PearlProblem):
    """Pearls at a given tension with solute in them, half a pearl of ``cells`` equal ones on the tube."""

    __repr__ = brief

    def law(self, u: Array) -> tuple[float, float]:
        """``solute, osmolarity``."""
        p = self.discretization.all_parameters(u)
        return float(p[_SOLUTE]), float(p[_OSMOLARITY])

    def observables(self, u: Array) -> dict[str, float]:
        """``lambda1, lambda2, v, E, amplitude, r_min, r_max, c0, L, area, force, potential, osmolarity``.

        ``L`` is the period, ``area`` by that of the straight tube of radius 1, ``E`` the energy by area; ``potential`` is what
        is least at stable equilibria: energy, tension times area, and the work that the law of the pressure does, by length.
        """
        d = self.discretization
        y, p = d.at_gauss_points(u), d.all_parameters(u)
        narrowest, widest = extremes(d.polynomial(u), 0)
        area, v = float(p[0] * (d.gauss_weights @ y[:, 0]) / p[_LENGTH]), float(p[_V])
        energy = float(d.gauss_weights @ axisymmetric.energy_density(y, p))  # by the area of the straight tube
        work = osmotic_work(v, *self.law(u))
        return {
            "lambda1": float(p[1]),
            "lambda2": float(p[2]),
            "v": v,
            "E": energy / area,
            "amplitude": (widest - narrowest) / 2,
            "r_min": narrowest,
            "r_max": widest,
            "c0": float(p[3]),
            "L": 2 * float(p[_LENGTH]),
            "area": area,
            "force": 2 * math.pi * float(axisymmetric.axial_force(d.values(u)[:1], p)[0]),
            "potential": 2 * math.pi * (energy + float(p[1]) * area) + work,
            "osmolarity": float(p[_OSMOLARITY]),
        }

    def spectrum(self, u: Array) -> Spectrum:
        """Growth rates of all perturbations that fit ``cells`` such pearls, at this tension with this solute."""
        p = self.discretization.all_parameters(u)
        solute = float(p[_SOLUTE]) * math.pi * 2 * float(p[_LENGTH]) * self.cells  # of the whole tube
        return spectrum(self.profile(u), self.cells, held=Held(area=False, volume=False, solute=solute))

    def at_osmolarity(self, u: Array, osmolarity: float) -> tuple[Self, Array]:
        """The same solution on the curve on which the period varies at one osmolarity, which it has to rounding."""
        problem, u = self.freeing(u, "lambda2", "v", "length")
        d = problem.discretization
        parameters = d.parameters.copy()
        parameters[_OSMOLARITY] = osmolarity
        return replace(problem, discretization=replace(d, parameters=parameters)), u


def osmotic_onset(c0: float, period: float, size: float, solute: float) -> Solution[OsmoticPearl]:
    """Where pearls of a period leave a straight tube that the pressure has blown up, ``osmolarity`` free on their curve.

    Args:
        c0: spontaneous curvature; the tension is ``1/4 - c0^2``.
        period: axial period of one pearl.
        size: radius of the tube there, one of ``theory.osmotic.onset_sizes``.
        solute: of the law.
    """
    similar, u, tangent = pearling_onset(Tube(c0 * size, period / size))
    d = similar.discretization
    grown = np.array([size, 1.0, 1 / size, 1 / size**2])
    p = d.all_parameters(u)
    lambda2, v = p[2] / size**3, size**2
    parameters = np.array(
        [period / 2, cylinder_lambda1(0.0, c0), lambda2, c0, period / 2, v, solute, lambda2 + solute / v]
    )
    free = ("arclength", "lambda2", "v", "osmolarity")
    own = replace(d, problem=OSMOTIC_HALF_CELL, parameters=parameters, free=free, weights=None)
    problem = OsmoticPearl(own, None, similar.tolerance)
    direction = own.pack(d.values(tangent) * grown, np.zeros(len(PARAMETERS)))
    return Solution.along(problem, own.pack(d.values(u) * grown, parameters), direction)
