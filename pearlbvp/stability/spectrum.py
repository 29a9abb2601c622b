"""All perturbations that fit a tube of several periods: growth rates by symmetry block, and how many are unstable.

A block is an azimuthal number ``n``, a Bloch number ``j`` (``theta = 2 pi j / cells``) and, where the profile has planes
of reflection and ``theta`` is 0 or pi, a parity about the belly. Translations are exact kernels; they are known in closed
form, removed by projection, and their residual says whether the profile and the points resolve the spectrum.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from pearlbvp.collocation.scheme import Array
from pearlbvp.errors import SpectrumError
from pearlbvp.representation import brief
from pearlbvp.stability.bloch import Fixed, SecondVariation, isothermal_points, restrict
from pearlbvp.stability.profile import Profile


class Block(NamedTuple):
    """A symmetry block of perturbations of ``cells`` periods: ``e^{i n phi}``, phase ``2 pi j / cells`` a period."""

    n: int
    j: int
    cells: int
    parity: str | None

    @property
    def theta(self) -> float:
        """Phase per period, exactly pi where it is."""
        return math.pi if 2 * self.j == self.cells else 2 * math.pi * self.j / self.cells

    @property
    def multiplicity(self) -> int:
        """How often each growth rate occurs: two directions around the tube, two along it."""
        return (1 if self.n == 0 else 2) * (1 if self.theta in (0.0, math.pi) else 2)

    def __str__(self) -> str:
        return f"n={self.n} j={self.j}/{self.cells}" + (f" {self.parity}" if self.parity else "")


def blocks_of(cells: int, n: int, symmetric: bool) -> list[Block]:
    """All blocks of an azimuthal number on a tube of ``cells`` periods; ``j`` and ``cells - j`` are one block."""
    blocks = []
    for j in range(cells // 2 + 1):
        parities = ("even", "odd") if symmetric and (j == 0 or 2 * j == cells) else (None,)
        blocks += [Block(n, j, cells, parity) for parity in parities]
    return blocks


def _kernel(variation: SecondVariation, block: Block) -> Array | None:
    """The translation in a block, as ``r w`` at its points: along the axis ``-sin psi``, across it ``cos psi``."""
    if block.j != 0:
        return None
    if block.n == 0 and block.parity != "even":
        return variation.r * np.sin(variation.psi)
    if block.n == 1 and block.parity != "odd":
        return variation.r * np.cos(variation.psi)
    return None


def kernel_residual(matrix: NDArray[Any], kernel: Array) -> float:
    """Size of ``(matrix - shift)^{-1} matrix kernel``: the error of a unit kernel vector, in the units of growth rates.

    The plain residual would be that of a fourth derivative, in which the rounding of the profile drowns everything else.
    """
    shift = 1 + max(0.0, float(np.linalg.eigvalsh(matrix)[-1]))
    defect = matrix @ kernel
    return float(np.linalg.norm(np.linalg.solve(matrix - shift * np.eye(len(matrix)), defect)))


def block_rates(variation: SecondVariation, block: Block, fixed: Fixed = "area and volume") -> tuple[Array, float]:
    """Growth rates of a block without its exact kernel, largest first, and how well that kernel is one.

    Returns:
        The rates, and how far the exact kernel is from one (0 where there is none); see ``kernel_residual``.
    """
    matrix = variation.matrix(block.n, block.theta, block.parity)
    size = len(matrix)
    normals = []
    residual = 0.0
    kernel = _kernel(variation, block)
    if kernel is not None and np.abs(kernel).max() > 1e-6:
        kernel = kernel[:size] / np.linalg.norm(kernel[:size])
        residual = kernel_residual(matrix, kernel)
        normals.append(kernel)
    if block.n == 0 and block.j == 0 and block.parity != "odd" and fixed != "nothing":
        normals.append(variation.h[:size] * variation.r[:size])
        if fixed == "area and volume":
            normals.append(variation.r[:size])
    if normals:
        matrix = restrict(matrix, np.column_stack(normals))
    return np.asarray(np.linalg.eigvalsh(matrix)[::-1]), residual


@dataclass(frozen=True)
class Spectrum:
    """The leading growth rates of all blocks that can be unstable.

    Attributes:
        rates: largest growth rates of each block, largest first.
        residual: largest residual of an exact kernel: how well the spectrum is resolved.
        points: Fourier points of a period.
        complete: whether all unstable waves are among them; else more wind around the tube than were looked at.
    """

    __repr__ = brief

    rates: dict[Any, Array]
    residual: float
    points: int
    complete: bool = True
    block: ClassVar[Any] = Block
    """What the blocks are: three whole numbers and a parity."""

    @property
    def neutral(self) -> float:
        """Growth rates of this size are zero to the accuracy of the spectrum: its kernels', and rounding."""
        largest = float(np.abs(np.concatenate([[0.0], *self.rates.values()])).max())
        return 1e-8 + ROUNDING * largest + 10 * self.residual

    @property
    def n_unstable(self) -> int:
        """Dimension of the unstable space; at a branch point its neutral perturbation is not counted."""
        zero = self.neutral  # it takes a look at all blocks, of which there may be thousands
        return sum(block.multiplicity * int(np.count_nonzero(rates > zero)) for block, rates in self.rates.items())

    def to_tree(self) -> dict[str, Any]:
        """Everything as arrays and numbers, to be saved."""
        parities = {None: 0, "even": 1, "odd": 2}
        return {
            "blocks": np.array([(*b[:3], parities[b.parity]) for b in self.rates], dtype=np.int64),
            "rates": np.concatenate(list(self.rates.values())),
            "sizes": np.array([len(rates) for rates in self.rates.values()], dtype=np.int64),
            "complete": self.complete,
            "residual": self.residual,
            "points": self.points,
        }

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> Self:
        """The inverse of ``to_tree``."""
        parities = (None, "even", "odd")
        blocks = [cls.block(*map(int, numbers), parities[parity]) for *numbers, parity in tree["blocks"]]
        pieces = np.split(np.asarray(tree["rates"], dtype=float), np.cumsum(tree["sizes"])[:-1])
        rates = dict(zip(blocks, pieces, strict=True))
        return cls(rates, float(tree["residual"]), int(tree["points"]), bool(tree["complete"]))

    @property
    def critical(self) -> Any:
        """The block of the largest growth rate."""
        return max(self.rates, key=lambda block: float(self.rates[block][0]))

    @property
    def mu_crit(self) -> float:
        """The largest growth rate, exact kernels left out."""
        return float(self.rates[self.critical][0])


