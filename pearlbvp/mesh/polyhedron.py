"""The discrete Helfrich energy, area and volume of a triangulated surface, with exact first and second derivatives.

About vertex ``i`` three sums over its triangles ``T = (i, j, k)`` with ``c = (X_j - X_i) x (X_k - X_i)``, ``|T| = |c|/2``::

    a = sum of d|T|/dX_i = sum of (c/|c|) x (X_k - X_j)/2      gradient of the area: the cotangent Laplacian of X
    n = sum of c/6                                             gradient of the volume: the vertex normal times an area
    M = sum of |T|/3                                           lumped mass; its sum is the area

    M H = b = <a, n/|n|>/2 (paper, Appendix B: M H = <L X, N>/2),   E = sum of M (H - c0)^2

Vertices move along fixed directions: ``X_i = X0_i + u_i N_i``. All derivatives are by ``u``, and those of the sum itself,
so the second derivative is symmetric and its inertia counts (``docs/theory/meshes.md``).
"""

from __future__ import annotations

import numpy as np

from pearlbvp.compiled import compiled


@compiled
def _cross(a, b, out):  # type: ignore[no-untyped-def]
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@compiled
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def _triangle_first(p, q, ni, nj, nk, c, e, dc, de, unit, dunit, length, work):  # type: ignore[no-untyped-def]
    """``c``, ``|c|`` and ``c/|c|`` of a triangle with their derivatives by ``u_i, u_j, u_k`` (first index)."""
    _cross(p, q, c)
    for x in range(3):
        e[x] = q[x] - p[x]
        de[0, x], de[1, x], de[2, x] = 0.0, -nj[x], nk[x]
        work[x] = p[x] - q[x]
    _cross(ni, work, dc[0])
    _cross(nj, q, dc[1])
    _cross(p, nk, dc[2])
    length[0] = np.sqrt(_dot(c, c))
    for x in range(3):
        unit[x] = c[x] / length[0]
    for r in range(3):
        length[1 + r] = _dot(unit, dc[r])
        for x in range(3):
            dunit[r, x] = (dc[r, x] - unit[x] * length[1 + r]) / length[0]


