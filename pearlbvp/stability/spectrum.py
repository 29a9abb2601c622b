"""All perturbations that fit a tube of several periods: growth rates by symmetry block, and how many are unstable.

A block is an azimuthal number ``n``, a Bloch number ``j`` (``theta = 2 pi j / cells``) and, where the profile has planes
of reflection and ``theta`` is 0 or pi, a parity about the belly. Translations are exact kernels; they are known in closed
form, removed by projection, and their residual says whether the profile and the points resolve the spectrum.
"""

from __future__ import annotations

import itertools
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.constrained import leading_eigenvalues
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.errors import SpectrumError
from pearlbvp.held import AREA_AND_VOLUME, Held
from pearlbvp.stability.bloch import QuadraticForm, SecondVariation
from pearlbvp.stability.isothermal import Isothermal
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


def _kernel(variation: SecondVariation, block: Block, size: int) -> Array | None:
    """The translation in a block, as ``r w`` at its points: along the axis ``-sin psi``, odd, across it ``cos psi``, even."""
    if block.j != 0 or block.n > 1 or block.parity == ("even", "odd")[block.n]:
        return None
    kernel = variation.r * (np.sin(variation.psi) if block.n == 0 else np.cos(variation.psi))
    unmoved = np.abs(kernel).max() < 1e-6  # the straight tube by one along its axis
    missing = size - len(kernel)  # the parts of the other parity
    return None if unmoved else np.pad(kernel, (missing, 0) if block.n == 0 else (0, missing)) / np.linalg.norm(kernel)


def kernel_residual(matrix: NDArray[Any], kernel: Array, largest: float) -> float:
    """Size of ``(matrix - shift)^{-1} matrix kernel``: the error of a unit kernel vector, in the units of growth rates.

    The plain residual would be that of a fourth derivative, in which the rounding of the profile drowns everything else. The
    shift is one beyond the ``largest`` growth rate, or beyond 0.
    """
    shift = 1 + max(0.0, largest)
    defect = matrix @ kernel
    return float(np.linalg.norm(np.linalg.solve(matrix - shift * np.eye(len(matrix)), defect)))


def block_problem(
    variation: SecondVariation, block: Block, held: Held = AREA_AND_VOLUME, form: QuadraticForm | None = None
) -> tuple[NDArray[Any], list[Array], list[Array]]:
    """The matrix whose eigenvalues are a block's growth rates on the vectors ``r w`` that some rows annihilate.

    Args:
        variation, block, held, form: as ``block_rates`` takes them.

    Returns:
        The matrix, the exact kernel (or none), and the rows of what is held.
    """
    matrix = (form or variation.form(block.theta, block.parity)).matrix(block.n)
    kernel = _kernel(variation, block, len(matrix))
    rows: list[Array] = []
    if block.n == 0 and block.j == 0 and block.parity != "odd":
        rows, matrix = variation.constrained(matrix, held, block.cells)
    return matrix, [] if kernel is None else [np.pad(kernel, (0, len(matrix) - len(kernel)))], rows


def block_rates(
    variation: SecondVariation, block: Block, held: Held = AREA_AND_VOLUME, form: QuadraticForm | None = None
) -> tuple[Array, float]:
    """Growth rates of a block without its exact kernel, largest first, and how well that kernel is one.

    Args:
        variation: of the profile.
        block: the block.
        held: what is held.
        form: the variation's on waves of the block's ``theta`` and parity, where it is known.

    Returns:
        The rates, and how far the exact kernel is from one (0 where there is none); see ``kernel_residual``.
    """
    matrix, kernels, rows = block_problem(variation, block, held, form)
    rates = leading_eigenvalues(matrix, [*kernels, *rows])
    if not kernels:
        return rates, 0.0
    largest = float(leading_eigenvalues(matrix)[0] if rows else rates[0])
    return rates, kernel_residual(matrix, kernels[0], largest)


MANY = 420
"""Fourier points of a period beyond which fewer are tried first than five in each unit: their cubes are long to wait for."""

ENOUGH, MOST = 5, 7
"""Fourier points in each unit of the isothermal coordinate at which rates near zero are known to rounding, which more of them
only enlarge, and to which they are raised where kernels say otherwise."""

