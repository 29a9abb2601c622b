"""Waves ``e^{i(p k x + b phi)}`` and what quadratic and linear forms over a surface make of them.

All of a mode's fields are waves times constant factors (its symbol), so a form ``mean of z . W z`` is a Fourier coefficient of
the weights ``W`` at the difference of two waves: nothing is summed over points for each pair. On a grid the coefficients are
those of its trapezoidal sum, so the forms are the exact derivatives of that sum (``docs/theory/reduced_modes.md``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft2, rfft2
from scipy.sparse import csc_array

from pearlbvp.arrays import Array, Complex
from pearlbvp.representation import brief
from pearlbvp.tube.kernels import (
    forms_of_modes,
    lower_halves,
    means_over_modes,
    spectrum_of_modes,
    with_phases,
)
from pearlbvp.tube.modes import Mode

FIELDS = range(10)
"""All of a tube's fields."""


@dataclass(frozen=True)
class Cell:
    """A period of a surface, on a grid.

    Attributes:
        period: its wave numbers along the tube are multiples of this, in units of ``k``; 0 for none.
        fold: its wave numbers around the tube are multiples of this; 0 for none.
        points: of the grid, along and around the cell.
    """

    period: int
    fold: int
    points: tuple[int, int]

    def transform(self, values: Array) -> Complex:
        """Fourier coefficients of functions on the grid, shape (..., K), at the waves ``p >= 0``."""
        return np.asarray(rfft2(values.reshape(*values.shape[:-1], *self.points), axes=(-1, -2), norm="forward"))

    @property
    def sizes(self) -> tuple[int, int, int, int]:
        """Period, fold and points, as the compiled loops take them."""
        return self.period, self.fold, *self.points


