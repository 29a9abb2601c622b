"""Waves ``e^{i(p k x + b phi)}`` and what quadratic and linear forms over a surface make of them.

All of a mode's fields are waves times constant factors (its symbol), so a form ``mean of z . W z`` is a Fourier coefficient of
the weights ``W`` at the difference of two waves: nothing is summed over points for each pair. On a grid the coefficients are
those of its trapezoidal sum, so the forms are the exact derivatives of that sum (``docs/theory/reduced_modes.md``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft2, rfft2
from scipy.sparse import csc_array

from pearlbvp.arrays import Array, Complex
from pearlbvp.representation import brief
from pearlbvp.tube.kernels import (
    add_sections,
    all_frequencies,
    lower_halves,
    means_over_modes,
    reduced_to_modes,
    spectrum_of_modes,
    wave_forms,
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
        """What the fields are made of (``fields_of_jets``), shape (Q, 10), those of ``IMAGINARY_JETS`` divided by ``i``.

        Of a wave of ``sigma`` the first six: ``v, v_xx, v_xphi, v_phiphi, v_x, v_phi``. Of one of the centre the last four:
        ``a_1, p_0, a_0, p_1`` of its shift ``e^{i k x}``, seen at ``b = 1`` and ``-1``, turned by the frame and ``phi``.
        """
        k, b, zero = self.p * self.k, self.b, np.zeros((6, len(self.p)))
        turning = k - b * self.kappa
        section = np.array([np.ones(len(k)), -(k**2), -k * b, -(b**2), k, b, *zero[:4]])
        centre = np.array([*zero, -b * turning, -(turning**2), turning, -b * turning**2])
        return np.ascontiguousarray(np.where(self.centre, centre, section).T)

    @cached_property
    def symbols(self) -> Complex:
        """The ten fields of each wave (``tube.density``), shape (Q, 10)."""
        phases = np.where(np.isin(np.arange(10), IMAGINARY_JETS), 1j, 1.0)
        return np.asarray((self.jets * phases) @ fields_of_jets(self.kappa).T)

    @cached_property
    def moved(self) -> Array:
        """What each wave moves points by in the plane, turned as the fields are, the second divided by ``i``: (Q, 2)."""
        return np.stack((np.ones(len(self.b)), np.where(self.centre, self.b, 0.0)), axis=1)

    @cached_property
    def displacements(self) -> Complex:
        """The same, nothing divided."""
        return self.moved * np.array((1.0, 1j))

    def bending_forms(self, cell: Cell, transform: MatrixTransform) -> Forms:
        """``mean of z . W z'`` of the jets ``z`` of each pair of waves, ``W`` given as ``matrix_transform``."""
        ends = np.where(self.centre[:, None], (6, 10), (0, 6))
        forms = self._forms(cell, self.jets, ends, transform, of_centre=True)
        order = np.argsort(self.p, kind="stable")
        order = order[~self.centre[order]]
        starts = np.append(np.flatnonzero(np.diff(self.p[order], prepend=-1)), len(order))
        add_sections(
            tuple(forms[:3]), self.k, self.p, self.b, order, starts, transform.coefficients, cell.period, cell.fold
        )
        return forms

    def moving_forms(self, cell: Cell, transform: MatrixTransform) -> Forms:
        """``mean of z . W z'`` of the displacements ``z`` of each pair of waves, ``W`` given as ``matrix_transform``."""
        return self._forms(cell, self.moved, self._moved_ends, transform)

    def dragging_forms(self, cell: Cell, transform: MatrixTransform) -> Forms:
        """``mean of z . W z'`` of one wave's displacement ``z``, and another's displacement and first four fields ``z'``.

        ``W`` is given as ``matrix_transform`` of 6 x 6 matrices for vectors with the ``IMAGINARY_DRAGS``; what they say of two
        fields is not used.
        """
        changed = np.hstack((self.moved, (self.symbols[:, :4] / (1j, 1.0, 1j, 1.0)).real))
        ends = np.where(self.centre[:, None], (0, 4), (0, 6))
        found = wave_forms(
            self.moved, self._moved_ends, changed, ends, self.p, self.b, *transform, cell.period, cell.fold, False, False
        )  # fmt: skip
        return Forms(*found)

    @property
    def _moved_ends(self) -> NDArray[np.intp]:
        """First and last entry but one of ``moved`` that are not zero."""
        return np.where(self.centre[:, None], (0, 2), (0, 1))

    def _forms(
        self, cell: Cell, z: Array, ends: NDArray[np.intp], transform: MatrixTransform, *, of_centre: bool = False
    ) -> Forms:
        found = wave_forms(z, ends, z, ends, self.p, self.b, *transform, cell.period, cell.fold, True, of_centre)
        return Forms(*found[:3])


IMAGINARY_JETS = (4, 5, 8, 9)
"""Jets of a wave that are imaginary: first derivatives of ``sigma``, and ``a_0`` and ``p_1`` of the centre."""

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


class Forms(NamedTuple):
    """``mean of f . W f'`` of real and imaginary parts of waves, each of shape (Q, Q).

    Attributes:
        cosines: of two real parts ``Re e^{iq}``.
        sines: of two ``-Im e^{iq}``, the real parts of ``i e^{iq}``.
        mixed: of an ``-Im e^{iq}`` (rows) and a ``Re e^{iq}``.
        turned: of a ``Re e^{iq}`` (rows) and an ``-Im e^{iq}``; None where the form is symmetric.
    """

    cosines: Array
    sines: Array
    mixed: Array
    turned: Array | None = None


class MatrixTransform(NamedTuple):
    """Fourier coefficients of matrices W, times the phases of what stands left (conjugate) and right of them, 1 or i.

    Attributes:
        coefficients: shape (1 or 2, points along, points around, F, F), real and imaginary parts first. Where the surface is
            even along and around, all are real.
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
    lower = lower_halves(weights, np.eye(size) if basis is None else basis)
    half = rfft2(lower.reshape(-1, *cell.points), norm="forward")
    signs = np.where(np.isin(np.arange(size), imaginary), -1.0, 1.0)
    return MatrixTransform(all_frequencies(half, cell.points[1], signs), signs)


# Arrays of megabytes are costly to come by, whatever is done with them: these loops make few.


@dataclass(frozen=True)
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

    def quadratic(self, forms: Forms) -> Array:
        """``mean of f . W f'`` for each pair of modes, from those of their waves: shape (modes, modes)."""
        symmetric = forms.turned is None
        turned = forms.mixed.T if symmetric else forms.turned
        return np.asarray(reduced_to_modes(*self._columns, *forms[:3], turned, symmetric))


def _wave_entries(mode: Mode) -> list[tuple[tuple[int, int], complex]]:
    """The waves of a product of a cosine or sine along the tube and one around it, with their coefficients."""
    p, b = mode.p, mode.harmonic
    along = 1.0 + 0j if mode.along == "cos" else -1j  # sine = Re(-i e^{i..})
    around = 1.0 + 0j if mode.is_even else -1j
    if p and b:
        return [((p, b), along * around / 2), ((p, -b), along * around.conjugate() / 2)]
    return [((p, b), along * around)]
