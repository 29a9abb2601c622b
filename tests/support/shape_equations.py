"""Pearls in an osmotic bath by another parametrization and somebody else's solver: an oracle for ``shapes.osmotic``.

The profile's Lagrangian by arclength, with multipliers of ``r' = sin psi`` and ``x' = cos psi``, all by 2 pi::

    L = r [(H - c0)^2 + lambda1] + lambda2 r^2 cos(psi)/2 + gamma (r' - sin psi) + eta (x' - cos psi),  2H = cos(psi)/r - psi'

(compare U. Seifert, K. Berndl, R. Lipowsky, Phys. Rev. A 44 (1991) 1182, eq. (2.6)). Hamilton's equations for ``r, psi`` and
their momenta ``gamma`` and ``p = dL/dpsi' = -r (H - c0)`` know neither ``H'`` nor the shape equation; ``eta`` is constant,
the Hamiltonian is zero as the arclength is free.
"""

import numpy as np
from scipy.integrate import solve_bvp


def pearl(c0, solute, osmolarity, period, guess, tolerance=1e-9):
    """Half a pearl from belly to neck.

    ``guess``: positions x from 0 to period / 2 and radii. Returns ``r_max, r_min, v, lambda2, force``.
    """
    lambda1 = 0.25 - c0**2

    def curvature(y):
        r, psi, _gamma, p = y[:4]
        h = c0 - p / r
        return h, np.cos(psi) / r - 2 * h  # and psi'

    def hamiltonian(y, eta, lambda2):
        r, psi, gamma, p = y[:4]
        h, bend = curvature(y)
        energy = r * ((h - c0) ** 2 + lambda1) + lambda2 * r**2 * np.cos(psi) / 2
        return p * bend + gamma * np.sin(psi) + eta * np.cos(psi) - energy

    def rhs(_t, y, parameters):
        length, eta, lambda2 = parameters
        r, psi, gamma = y[:3]
        h, bend = curvature(y)
        sine, cosine = np.sin(psi), np.cos(psi)
        d_gamma = (h - c0) ** 2 + lambda1 - (h - c0) * cosine / r + lambda2 * r * cosine
        d_p = -(h - c0) * sine - lambda2 * r**2 * sine / 2 - gamma * cosine + eta * sine
        return length * np.array([sine, bend, d_gamma, d_p, cosine, r**2 * cosine])

    def ends(a, b, parameters):
        _, eta, lambda2 = parameters
        v = b[5] / (period / 2)
        return np.array(
            [a[1], a[2], a[4], a[5], b[1], b[2], b[4] - period / 2,
             hamiltonian(a, eta, lambda2), lambda2 + solute / v - osmolarity]
        )  # fmt: skip

    x, r = guess
    s = np.append(0.0, np.cumsum(np.hypot(np.diff(x), np.diff(r))))
    psi = np.unwrap(np.arctan2(np.gradient(r, s), np.gradient(x, s)))
    psi[[0, -1]] = 0.0
    h = (np.cos(psi) / r - np.gradient(psi, s)) / 2
    volume = np.append(0.0, np.cumsum(np.diff(x) * (r[1:] ** 2 + r[:-1] ** 2) / 2))
    first = np.array([r, psi, 0 * r, -r * (h - c0), x, volume])
    lambda2 = osmolarity - solute / (volume[-1] / x[-1])
    found = solve_bvp(rhs, ends, s / s[-1], first, [s[-1], 0.1, lambda2], tol=tolerance, max_nodes=20000)
    assert found.success, found.message
    r, v = found.y[0], found.y[5, -1] / (period / 2)
    return {"r_max": r[0], "r_min": r[-1], "v": v, "lambda2": found.p[2], "force": 2 * np.pi * found.p[1]}
