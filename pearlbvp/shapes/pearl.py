"""Pearls and all other axisymmetric equilibria of fixed period and area, as ``continuation`` takes them.

One class for half cells and full cells (``shapes.cells``) and for both charts of the multipliers (``shapes.axisymmetric``,
``shapes.tension``): it changes mesh and chart as the solution asks for it, knows the stability of its solutions, and embeds
them in the larger spaces in which branches that break a symmetry live (design, §6).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, ClassVar, Literal, get_args

import numpy as np

from pearlbvp.collocation import (
    Discretization,
    PiecewisePolynomial,
    equidistribute,
    error_estimate,
    gauss_scheme,
    intervals_for,
)
from pearlbvp.collocation.polynomial import all_points, extremes
from pearlbvp.collocation.scheme import Array
from pearlbvp.helfrich import SHORT_WAVE, Tube, cylinder_lambda1
from pearlbvp.representation import brief
from pearlbvp.shapes import axisymmetric, tension
from pearlbvp.shapes.cells import HALF_CELL, HALF_CELL_TENSION, full_cell
from pearlbvp.stability.bloch import Fixed, SecondVariation
from pearlbvp.stability.profile import Profile
from pearlbvp.stability.spectrum import Block, Spectrum, block_rates, spectrum
from pearlbvp.theory.dispersion import critical_lambda2

Centre = Literal["pearl", "neck"]

LARGE_TENSION, SMALL_TENSION = 12.0, 6.0
"""``|lambda1|`` above which a half cell changes to the chart of large multipliers, and below which it changes back.

