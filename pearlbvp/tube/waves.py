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
from pearlbvp.compiled import compiled
from pearlbvp.representation import brief
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
        _add_sections(
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
        found = _forms(
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
        found = _forms(z, ends, z, ends, self.p, self.b, *transform, cell.period, cell.fold, True, of_centre)
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


REAL = 1e-14
"""Imaginary parts below this, by the largest coefficient, are rounding."""


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
    lower = _lower_halves(weights, np.eye(size) if basis is None else basis)
    half = rfft2(lower.reshape(-1, *cell.points), norm="forward")
    signs = np.where(np.isin(np.arange(size), imaginary), -1.0, 1.0)
    return MatrixTransform(_all_frequencies(half, cell.points[1], signs), signs)


# Arrays of megabytes are costly to come by, whatever is done with them: these loops make few.


@compiled
def _lower_halves(weights, basis):  # type: ignore[no-untyped-def]
    """Lower halves, row by row, of ``basis^T weights basis`` at each point: shape (F(F + 1)/2, K)."""
    count, size = weights.shape[:2]
    found = np.empty((size * (size + 1) // 2, count))
    used = np.zeros((size, size), dtype=np.int64)  # rows of each column of the basis that are not zero
    many = np.zeros(size, dtype=np.int64)
    for a in range(size):
        for i in range(size):
            if basis[i, a] != 0:
                used[a, many[a]] = i
                many[a] += 1
    for k in range(count):
        entry = 0
        for a in range(size):
            for c in range(a + 1):
                total = 0.0
                for i in used[a, : many[a]]:
                    for j in used[c, : many[c]]:
                        total += basis[i, a] * basis[j, c] * weights[k, i, j]
                found[entry, k] = total
                entry += 1
    return found


@compiled
def _all_frequencies(half, around, signs):  # type: ignore[no-untyped-def]
    """Whole symmetric matrices at all frequencies, times phases, from lower halves at those that a real transform keeps."""
    along, kept = half.shape[1:]
    size = len(signs)
    # A coefficient of two real entries, or two imaginary ones, is real on an even surface; of one of each it is imaginary.
    largest = odd = 0.0
    entry = 0
    for a in range(size):
        for c in range(a + 1):
            for value in half[entry].flat:
                real, imaginary = abs(value.real), abs(value.imag)
                largest = max(largest, real, imaginary)
                odd = max(odd, imaginary if signs[a] == signs[c] else real)
            entry += 1
    full = np.empty((2 if odd > REAL * largest else 1, along, around, size, size))
    for x in range(along):
        for y in range(around):
            mirrored = y >= kept
            at_x, at_y = ((along - x) % along, around - y) if mirrored else (x, y)
            entry = 0
            for a in range(size):
                for c in range(a + 1):
                    value = half[entry, at_x, at_y]
                    if mirrored:
                        value = np.conj(value)
                    if signs[a] == signs[c]:
                        full[0, x, y, a, c] = full[0, x, y, c, a] = value.real
                        if len(full) > 1:
                            full[1, x, y, a, c] = full[1, x, y, c, a] = value.imag
                    else:  # times -i where the left one is imaginary, times i where the right one is
                        full[0, x, y, a, c] = -signs[a] * value.imag
                        full[0, x, y, c, a] = -signs[c] * value.imag
                        if len(full) > 1:
                            full[1, x, y, a, c] = signs[a] * value.real
                            full[1, x, y, c, a] = signs[c] * value.real
                    entry += 1
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

    def state(self, cell: Cell, coefficients: Array, fields: range = FIELDS) -> Array:
        """Fields of a sum of modes on a cell's grid, all ten or a range of them: shape (fields, K)."""
        return self._sums(cell, self.waves.symbols, fields, coefficients)

    def displacement(self, cell: Cell, coefficients: Array) -> Array:
        """What a sum of modes moves points by in the plane, turned as the fields are, on a cell's grid: shape (2, K)."""
        return self._sums(cell, self.waves.displacements, range(2), coefficients)

    def _sums(self, cell: Cell, symbols: Complex, entries: range, coefficients: Array) -> Array:
        waves, (along, around) = self.waves, cell.points
        spectrum = _spectrum(
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
        return np.asarray(_means(*self._columns, transform, symbols, entries.start, waves.p, waves.b, *cell.sizes))

    @property
    def _columns(self) -> tuple[NDArray[np.int32], NDArray[np.int32], Complex]:
        """Where the waves of each mode start, their numbers and coefficients, as the compiled loops take them."""
        return self.coefficients.indptr, self.coefficients.indices, self.coefficients.data

    def quadratic(self, forms: Forms) -> Array:
        """``mean of f . W f'`` for each pair of modes, from those of their waves: shape (modes, modes)."""
        symmetric = forms.turned is None
        turned = forms.mixed.T if symmetric else forms.turned
        return np.asarray(_of_modes(*self._columns, *forms[:3], turned, symmetric))


@compiled
def _spectrum(starts, waves, coefficients, values, symbols, first, last, p, b, period, fold, along, around):  # type: ignore[no-untyped-def]
    """Spectra, as a real transform takes them, of some entries of the symbols of a sum of modes.

    Args:
        starts, waves, coefficients: the modes as sums of waves, by columns of a sparse matrix.
        values: coefficients of the modes.
        symbols: of the waves.
        first, last: entry of the symbols, and the last but one.
        p, b: wave numbers.
        period, fold, along, around: of the cell.
    """
    amplitudes = np.zeros(len(p), dtype=np.complex128)
    for mode in range(len(values)):
        for i in range(starts[mode], starts[mode + 1]):
            amplitudes[waves[i]] += coefficients[i] * values[mode]
    found = np.zeros((last - first, along // 2 + 1, around), dtype=np.complex128)
    for q in range(len(p)):
        x, y = _place(p[q], period, along), _place(b[q], fold, around)
        if x < 0 or y < 0:
            continue
        mirrored = 2 * x > along
        # The transform adds its conjugate to each wave of 0 < 2 x < along, and takes the real part of the others.
        share = 1.0 if x == 0 or 2 * x == along else 0.5
        for entry in range(last - first):
            value = share * amplitudes[q] * symbols[q, first + entry]
            if mirrored:
                found[entry, along - x, (around - y) % around] += np.conj(value)
            else:
                found[entry, x, y] += value
    return found


@compiled
def _means(starts, waves, coefficients, transform, symbols, first, p, b, period, fold, along, around):  # type: ignore[no-untyped-def]
    """Means of given functions times entries of the symbols of each mode, from the first one on; see ``_spectrum``."""
    of_waves = np.zeros(len(p), dtype=np.complex128)
    for q in range(len(p)):
        x, y = _place(p[q], period, along), _place(b[q], fold, around)
        if x < 0 or y < 0:
            continue
        for entry in range(len(transform)):
            if 2 * x > along:
                value = transform[entry, along - x, (around - y) % around]
            else:
                value = np.conj(transform[entry, x, y])
            of_waves[q] += value * symbols[q, first + entry]
    found = np.zeros(len(starts) - 1)
    for mode in range(len(found)):
        for i in range(starts[mode], starts[mode + 1]):
            found[mode] += (coefficients[i] * of_waves[waves[i]]).real
    return found


@compiled
def _of_modes(starts, waves, coefficients, cosines, sines, mixed, turned, symmetric):  # type: ignore[no-untyped-def]
    """A form of each pair of modes, from the four parts of ``Forms``.

    Args:
        starts, waves, coefficients: the modes as sums of waves, by columns of a sparse matrix.
        cosines, sines, mixed, turned: of the waves.
        symmetric: whether the form is.
    """
    count = len(starts) - 1
    found = np.empty((count, count))
    real, imaginary = np.empty(len(cosines)), np.empty(len(cosines))
    for m in range(count):
        real[:], imaginary[:] = 0.0, 0.0  # the form of the mode and either part of each wave
        for i in range(starts[m], starts[m + 1]):
            c, q = coefficients[i], waves[i]
            if c.real != 0:
                for w in range(len(real)):
                    real[w] += c.real * cosines[q, w]
                    imaginary[w] += c.real * turned[q, w]
            if c.imag != 0:
                for w in range(len(real)):
                    real[w] += c.imag * mixed[q, w]
                    imaginary[w] += c.imag * sines[q, w]
        for n in range(m + 1 if symmetric else count):
            total = 0.0
            for j in range(starts[n], starts[n + 1]):
                total += coefficients[j].real * real[waves[j]] + coefficients[j].imag * imaginary[waves[j]]
            found[m, n] = total
            if symmetric:
                found[n, m] = total
    return found


def _wave_entries(mode: Mode) -> list[tuple[tuple[int, int], complex]]:
    """The waves of a product of a cosine or sine along the tube and one around it, with their coefficients."""
    p, b = mode.p, mode.harmonic
    along = 1.0 + 0j if mode.along == "cos" else -1j  # sine = Re(-i e^{i..})
    around = 1.0 + 0j if mode.is_even else -1j
    if p and b:
        return [((p, b), along * around / 2), ((p, -b), along * around.conjugate() / 2)]
    return [((p, b), along * around)]


@compiled
def _place(number, unit, points):  # type: ignore[no-untyped-def]
    """Place of a wave number in a transform, or -1 for none of its."""
    if unit == 0:
        return 0 if number == 0 else -1
    return (number // unit) % points if number % unit == 0 else -1


@compiled
def _forms(z, rows, other, columns, p, b, weights, signs, period, fold, symmetric, of_centre):  # type: ignore[no-untyped-def]
    """The four parts of ``Forms``.

    Args:
        z, other: vectors left and right of the matrices, for each wave.
        rows, columns: first and last entry but one of them that are not zero, for each wave.
        p, b: wave numbers.
        weights, signs: as ``matrix_transform`` gives them.
        period, fold: of the cell.
        symmetric: whether the vectors are the same on both sides: then the last part is empty.
        of_centre: take only the pairs of which one or both move the centre.
    """
    count, parts, along, around = len(p), weights.shape[0], weights.shape[1], weights.shape[2]
    cosines, sines, mixed = np.zeros((count, count)), np.zeros((count, count)), np.zeros((count, count))
    turned = np.zeros((0, 0) if symmetric else (count, count))
    for i in range(count):
        for j in range(i + 1 if symmetric else count):
            if of_centre and abs(b[i]) != 1 and abs(b[j]) != 1:
                continue
            re = im = re2 = im2 = 0.0
            x, y = _place(p[i] - p[j], period, along), _place(b[i] - b[j], fold, around)
            if x >= 0 and y >= 0:  # mean of conj(z e^{iq}) . W z' e^{iq'}
                for a in range(rows[i, 0], rows[i, 1]):
                    for c in range(columns[j, 0], columns[j, 1]):
                        factor = z[i, a] * other[j, c]
                        re += factor * weights[0, x, y, a, c]
                        if parts > 1:
                            im += factor * weights[1, x, y, a, c]
            x, y = _place(-p[i] - p[j], period, along), _place(-b[i] - b[j], fold, around)
            if x >= 0 and y >= 0:  # and without the conjugate: that of the opposite wave
                for a in range(rows[i, 0], rows[i, 1]):
                    for c in range(columns[j, 0], columns[j, 1]):
                        factor = signs[a] * z[i, a] * other[j, c]
                        re2 += factor * weights[0, x, y, a, c]
                        if parts > 1:
                            im2 += factor * weights[1, x, y, a, c]
            cosines[i, j], sines[i, j], mixed[i, j] = (re + re2) / 2, (re - re2) / 2, (im - im2) / 2
            if symmetric:
                cosines[j, i], sines[j, i], mixed[j, i] = cosines[i, j], sines[i, j], (-im - im2) / 2
            else:
                turned[i, j] = (-im - im2) / 2
    return cosines, sines, mixed, turned


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
def _add_sections(forms, k, p, b, order, starts, weights, period, fold):  # type: ignore[no-untyped-def]
    """Add the pairs of two sections to ``cosines``, ``sines`` and ``mixed``.

    Args:
        forms: the three, to be added to.
        k: unit of the wave numbers along.
        p, b: wave numbers.
        order: waves of sections, those of one ``p`` together.
        starts: where each ``p`` starts in that order, and the end.
        weights: coefficients of a ``MatrixTransform``.
        period, fold: of the cell.
    """
    cosines, sines, mixed = forms
    parts, along, around = weights.shape[0], weights.shape[1], weights.shape[2]
    for first in range(len(starts) - 1):
        for second in range(first + 1):
            one, other = p[order[starts[first]]], p[order[starts[second]]]
            for sign in (1, -1):  # the conjugate of the first wave, and that of the opposite one
                x = _place(sign * one - other, period, along)
                if x < 0:
                    continue
                for part in range(parts):
                    table = _powers_of_b(weights[part, x], sign * one * k, other * k)
                    for at in range(starts[first], starts[first + 1]):
                        i = order[at]
                        end = starts[second + 1] if second < first else at + 1
                        for beside in range(starts[second], end):
                            j = order[beside]
                            y = _place(sign * b[i] - b[j], fold, around)
                            if y < 0:
                                continue
                            t, c, d = table[y], sign * b[i], b[j]
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
