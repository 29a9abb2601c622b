"""Eigenvalues on the vectors that rows annihilate: two ways to the same ones, and graded matrices whose are known."""

import numpy as np
import pytest

from pearlbvp.constrained import leading_eigenvalues, restricted


@pytest.mark.parametrize("phase", [0.0, 1.0j])
@pytest.mark.parametrize(("largest", "size"), [(-3.0, 9), (50.0, 9), (50.0, 101)])
def test_eigenvalues_on_what_rows_annihilate_are_those_of_the_projected_matrix(phase, largest, size):
    rng = np.random.default_rng(1)
    unitary = np.linalg.qr(rng.normal(size=(size, size)) + phase * rng.normal(size=(size, size))).Q
    matrix = (unitary * np.append(largest, -np.arange(4.0, size + 3))) @ unitary.conj().T
    rows = rng.normal(size=(2, size))
    np.testing.assert_allclose(leading_eigenvalues(matrix)[:4], sorted([largest, -4, -5, -6], reverse=True), rtol=1e-12)
    (inside,) = restricted(rows, matrix)
    expected = np.linalg.eigvalsh(inside)[::-1]
    np.testing.assert_allclose(leading_eigenvalues(matrix, [*rows, rows[0] + rows[1]]), expected, rtol=1e-11)


@pytest.mark.parametrize("count", [1, 60])
def test_small_eigenvalues_beside_large_entries_are_known_to_their_own_rounding(count):
    large, small = 1e16, 3.0 + np.arange(count)
    unit = np.eye(count)
    matrix = -np.block([[large * unit, np.sqrt(large) * unit], [np.sqrt(large) * unit, np.diag(small)]])
    # Of each pair the product is large (small - 1), and one of them is -large - 1 to 1e-16.
    np.testing.assert_allclose(leading_eigenvalues(matrix)[:count], 1 - small, rtol=1e-14)
    order = np.random.default_rng(2).permutation(2 * count)
    np.testing.assert_allclose(leading_eigenvalues(matrix[np.ix_(order, order)])[:count], 1 - small, rtol=1e-14)


def test_what_are_no_numbers_have_no_eigenvalues():
    with pytest.raises(np.linalg.LinAlgError):
        leading_eigenvalues(np.full((3, 3), np.nan))
