"""Helfrich energy, area and volume of the subdivision surface at its quadrature points, with exact derivatives.

With tangents ``a, b``, second derivatives ``p, q, r``, ``E = a.a, F = a.b, G = b.b``, ``c = a x b``, ``g = c.c = E G - F^2``,
``M = -(G p - 2 F q + E r).c`` and the outward ``c``: ``H = M/(2 g^{3/2})``, and by area of the parameter plane::

    (H - c0)^2 dS = M^2/(4 g^{5/2}) - c0 M/g + c0^2 sqrt(g),   dV = (y c_y + z c_z)/2

Control vertices move along fixed directions, ``X_i = X0_i + u_i N_i``. Everything is differentiated as it is summed: the
second derivative is symmetric, and its inertia counts (``docs/theory/meshes.md``).
"""

from __future__ import annotations

import numpy as np

from pearlbvp.compiled import compiled


@compiled
def _cross(a, b):  # type: ignore[no-untyped-def]
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def _add_outer(block, factor, a, b):  # type: ignore[no-untyped-def]
    """``block += factor a b^T``."""
    for x in range(3):
        for y in range(3):
            block[x, y] += factor * a[x] * b[y]


@compiled
def _add_cross(block, factor, a):  # type: ignore[no-untyped-def]
    """``block += factor [a]_x``, the matrix of the vector product with ``a`` from the left."""
    block[0, 1] -= factor * a[2]
    block[0, 2] += factor * a[1]
    block[1, 0] += factor * a[2]
    block[1, 2] -= factor * a[0]
    block[2, 0] -= factor * a[1]
    block[2, 1] += factor * a[0]


@compiled
def _add_identity(block, factor):  # type: ignore[no-untyped-def]
    for x in range(3):
        block[x, x] += factor


@compiled
def _numerator_and_metric(z, first):  # type: ignore[no-untyped-def]
    """``M`` and ``g``; their gradients by ``X, a, b, p, q, r`` go to ``first``, shape (2, 6, 3)."""
    a, b, p, q, r = z[1], z[2], z[3], z[4], z[5]
    E, F, G = _dot(a, a), _dot(a, b), _dot(b, b)
    c = _cross(a, b)
    pc, qc, rc = _dot(p, c), _dot(q, c), _dot(r, c)
    w = (G * p[0] - 2 * F * q[0] + E * r[0], G * p[1] - 2 * F * q[1] + E * r[1], G * p[2] - 2 * F * q[2] + E * r[2])
    bw, wa = _cross(b, w), _cross(w, a)
    for x in range(3):
        first[0, 0, x] = 0.0
        first[0, 1, x] = -2 * (a[x] * rc - b[x] * qc) - bw[x]
        first[0, 2, x] = -2 * (b[x] * pc - a[x] * qc) - wa[x]
        first[0, 3, x] = -G * c[x]
        first[0, 4, x] = 2 * F * c[x]
        first[0, 5, x] = -E * c[x]
        first[1, :, x] = 0.0
        first[1, 1, x] = 2 * (G * a[x] - F * b[x])
        first[1, 2, x] = 2 * (E * b[x] - F * a[x])
    return -_dot(w, c), E * G - F * F


