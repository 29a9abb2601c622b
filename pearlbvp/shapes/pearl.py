"""Pearls: axisymmetric equilibria of fixed period and area, on the half cell and on the full cell (design, §4).

The half cell ends in planes of reflection (``psi = w = 0``): four states and the unknowns ``arclength, lambda1, lambda2,
v`` against four boundary conditions and three integrals leave a curve of solutions, with no redundancy and no phase.
On the full cell the shift along the axis needs a phase condition, and the conserved axial force makes one of the
periodicity conditions redundant: an unfolding parameter takes its place and must stay at rounding level (F. J.
Munoz-Almaraz et al., Physica D 181 (2003) 1).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from pearlbvp.collocation import (
    BoundaryValueProblem,
    Discretization,
    equidistribute,
    error_estimate,
    gauss_scheme,
    intervals_for,
)
from pearlbvp.collocation.polynomial import all_points
from pearlbvp.collocation.scheme import Array
from pearlbvp.helfrich import Tube, cylinder_lambda1
from pearlbvp.shapes import axisymmetric
from pearlbvp.stability.profile import Profile
from pearlbvp.theory.dispersion import critical_lambda2

_ENDS = np.zeros((4, 4)), np.zeros((4, 4)), np.zeros((4, 6))
_ENDS[0][0, 1] = _ENDS[0][1, 3] = _ENDS[1][2, 1] = _ENDS[1][3, 3] = 1.0

HALF_CELL = BoundaryValueProblem(
    states=axisymmetric.STATES,
    parameters=axisymmetric.PARAMETERS,
    rhs=axisymmetric.rhs,
    rhs_jacobian=axisymmetric.rhs_jacobian,
    boundary=lambda ya, yb, p: np.array([ya[1], ya[3], yb[1], yb[3]]),
    boundary_jacobian=lambda ya, yb, p: _ENDS,
    integrand=axisymmetric.constraints,
    integrand_jacobian=axisymmetric.constraints_jacobian,
)


def full_cell(reference: Callable[[Array], Array]) -> BoundaryValueProblem:
    """The periodic problem, its phase fixed against ``reference``.

    Args:
        reference: derivative by ``sigma`` of some profile of the same shape, (K,) to (K, 4). The phase condition is
            ``integral of reference . y = 0``, which holds for the profile itself.

    The unfolding parameter ``drag`` adds ``drag * r sin psi`` to ``w'``, which would change the axial force by
    ``-drag * (r sin psi)^2`` all along.
    """

    def rhs(t: Array, y: Array, p: Array) -> Array:
        f: Array = axisymmetric.rhs(t, y, p)
        f[:, 3] += p[6] * y[:, 0] * np.sin(y[:, 1])
        return f

    def rhs_jacobian(t: Array, y: Array, p: Array) -> tuple[Array, Array]:
        by_y, by_p = axisymmetric.rhs_jacobian(t, y, p)
        r, sine, cosine = y[:, 0], np.sin(y[:, 1]), np.cos(y[:, 1])
        by_y[:, 3, 0] += p[6] * sine
        by_y[:, 3, 1] += p[6] * r * cosine
        by_drag = np.zeros((len(y), 4, 1))
        by_drag[:, 3, 0] = r * sine
        return by_y, np.concatenate((by_p, by_drag), axis=2)

    def integrand(t: Array, y: Array, p: Array) -> Array:
        return np.column_stack((axisymmetric.constraints(t, y, p), (reference(t) * y).sum(axis=1)))

    def integrand_jacobian(t: Array, y: Array, p: Array) -> tuple[Array, Array]:
        by_y, by_p = axisymmetric.constraints_jacobian(t, y, p)
        by_y = np.concatenate((by_y, reference(t)[:, None, :]), axis=1)
        return by_y, np.pad(by_p, ((0, 0), (0, 1), (0, 1)))

    ends = np.eye(4), -np.eye(4), np.zeros((4, 7))
    return BoundaryValueProblem(
        states=axisymmetric.STATES,
        parameters=(*axisymmetric.PARAMETERS, "drag"),
        rhs=rhs,
        rhs_jacobian=rhs_jacobian,
        boundary=lambda ya, yb, p: ya - yb,
        boundary_jacobian=lambda ya, yb, p: ends,
        integrand=integrand,
        integrand_jacobian=integrand_jacobian,
    )


@dataclass(frozen=True)
class PearlProblem:
    """Pearls on a mesh, as ``continuation`` takes them: ``residual(u) = 0`` is a curve.

    Attributes:
        discretization: collocation of the half cell or the full cell.
        half: which of the two.
        tolerance: estimated error of the profile at which ``remesh`` acts.
    """

    discretization: Discretization
    half: bool
    tolerance: float

    def residual(self, u: Array) -> Array:
        """Defects, boundary conditions and constraints at ``u``."""
        return self.discretization.residual(u)

    def solve(self, u: Array, rhs: Array, row: Array | None = None) -> Array:
        """Bordered solve of the residual's Jacobian at ``u``; see ``Discretization.solve``."""
        return self.discretization.solve(u, rhs, row)

    def inner(self, u: Array, v: Array) -> float:
        """Inner product that does not depend on the mesh."""
        return self.discretization.inner(u, v)

    def observables(self, u: Array) -> dict[str, float]:
        """``lambda1, lambda2, v, E, amplitude, r_min, r_max``; ``E`` is the energy by area."""
        p = self.discretization.all_parameters(u)
        y = self.discretization.at_gauss_points(u)
        radii = self.discretization.values(u)[:, 0]
        return {
            "lambda1": float(p[1]),
            "lambda2": float(p[2]),
            "v": float(p[5]),
            "E": float(self.discretization.gauss_weights @ axisymmetric.energy_density(y, p)),
            "amplitude": float(radii.max() - radii.min()) / 2,
            "r_min": float(radii.min()),
            "r_max": float(radii.max()),
        }

    def remesh(self, u: Array, *others: Array) -> tuple[PearlProblem, list[Array]] | None:
        """The problem on a mesh fitted to ``u``, with all unknowns moved there; None if the present mesh will do."""
        polynomial = self.discretization.polynomial(u)
        error = float(error_estimate(polynomial).max())
        if error <= self.tolerance:
            return None
        intervals = max(intervals_for(polynomial, self.tolerance / 10), len(self.discretization.h))
        intervals = min(intervals, 2 * len(self.discretization.h) + 4)
        mesh = equidistribute(polynomial, intervals)
        discretization, moved = self.discretization.on_mesh(mesh, u, *others)
        return replace(self, discretization=discretization), moved

    def adopt(self, other: PearlProblem, u: Array) -> Array:
        """An unknown that lives on another problem's mesh, interpolated onto this one's."""
        if np.array_equal(other.discretization.mesh, self.discretization.mesh):
            return u
        _, (moved,) = other.discretization.on_mesh(self.discretization.mesh, u)
        return moved

    def profile(self, u: Array) -> Profile:
        """The shape, for ``stability`` and pictures."""
        p = self.discretization.all_parameters(u)
        return Profile(
            states=self.discretization.polynomial(u),
            arclength=float(p[0]),
            half=self.half,
            c0=float(p[3]),
            lambda1=float(p[1]),
            lambda2=float(p[2]),
            period=float(p[4]) * (2 if self.half else 1),
        )

    def axial_force_spread(self, u: Array) -> float:
        """Largest minus smallest axial force at the mesh points: zero on an exact solution, a free error measure."""
        values = self.discretization.values(u)[:: self.discretization.scheme.m]
        force = axisymmetric.axial_force(values, self.discretization.all_parameters(u))
        return float(np.ptp(force))