@compiled
def star_sums(X, directions, start, head, offset, c0, lambda1, lambda2, place, data):  # type: ignore[no-untyped-def]
    """Energy, area and volume by ``u``: values, gradients, and where ``place`` is not empty the Hessian of ``F``.

    Args:
        X: vertices, shape (V, 3).
        directions: in which they move, shape (V, 3).
        start, head, offset: half-edges out of each vertex in order, the vertex each leads to and by how much that is
            shifted along ``x``; shapes (V + 1,), (3T,), (3T,).
        c0, lambda1, lambda2: ``F = E + lambda1 A + lambda2 V``.
        place: where each pair of dofs of each star goes in ``data``.
        data: nonzeros of the Hessian of ``F``, added to.

    Returns:
        Values (E, A, V and the integral of H), shape (4,), and gradients by ``u``, shape (3, V).
    """
    count = X.shape[0]
    values = np.zeros(4)
    gradients = np.zeros((3, count))
    most = 0
    for i in range(count):
        most = max(most, start[i + 1] - start[i])
    ring = np.empty((most, 3))
    J = np.empty((7, most + 1))  # derivatives of a (3), n (3), M by u of the star
    B = np.empty(most + 1)
    second = np.empty((most + 1, most + 1))
    c, e, unit, work, other, p = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    dc, de, dunit = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    length = np.empty(4)
    a, n = np.empty(3), np.empty(3)
    wa, wn = np.empty(3), np.empty(3)
    dof = np.empty(3, dtype=np.int64)
    ddc = np.zeros((3, 3, 3))
    position = 0
    for i in range(count):
        first, degree = start[i], start[i + 1] - start[i]
        size = degree + 1
        for t in range(degree):
            j = head[first + t]
            for x in range(3):
                ring[t, x] = X[j, x] - X[i, x]
            ring[t, 0] += offset[first + t]
        a[:], n[:], M = 0.0, 0.0, 0.0
        J[:, :size] = 0.0
        for t in range(degree):
            s = t + 1 if t + 1 < degree else 0
            dof[0], dof[1], dof[2] = 0, t + 1, s + 1
            nj, nk = directions[head[first + t]], directions[head[first + s]]
            _triangle_first(ring[t], ring[s], directions[i], nj, nk, c, e, dc, de, unit, dunit, length, work)
            _cross(unit, e, work)
            for x in range(3):
                a[x] += work[x] / 2
                n[x] += c[x] / 6
            M += length[0] / 6
            for r in range(3):
                _cross(dunit[r], e, work)
                _cross(unit, de[r], other)
                for x in range(3):
                    J[x, dof[r]] += (work[x] + other[x]) / 2
                    J[3 + x, dof[r]] += dc[r, x] / 6
                J[6, dof[r]] += length[1 + r] / 6
        # b = <a, n>/(2 |n|) and f = b^2/M - 2 c0 b + (c0^2 + lambda1) M: values and derivatives.
        size_n = np.sqrt(_dot(n, n))
        for x in range(3):
            unit[x] = n[x] / size_n
        an = _dot(a, unit)
        b = an / 2
        for x in range(3):
            wa[x] = unit[x] / 2
            wn[x] = (a[x] - an * unit[x]) / (2 * size_n)
        values[0] += b * b / M - 2 * c0 * b + c0 * c0 * M
        values[1] += M
        values[3] += b
        f_b, f_M = 2 * b / M - 2 * c0, c0 * c0 - b * b / (M * M)
        for x in range(3):
            p[x] = X[i, x]
        values[2] += (p[1] * n[1] + p[2] * n[2]) / 2  # flux of (0, y, z)/2, shared by the corners
        for r in range(size):
            B[r] = 0.0
            for x in range(3):
                B[r] += wa[x] * J[x, r] + wn[x] * J[3 + x, r]
            j = i if r == 0 else head[first + r - 1]
            gradients[0, j] += f_b * B[r] + f_M * J[6, r]
            gradients[1, j] += J[6, r]
        gradients[2, i] = _dot(n, directions[i])
        if place.size == 0:
            continue
        f_M += lambda1
        f_bb, f_bM, f_MM = 2 / M, -2 * b / (M * M), 2 * b * b / (M * M * M)
        for r in range(size):
            for s in range(size):
                # second derivatives of b by a and n, along both columns of J
                aa_r, aa_s, nn_r, nn_s, an_r, an_s, rs = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
                mix_rs, mix_sr = 0.0, 0.0
                for x in range(3):
                    nn_r += unit[x] * J[3 + x, r]
                    nn_s += unit[x] * J[3 + x, s]
                    aa_r += unit[x] * J[x, r]
                    aa_s += unit[x] * J[x, s]
                    an_r += a[x] * J[3 + x, r]
                    an_s += a[x] * J[3 + x, s]
                    rs += J[3 + x, r] * J[3 + x, s]
                    mix_rs += J[x, r] * J[3 + x, s]
                    mix_sr += J[x, s] * J[3 + x, r]
                b_rs = (mix_rs - aa_r * nn_s + mix_sr - aa_s * nn_r) / (2 * size_n)
                b_rs -= (an_r * nn_s + an_s * nn_r + an * (rs - 3 * nn_r * nn_s)) / (2 * size_n * size_n)
                second[r, s] = (
                    f_bb * B[r] * B[s]
                    + f_bM * (B[r] * J[6, s] + J[6, r] * B[s])
                    + f_MM * J[6, r] * J[6, s]
                    + f_b * b_rs
                )
        for x in range(3):
            wa[x] *= f_b
            wn[x] *= f_b
        for t in range(degree):
            s = t + 1 if t + 1 < degree else 0
            dof[0], dof[1], dof[2] = 0, t + 1, s + 1
            ni, nj, nk = directions[i], directions[head[first + t]], directions[head[first + s]]
            _triangle_first(ring[t], ring[s], ni, nj, nk, c, e, dc, de, unit, dunit, length, work)
            _cross(ni, nj, ddc[0, 1])
            _cross(nk, ni, ddc[0, 2])
            _cross(nj, nk, ddc[1, 2])
            for r in range(3):
                second[0, dof[r]] += lambda2 * _dot(dc[r], ni) / 6  # row i of the Hessian of the volume
                for s in range(r, 3):
                    # c is linear in each u: its pure second derivatives vanish.
                    pure = 0.0 if s == r else 1.0
                    length_rs = _dot(dc[r], dc[s]) - length[1 + r] * length[1 + s]
                    length_rs = length_rs / length[0] + pure * _dot(unit, ddc[r, s])
                    for x in range(3):
                        p[x] = pure * ddc[r, s, x] - dunit[s, x] * length[1 + r] - unit[x] * length_rs
                        p[x] = (p[x] - dunit[r, x] * length[1 + s]) / length[0]
                    _cross(p, e, work)
                    value = _dot(wa, work)
                    _cross(dunit[r], de[s], work)
                    value += _dot(wa, work)
                    _cross(dunit[s], de[r], work)
                    value = (value + _dot(wa, work)) / 2
                    value += (pure * _dot(wn, ddc[r, s]) + f_M * length_rs) / 6
                    second[dof[r], dof[s]] += value
                    if s > r:
                        second[dof[s], dof[r]] += value
        for r in range(size):
            for s in range(size):
                data[place[position]] += second[r, s]
                position += 1
    return values, gradients


__all__ = ["star_sums"]
