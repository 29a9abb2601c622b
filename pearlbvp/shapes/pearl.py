"""Pearls and all other axisymmetric equilibria of fixed period and area, as ``continuation`` takes them.

One class for half cells and full cells (``shapes.cells``) and for both charts of the multipliers (``shapes.axisymmetric``,
``shapes.large_multipliers``): it changes mesh and chart as the solution asks for it, knows the stability of its solutions, and
embeds them in the larger spaces in which branches that break a symmetry live (``docs/theory/symmetry_and_blocks.md``).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation import Collocated, Discretization, PiecewisePolynomial, gauss_scheme
from pearlbvp.collocation.mesh import equidistribute, error_estimate, intervals_for
from pearlbvp.collocation.polynomial import extremes
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.errors import SpectrumError
from pearlbvp.held import AREA_AND_VOLUME, Held, known_held
from pearlbvp.membrane import Grid, MembraneProblem, Surface
from pearlbvp.membrane import repeated as repeated_surface
from pearlbvp.representation import brief
from pearlbvp.shapes import axisymmetric, large_multipliers
from pearlbvp.shapes.cells import HALF_CELL, HALF_CELL_LARGE, full_cell, mirrored, repeated_cells
from pearlbvp.stability.bloch import SecondVariation
from pearlbvp.stability.profile import Profile
from pearlbvp.stability.spectrum import Block, block_rates, spectrum
from pearlbvp.units import Sentence

if TYPE_CHECKING:
    from pearlbvp.tube.problem import TubeProblem

ENTER_LARGE, LEAVE_LARGE = 12.0, 6.0
"""``|lambda1|`` above which a half cell changes to the chart of large multipliers, and below which it changes back.

