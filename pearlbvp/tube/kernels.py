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
def with_phases(half, signs):  # type: ignore[no-untyped-def]
    """Coefficients of lower halves, at the frequencies that a real transform keeps, times phases; see ``MatrixTransform``."""
    entries, along, kept = half.shape
    # A coefficient of two real entries, or two imaginary ones, is real on an even surface; of one of each it is imaginary.
    largest = odd = 0.0
    entry = 0
    for a in range(len(signs)):
        for c in range(a + 1):
            for value in half[entry].flat:
                real, imaginary = abs(value.real), abs(value.imag)
                largest = max(largest, real, imaginary)
                odd = max(odd, imaginary if signs[a] == signs[c] else real)
            entry += 1
    found = np.empty((2 if odd > REAL * largest else 1, entries, along, kept))
    entry = 0
    for a in range(len(signs)):
        for c in range(a + 1):
            # Times -i where the left entry is imaginary, times i where the right one is.
            factor = 1.0 + 0j if signs[a] == signs[c] else 1j * signs[a]
            for x in range(along):
                for y in range(kept):
                    value = half[entry, x, y] * factor
                    found[0, entry, x, y] = value.real
                    if len(found) > 1:
                        found[1, entry, x, y] = value.imag
            entry += 1
    return found


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
def folded(number, unit, points):  # type: ignore[no-untyped-def]
    """Place of a wave number in a transform, or -1 for none of its."""
    if unit == 0:
        return 0 if number == 0 else -1
    return (number // unit) % points if number % unit == 0 else -1


@compiled
def by_powers(left, right, weights, signs, sign, x, table):  # type: ignore[no-untyped-def]
    """``left . W right`` of vectors that are polynomials in their wave numbers around, at all frequencies around.

    Args:
        left, right: coefficients of each power, shapes (U, F) and (V, F).
        weights, signs: as ``MatrixTransform`` has them.
        sign: 1, or -1 for the opposite waves on the left.
        x: frequency along, or -1 for none of the transform's.
        table: to be filled for each part and two powers, shape (1 or 2, U, V, points around).
    """
    along, kept, around = weights.shape[2], weights.shape[3], table.shape[3]
    if x < 0:
        return
    table[:] = 0.0
    for u in range(left.shape[0]):
        for a in range(left.shape[1]):
            if left[u, a] == 0:
                continue
            of_row = left[u, a] * (signs[a] if sign < 0 else 1.0)
            for v in range(right.shape[0]):
                for c in range(right.shape[1]):
                    if right[v, c] == 0:
                        continue
                    entry, alike = a * (a + 1) // 2 + c if a >= c else c * (c + 1) // 2 + a, signs[a] * signs[c]
                    factor = of_row * right[v, c] * (alike if a < c else 1.0)
                    for part in range(len(table)):
                        row, here = table[part, u, v], weights[part, entry, x]
                        there = weights[part, entry, (along - x) % along]
                        opposite = factor * (alike if part == 0 else -alike)
                        for y in range(kept):
                            row[y] += factor * here[y]
                        for y in range(1, around - kept + 1):
                            row[around - y] += opposite * there[y]


@compiled
def value_at(polynomials, one, other, y):  # type: ignore[no-untyped-def]
    """Value at two numbers of a polynomial, shape (U, V, points around): that of ``y``, or 0 for a negative one."""
    value = 0.0
    if y >= 0:
        for u in range(polynomials.shape[0] - 1, -1, -1):  # Horner's scheme
            of_power = 0.0
            for v in range(polynomials.shape[1] - 1, -1, -1):
                of_power = other * of_power + polynomials[u, v, y]
            value = one * value + of_power
    return value


@compiled
def tile_of_waves(left, right, b, ones, others, weights, signs, along_of, around_of, table, tile):  # type: ignore[no-untyped-def]
    """Forms of each wave of one group with each of another.

    Args:
        left, right: vectors of all waves, as ``forms_of_modes`` takes them.
        b: wave numbers around.
        ones, others: the waves of the two groups.
        weights, signs: as ``MatrixTransform`` has them.
        along_of: the frequency along, and that for the waves opposite to the left ones; -1 where the cell has none.
        around_of: frequencies around for a difference of two ``b``, from the least one on.
        table: to work in, two of those that ``by_powers`` takes.
        tile: to be filled, shape (2, 2, waves, waves): of a real part ``Re e^{iq}``, 0, or ``-Im e^{iq}``, 1, on each side.
    """
    for s in range(2):
        by_powers(left[ones[0]], right[others[0]], weights, signs, 1 - 2 * s, along_of[s], table[s])
    for i in range(len(ones)):
        for j in range(len(others)):
            one, other = b[ones[i]], b[others[j]]
            y = around_of[one - other + len(around_of) // 2] if along_of[0] >= 0 else -1
            opposite = around_of[-one - other + len(around_of) // 2] if along_of[1] >= 0 else -1
            for part in range(2):
                here = there = 0.0
                if part < len(weights):
                    here, there = (
                        value_at(table[0, part], one, other, y),
                        value_at(table[1, part], one, other, opposite),
                    )
                if part == 0:
                    tile[0, 0, i, j], tile[1, 1, i, j] = (here + there) / 2, (here - there) / 2
                else:
                    tile[0, 1, i, j], tile[1, 0, i, j] = -(here + there) / 2, (here - there) / 2


@compiled
def forms_of_modes(left, right, p, b, order, starts, weights, signs, cell, around_of, modes, symmetric, tile, found):  # type: ignore[no-untyped-def]
    """Forms of the modes of some families, one after the other, from those of the waves that they share.

    Pairs of waves are taken in turn by their groups: what they are is used for all modes at once, and not kept.

    Args:
        left, right: vectors of each wave on both sides of the matrices, as ``Waves.jets`` are given.
        p, b: wave numbers.
        order, starts: the groups of waves whose vectors are of one polynomial (``Waves.groups``).
        weights, signs: as ``MatrixTransform`` has them.
        cell: its period, and points along and around.
        around_of: as ``tile_of_waves`` takes it.
        modes: the families (``Families``).
        symmetric: whether the vectors are the same on both sides, and so the forms symmetric.
        tile: to work in, shape (2, 2, largest group, largest group).
        found: zeros, to be filled.
    """
    period, along, around = cell
    groups, families = len(starts) - 1, len(modes.sizes)
    table = np.empty((2, len(weights), left.shape[1], right.shape[1], around))
    row = np.empty((2, tile.shape[3]))
    for first in range(groups):
        for second in range(first + 1 if symmetric else groups):
            ones, others = order[starts[first] : starts[first + 1]], order[starts[second] : starts[second + 1]]
            one, other = p[ones[0]], p[others[0]]
            along_of = folded(one - other, period, along), folded(-one - other, period, along)
            if along_of[0] < 0 and along_of[1] < 0:
                continue
            tile_of_waves(left, right, b, ones, others, weights, signs, along_of, around_of, table, tile)
            offset = 0
            for f in range(families):
                size = modes.sizes[f]
                for at in range(modes.bounds[first, f], modes.bounds[first, f + 1]):
                    m = modes.listed[at]
                    row[:] = 0.0
                    for i in range(modes.starts[m], modes.starts[m + 1]):
                        for kind in range(2):
                            for v in range(len(others)):
                                row[kind, v] += modes.factors[i] * tile[modes.kinds[m], kind, modes.places[i], v]
                    for beside in range(modes.bounds[second, f], modes.bounds[second, f + 1]):
                        n, value = modes.listed[beside], 0.0
                        for j in range(modes.starts[n], modes.starts[n + 1]):
                            value += modes.factors[j] * row[modes.kinds[n], modes.places[j]]
                        found[offset + size * modes.rows[m] + modes.rows[n]] = value
                        if symmetric:
                            found[offset + size * modes.rows[n] + modes.rows[m]] = value
                offset += size**2