@compiled
def _second(z, by_M, by_g, lambda2, second):  # type: ignore[no-untyped-def]
    """``by_M M'' + by_g g'' + lambda2`` times the volume's, upper blocks of ``second``, shape (6, 6, 3, 3)."""
    X, a, b, p, q, r = z[0], z[1], z[2], z[3], z[4], z[5]
    E, F, G = _dot(a, a), _dot(a, b), _dot(b, b)
    c = _cross(a, b)
    pc, qc, rc = _dot(p, c), _dot(q, c), _dot(r, c)
    m = by_M
    aa, ab, bb = second[1, 1], second[1, 2], second[2, 2]
    bq, br, qa, pa = _cross(b, q), _cross(b, r), _cross(q, a), _cross(p, a)
    _add_outer(aa, 2 * m, b, bq)
    _add_outer(aa, 2 * m, bq, b)
    _add_outer(aa, -2 * m, a, br)
    _add_outer(aa, -2 * m, br, a)
    _add_identity(aa, -2 * m * rc)
    _add_outer(bb, -2 * m, b, pa)
    _add_outer(bb, -2 * m, pa, b)
    _add_outer(bb, 2 * m, a, qa)
    _add_outer(bb, 2 * m, qa, a)
    _add_identity(bb, -2 * m * pc)
    _add_outer(ab, -2 * m, _cross(b, p), b)
    _add_cross(ab, G * m, p)
    _add_outer(ab, 2 * m, b, qa)
    _add_outer(ab, 2 * m, bq, a)
    _add_identity(ab, 2 * m * qc)
    _add_cross(ab, -2 * F * m, q)
    _add_outer(ab, -2 * m, a, _cross(r, a))
    _add_cross(ab, E * m, r)
    # by a or b (rows) and p, q, r: transposes of the derivatives of -G c, 2 F c, -E c
    _add_cross(second[1, 3], -G * m, b)
    _add_outer(second[2, 3], -2 * m, b, c)
    _add_cross(second[2, 3], G * m, a)
    _add_outer(second[1, 4], 2 * m, b, c)
    _add_cross(second[1, 4], 2 * F * m, b)
    _add_outer(second[2, 4], 2 * m, a, c)
    _add_cross(second[2, 4], -2 * F * m, a)
    _add_outer(second[1, 5], -2 * m, a, c)
    _add_cross(second[1, 5], -E * m, b)
    _add_cross(second[2, 5], E * m, a)
    _add_outer(aa, -2 * by_g, b, b)
    _add_identity(aa, 2 * by_g * G)
    _add_outer(bb, -2 * by_g, a, a)
    _add_identity(bb, 2 * by_g * E)
    _add_outer(ab, 4 * by_g, a, b)
    _add_outer(ab, -2 * by_g, b, a)
    _add_identity(ab, -2 * by_g * F)
    _add_cross(ab, -lambda2 / 2, (0.0, X[1], X[2]))
    _add_cross(second[0, 1], -lambda2 / 2, b)
    _add_cross(second[0, 2], lambda2 / 2, a)
    second[0, 1, 0, :] = 0.0
    second[0, 2, 0, :] = 0.0


