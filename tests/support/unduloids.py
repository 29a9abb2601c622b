"""The Jacobi operator of an unduloid, by a Fourier method that shares nothing with the package's collocation."""

import math

import numpy as np
import scipy.linalg


def _jacobi(unduloid, frequencies, functions, points=120):
    """``J = Laplacian + |A|^2`` on functions of arclength between belly and neck; what it is of, and weights of the area."""
    h, b = unduloid.mean, unduloid.shape
    half = math.pi / (2 * h)
    s = half * (np.arange(points) + 0.5) / points
    t = math.pi / 2 + 2 * h * s
    size = np.sqrt(1 + b * b + 2 * b * np.sin(t))
    r, cosine, sine = size / (2 * h), (1 + b * np.sin(t)) / size, b * np.cos(t) / size
    around = cosine / r
    k = frequencies(np.arange(points)) * math.pi / half
    phase = np.outer(s, k)
    even = functions == "cos"
    values, slopes = (np.cos(phase), -k * np.sin(phase)) if even else (np.sin(phase), k * np.cos(phase))
    applied = -(k**2) * values + (sine / r)[:, None] * slopes
    applied += (around**2 + (2 * h - around) ** 2)[:, None] * values
    return applied @ np.linalg.inv(values), r * half / points


def neutral_tensions(unduloid, kind):
    """``lambda1``, largest first, at which waves on an unduloid are neutral where ``c0`` is its mean curvature.

    The second variation of energy, area and volume is ``J (J/2 - lambda1)`` there. Of ``equal`` pearls it is constrained: area
    and volume are kept where the integral of the wave vanishes. ``belly`` and ``neck`` are waves that alternate from pearl to pearl
    and are even about those.
    """
    if kind != "equal":
        jacobi, _ = _jacobi(unduloid, lambda j: j + 0.5, "cos" if kind == "belly" else "sin")
        return np.sort(np.linalg.eigvals(jacobi).real)[::-1] / 2
    jacobi, weights = _jacobi(unduloid, lambda j: j, "cos")
    n = len(weights)
    left, right = np.zeros((2, n + 1, n + 1))
    left[:n, :n], left[:n, n], left[n, :n] = jacobi @ jacobi, -1, weights
    right[:n, :n] = 2 * jacobi
    found = scipy.linalg.eigvals(left, right)
    return np.sort(found[np.isfinite(found) & (np.abs(found) < 1e3) & (np.abs(found.imag) < 1e-6)].real)[::-1]
