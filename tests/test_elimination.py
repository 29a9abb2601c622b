"""The bordered elimination against a dense matrix written from the definition, and against matrix exponentials."""

import numpy as np
import pytest
from scipy.linalg import eigvals, expm

from pearlbvp.collocation.elimination import LinearSystem, solve, transfer_pencil
from pearlbvp.collocation.scheme import gauss_scheme


def dense(scheme, system):
    """The whole matrix, row by row from ``mass y' - jacobian y - parameter_jacobian p`` and the borders' definitions."""
    m, h = scheme.m, system.h
    n, k = system.parameter_jacobian.shape[1:]
    at_start, at_end, by_p = system.boundary
    unknowns = (len(h) * m + 1) * n + k
    rows = []
    weights = np.zeros((len(h) * m, unknowns - k, n))  # integral of density . y as a row
    for i in range(len(h)):
        for g in range(m):
            values = np.zeros((n, unknowns))
            slopes = np.zeros((n, unknowns))
            for j in range(m + 1):
                place = (i * m + j) * n
                values[:, place : place + n] += scheme.values[g, j] * np.eye(n)
                slopes[:, place : place + n] += scheme.derivatives[g, j] / h[i] * np.eye(n)
            row = system.mass[:, None] * slopes - system.jacobian[i * m + g] @ values
            row[:, unknowns - k :] -= system.parameter_jacobian[i * m + g]
            rows.append(row)
            weights[i * m + g] = h[i] * scheme.weights[g] * values[:, : unknowns - k].T
    boundary = np.zeros((len(at_start), unknowns))
    boundary[:, :n], boundary[:, unknowns - k - n : unknowns - k], boundary[:, unknowns - k :] = at_start, at_end, by_p
    borders = np.hstack((np.einsum("gcn,gun->cu", system.borders, weights), system.borders_p))
    return np.vstack((*rows, boundary, borders))


@pytest.mark.parametrize(
    ("m", "n", "intervals", "k", "b"), [(2, 3, 1, 1, 3), (3, 2, 5, 2, 2), (4, 4, 7, 4, 4), (5, 1, 3, 0, 0)]
)
def test_agrees_with_the_dense_matrix(m, n, intervals, k, b):
    rng = np.random.default_rng(m)
    scheme = gauss_scheme(m)
    c = n + k - b
    h = rng.uniform(0.5, 1.5, intervals)
    h /= h.sum()
    points = intervals * m
    system = LinearSystem(
        h,
        rng.standard_normal((points, n, n)),
        rng.standard_normal((points, n, k)),
        (rng.standard_normal((b, n)), rng.standard_normal((b, n)), rng.standard_normal((b, k))),
        rng.standard_normal((points, c, n)),
        rng.standard_normal((c, k)),
        rng.standard_normal(n),
    )
    defects, conditions = rng.standard_normal((points, n, 2)), rng.standard_normal((b + c, 2))
    y, p = solve(scheme, system, defects, conditions)
    expected = np.linalg.solve(dense(scheme, system), np.vstack((defects.reshape(-1, 2), conditions)))
    np.testing.assert_allclose(np.hstack((y.reshape(2, -1), p)).T, expected, rtol=1e-9, atol=1e-10)


def test_transfer_pencil_is_the_matrix_exponential():
    matrix = np.array([[0.0, 1.0, 0.3], [-4.0, -0.1, 0.0], [0.2, 0.0, 1.0]])
    scheme = gauss_scheme(5)
    h = np.array([0.1, 0.2, 0.3, 0.15, 0.25])
    a0, a1 = transfer_pencil(scheme, h, np.broadcast_to(matrix, (25, 3, 3)).copy())
    np.testing.assert_allclose(-np.linalg.solve(a1, a0), expm(matrix), atol=1e-11)


def test_multipliers_on_the_unit_circle_survive_beside_huge_ones():
    # y'' = 400 y and z'' = -4 z, mixed by a rotation: multipliers e^{+-20} and e^{+-2i}. The monodromy matrix loses
    # e^{20} * 1e-16 of the latter; the pencil does not.
    scheme = gauss_scheme(6)
    decoupled = np.array([[0.0, 1, 0, 0], [400, 0, 0, 0], [0, 0, 0, 1], [0, 0, -4, 0]])
    rotation, _ = np.linalg.qr(np.random.default_rng(0).standard_normal((4, 4)))
    matrix = rotation @ decoupled @ rotation.T
    a0, a1 = transfer_pencil(scheme, np.full(40, 1 / 40), np.broadcast_to(matrix, (240, 4, 4)).copy())
    rho = eigvals(-a0, a1)
    neutral = rho[np.argsort(np.abs(np.log(np.abs(rho))))][:2]
    np.testing.assert_allclose(np.sort_complex(neutral), np.exp([-2j, 2j]), atol=1e-12)


def test_a_singular_matrix_is_said_to_be_singular():
    scheme = gauss_scheme(2)
    zeros = np.zeros((2, 1, 1))
    system = LinearSystem(
        np.ones(1), zeros, np.zeros((2, 1, 0)), (np.zeros((1, 1)), np.zeros((1, 1)), np.zeros((1, 0))),
        np.zeros((2, 0, 1)), np.zeros((0, 0)), np.ones(1),
    )  # fmt: skip
    with pytest.raises(np.linalg.LinAlgError):
        solve(scheme, system, np.ones((2, 1, 1)), np.ones((1, 1)))