MANY = 420
"""Fourier points of a period beyond which fewer are tried first than seven in each unit: their cubes are long to wait for."""

ROUNDING = 1e-12
"""Error of growth rates by the largest of them."""

_KEPT = 12
"""Growth rates kept of each block, besides the positive ones."""


def _sampled(profile: Profile, points: int) -> tuple[SecondVariation, float]:
    """The second variation on some points, and how far translations are from being its kernel."""
    variation = SecondVariation.of(profile, points)
    translations = [block for n in (0, 1) for block in blocks_of(1, n, profile.half)]
    return variation, max(block_rates(variation, block)[1] for block in translations)


def spectrum(
    profile: Profile,
    cells: int = 1,
    *,
    fixed: Fixed = "area and volume",
    tolerance: float = 1e-7,
    points: int | None = None,
    max_points: int | None = None,
    max_n: int = 64,
) -> Spectrum:
    """Growth rates of all perturbations of a tube of ``cells`` periods, over all ``n`` that matter.

    The number of Fourier points is doubled until the exact kernels are kernels to ``tolerance``, as long as that helps.
    Azimuthal numbers go up
    until, past ``n = 2``, all rates of one are negative and below those of the one before.

    Args:
        profile: one period, or half of it.
        cells: periods on the tube.
        fixed: what perturbations keep.
        tolerance: for the residual of the exact kernels.
        points: Fourier points of a period to begin with (``None``: seven in each unit of the isothermal coordinate, on long
            periods fewer).
        max_points: the most to go to (``None``: seven in each unit, and 768 at least); the result's ``residual`` says whether
            they sufficed.
        max_n: largest azimuthal number.

    Raises:
        SpectrumError: far more wind around the tube and grow.
    """
    length = isothermal_points(profile, 2)[1]
    seven = 2 * math.ceil(3.5 * length)
    if points is None:
        fastest = math.sqrt(
            3 + 2 * abs(profile.lambda2) + 2 * abs(1 - 2 * profile.c0)
        )  # that grows on the straight tube
        points = max(48, min(seven, max(MANY, 2 * math.ceil(length * max(1.25, fastest / 2)))))
    max_points = max(768, seven) if max_points is None else max_points
    variation, residual = _sampled(profile, points)
    while residual > tolerance and 2 * points <= max_points:
        finer, smaller = _sampled(profile, 2 * points)
        if smaller > residual / 2:  # rounding, or the profile itself, is what remains
            break
        variation, residual, points = finer, smaller, 2 * points
    if profile.lambda2 > (max_n + 1) ** 2:  # on the straight tube they grow beyond half of that
        raise SpectrumError(f"waves of more than n = {max_n} around the tube grow")
    rates: dict[Block, Array] = {}
    before = np.inf
    for n in range(max_n + 1):
        for block in blocks_of(cells, n, profile.half):
            found = block_rates(variation, block, fixed)[0]
            rates[block] = found[: _KEPT + int((found > 0).sum())]
        largest = max(float(rates[block][0]) for block in rates if block.n == n)
        if n >= 2 and largest < 0 and largest < before:
            return Spectrum(rates, residual, points)
        before = largest
    return Spectrum(rates, residual, points, complete=False)
