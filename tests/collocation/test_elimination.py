"""The bordered elimination against a dense matrix written from the definition, and against matrix exponentials."""

import numpy as np
import pytest
from scipy.linalg import eigvals, expm

from pearlbvp.collocation.elimination import LinearSystem, solve, solve_signed, transfer_pencil
from pearlbvp.collocation.scheme import gauss_scheme


def dense(scheme, system):
    """The whole matrix, row by row from ``mass y' - jacobian y - parameter_jacobian p`` and the borders' definitions."""
    m, h, free = scheme.m, system.h, system.free
    n, k = system.jacobian.shape[1], len(free)
    states = (len(h) * m + 1) * n
    rows = []
    at_gauss = np.zeros((len(h) * m, n, states))
    weights = np.repeat(h, m) * np.tile(scheme.weights, len(h))
    for i in range(len(h)):
        for g in range(m):
            slopes = np.zeros((n, states))
            for j in range(m + 1):
                place = (i * m + j) * n
                at_gauss[i * m + g, :, place : place + n] += scheme.values[g, j] * np.eye(n)
                slopes[:, place : place + n] += scheme.derivatives[g, j] / h[i] * np.eye(n)
            by_y = system.mass[:, None] * slopes - system.jacobian[i * m + g] @ at_gauss[i * m + g]
            rows.append(np.hstack((by_y, -system.parameter_jacobian[i * m + g][:, free])))
    boundary = np.zeros((len(system.at_start), states))
    boundary[:, :n], boundary[:, states - n :] = system.at_start, system.at_end
    rows.append(np.hstack((boundary, system.boundary_p[:, free])))
    integrals = np.einsum("g,gcn,gnu->cu", weights, system.densities, at_gauss)
    rows.append(np.hstack((integrals, np.tensordot(weights, system.densities_p, 1)[:, free])))
    for row in system.rows:
        row_at_gauss = at_gauss @ row[:states]
        rows.append(np.append(np.einsum("g,gn,gnu->u", weights, row_at_gauss, at_gauss), row[states:])[None])
    assert len(np.vstack(rows)) == states + k
    return np.vstack(rows)


@pytest.mark.parametrize(
    ("m", "n", "intervals", "free", "b", "c"),
    [(2, 3, 1, [1], 3, 0), (3, 2, 5, [2, 0], 2, 1), (4, 4, 7, [0, 1, 3, 4], 4, 3), (5, 1, 3, [], 0, 1)],
)
def test_agrees_with_the_dense_matrix(m, n, intervals, free, b, c):
    rng = np.random.default_rng(m)
    scheme = gauss_scheme(m)
    k, r = 5, n + len(free) - b - c
    h = rng.uniform(0.5, 1.5, intervals)
    h /= h.sum()
    points = intervals * m
    unknowns = (points + 1) * n + len(free)
    shapes = [(points, n, n), (points, n, k), (n,), (b, n), (b, n), (b, k), (points, c, n), (points, c, k)]
    system = LinearSystem(
        h, *(rng.standard_normal(s) for s in shapes), np.array(free, dtype=np.intp), rng.standard_normal((r, unknowns))
    )
    rhs = rng.standard_normal((unknowns, 2))
    expected = np.linalg.solve(dense(scheme, system), rhs)
    np.testing.assert_allclose(solve(scheme, system, rhs), expected, rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("m", [2, 3, 4])
def test_the_determinant_s_sign_is_that_of_the_dense_matrix(m):
    """Up to one factor for a size of the problem: the same on meshes of any number of intervals, whatever the borders."""
    rng = np.random.default_rng(m)
    scheme, n = gauss_scheme(m), 3
    against = set()
    for trial in range(24):
        h = rng.uniform(0.5, 1.5, 1 + trial % 4)
        h /= h.sum()
        points, size = h.size * m, (h.size * m + 1) * n + 1
        shapes = [(3, n), (3, n), (3, 1), (points, 1, n), (points, 1, 1)]
        conditions = [rng.standard_normal(shape) for shape in shapes]
        jacobian, by_p = rng.standard_normal((points, n, n)), rng.standard_normal((points, n, 1))
        free, rows = np.array([0], dtype=np.intp), np.empty((0, size))
        system = LinearSystem(h, jacobian, by_p, np.ones(n), *conditions, free, rows)
        _, sign = solve_signed(scheme, system, rng.standard_normal((size, 1)))
        # Columns y_0, int_0, y_1, ...: the n of y_0 belong behind all others of the states.
        order = np.concatenate((np.arange(n, size - 1), np.arange(n), [size - 1]))
        against.add(sign * np.linalg.slogdet(dense(scheme, system)[:, order])[0])
    assert len(against) == 1


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
    shapes = [(2, 1, 1), (2, 1, 0), (1,), (1, 1), (1, 1), (1, 0), (2, 0, 1), (2, 0, 0)]
    system = LinearSystem(np.ones(1), *(np.zeros(s) for s in shapes), np.zeros(0, dtype=np.intp), np.zeros((0, 3)))
    with pytest.raises(np.linalg.LinAlgError):
        solve(scheme, system, np.ones((3, 1)))
