"""Energy and area densities of a tube ``(x, P(x, phi))`` with exact first and second derivatives, compiled.

See ``docs/theory/reduced_modes.md``. Ten fields, linear in the unknowns, say all of a surface at a point: the real and
imaginary parts of ``a = P_x, b = P_phi, p = P_xx, q = P_xphi, s = P_phiphi``, turned by ``e^{-i(kappa x + phi)}``. With ``X
= (x, P)`` and the inner normal

    g11 = 1 + |a|^2,  g12 = a.b,  g22 = |b|^2,  h_ij sqrt(g) = b x P_ij,  g = g22 + (a x b)^2
    M = g22 h11 - 2 g12 h12 + g11 h22 (times sqrt(g)),  H = M / (2 g^(3/2))

the energy density is ``(H - c0)^2 sqrt(g) = M^2/(4 g^(5/2)) - c0 M/g + c0^2 sqrt(g)``, the area's ``sqrt(g)``.
"""

from __future__ import annotations

import numpy as np

from pearlbvp.compiled import compiled


@compiled
def _invariants(z, first):  # type: ignore[no-untyped-def]
    """``M, g``, their gradients in rows 0 and 1 of ``first`` (9, 10), and those of the seven products in rows 2 to 8."""
    a0, a1, b0, b1 = z[0], z[1], z[2], z[3]
    g11, g12, g22 = 1.0 + a0**2 + a1**2, a0 * b0 + a1 * b1, b0**2 + b1**2
    c = a0 * b1 - a1 * b0
    h11, h12, h22 = b0 * z[5] - b1 * z[4], b0 * z[7] - b1 * z[6], b0 * z[9] - b1 * z[8]
    first[:, :] = 0.0
    first[2, 0], first[2, 1] = 2 * a0, 2 * a1  # g11
    first[3, 0], first[3, 1], first[3, 2], first[3, 3] = b0, b1, a0, a1  # g12
    first[4, 2], first[4, 3] = 2 * b0, 2 * b1  # g22
    first[5, 0], first[5, 1], first[5, 2], first[5, 3] = b1, -b0, -a1, a0  # c
    for i in range(3):  # h11, h12, h22
        re, im = 4 + 2 * i, 5 + 2 * i
        first[6 + i, 2], first[6 + i, 3], first[6 + i, re], first[6 + i, im] = z[im], -z[re], -b1, b0
    for j in range(10):
        first[0, j] = (
            h11 * first[4, j] + g22 * first[6, j] - 2 * (h12 * first[3, j] + g12 * first[7, j])
            + h22 * first[2, j] + g11 * first[8, j]
        )  # fmt: skip
        first[1, j] = first[4, j] + 2 * c * first[5, j]
    return g22 * h11 - 2 * g12 * h12 + g11 * h22, g22 + c**2, g11, g12, g22, c, h11, h12, h22


@compiled
def areas(z):  # type: ignore[no-untyped-def]
    """Density of the area, shape (K,), and its gradient in the first four fields, the only ones it depends on: (4, K)."""
    count = z.shape[1]
    values, slopes = np.empty(count), np.empty((4, count))
    for k in range(count):
        a0, a1, b0, b1 = z[0, k], z[1, k], z[2, k], z[3, k]
        c = a0 * b1 - a1 * b0
        root = np.sqrt(b0**2 + b1**2 + c**2)
        values[k] = root
        slopes[0, k], slopes[1, k] = c * b1 / root, -c * b0 / root
        slopes[2, k], slopes[3, k] = (b0 - c * a1) / root, (b1 + c * a0) / root
    return values, slopes


@compiled
def gradients(z, c0):  # type: ignore[no-untyped-def]
    """Density of the energy, shape (K,), and its gradient in the fields, shape (10, K), for fields (10, K)."""
    count = z.shape[1]
    values, slopes, first = np.empty(count), np.empty((10, count)), np.empty((9, 10))
    for k in range(count):
        m, g = _invariants(z[:, k], first)[:2]
        root = np.sqrt(g)
        values[k] = m**2 / (4 * g**2 * root) - c0 * m / g + c0**2 * root
        by_m = m / (2 * g**2 * root) - c0 / g
        by_g = -5 * m**2 / (8 * g**3 * root) + c0 * m / g**2 + c0**2 / (2 * root)
        for j in range(10):
            slopes[j, k] = by_m * first[0, j] + by_g * first[1, j]
    return values, slopes


@compiled
def hessians(z, c0, lambda1):  # type: ignore[no-untyped-def]
    """Second derivatives of energy plus ``lambda1`` times area in the fields, shape (K, 10, 10), for fields (10, K)."""
    count = z.shape[1]
    result, first = np.zeros((count, 10, 10)), np.empty((9, 10))
    for k in range(count):
        m, g, g11, g12, g22, c, h11, h12, h22 = _invariants(z[:, k], first)
        root = np.sqrt(g)
        by_m = m / (2 * g**2 * root) - c0 / g
        by_g = -5 * m**2 / (8 * g**3 * root) + c0 * m / g**2 + (c0**2 + lambda1) / (2 * root)
        by_mm = 1 / (2 * g**2 * root)
        by_mg = -5 * m / (4 * g**3 * root) + c0 / g**2
        by_gg = 35 * m**2 / (16 * g**4 * root) - 2 * c0 * m / g**3 - (c0**2 + lambda1) / (4 * g * root)
        z2 = result[k]
        for i in range(10):
            for j in range(i + 1):
                second_m = (
                    first[4, i] * first[6, j] + first[6, i] * first[4, j]
                    - 2 * (first[3, i] * first[7, j] + first[7, i] * first[3, j])
                    + first[2, i] * first[8, j] + first[8, i] * first[2, j]
                )  # fmt: skip
                z2[i, j] = (
                    by_mm * first[0, i] * first[0, j]
                    + by_mg * (first[0, i] * first[1, j] + first[1, i] * first[0, j])
                    + by_gg * first[1, i] * first[1, j]
                    + by_m * second_m
                    + by_g * 2 * first[5, i] * first[5, j]
                )
        # The constant second derivatives of the products, lower triangle: weights of g11, g12, g22, c, h11, h12, h22.
        of11, of12, of22, of_c = by_m * h22, -2 * by_m * h12, by_m * h11 + by_g, 2 * by_g * c
        z2[0, 0] += 2 * of11
        z2[1, 1] += 2 * of11
        z2[2, 0] += of12
        z2[3, 1] += of12
        z2[2, 2] += 2 * of22
        z2[3, 3] += 2 * of22
        z2[3, 0] += of_c
        z2[2, 1] -= of_c
        weights = (by_m * g22, -2 * by_m * g12, by_m * g11)
        for i in range(3):
            z2[5 + 2 * i, 2] += weights[i]
            z2[4 + 2 * i, 3] -= weights[i]
        for i in range(10):
            for j in range(i):
                z2[j, i] = z2[i, j]
    return result
