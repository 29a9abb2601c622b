"""Tubes of any symmetry as sums of modes, as ``continuation`` takes them (``docs/theory/reduced_modes.md``).

Each tube lives in the space of its symmetry (``tube.symmetry``), where its bifurcation is simple. The unknown holds the modes'
coefficients, then those of ``lambda1, lambda2, v, c0, length`` that are free. Equations: the energy's gradient by the
coefficients with both constraints' multipliers, the area, the volume. All are exact derivatives of one trapezoidal sum.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.fft import next_fast_len

from pearlbvp.arrays import Array
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.errors import SpectrumError
from pearlbvp.helfrich import SHORT_WAVE
from pearlbvp.tube.extremes import extremes
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.perturbations import blocks_up_to
from pearlbvp.tube.rigid import rigid_motions
from pearlbvp.tube.shapes import TubeShapes
from pearlbvp.tube.spectrum import BlockProblem, Equilibrium
from pearlbvp.tube.symmetry import TubeBlock
from pearlbvp.tube.waves import Cell, ModeWaves, Waves
from pearlbvp.units import Sentence

MOST_MODES, MOST_MODES_PLANE = 256, 64
"""Largest number of periods or folds in a tube's modes: where it depends on one variable, and each way where on two."""

PLANE_TOLERANCE = 1e-6
"""Of the curvature of the last modes where a tube depends on two variables. Energies and multipliers, stationary values, are
known to 1e-11 there, growth rates to 1e-8: a tenth would take a sixth more modes each way, and spectra twice the time."""


RESOLVED = 1e-6
"""Error of growth rates, by the fourth power of the wave number, beyond which a branch ends rather than count wrongly."""