Of short pearls times the square of their wave number, which is the size of their multipliers."""


@dataclass(frozen=True)
class PearlProblem:
    """Pearls on a mesh, as ``continuation`` takes them: ``residual(u) = 0`` is a curve.

    Attributes:
        discretization: collocation of the half cell or the full cell.
        tolerance: estimated error of the profile at which ``remesh`` acts.
        reference: what the phase of a full cell is fixed against; None for a half cell.
        cells: periods on the tube, for stability.
        fixed: what perturbations keep, for stability.
        wave_number: of the pearls at their onset, by that of short waves, 1 for longer ones: by its powers their curvatures
            and multipliers are measured along branches.
    """

    __repr__ = brief

    stored_as: ClassVar[str] = "pearl"
    family: ClassVar[str] = "pearl"

    discretization: Discretization
    reference: PiecewisePolynomial | None
    tolerance: float
    cells: int = 1
    fixed: Fixed = "area and volume"
    wave_number: float = 1.0

    @property
    def half(self) -> bool:
        """Whether it is the half cell."""
        return self.reference is None

    @property
    def large_tension(self) -> bool:
        """Whether the unknown is that of the chart of large multipliers (``shapes.tension``)."""
        return self.discretization.problem is HALF_CELL_TENSION

    def multipliers(self, values: Array, parameters: Array) -> tuple[Array, Array]:
        """States ``r, psi, h, w`` and parameters with ``lambda1, lambda2``, whatever the chart."""
        return tension.to_multipliers(values, parameters) if self.large_tension else (values, parameters)

    def change_chart(self, large: bool, u: Array, *tangents: Array) -> tuple[PearlProblem, list[Array]]:
        """A half-cell solution, and tangents of it, in the one chart or the other."""
        if large == self.large_tension:
            return self, [u, *tangents]
        d = self.discretization
        convert = tension.from_multipliers if large else tension.to_multipliers
        names = {"lambda1": "compliance", "lambda2": "mean"}
        if not large:
            names = {new: old for old, new in names.items()}
        free = tuple(names.get(name, name) for name in d.free)
        problem = HALF_CELL_TENSION if large else HALF_CELL
        _, parameters = convert(d.values(u), d.all_parameters(u))
        weights = _weights(self.wave_number, large)
        other = replace(d, problem=problem, parameters=parameters, free=free, weights=weights)

        def moved(vector: Array) -> Array:
            return other.pack(*convert(d.values(vector), d.all_parameters(vector)))

        eps = 1e-6
        turned = [(moved(u + eps * tangent) - moved(u - eps * tangent)) / (2 * eps) for tangent in tangents]
        return replace(self, discretization=other), [moved(u), *turned]

    def poles(self, u: Array) -> dict[str, float]:
        """Functions at whose zeros growth rates pass through infinity: ``cmc``, constant mean curvature."""
        return {"cmc": float(self.discretization.all_parameters(u)[1])} if self.large_tension else {}

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
        """``lambda1, lambda2, v, E, amplitude, r_min, r_max, c0, L``; ``E`` is by area, ``L`` the whole tube's."""
        d = self.discretization
        y, p = self.multipliers(d.at_gauss_points(u), d.all_parameters(u))
        narrowest, widest = extremes(d.polynomial(u), 0)
        return {
            "lambda1": float(p[1]),
            "lambda2": float(p[2]),
            "v": float(p[5]),
            "E": float(d.gauss_weights @ axisymmetric.energy_density(y, p)),
            "amplitude": (widest - narrowest) / 2,
            "r_min": narrowest,
            "r_max": widest,
            "c0": float(p[3]),
            "L": float(p[4]) * self.cells * (2 if self.half else 1),
        }

    def remesh(self, u: Array, *others: Array) -> tuple[PearlProblem, list[Array]] | None:
        """The problem on a mesh fitted to ``u`` and in the chart that suits it, with tangents moved there.

        None if mesh and chart will do.
        """
        d = self.discretization
        chart_parameter = abs(d.all_parameters(u)[1]) * self.wave_number ** (2 if self.large_tension else -2)
        size = 1 / max(chart_parameter, 1e-300) if self.large_tension else chart_parameter
        if self.half and (size > LARGE_TENSION if not self.large_tension else size < SMALL_TENSION):
            changed, moved = self.change_chart(not self.large_tension, u, *others)
            return changed.remesh(*moved) or (changed, moved)
        polynomial = d.polynomial(u)
        error = float(error_estimate(polynomial).max())
        if error <= self.tolerance:
            return None
        intervals = max(intervals_for(polynomial, self.tolerance / 10), len(d.h))
        intervals = min(intervals, 2 * len(d.h) + 4)
        mesh = equidistribute(polynomial, intervals)
        discretization, moved = d.on_mesh(mesh, u, *others)
        return replace(self, discretization=discretization), moved

    def adopt(self, other: PearlProblem, u: Array) -> Array:
        """An unknown that lives on another problem's mesh and chart, moved onto this one's."""
        other, (u,) = other.change_chart(self.large_tension, u)
        if np.array_equal(other.discretization.mesh, self.discretization.mesh):
            return u
        _, (moved,) = other.discretization.on_mesh(self.discretization.mesh, u)
        return moved

    def profile(self, u: Array) -> Profile:
        """The shape, for ``stability`` and pictures."""
        d = self.discretization
        values, p = self.multipliers(d.values(u), d.all_parameters(u))
        return Profile(
            states=PiecewisePolynomial(d.mesh, values),
            arclength=float(p[0]),
            half=self.half,
            c0=float(p[3]),
            lambda1=float(p[1]),
            lambda2=float(p[2]),
            period=float(p[4]) * (2 if self.half else 1),
        )

    @property
    def own_block(self) -> Block:
        """Perturbations that keep the period, the axis of rotation and the planes of reflection."""
        return Block(0, 0, self.cells, "even" if self.half else None)

    @property
    def conserved(self) -> str:
        """Of what perturbations keep (``v``, or ``lambda2`` at given pressure, and ``c0``, ``L``), what varies here."""
        free = self.discretization.free
        kept = {"v": "v"} if self.fixed == "area and volume" else {"lambda2": "lambda2", "mean": "lambda2"}
        varying = [name for parameter, name in (kept | {"c0": "c0", "length": "L"}).items() if parameter in free]
        return varying[0] if len(varying) == 1 else ""

    @property
    def constant(self) -> tuple[str, ...]:
        """Of ``lambda1, lambda2, v, c0, L`` those that do not vary along the branch."""
        names = {"compliance": "lambda1", "mean": "lambda2", "length": "L"}
        varying = {names.get(parameter, parameter) for parameter in self.discretization.free}
        return tuple(name for name in ("lambda1", "lambda2", "v", "c0", "L") if name not in varying)

    def spectrum(self, u: Array) -> Spectrum:
        """Growth rates of all perturbations that fit the tube."""
        return spectrum(self.profile(u), self.cells, fixed=self.fixed)

    def block_rates(self, u: Array, block: Block, like: Spectrum) -> Array:
        """Growth rates in one symmetry block, largest first, without its exact kernel, on as many points as ``like``."""
        return block_rates(SecondVariation.of(self.profile(u), like.points), block, self.fixed)[0]

    def place(self, name: str) -> int:
        """Place of a free parameter in every unknown, counted from its end."""
        free = self.discretization.free
        return free.index(name) - len(free)

    def wave(self, u: Array) -> float:
        """``2 A`` of the largest wave (``projection``): of equal pearls the first, of a localized one what it is made of."""
        profile = self.profile(u)
        waves = max(16, math.ceil(3 * profile.period / (2 * math.pi)))
        return profile.projection().wave(2 * math.pi / profile.period, (waves, 0))

    def straightness(self, u: Array) -> float:
        """Difference of the radii at the two ends of the first half period: it changes sign where pearls become straight."""
        radii = self.discretization.values(u)[:, 0]
        return float(radii[0] - radii[-1 if self.half else len(radii) // 2])

    def released(self, u: Array, *free: str) -> tuple[PearlProblem, Array]:
        """The same solution with other parameters free: to vary ``c0`` at fixed ``v``, say.

        Args:
            u: a solution.
            free: names of the parameters, in the order in which they are to end the unknown, besides the arclength and the
                drag of a full cell: three leave a curve of solutions, four a surface.

        Raises:
            ValueError: a name that is no parameter.
        """
        if self.large_tension:
            plain, (u,) = self.change_chart(False, u)
            return plain.released(u, *free)
        d = self.discretization
        names = ("arclength", *free, *(("drag",) if self.reference is not None else ()))
        discretization = replace(d, parameters=d.all_parameters(u), free=names)
        return replace(self, discretization=discretization), discretization.pack(d.values(u), d.all_parameters(u))

    def with_second(self, name: str, u: Array, tangent: Array) -> tuple[PearlProblem, list[Array], int]:
        """The problem with ``c0`` or ``length`` free besides, vectors moved there, and that parameter's place in them.

        Raises:
            ValueError: another name.
        """
        if name not in ("c0", "length"):
            raise ValueError(f"second: {name!r} is not c0 or length")
        plain, (u, tangent) = self.change_chart(False, u, tangent)
        free = plain.discretization.free
        problem, moved = plain.released(u, *(p for p in free if p not in ("arclength", "drag")), name)
        place = moved.size + problem.place(name)
        return problem, [moved, np.insert(tangent, place, 0.0)], place

    def embed(self, block: Block, centre: Centre, *vectors: Array) -> tuple[PearlProblem, list[Array]]:
        """The problem in whose space the perturbations of a block live, and vectors moved into it.

        Args:
            block: an axisymmetric block of this problem.
            centre: what the new plane of reflection passes through, where the block leaves the choice.
            vectors: solutions or tangents of this problem.

        Raises:
            ValueError: the block's perturbations are not axisymmetric.
        """
        if block.n != 0:
            raise ValueError(f"block: perturbations with n = {block.n} are not axisymmetric; pearls cannot follow them")
        if block == self.own_block:
            return self, list(vectors)
        if block.j == 0:
            plain, moved = self.change_chart(False, *vectors)
            return full_cell_problem(plain, *moved)
        if block.parity is not None:  # a wave that changes sign from cell to cell is even about either pearl or neck
            centre = "pearl" if block.parity == "even" else "neck"
        return unrolled(self, block.cells // math.gcd(block.j, block.cells), centre, *vectors)

    def grows_at_centre(self, direction: Array) -> bool:
        """Whether a perturbation makes the tube thicker at the first plane of reflection."""
        return bool(self.discretization.values(direction)[0, 0] > 0)

    def to_tree(self) -> dict[str, Any]:
        """Everything as arrays, numbers and words, to be saved."""
        d = self.discretization
        tree: dict[str, Any] = {
            "mesh": d.mesh, "degree": d.scheme.m, "parameters": d.parameters, "free": ",".join(d.free),
            "tolerance": self.tolerance, "cells": self.cells, "fixed": self.fixed, "large_tension": self.large_tension,
            "wave_number": self.wave_number,
        }  # fmt: skip
        if self.reference is not None:
            tree |= {"reference_mesh": self.reference.mesh, "reference_values": self.reference.values}
        return tree

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> PearlProblem:
        """The inverse of ``to_tree``.

        Raises:
            ValueError: the tree describes no pearl problem.
        """
        reference = None
        if "reference_mesh" in tree:
            reference = PiecewisePolynomial(tree["reference_mesh"], tree["reference_values"])
        if tree["fixed"] not in get_args(Fixed):
            raise ValueError(f"fixed: {tree['fixed']!r} is none of {get_args(Fixed)}")
        problem = HALF_CELL_TENSION if tree["large_tension"] else HALF_CELL
        if reference is not None:
            problem = full_cell(reference)
        scheme, free = gauss_scheme(int(tree["degree"])), tuple(tree["free"].split(","))
        wave_number = float(tree["wave_number"])
        weights = _weights(wave_number, bool(tree["large_tension"]))
        discretization = Discretization(problem, scheme, tree["mesh"], tree["parameters"], free, weights)
        return cls(discretization, reference, float(tree["tolerance"]), int(tree["cells"]), tree["fixed"], wave_number)

    def axial_force_spread(self, u: Array) -> float:
        """Largest minus smallest axial force at the mesh points: zero on an exact solution, a free error measure."""
        d = self.discretization
        force = axisymmetric.axial_force(*self.multipliers(d.values(u)[:: d.scheme.m], d.all_parameters(u)))
        return float(np.ptp(force))


def _weights(wave_number: float, large_tension: bool) -> Array | None:
    """Weights of states and parameters, of a full cell's too, in the inner product; None where all are 1.

    With ``k`` the wave number, ``h`` is of size ``k`` on short pearls, ``w`` and both multipliers are of size ``k^2``; slopes
    and volumes are of size 1.
    """
    if wave_number == 1:
        return None
    states = (0, 0, -3, -4) if large_tension else (0, 0, -1, -2)
    parameters = (0, 2, 0, -1, 0, 0, 0) if large_tension else (0, -2, -2, -1, 0, 0, 0)
    return np.asarray(wave_number ** (2.0 * np.array(states + parameters)))


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
    short = max(k / SHORT_WAVE, 1.0)
    weights = _weights(short, False)
    discretization = Discretization(
        HALF_CELL, gauss_scheme(degree), _uniform_mesh(intervals), parameters, free, weights
    )
    x = half * all_points(discretization.mesh, discretization.scheme)
    one = np.ones_like(x)
    u = discretization.pack(np.column_stack((one, 0 * one, one / 2, 0 * one)), parameters)
    # delta r = cos kx, psi = delta r', delta h = (k^2 - 1)/2 cos kx (errata: remark rerem1), w = delta h'
    bend = (k**2 - 1) / 2
    wave = np.column_stack((np.cos(k * x), -k * np.sin(k * x), bend * np.cos(k * x), -bend * k * np.sin(k * x)))
    tangent = discretization.pack(wave, np.zeros_like(parameters))
    tangent /= math.sqrt(discretization.inner(tangent, tangent))
    return PearlProblem(discretization, None, tolerance, cells=m, wave_number=short), u, tangent


_MIRROR = np.array([1.0, -1.0, 1.0, -1.0])
"""What a plane of reflection does to ``r, psi, h, w``."""


def full_cell_problem(problem: PearlProblem, u: Array, *tangents: Array) -> tuple[PearlProblem, list[Array]]:
    """The full-cell problem around a solution of the half cell; that solution and tangents of it mirrored into it.

    Returns:
        The problem, with the solution as reference of its phase, and the vectors in it, ``u`` first.
    """
    half = problem.discretization
    p = half.all_parameters(u)
    mesh = np.append(half.mesh / 2, 1 - half.mesh[-2::-1] / 2)
    parameters = np.append(p * _scale(2), 0.0)

    def mirrored(values: Array) -> Array:
        return np.vstack((values, (values[::-1] * _MIRROR)[1:]))

    states = PiecewisePolynomial(mesh, mirrored(half.values(u)))
    slopes = np.asarray(axisymmetric.rhs(states.points, states.values, parameters))
    reference = PiecewisePolynomial(mesh, slopes)
    whole = Discretization(full_cell(reference), half.scheme, mesh, parameters, (*half.free, "drag"), half.weights)
    moved = []
    for vector in (u, *tangents):
        free = vector[vector.size - len(half.free) :] * _scale(2)[half.free_index]
        moved.append(np.concatenate((mirrored(half.values(vector)).ravel(), free, [0.0])))
    return replace(problem, discretization=whole, reference=reference), moved


def unrolled(problem: PearlProblem, cells: int, centre: Centre, *vectors: Array) -> tuple[PearlProblem, list[Array]]:
    """Half-cell solutions as solutions of period ``cells`` times as long, on the half of that from a plane of reflection.

    In this larger space periods may differ from each other: where pearls lose stability to a Bloch wave, the branch of
    the localized pearl leaves in it, centred on a pearl or on a neck (design, §6).

    Args:
        problem: pearls on the half cell.
        cells: how many periods become one; it divides ``problem.cells``.
        centre: what stands at the first plane of reflection.
        vectors: solutions or tangents.

    Raises:
        ValueError: the tube does not hold a multiple of that many cells, or the problem is not that of a half cell.
    """
    if problem.cells % cells or not problem.half:
        raise ValueError(
            f"cells: {cells} periods do not divide a tube of {problem.cells}, or have no planes of reflection"
        )
    d = problem.discretization
    order = [(i + (centre == "neck")) % 2 for i in range(cells)]  # 0: pearl to neck, 1: neck to pearl
    meshes = [(i + (d.mesh[1:] if way == 0 else 1 - d.mesh[-2::-1])) / cells for i, way in enumerate(order)]
    mesh = np.concatenate((np.zeros(1), *meshes))
    mesh[-1] = 1.0
    discretization = replace(d, mesh=mesh, parameters=d.parameters * _scale(cells))
    moved = []
    for vector in vectors:
        forth = d.values(vector)
        back = forth[::-1] * _MIRROR
        parts = [(forth, back)[way][min(i, 1) :] for i, way in enumerate(order)]
        free = vector[vector.size - len(d.free) :] * _scale(cells)[d.free_index]
        moved.append(np.concatenate((np.vstack(parts).ravel(), free)))
    return replace(problem, discretization=discretization, cells=problem.cells // cells), moved


def _scale(cells: int) -> Array:
    """Factors of the parameters when several cells become one."""
    return np.array([cells if name in ("arclength", "length") else 1.0 for name in axisymmetric.PARAMETERS])
