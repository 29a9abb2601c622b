"""The second variation of a profile point by point, for all waves at once: complex, with nothing shared between blocks."""

import numpy as np

from pearlbvp.stability.profile import curvatures


def isothermal_points(profile, count):
    """``sigma`` of the whole period evenly spaced in ``xi = integral of ds/r``, by Gauss's quadrature and Newton's method."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    mesh, states = profile.states.mesh, profile.states

    def beyond(left, right):
        half = (right - left) / 2
        points = (left + right)[:, None] / 2 + half[:, None] * nodes
        radius = states(points.ravel())[:, 0].reshape(points.shape)
        return profile.arclength * half * ((1 / radius) @ weights)

    at_mesh = np.concatenate(([0.0], np.cumsum(beyond(mesh[:-1], mesh[1:]))))
    total = (2 if profile.half else 1) * at_mesh[-1]
    target = (np.arange(count) + 0.5) * total / count
    folded = np.where(target > at_mesh[-1], total - target, target)
    interval = np.clip(np.searchsorted(at_mesh, folded, side="right") - 1, 0, len(mesh) - 2)
    left, right = mesh[interval], mesh[interval + 1]
    sigma = left + (right - left) * (folded - at_mesh[interval]) / (at_mesh[interval + 1] - at_mesh[interval])
    for _ in range(20):
        step = (at_mesh[interval] + beyond(left, sigma) - folded) * states(sigma)[:, 0] / profile.arclength
        sigma = np.clip(sigma - step, left, right)
        if np.abs(step).max() < 1e-14:
            break
    return np.where(target > at_mesh[-1], 2 - sigma, sigma), float(total)


def matrix(profile, count, n, theta):
    """Hermitian matrix of the growth rates on ``r w`` at all points, and the two rows that keep area and volume."""
    sigma, total = isothermal_points(profile, count)
    g = curvatures(profile.at(sigma), profile)
    q = 4 * g.h**2 - 2 * g.gauss
    f = 2 * g.h**2 - 2 * (profile.c0**2 + profile.lambda1)
    coupling = 2 * profile.c0 - 2 * g.h
    by_value = (
        -(g.h1**2 + g.h * g.lap)
        - f * q / 2
        + (g.around * g.h2 + g.along * g.b * g.h1)
        - 2 * g.h * g.gauss * coupling
        - 2 * (g.along * g.h2 + g.around * g.b * g.h1)
        - 2 * g.h1**2
        - ((g.around - g.h) * (g.h2 - g.b * g.h1) - g.h1**2)
    )
    x = (np.arange(count) + 0.5) / count
    kappa = 2 * np.pi * (np.arange(count) - count // 2) + theta
    wave = np.exp(1j * np.outer(x, kappa)) / np.sqrt(count)
    kappa = kappa / total
    slope = (1j * wave * kappa) @ wave.conj().T
    bending = ((wave * -(kappa**2 + n**2)) @ wave.conj().T) / g.r[:, None] + np.diag(q * g.r)
    value = g.r**2 * by_value + n**2 * (f / 2 + coupling * g.along)
    form = slope.conj().T @ ((f / 2 + coupling * g.around)[:, None] * slope) + np.diag(value)
    form = (form - 0.5 * bending.conj().T @ bending) / np.outer(g.r, g.r)
    return (form + form.conj().T) / 2, [g.h * g.r, g.r]