Of short pearls times the square of their wave number, which is the size of their multipliers."""

THINNEST_NECK = 4e-3
"""Radius of the neck at which a branch of pearls ends: beyond, rounding spoils the count of unstable waves."""

RESOLVED = 1e-4
"""Error of growth rates, by the fourth power of the wave number, beyond which a branch ends rather than count wrongly."""


@dataclass(frozen=True)
class PearlProblem(Collocated, MembraneProblem):
    """Pearls on a mesh, as ``continuation`` takes them: ``residual(u) = 0`` is a curve.

    Attributes:
        discretization: collocation of the half cell or the full cell.
        tolerance: estimated error of the profile at which ``remesh`` acts.
        reference: what the phase of a full cell is fixed against; None for a half cell.
        cells: periods on the tube, for stability.
        held: what is held while stability is judged.
        wave_number: of the pearls at their onset, by that of short waves, 1 for longer ones: by its powers their curvatures
            and multipliers are measured along branches.
    """

    __repr__ = brief

    stored_as: ClassVar[str] = "pearl"
    family = "pearl"
    block: ClassVar[Any] = Block
    may_vary: ClassVar[Mapping[str, str]] = {"c0": "c0", "L": "length"}
    drawn = "outline"
    rejoins = True
    centred = True

    discretization: Discretization
    reference: PiecewisePolynomial | None
    tolerance: float
    cells: int = 1
    held: Held = AREA_AND_VOLUME
    wave_number: float = 1.0

    @property
    def half(self) -> bool:
        """Whether it is the half cell."""
        return self.reference is None

    @property
    def repeats(self) -> tuple[int, int]:
        """Periods on the tube, and no folds."""
        return self.cells, 0

    @property
    def in_large_chart(self) -> bool:
        """Whether the unknown is that of the chart of large multipliers (``shapes.large_multipliers``)."""
        return self.discretization.problem is HALF_CELL_LARGE

    def multipliers(self, values: Array, parameters: Array) -> tuple[Array, Array]:
        """States ``r, psi, h, w`` and parameters with ``lambda1, lambda2``, whatever the chart."""
        return large_multipliers.to_multipliers(values, parameters) if self.in_large_chart else (values, parameters)

    def change_chart(self, large: bool, u: Array, *tangents: Array) -> tuple[Self, list[Array]]:
        """A half-cell solution, and tangents of it, in the one chart or the other."""
        if large == self.in_large_chart:
            return self, [u, *tangents]
        d = self.discretization
        convert = large_multipliers.from_multipliers if large else large_multipliers.to_multipliers
        names = {"lambda1": "compliance", "lambda2": "mean"}
        if not large:
            names = {new: old for old, new in names.items()}
        free = tuple(names.get(name, name) for name in d.free)
        problem = HALF_CELL_LARGE if large else HALF_CELL
        _, parameters = convert(d.values(u), d.all_parameters(u))
        weights = large_multipliers.weights_of(self.wave_number, large)
        other = replace(d, problem=problem, parameters=parameters, free=free, weights=weights)

        def moved(vector: Array) -> Array:
            return other.pack(*convert(d.values(vector), d.all_parameters(vector)))

        eps = 1e-6
        turned = [(moved(u + eps * tangent) - moved(u - eps * tangent)) / (2 * eps) for tangent in tangents]
        return replace(self, discretization=other), [moved(u), *turned]

    def poles(self, u: Array) -> dict[str, float]:
        """Functions at whose zeros growth rates pass through infinity: ``cmc``, constant mean curvature."""
        return {"cmc": float(self.discretization.all_parameters(u)[1])} if self.in_large_chart else {}

    def observables(self, u: Array) -> dict[str, float]:
        """``lambda1, lambda2, v, E, amplitude, r_min, r_max, c0, L, M, force``; ``E`` is by area, ``L`` the whole tube's."""
        d = self.discretization
        y, p = self.multipliers(d.at_gauss_points(u), d.all_parameters(u))
        narrowest, widest = extremes(d.polynomial(u), 0)
        length = float(p[4]) * self.cells * (2 if self.half else 1)
        observed = {
            "lambda1": float(p[1]),
            "lambda2": float(p[2]),
            "v": float(p[5]),
            "E": float(d.gauss_weights @ axisymmetric.energy_density(y, p)),
            "amplitude": (widest - narrowest) / 2,
            "r_min": narrowest,
            "r_max": widest,
            "c0": float(p[3]),
            "L": length,
            "M": 2 * math.pi * length * float(d.gauss_weights @ axisymmetric.curvature_density(y, p)),
        }
        return self.completed(observed)

    def remesh(self, u: Array, *others: Array) -> tuple[Self, list[Array]] | None:
        """The problem on a mesh fitted to ``u`` and in the chart that suits it, with tangents moved there.

        None if mesh and chart will do.
        """
        d = self.discretization
        chart_parameter = abs(d.all_parameters(u)[1]) * self.wave_number ** (2 if self.in_large_chart else -2)
        size = 1 / max(chart_parameter, 1e-300) if self.in_large_chart else chart_parameter
        if self.half and (size > ENTER_LARGE if not self.in_large_chart else size < LEAVE_LARGE):
            changed, moved = self.change_chart(not self.in_large_chart, u, *others)
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

    def transfer(self, other: PearlProblem, u: Array) -> Array:
        """An unknown that lives on another problem's mesh and chart, moved onto this one's."""
        other, (u,) = other.change_chart(self.in_large_chart, u)
        if np.array_equal(other.discretization.mesh, self.discretization.mesh):
            return u
        _, (moved,) = other.discretization.on_mesh(self.discretization.mesh, u)
        return moved

    def profile(self, u: Array) -> Profile:
        """The shape, for ``stability`` and pictures."""
        d = self.discretization
        values, p = self.multipliers(d.values(u), d.all_parameters(u))
        arclength, lambda1, lambda2, c0, length = map(float, p[:5])
        states, period = PiecewisePolynomial(d.mesh, values), length * (2 if self.half else 1)
        return Profile(states, arclength, self.half, c0, lambda1, lambda2, period)

    def clearance(self, u: Array) -> float:
        """Of the outline from itself and the next periods."""
        return self.profile(u).clearance()

    @property
    def trivial_block(self) -> Block:
        """Perturbations that keep the period, the axis of rotation and the planes of reflection."""
        return Block(0, 0, self.cells, "even" if self.half else None)

    @property
    def free(self) -> tuple[str, ...]:
        """Names of the parameters that end every unknown."""
        return self.discretization.free

    @property
    def varied(self) -> tuple[str, ...]:
        """All but the arclength, and the drag of a full cell, which are unknowns on every branch."""
        return tuple(name for name in self.free if name not in ("arclength", "drag"))

    @property
    def varying(self) -> tuple[str, ...]:
        """What varies on the branch of what perturbations may keep."""
        # The chart of large multipliers has lambda2 by way of the mean curvature.
        names = {"mean": "lambda2", "length": "L"}
        return tuple(names.get(name, name) for name in self.free)

    def spectrum(self, u: Array) -> Spectrum:
        """Growth rates of all perturbations that fit the tube."""
        return spectrum(self.profile(u), self.cells, held=self.held)

    def block_rates(self, u: Array, block: Block, like: Spectrum) -> Array:
        """Growth rates in one symmetry block, largest first, without its exact kernel, on as many points as ``like``."""
        return block_rates(SecondVariation.of(self.profile(u), like.points), block, self.held)[0]

    def largest_wave(self, u: Array) -> float:
        """``2 A`` of the largest wave (``projection``): of equal pearls the first, of a localized one what it is made of."""
        profile = self.profile(u)
        waves = max(16, math.ceil(3 * profile.period / (2 * math.pi)))
        return profile.projection().wave(2 * math.pi / profile.period, (waves, 0))

    def signed_amplitude(self, u: Array) -> float:
        """Difference of the radii at the two ends of the first half period: it changes sign where pearls become straight."""
        radii = self.discretization.values(u)[:, 0]
        return float(radii[0] - radii[-1 if self.half else len(radii) // 2])

    def plain(self, *vectors: Array) -> tuple[Self, list[Array]]:
        """In the chart of the multipliers themselves."""
        return self.change_chart(False, *vectors)

    def freeing(self, u: Array, *free: str) -> tuple[Self, Array]:
        """The same solution with other parameters free: to vary ``c0`` at fixed ``v``, say.

        Args:
            u: a solution.
            free: names of the parameters, in the order in which they are to end the unknown, besides those that are
                unknowns on every branch: three leave a curve of solutions, four a surface.
        """
        problem, (u,) = self.plain(u)
        d = problem.discretization
        names = ("arclength", *free, *(("drag",) if self.reference is not None else ()))
        discretization = replace(d, parameters=d.all_parameters(u), free=names)
        return replace(problem, discretization=discretization), discretization.pack(d.values(u), d.all_parameters(u))

    def limit(self, observed: Mapping[str, float], spectrum: Spectrum) -> str | None:
        """Too many waves around, a spectrum that is not resolved, or a neck that is too thin for one."""
        if not spectrum.complete:
            n = max((block.n for block in spectrum.rates), default=0)
            text = f"waves of more than n = {n} around the tube grow: its tension is {{lambda1:.3g}}; "
            text += "stop before, or take fewer pearls"
            raise SpectrumError(Sentence(text, lambda1=observed["lambda1"]))
        if spectrum.residual > RESOLVED * self.wave_number**4:
            text = "its spectrum is known to {rate:.0e} only, at a neck of {r_min:.1e}; stop before, at an r_min say"
            raise SpectrumError(Sentence(text, rate=spectrum.residual, r_min=observed["r_min"]))
        if observed["r_min"] < THINNEST_NECK:
            return f"the neck is thinner than {THINNEST_NECK:g} radii: the surface is about to touch its axis"
        return None

    def lift(self, block: Block, centre: str, *vectors: Array) -> tuple[PearlProblem | TubeProblem, list[Array]]:
        """The problem in whose space the perturbations of a block live, and vectors moved into it.

        Args:
            block: of this problem's; where it breaks the symmetry about the axis, the space is one of reduced modes.
            centre: what the new plane of reflection passes through, where the block leaves the choice.
            vectors: solutions or tangents of this problem; a solution and its tangent for reduced modes.

        Raises:
            LiftError: the profile is no graph over its axis, as reduced modes need it.
        """
        if block.n != 0:
            from pearlbvp.tube.symmetry import ODD_X

            tube, *moved = self.in_modes(*vectors)
            odd = ODD_X if block.parity == "odd" else 0
            return tube.lift(tube.symmetry.block(block.j, block.n, odd), centre, *moved)
        if block == self.trivial_block:
            return self, list(vectors)
        if block.j == 0:
            return self.whole_cell(*vectors)
        if block.parity is not None:  # a wave that changes sign from cell to cell is even about either pearl or neck
            centre = "pearl" if block.parity == "even" else "neck"
        return self.repeated(block.cells // math.gcd(block.j, block.cells), centre, *vectors)

    def in_modes(self, u: Array, tangent: Array) -> tuple[TubeProblem, Array, Array]:
        """Pearls in reduced modes; see ``shapes.pearl_modes``."""
        from pearlbvp.shapes.pearl_modes import pearls_in_modes  # with the rooms of tubes, which few branches lead to

        pearls, (u, tangent) = self.plain(u, tangent)

        def along(step: float) -> tuple[Profile, float]:
            moved = u + step * tangent
            return pearls.profile(moved), float(pearls.discretization.all_parameters(moved)[5])

        return pearls_in_modes(along, self.cells, pearls.free, self.held)

    def whole_cell(self, *vectors: Array) -> tuple[PearlProblem, list[Array]]:
        """The full-cell problem around a solution, the first of some vectors, which is the reference of its phase."""
        plain, moved = self.plain(*vectors)
        discretization, reference, moved = mirrored(plain.discretization, *moved)
        return replace(plain, discretization=discretization, reference=reference), moved

    def repeated(self, cells: int, centre: str, *vectors: Array) -> tuple[PearlProblem, list[Array]]:
        """Several cells as one: in this larger space periods may differ from each other.

        Where pearls lose stability to a Bloch wave, the branch of the localized pearl leaves in it, centred on a pearl or on a
        neck.

        Args:
            cells: how many periods become one; it divides ``self.cells``.
            centre: what stands at the first plane of reflection.
            vectors: solutions or tangents.

        Raises:
            ValueError: the tube does not hold a multiple of that many cells, or the problem is not that of a half cell.
        """
        if self.cells % cells or not self.half:
            raise ValueError(
                f"cells: {cells} periods do not divide a tube of {self.cells}, or have no planes of reflection"
            )
        discretization, moved = repeated_cells(self.discretization, cells, centre == "neck", *vectors)
        return replace(self, discretization=discretization, cells=self.cells // cells), moved

    def to_draw(self, u: Array) -> Grid:
        """The surface of all periods."""
        profile, length = self.profile(u), self.observables(u)["L"]
        return repeated_surface(profile.surface(), profile.period, max(1, round(length / profile.period)))

    def parametrized(self, u: Array) -> Surface:
        """Points of the surface by arclength and angle."""
        return self.profile(u).parametrized()

    def curve(self, u: Array, samples: int) -> dict[str, Array]:
        """The profile of the whole tube: ``x, r, psi`` (the tangent's angle), ``H`` (mean curvature)."""
        profile = self.profile(u)
        return profile.curve(round(self.observables(u)["L"] / profile.period), samples)

    def is_upper_half(self, direction: Array) -> bool:
        """Whether a perturbation makes the tube thicker at the first plane of reflection."""
        return bool(self.discretization.values(direction)[0, 0] > 0)

    def to_tree(self) -> dict[str, Any]:
        """Everything as arrays, numbers and words, to be saved."""
        d = self.discretization
        tree: dict[str, Any] = {
            "mesh": d.mesh, "degree": d.scheme.m, "parameters": d.parameters, "free": ",".join(d.free),
            "tolerance": self.tolerance, "cells": self.cells, "held": str(self.held), "in_large_chart": self.in_large_chart,
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
        problem = HALF_CELL_LARGE if tree["in_large_chart"] else HALF_CELL
        if reference is not None:
            problem = full_cell(reference)
        scheme, free = gauss_scheme(int(tree["degree"])), tuple(tree["free"].split(","))
        wave_number = float(tree["wave_number"])
        weights = large_multipliers.weights_of(wave_number, bool(tree["in_large_chart"]))
        discretization = Discretization(problem, scheme, tree["mesh"], tree["parameters"], free, weights)
        tolerance, cells, held = float(tree["tolerance"]), int(tree["cells"]), known_held(tree["held"])
        return cls(discretization, reference, tolerance, cells, held, wave_number)

    def axial_force_spread(self, u: Array) -> float:
        """Largest minus smallest axial force at the mesh points: zero on an exact solution, a free error measure."""
        d = self.discretization
        force = axisymmetric.axial_force(*self.multipliers(d.values(u)[:: d.scheme.m], d.all_parameters(u)))
        return float(np.ptp(force))