@dataclass(frozen=True, eq=False)
class Waves:
    """Waves of a half plane: ``p > 0``, or ``p = 0`` and ``b >= 0``. Those with ``|b| = 1`` belong to the centre.

    Attributes:
        k: unit of the wave numbers along the tube.
        kappa: rate at which the frame turns.
        p, b: wave numbers, shape (Q,).
    """

    __repr__ = brief

    k: float
    kappa: float
    p: NDArray[np.intp]
    b: NDArray[np.intp]

    @property
    def centre(self) -> NDArray[np.bool_]:
        """Which waves move the centre."""
        return np.asarray(np.abs(self.b) == 1)

    @cached_property
    def jets(self) -> Array:
        """What the fields are made of (``fields_of_jets``), ten entries, those of ``IMAGINARY_JETS`` divided by ``i``.

        Of a wave of ``sigma`` the first six: ``v, v_xx, v_xphi, v_phiphi, v_x, v_phi``. Of one of the centre the last four:
        ``a_1, p_0, a_0, p_1`` of its shift ``e^{i k x}``, seen at ``b = 1`` and ``-1``, turned by the frame and ``phi``.
        All are polynomials in ``b`` (whose square is 1 for the centre): coefficients of its powers, shape (Q, 3, 10).
        """
        k, kappa = self.p * self.k, self.kappa
        found = np.zeros((3, 10, len(k)))
        found[0, 0], found[0, 1], found[0, 4] = 1.0, -(k**2), k
        found[1, 2], found[1, 5], found[2, 3] = -k, 1.0, -1.0
        centre = np.zeros_like(found)
        centre[0, 6], centre[0, 7], centre[0, 8], centre[0, 9] = kappa, -(k**2 + kappa**2), k, 2 * k * kappa
        centre[1, 6], centre[1, 7], centre[1, 8], centre[1, 9] = -k, 2 * k * kappa, -kappa, -(k**2 + kappa**2)
        return np.ascontiguousarray(np.where(self.centre, centre, found).transpose(2, 0, 1))

    @cached_property
    def symbols(self) -> Complex:
        """The ten fields of each wave (``tube.density``), shape (Q, 10)."""
        return np.asarray((self._at_b(self.jets) * PHASES_OF_JETS) @ fields_of_jets(self.kappa).T)

    @cached_property
    def moved(self) -> Array:
        """What each wave moves points by in the plane, turned as the fields are, the second of two entries divided by ``i``.

        Coefficients of powers of ``b``, shape (Q, 2, 2).
        """
        return np.where(self.centre[:, None, None], np.eye(2), [[1.0, 0.0], [0.0, 0.0]])

    @cached_property
    def displacements(self) -> Complex:
        """The same, nothing divided, shape (Q, 2)."""
        return self._at_b(self.moved) * np.array((1.0, 1j))

    def _at_b(self, polynomials: Array) -> Array:
        return np.asarray(np.einsum("qu,quf->qf", self.b[:, None] ** np.arange(polynomials.shape[1]), polynomials))

    @cached_property
    def groups(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """The waves, those of one ``p`` and of the centre or not together, where each group starts among them, and the end."""
        group = 2 * self.p + self.centre
        order = np.argsort(group, kind="stable")
        return order, np.append(np.flatnonzero(np.diff(group[order], prepend=-1)), len(order))

    def bending(self, cell: Cell, transform: MatrixTransform, families: Families) -> list[Array]:
        """``mean of z . W z'`` of the jets ``z`` of each pair of modes of a family of these waves, shape (modes, modes).

        Args:
            cell: whose grid ``W`` is given on.
            transform: of ``W``, from ``matrix_transform``.
            families: of modes, which share most of the work (``Families.of``).
        """
        return self._forms(cell, self.jets, self.jets, transform, families)

    def moving(self, cell: Cell, transform: MatrixTransform, families: Families) -> list[Array]:
        """``mean of z . W z'`` of the displacements ``z`` of each pair of modes; see ``bending``."""
        return self._forms(cell, self.moved, self.moved, transform, families)

    def dragging(self, cell: Cell, transform: MatrixTransform, families: Families) -> list[Array]:
        """``mean of z . W z'`` of one mode's displacement ``z``, and another's displacement and first four fields ``z'``.

        ``W`` is given as ``matrix_transform`` of 6 x 6 matrices for vectors with the ``IMAGINARY_DRAGS``; what they say of two
        fields is not used. See ``bending``.
        """
        return self._forms(cell, self.moved, self._moving_fields, transform, families)

    def spreading(self, cell: Cell, transform: MatrixTransform, families: Families) -> list[Array]:
        """``mean of z . W z'`` of displacements and first four fields ``z`` of each pair of modes; see ``dragging``."""
        return self._forms(cell, self._moving_fields, self._moving_fields, transform, families)

    @cached_property
    def _moving_fields(self) -> Array:
        """Displacement and first four fields, those of ``IMAGINARY_DRAGS`` divided by ``i``; see ``moved``: shape (Q, 2, 6)."""
        first_fields = fields_of_jets(self.kappa)[:4].T * (PHASES_OF_JETS[:, None] / (1j, 1.0, 1j, 1.0)).real
        fields = self.jets[:, :2] @ first_fields  # none of them has the square of b
        return np.concatenate((self.moved, fields), axis=2)

    def _forms(
        self, cell: Cell, left: Array, right: Array, transform: MatrixTransform, families: Families
    ) -> list[Array]:
        most, largest = np.diff(self.groups[1]).max(), 2 * np.abs(self.b).max()
        differences, unit = np.arange(-largest, largest + 1), cell.fold or largest + 1
        around_of = np.where(differences % unit == 0, differences // unit % cell.points[1], -1)
        tile, found = np.empty((2, 2, most, most)), np.zeros(np.sum(families.sizes**2))
        forms_of_modes(
            left, right, self.p, self.b, *self.groups, *transform, (cell.period, *cell.points), around_of, families,
            left is right, tile, found,
        )  # fmt: skip
        pieces = np.split(found, np.cumsum(families.sizes**2)[:-1])
        return [piece.reshape(size, size) for piece, size in zip(pieces, families.sizes, strict=True)]


IMAGINARY_JETS = (4, 5, 8, 9)
"""Jets of a wave that are imaginary: first derivatives of ``sigma``, and ``a_0`` and ``p_1`` of the centre."""

PHASES_OF_JETS = np.where(np.isin(np.arange(10), IMAGINARY_JETS), 1j, 1.0)
"""What those jets are to be multiplied by."""

IMAGINARY_DRAGS = (1, 2, 4)
"""Imaginary entries of a wave's displacement and its first four fields, in one vector."""


def fields_of_jets(kappa: float) -> Array:
    """The ten fields from the jets of ``sigma`` and the centre's ``a`` and ``p``, in a frame turning at ``kappa``: (10, 10)."""
    matrix = np.zeros((10, 10))
    v, vxx, vxp, vpp, vx, vp = range(6)
    rows = [
        {vx: 1.0}, {v: kappa}, {vp: 1.0}, {v: 1.0}, {vxx: 1.0, v: -(kappa**2)}, {vx: 2 * kappa},
        {vxp: 1.0, v: -kappa}, {vx: 1.0, vp: kappa}, {vpp: 1.0, v: -1.0}, {vp: 2.0},
    ]  # fmt: skip
    for field, row in enumerate(rows):
        for jet, factor in row.items():
            matrix[field, jet] = factor
    for jet, field in zip(range(6, 10), (1, 4, 0, 5), strict=True):
        matrix[field, jet] = 1.0
    return matrix


class MatrixTransform(NamedTuple):
    """Fourier coefficients of symmetric matrices W, times the phases of what stands left (conjugate) and right, 1 or i.

    At a frequency ``y`` beyond those that a real transform keeps they are those of the opposite one, the first part times
    ``s``, the second times ``-s``: ``s`` is the product of an entry's two ``signs``. Above the diagonal, both times ``s``.

    Attributes:
        coefficients: lower halves, row by row, of their real and imaginary parts: shape (1 or 2, F(F + 1)/2, points along,
            points around/2 + 1). Where the surface is even along and around, all are real.
        signs: what an opposite wave has of a wave's vector, its phases taken out: -1 where those are i, shape (F,).
    """

    coefficients: Array
    signs: Array


def matrix_transform(
    cell: Cell, weights: Array, imaginary: Sequence[int], basis: Array | None = None
) -> MatrixTransform:
    """Fourier coefficients of symmetric matrices on a cell's grid, for vectors with ``imaginary`` entries.

    Args:
        cell: the cell.
        weights: the matrices, shape (K, F, F).
        imaginary: which entries of the vectors are.
        basis: what makes the matrices' vectors of others that are meant, shape (F, F).
    """
    size = weights.shape[1]
    lower = lower_halves(np.ascontiguousarray(weights), np.eye(size) if basis is None else basis)
    half = rfft2(lower.reshape(-1, *cell.points), norm="forward")
    signs = np.where(np.isin(np.arange(size), imaginary), -1.0, 1.0)
    return MatrixTransform(with_phases(half, signs), signs)


# Arrays of megabytes are costly to come by, whatever is done with them: these loops make few.


@dataclass(frozen=True, eq=False)
class ModeWaves:
    """Real modes as sums of waves: each is the real part of ``sum of C_q e^{i q}``.

    Attributes:
        modes: the modes, products of a cosine or sine along the tube and one around it.
        waves: those that they are sums of; other modes may share them.
        coefficients: ``C``, shape (Q, modes).
    """

    __repr__ = brief

    modes: tuple[Mode, ...]
    waves: Waves
    coefficients: csc_array

    @classmethod
    def of(cls, k: float, kappa: float, *families: Sequence[Mode]) -> list[ModeWaves]:
        """Families of modes that share their waves."""
        place: dict[tuple[int, int], int] = {}
        entries = [[_wave_entries(mode) for mode in modes] for modes in families]
        for family in entries:
            for pairs in family:
                for wave, _ in pairs:
                    place.setdefault(wave, len(place))
        numbers = np.array(list(place), dtype=np.intp).reshape(-1, 2)
        waves = Waves(k, kappa, numbers[:, 0].copy(), numbers[:, 1].copy())
        found = []
        for modes, family in zip(families, entries, strict=True):
            triples = [(place[wave], column, c) for column, pairs in enumerate(family) for wave, c in pairs]
            rows, columns, values = zip(*triples, strict=True) if triples else ((), (), ())
            matrix = csc_array((np.array(values, dtype=complex), (rows, columns)), shape=(len(place), len(modes)))
            found.append(cls(tuple(modes), waves, matrix))
        return found

    @staticmethod
    def stretched(k: float, kappa: float, *families: ModeWaves) -> list[ModeWaves]:
        """Families of modes on a tube of another length; those that share their waves go on sharing them."""
        waves = {family.waves: replace(family.waves, k=k, kappa=kappa) for family in families}
        return [replace(family, waves=waves[family.waves]) for family in families]

    def state(self, cell: Cell, coefficients: Array, fields: range = FIELDS) -> Array:
        """Fields of a sum of modes on a cell's grid, all ten or a range of them: shape (fields, K)."""
        return self._sums(cell, self.waves.symbols, fields, coefficients)

    def displacement(self, cell: Cell, coefficients: Array) -> Array:
        """What a sum of modes moves points by in the plane, turned as the fields are, on a cell's grid: shape (2, K)."""
        return self._sums(cell, self.waves.displacements, range(2), coefficients)

    def _sums(self, cell: Cell, symbols: Complex, entries: range, coefficients: Array) -> Array:
        waves, (along, around) = self.waves, cell.points
        spectrum = spectrum_of_modes(
            *self._columns, coefficients, symbols, entries.start, entries.stop, waves.p, waves.b, *cell.sizes
        )
        return np.asarray(irfft2(spectrum, (around, along), axes=(-1, -2), norm="forward")).reshape(len(entries), -1)

    def linear(self, cell: Cell, transform: Complex, fields: range = FIELDS) -> Array:
        """``mean of weights . fields`` for each mode, shape (modes,). Waves that are none of the cell's give 0.

        Args:
            cell: whose grid the weights are given on.
            transform: Fourier coefficients of the weights, from ``Cell.transform``.
            fields: which of the ten fields they are the weights of.
        """
        return self._means(cell, self.waves.symbols, fields, transform)

    def pushed(self, cell: Cell, transform: Complex) -> Array:
        """``mean of weights . displacement`` for each mode, shape (modes,); see ``linear``."""
        return self._means(cell, self.waves.displacements, range(2), transform)

    def _means(self, cell: Cell, symbols: Complex, entries: range, transform: Complex) -> Array:
        waves = self.waves
        return np.asarray(
            means_over_modes(*self._columns, transform, symbols, entries.start, waves.p, waves.b, *cell.sizes)
        )

    @property
    def _columns(self) -> tuple[NDArray[np.int32], NDArray[np.int32], Complex]:
        """Where the waves of each mode start, their numbers and coefficients, as the compiled loops take them."""
        return self.coefficients.indptr, self.coefficients.indices, self.coefficients.data


class Families(NamedTuple):
    """Modes of some families, one after the other, as sums of the waves that they share.

    Attributes:
        starts: where the waves of each mode start, and the end.
        places: of these waves in their groups (``Waves.groups``).
        factors: their coefficients, or those divided by ``i``.
        kinds: of the modes: 1 where their coefficients are imaginary, else 0.
        listed: the modes by the groups of their waves, and by families.
        bounds: where the modes of each group and family start in that list, and end, shape (groups, families + 1).
        rows: of the modes in their families.
        sizes: of the families.
    """

    starts: NDArray[np.intp]
    places: NDArray[np.intp]
    factors: Array
    kinds: NDArray[np.intp]
    listed: NDArray[np.intp]
    bounds: NDArray[np.intp]
    rows: NDArray[np.intp]
    sizes: NDArray[np.intp]

    @classmethod
    @lru_cache(maxsize=32)
    def of(cls, *families: ModeWaves) -> Families:
        """Families of the same waves; all points of a branch on some modes have the same ones."""
        columns = [family.coefficients for family in families]
        sizes = np.array([c.shape[1] for c in columns])
        starts = np.append(0, np.cumsum(np.concatenate([np.diff(c.indptr) for c in columns])))
        waves = np.concatenate([c.indices for c in columns])
        order, first = families[0].waves.groups
        group, place = np.empty_like(order), np.empty_like(order)
        group[order] = np.repeat(np.arange(len(first) - 1), np.diff(first))
        place[order] = np.arange(len(order)) - first[group[order]]
        of_modes, family = group[waves[starts[:-1]]], np.repeat(np.arange(len(sizes)), sizes)
        listed = np.lexsort((family, of_modes))
        counts = np.zeros((len(first) - 1, len(sizes)), dtype=np.intp)
        np.add.at(counts, (of_modes, family), 1)
        bounds = np.cumsum(counts).reshape(counts.shape)
        bounds = np.column_stack((bounds[:, 0] - counts[:, 0], bounds))
        rows = np.concatenate([np.arange(size) for size in sizes])
        values = np.concatenate([c.data for c in columns])
        kinds = (values.real[starts[:-1]] == 0).astype(np.intp)
        return cls(starts, place[waves], values.real + values.imag, kinds, listed, bounds, rows, sizes)


def _wave_entries(mode: Mode) -> list[tuple[tuple[int, int], complex]]:
    """The waves of a product of a cosine or sine along the tube and one around it, with their coefficients."""
    p, b = mode.p, mode.harmonic
    along = 1.0 + 0j if mode.along == "cos" else -1j  # sine = Re(-i e^{i..})
    around = 1.0 + 0j if mode.is_even else -1j
    if p and b:
        return [((p, b), along * around / 2), ((p, -b), along * around.conjugate() / 2)]
    return [((p, b), along * around)]
