"""Long trains of pearls: when slow changes of their amplitude along the tube grow, and why beyond ``c0 = 0.4884`` they do not.

Pearls of the critical wave number ``k`` on a long tube, ``u = A(x, t) e^{ikx} + c.c. + u0(x, t)`` with ``A`` and the mean
radius ``u0`` slow in ``x``, obey, with tension ``lambda1 = lambda1_c - beta2 + tau`` and ``lambda2 = lambda2_c + beta2``,

    A_t = A (a beta2 - k^2 tau + c u0 + d |A|^2) + D A_xx,    u0_t = s u0 - tau + c |A|^2,

the gradient flow of one energy, ``s`` and ``D`` from the dispersion relation. Area and volume hold the means of ``u0`` and
``|A|^2`` along the tube and nothing else: P. C. Matthews and S. M. Cox, Nonlinearity 13 (2000) 1293, for flows; B. Hilder,
J. Differential Equations 269 (2020) 4353. Along equal pearls ``u0 = -k^2 |A|^2`` keeps the area, which gives ``c`` and ``d`` by
``alpha2`` and ``b`` of ``theory.amplitude``: ``c = alpha2 + k^2 s`` and ``d = b + k^2 (alpha2 + c)``. Where a slow wave
changes ``|A|^2``, ``u0`` follows freely, and the cubic coefficient is another one,

    b_local = d - c^2/s = b - alpha2^2/s.

Equal pearls minimize ``D |A_x|^2 - b_local |A|^4/2`` at fixed mean of ``|A|^2`` up to ``|A|^2 = D q^2/(2 b_local)``, where
the wave ``q = 2 pi/L`` begins to grow: there the localized pearl branches off. With ``v = 1 - 2 a |A|^2`` this is a law for
``v_s``.
"""

from __future__ import annotations

import math

from pearlbvp.errors import InputError
from pearlbvp.helfrich import finite
from pearlbvp.roots import root


def _span(c0: float) -> float:
    """``t = 1 - k^2 = sqrt(2 - 4 c0)`` of the critical pearls, between 0 and 1.

    Raises:
        InputError: long tubes of this ``c0`` have no critical pearls.
    """
    c0 = finite("c0", c0)
    if not 0.25 < c0 < 0.5:
        raise InputError("c0", f"{c0:g} has no first pearls on very long tubes", "give a value between 0.25 and 0.5")
    return math.sqrt(2 - 4 * c0)


def _quartic(t: float) -> float:
    return 4 * t**4 - 8 * t**3 - t**2 - 18 * t + 4


def local_cubic(c0: float) -> float:
    """``b_local`` of the critical pearls, in closed form; slow waves along the tube may grow where it is positive.

    Raises:
        InputError: ``c0`` is not between 1/4 and 1/2.

    Examples:
        >>> round(local_cubic(0.48), 6), local_cubic(0.49) < 0
        (0.313186, True)
    """
    t = _span(c0)
    return t * (t - 2) * _quartic(t) / (4 * (t - 1) ** 2)


def loss_of_stability(c0: float) -> float:
    """The limit of ``(v_s - 1) L^2`` on long tubes, where ``v_s`` ends the stability of pearls of the critical period.

    Infinite from ``marginal_c0()`` on, where ``v_s`` stays away from 1.

    Raises:
        InputError: ``c0`` is not between 1/4 and 1/2.

    Examples:
        >>> [round(loss_of_stability(c0), 4) for c0 in (0.3, 0.4, 0.48)]
        [0.0209, 1.2507, 51.1384]
    """
    t = _span(c0)
    if local_cubic(c0) <= 0:
        return math.inf
    return 32 * math.pi**2 * (1 - t) ** 3 / ((t - 2) * _quartic(t))


def marginal_c0() -> float:
    """The ``c0`` from which on long trains of critical pearls are stable to all slow waves: about 0.488373.

    Examples:
        >>> round(marginal_c0(), 8)
        0.48837257
    """
    t = root(_quartic, 0.0, 1.0, 1e-15)
    return 0.5 - t**2 / 4