@cache
def _uniform_mesh(intervals: int) -> Array:
    mesh = np.linspace(0.0, 1.0, intervals + 1)
    mesh.flags.writeable = False
    return mesh


def pearling_onset(
    tube: Tube, m: int = 1, *, intervals: int = 8, degree: int = 6, tolerance: float = 1e-9
) -> tuple[PearlProblem, Array, Array]:
    """The straight cylinder where pearls of period ``L/m`` branch off, and the direction in which they do.

    Args:
        tube: the straight tube.
        m: number of pearls on it; the problem is that of one of them.
        intervals: of the first mesh on the half cell.
        degree: Gauss points an interval.
        tolerance: of the profile, for remeshing.

    Returns:
        The half-cell problem, the unknown at onset and the unit tangent of the pearls, thick at ``sigma = 0``. The
        Jacobian there is singular twice over: pearls and cylinders cross.

    Raises:
        ValueError: the period is ``2 pi`` exactly, where pearls branch off nowhere (``k = 1``).
    """
    k = tube.wave_number(m)
    onset = float(critical_lambda2(k, 0, tube.c0))
    if math.isnan(onset):
        raise ValueError("period: pearls of period 2 pi (k = 1) branch off nowhere; take a longer or shorter period")
    half = tube.length / m / 2
    parameters = np.array([half, cylinder_lambda1(onset, tube.c0), onset, tube.c0, half, 1.0])
    free = ("arclength", "lambda1", "lambda2", "v")
    discretization = Discretization(HALF_CELL, gauss_scheme(degree), _uniform_mesh(intervals), parameters, free)
    x = half * all_points(discretization.mesh, discretization.scheme)
    one = np.ones_like(x)
    u = discretization.pack(np.column_stack((one, 0 * one, one / 2, 0 * one)), parameters)
    # delta r = cos kx, psi = delta r', delta h = (k^2 - 1)/2 cos kx (errata: remark rerem1), w = delta h'
    bend = (k**2 - 1) / 2
    wave = np.column_stack((np.cos(k * x), -k * np.sin(k * x), bend * np.cos(k * x), -bend * k * np.sin(k * x)))
    tangent = discretization.pack(wave, np.zeros_like(parameters))
    tangent /= math.sqrt(discretization.inner(tangent, tangent))
    return PearlProblem(discretization, True, tolerance), u, tangent


def full_cell_problem(problem: PearlProblem, u: Array) -> tuple[PearlProblem, Array]:
    """The full-cell problem around a solution of the half cell, and that solution mirrored into it."""
    profile = problem.profile(u).mirrored()
    p = problem.discretization.all_parameters(u)
    parameters = np.array([2 * p[0], p[1], p[2], p[3], 2 * p[4], p[5], 0.0])
    states = profile.states

    def slope(t: Array) -> Array:
        return np.asarray(axisymmetric.rhs(t, states(t), parameters))

    discretization = Discretization(
        full_cell(slope), states.scheme, states.mesh, parameters, ("arclength", "lambda1", "lambda2", "v", "drag")
    )
    return PearlProblem(discretization, False, problem.tolerance), discretization.pack(states.values, parameters)
