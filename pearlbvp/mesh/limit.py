"""Helfrich energy, area and volume of the subdivision surface at its quadrature points, with exact derivatives.

With tangents ``a, b``, second derivatives ``p, q, r``, ``E = a.a, F = a.b, G = b.b``, ``c = a x b``, ``g = c.c = E G - F^2``,
``P = p.c, Q = q.c, R = r.c``, ``M = -(G P - 2 F Q + E R)`` and the outward ``c``: ``H = M/(2 g^{3/2})``, and by area of the
parameter plane::

    (H - c0)^2 dS = M^2/(4 g^{5/2}) - c0 M/g + c0^2 sqrt(g),   dV = (y c_y + z c_z)/2

Control vertices move along fixed directions, ``X_i = X0_i + u_i N_i``. Everything is differentiated as it is summed: the
second derivative is symmetric, and its inertia counts (``docs/theory/meshes.md``). Gradients are summed backwards, as slopes by
``X, a, b, p, q, r`` times the weights of the vertices in these. At each point the second derivative is a sum of products of
the first derivatives of these nine quantities, for each of them is bilinear in the position's derivatives, which are linear in
``u``: a matrix of rank twenty.

Arrays are made outside of the compiled loops, and filled number by number: what numba has to compile for its own ``np.empty``
and for assignments to slices takes longer than the loops.
"""

from __future__ import annotations

import numpy as np

from pearlbvp.arrays import Array, Integers
from pearlbvp.compiled import compiled
from pearlbvp.mesh.subdivision import Patches


@compiled
def _cross(a, b):  # type: ignore[no-untyped-def]
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


TERMS = 20
"""Products that the second derivative of ``F`` is the sum of."""


@compiled
def _jet(point, low, size, index, weights, offsets, X, jet):  # type: ignore[no-untyped-def]
    """Position and its derivatives ``X, a, b, p, q, r`` at a point, shape (6, 3)."""
    for k in range(0, 6, 2):  # two at a time: sums that stay in registers
        x, y, z = offsets[k, point], 0.0, 0.0
        u, v, w = offsets[k + 1, point], 0.0, 0.0
        for term in range(low, low + size):
            j, one, other = index[term], weights[k, term], weights[k + 1, term]
            x += one * X[j, 0]
            y += one * X[j, 1]
            z += one * X[j, 2]
            u += other * X[j, 0]
            v += other * X[j, 1]
            w += other * X[j, 2]
        jet[k, 0], jet[k, 1], jet[k, 2] = x, y, z
        jet[k + 1, 0], jet[k + 1, 1], jet[k + 1, 2] = u, v, w


@compiled
def _first(low, size, weights, jet, N, D):  # type: ignore[no-untyped-def]
    """Derivatives by the directions, a row each: ``M, g, E, G, F, P, Q, R``, then ``c, a, b`` by components, 17 in all."""
    a, b, p, q, r = jet[1], jet[2], jet[3], jet[4], jet[5]
    E, F, G, c = _dot(a, a), _dot(a, b), _dot(b, b), _cross(a, b)
    P, Q, R = _dot(p, c), _dot(q, c), _dot(r, c)
    for term in range(size):
        w1, w2, nx, ny, nz = weights[1, low + term], weights[2, low + term], N[0, term], N[1, term], N[2, term]
        an, bn = a[0] * nx + a[1] * ny + a[2] * nz, b[0] * nx + b[1] * ny + b[2] * nz
        cn = c[0] * nx + c[1] * ny + c[2] * nz
        cx = w1 * (ny * b[2] - nz * b[1]) + w2 * (a[1] * nz - a[2] * ny)
        cy = w1 * (nz * b[0] - nx * b[2]) + w2 * (a[2] * nx - a[0] * nz)
        cz = w1 * (nx * b[1] - ny * b[0]) + w2 * (a[0] * ny - a[1] * nx)
        e, f, h = 2 * w1 * an, w1 * bn + w2 * an, 2 * w2 * bn
        by_p = weights[3, low + term] * cn + p[0] * cx + p[1] * cy + p[2] * cz
        by_q = weights[4, low + term] * cn + q[0] * cx + q[1] * cy + q[2] * cz
        by_r = weights[5, low + term] * cn + r[0] * cx + r[1] * cy + r[2] * cz
        D[0, term] = -(h * P + G * by_p - 2 * (f * Q + F * by_q) + e * R + E * by_r)
        D[1, term] = e * G + E * h - 2 * F * f
        D[2, term], D[3, term], D[4, term] = e, h, f
        D[5, term], D[6, term], D[7, term] = by_p, by_q, by_r
        D[8, term], D[9, term], D[10, term] = cx, cy, cz
        D[11, term], D[12, term], D[13, term] = w1 * nx, w1 * ny, w1 * nz
        D[14, term], D[15, term], D[16, term] = w2 * nx, w2 * ny, w2 * nz