@compiled
def limit_sums(X, directions, start, index, weights, offsets, weight, c0, lambda1, lambda2, place, data):  # type: ignore[no-untyped-def]
    """Energy, area and volume by ``u``: values, gradients, and where ``place`` is not empty the Hessian of ``F``.

    Args:
        X: control vertices, shape (V, 3).
        directions: in which they move, shape (V, 3).
        start, index, weights, offsets, weight: of ``subdivision.Patches``.
        c0, lambda1, lambda2: ``F = E + lambda1 A + lambda2 V``.
        place: where each pair of control vertices of each point goes in ``data``.
        data: nonzeros of the Hessian of ``F``, added to.

    Returns:
        Values (E, A, V), shape (3,), and gradients by ``u``, shape (3, V).
    """
    values, gradients = np.zeros(3), np.zeros((3, X.shape[0]))
    most = 0
    for point in range(start.size - 1):
        most = max(most, start[point + 1] - start[point])
    z, first = np.empty((6, 3)), np.empty((2, 6, 3))
    second, dense = np.empty((6, 6, 3, 3)), np.empty((18, 18))
    J, HJ = np.zeros((18, most)), np.empty((18, most))
    jets = np.empty((3, 6, 3))
    position = 0
    for point in range(start.size - 1):
        low, size = start[point], start[point + 1] - start[point]
        for k in range(6):
            z[k, 0], z[k, 1], z[k, 2] = offsets[k, point], 0.0, 0.0
            for term in range(size):
                j = index[low + term]
                for x in range(3):
                    z[k, x] += weights[k, low + term] * X[j, x]
        M, g = _numerator_and_metric(z, first)
        root = np.sqrt(g)
        a, b = z[1], z[2]
        c, flat = _cross(a, b), (0.0, z[0, 1], z[0, 2])
        values[0] += weight * (M * M / (4 * g * g * root) - c0 * M / g + c0 * c0 * root)
        values[1] += weight * root
        values[2] += weight * _dot(flat, c) / 2
        e_M = M / (2 * g * g * root) - c0 / g
        e_g = -5 * M * M / (8 * g * g * g * root) + c0 * M / (g * g) + c0 * c0 / (2 * root)
        bx, xa = _cross(b, flat), _cross(flat, a)
        for k in range(6):
            for x in range(3):
                jets[0, k, x] = e_M * first[0, k, x] + e_g * first[1, k, x]
                jets[1, k, x] = first[1, k, x] / (2 * root)
                jets[2, k, x] = 0.0
        for x in range(3):
            jets[2, 0, x] = c[x] / 2 if x > 0 else 0.0
            jets[2, 1, x] = bx[x] / 2
            jets[2, 2, x] = xa[x] / 2
        for term in range(size):
            j = index[low + term]
            for k in range(6):
                for x in range(3):
                    move = weight * weights[k, low + term] * directions[j, x]
                    for which in range(3):
                        gradients[which, j] += move * jets[which, k, x]
        if place.size == 0:
            continue
        e_g += lambda1 / (2 * root)
        e_MM = 1 / (2 * g * g * root)
        e_Mg = -5 * M / (4 * g * g * g * root) + c0 / (g * g)
        e_gg = 35 * M * M / (16 * g * g * g * g * root) - 2 * c0 * M / (g * g * g)
        e_gg -= (c0 * c0 + lambda1) / (4 * g * root)
        second[:] = 0.0
        _second(z, e_M, e_g, lambda2, second)
        for k in range(6):
            for m in range(k, 6):
                for x in range(3):
                    for y in range(3):
                        value = second[k, m, x, y] + e_MM * first[0, k, x] * first[0, m, y]
                        value += e_Mg * (first[0, k, x] * first[1, m, y] + first[1, k, x] * first[0, m, y])
                        value += e_gg * first[1, k, x] * first[1, m, y]
                        dense[3 * k + x, 3 * m + y] = weight * value
                        dense[3 * m + y, 3 * k + x] = weight * value
        for k in range(6):
            for term in range(size):
                for x in range(3):
                    J[3 * k + x, term] = weights[k, low + term] * directions[index[low + term], x]
        for k in range(18):
            for term in range(size):
                HJ[k, term] = 0.0
            for m in range(18):
                factor = dense[k, m]
                for term in range(size):
                    HJ[k, term] += factor * J[m, term]
        for term in range(size):
            for other in range(term, size):
                value = 0.0
                for k in range(18):
                    value += J[k, term] * HJ[k, other]
                data[place[position + term * size + other]] += value
                if other > term:
                    data[place[position + other * size + term]] += value
        position += size * size
    return values, gradients


@compiled
def limit_mass(X, directions, start, index, weights, offsets, weight, place, data):  # type: ignore[no-untyped-def]
    """Mean square of the normal displacement, into ``data``, and the part of rigid motions in it.

    Arguments as in ``limit_sums``.

    Returns:
        ``integral of <t, n> <N_j, n> B_j dS`` for the translations along ``x, y, z`` and the rotation about ``x`` as ``t``,
        shape (4, V).
    """
    rows = np.zeros((4, X.shape[0]))
    z = np.empty((3, 3))
    most = 0
    for point in range(start.size - 1):
        most = max(most, start[point + 1] - start[point])
    normal = np.empty(most)
    position = 0
    for point in range(start.size - 1):
        low, size = start[point], start[point + 1] - start[point]
        for k in range(3):
            z[k, 0], z[k, 1], z[k, 2] = offsets[k, point], 0.0, 0.0
            for term in range(size):
                j = index[low + term]
                for x in range(3):
                    z[k, x] += weights[k, low + term] * X[j, x]
        c = _cross(z[1], z[2])
        root = np.sqrt(_dot(c, c))
        turn = (z[0, 1] * c[2] - z[0, 2] * c[1]) / root
        for term in range(size):
            j = index[low + term]
            normal[term] = weights[0, low + term] * _dot(directions[j], c) / root
            share = weight * normal[term]
            for x in range(3):
                rows[x, j] += share * c[x]
            rows[3, j] += share * root * turn
        for term in range(size):
            for other in range(size):
                data[place[position]] += weight * root * normal[term] * normal[other]
                position += 1
    return rows
