"""What the paper says of the straight tube in closed form: Figs. neigs and stabfig."""

from __future__ import annotations

import numpy as np
import pandas as pd

from pearlbvp.helfrich import Tube
from pearlbvp.paper.sheet import Panel, Rates, Regions, Sectors, Sheet
from pearlbvp.studies.dispersion import instability_curves
from pearlbvp.theory.dispersion import (
    critical_lambda2,
    critical_wave_number,
    growth_rate,
    long_tube_interval,
)

K_MAX = 1.6
"""Largest wave number of the curves."""


def neigs() -> Sheet:
    """Where the straight tube is unstable, over the wave number, and growth rates at criticality (eqs. (l2hu), (inmixed))."""
    regions = [
        Regions(letter, c0, instability_curves(c0, K_MAX, 2, 401))
        for letter, c0 in zip("abc", (0.0, -1.0, 0.48), strict=True)
    ]
    k = np.linspace(0.0, K_MAX, 321)
    critical = [(f"c0 = {c0:g}, {end}", c0, lambda2) for c0 in (0.0, -1.0, 0.48)
                for end, lambda2 in zip(("lower end", "upper end"), long_tube_interval(c0), strict=True)]  # fmt: skip
    rates = [_rates(case, k, (0, 1, 2), lambda2, c0) for case, c0, lambda2 in critical]
    unstable = [_rates("c0 = 0.75, lambda2 = 0", k, (0,), 0.0, 0.75)]
    panels: tuple[Panel, ...] = (
        *regions,
        Rates("d", pd.concat(rates, ignore_index=True)),
        Regions("e_regions", 0.75, instability_curves(0.75, K_MAX, 2, 401)),
        Rates("e_rates", pd.concat(unstable, ignore_index=True)),
    )
    return Sheet(panels, _onsets() | _long_tubes())


def _rates(case: str, k: np.ndarray, waves: tuple[int, ...], lambda2: float, c0: float) -> pd.DataFrame:
    tables = [pd.DataFrame({"case": case, "n": n, "k": k, "mu": growth_rate(k, n, lambda2, c0)}) for n in waves]
    return pd.concat(tables, ignore_index=True)


def _onsets() -> dict[tuple[str, str], float]:
    """Wave numbers and pressures of modes that §§3 and 5 print."""
    return {
        ("wrinkling (0,2)", "lambda2"): float(critical_lambda2(0.0, 2, 0.0)),
        ("L = 10, m = 1", "k"): Tube(0.0, 10).wave_number(1),
        ("L = 10, m = 2", "k"): Tube(0.0, 10).wave_number(2),
        ("L = 15, m = 2", "k"): Tube(0.0, 15).wave_number(2),
        ("L = 30, m = 1", "k"): Tube(0.0, 30).wave_number(1),
        ("c0 = 0.48", "period"): 2 * np.pi / critical_wave_number(0.48),
    }


def _long_tubes() -> dict[tuple[str, str], float]:
    """Ends of the stable interval of the infinitely long tube (Corollary destabcor)."""
    found: dict[tuple[str, str], float] = {}
    for c0 in (0.0, -1.0, 0.48):
        lower, upper = long_tube_interval(c0)
        found |= {(f"c0 = {c0:g}, long", "lambda2_pearl"): lower, (f"c0 = {c0:g}, long", "lambda2_upper"): upper}
    return found


def stabfig() -> Sheet:
    """Directions and stability of coils and buckles over ``b1`` and ``b2``, a row for each of the eight sectors.

    For ``a > 0`` coils are supercritical where ``b1 < 0``, buckles where ``b1 + b2 < 0``; at fixed area and volume coils are
    stable where ``b2 < b1``, buckles where ``b1 < b2``. (The text after eq. (ampsys) has a sign error, the figure has not.)
    """
    angles = np.deg2rad(22.5 + 45 * np.arange(8))
    b1, b2 = np.cos(angles), np.sin(angles)
    table = pd.DataFrame(
        {
            "b1": b1,
            "b2": b2,
            "coils": np.where(b1 < 0, "supercritical", "subcritical"),
            "buckles": np.where(b1 + b2 < 0, "supercritical", "subcritical"),
            "stable": np.where(b2 < b1, "coil", "buckle"),
        }
    )
    return Sheet((Sectors("a", table),), {})
