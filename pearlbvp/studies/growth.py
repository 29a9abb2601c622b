"""How fast do waves of a straight tube grow in water, which of them is fastest, and above which tension do pearls grow?"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pearlbvp.errors import InputError
from pearlbvp.helfrich import LARGEST_C0, Tube, cylinder_force, finite, whole
from pearlbvp.numbers import as_numbers
from pearlbvp.theory.dispersion import growing_waves, growth_rate, long_tube_interval, mode_type, stable_interval
from pearlbvp.theory.stokes import Fluids, fastest_waves, stokes_rate
from pearlbvp.units import Sentence

COLUMNS = ["m", "n", "k", "type", "wavelength", "rate", "mu", "mu_diffusion", "role",
           "c0", "L", "lambda1", "lambda2", "lambda1_lower", "lambda1_pearl", "force"]  # fmt: skip

MOST_ROWS = 1_000_000

LARGEST_WAVE_NUMBER = 1e4
"""Shorter waves are shorter than a membrane is thick."""

LARGEST_TENSION, LARGEST_PRESSURE = 1e12, 1e3
"""Beyond the first a number is a mistake of units; at a ``lambda2`` beyond the second, tens of waves around the tube grow."""


def growth(
    c0: float,
    tension: float,
    length: float | None = None,
    *,
    wave_numbers: Iterable[float] | None = None,
    max_m: int | None = None,
    max_n: int = 2,
    viscosity_ratio: float = 1.0,
    membrane_viscosity: float = 0.0,
) -> pd.DataFrame:
    """Growth rates of waves of the straight tube: in fluids inside and outside of it, and in two flows without fluids.

    Args:
        c0: spontaneous curvature.
        tension: ``lambda1``, that is ``Sigma R^2/(2 kappa)``; the pressure is what the straight tube has at that tension.
        length: axial period, in radii; without it any wave number is that of a wave.
        wave_numbers: along the tube, without a length; by default 30 up to 1.5, or beyond what grows.
        max_m: most waves along a tube of a length; by default as far as the wave numbers without one.
        max_n: most waves around the tube.
        viscosity_ratio: viscosity of the fluid inside, by that of the fluid outside.
        membrane_viscosity: surface viscosity of the membrane, by the viscosity of the fluid outside and the radius.

    Returns:
        A row a wave, by ``n`` and ``k``: ``m`` (of a length), ``n, k, type, wavelength``; ``rate`` in fluids (Stokes flow, the
        membrane incompressible), in units of ``2 kappa/(eta R^3)``; ``mu`` of the flow ``V_t = G`` and ``mu_diffusion`` of its
        Laplacian, each in the unit of its mobility; ``role``, which is ``fastest`` where ``rate`` is largest of all waves that
        fit, and positive; ``c0, L, lambda1, lambda2``; and between which tensions no wave grows: above ``lambda1_pearl`` pearls
        do, below ``lambda1_lower`` others. They are empty where there is no such tension. ``force`` is that along the axis.

    Raises:
        InputError: an argument that cannot be used.

    Examples:
        >>> import pearlbvp as pb
        >>> table = pb.growth(c0=0, tension=1.5)
        >>> table[table.role == "fastest"][["k", "rate", "lambda1_pearl"]].round(4).to_dict("records")
        [{'k': 0.4697, 'rate': 0.0155, 'lambda1_pearl': 0.75}]
    """
    fluids = Fluids(viscosity_ratio, membrane_viscosity)
    c0, lambda1, lambda2 = known_tension(c0, tension)
    tube = None if length is None else Tube(c0, length)
    along = _wave_numbers(tube, wave_numbers, max_m, shortest_wave(lambda2, c0))
    around = whole("max_n", max_n, 0) + 1
    if along.size * around > MOST_ROWS:
        raise InputError("max_n", f"{along.size * around} waves are too many to list", "give a smaller max_n or max_m")
    waves = {n: along[along > 0] if n < 2 else along for n in range(around)}  # others are no waves
    fastest = _fastest(lambda2, c0, fluids, tube)
    if fastest is not None:
        k, n = fastest
        waves[n] = np.append(waves.get(n, []), k)
    table = pd.concat(
        [_rates(np.unique(k), n, lambda2, c0, fluids) for n, k in sorted(waves.items())], ignore_index=True
    )
    is_fastest = [wave == fastest for wave in zip(table["k"], table["n"], strict=True)]
    lower, pearl = stable_tensions(c0, tube)
    table = table.assign(
        m=math.nan if tube is None else (table["k"] / tube.wave_number(1)).round(),
        role=np.where(is_fastest, "fastest", ""),
        c0=c0,
        L=math.nan if tube is None else tube.length,
        lambda1=lambda1,
        lambda2=lambda2,
        lambda1_lower=lower,
        lambda1_pearl=pearl,
        force=cylinder_force(lambda2, c0),
    )
    return table.astype({"m": "Int64"})[COLUMNS]


def shortest_wave(lambda2: float, c0: float) -> float:
    """Up to which wave number waves are of interest: 1.5, or a fifth beyond all that grow."""
    return max([1.5, *(1.2 * high for _, high in growing_waves(lambda2, c0).values())])


def curves(table: pd.DataFrame, *, viscosity_ratio: float = 1.0, membrane_viscosity: float = 0.0) -> pd.DataFrame:
    """The same columns over many wave numbers, as if each fitted the tube: to draw a table of ``growth`` by."""
    first = table.iloc[0]
    along = np.linspace(1e-3, 1, 400) * float(table["k"].max())
    return growth(
        first["c0"], first["lambda1"], wave_numbers=along, max_n=int(table["n"].max()),
        viscosity_ratio=viscosity_ratio, membrane_viscosity=membrane_viscosity,
    )  # fmt: skip


def title(table: pd.DataFrame) -> Sentence:
    """What tube a table of ``growth`` is of."""
    first = table.iloc[0]
    words = "c0 = {c0:g}, tension {lambda1:g}" + ("" if math.isnan(first["L"]) else ", L = {L:g}")
    return Sentence(words, c0=float(first["c0"]), lambda1=float(first["lambda1"]), L=float(first["L"]))


def summary(table: pd.DataFrame) -> Sentence:
    """What a table of ``growth`` says in a sentence: the fastest wave, and when the tube rests."""
    first = table.iloc[0]
    pearl, lower = float(first["lambda1_pearl"]), float(first["lambda1_lower"])
    if math.isnan(lower):
        rests = "no tension keeps the tube straight"
    elif math.isnan(pearl):
        rests = "the tube is straight at tensions above {lambda1_lower:.6g}"
    else:
        rests = (
            "the tube is straight at tensions from {lambda1_lower:.6g} to {lambda1_pearl:.6g}, above which it pearls"
        )
    fastest = table[table["role"] == "fastest"]
    if fastest.empty:
        return Sentence(f"no wave grows: {rests}", lambda1_lower=lower, lambda1_pearl=pearl)
    row = fastest.iloc[0]
    wave = "{wavelength:.6g} {wavelength_unit} long" if row["k"] > 0 else "as long as the tube"
    if row["n"]:
        wave += f", with {row['n']} around it,"
    return Sentence(
        f"the fastest wave is {wave} and grows at {{rate:.6g}}; {rests}",
        wavelength=float(row["wavelength"]), rate=float(row["rate"]), lambda1_lower=lower, lambda1_pearl=pearl,
    )  # fmt: skip


def stable_tensions(c0: float, tube: Tube | None = None) -> tuple[float, float]:
    """Between which ``lambda1`` no wave of a tube grows: others do below, pearls above; not a number where there is no end.

    Args:
        c0: spontaneous curvature.
        tube: of a length, or none for one on which every wave fits.
    """
    if tube is None:
        lower, upper = long_tube_interval(c0)
    else:
        interval = stable_interval(tube)
        lower, upper = interval.lower, interval.upper
    ends = [0.25 - c0**2 - lambda2 if lower < upper else math.nan for lambda2 in (upper, lower)]
    return ends[0], ends[1] if math.isfinite(ends[1]) else math.nan


def known_tension(c0: float, tension: float) -> tuple[float, float, float]:
    """``c0, lambda1, lambda2`` of the straight tube.

    Raises:
        InputError: one cannot be used.
    """
    c0, tension = finite("c0", c0), finite("tension", tension)
    if abs(c0) > LARGEST_C0:
        raise InputError("c0", f"{c0:g} is beyond {LARGEST_C0:g} in units of 1/radius", "check its unit")
    if abs(tension) > LARGEST_TENSION:
        raise InputError(
            "tension", f"{tension:g} is beyond {LARGEST_TENSION:g} in units of 2 kappa/R^2", "check its unit"
        )
    lambda2 = 0.25 - tension - c0**2
    if lambda2 > LARGEST_PRESSURE:
        raise InputError(
            "tension",
            Sentence("at {tension:g} more waves around the tube grow than can be listed", tension=tension),
            Sentence("give more than {tension:.6g}", tension=0.25 - LARGEST_PRESSURE - c0**2),
        )
    return c0, tension, lambda2


def _fastest(lambda2: float, c0: float, fluids: Fluids, tube: Tube | None) -> tuple[float, int] | None:
    """Wave number and waves around of the wave that grows fastest of all that fit."""
    peaks = fastest_waves(lambda2, c0, fluids)
    found = [(k, n) for n, k in peaks.items()]
    if tube is not None:  # next to a maximum over all wave numbers
        one = tube.wave_number(1)
        found = [(m * one, n) for k, n in found for m in (math.floor(k / one), math.ceil(k / one))]
    rates = [float(stokes_rate(k, n, lambda2, c0, fluids)) for k, n in found]
    best = max(range(len(found)), key=rates.__getitem__, default=None)
    return None if best is None or rates[best] <= 0 else found[best]


def _wave_numbers(
    tube: Tube | None, wave_numbers: Iterable[float] | None, max_m: int | None, largest: float
) -> NDArray[np.float64]:
    """Wave numbers along the tube, zero or more: as given, or as a tube's length has them, or 30.

    Raises:
        InputError: an argument that cannot be used, or does not go with another.
    """
    if tube is not None:
        if wave_numbers is not None:
            raise InputError("wave_numbers", "a tube of a given length has its own", "leave one of the two out")
        max_m = math.floor(largest / tube.wave_number(1)) if max_m is None else whole("max_m", max_m, 0)
        if max_m > MOST_ROWS:
            raise InputError("max_m", f"{max_m} waves are too many to list", "give a smaller max_m")
        return tube.wave_number(1) * np.arange(max_m + 1, dtype=np.float64)
    if max_m is not None:
        raise InputError("max_m", "it goes with a length", "give that, or wave_numbers instead")
    if wave_numbers is None:
        return largest * np.linspace(0, 1, 31, dtype=np.float64)
    given = np.array(as_numbers("wave_numbers", wave_numbers), dtype=np.float64)
    if given.min() < 0 or given.max() > LARGEST_WAVE_NUMBER:
        raise InputError(
            "wave_numbers", f"there are some that are negative or beyond {LARGEST_WAVE_NUMBER:g}", "leave them out"
        )
    return given


def _rates(k: NDArray[np.float64], n: int, lambda2: float, c0: float, fluids: Fluids) -> pd.DataFrame:
    """The rates of waves with one number around the tube."""
    mu = growth_rate(k, n, lambda2, c0)
    with np.errstate(divide="ignore"):
        wavelength = np.where(k > 0, 2 * math.pi / k, math.nan)
    rates = {"rate": stokes_rate(k, n, lambda2, c0, fluids), "mu": mu, "mu_diffusion": (k**2 + n**2) * mu}
    kind = [mode_type(int(one > 0), n) for one in k]
    return pd.DataFrame({"n": n, "k": k, "type": kind, "wavelength": wavelength, **rates})
