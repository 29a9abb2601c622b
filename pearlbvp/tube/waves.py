"""Waves ``e^{i(p k x + b phi)}`` and what quadratic and linear forms over a surface make of them.

All of a mode's fields are waves times constant factors (its symbol), so a form ``mean of z . W z`` is a Fourier coefficient of
the weights ``W`` at the difference of two waves: nothing is summed over points for each pair. On a grid the coefficients are
those of its trapezoidal sum, so the forms are the exact derivatives of that sum (design, §7).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import rfft2
from scipy.sparse import csc_array, csr_array

from pearlbvp.arrays import Array, Complex
from pearlbvp.compiled import compiled
from pearlbvp.representation import brief
from pearlbvp.tube.modes import Mode


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

    def places(self, p: NDArray[np.intp], b: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Places of waves of the cell in its discrete Fourier transform."""
        along, around = p // (self.period or 1), b // (self.fold or 1)
        return along % self.points[0], around % self.points[1]

    def transform(self, values: NDArray[Any]) -> Complex:
        """Fourier coefficients of functions on the grid, shape (..., K): shape (..., points along, points around)."""
        count = self.points[0] * self.points[1]
        return np.asarray(np.fft.fft2(values.reshape(*values.shape[:-1], *self.points)) / count)


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
        """The ten fields of each wave (``tube.modes``), shape (Q, 10)."""
        phases = np.where(np.isin(np.arange(10), IMAGINARY_JETS), 1j, 1.0)
        return np.asarray((self.jets * phases) @ fields_of_jets(self.kappa).T)

    @cached_property
    def moved(self) -> Array:
        """What each wave moves points by in the plane, turned as the fields are, the second divided by ``i``: (Q, 2)."""
        return np.stack((np.ones(len(self.b)), np.where(self.centre, self.b, 0.0)), axis=1)

    def bending_forms(self, cell: Cell, transform: MatrixTransform) -> Forms:
        """``mean of z . W z'`` of the jets ``z`` of each pair of waves, ``W`` given as ``matrix_transform``."""
        first, last = np.where(self.centre, 6, 0), np.where(self.centre, 10, 6)
        forms = self._forms(cell, self.jets, first, last, transform, of_centre=True)
        order = np.argsort(self.p, kind="stable")
        order = order[~self.centre[order]]
        starts = np.append(np.flatnonzero(np.diff(self.p[order], prepend=-1)), len(order))
        _add_sections(tuple(forms), self.k, self.p, self.b, order, starts, *transform, cell.period, cell.fold)
        return forms

    def moving_forms(self, cell: Cell, transform: MatrixTransform) -> Forms:
        """``mean of z . W z'`` of the displacements ``z`` of each pair of waves, ``W`` given as ``matrix_transform``."""
        return self._forms(cell, self.moved, np.zeros_like(self.p), np.where(self.centre, 2, 1), transform)

    def _forms(
        self,
        cell: Cell,
        z: Array,
        first: NDArray[np.intp],
        last: NDArray[np.intp],
        transform: MatrixTransform,
        *,
        of_centre: bool = False,
    ) -> Forms:
        return Forms(*_forms(z, first, last, self.p, self.b, *transform, cell.period, cell.fold, of_centre))


IMAGINARY_JETS = (4, 5, 8, 9)
"""Jets of a wave that are imaginary: first derivatives of ``sigma``, and ``a_0`` and ``p_1`` of the centre."""


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
    """

    cosines: Array
    sines: Array
    mixed: Array


MatrixTransform = tuple[Array, Array]
"""Fourier coefficients of matrices W, times the phases of what stands left and right of them (1 or i), the left one conjugate
in the first; each of shape (1 or 2, points along, points around, F, F), real and imaginary parts first. Where the surface is
even along and around, all are real."""

REAL = 1e-14
"""Imaginary parts below this, by the largest coefficient, are rounding."""


def matrix_transform(cell: Cell, weights: Array, imaginary: Sequence[int]) -> MatrixTransform:
    """Fourier coefficients of symmetric matrices on a cell's grid, shape (K, F, F), for vectors with ``imaginary`` entries."""
    size = weights.shape[1]
    rows, columns = np.tril_indices(size)
    half = rfft2(weights[:, rows, columns].T.reshape(-1, *cell.points), norm="forward")
    phases = np.where(np.isin(np.arange(size), imaginary), 1j, 1.0)
    straight, crossed = np.outer(phases.conj(), phases), np.outer(phases, phases)
    # A coefficient of two real entries, or two imaginary ones, is real on an even surface; of one of each it is imaginary.
    turned = half * straight[rows, columns][:, None, None]
    parts = 2 if np.abs(turned.imag).max() > REAL * np.abs(half).max() else 1
    found = _all_frequencies(half, cell.points[1], rows, columns, straight, crossed, parts)
    return found[0], found[1]


