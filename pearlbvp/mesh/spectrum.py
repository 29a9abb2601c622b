"""Growth rates of a triangulated tube, and how many are positive.

``second variation w = -mu mass w`` on the displacements that keep what is held and contain no rigid motion. The count
is the inertia of the bordered matrix and owes nothing to iterations; the rates nearest zero come from Lanczos' method on
its inverse. Each checks the other. Where a mesh and its surface are symmetric, displacements that keep the symmetry and
those that break it are found apart: projections commute with all matrices.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.linalg import eigh
from scipy.sparse.linalg import LinearOperator, eigsh

from pearlbvp.arrays import Array, Integers
from pearlbvp.bordered import Bordered, Pinned
from pearlbvp.constrained import lifted, restricted
from pearlbvp.held import Held, Stiffness, coefficients
from pearlbvp.mesh.functional import Functional
from pearlbvp.mesh.symmetry import mean
from pearlbvp.representation import brief

NEUTRAL = 1e-9
"""Growth rates of this size are zero to the accuracy of the arithmetic."""

SMOOTH = 20.0
"""Growth rates, in size, of displacements that count as smooth."""

NOTHING = 1e-6
"""Mean square below which a unit rigid motion moves the surface along itself, and the gradients of area and volume are
parallel, as they are on the straight tube."""


class MeshBlock(NamedTuple):
    """A symmetry block of perturbations: those that are constant on the orbits of the symmetry, or the others.

    Attributes:
        name: ``symmetric`` or ``breaking``; ``all`` where there is no symmetry.
        multiplicity: how often its growth rates are counted.
    """

    name: str = "all"
    multiplicity: int = 1

    def __str__(self) -> str:
        return self.name


def smoothing(second: sparse.csc_matrix, mass: sparse.csc_matrix, pins: Integers) -> Bordered:
    """``second + SMOOTH mass`` of a second variation, factorized for ``independent``; ``pins`` are held on the way."""
    none = np.zeros((0, second.shape[0]))
    return Pinned.of((second + SMOOTH * mass).tocsc(), pins).bordered(none.T, none, np.zeros((0, 0)))


def independent(rows: Array, smoothed: Bordered, mass: sparse.csc_matrix) -> tuple[Array, Array]:
    """Combinations of rows that stand for smooth displacements, unit ones, without those that are none; and these.

    On the straight tube a shift along it moves no point along the normal, and on a mesh all but none; what remains is
    roughness, and no kernel. So rows ``r`` are smoothed, ``w = s (second + s mass)^{-1} r``: a kernel is left as it is, of
    what is rough next to nothing, and the mean square of ``w`` tells them apart.

    Args:
        rows: products of displacements with the mass, shape (q, V).
        smoothed: see ``smoothing``.
        mass: of normal displacements, shape (V, V).

    Returns:
        The rows, shape (rank, V), and the smoothed displacements, orthonormal in the mass, shape (V, rank).
    """
    motions = SMOOTH * smoothed.solve(np.ascontiguousarray(rows.T), np.zeros((0, len(rows))), 0)
    squares, vectors = np.linalg.eigh(motions.T @ (mass @ motions))
    kept = squares > NOTHING * mass.sum()
    chosen = vectors[:, kept] / np.sqrt(squares[kept])
    return np.asarray(chosen.T @ rows), np.asarray(motions @ chosen)


@dataclass(frozen=True)
class Modes:
    """Growth rates and their perturbations.

    Attributes:
        rates: of each block, largest first, shape (k,).
        vectors: perturbations as columns, shape (V, k).
        unstable: number of positive rates in all blocks together, by inertia.
        residual: as in ``Spectrum``.
    """

    __repr__ = brief

    rates: dict[MeshBlock, Array]
    vectors: dict[MeshBlock, Array]
    unstable: int
    residual: float = math.nan

    @property
    def complete(self) -> bool:
        """Whether all positive rates were found; the signs of neutral ones are rounding."""
        positive = sum(int((rates > NEUTRAL).sum()) for rates in self.rates.values())
        neutral = sum(int((np.abs(rates) <= NEUTRAL).sum()) for rates in self.rates.values())
        return positive <= self.unstable <= positive + neutral

    def together(self) -> tuple[Array, Array]:
        """Rates and vectors of all blocks, largest first."""
        rates, vectors = np.concatenate(list(self.rates.values())), np.hstack(list(self.vectors.values()))
        order = np.argsort(-rates)
        return rates[order], vectors[:, order]


def leading(
    second: sparse.csc_matrix,
    mass: sparse.csc_matrix,
    rows: Array,
    pins: Integers,
    counts: Mapping[MeshBlock, int],
    orbits: Integers | None = None,
    stiff: Sequence[Stiffness] = (),
) -> Modes:
    """The growth rates nearest zero and all positive ones, on what the rows annihilate.

    Args:
        second: second variation, shape (V, V).
        mass: of normal displacements, shape (V, V).
        rows: shape (q, V), independent.
        pins: vertices for the factorization.
        counts: how many rates of each block are wanted besides as many as are positive.
        orbits: of the symmetry, shape (V,).
        stiff: what reservoirs add to the second variation.

    Raises:
        numpy.linalg.LinAlgError: the matrix is singular, or Lanczos' method did not converge.
    """
    pinned = Pinned.of(second, pins)
    borders = np.vstack((rows, *(math.sqrt(factor) * row for row, factor in stiff)))
    corner = -np.diag(np.repeat((0.0, 1.0), (len(rows), len(stiff))))
    unstable = pinned.negative(borders, corner)
    inverse = Inverse.of(pinned, borders, corner, second, mass)
    wanted = {block: unstable + count for block, count in counts.items()}
    while True:
        found = {
            block: _of_symmetry(second, mass, rows, orbits, number, stiff)
            if block.name == "symmetric" and orbits is not None and orbits.max() < DENSE
            else _nearest_zero(second, mass, inverse, number, _projection(block, orbits))
            for block, number in wanted.items()
        }
        modes = Modes({b: rates for b, (rates, _) in found.items()}, {b: w for b, (_, w) in found.items()}, unstable)
        if modes.complete or len(counts) < (1 if orbits is None else 2) or min(wanted.values()) >= second.shape[0] // 2:
            return modes  # one block of two cannot be compared with the inertia
        wanted = {block: 2 * number for block, number in wanted.items()}


def perturbations(
    functional: Functional,
    vertices: Array,
    parameters: tuple[float, float, float],
    held: Held,
    counts: Mapping[MeshBlock, int],
    orbits: Integers | None,
) -> Modes:
    """Leading growth rates of an equilibrium and their displacements.

    Args:
        functional: on its reference mesh.
        vertices: shape (V, 3).
        parameters: ``lambda1, lambda2, c0``.
        held: what is held.
        counts, orbits: as in ``leading``.
    """
    (lambda1, lambda2, c0), directions, pins = parameters, functional.directions, functional.pins
    second, sums = (
        functional.hessian(vertices, directions, c0, lambda1, lambda2),
        functional.sums(vertices, directions, c0),
    )
    mass, motions = functional.normal_mass(vertices, directions)
    quantities = functional.quantities(vertices, directions, sums, coefficients(lambda1, lambda2, c0))
    smoothed = smoothing(second, mass, pins)
    rigid, moved = independent(motions, smoothed, mass)
    residual = float(np.abs(np.linalg.eigvalsh(moved.T @ (second @ moved))).max())
    count, size = len(vertices), np.linalg.norm(motions[1])
    if not held.length:  # one more coordinate, an orbit of its own, which like a pin couples with all others
        both, alone, quantities = quantities.stretched()
        second = sparse.bmat([[second, both[:, None]], [both[None, :], [[alone]]]]).tocsc()
        mass, pins = sparse.block_diag((mass, 1.0)).tocsc(), np.append(pins, count)
        rigid = np.pad(rigid, ((0, 0), (0, 1)))
        orbits = None if orbits is None else np.append(orbits, orbits.max() + 1)
    kept = [row * size / np.linalg.norm(row) for row in held.rows(quantities.gradients)]
    constraints = np.array(kept).reshape(-1, len(rigid.T))
    if len(kept) and held.length:  # else no shape has changes of area and volume, and of the length, that are parallel
        constraints, _ = independent(constraints, smoothed, mass)
    modes = leading(second, mass, np.vstack((constraints, rigid)), pins, counts, orbits, held.stiffnesses(quantities))
    vectors = {block: found[:count] for block, found in modes.vectors.items()}
    return replace(modes, vectors=vectors, residual=residual)


DENSE = 300
"""Orbits up to which displacements that keep the symmetry are treated by dense algebra."""


def _projection(block: MeshBlock, orbits: Integers | None) -> Callable[[Array], Array]:
    """Onto the perturbations of a block."""
    if orbits is None or block.name == "all":
        return lambda w: w
    if block.name == "symmetric":
        return lambda w: mean(orbits, w)
    return lambda w: w - mean(orbits, w)


SINGULAR = 1e-6
"""Growth rate below which a mode is neutral to the inverse: others would drown in its rounding."""

SHIFT = 1e-2
"""Growth rate about which the inverse is taken instead."""


GUARD = 4
"""Rates beyond those wanted: Lanczos' method meets the copies of a multiple rate one by one, through rounding, and might be
content with a simple one farther from zero before it has all."""


@dataclass(frozen=True)
class Inverse:
    """The inverse of ``second - shift mass`` on what some rows annihilate.

    Attributes:
        bordered: the matrix with the rows.
        shift: 0, or where there is a neutral mode a little beside it.
    """

    bordered: Bordered
    shift: float

    @classmethod
    def of(
        cls, pinned: Pinned, rows: Array, corner: Array, second: sparse.csc_matrix, mass: sparse.csc_matrix
    ) -> Inverse:
        """From the second variation, factorized; two steps of inverse iteration say whether a mode is neutral."""
        found = cls(pinned.bordered(rows.T, rows, corner), 0.0)
        vector = found(mass @ np.random.default_rng(1).standard_normal(second.shape[0]))
        vector /= np.sqrt(vector @ (mass @ vector))
        grown = found(mass @ vector)
        if grown @ (mass @ grown) < 1 / SINGULAR**2:
            return found
        shifted = Pinned.of((second - SHIFT * mass).tocsc(), pinned.pins)
        return cls(shifted.bordered(rows.T, rows, corner), SHIFT)

    def __call__(self, load: Array) -> Array:
        """The displacement under a load, both of shape (V,)."""
        zero = np.zeros((len(self.bordered.rows), 1))
        return self.bordered.solve(load.reshape(-1, 1), zero, 0)[: len(load), 0]


def _nearest_zero(
    second: sparse.csc_matrix,
    mass: sparse.csc_matrix,
    inverse: Inverse,
    number: int,
    project: Callable[[Array], Array],
) -> tuple[Array, Array]:
    """Growth rates nearest zero, largest first, and their perturbations, by Lanczos' method on the inverse."""
    size = second.shape[0]

    def of_block(load: Array) -> Array:
        return project(inverse(load.ravel()))

    operator = LinearOperator((size, size), matvec=of_block, dtype=np.float64)
    start = of_block(mass @ np.random.default_rng(0).standard_normal(size))
    try:
        values, vectors = eigsh(
            second, min(number + GUARD, size // 2), mass, sigma=inverse.shift, OPinv=operator, v0=start, tol=1e-10
        )
    except sparse.linalg.ArpackNoConvergence as error:
        raise np.linalg.LinAlgError(f"Lanczos' method: {error}") from None
    nearest = np.argsort(np.abs(values - inverse.shift))[:number]
    order = nearest[np.argsort(values[nearest])]
    return -values[order], vectors[:, order]


def _of_symmetry(
    second: sparse.csc_matrix,
    mass: sparse.csc_matrix,
    rows: Array,
    orbits: Integers,
    number: int,
    stiff: Sequence[Stiffness],
) -> tuple[Array, Array]:
    """The largest growth rates of what is constant on orbits, and their perturbations, by dense algebra."""
    size = len(orbits)
    basis = sparse.coo_matrix((np.ones(size), (np.arange(size), orbits))).tocsr()
    kept = rows @ basis
    on_orbits, mass_on_orbits = ((basis.T @ matrix @ basis).toarray() for matrix in (second, mass))
    for row, factor in stiff:
        on_orbits += factor * np.outer(row @ basis, row @ basis)
    pencil = restricted(kept, on_orbits, mass_on_orbits)
    values, vectors = eigh(*[(matrix + matrix.T) / 2 for matrix in pencil])
    return -values[:number], basis @ lifted(kept, vectors[:, :number])