@compiled
def _products(low, size, weights, jet, N, D, f, lambda2, left, right):  # type: ignore[no-untyped-def]
    """Factors of the second derivative, shapes (20, size): the sum over rows of ``left_i right_j``.

    ``f`` has the derivatives ``f_M, f_g, f_MM, f_Mg, f_gg`` of the density.
    """
    X, a, b, p, q, r = jet[0], jet[1], jet[2], jet[3], jet[4], jet[5]
    E, F, G, c = _dot(a, a), _dot(a, b), _dot(b, b), _cross(a, b)
    P, Q, R = _dot(p, c), _dot(q, c), _dot(r, c)
    f_M, f_g, f_MM, f_Mg, f_gg = f
    # What multiplies a_i.a_j, a_i.b_j, b_i.b_j, and c_ij = a_i x b_j - b_i x a_j.
    aa, ab, bb = 2 * (f_g * G - f_M * R), 2 * (f_M * Q - f_g * F), 2 * (f_g * E - f_M * P)
    kx = -f_M * (G * p[0] - 2 * F * q[0] + E * r[0])
    ky = -f_M * (G * p[1] - 2 * F * q[1] + E * r[1]) + lambda2 / 2 * X[1]
    kz = -f_M * (G * p[2] - 2 * F * q[2] + E * r[2]) + lambda2 / 2 * X[2]
    for term in range(size):
        for k in range(8):
            left[k, term] = D[k, term]
        e, h, m = D[2, term], D[3, term], D[4, term]
        right[0, term] = f_MM * D[0, term] + f_Mg * D[1, term]
        right[1, term] = f_Mg * D[0, term] + f_gg * D[1, term]
        right[2, term] = f_g * h - f_M * D[7, term]
        right[3, term] = f_g * e - f_M * D[5, term]
        right[4, term] = 2 * (f_M * D[6, term] - f_g * m)
        right[5, term], right[6, term], right[7, term] = -f_M * h, 2 * f_M * m, -f_M * e
        along = -f_M * (G * weights[3, low + term] - 2 * F * weights[4, low + term] + E * weights[5, low + term])
        flat = along + lambda2 / 2 * weights[0, low + term]
        y = (along * N[0, term], flat * N[1, term], flat * N[2, term])
        for x in range(3):
            left[8 + x, term], right[8 + x, term] = y[x], D[8 + x, term]
            left[11 + x, term], right[11 + x, term] = D[8 + x, term], y[x]
            left[14 + x, term], left[17 + x, term] = D[11 + x, term], D[14 + x, term]
        ax, ay, az = D[11, term], D[12, term], D[13, term]
        bx, by, bz = D[14, term], D[15, term], D[16, term]
        right[14, term] = aa * ax + ab * bx + by * kz - bz * ky
        right[15, term] = aa * ay + ab * by + bz * kx - bx * kz
        right[16, term] = aa * az + ab * bz + bx * ky - by * kx
        right[17, term] = ab * ax + bb * bx - ay * kz + az * ky
        right[18, term] = ab * ay + bb * by - az * kx + ax * kz
        right[19, term] = ab * az + bb * bz - ax * ky + ay * kx