@compiled
def _all_frequencies(half, around, rows, columns, straight, crossed, parts):  # type: ignore[no-untyped-def]
    """Whole symmetric matrices at all frequencies, from their lower halves at those that a real transform keeps."""
    count, along, kept = half.shape
    size = len(straight)
    full = np.empty((2, parts, along, around, size, size))
    for x in range(along):
        for y in range(around):
            mirrored = y >= kept
            at_x, at_y = ((along - x) % along, around - y) if mirrored else (x, y)
            for entry in range(count):
                value = half[entry, at_x, at_y]
                if mirrored:
                    value = np.conj(value)
                for a, c in ((rows[entry], columns[entry]), (columns[entry], rows[entry])):
                    first, second = value * straight[a, c], value * crossed[a, c]
                    full[0, 0, x, y, a, c], full[1, 0, x, y, a, c] = first.real, second.real
                    if parts > 1:
                        full[0, 1, x, y, a, c], full[1, 1, x, y, a, c] = first.imag, second.imag
    return full


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

    def state(self, cell: Cell, coefficients: Array) -> Array:
        """The ten fields of a sum of modes on a cell's grid, shape (10, K)."""
        spectrum = np.zeros((10, *cell.points), dtype=complex)
        amplitudes = self.waves.symbols * (self.coefficients @ coefficients)[:, None]
        spectrum[(slice(None), *cell.places(self.waves.p, self.waves.b))] = amplitudes.T
        return np.ascontiguousarray(np.fft.ifft2(spectrum, norm="forward").real.reshape(10, -1))

    def linear(self, cell: Cell, transform: Complex) -> Array:
        """``mean of weights . fields`` for each mode, shape (modes,). Waves that are none of the cell's give 0.

        Args:
            cell: whose grid the weights are given on.
            transform: Fourier coefficients of the weights (10, K), from ``Cell.transform``.
        """
        p, b = self.waves.p, self.waves.b
        at = transform[(slice(None), *cell.places(-p, -b))]
        own = _multiple(p, cell.period) & _multiple(b, cell.fold)
        return np.asarray((self._transposed @ ((self.waves.symbols * at.T).sum(axis=1) * own)).real)

    def quadratic(self, forms: Forms) -> Array:
        """``mean of f . W f'`` for each pair of modes, from those of their waves: symmetric, shape (modes, modes)."""
        cosines, sines = self._parts
        total = np.zeros((len(self.modes), len(self.modes)))
        if cosines.nnz:
            total += _congruent(cosines, forms.cosines, cosines)
        if sines.nnz:
            total += _congruent(sines, forms.sines, sines)
        if cosines.nnz and sines.nnz:
            mixed = _congruent(sines, forms.mixed, cosines)
            total += mixed + mixed.T
        return total

    @cached_property
    def _parts(self) -> tuple[csr_array, csr_array]:
        """Transposed real and imaginary parts of the coefficients."""
        found = []
        for part in (self.coefficients.real, self.coefficients.imag):
            part = csr_array(part.T, copy=True)  # dropping its zeros must not touch what it is a view of
            part.eliminate_zeros()
            found.append(part)
        return found[0], found[1]

    @cached_property
    def _transposed(self) -> csr_array:
        return self.coefficients.T


def _congruent(left: csr_array, matrix: Array, right: csr_array) -> Array:
    """``left matrix right^T``."""
    return np.asarray((right @ (left @ matrix).T).T)


def _wave_entries(mode: Mode) -> list[tuple[tuple[int, int], complex]]:
    """The waves of a product of a cosine or sine along the tube and one around it, with their coefficients."""
    p, b = int(mode.p), mode.harmonic
    along = 1.0 + 0j if mode.along == "cos" else -1j  # sine = Re(-i e^{i..})
    around = 1.0 + 0j if mode.is_even else -1j
    if p and b:
        return [((p, b), along * around / 2), ((p, -b), along * around.conjugate() / 2)]
    return [((p, b), along * around)]


def _multiple(number: NDArray[np.intp], unit: int) -> NDArray[np.bool_]:
    return number == 0 if unit == 0 else number % unit == 0


