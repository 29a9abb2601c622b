"""Eigenvalues on the vectors that rows annihilate: two ways to the same ones, and graded matrices whose are known."""

import numpy as np
import pytest

from pearlbvp.constrained import leading_eigenvalues, restricted


@pytest.mark.parametrize("phase", [0.0, 1.0j])
@pytest.mark.parametrize("largest", [-3.0, 50.0])
def test_eigenvalues_on_what_rows_annihilate_are_those_of_the_projected_matrix(phase, largest):
    rng = np.random.default_rng(1)
    unitary = np.linalg.qr(rng.normal(size=(9, 9)) + phase * rng.normal(size=(9, 9))).Q
    matrix = (unitary * np.append(largest, -np.arange(4.0, 12.0))) @ unitary.conj().T
    rows = rng.normal(size=(2, 9))
    np.testing.assert_allclose(leading_eigenvalues(matrix)[:4], sorted([largest, -4, -5, -6], reverse=True), rtol=1e-12)
    (inside,) = restricted(rows, matrix)
    expected = np.linalg.eigvalsh(inside)[::-1]
    np.testing.assert_allclose(leading_eigenvalues(matrix, [*rows, rows[0] + rows[1]]), expected, rtol=1e-11)


def test_small_eigenvalues_beside_large_entries_are_known_to_their_own_rounding():
    large, small = 1e16, 3.0
    matrix = -np.array([[large, np.sqrt(large)], [np.sqrt(large), small]])
    # Their product is large (small - 1), and one of them is -large - 1 to 1e-16.
    assert leading_eigenvalues(matrix)[0] == pytest.approx(-(small - 1), rel=1e-14)


def test_what_are_no_numbers_have_no_eigenvalues():
    with pytest.raises(np.linalg.LinAlgError):
        leading_eigenvalues(np.full((3, 3), np.nan))
