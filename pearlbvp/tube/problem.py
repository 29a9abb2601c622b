"""Tubes of any symmetry as sums of modes, as ``continuation`` takes them (design, §6 and §7).

Each tube lives in the space of its symmetry (``tube.symmetry``), where its bifurcation is simple. The unknown holds the modes'
coefficients, then ``lambda1, lambda2, v``. Equations: the energy's gradient by the coefficients with both constraints'
multipliers, the area, the volume. All are exact derivatives of one trapezoidal sum.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any, ClassVar, get_args

import numpy as np
from scipy.fft import next_fast_len

from pearlbvp.collocation.scheme import Array
from pearlbvp.tube.density import gradients
from pearlbvp.tube.extremes import extremes
from pearlbvp.tube.modes import Basis, Mode
from pearlbvp.tube.rigid import rigid_motions
from pearlbvp.tube.spectrum import Equilibrium, Fixed, TubeSpectrum, block_rates
from pearlbvp.tube.symmetry import TubeBlock, TubeSymmetry, ellipse
from pearlbvp.tube.waves import Cell, ModeWaves

MOST_MODES, MOST_MODES_PLANE = 256, 48
"""Largest number of periods or folds in a tube's modes: where it depends on one variable, and each way where on two."""

PLANE_TOLERANCE = 1e-7
"""Of the curvature of the last modes where a tube depends on two variables. Multipliers and energy, stationary values, are
far better."""