@dataclass(frozen=True)
class TubeProblem(TubeShapes):
    """Equilibria among tubes of one symmetry on a number of modes: ``residual(u) = 0`` is a curve."""

    @cached_property
    def cell(self) -> Cell:
        """A period of the tube, on points that resolve products of three modes."""
        return self._cell_for(self.size)

    def _cell_for(self, largest: tuple[int, int]) -> Cell:
        """A period of the tube, on points that resolve products of a mode and two waves of the ``largest`` numbers.

        Those are in periods and folds. On fewer points differences of two waves would be taken for longer ones.
        """
        along, around = (
            next_fast_len(max(2 * wave, 2 * most + 4) + most + 4, real=True) if unit else 1
            for wave, most, unit in zip(largest, self.size, self._units, strict=True)
        )
        return Cell(self.symmetry.period, self.symmetry.fold, (along, around))

    def residual(self, u: Array) -> Array:
        """The equations at ``u``, shape (N + 2,)."""
        equilibrium = self.equilibrium(u)
        force, (_, area, volume) = equilibrium.force(self._waves(u)), equilibrium.means
        if self.pinned is not None:
            # The energy does not change along rigid motions, so this is no force: at a solution it vanishes by itself.
            force += self.pinned.T @ (self.pinned @ self.coefficients(u))
        return np.concatenate((force, [area - 1, volume - self.parameters(u).v / 2]))

    def solve(self, u: Array, rhs: Array, row: Array | None = None) -> Array:
        """Bordered solve of the residual's Jacobian at ``u``; see ``Problem.solve``."""
        equilibrium, waves = self.equilibrium(u), self._waves(u)
        second = equilibrium.hessian(waves)
        if self.pinned is not None:
            second = second + self.pinned.T @ self.pinned
        by_area, by_volume = equilibrium.constraints(waves)
        rows = np.zeros((0, u.size)) if row is None else np.atleast_2d(row) * self.weights
        size = len(second)
        matrix = np.zeros((size + 2 + len(rows), u.size))
        matrix[:size, :size] = second
        matrix[size, :size], matrix[size + 1, :size] = by_area, by_volume
        for name, column in zip(self.free, matrix.T[size:], strict=True):
            if name == "lambda1":
                column[:size] = by_area
            elif name == "lambda2":
                column[:size] = by_volume
            elif name == "v":
                column[size + 1] = -0.5
            elif name == "c0":
                column[:size] = equilibrium.by_c0(waves)
            else:
                column[:size], column[size] = equilibrium.by_length(waves, self.parameters(u).length)
        matrix[size + 2 :] = rows
        return np.asarray(np.linalg.solve(matrix, rhs))

    @property
    def wave_number(self) -> float:
        """Of the waves that the symmetry has, by that of short ones; 1 for longer. Multipliers are of its square's size."""
        s = self.symmetry
        return max(1.0, math.hypot((s.period or s.turns) * self.k, math.sqrt(max(s.fold**2 - 1, 0))) / SHORT_WAVE)

    @cached_property
    def weights(self) -> Array:
        """Of the entries of ``u`` in the inner product: mean squares of the modes, 1 for the parameters.

        Waves much shorter than the tube's radius have amplitudes and multipliers of another size, by powers of their number.
        """
        across = self.wave_number**2
        squares = [
            (0.5 if mode.p else 1.0) * (0.5 if mode.b else 1.0) * (across if mode.p or mode.harmonic else 1.0)
            for mode in self.modes
        ]
        powers = {"lambda1": 2, "lambda2": 2, "c0": 1}
        return np.array([*squares, *(across ** -powers.get(name, 0) for name in self.free)])

    def inner(self, u: Array, v: Array) -> float:
        """Inner product that does not depend on the number of modes."""
        return float((u * self.weights) @ v)

    def observables(self, u: Array) -> dict[str, float]:
        """``lambda1, lambda2, v, E, amplitude, r_min, r_max, c0, L, M, force``, and of shapes that turn the ``torque``.

        Radii are measured from the sections' centres.
        """
        lambda1, lambda2, v, c0, length = self.parameters(u)
        waves, coefficients, equilibrium = self._waves(u), self.coefficients(u), self.equilibrium(u)
        thin, thick = extremes(waves, self.cell, coefficients)
        observed = {
            "lambda1": lambda1, "lambda2": lambda2, "v": v, "E": equilibrium.means[0],
            "amplitude": (thick - thin) / 2, "r_min": thin, "r_max": thick, "c0": c0, "L": length,
            "M": 2 * math.pi * length * equilibrium.curvature,
        }  # fmt: skip
        if self.family == "coil":
            observed["torque"] = equilibrium.torque(waves.displacement(self.cell, coefficients))
        return self.completed(observed)

    def tails(self, u: Array) -> tuple[tuple[float, float], tuple[float, float]]:
        """Largest curvatures of the modes halfway out and at the end: of those more along the tube, and more around it.

        Coefficients times ``k^2 + b^2``: what the growth rates, of higher order than the energy, feel of modes left out.
        """
        numbers = np.array([(mode.p, mode.harmonic) for mode in self.modes])
        k = 2 * math.pi / self.parameters(u).length
        curvatures = np.abs(self.coefficients(u)) * ((numbers[:, 0] * k) ** 2 + numbers[:, 1] ** 2)
        numbers[numbers == 1] = 0  # the centre is no wave around the tube
        share = numbers / [max(most * unit, 1) for most, unit in zip(self.size, self._units, strict=True)]
        out, longer = np.hypot(*share.T), share[:, 0] >= share[:, 1]
        halfway, last = (out > 0.4) & (out < 0.6), out > 0.8
        along, around = (
            (float(curvatures[halfway & side].max(initial=0.0)), float(curvatures[last & side].max(initial=0.0)))
            for side in (longer, ~longer)
        )
        return along, around

    def _fitting(self, old: int, halfway: float, last: float) -> int:
        """How many periods or folds bring the last modes below the tolerance, as fast as they fall now."""
        if last <= self.tolerance or old == 0:
            return old
        fall = math.log(max(halfway / last, 1.5)) / 0.4  # from half the wave numbers to nine tenths of them
        wanted = math.ceil(old * min(0.9 + math.log(last / self.tolerance) / fall, 2.0)) + 2
        most = MOST_MODES_PLANE if all(self._units) else MOST_MODES
        return max(old, min(max(wanted, old + 4), most))

    def remesh(self, u: Array, *others: Array) -> tuple[TubeProblem, list[Array]] | None:
        """The problem with more modes, where the last of them are not small; None where they are."""
        along, around = (self._fitting(old, *tail) for old, tail in zip(self.size, self.tails(u), strict=True))
        if (along, around) == self.size:
            return None
        larger = self.resized((along, around))
        return larger, [larger.transfer(self, vector) for vector in (u, *others)]

    def resized(self, size: tuple[int, int]) -> TubeProblem:
        """The same problem on another number of modes."""
        other = replace(self, size=size, pinned=None)
        if self.pinned is None:
            return other
        moved = np.array([other.packed(dict(zip(self.modes, row, strict=True))) for row in self.pinned])
        return replace(other, pinned=moved)

    def lift(self, block: TubeBlock, centre: str, *vectors: Array) -> tuple[TubeProblem, list[Array]]:
        """The problem in whose space the perturbations of a block live, and vectors moved into it.

        Args:
            block: a symmetry block of this problem.
            centre: of no use here: blocks of reduced modes leave no choice.
            vectors: a solution of this problem, then solutions or tangents.
        """
        if block == self.trivial_block:
            return self, list(vectors)
        symmetry = self.symmetry.broken_by(block)
        sizes = []
        for most, old, new in zip(self.size, self._units, (symmetry.period, symmetry.fold), strict=True):
            sizes.append(max(most * old // new, 8) if new else 0)
        tolerance = max(self.tolerance, PLANE_TOLERANCE) if all(sizes) else self.tolerance
        problem = replace(self, symmetry=symmetry, size=(sizes[0], sizes[1]), pinned=None, tolerance=tolerance)
        return problem.pinned_at(self.known(vectors[0])), [problem.transfer(self, vector) for vector in vectors]

    def pinned_at(self, known: Mapping[Mode, float]) -> TubeProblem:
        """The problem with phase conditions against the rigid motions that its modes leave free, at known coefficients."""
        motions = rigid_motions(known, self.modes, self.symmetry.turns)
        rows = [motion * self.coefficients(self.weights) for motion in motions if not self._is_shift(motion)]
        return replace(self, pinned=np.array([row / np.linalg.norm(row) for row in rows])) if rows else self

    def _is_shift(self, motion: Array) -> bool:
        """Whether a motion is one across the axis, which the modes leave no room for: one of its parts is missing."""
        moved = {mode for mode, value in zip(self.modes, motion, strict=True) if value != 0}
        return all(mode.part != "sigma" and mode.p == self.symmetry.turns for mode in moved)

    def is_upper_half(self, direction: Array) -> bool:
        """A choice between the two halves of a pitchfork: whether its largest coefficient grows."""
        coefficients = self.coefficients(direction)
        return bool(coefficients[np.abs(coefficients).argmax()] > 0)

    @cached_property
    def trivial_block(self) -> TubeBlock:
        """Perturbations that keep the symmetry."""
        return self.symmetry.block(0, 0, 0)

    def limit(self, observed: Mapping[str, float], spectrum: Spectrum) -> str | None:
        """A section that is not star-shaped, or growth rates that the modes do not resolve."""
        if observed["r_min"] <= 0:
            return "a cross-section is no longer star-shaped about its centre, as reduced modes need it"
        if spectrum.residual > RESOLVED * self.wave_number**4:
            size = " x ".join(str(most) for most in self.size if most)
            text = f"its growth rates are known to {{rate:.0e}} only, as its rigid motions show: {size} modes do not "
            text += "resolve it; stop before, or follow the branch on a mesh (nodes)"
            raise SpectrumError(Sentence(text, rate=spectrum.residual))
        return None

    def equilibrium(self, u: Array, cell: Cell | None = None) -> Equilibrium:
        """The solution as its second variation needs it, on the points of its own cell or of another."""
        waves, parameters, cell = self._waves(u), self.parameters(u), cell or self.cell
        fields = waves.state(cell, self.coefficients(u))
        return Equilibrium(cell, fields, waves.waves.kappa, parameters.c0, parameters.lambda1, parameters.lambda2)

    def _reach(self, u: Array) -> tuple[int, int]:
        """Largest wave numbers of perturbations, along and around: a little beyond the solution's, and all that may grow."""
        period, fold = self._units
        parameters, largest = self.parameters(u), self._largest(u)
        around = max(8, fold * self.size[1] + 2, math.ceil(largest) + 2)
        # In a turning frame, the wave (m, n) at rest has m + turns n waves along.
        fastest = math.ceil(largest * math.hypot(parameters.length / (2 * math.pi), self.symmetry.turns))
        along = max(period * (self.size[0] + 2), fastest + 2) if period else fastest + self.symmetry.turns
        return along, around

    def _blocks(self, reach: tuple[int, int], u: Array) -> Mapping[TubeBlock, ModeWaves]:
        """All blocks of perturbations up to the largest wave numbers, on the problem's length.

        Raises:
            SpectrumError: they are too many.
        """
        blocks = blocks_up_to(self.symmetry, self.k, self.kappa, reach)
        if not blocks:
            raise SpectrumError(
                f"its stability would take too many modes: up to {reach[0]} waves along and {reach[1]} around it "
                f"may grow; take {self._fewer(u)}"
            )
        return blocks

    def check_spectrum(self, u: Array) -> None:
        """Refuse growth rates that would take too many modes."""
        self._blocks(self._reach(u), u)

    def _fewer(self, u: Array) -> str:
        """What makes fewer perturbations grow: their number is that of waves up to ``_largest``, or of the shape's own."""
        p, period, fold = self.parameters(u), self.symmetry.period or self.symmetry.turns, self.symmetry.fold
        k = 2 * math.pi * period / p.length
        own, by_curvature = k**2 + fold**2, abs(1 - 2 * p.c0)
        words = ["fewer waves in the mode"] if own > max(4.0, by_curvature / 4) else []
        words += ["a c0 nearer to 1/2"] if by_curvature > own else []
        words += ["a shorter tube"] if k < 1 else ["a longer tube"] if k > fold else []
        return ", or ".join(words)

    def _perturbed(self, u: Array, reach: tuple[int, int]) -> Equilibrium:
        """The solution on points that resolve its perturbations."""
        along, around = (math.ceil(most / (unit or 1)) for most, unit in zip(reach, self._units, strict=True))
        return self.equilibrium(u, self._cell_for((along, around)))

    def _largest(self, u: Array) -> float:
        """A wave number beyond which nothing grows, along the tube or around it.

        On the cylinder nothing grows beyond ``k^2 + n^2 = 3 + 2 |lambda2| + 2 |1 - 2 c0|``; deformed shapes get some room.
        """
        parameters = self.parameters(u)
        return 1.25 * math.sqrt(3 + 2 * abs(parameters.lambda2) + 2 * abs(1 - 2 * parameters.c0))

    def _block_problems(
        self, equilibrium: Equilibrium, u: Array, families: Sequence[ModeWaves]
    ) -> Iterator[BlockProblem]:
        """Eigenproblems of blocks that share their waves."""
        known, length = self.known(u), self.parameters(u).length
        for modes, matrices in zip(families, equilibrium.second_variations(*families), strict=True):
            motions = rigid_motions(known, modes.modes, self.symmetry.turns)
            yield BlockProblem.of(equilibrium, modes, matrices, motions, self.held, length)

    def spectrum(self, u: Array) -> Spectrum:
        """Growth rates of all perturbations that fit the tube."""
        reach = self._reach(u)
        equilibrium, blocks = self._perturbed(u, reach), self._blocks(reach, u)
        alike: dict[Waves, dict[TubeBlock, ModeWaves]] = {}
        for block, modes in zip(blocks, self._stretched(u, *blocks.values()), strict=True):
            alike.setdefault(modes.waves, {})[block] = modes
        found: dict[TubeBlock, tuple[Array, float]] = {}
        for group in alike.values():
            problems = self._block_problems(equilibrium, u, list(group.values()))
            found |= {block: problem.rates() for block, problem in zip(group, problems, strict=True)}
        rates = {block: found[block][0] for block in blocks}
        return Spectrum.of(rates, max((error for _, error in found.values()), default=0.0))

    def block_problem(self, u: Array, block: TubeBlock) -> tuple[tuple[Mode, ...], BlockProblem]:
        """A block's modes, and its eigenproblem."""
        reach = self._reach(u)
        (modes,) = self._stretched(u, self._blocks(reach, u)[block])
        (problem,) = self._block_problems(self._perturbed(u, reach), u, [modes])
        return modes.modes, problem

    def block_rates(self, u: Array, block: TubeBlock, like: Spectrum) -> Array:
        """Growth rates in one block."""
        return self.block_problem(u, block)[1].rates()[0]
