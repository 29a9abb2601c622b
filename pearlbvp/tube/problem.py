"""Rings, coils and buckles as sums of modes, as ``continuation`` takes them (design, §6 and §7).

Each family lives in the space of its symmetry, where its bifurcation is simple and nothing needs a phase condition:

- ``ring``: independent of ``x``, ``n``-fold, even in ``phi``;
- ``coil``: independent of ``x`` in a frame that turns once in ``L/m``, even in ``phi``;
- ``buckle``: even in ``x`` and ``phi``, invariant under a shift by half a wave both ways.

The unknown holds the modes' coefficients, then ``lambda1, lambda2, v``. Equations: the energy's gradient by the coefficients
with both constraints' multipliers, the area, the volume. All are exact derivatives of one trapezoidal sum.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from pearlbvp.collocation.scheme import Array
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.theory.amplitude import amplitude_equation
from pearlbvp.tube.density import gradients, hessians
from pearlbvp.tube.modes import Basis, Mode, grid
from pearlbvp.tube.spectrum import Fixed, Surface, TubeBlock, TubeSpectrum, block_rates

Family = Literal["ring", "coil", "buckle"]


@dataclass(frozen=True)
class TubeProblem:
    """A family of tubes on a number of modes: ``residual(u) = 0`` is a curve.

    Attributes:
        family: its symmetry.
        m, n: waves along and around the tube where it branches off.
        c0, length: the tube's.
        size: largest wave numbers along and around, in units of ``m`` waves and of ``n`` (of 1 where ``n = 1``).
        tolerance: of the smallest modes' coefficients, beyond which ``remesh`` takes more.
        fixed: what perturbations keep, for stability.
    """

    family: Family
    m: int
    n: int
    c0: float
    length: float
    size: tuple[int, int]
    tolerance: float = 1e-10
    fixed: Fixed = "area and volume"

    @cached_property
    def kappa(self) -> float:
        """Rate at which the frame turns."""
        return 2 * math.pi * self.m / self.length if self.family == "coil" else 0.0

    @property
    def k(self) -> float:
        """Unit of the wave numbers along the tube."""
        return 2 * math.pi * max(self.m, 1) / self.length

    @cached_property
    def modes(self) -> tuple[Mode, ...]:
        """The functions that solutions are sums of."""
        along = range(self.size[0] + 1) if self.family == "buckle" else (0,)
        glide = self.family == "buckle"
        found = [
            Mode("sigma", p, "cos", b * self.n)
            for p in along
            for b in range(self.size[1] + 1)
            if b * self.n != 1 and not (glide and (p + b) % 2)
        ]
        if self.n == 1:
            found += [Mode("y", p) for p in along if not (glide and p % 2 == 0)]
        return tuple(found)

    def _points(self) -> tuple[int, int]:
        """Points of the trapezoidal sum on a whole period: three times the largest wave number, for what is no product."""
        along = 4 * self.size[0] + 8 if self.family == "buckle" else 1
        return along, 4 * self.size[1] + 8

    @cached_property
    def basis(self) -> Basis:
        """The modes on a quarter of the period."""
        x, phi = grid(*self._points(), 2 * math.pi / self.k, 2 * math.pi / self.n, halved=True)
        return Basis.of(self.modes, self.k, self.kappa, x, phi)

    def coefficients(self, u: Array) -> Array:
        """Those of the modes, shape (N,)."""
        return u[:-3]

    def _gradients(self, u: Array) -> tuple[float, float, float, Array, Array, Array]:
        """Means of energy, area and volume by unit area of the cylinder, and their gradients."""
        state, fields = self.basis.state(u[:-3]), self.basis.fields
        values, slopes = gradients(state, self.c0)
        count = state.shape[1]
        energy, area = (np.tensordot(slope.T, fields, 2) / count for slope in slopes)
        return (
            values[0].mean(), values[1].mean(), float(state[3] @ state[3]) / (2 * count),
            energy, area, state[3] @ fields[:, 3] / count,
        )  # fmt: skip

    def residual(self, u: Array) -> Array:
        """The equations at ``u``, shape (N + 2,)."""
        _, area, volume, by_energy, by_area, by_volume = self._gradients(u)
        return np.concatenate((by_energy + u[-3] * by_area + u[-2] * by_volume, [area - 1, volume - u[-1] / 2]))

    def solve(self, u: Array, rhs: Array, row: Array | None = None) -> Array:
        """Bordered solve of the residual's Jacobian at ``u``; see ``Problem.solve``."""
        state, fields = self.basis.state(u[:-3]), self.basis.fields
        hessian = hessians(state, self.c0, u[-3])
        hessian[:, 3, 3] += u[-2]
        count, _, size = fields.shape
        second = fields.reshape(-1, size).T @ (hessian @ fields).reshape(-1, size) / count
        *_, by_area, by_volume = self._gradients(u)
        rows = np.zeros((0, u.size)) if row is None else np.atleast_2d(row) * self.weights
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
        return np.append(self.basis.norms(), np.ones(3))

    def inner(self, u: Array, v: Array) -> float:
        """Inner product that does not depend on the number of modes."""
        return float((u * self.weights) @ v)

    def observables(self, u: Array) -> dict[str, float]:
        """``lambda1, lambda2, v, E, amplitude, r_min, r_max, c0, L``; radii are measured from the sections' centres."""
        thin, thick = self._extremes(u)
        return {
            "lambda1": float(u[-3]), "lambda2": float(u[-2]), "v": float(u[-1]), "E": float(self._gradients(u)[0]),
            "amplitude": (thick - thin) / 2, "r_min": thin, "r_max": thick, "c0": self.c0, "L": self.length,
        }  # fmt: skip

    @cached_property
    def _fine(self) -> Array:
        """Values of the modes of ``sigma`` on a fine grid with the planes of symmetry, shape (points, N)."""
        along = np.linspace(0, np.pi / self.k, 33) if self.family == "buckle" else np.zeros(1)
        around = np.linspace(0, np.pi / self.n, 65 if self.family == "buckle" else 513)
        x, phi = (t.ravel() for t in np.meshgrid(along, around, indexing="ij"))
        return Basis.of(self.modes, self.k, self.kappa, x, phi).fields[:, 3]

    def _extremes(self, u: Array) -> tuple[float, float]:
        radii = self._fine @ u[:-3]
        return float(radii.min()), float(radii.max())

    def section(self, u: Array, x: float, points: int = 181) -> tuple[Array, Array]:
        """The cross-section at ``x`` as a closed curve in the plane: ``y`` and ``z``."""
        phi = np.linspace(0, 2 * math.pi, points)
        basis = Basis.of(self.modes, self.k, self.kappa, np.full(points, x), phi)
        moved = basis.displacement() @ u[:-3]  # turned by e^{-i(kappa x + phi)}
        curve = (moved[:, 0] + 1j * moved[:, 1]) * np.exp(1j * (self.kappa * x + phi))
        return curve.real, curve.imag

    def tail(self, u: Array) -> tuple[float, float]:
        """Largest coefficients among the last fifth of the wave numbers, along and around the tube."""
        coefficients = np.abs(u[:-3])
        tails = []
        for place, most in enumerate(self.size):
            wave = np.array([mode.p if place == 0 else mode.b / self.n for mode in self.modes])
            late = coefficients[(wave > 0.8 * most) & (wave > 0)]
            tails.append(float(late.max()) if len(late) else 0.0)
        return tails[0], tails[1]

    def remesh(self, u: Array, *others: Array) -> tuple[TubeProblem, list[Array]] | None:
        """The problem with more modes, where the last of them are not small; None where they are."""
        tails = self.tail(u)
        size = [s if tail <= self.tolerance else s + max(4, s // 4) for s, tail in zip(self.size, tails, strict=True)]
        most = MOST_MODES if self.family != "buckle" else MOST_MODES // 8
        size = [min(s, max(most, old)) for s, old in zip(size, self.size, strict=True)]
        if tuple(size) == self.size:
            return None
        larger = replace(self, size=(size[0], size[1]))
        return larger, [larger.adopt(self, vector) for vector in (u, *others)]

    def adopt(self, other: TubeProblem, u: Array) -> Array:
        """An unknown of another number of modes; those that it does not have are 0."""
        if other.size == self.size:
            return u
        known = dict(zip(other.modes, u[:-3], strict=True))
        return np.append([known.get(mode, 0.0) for mode in self.modes], u[-3:])

    @property
    def own_block(self) -> TubeBlock:
        """Perturbations that keep the symmetry of the family."""
        if self.family == "buckle":
            return TubeBlock("x even phi even" + (" 0" if self._glides else ""))
        return TubeBlock("j=0 even")

    @property
    def conserved(self) -> str:
        """What perturbations keep and the branch does not."""
        return "v" if self.fixed == "area and volume" else "lambda2"

    def poles(self, u: Array) -> Mapping[str, float]:
        """None: the multipliers of these families stay finite."""
        return {}

    @property
    def _glides(self) -> bool:
        """Whether perturbations split by the shift by half a wave both ways, too."""
        return self.family == "buckle" and self.m == 1 and self.n == 1

    def surface(self, u: Array, x: Array, phi: Array) -> Surface:
        """The solution on a grid."""
        base = Basis.of(self.modes, self.k, self.kappa, x, phi)
        return Surface(base.state(u[:-3]), self.c0, float(u[-3]), float(u[-2]))

    def _blocks(self, u: Array) -> list[tuple[TubeBlock, tuple[Mode, ...], bool]]:
        """All blocks, their modes, and whether area and volume change in them at first order.

        Wave numbers along the tube in units of ``2 pi/L``. Around it all harmonics up to a third more than the solution's.
        """
        most = max(8, (4 * self.n * self.size[1]) // 3)
        around = [b for b in range(most + 1) if b != 1]
        if self.family == "buckle":
            return self._buckle_blocks(around)
        even = lambda j: (Mode("y", j, "exp"), *(Mode("sigma", j, "exp", b) for b in around))  # noqa: E731
        odd = lambda j: (Mode("z", j, "exp"), *(Mode("sigma", j, "exp", b, "sin") for b in around if b))  # noqa: E731
        blocks = []
        # On the cylinder nothing grows beyond k^2 = 3 + 2 |lambda2| + 2 |1 - 2 c0|; deformed shapes get some room.
        largest = math.sqrt(3 + 2 * abs(u[-2]) + 2 * abs(1 - 2 * self.c0))
        for j in range(math.ceil(1.25 * largest * self.length / (2 * math.pi)) + self.m + 1):
            count = 1 if j == 0 else 2
            if self.family == "coil" and j:  # a helix mixes both parities
                blocks.append((TubeBlock(f"j={j}", count), even(j) + odd(j), False))
            else:
                blocks.append((TubeBlock(f"j={j} even", count), even(j), j == 0))
                blocks.append((TubeBlock(f"j={j} odd", count), odd(j), False))
        return blocks

    def _buckle_blocks(self, around: list[int]) -> list[tuple[TubeBlock, tuple[Mode, ...], bool]]:
        waves = range(self.m * (self.size[0] + 2) + 1)
        blocks = []
        for along in ("cos", "sin"):
            for centre, trig in (("y", "cos"), ("z", "sin")):
                modes = [Mode(centre, p, along) for p in waves if p or along == "cos"]  # type: ignore[arg-type]
                modes += [
                    Mode("sigma", p, along, b, trig)
                    for p in waves
                    for b in around
                    if (p or along == "cos") and (b or trig == "cos")
                ]
                name = f"x {'even' if along == 'cos' else 'odd'} phi {'even' if trig == 'cos' else 'odd'}"
                for part in (0, 1) if self._glides else (None,):
                    of = tuple(
                        mode for mode in modes
                        if part is None or (mode.p + (mode.b if mode.part == "sigma" else 1)) % 2 == part
                    )  # fmt: skip
                    symmetric = along == trig == "cos" and part in (0, None)
                    blocks.append((TubeBlock(name + ("" if part is None else f" {part}")), of, symmetric))
        return blocks

    def _rigid(self, u: Array, modes: tuple[Mode, ...]) -> list[Array]:
        """Rigid motions in a block's modes: shifts of the axis, rotation about it, and the shift along it."""
        known = {
            (mode.part, mode.p * max(self.m, 1), mode.b): value for mode, value in zip(self.modes, u[:-3], strict=True)
        }
        j = modes[0].p
        found = []
        # In the turning frame of a coil a shift across the axis is the wave e^{-i kappa x}, which has j = m; rings have m = 0.
        if j == self.m or self.family == "buckle":
            shift = np.zeros(len(modes), dtype=complex)
            for i, mode in enumerate(modes):
                if mode.part != "sigma" and (self.family == "coil" or mode.p == 0):
                    shift[i] = 1.0 if mode.part == "y" else 1j if self.family == "coil" else 1.0
            found.append(shift)
        if self.family != "buckle" and j:
            return [vector for vector in found if np.abs(vector).max() > 0]
        turn, along = np.zeros(len(modes)), np.zeros(len(modes))
        for i, mode in enumerate(modes):
            if mode.along != "sin" and mode.part == "z":  # i d
                turn[i] = known.get(("y", mode.p, 0), 0.0)
            if mode.along != "sin" and mode.part == "sigma" and mode.around == "sin":  # -sigma_phi
                turn[i] = mode.b * known.get(("sigma", mode.p, mode.b), 0.0)
            if mode.along == "sin" and mode.around == "cos" and mode.part != "z":  # d/dx
                along[i] = -mode.p * known.get((mode.part, mode.p, mode.b), 0.0)
        return [vector for vector in (*found, turn, along) if np.abs(vector).max() > 1e-12]

    def _rates(
        self, u: Array, block: tuple[TubeBlock, tuple[Mode, ...], bool], surface: Surface
    ) -> tuple[Array, float]:
        _, modes, constrained = block
        x, phi = self._grid
        basis = Basis.of(modes, 2 * math.pi / self.length, self.kappa, x, phi)
        return block_rates(surface, basis, self._rigid(u, modes), self.fixed, constrained)

    @cached_property
    def _grid(self) -> tuple[Array, Array]:
        """Points on which perturbations are integrated."""
        along, around = self._points()
        buckle = self.family == "buckle"
        return grid(along * self.m if buckle else 1, around * self.n, self.length, 2 * math.pi, halved=buckle)

    def spectrum(self, u: Array) -> TubeSpectrum:
        """Growth rates of all perturbations that fit the tube."""
        surface = self.surface(u, *self._grid)
        rates, kernel = {}, 0.0
        for block in self._blocks(u):
            rates[block[0]], error = self._rates(u, block, surface)
            kernel = max(kernel, error)
        return TubeSpectrum(rates, kernel)

    def block_rates(self, u: Array, block: TubeBlock, like: TubeSpectrum) -> Array:
        """Growth rates in one block."""
        chosen = next(entry for entry in self._blocks(u) if entry[0] == block)
        return self._rates(u, chosen, self.surface(u, *self._grid))[0]


MOST_MODES = 256
"""Largest wave number of rings and coils; buckles have an eighth of it each way."""


def onset(
    tube: Tube, family: Family, m: int, n: int, *, size: tuple[int, int] | None = None, fixed: Fixed = "area and volume"
) -> tuple[TubeProblem, Array, Array]:
    """The straight tube where a family branches off, and the direction in which it does.

    Args:
        tube: the straight tube.
        family: of the branch.
        m, n: waves along and around the tube.
        size: largest wave numbers at first; more are taken where needed.
        fixed: what perturbations keep, for stability.

    Raises:
        InputError: the family does not branch off at that mode, or is not built for it.
    """
    equation = amplitude_equation(tube, (m, n))
    equation.cubic(family)  # refuses a family that does not branch off there
    if family == "coil" and n > 1:
        raise InputError(f"mode: coils with n = {n} are not built yet; give n = 1")
    size = size or ((8, 8) if family == "buckle" else (0, 16))
    problem = TubeProblem(family, m, n, tube.c0, tube.length, size, fixed=fixed)
    u, direction = np.zeros(len(problem.modes) + 3), np.zeros(len(problem.modes) + 3)
    u[problem.modes.index(Mode("sigma", 0))] = 1.0
    u[-3:] = equation.lambda1, equation.lambda2, 1.0
    wave = 1 if family == "buckle" else 0
    direction[problem.modes.index(Mode("y", wave) if n == 1 else Mode("sigma", wave, "cos", n))] = 1.0
    return problem, u, direction