@dataclass(frozen=True)
class TubeProblem:
    """Tubes of one symmetry on a number of modes: ``residual(u) = 0`` is a curve.

    Attributes:
        symmetry: the symmetry.
        c0, length: the tube's.
        size: largest wave numbers along and around, in periods and in folds.
        pinned: rigid motions that the symmetry leaves free, shape (r, N): solutions are perpendicular to them.
        tolerance: of the last modes' curvature, beyond which ``remesh`` takes more.
        fixed: what perturbations keep, for stability.
    """

    stored_as: ClassVar[str] = "tube"

    symmetry: TubeSymmetry
    c0: float
    length: float
    size: tuple[int, int]
    pinned: Array | None = None
    tolerance: float = 2e-8
    fixed: Fixed = "area and volume"

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
        along, around = (
            next_fast_len(3 * most + 8, real=True) if unit else 1
            for most, unit in zip(self.size, self._units, strict=True)
        )
        return Cell(self.symmetry.period, self.symmetry.fold, (along, around))

    @property
    def _units(self) -> tuple[int, int]:
        return self.symmetry.period, self.symmetry.fold

    def _gradients(self, u: Array) -> tuple[float, float, float, Array, Array, Array]:
        """Means of energy, area and volume by unit area of the cylinder, and their gradients."""
        state = self.waves.state(self.cell, u[:-3])
        values, slopes = gradients(state, self.c0)
        by_volume = np.zeros_like(state)
        by_volume[3] = state[3]  # volume is the mean of sigma^2/2, and sigma is the field b_1
        transform = self.cell.transform
        energy, area, volume = (self.waves.linear(self.cell, transform(slope)) for slope in (*slopes, by_volume))
        return (
            values[0].mean(),
            values[1].mean(),
            float(state[3] @ state[3]) / (2 * state.shape[1]),
            energy,
            area,
            volume,
        )

    def residual(self, u: Array) -> Array:
        """The equations at ``u``, shape (N + 2,)."""
        _, area, volume, by_energy, by_area, by_volume = self._gradients(u)
        force = by_energy + u[-3] * by_area + u[-2] * by_volume
        if self.pinned is not None:
            # The energy does not change along rigid motions, so this is no force: at a solution it vanishes by itself.
            force += self.pinned.T @ (self.pinned @ u[:-3])
        return np.concatenate((force, [area - 1, volume - u[-1] / 2]))

    def solve(self, u: Array, rhs: Array, row: Array | None = None) -> Array:
        """Bordered solve of the residual's Jacobian at ``u``; see ``Problem.solve``."""
        equilibrium = self.equilibrium(u)
        second = equilibrium.hessian(self.waves)
        if self.pinned is not None:
            second = second + self.pinned.T @ self.pinned
        by_area, by_volume = equilibrium.constraints(self.waves)
        rows = np.zeros((0, u.size)) if row is None else np.atleast_2d(row) * self.weights
        size = len(second)
        matrix = np.zeros((size + 2 + len(rows), u.size))
        matrix[:size, :size] = second
        matrix[:size, size], matrix[:size, size + 1] = by_area, by_volume
        matrix[size, :size], matrix[size + 1, :size] = by_area, by_volume
        matrix[size + 1, -1] = -0.5
        matrix[size + 2 :] = rows
        return np.asarray(np.linalg.solve(matrix, rhs))

    @cached_property
    def weights(self) -> Array:
        """Of the entries of ``u`` in the inner product: mean squares of the modes, 1 for the parameters."""
        squares = [(0.5 if mode.p else 1.0) * (0.5 if mode.b else 1.0) for mode in self.modes]
        return np.array([*squares, 1.0, 1.0, 1.0])

    def inner(self, u: Array, v: Array) -> float:
        """Inner product that does not depend on the number of modes."""
        return float((u * self.weights) @ v)

    def observables(self, u: Array) -> dict[str, float]:
        """``lambda1, lambda2, v, E, amplitude, r_min, r_max, c0, L``; radii are measured from the sections' centres."""
        thin, thick = extremes(self.waves, self.cell, u[:-3])
        energy = gradients(self.waves.state(self.cell, u[:-3]), self.c0)[0][0].mean()
        return {
            "lambda1": float(u[-3]), "lambda2": float(u[-2]), "v": float(u[-1]), "E": float(energy),
            "amplitude": (thick - thin) / 2, "r_min": thin, "r_max": thick, "c0": self.c0, "L": self.length,
        }  # fmt: skip

    def tails(self, u: Array) -> tuple[tuple[float, float], tuple[float, float]]:
        """Largest curvatures of the modes halfway out and at the end: of those more along the tube, and more around it.

        Coefficients times ``k^2 + b^2``: what the growth rates, of higher order than the energy, feel of modes left out.
        """
        numbers = np.array([(mode.p, mode.harmonic) for mode in self.modes])
        curvatures = np.abs(u[:-3]) * ((numbers[:, 0] * self.k) ** 2 + numbers[:, 1] ** 2)
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
        return larger, [larger.adopt(self, vector) for vector in (u, *others)]

    def resized(self, size: tuple[int, int]) -> TubeProblem:
        """The same problem on another number of modes."""
        other = replace(self, size=size, pinned=None)
        if self.pinned is None:
            return other
        moved = np.array([other.packed(dict(zip(self.modes, row, strict=True))) for row in self.pinned])
        return replace(other, pinned=moved)

    def coefficients(self, u: Array) -> Array:
        """Those of the modes, shape (N,)."""
        return u[:-3]

    def packed(self, known: Mapping[Mode, float]) -> Array:
        """Coefficients in the order of the modes; those that are not known are 0."""
        return np.array([known.get(mode, 0.0) for mode in self.modes])

    def known(self, u: Array) -> dict[Mode, float]:
        """The coefficients of an unknown by mode."""
        return dict(zip(self.modes, map(float, u[:-3]), strict=True))

    def adopt(self, other: TubeProblem, u: Array) -> Array:
        """An unknown of another number of modes, or of a larger symmetry; modes that it does not have are 0."""
        if other.modes == self.modes:
            return u
        return np.append(self.packed(other.known(u)), u[-3:])

    def embed(self, block: TubeBlock, centre: str, *vectors: Array) -> tuple[TubeProblem, list[Array]]:
        """The problem in whose space the perturbations of a block live, and vectors moved into it.

        Args:
            block: a symmetry block of this problem.
            centre: of no use here: blocks of reduced modes leave no choice.
            vectors: a solution of this problem, then solutions or tangents.
        """
        if block == self.own_block:
            return self, list(vectors)
        symmetry = self.symmetry.broken_by(block)
        sizes = []
        for most, old, new in zip(self.size, self._units, (symmetry.period, symmetry.fold), strict=True):
            sizes.append(max(most * old // new, 8) if new else 0)
        tolerance = max(self.tolerance, PLANE_TOLERANCE) if all(sizes) else self.tolerance
        problem = replace(self, symmetry=symmetry, size=(sizes[0], sizes[1]), pinned=None, tolerance=tolerance)
        moved = [problem.adopt(self, vector) for vector in vectors]
        motions = rigid_motions(self.known(vectors[0]), problem.modes, symmetry.turns)
        rows = [motion * problem.weights[:-3] for motion in motions if not problem._is_shift(motion)]
        if rows:
            problem = replace(problem, pinned=np.array([row / np.linalg.norm(row) for row in rows]))
        return problem, moved

    def _is_shift(self, motion: Array) -> bool:
        """Whether a motion is one across the axis, which the modes leave no room for: one of its parts is missing."""
        moved = {mode for mode, value in zip(self.modes, motion, strict=True) if value != 0}
        return all(mode.part != "sigma" and mode.p == self.symmetry.turns for mode in moved)

    def grows_at_centre(self, direction: Array) -> bool:
        """A choice between the two halves of a pitchfork: whether its largest coefficient grows."""
        return bool(direction[:-3][np.abs(direction[:-3]).argmax()] > 0)

    @cached_property
    def own_block(self) -> TubeBlock:
        """Perturbations that keep the symmetry."""
        return self.symmetry.block(0, 0, 0)

    @property
    def conserved(self) -> str:
        """What perturbations keep and the branch does not."""
        return "v" if self.fixed == "area and volume" else "lambda2"

    def poles(self, u: Array) -> Mapping[str, float]:
        """None: the multipliers of these families stay finite."""
        return {}

    def equilibrium(self, u: Array) -> Equilibrium:
        """The solution as its second variation needs it."""
        fields = self.waves.state(self.cell, u[:-3])
        return Equilibrium(self.cell, fields, self.kappa, self.c0, float(u[-3]), float(u[-2]))

    def _blocks(self, u: Array) -> dict[TubeBlock, ModeWaves]:
        """All blocks of perturbations; their waves go a little beyond the solution's."""
        period, fold = self._units
        around = max(8, fold * self.size[1] + 2)
        fastest = self._fastest(u)
        along = max(period * (self.size[0] + 2), fastest + 2) if period else fastest + self.symmetry.turns
        if (along, around) not in self._known_blocks:
            waves = ellipse(1, 1, (along, around)) if period else list(product(range(along + 1), range(around + 1)))
            self._known_blocks[along, around] = self._shared(self.symmetry.blocks(waves))
        return self._known_blocks[along, around]

    def _fastest(self, u: Array) -> int:
        """A wave number along the tube, in units of ``k``, beyond which nothing grows.

        On the cylinder nothing grows beyond ``k^2 = 3 + 2 |lambda2| + 2 |1 - 2 c0|``; deformed shapes get some room.
        """
        largest = math.sqrt(3 + 2 * abs(u[-2]) + 2 * abs(1 - 2 * self.c0))
        return math.ceil(1.25 * largest / self.k)

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

    def spectrum(self, u: Array) -> TubeSpectrum:
        """Growth rates of all perturbations that fit the tube."""
        equilibrium, known = self.equilibrium(u), self.known(u)
        rates, kernel = {}, 0.0
        for block, modes in self._blocks(u).items():
            rates[block], error = self._rates(equilibrium, known, modes)
            kernel = max(kernel, error)
        return TubeSpectrum(rates, kernel)

    def block_rates(self, u: Array, block: TubeBlock, like: TubeSpectrum) -> Array:
        """Growth rates in one block."""
        return self._rates(self.equilibrium(u), self.known(u), self._blocks(u)[block])[0]

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
        x = np.linspace(0, self.length, max(2, round(12 * self.length)) + 1) if x is None else x
        phi = np.linspace(0, 2 * math.pi, around + 1)
        xs, phis = np.meshgrid(x, phi, indexing="ij")
        basis = Basis.of(self.modes, self.k, self.kappa, xs.ravel(), phis.ravel())
        moved = basis.displacement() @ u[:-3]  # turned by e^{-i(kappa x + phi)}
        plane = (moved[:, 0] + 1j * moved[:, 1]) * np.exp(1j * (self.kappa * xs.ravel() + phis.ravel()))
        return xs, plane.real.reshape(xs.shape), plane.imag.reshape(xs.shape)

    def to_tree(self) -> dict[str, Any]:
        """Everything as arrays, numbers and words, to be saved."""
        s = self.symmetry
        tree: dict[str, Any] = {
            "period": s.period, "fold": s.fold, "turns": s.turns, "group": np.array(sorted(s.group), dtype=np.int64),
            "size": np.array(self.size, dtype=np.int64), "c0": self.c0, "length": self.length,
            "tolerance": self.tolerance, "fixed": self.fixed,
        }  # fmt: skip
        return tree if self.pinned is None else tree | {"pinned": self.pinned}

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> TubeProblem:
        """The inverse of ``to_tree``.

        Raises:
            ValueError: the tree describes no tube.
        """
        if tree["fixed"] not in get_args(Fixed):
            raise ValueError(f"fixed: {tree['fixed']!r} is none of {get_args(Fixed)}")
        group = frozenset(int(element) for element in tree["group"])
        symmetry = TubeSymmetry(int(tree["period"]), int(tree["fold"]), int(tree["turns"]), group)
        size = int(tree["size"][0]), int(tree["size"][1])
        return cls(
            symmetry, float(tree["c0"]), float(tree["length"]), size, tree.get("pinned"), float(tree["tolerance"]),
            tree["fixed"],
        )  # fmt: skip