@compiled
def _gradients(X, directions, start, index, weights, offsets, weight, c0, values, gradients, jet, slopes):  # type: ignore[no-untyped-def]
    """See ``limit_sums``; ``slopes``, shape (10, 3), has those of the energy by ``a, b, p, q, r``, of the area by ``a, b``, of
    the volume by ``X, a, b``."""
    for point in range(start.size - 1):
        low, size = start[point], start[point + 1] - start[point]
        _jet(point, low, size, index, weights, offsets, X, jet)
        a, b, p, q, r, y, z = jet[1], jet[2], jet[3], jet[4], jet[5], jet[0, 1], jet[0, 2]
        E, F, G, c = _dot(a, a), _dot(a, b), _dot(b, b), _cross(a, b)
        P, Q, R = _dot(p, c), _dot(q, c), _dot(r, c)
        M, g = -(G * P - 2 * F * Q + E * R), E * G - F * F
        root = np.sqrt(g)
        values[0] += weight * (M * M / (4 * g * g * root) - c0 * M / g + c0 * c0 * root)
        values[1] += weight * root
        values[2] += weight * (y * c[1] + z * c[2]) / 2
        values[3] += weight * M / (2 * g)
        f_M = weight * (M / (2 * g * g * root) - c0 / g)
        f_g = weight * (-5 * M * M / (8 * g * g * g * root) + c0 * M / (g * g) + c0 * c0 / (2 * root))
        share, half = weight / root, weight / 2
        m = (
            -(G * p[0] - 2 * F * q[0] + E * r[0]),
            -(G * p[1] - 2 * F * q[1] + E * r[1]),
            -(G * p[2] - 2 * F * q[2] + E * r[2]),
        )
        bm, ma = _cross(b, m), _cross(m, a)
        for x in range(3):
            by_a, by_b = G * a[x] - F * b[x], E * b[x] - F * a[x]  # halves of g's
            slopes[0, x] = f_M * (2 * Q * b[x] - 2 * R * a[x] + bm[x]) + 2 * f_g * by_a
            slopes[1, x] = f_M * (2 * Q * a[x] - 2 * P * b[x] + ma[x]) + 2 * f_g * by_b
            slopes[2, x], slopes[3, x], slopes[4, x] = -f_M * G * c[x], 2 * f_M * F * c[x], -f_M * E * c[x]
            slopes[5, x], slopes[6, x] = share * by_a, share * by_b
        slopes[7, 0], slopes[7, 1], slopes[7, 2] = 0.0, half * c[1], half * c[2]
        slopes[8, 0], slopes[8, 1], slopes[8, 2] = half * (b[1] * z - b[2] * y), -half * b[0] * z, half * b[0] * y
        slopes[9, 0], slopes[9, 1], slopes[9, 2] = half * (y * a[2] - z * a[1]), half * z * a[0], -half * y * a[0]
        for term in range(low, low + size):
            w, w1, w2 = weights[0, term], weights[1, term], weights[2, term]
            w3, w4, w5 = weights[3, term], weights[4, term], weights[5, term]
            by_energy, by_area, by_volume = 0.0, 0.0, 0.0
            for x in range(3):
                n = directions[index[term], x]
                by_energy += n * (
                    w1 * slopes[0, x] + w2 * slopes[1, x] + w3 * slopes[2, x] + w4 * slopes[3, x] + w5 * slopes[4, x]
                )
                by_area += n * (w1 * slopes[5, x] + w2 * slopes[6, x])
                by_volume += n * (w * slopes[7, x] + w1 * slopes[8, x] + w2 * slopes[9, x])
            gradients[0, index[term]] += by_energy
            gradients[1, index[term]] += by_area
            gradients[2, index[term]] += by_volume


def limit_sums(p: Patches, X: Array, directions: Array, c0: float) -> tuple[Array, Array]:
    """Energy, area, volume and integral of the mean curvature, shape (4,), and the gradients of the first three, (3, V).

    Args:
        p: quadrature points.
        X: control vertices, shape (V, 3).
        directions: in which they move, shape (V, 3).
        c0: spontaneous curvature.
    """
    values, gradients = np.zeros(4), np.zeros((3, len(X)))
    room = [np.empty(shape) for shape in ((6, 3), (10, 3))]
    _gradients(X, directions, p.start, p.index, p.weights, p.offsets, p.weight, c0, values, gradients, *room)
    return values, gradients


