"""Tubes of any symmetry as sums of modes, as ``continuation`` takes them (``docs/theory/reduced_modes.md``).

Each tube lives in the space of its symmetry (``tube.symmetry``), where its bifurcation is simple. The unknown holds the modes'
coefficients, then those of ``lambda1, lambda2, v, c0, length`` that are free. Equations: the energy's gradient by the
coefficients with both constraints' multipliers, the area, the volume. All are exact derivatives of one trapezoidal sum.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len

from pearlbvp.arrays import Array
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.errors import SpectrumError
from pearlbvp.helfrich import SHORT_WAVE, Fixed
from pearlbvp.membrane import AROUND, Grid, MembraneProblem, Surface, fixed_of_tree, of_sections
from pearlbvp.projection import of_section
from pearlbvp.representation import brief
from pearlbvp.tube.extremes import extremes
from pearlbvp.tube.modes import Mode, sections
from pearlbvp.tube.rigid import rigid_motions
from pearlbvp.tube.spectrum import Equilibrium, block_rates
from pearlbvp.tube.symmetry import TubeBlock, TubeSymmetry, ellipse
from pearlbvp.tube.waves import Cell, ModeWaves
from pearlbvp.units import Sentence

MOST_MODES, MOST_MODES_PLANE = 256, 48
"""Largest number of periods or folds in a tube's modes: where it depends on one variable, and each way where on two."""

PLANE_TOLERANCE = 1e-7
"""Of the curvature of the last modes where a tube depends on two variables. Multipliers and energy, stationary values, are
far better."""


RESOLVED = 1e-6
"""Error of growth rates, by the fourth power of the wave number, beyond which a branch ends rather than count wrongly."""

MOST_WAVES = 20000
"""Waves along times waves around, beyond which a spectrum is not tried."""

MOST_WORK = 1e10
"""Cubes of the sizes of all symmetry blocks, up to which a spectrum is computed: a few seconds."""


class TubeParameters(NamedTuple):
    """Multipliers and parameters of a tube, in the order in which those that are free end an unknown."""

    lambda1: float
    lambda2: float
    v: float
    c0: float
    length: float


