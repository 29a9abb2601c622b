"""Flow of tubes without any symmetry, in reduced modes: ``P(x, phi) = d(x) + sigma(x, phi) e^{i phi}`` (design, §7).

The unknowns are all products of a Fourier function along the tube and a function around it (waves of ``sigma`` without the
first, and the two coordinates of the centre ``d``): a matrix ``Q`` of coefficients. Each of the ten fields of
``tube.density`` is a derivative of one order along ``x`` of such a sum, so fields, gradients and Hessians are products of
small matrices, one way after the other: a Hessian of ``N`` modes costs some ``N^2`` times the points in one direction, not in
both (S. A. Orszag, J. Comput. Phys. 37 (1980) 70).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, get_args

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError
from pearlbvp.flow.problem import Law, Trouble, check_law
from pearlbvp.flow.spectrum import growth_rates
from pearlbvp.flow.tensor import DISPLACEMENT, FIELDS, Tensor
from pearlbvp.representation import brief
from pearlbvp.tube.density import gradients, hessians
from pearlbvp.tube.extremes import extremes
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.torus import TorusFunction
from pearlbvp.tube.waves import Cell, ModeWaves
from pearlbvp.units import Sentence

THINNEST, STEEPEST = 1e-2, 20.0
"""Radius of a section about its centre, and slope of the surface against the axis, beyond which these modes are left."""

MOST_MODES = 2500


@dataclass(frozen=True)
class TubeFlow:
    """Tubes in reduced modes; ``q`` holds ``Q`` row by row: functions of ``x``, then of ``phi`` (``Tensor``).

    Attributes:
        c0, length: the tube's.
        size: largest wave numbers along and around.
        law: what the flow keeps: area and volume, or the area.
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
            raise InputError(f"size: {along},{around} waves along and around are too few; give at least 1,2")
        count = (2 * along + 1) * (2 * around + 1)
        if count > MOST_MODES:
            raise InputError(
                f"size: {along},{around} waves along and around are {count} functions, more than {MOST_MODES}; "
                "give fewer, like 24,24 or 60,9"
            )

    @cached_property
    def tensor(self) -> Tensor:
        """The functions on their grid."""
        return Tensor.of(self.size, self.length)

    @cached_property
    def modes(self) -> tuple[Mode, ...]:
        """The modes whose coefficients ``q`` holds, as ``tube.modes`` has them."""
        return self.tensor.modes

    @cached_property
    def _cell(self) -> tuple[ModeWaves, Cell]:
        """The modes as waves, and the period they live on, with points for its extremes."""
        (waves,) = ModeWaves.of(self.tensor.k, 0.0, self.modes)
        return waves, Cell(1, 1, (2 * self.size[0] + 2, 2 * self.size[1] + 2))

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
                f"kappa: a frame that turns {kappa / unit:.6g} times on L = {self.length:g} does not fit it; give a multiple "
                "of 2 pi/L"
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
        matrix = np.zeros(self.tensor.shape)
        column = self.tensor.column("sigma", 0, "cos")
        matrix[0, column] = waves[0].real
        for p in range(1, min(self.size[0], len(waves) - 1) + 1):
            matrix[self.tensor.row(p, "cos"), column] = 2 * waves[p].real
            matrix[self.tensor.row(p, "sin"), column] = -2 * waves[p].imag
        return matrix.ravel()

    def _matrix(self, q: Array) -> Array:
        return q.reshape(self.tensor.shape)

    def _fields(self, q: Array) -> Array:
        """The ten fields, shape (10, K)."""
        return self.tensor.values(self._matrix(q), FIELDS)

    def _lambda2(self, multipliers: Array) -> float:
        return float(multipliers[1]) if self.law == "area and volume" else self.pressure

    def _variations(self, z: Array) -> tuple[Array, Array]:
        """Energy, area and volume (3,), and their gradients (3, N), at given fields."""
        values, slopes = gradients(z, self.c0)
        by_volume = np.zeros_like(z)
        by_volume[3] = z[3]  # the volume is the mean of sigma^2/2, and sigma is the field b_1
        rows = [self.tensor.adjoint(slope, FIELDS).ravel() for slope in (slopes[0], slopes[1], by_volume)]
        return np.append(values.mean(axis=1), (z[3] @ z[3]) / (2 * z.shape[1])), np.array(rows)

    def _motion(self, z: Array, rate: Array) -> tuple[Array, Array, Array]:
        """Displacements in the plane (2, K), outward normal velocity times ``sqrt(g)``, and ``g``, shape (K,)."""
        moved = self.tensor.values(self._matrix(rate), DISPLACEMENT)
        return moved, moved[0] * z[3] - moved[1] * z[2], _g(z)

    def residual(self, q: Array, rate: Array, multipliers: Array) -> Array:
        """``M q_t + grad F``: the mean of ``V_t`` times each mode's normal displacement, plus the gradient."""
        z = self._fields(q)
        if z[3].min() <= 0:  # a section that is not star-shaped about its centre
            return np.full_like(q, np.nan)
        _, rows = self._variations(z)
        _, normal, g = self._motion(z, rate)
        weighted = normal / np.sqrt(g)
        moving = self.tensor.adjoint(np.array((z[3] * weighted, -z[2] * weighted)), DISPLACEMENT).ravel()
        return np.asarray(moving + rows[0] + multipliers[0] * rows[1] + self._lambda2(multipliers) * rows[2])

    def _second(self, z: Array, lambda1: float, lambda2: float) -> Array:
        """Second variation of ``F``, shape (N, N)."""
        second = hessians(z, self.c0, lambda1)
        second[:, 3, 3] += lambda2
        return self.tensor.sandwich(second, FIELDS, FIELDS)

    def _mass(self, z: Array, factor: float = 1.0) -> Array:
        """``factor`` times the metric, as coefficients between displacements, shape (K, 2, 2)."""
        outward = np.array((z[3], -z[2]))
        return np.asarray(factor * np.einsum("ik,jk->kij", outward, outward) / np.sqrt(_g(z))[:, None, None])

    def jacobian(self, q: Array, rate: Array, multipliers: Array, factor: float) -> Array:
        """Exact derivative of ``residual``."""
        z = self._fields(q)
        matrix = self._second(z, float(multipliers[0]), self._lambda2(multipliers))
        if factor:
            matrix += self.tensor.sandwich(self._mass(z, factor), DISPLACEMENT, DISPLACEMENT)
        if not rate.any():
            return matrix
        (m0, m1), normal, g = self._motion(z, rate)
        a0, a1, b0, b1 = z[:4]
        c, root = a0 * b1 - a1 * b0, np.sqrt(g)
        # W = normal/sqrt(g) by a_0, a_1, b_0, b_1; then b_1 W and -b_0 W by them.
        by_g = -normal / (2 * g * root)
        of_w = (2 * by_g * c * b1, -2 * by_g * c * b0,
                by_g * (2 * b0 - 2 * c * a1) - m1 / root, by_g * (2 * b1 + 2 * c * a0) + m0 / root)  # fmt: skip
        changed = np.zeros((len(g), 2, 4))
        for i, slope in enumerate(of_w):
            changed[:, 0, i], changed[:, 1, i] = b1 * slope, -b0 * slope
        changed[:, 0, 3] += normal / root
        changed[:, 1, 2] -= normal / root
        return np.asarray(matrix + self.tensor.sandwich(changed, DISPLACEMENT, FIELDS[:4]))

    def columns(self, q: Array) -> Array:
        """Gradients of what the flow keeps, as columns."""
        return self.constraint_rows(q).T

    def constraints(self, q: Array) -> Array:
        """Area, or area and volume, of the straight tube's area."""
        z = self._fields(q)
        area = np.sqrt(_g(z)).mean() if z[3].min() > 0 else np.nan
        volume = (z[3] @ z[3]) / (2 * z.shape[1])
        return np.array([area, volume] if self.law == "area and volume" else [area])

    def constraint_rows(self, q: Array) -> Array:
        """Their derivatives."""
        z = self._fields(q)
        root, c = np.sqrt(_g(z)), z[0] * z[3] - z[1] * z[2]
        by_area = np.array((c * z[3], -c * z[2], z[2] - c * z[1], z[3] + c * z[0])) / root
        rows = [self.tensor.adjoint(by_area, FIELDS[:4]).ravel()]
        if self.law == "area and volume":
            rows.append(self.tensor.adjoint(z[3:4], FIELDS[3:4]).ravel())
        return np.array(rows)

    def metric(self, q: Array) -> Array:
        """Mean products of normal displacements."""
        return self.tensor.sandwich(self._mass(self._fields(q)), DISPLACEMENT, DISPLACEMENT)

    def moved_by(self, q: Array, speed: Array) -> Array:
        """The rate whose normal velocity is nearest to given speeds, in ``L^2`` of the surface."""
        z = self._fields(q)
        force = self.tensor.adjoint(np.array((z[3] * speed, -z[2] * speed)), DISPLACEMENT).ravel()
        return np.asarray(np.linalg.solve(self.metric(q), force))

    def velocity(self, q: Array, rate: Array) -> Array:
        """Outward normal velocity at the grid's points."""
        _, normal, g = self._motion(self._fields(q), rate)
        return np.asarray(normal / np.sqrt(g))

    def places(self, q: Array) -> tuple[Array, Array]:
        """``x`` of the grid's points, and their polar angles about the axis, not about their section's centre."""
        moved = self.tensor.values(self._matrix(q), DISPLACEMENT)
        return self.tensor.x, self.tensor.phi + np.arctan2(moved[1], moved[0])

    def resistance(self, q: Array, force: Array) -> Array:
        """The metric's inverse on a force."""
        return np.asarray(np.linalg.solve(self.metric(q), force))

    def equilibrium(self, q: Array, multipliers: Array) -> tuple[TubeFlow, Array]:
        """This problem itself."""
        return self, multipliers

    def kernels(self, q: Array, multipliers: Array) -> Array:
        """Shifts in ``y``, ``z`` and ``x``, and the turn about the axis."""
        matrix = self._matrix(q)
        found = np.zeros((4, *matrix.shape))
        y, z = self.tensor.column("y", 0, "cos"), self.tensor.column("z", 0, "cos")
        found[0, 0, y] = found[1, 0, z] = 1.0
        found[2] = self.tensor.along(matrix)
        found[3] = -self.tensor.around(matrix)  # the section turned by an angle: i d, and -sigma_phi
        found[3, :, y], found[3, :, z] = -matrix[:, z], matrix[:, y]
        return found.reshape(4, -1)

    def growth_rates(self, q: Array, multipliers: Array, count: int = 6) -> tuple[Array, Array]:
        """Growth rates of all perturbations in these modes."""
        second = self._second(self._fields(q), float(multipliers[0]), self._lambda2(multipliers))
        return growth_rates(second, self.metric(q), self.constraint_rows(q), self.kernels(q, multipliers), count)

    def observables(self, q: Array, multipliers: Array) -> dict[str, float]:
        """Energy by area, multipliers, reduced volume; radii are measured from the sections' centres."""
        z = self._fields(q)
        energy, area = gradients(z, self.c0)[0].mean(axis=1)
        volume = float(z[3] @ z[3]) / (2 * z.shape[1])
        thin, thick = extremes(*self._cell, q)
        return {
            "lambda1": float(multipliers[0]), "lambda2": self._lambda2(multipliers), "E": float(energy / area),
            "area": float(area), "volume": volume, "v": 2 * volume, "amplitude": (thick - thin) / 2, "r_min": thin,
            "r_max": thick,
        }  # fmt: skip

    def trouble(self, q: Array) -> Trouble | None:
        """A section that closes on its centre, or a surface about to stand across the axis."""
        z = self._fields(q)
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
        return {"x": self.tensor.x[point], "phi": self.tensor.phi[point]}

    def _tails(self, q: Array) -> tuple[float, float]:
        """Largest coefficients among the last sixth of the wave numbers, along and around."""
        matrix = np.abs(self._matrix(q))
        along, around = self.tensor.waves
        late = [np.maximum(5 * size // 6, 1) for size in self.size]
        return float(matrix[along > late[0]].max()), float(matrix[:, around > late[1]].max())

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
        moved = Tensor.at(self.size, self.length, x, phi).values(self._matrix(q), DISPLACEMENT)
        curve = (moved[0] + 1j * moved[1]).reshape(along, around) * np.exp(1j * phi)
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


def _g(z: Array) -> Array:
    """Square of the area element at given fields."""
    return np.asarray(z[2] ** 2 + z[3] ** 2 + (z[0] * z[3] - z[1] * z[2]) ** 2)