@compiled
def _hessian(  # type: ignore[no-untyped-def]
    X, directions, start, index, weights, offsets, weight, c0, lambda1, lambda2, place, data, jet, N, D, left, right, row
):  # fmt: skip
    """See ``limit_hessian``; from ``jet`` on they are room to work in."""
    position = 0
    for point in range(start.size - 1):
        low, size = start[point], start[point + 1] - start[point]
        _jet(point, low, size, index, weights, offsets, X, jet)
        for term in range(size):
            for x in range(3):
                N[x, term] = directions[index[low + term], x]
        _first(low, size, weights, jet, N, D)
        a, b = jet[1], jet[2]
        E, F, G, c = _dot(a, a), _dot(a, b), _dot(b, b), _cross(a, b)
        M = -(G * _dot(jet[3], c) - 2 * F * _dot(jet[4], c) + E * _dot(jet[5], c))
        g = E * G - F * F
        root = np.sqrt(g)
        f_M = M / (2 * g * g * root) - c0 / g
        f_g = -5 * M * M / (8 * g * g * g * root) + c0 * M / (g * g) + (c0 * c0 + lambda1) / (2 * root)
        f_MM = 1 / (2 * g * g * root)
        f_Mg = -5 * M / (4 * g * g * g * root) + c0 / (g * g)
        f_gg = 35 * M * M / (16 * g * g * g * g * root) - 2 * c0 * M / (g * g * g)
        f_gg -= (c0 * c0 + lambda1) / (4 * g * root)
        f = (weight * f_M, weight * f_g, weight * f_MM, weight * f_Mg, weight * f_gg)
        _products(low, size, weights, jet, N, D, f, weight * lambda2, left, right)
        for term in range(size):
            for other in range(size):
                row[other] = 0.0
            for k in range(0, TERMS, 5):
                l0, l1, l2, l3, l4 = (
                    left[k, term],
                    left[k + 1, term],
                    left[k + 2, term],
                    left[k + 3, term],
                    left[k + 4, term],
                )
                for other in range(size):
                    row[other] += (
                        l0 * right[k, other]
                        + l1 * right[k + 1, other]
                        + l2 * right[k + 2, other]
                        + l3 * right[k + 3, other]
                        + l4 * right[k + 4, other]
                    )
            for other in range(size):
                data[place[position + other]] += row[other]
            position += size


def limit_hessian(
    p: Patches, X: Array, directions: Array, c0: float, lambda1: float, lambda2: float, place: Integers, data: Array
) -> None:
    """Add the second derivative of ``F = E + lambda1 A + lambda2 V`` by ``u`` to ``data``.

    Args:
        p, X, directions, c0: as ``limit_sums`` has them.
        lambda1, lambda2: multipliers.
        place: where each pair of control vertices of each point goes in ``data``.
        data: nonzeros of the Hessian.
    """
    room = [np.empty(shape) for shape in ((6, 3), *((rows, p.most) for rows in (3, 17, TERMS, TERMS)), (p.most,))]
    _hessian(X, directions, p.start, p.index, p.weights, p.offsets, p.weight, c0, lambda1, lambda2, place, data, *room)


@compiled
def _mass(X, directions, start, index, weights, offsets, weight, rate, place, data, rows, z, normal):  # type: ignore[no-untyped-def]
    """See ``limit_mass``; ``z`` and ``normal`` are room to work in."""
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
        turn, moved = z[0, 1] * c[2] - z[0, 2] * c[1], 0.0
        for term in range(size):
            j = index[low + term]
            normal[term] = weights[0, low + term] * _dot(directions[j], c) / root
            moved += normal[term] * rate[j]
        for term in range(size):
            j, share = index[low + term], weight * normal[term]
            for x in range(3):
                rows[x, j] += share * c[x]
            rows[3, j] += share * turn
            rows[4, j] += share * root * moved
        if place.size == 0:
            continue
        for term in range(size):
            for other in range(size):
                data[place[position]] += weight * root * normal[term] * normal[other]
                position += 1


def limit_mass(p: Patches, X: Array, directions: Array, rate: Array, place: Integers, data: Array) -> Array:
    """Mean square of the normal displacement, where ``place`` is not empty into ``data``, and the part of motions in it.

    Arguments as in ``limit_hessian``, and a displacement ``rate`` along the directions, shape (V,).

    Returns:
        ``integral of <t, n> <N_j, n> B_j dS`` for the translations along ``x, y, z``, the rotation about ``x`` and the
        displacement as ``t``, shape (5, V).
    """
    rows, z, normal = np.zeros((5, len(X))), np.empty((3, 3)), np.empty(p.most)
    arrays = X, directions, p.start, p.index, p.weights, p.offsets
    _mass(*arrays, p.weight, rate.copy(), place, data, rows, z, normal)  # IDA's arrays are of another kind to numba
    return rows
