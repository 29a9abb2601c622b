"""Compiled sums over the modes, waves and points of a tube; what they are sums of is in ``tube.waves``."""

from __future__ import annotations

import numpy as np

from pearlbvp.compiled import compiled

REAL = 1e-14
"""Imaginary parts below this, by the largest coefficient, are rounding."""


@compiled
def lower_halves(weights, basis):  # type: ignore[no-untyped-def]
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
def all_frequencies(half, around, signs):  # type: ignore[no-untyped-def]
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


@compiled
def spectrum_of_modes(starts, waves, coefficients, values, symbols, first, last, p, b, period, fold, along, around):  # type: ignore[no-untyped-def]
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
        x, y = folded(p[q], period, along), folded(b[q], fold, around)
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
def means_over_modes(starts, waves, coefficients, transform, symbols, first, p, b, period, fold, along, around):  # type: ignore[no-untyped-def]
    """Means of given functions times entries of the symbols of each mode, from the first one on; see ``spectrum_of_modes``."""
    of_waves = np.zeros(len(p), dtype=np.complex128)
    for q in range(len(p)):
        x, y = folded(p[q], period, along), folded(b[q], fold, around)
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
def reduced_to_modes(starts, waves, coefficients, cosines, sines, mixed, turned, symmetric):  # type: ignore[no-untyped-def]
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


@compiled
def folded(number, unit, points):  # type: ignore[no-untyped-def]
    """Place of a wave number in a transform, or -1 for none of its."""
    if unit == 0:
        return 0 if number == 0 else -1
    return (number // unit) % points if number % unit == 0 else -1


@compiled
def wave_forms(z, rows, other, columns, p, b, weights, signs, period, fold, symmetric, of_centre):  # type: ignore[no-untyped-def]
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
            x, y = folded(p[i] - p[j], period, along), folded(b[i] - b[j], fold, around)
            if x >= 0 and y >= 0:  # mean of conj(z e^{iq}) . W z' e^{iq'}
                for a in range(rows[i, 0], rows[i, 1]):
                    for c in range(columns[j, 0], columns[j, 1]):
                        factor = z[i, a] * other[j, c]
                        re += factor * weights[0, x, y, a, c]
                        if parts > 1:
                            im += factor * weights[1, x, y, a, c]
            x, y = folded(-p[i] - p[j], period, along), folded(-b[i] - b[j], fold, around)
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
def powers_of_b(weights, one, other):  # type: ignore[no-untyped-def]
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
def add_sections(forms, k, p, b, order, starts, weights, period, fold):  # type: ignore[no-untyped-def]
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
                x = folded(sign * one - other, period, along)
                if x < 0:
                    continue
                for part in range(parts):
                    table = powers_of_b(weights[part, x], sign * one * k, other * k)
                    for at in range(starts[first], starts[first + 1]):
                        i = order[at]
                        end = starts[second + 1] if second < first else at + 1
                        for beside in range(starts[second], end):
                            j = order[beside]
                            y = folded(sign * b[i] - b[j], fold, around)
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
