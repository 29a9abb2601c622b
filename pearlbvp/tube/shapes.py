"""Tubes as sums of modes in the space of a symmetry: what an unknown is, and the surface that it describes.

The unknown holds the modes' coefficients, then those of ``lambda1, lambda2, v, c0, length`` that are free. Which equations it
solves is in ``tube.problem``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.held import AREA_AND_VOLUME, Held, known_held
from pearlbvp.membrane import AROUND, Grid, MembraneProblem, Surface, of_sections
from pearlbvp.projection import of_section
from pearlbvp.representation import brief
from pearlbvp.tube.modes import Mode, sections
from pearlbvp.tube.symmetry import TubeBlock, TubeSymmetry
from pearlbvp.tube.waves import ModeWaves


class TubeParameters(NamedTuple):
    """Multipliers and parameters of a tube, in the order in which those that are free end an unknown."""

    lambda1: float
    lambda2: float
    v: float
    c0: float
    length: float


@dataclass(frozen=True)
class TubeShapes(MembraneProblem):
    """Tubes of one symmetry on a number of modes.

    Attributes:
        symmetry: the symmetry.
        c0, length: the tube's, where they are not free.
        size: largest wave numbers along and around, in periods and in folds.
        pinned: rigid motions that the symmetry leaves free, shape (r, N): solutions are perpendicular to them.
        tolerance: of the last modes' curvature, beyond which ``remesh`` takes more.
        held: what is held while stability is judged.
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
    held: Held = AREA_AND_VOLUME
    free: tuple[str, ...] = ("lambda1", "lambda2", "v")
    lambda1: float = 0.0
    lambda2: float = 0.0
    v: float = 1.0

    @property
    def family(self) -> str:
        """``coil`` (and what branches off from coils) or ``buckle`` (and all other tubes)."""
        return "coil" if self.symmetry.turns or self.symmetry.is_coil else "buckle"

    def parameters(self, u: Array) -> TubeParameters:
        """Multipliers and parameters of an unknown: its own where they are free, else the problem's."""
        own = dict(zip(self.free, map(float, u[len(self.modes) :]), strict=True))
        return TubeParameters(*(own.get(name, getattr(self, name)) for name in TubeParameters._fields))

    def freeing(self, u: Array, *free: str) -> tuple[Self, Array]:
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

    @property
    def repeats(self) -> tuple[int, int]:
        """Periods along the tube, of coils their turns, and folds around it."""
        return self.symmetry.period or self.symmetry.turns, self.symmetry.fold

    @cached_property
    def modes(self) -> tuple[Mode, ...]:
        """The functions that solutions are sums of."""
        return self.symmetry.modes(self.size)

    @cached_property
    def waves(self) -> ModeWaves:
        """The same as waves."""
        return ModeWaves.of(self.k, self.kappa, self.modes)[0]

    @property
    def _units(self) -> tuple[int, int]:
        return self.symmetry.period, self.symmetry.fold

    def _waves(self, u: Array) -> ModeWaves:
        """The modes as waves on a tube of the length that an unknown has."""
        return self.waves if "length" not in self.free else self._stretched(u, self.waves)[0]

    def _stretched(self, u: Array, *families: ModeWaves) -> list[ModeWaves]:
        k = 2 * math.pi / self.parameters(u).length
        return list(families) if k == self.k else ModeWaves.stretched(k, self.symmetry.turns * k, *families)

    def coefficients(self, u: Array) -> Array:
        """Those of the modes, shape (N,)."""
        return u[: len(self.modes)]

    def packed(self, known: Mapping[Mode, float]) -> Array:
        """Coefficients in the order of the modes; those that are not known are 0."""
        return np.array([known.get(mode, 0.0) for mode in self.modes])

    def known(self, u: Array) -> dict[Mode, float]:
        """The coefficients of an unknown by mode."""
        return dict(zip(self.modes, map(float, self.coefficients(u)), strict=True))

    def transfer(self, other: Self, u: Array) -> Array:
        """An unknown of another number of modes, or of a larger symmetry; modes that it does not have are 0."""
        if other.modes == self.modes:
            return u
        return np.append(self.packed(other.known(u)), u[len(other.modes) :])

    def signed_amplitude(self, u: Array) -> float:
        """A number that changes its sign where a ring, coil, buckle or pearl becomes the straight tube; 1 of other tubes."""
        mode = self.symmetry.onset_mode
        return 1.0 if mode is None else self.known(u)[mode]

    @property
    def varying(self) -> tuple[str, ...]:
        """What varies on the branch of what perturbations may keep."""
        return tuple("L" if name == "length" else name for name in self.free)

    def in_modes(self, u: Array, tangent: Array) -> tuple[Self, Array, Array]:
        """Itself; shapes of other kinds have their solutions in reduced modes."""
        return self, u, tangent

    @property
    def turns(self) -> int:
        """Of the frame along the tube."""
        return self.symmetry.turns

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

    def _at_its_length(self, u: Array) -> tuple[Self, Array]:
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
            "tolerance": self.tolerance, "held": str(self.held),
            "free": ",".join(self.free), "lambda1": self.lambda1, "lambda2": self.lambda2, "v": self.v,
        }  # fmt: skip
        return tree if self.pinned is None else tree | {"pinned": self.pinned}

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> Self:
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
            known_held(tree["held"]), free, **kept,
        )  # fmt: skip