_KEPT = 12
"""Growth rates kept of each block, besides the positive ones."""

LEAST_N = 3
"""Azimuthal numbers that are looked at in any case."""


def _of_blocks(variation: SecondVariation, blocks: list[Block], held: Held) -> tuple[dict[Block, Array], float]:
    """Leading growth rates of some blocks, and the largest error of an exact kernel.

    Blocks of one ``theta`` and parity, which stand together, share their quadratic form.
    """
    rates, residual = {}, 0.0
    for (_, parity), together in itertools.groupby(blocks, key=lambda block: (block.j, block.parity)):
        form = None
        for block in together:
            form = form or variation.form(block.theta, parity)
            found, error = block_rates(variation, block, held, form)
            rates[block] = found[: _KEPT + int((found > 0).sum())]
            residual = max(residual, error)
    return rates, residual


def spectrum(
    profile: Profile,
    cells: int = 1,
    *,
    held: Held = AREA_AND_VOLUME,
    tolerance: float = 1e-7,
    points: int | None = None,
    max_points: int | None = None,
    max_n: int = 64,
) -> Spectrum:
    """Growth rates of all perturbations of a tube of ``cells`` periods, over all ``n`` that matter.

    The number of Fourier points is doubled until the exact kernels are kernels to ``tolerance``, as long as that helps.
    Azimuthal numbers go up until, from ``n = 2`` on, all rates of one are negative and below those of the one before.

    Args:
        profile: one period, or half of it.
        cells: periods on the tube.
        held: what is held.
        tolerance: for the residual of the exact kernels.
        points: Fourier points of a period to begin with (``None``: five in each unit of the isothermal coordinate, on long
            periods fewer).
        max_points: the most to go to (``None``: seven in each unit, and 768 at least); the result's ``residual`` says whether
            they sufficed.
        max_n: largest azimuthal number.

    Raises:
        SpectrumError: far more wind around the tube and grow.
    """
    coordinate = Isothermal.of(profile)
    length = coordinate.period * (1 - 1e-12)  # a straight tube's is exact: its rounding is to add no points
    enough, most = (2 * math.ceil(density / 2 * length) for density in (ENOUGH, MOST))
    if points is None:
        fastest = math.sqrt(
            3 + 2 * abs(profile.lambda2) + 2 * abs(1 - 2 * profile.c0)
        )  # that grows on the straight tube
        points = max(48, min(enough, max(MANY, 2 * math.ceil(length * max(1.25, fastest / 2)))))
    max_points = max(768, most) if max_points is None else max_points
    if profile.lambda2 > (max_n + 1) ** 2:  # on the straight tube they grow beyond half of that
        raise SpectrumError(
            f"waves of more than n = {max_n} around the tube grow on such short pearls; take fewer, or a longer tube"
        )
    first = [block for n in range(LEAST_N) for block in blocks_of(cells, n, profile.half)]
    first.sort(key=lambda block: (block.j, block.parity or ""))
    at_rest = [block for block in first if block.j == 0]  # translations among them
    variation = SecondVariation.of(profile, points, coordinate)
    rates, residual = _of_blocks(variation, at_rest, held)
    while residual > tolerance and 2 * points <= max_points:
        finer = SecondVariation.of(profile, 2 * points, coordinate)
        again, smaller = _of_blocks(finer, at_rest, held)
        if smaller > residual / 2:  # rounding, or the profile itself, is what remains
            break
        variation, rates, residual, points = finer, again, smaller, 2 * points
    rates |= _of_blocks(variation, first[len(at_rest) :], held)[0]

    def falls(n: int) -> bool:
        """Whether nothing grows that winds ``n`` times around, and less than what winds once less."""
        here, before = (max(float(found[0]) for block, found in rates.items() if block.n == m) for m in (n, n - 1))
        return here < min(0.0, before)

    n = LEAST_N - 1
    while not falls(n) and n < max_n:
        n += 1
        rates |= _of_blocks(variation, blocks_of(cells, n, profile.half), held)[0]
    return Spectrum.of(rates, residual, falls(n), points)
