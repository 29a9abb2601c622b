"""The critical perturbation of a solution: the normal displacement that grows fastest, or decays slowest.

It is the leading eigenvector of the symmetry block that the spectrum names, by the matrices that its growth rates come from.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import singledispatch
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.linalg import eigh

from pearlbvp.arrays import Array
from pearlbvp.constrained import independent_directions
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.explorer.shapes import Shared, mode_numbers, packed, steps
from pearlbvp.membrane import MembraneProblem
from pearlbvp.mesh.operators import vertex_normals
from pearlbvp.mesh.problem import MeshProblem
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.shapes.ring import RingProblem
from pearlbvp.stability.bloch import SecondVariation
from pearlbvp.stability.isothermal import Isothermal
from pearlbvp.stability.planar import PlanarVariation
from pearlbvp.stability.spectrum import block_problem
from pearlbvp.tube.problem import TubeProblem


@dataclass(frozen=True)
class Wave:
    """A perturbation.

    Attributes:
        rate: its growth rate.
        drawn: what a page makes it of (``surfaces.js``).
    """

    rate: float
    drawn: dict[str, Any]


@singledispatch
def critical(problem: MembraneProblem, u: Array, spectrum: Spectrum, shared: Shared) -> Wave | None:
    """The critical perturbation; None of families that do not tell it.

    Args:
        problem, u: a solution.
        spectrum: its growth rates, which name the block.
        shared: where lists go that others have, too.
    """
    return None


def _leading(second: NDArray[Any], rows: list[Array], mass: NDArray[Any] | None = None) -> tuple[float, NDArray[Any]]:
    """The largest ``mu`` of ``second w = -mu mass w``, and ``w``, on the vectors that all rows annihilate.

    Against ``second + shift mass``, which is positive definite (``tube.spectrum``): the mass may be all but singular.
    """
    size = len(second)
    directions = independent_directions(rows, size)
    basis = np.linalg.qr(directions, mode="complete")[0][:, directions.shape[1] :]
    inside = basis.conj().T @ second @ basis
    weight = np.eye(inside.shape[0]) if mass is None else basis.T @ mass @ basis
    shift, most = 16.0, 1e12
    while shift < most:
        try:
            value, vector = eigh(weight, inside + shift * weight, subset_by_index=[len(inside) - 1, len(inside) - 1])
            return float(shift - 1 / value[0]), np.asarray(basis @ vector[:, 0])
        except np.linalg.LinAlgError:
            shift *= 8
    raise np.linalg.LinAlgError("the second variation has no lower bound")


@critical.register
def _of_pearls(problem: PearlProblem, u: Array, spectrum: Spectrum, shared: Shared) -> Wave:
    """At equal steps of arclength over a period: ``Re(w e^{i theta cell}) cos(n phi)``."""
    profile, block = problem.profile(u), spectrum.critical
    variation, coordinate = SecondVariation.of(profile, spectrum.points), Isothermal.of(profile)
    matrix, kernels, rows = block_problem(variation, block, problem.held)
    rate, vector = _leading(-matrix, [*kernels, *rows])
    count = steps(problem, u)
    sigma, half = coordinate.points(variation.count), len(variation.r)
    turn = np.exp(1j * block.theta)
    if variation.symmetric:
        if block.parity is None:  # real part, even about the belly, then the imaginary one, odd
            found: NDArray[Any] = vector[:half] + 1j * vector[half : 2 * half]
        else:
            found = vector[:half] * (1 + 0j if block.parity == "even" else 1j)
        w = found / variation.r
        w, sigma = np.concatenate((w, turn * w.conj()[::-1])), np.concatenate((sigma, 2 - sigma[::-1])) / 2
    else:
        w = vector[:half] / variation.r
    w = w * np.exp(-1j * np.angle(w[np.abs(w).argmax()]))
    around = (sigma[-6:] - 1, sigma, sigma[:6] + 1)
    values = CubicSpline(np.concatenate(around), np.concatenate((w[-6:] / turn, w, w[:6] * turn)))(
        np.arange(count) / count
    )
    return Wave(rate, {"n": block.n, "theta": block.theta, "re": packed(values.real), "im": packed(values.imag)})


@critical.register
def _of_rings(problem: RingProblem, u: Array, spectrum: Spectrum, shared: Shared) -> Wave:
    """Around the section, times ``cos kx``."""
    profile, block = problem.profile(u), spectrum.critical
    variation, k = PlanarVariation.of(profile, spectrum.points), 2 * math.pi * block.j / problem.length
    at_rest, by_square = variation.matrices(block.c, block.parity)
    rows: list[Array] = []
    second: NDArray[Any] = -(at_rest + k**2 * by_square) + k**4 / 2 * np.eye(len(at_rest))
    if block.j == 0:
        rows, second = variation.at_rest(block.c, block.parity, problem.length, problem.held)
    rate, vector = _leading(second, rows)
    count, sigma = len(variation.psi), np.linspace(0, 2 * profile.n, steps(problem, u) + 1)
    _, _, number = variation.waves(block.c, block.parity)
    angle = np.outer(2 * math.pi * sigma / (2 * profile.n), number)
    waves = np.sin(angle) if block.parity == "odd" else np.cos(angle)
    sizes = np.ones(len(number)) if block.parity is None else _sizes(count, number / profile.n, block.parity)
    return Wave(rate, {"k": k, "re": packed(waves @ (vector[: len(number)] / sizes))})


def _sizes(count: int, per_lobe: Array, parity: str) -> Array:
    """Norms of cosines or sines at the points ``(i + 1/2) / count`` of half a lobe, which ``bloch.waves`` divides by."""
    angle = np.outer((np.arange(count // 2) + 0.5) / count, 2 * math.pi * per_lobe)
    return np.asarray(np.linalg.norm(np.cos(angle) if parity == "even" else np.sin(angle), axis=0))


@critical.register
def _of_modes(problem: TubeProblem, u: Array, spectrum: Spectrum, shared: Shared) -> Wave:
    """A sum of modes, which displace points in the planes across the axis; their normal part counts."""
    modes, block = problem.block_problem(u, spectrum.critical)
    rate, vector = _leading(block.second, block.rows, block.mass)
    return Wave(rate, {"modes": shared.number(mode_numbers(modes)), "values": packed(vector[: len(modes)])})


@critical.register
def _of_meshes(problem: MeshProblem, u: Array, spectrum: Spectrum, shared: Shared) -> Wave:
    """The normal part of the displacements of the surface's points, which are no vertices of a control mesh."""
    block = spectrum.critical
    found = problem.block_modes(u, {block: 1})
    moved = problem.vertices(u) + found.vectors[block][:, :1] * problem.directions
    along = problem.functional.points(moved) - problem.points(u)
    vector = (vertex_normals(problem.surface(u)) * along).sum(axis=1)
    return Wave(float(found.rates[block][0]), {"values": packed(vector)})