@compiled
def _place(number, unit, points):  # type: ignore[no-untyped-def]
    """Place of a wave number in a transform, or -1 for none of its."""
    if unit == 0:
        return 0 if number == 0 else -1
    return (number // unit) % points if number % unit == 0 else -1


@compiled
def _forms(z, first, last, p, b, straight, crossed, period, fold, of_centre):  # type: ignore[no-untyped-def]
    """``cosines``, ``sines`` and ``mixed`` of ``Forms``; only entries ``first`` to ``last`` of a wave's ``z`` are not zero.

    With ``of_centre``, of the pairs alone of which one or both move the centre.
    """
    count, parts, along, around = len(p), straight.shape[0], straight.shape[1], straight.shape[2]
    cosines, sines, mixed = np.zeros((count, count)), np.zeros((count, count)), np.zeros((count, count))
    for i in range(count):
        for j in range(i + 1):
            if of_centre and abs(b[i]) != 1 and abs(b[j]) != 1:
                continue
            re = im = re2 = im2 = 0.0
            x, y = _place(p[i] - p[j], period, along), _place(b[i] - b[j], fold, around)
            if x >= 0 and y >= 0:  # mean of conj(z e^{iq}) . W z' e^{iq'}
                for a in range(first[i], last[i]):
                    for c in range(first[j], last[j]):
                        factor = z[i, a] * z[j, c]
                        re += factor * straight[0, x, y, a, c]
                        if parts > 1:
                            im += factor * straight[1, x, y, a, c]
            x, y = _place(-p[i] - p[j], period, along), _place(-b[i] - b[j], fold, around)
            if x >= 0 and y >= 0:  # and without the conjugate
                for a in range(first[i], last[i]):
                    for c in range(first[j], last[j]):
                        factor = z[i, a] * z[j, c]
                        re2 += factor * crossed[0, x, y, a, c]
                        if parts > 1:
                            im2 += factor * crossed[1, x, y, a, c]
            cosines[i, j] = cosines[j, i] = (re + re2) / 2
            sines[i, j] = sines[j, i] = (re - re2) / 2
            mixed[i, j], mixed[j, i] = (im - im2) / 2, (-im - im2) / 2
    return cosines, sines, mixed


@compiled
def _powers_of_b(weights, one, other):  # type: ignore[no-untyped-def]
    """Sections' jets contracted but for their powers of ``b``, at all frequencies around: shape (points around, 9).

    Jets of a section are ``1, -k^2, -k b, -b^2, k, b``: entry ``3 u + v`` belongs to ``b^u b'^v``.

    Args:
        weights: matrices at one frequency along, shape (points around, F, F).
        one, other: the numbers ``k`` of the two waves.
    """
    found = np.empty((len(weights), 9))
    left, right = (1.0, -(one**2), -one, -1.0, one, 1.0), (1.0, -(other**2), -other, -1.0, other, 1.0)
    half = np.empty((3, 6))
    for y in range(len(weights)):
        w = weights[y]
        for c in range(6):
            half[0, c] = w[0, c] + left[1] * w[1, c] + left[4] * w[4, c]
            half[1, c] = left[2] * w[2, c] + w[5, c]
            half[2, c] = -w[3, c]
        for u in range(3):
            found[y, 3 * u] = half[u, 0] + right[1] * half[u, 1] + right[4] * half[u, 4]
            found[y, 3 * u + 1] = right[2] * half[u, 2] + half[u, 5]
            found[y, 3 * u + 2] = -half[u, 3]
    return found


@compiled
def _add_sections(forms, k, p, b, order, starts, straight, crossed, period, fold):  # type: ignore[no-untyped-def]
    """Add the pairs of two sections to ``cosines``, ``sines`` and ``mixed``.

    Args:
        forms: the three, to be added to.
        k: unit of the wave numbers along.
        p, b: wave numbers.
        order: waves of sections, those of one ``p`` together.
        starts: where each ``p`` starts in that order, and the end.
        straight, crossed: as ``matrix_transform`` gives them.
        period, fold: of the cell.
    """
    cosines, sines, mixed = forms
    parts, along, around = straight.shape[0], straight.shape[1], straight.shape[2]
    for first in range(len(starts) - 1):
        for second in range(first + 1):
            one, other = p[order[starts[first]]], p[order[starts[second]]]
            for sign in (1, -1):  # of the first wave: its conjugate, and itself
                x = _place(sign * one - other, period, along)
                if x < 0:
                    continue
                for part in range(parts):
                    weights = straight[part, x] if sign == 1 else crossed[part, x]
                    table = _powers_of_b(weights, one * k, other * k)
                    for at in range(starts[first], starts[first + 1]):
                        i = order[at]
                        end = starts[second + 1] if second < first else at + 1
                        for beside in range(starts[second], end):
                            j = order[beside]
                            y = _place(sign * b[i] - b[j], fold, around)
                            if y < 0:
                                continue
                            t, c, d = table[y], b[i], b[j]
                            value = (
                                t[0]
                                + d * (t[1] + d * t[2])
                                + c * (t[3] + d * (t[4] + d * t[5]) + c * (t[6] + d * (t[7] + d * t[8])))
                            ) / 2
                            if part == 0:
                                cosines[i, j] += value
                                sines[i, j] += sign * value
                                if i != j:
                                    cosines[j, i] += value
                                    sines[j, i] += sign * value
                            else:
                                mixed[i, j] += sign * value
                                if i != j:
                                    mixed[j, i] -= value
