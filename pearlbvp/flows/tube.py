"""Flow of tubes without any symmetry, in reduced modes: ``P(x, phi) = d(x) + sigma(x, phi) e^{i phi}``.

See ``docs/theory/reduced_modes.md``. The unknowns are the coefficients of all products of a Fourier function along the tube
and one around it, up to given wave numbers. Gradients and Hessians of area, volume and energy are those of
``tube.spectrum``, in the frame at rest. What resists is a drag, half the mean square of the normal velocity: its gradient
by the rates balances that of the energy.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any, get_args

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError
from pearlbvp.flows.problem import Law, Trouble, check_law
from pearlbvp.flows.spectrum import growth_rates
from pearlbvp.representation import brief
from pearlbvp.tube.extremes import extremes
from pearlbvp.tube.modes import Mode, sections
from pearlbvp.tube.rigid import rigid_motions
from pearlbvp.tube.spectrum import Equilibrium
from pearlbvp.tube.symmetry import product_modes
from pearlbvp.tube.torus import TorusFunction
from pearlbvp.tube.waves import IMAGINARY_DRAGS, Cell, Families, MatrixTransform, ModeWaves, matrix_transform
from pearlbvp.units import Sentence

THINNEST, STEEPEST = 1e-2, 20.0
"""Radius of a section about its centre, and slope of the surface against the axis, beyond which these modes are left."""

MOST_MODES = 2500


@dataclass(frozen=True)
class TubeFlow:
    """Tubes in reduced modes; ``q`` holds the coefficients of ``modes``.

    Attributes:
        c0, length: the tube's.
        size: largest wave numbers along and around.
        law: what the flow keeps: area and volume, in ``L^2`` or in ``H^-1``, or the area.
        pressure: the given ``lambda2`` where the law keeps the area alone.

    Raises:
        InputError: an argument that cannot be used.
    """

    __repr__ = brief

    c0: float
    length: float
    size: tuple[int, int] = (12, 12)
    law: Law = "area and volume"
    pressure: float = 0.0

    def __post_init__(self) -> None:
        check_law(self.law)
        along, around = self.size
        if along < 1 or around < 2:
            raise InputError("size", f"{along},{around} waves along and around are too few", "give at least 1,2")
        count = (2 * along + 1) * (2 * around + 1)
        if count > MOST_MODES:
            raise InputError(
                "size",
                f"{along},{around} waves along and around are {count} functions, more than {MOST_MODES}",
                "give fewer, like 24,24 or 60,9",
            )

    @cached_property
    def waves(self) -> ModeWaves:
        """All modes up to the largest wave numbers, as waves."""
        along, around = self.size
        numbers = product(range(along + 1), range(around + 1))
        (waves,) = ModeWaves.of(2 * np.pi / self.length, 0.0, tuple(product_modes(numbers, 0)))
        return waves

    @property
    def modes(self) -> tuple[Mode, ...]:
        """The modes whose coefficients ``q`` holds."""
        return self.waves.modes

    @cached_property
    def _numbers(self) -> tuple[Array, Array]:
        """Wave numbers of the modes along and around, those of the centre 0."""
        return np.array([mode.p for mode in self.modes]), np.array([mode.b for mode in self.modes])

    @property
    def cell(self) -> Cell:
        """A period, on points that integrate products of three modes, and some more."""
        along, around = self.size
        return Cell(1, 1, (4 * along + 8, 4 * around + 8))

    @cached_property
    def _points(self) -> tuple[Array, Array]:
        """``x``, from ``-L/2`` on, and ``phi`` of the cell's points, shape (K,)."""
        along, around = self.cell.points
        x = np.fft.fftfreq(along) * self.length
        xs, phis = np.meshgrid(x, np.arange(around) / around * 2 * np.pi, indexing="ij")
        return xs.ravel(), phis.ravel()

    def packed(self, known: Mapping[Mode, float]) -> Array:
        """``q`` of known coefficients; the others are 0, and what does not fit into ``size`` is dropped."""
        return np.array([known.get(mode, 0.0) for mode in self.modes])

    def known(self, q: Array) -> dict[Mode, float]:
        """The coefficients by mode."""
        return dict(zip(self.modes, map(float, q), strict=True))

    def coordinates(self, modes: Iterable[Mode], coefficients: Array, k: float, kappa: float = 0.0) -> Array:
        """``q`` of a sum of modes as ``tube.modes`` has them; what does not fit into ``size`` is dropped.

        Args:
            modes, coefficients: the sum.
            k: unit of the modes' wave numbers.
            kappa: rate at which their frame turns.

        Raises:
            InputError: the frame does not turn a whole number of times on the length.
        """
        unit = 2 * np.pi / self.length
        turns = round(kappa / unit)
        if abs(kappa / unit - turns) > 1e-9:
            raise InputError(
                "kappa",
                f"a frame that turns {kappa / unit:.6g} times on L = {self.length:g} does not fit it",
                "give a multiple of 2 pi/L",
            )
        known = {
            mode._replace(p=round(mode.p * k / unit)): float(value)
            for mode, value in zip(modes, coefficients, strict=True)
        }
        return self.packed(TorusFunction.of(known).in_frame(-turns).modes() if turns else known)

    def of_radii(self, x: Array, r: Array) -> Array:
        """``q`` of an axisymmetric shape given at evenly spaced places of a period that begin at ``x[0]``."""
        waves = np.fft.rfft(r) / len(r)
        waves *= np.exp(-2j * np.pi * np.arange(len(waves)) * x[0] / self.length)
        known = {Mode("sigma", 0): float(waves[0].real)}
        for p, wave in enumerate(waves[1:], 1):
            known |= {Mode("sigma", p): 2 * wave.real, Mode("sigma", p, "sin"): -2 * wave.imag}
        return self.packed(known)

    def _tube(self, q: Array, multipliers: Array) -> Equilibrium:
        """The tube as ``tube.spectrum`` takes it, for gradients and Hessians."""
        fields = self.waves.state(self.cell, q)
        return Equilibrium(self.cell, fields, 0.0, self.c0, float(multipliers[0]), self._lambda2(multipliers))

    def _shape(self, q: Array) -> Equilibrium:
        """The same for areas, volumes and normal displacements alone, without what only the energy and gradients need."""
        return Equilibrium(self.cell, self.waves.state(self.cell, q, range(4)), 0.0, self.c0, 0.0, 0.0)

    def _lambda2(self, multipliers: Array) -> float:
        return float(multipliers[1]) if self.law != "area" else self.pressure

    def _motion(self, tube: Equilibrium, rate: Array) -> tuple[Array, Array]:
        """Displacements in the plane, shape (2, K), and the outward normal velocity, shape (K,)."""
        moved = self.waves.displacement(self.cell, rate)
        return moved, (tube.outward * moved).sum(axis=0) / tube.areas[0]

    def _force(self, tube: Equilibrium, speed: Array) -> Array:
        """Mean of a normal velocity times each mode's normal displacement, shape (N,)."""
        return self.waves.pushed(self.cell, self.cell.transform(tube.outward * speed))

    def energy(self, q: Array) -> float:
        """By the straight tube's area; infinite where a section closes."""
        tube = self._tube(q, np.zeros(2))
        return math.inf if _pinched(tube) else tube.means[0]

    def residual(self, q: Array, rate: Array, multipliers: Array) -> Array:
        """``M q_t + grad F``: the mean of ``V_t`` times each mode's normal displacement, plus the gradient.

        In the ``H^-1`` flow the mean of the potential ``g`` with ``-Lap g = V_t`` in place of ``V_t``.
        """
        tube = self._tube(q, multipliers)
        if _pinched(tube):
            return np.full_like(q, np.nan)
        moved = self._force(tube, self._motion(tube, rate)[1])
        if self.law == "diffusion":
            moved = self._force(tube, self._motion(tube, self._potential(tube, moved))[1])
        return moved + tube.force(self.waves)

    def _potential(self, tube: Equilibrium, moved: Array) -> Array:
        """Normal displacements ``g`` with ``-Lap g = V_t``, as a rate is, of the means of ``V_t`` times those of the modes.

        By Galerkin's method. Constants, which the Laplacian does not see, are told by the mean of ``g``: it is that of ``V_t``,
        0 at fixed volume.
        """
        by_volume = tube.constraints(self.waves)[1]
        return np.asarray(cho_solve(cho_factor(tube.stiffness(self.waves) + np.outer(by_volume, by_volume)), moved))

    def _metric(self, tube: Equilibrium) -> Array:
        mass = tube.mass(self.waves)
        return mass @ self._potential(tube, mass) if self.law == "diffusion" else mass

    def _drag(self, tube: Equilibrium, rate: Array, factor: float) -> MatrixTransform:
        """Second derivatives of the drag: by displacements, ``factor`` times, and by a displacement and a field."""
        (element, slopes), (moved, speed) = tube.areas, self._motion(tube, rate)
        of_speed = -speed * slopes  # its derivatives by the fields a_0, a_1, b_0, b_1, times the area element
        of_speed[2:] += -moved[1], moved[0]
        mixed = tube.outward[:, None] * of_speed / element
        mixed[0, 3] += speed
        mixed[1, 2] -= speed
        weights = np.zeros((len(element), 6, 6))
        weights[:, :2, :2] = (factor * tube.outward[:, None] * tube.outward / element).transpose(2, 0, 1)
        weights[:, :2, 2:], weights[:, 2:, :2] = mixed.transpose(2, 0, 1), mixed.transpose(2, 1, 0)
        return matrix_transform(self.cell, weights, IMAGINARY_DRAGS)

    def jacobian(self, q: Array, rate: Array, multipliers: Array, factor: float) -> Array:
        """Exact derivative of ``residual``; in the ``H^-1`` flow without the metric's own change, as ``flows.mesh`` has it."""
        tube = self._tube(q, multipliers)
        matrix = tube.hessian(self.waves)
        if self.law == "diffusion":
            return matrix + factor * self._metric(tube)
        if factor or rate.any():
            drag = self._drag(tube, rate, factor)
            matrix += self.waves.waves.dragging(self.cell, drag, Families.of(self.waves))[0]
        return matrix

    def columns(self, q: Array) -> Array:
        """Gradients of what the flow keeps, as columns."""
        return self.constraint_rows(q).T

    def constraints(self, q: Array) -> Array:
        """Area, or area and volume, of the straight tube's area."""
        tube = self._shape(q)
        area = np.nan if _pinched(tube) else tube.area
        return np.array([area, tube.volume] if self.law != "area" else [area])

    def constraint_rows(self, q: Array) -> Array:
        """Their derivatives."""
        rows = self._shape(q).constraints(self.waves)
        return np.array(rows if self.law != "area" else rows[:1])

    def metric(self, q: Array) -> Array:
        """Mean products of normal displacements, or in the ``H^-1`` flow of their potentials' gradients."""
        return self._metric(self._tube(q, np.zeros(2)))

    def moved_by(self, q: Array, speed: Array) -> Array:
        """The rate whose normal velocity is nearest to given speeds, in ``L^2`` of the surface."""
        shape = self._shape(q)
        return np.asarray(np.linalg.solve(shape.mass(self.waves), self._force(shape, speed)))

    def velocity(self, q: Array, rate: Array) -> Array:
        """Outward normal velocity at the grid's points."""
        return self._motion(self._shape(q), rate)[1]

    def places(self, q: Array) -> tuple[Array, Array]:
        """``x`` of the grid's points, and their polar angles about the axis, not about their section's centre."""
        x, phi = self._points
        moved = self.waves.displacement(self.cell, q)
        return x, phi + np.arctan2(moved[1], moved[0])

    def resistance(self, q: Array, force: Array) -> Array:
        """The metric's inverse on a force."""
        return np.asarray(np.linalg.solve(self.metric(q), force))

    def equilibrium(self, q: Array, multipliers: Array) -> tuple[TubeFlow, Array]:
        """This problem itself."""
        return self, multipliers

    def kernels(self, q: Array, multipliers: Array) -> Array:
        """Shifts in ``y``, ``z`` and ``x``, and the turn about the axis."""
        return np.array(rigid_motions(self.known(q), self.modes, 0))

    def growth_rates(self, q: Array, multipliers: Array, count: int = 6) -> tuple[Array, Array]:
        """Growth rates of all perturbations in these modes."""
        tube = self._tube(q, multipliers)
        return growth_rates(
            tube.hessian(self.waves), self._metric(tube), self.constraint_rows(q), self.kernels(q, multipliers), count
        )

    def observables(self, q: Array, multipliers: Array) -> dict[str, float]:
        """Energy by area, multipliers, reduced volume; radii are measured from the sections' centres."""
        tube = self._tube(q, multipliers)
        energy, area, volume = tube.means
        along, around = self.size
        thin, thick = extremes(self.waves, Cell(1, 1, (2 * along + 2, 2 * around + 2)), q)
        return {
            "lambda1": float(multipliers[0]), "lambda2": self._lambda2(multipliers), "E": energy / area,
            "area": area, "volume": volume, "v": 2 * volume, "amplitude": (thick - thin) / 2, "r_min": thin,
            "r_max": thick, "c0": self.c0, "L": self.length, "M": 2 * math.pi * self.length * tube.curvature,
        }  # fmt: skip

    def trouble(self, q: Array) -> Trouble | None:
        """A section that closes on its centre, or a surface about to stand across the axis."""
        z = self.waves.state(self.cell, q, range(4))
        slope = np.abs(z[0] * z[3] - z[1] * z[2]) / np.hypot(z[2], z[3])
        thin, steep = int(z[3].argmin()), int(slope.argmax())
        if z[3, thin] < THINNEST:
            where = Sentence("the section at x = {x:.4g}, phi = {phi:.3f} closes on its centre", **self._place(thin))
            return Trouble("pinch", where, "stop before, or change the volume")
        if slope[steep] > STEEPEST:
            text = "the surface at x = {x:.4g}, phi = {phi:.3f} has slope {slope:.0f} against the axis"
            where = Sentence(text, slope=slope[steep], **self._place(steep))
            advice = "sections across the axis no longer describe it; use a triangulated tube"
            return Trouble("overhang", where, advice)
        return None

    def _place(self, point: int) -> dict[str, float]:
        """Where a grid point is, for a ``Sentence``."""
        x, phi = self._points
        return {"x": x[point], "phi": phi[point]}

    def _tails(self, q: Array) -> tuple[float, float]:
        """Largest coefficients among the last sixth of the wave numbers, along and around."""
        size, (p, b), (along, around) = np.abs(q), self._numbers, self.size
        return float(size[p > 5 * along // 6].max()), float(size[b > 5 * around // 6].max())

    @property
    def space(self) -> str:
        """What it describes."""
        return "tubes of all symmetries"

    @property
    def creeps(self) -> bool:
        """Products of Fourier functions are shifted and turned exactly."""
        return False

    @property
    def wanted_resolution(self) -> float:
        """Spectral: the energy is then good to ten digits."""
        return 1e-5

    def resolution(self, q: Array) -> float:
        """The larger of the tails' coefficients."""
        return max(self._tails(q))

    def refined(self, q: Array) -> tuple[TubeFlow, Array] | None:
        """A third more waves in the directions whose tail is not much smaller than the other's."""
        tails = self._tails(q)
        size = tuple(
            s + max(2, s // 3) if tail > 0.01 * max(tails) else s for s, tail in zip(self.size, tails, strict=True)
        )
        if (2 * size[0] + 1) * (2 * size[1] + 1) > MOST_MODES:
            return None
        finer = replace(self, size=(size[0], size[1]))
        return finer, finer.packed(self.known(q))

    def remeshed(self, q: Array) -> None:
        """Modes fit as long as sections are star-shaped."""

    def surface(self, q: Array, along: int = 161, around: int = 49) -> tuple[Array, Array, Array]:
        """Points to draw: ``x, y, z``, each of shape (along, around), closed around."""
        x, phi = np.linspace(-self.length / 2, self.length / 2, along), np.linspace(0, 2 * np.pi, around)
        curve = sections(self.known(q), 2 * np.pi / self.length, 0.0, x, phi)
        return np.repeat(x[:, None], around, axis=1), curve.real, curve.imag

    def to_tree(self) -> dict[str, Any]:
        """Everything as numbers and words."""
        return {
            "kind": "tube", "c0": self.c0, "length": self.length, "along": self.size[0], "around": self.size[1],
            "law": self.law, "pressure": self.pressure,
        }  # fmt: skip

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> TubeFlow:
        """The inverse of ``to_tree``."""
        law = str(tree["law"])
        if law not in get_args(Law):
            raise ValueError(f"law: {law!r} is none of {get_args(Law)}")
        size = int(tree["along"]), int(tree["around"])
        return cls(float(tree["c0"]), float(tree["length"]), size, law, float(tree["pressure"]))  # type: ignore[arg-type]


def _pinched(tube: Equilibrium) -> bool:
    """Whether a section is not star-shaped about its centre."""
    return bool(tube.fields[3].min() <= 0)
