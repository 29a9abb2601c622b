"""Half a sphere on half a tether: the area and volume of a tube in closed form, as pearls have them at large tension."""

from __future__ import annotations

import math

from pearlbvp.roots import root


def sphere_on_tether(half: float, v: float) -> tuple[float, float]:
    """Half a period of a sphere of radius ``R`` that passes at the angle ``alpha`` into a tether.

    With the tether's radius ``a = R cos(alpha)`` and length ``d = l - R sin(alpha)``, area and volume of a tube of radius 1 are
    ``R^2 sin(alpha) + a d = l`` and ``R^3 (sin(alpha) - sin(alpha)^3/3) + a^2 d = v l``.

    Args:
        half: half the period ``l``.
        v: reduced volume.

    Returns:
        ``R`` and ``alpha``.

    Raises:
        ValueError: ``v`` lies not between 1 and that of a sphere with all the area, ``2 sqrt(l)/3``.

    Examples:
        >>> R, alpha = sphere_on_tether(5.0, 1.3)
        >>> round(R, 4), round(R * math.cos(alpha), 4)
        (2.1272, 0.17)
    """

    def sphere(a: float) -> tuple[float, float]:
        def area(R: float) -> float:
            rise = math.sqrt(R**2 - a**2)
            return R * rise + a * (half - rise) - half

        R = root(area, max(a, 1e-12), 2 * math.sqrt(half) + 1, 1e-13)
        return R, math.acos(min(a / R, 1.0))

    def excess(a: float) -> float:
        R, alpha = sphere(a)
        rise = math.sin(alpha)
        return R**3 * (rise - rise**3 / 3) + a**2 * (half - R * rise) - v * half

    if excess(0.0) * excess(1.0) >= 0:
        raise ValueError(f"v: no sphere on a tether has {v:g}")
    return sphere(root(excess, 0.0, 1.0, 1e-10))