@dataclass(frozen=True)
class TubeProblem(MembraneProblem):
    """Tubes of one symmetry on a number of modes: ``residual(u) = 0`` is a curve.

    Attributes:
        symmetry: the symmetry.
        c0, length: the tube's, where they are not free.
        size: largest wave numbers along and around, in periods and in folds.
        pinned: rigid motions that the symmetry leaves free, shape (r, N): solutions are perpendicular to them.
        tolerance: of the last modes' curvature, beyond which ``remesh`` takes more.
        fixed: what perturbations keep, for stability.
        free: names of the parameters that end the unknown, in the order of ``TubeParameters``: three leave a curve.
        lambda1, lambda2, v: the tube's, where they are not free.
    """

    __repr__ = brief

    stored_as: ClassVar[str] = "tube"
    block: ClassVar[Any] = TubeBlock
    may_vary: ClassVar[Mapping[str, str]] = {"c0": "c0", "L": "length"}

    symmetry: TubeSymmetry
    c0: float
    length: float
    size: tuple[int, int]
    pinned: Array | None = None
    tolerance: float = 2e-8
    fixed: Fixed = "area and volume"
    free: tuple[str, ...] = ("lambda1", "lambda2", "v")
    lambda1: float = 0.0
    lambda2: float = 0.0
    v: float = 1.0

    @property
    def family(self) -> str:
        """``coil`` (and what branches off from coils) or ``buckle`` (and all other tubes)."""
        return "coil" if self.symmetry.turns else "buckle"

    def parameters(self, u: Array) -> TubeParameters:
        """Multipliers and parameters of an unknown: its own where they are free, else the problem's."""
        own = dict(zip(self.free, map(float, u[len(self.modes) :]), strict=True))
        return TubeParameters(*(own.get(name, getattr(self, name)) for name in TubeParameters._fields))

    def freeing(self, u: Array, *free: str) -> tuple[TubeProblem, Array]:
        """The same solution with other parameters free, the rest kept as they are there: to vary ``c0`` at fixed ``v``, say.

        Args:
            u: a solution.
            free: names of ``TubeParameters``, in any order: three leave a curve of solutions, four a surface.

        Raises:
            ValueError: a name that is no parameter.
        """
        unknown = set(free) - set(TubeParameters._fields)
        if unknown:
            raise ValueError(f"free: {min(unknown)!r} is none of {', '.join(TubeParameters._fields)}")
        known = self.parameters(u)._asdict()
        problem = replace(self, free=tuple(name for name in known if name in free), **known)
        return problem, np.append(self.coefficients(u), [known[name] for name in problem.free])

    @property
    def k(self) -> float:
        """Unit of the wave numbers along the tube."""
        return 2 * math.pi / self.length

    @property
    def kappa(self) -> float:
        """Rate at which the frame turns."""
        return self.symmetry.turns * self.k

    @property
    def wavelength(self) -> float:
        """Length after which sections repeat."""
        return self.length / (self.symmetry.period or self.symmetry.turns or 1)

    @cached_property
    def modes(self) -> tuple[Mode, ...]:
        """The functions that solutions are sums of."""
        return self.symmetry.modes(self.size)

    @cached_property
    def waves(self) -> ModeWaves:
        """The same as waves."""
        return ModeWaves.of(self.k, self.kappa, self.modes)[0]

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

    @property
    def _units(self) -> tuple[int, int]:
        return self.symmetry.period, self.symmetry.fold

    def _waves(self, u: Array) -> ModeWaves:
        """The modes as waves on a tube of the length that an unknown has."""
        return self.waves if "length" not in self.free else self._stretched(u, self.waves)[0]

    def _stretched(self, u: Array, *families: ModeWaves) -> list[ModeWaves]:
        k = 2 * math.pi / self.parameters(u).length
        return list(families) if k == self.k else ModeWaves.stretched(k, self.symmetry.turns * k, *families)

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
        """``lambda1, lambda2, v, E, amplitude, r_min, r_max, c0, L``; radii are measured from the sections' centres."""
        lambda1, lambda2, v, c0, length = self.parameters(u)
        thin, thick = extremes(self._waves(u), self.cell, self.coefficients(u))
        return {
            "lambda1": lambda1, "lambda2": lambda2, "v": v, "E": self.equilibrium(u).means[0],
            "amplitude": (thick - thin) / 2, "r_min": thin, "r_max": thick, "c0": c0, "L": length,
        }  # fmt: skip

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

    def coefficients(self, u: Array) -> Array:
        """Those of the modes, shape (N,)."""
        return u[: len(self.modes)]

    def packed(self, known: Mapping[Mode, float]) -> Array:
        """Coefficients in the order of the modes; those that are not known are 0."""
        return np.array([known.get(mode, 0.0) for mode in self.modes])

    def known(self, u: Array) -> dict[Mode, float]:
        """The coefficients of an unknown by mode."""
        return dict(zip(self.modes, map(float, self.coefficients(u)), strict=True))

    def transfer(self, other: TubeProblem, u: Array) -> Array:
        """An unknown of another number of modes, or of a larger symmetry; modes that it does not have are 0."""
        if other.modes == self.modes:
            return u
        return np.append(self.packed(other.known(u)), u[len(other.modes) :])

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

    def signed_amplitude(self, u: Array) -> float:
        """A number that changes its sign where a ring, coil, buckle or pearl becomes the straight tube; 1 of other tubes."""
        mode = self.symmetry.onset_mode
        return 1.0 if mode is None else self.known(u)[mode]

    @cached_property
    def trivial_block(self) -> TubeBlock:
        """Perturbations that keep the symmetry."""
        return self.symmetry.block(0, 0, 0)

    @property
    def varying(self) -> tuple[str, ...]:
        """What varies on the branch of what perturbations may keep."""
        return tuple("L" if name == "length" else name for name in self.free)

    def in_modes(self, u: Array, tangent: Array) -> tuple[TubeProblem, Array, Array]:
        """Itself; shapes of other kinds have their solutions in reduced modes."""
        return self, u, tangent

    @property
    def turns(self) -> int:
        """Of the frame along the tube."""
        return self.symmetry.turns

    def limit(self, observed: Mapping[str, float], spectrum: Spectrum) -> str | None:
        """A section that is not star-shaped, or growth rates that the modes do not resolve."""
        if observed["r_min"] <= 0:
            return "a cross-section is no longer star-shaped about its centre, as reduced modes need it"
        if spectrum.residual > RESOLVED * self.wave_number**4:
            size = " x ".join(str(most) for most in self.size if most)
            text = f"its growth rates are known to {{rate:.0e}} only, as its rigid motions show: {size} modes do not "
            text += "resolve it; stop before, or follow the branch on a mesh (--nodes)"
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

    def _blocks(self, reach: tuple[int, int], u: Array) -> dict[TubeBlock, ModeWaves]:
        """All blocks of perturbations up to the largest wave numbers, on the problem's length.

        Raises:
            SpectrumError: they are too many.
        """
        if reach not in self._known_blocks:
            along, around = reach
            waves: list[tuple[int, int]] = []
            if along * around < MOST_WAVES:
                waves = ellipse(1, 1, reach) if self._units[0] else list(product(range(along + 1), range(around + 1)))
            blocks = self.symmetry.blocks(waves)
            if not waves or sum(len(modes) ** 3 for modes in blocks.values()) > MOST_WORK:
                raise SpectrumError(
                    f"its stability would take too many modes: up to {along} waves along and {around} around it "
                    f"may grow; take {self._fewer(u)}"
                )
            self._known_blocks[reach] = self._shared(blocks)
        return self._known_blocks[reach]

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

    def _shared(self, blocks: Mapping[TubeBlock, list[Mode]]) -> dict[TubeBlock, ModeWaves]:
        """Blocks as sums of waves, which those share that differ in parities alone."""
        alike: dict[object, list[TubeBlock]] = {}
        for block in blocks:
            alike.setdefault(self.symmetry.wave_class(block), []).append(block)
        found: dict[TubeBlock, ModeWaves] = {}
        for group in alike.values():
            families = ModeWaves.of(self.k, self.kappa, *(blocks[block] for block in group))
            found |= dict(zip(group, families, strict=True))
        return found

    @cached_property
    def _known_blocks(self) -> dict[tuple[int, int], dict[TubeBlock, ModeWaves]]:
        return {}

    def _rates(self, equilibrium: Equilibrium, known: Mapping[Mode, float], modes: ModeWaves) -> tuple[Array, float]:
        motions = rigid_motions(known, modes.modes, self.symmetry.turns)
        return block_rates(equilibrium, modes, motions, self.fixed)

    def spectrum(self, u: Array) -> Spectrum:
        """Growth rates of all perturbations that fit the tube."""
        reach = self._reach(u)
        equilibrium, known = self._perturbed(u, reach), self.known(u)
        rates, kernel, blocks = {}, 0.0, self._blocks(reach, u)
        for block, modes in zip(blocks, self._stretched(u, *blocks.values()), strict=True):
            rates[block], error = self._rates(equilibrium, known, modes)
            kernel = max(kernel, error)
        return Spectrum.of(rates, kernel)

    def block_rates(self, u: Array, block: TubeBlock, like: Spectrum) -> Array:
        """Growth rates in one block."""
        reach = self._reach(u)
        (modes,) = self._stretched(u, self._blocks(reach, u)[block])
        return self._rates(self._perturbed(u, reach), self.known(u), modes)[0]

    def section(self, u: Array, x: float, points: int = 181) -> tuple[Array, Array]:
        """The cross-section at ``x`` as a closed curve in the plane: ``y`` and ``z``."""
        _, y, z = self.surface(u, np.array([x]), points - 1)
        return y[0], z[0]

    def surface(self, u: Array, x: Array | None = None, around: int = 96) -> tuple[Array, Array, Array]:
        """Points of the surface, to draw or to export: ``x, y, z``, each of shape (len(x), around + 1), closed around.

        Args:
            u: a solution.
            x: places along the axis; by default the whole length, both ends among them.
            around: points of each section.
        """
        length = self.parameters(u).length
        x = np.linspace(0, length, max(2, round(12 * length)) + 1) if x is None else x
        plane = self._sections(u, x, np.linspace(0, 2 * math.pi, around + 1))
        return np.repeat(x[:, None], around + 1, axis=1), plane.real, plane.imag

    def _at_its_length(self, u: Array) -> tuple[TubeProblem, Array]:
        """The same solution, its length that of its problem, whatever varies."""
        return self.freeing(u, "lambda1", "lambda2", "v")

    def to_draw(self, u: Array) -> Grid:
        """The surface on the whole tube, piece by piece, for the memory of all modes at all points."""
        problem, u = self._at_its_length(u)
        x = np.linspace(0, problem.length, max(24, round(6 * problem.length)) + 1)
        pieces = [problem.surface(u, part, 64) for part in np.array_split(x, max(1, len(x) // 10))]
        x, y, z = (np.concatenate(parts) for parts in zip(*pieces, strict=True))
        return x, y, z

    def parametrized(self, u: Array) -> Surface:
        """Points by ``x`` and polar angle in the frame."""
        problem, u = self._at_its_length(u)
        return of_sections(lambda x: problem.section(u, x, AROUND + 1))

    def curve(self, u: Array, samples: int) -> dict[str, Array]:
        """Of coils the section at ``x = 0``, closed, which turns along the tube: ``y, z``.

        Raises:
            InputError: the sections are not alike.
        """
        if self.symmetry.period:
            return super().curve(u, samples)
        y, z = self.section(u, 0.0, samples + 1)
        return {"y": y, "z": z}

    def _sections(self, u: Array, x: Array, phi: Array) -> NDArray[np.complex128]:
        """Points of the surface in planes across the axis, shape (len(x), len(phi))."""
        k = 2 * math.pi / self.parameters(u).length
        return sections(self.known(u), k, self.symmetry.turns * k, x, phi)

    def largest_wave(self, u: Array) -> float:
        """``2 A`` of the largest wave (``projection``): near the straight tube that of the mode in which it leaves that."""
        # In its frame, and on one period there, a tube has the waves that it has at rest, each with other numbers along.
        period, fold = self._units
        length, turns = self.parameters(u).length, self.symmetry.turns
        wavelength = length / (period or 1)
        along, about = 6 * self.size[0] + 16 if period else 1, 6 * max(fold * self.size[1], 1) + 16
        x = wavelength * np.arange(along) / along
        phi = 2 * math.pi * np.arange(about) / about
        turned = np.exp(-2j * math.pi * turns * x / length)
        curve = self._sections(u, x, phi) * turned[:, None]
        by_phi = np.fft.ifft(1j * np.fft.fftfreq(about, 1 / about) * np.fft.fft(curve))
        projected = of_section(curve, by_phi * 2 * math.pi / about, x[:, None])
        most = (self.size[0] if period else 0), self.size[1] if fold else 0
        return projected.wave(2 * math.pi / wavelength, most, fold=max(fold, 1), turns=turns / (period or 1))

    def to_tree(self) -> dict[str, Any]:
        """Everything as arrays, numbers and words, to be saved."""
        s = self.symmetry
        tree: dict[str, Any] = {
            "period": s.period, "fold": s.fold, "turns": s.turns, "group": np.array(sorted(s.group), dtype=np.int64),
            "size": np.array(self.size, dtype=np.int64), "c0": self.c0, "length": self.length,
            "tolerance": self.tolerance, "fixed": self.fixed,
            "free": ",".join(self.free), "lambda1": self.lambda1, "lambda2": self.lambda2, "v": self.v,
        }  # fmt: skip
        return tree if self.pinned is None else tree | {"pinned": self.pinned}

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> TubeProblem:
        """The inverse of ``to_tree``.

        Raises:
            ValueError: the tree describes no tube.
        """
        group = frozenset(int(element) for element in tree["group"])
        symmetry = TubeSymmetry(int(tree["period"]), int(tree["fold"]), int(tree["turns"]), group)
        size = int(tree["size"][0]), int(tree["size"][1])
        free = tuple(str(tree["free"]).split(","))
        if free != tuple(name for name in TubeParameters._fields if name in free):
            raise ValueError(
                f"free: {','.join(free)!r} are not some of {','.join(TubeParameters._fields)} in their order"
            )
        kept = {name: float(tree[name]) for name in ("lambda1", "lambda2", "v")}
        return cls(
            symmetry, float(tree["c0"]), float(tree["length"]), size, tree.get("pinned"), float(tree["tolerance"]),
            fixed_of_tree(tree), free, **kept,
        )  # fmt: skip
