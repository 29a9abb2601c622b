"""The isothermal coordinate ``xi = integral of ds/r`` of a profile, in which its surface is a conformal image of a cylinder.

On every interval of the profile's mesh ``1/r`` is a Chebyshev series, which is integrated term by term (L. N. Trefethen,
Approximation Theory and Approximation Practice (SIAM 2013), chapters 4 and 19).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev

from pearlbvp.arrays import Array
from pearlbvp.collocation.scheme import lagrange_matrix
from pearlbvp.representation import brief
from pearlbvp.stability.profile import Profile

TERMS = 20
"""Of the series of ``1/r`` on an interval: on meshes that resolve a profile to 1e-9 they are known to rounding."""


@cache
def _nodes() -> tuple[Array, Array]:
    """Chebyshev points of [0, 1], shape (T,), and from values there to coefficients of the integral from 0 and of the
    function itself, shape (T + 1, 2, T)."""
    x = chebyshev.chebpts1(TERMS)
    series = chebyshev.chebvander(x, TERMS - 1).T * (2 / TERMS)
    series[0] /= 2
    integral = chebyshev.chebint(series, lbnd=-1, scl=0.5)  # x = 2 tau - 1
    return (x + 1) / 2, np.stack((integral, np.vstack((series, np.zeros(TERMS)))), axis=1)


@dataclass(frozen=True)
class Isothermal:
    """The isothermal coordinate along a profile, from its first point on.

    Attributes:
        mesh: the profile's, in ``sigma``, shape (N + 1,).
        at_mesh: the coordinate there, shape (N + 1,).
        series: Chebyshev coefficients on every interval of the coordinate beyond its left end, and of its derivative by the
            share of the interval, shape (T + 1, 2, N).
        half: whether the profile is half a period.
    """

    __repr__ = brief

    mesh: Array
    at_mesh: Array
    series: Array
    half: bool

    @classmethod
    def of(cls, profile: Profile) -> Isothermal:
        """Integrate along a profile."""
        nodes, to_series = _nodes()
        states = profile.states
        radius = states.local()[:, :, 0] @ lagrange_matrix(states.scheme.points, nodes).T
        rate = profile.arclength * np.diff(states.mesh)[:, None] / radius
        series = to_series @ rate.T
        at_mesh = np.concatenate(([0.0], np.cumsum(series[:, 0].sum(axis=0))))
        return cls(states.mesh, at_mesh, series, profile.half)

    @property
    def period(self) -> float:
        """The whole period in ``xi``."""
        return float(self.at_mesh[-1]) * (2 if self.half else 1)

    def points(self, count: int) -> Array:
        """``sigma`` at ``xi = (j + 1/2) / count`` of the whole period, as many of these as lie on the profile.

        Args:
            count: of the whole period, even; the second half of a half profile's is the first mirrored.
        """
        target = (np.arange(count // 2 if self.half else count) + 0.5) * self.period / count
        interval = np.clip(np.searchsorted(self.at_mesh, target, side="right") - 1, 0, len(self.mesh) - 2)
        left, width = self.mesh[interval], np.diff(self.mesh)[interval]
        beyond, series = target - self.at_mesh[interval], self.series[:, :, interval]
        share = beyond / np.diff(self.at_mesh)[interval]
        for _ in range(20):  # Newton's method
            xi, rate = chebyshev.chebval(2 * share - 1, series, tensor=False)
            step = (xi - beyond) / rate
            share = np.clip(share - step, 0.0, 1.0)
            if np.abs(step).max() < ROUNDING:
                break
        return np.asarray(left + width * share)


ROUNDING = 1e-9
"""Step, in shares of an interval, after which Newton's method, which squares it, has the coordinate to rounding."""
