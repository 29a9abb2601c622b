"""Which pearl period appears on a tube, over which range is the tube stable, and when does a localized pearl take over?"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np
import pandas as pd
from numpy.polynomial.chebyshev import chebval

from pearlbvp.arrays import Array
from pearlbvp.continuation import PathOptions, Solution, follow
from pearlbvp.continuation.chebyshev import Unresolved, in_pieces, series
from pearlbvp.continuation.path import PathEnd
from pearlbvp.continuation.segment import Segment
from pearlbvp.errors import InputError, Interruption
from pearlbvp.helfrich import Tube, positive, whole
from pearlbvp.messages import say
from pearlbvp.numbers import as_numbers
from pearlbvp.progress import progress as progress_bar
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.shapes.pearling import pearling_onset
from pearlbvp.studies.first_pearls import first_pearls
from pearlbvp.studies.parallel import in_processes
from pearlbvp.studies.pearl_series import DEGREES, FEWEST, HOPELESS, TOLERANCE, scaled, unscaled
from pearlbvp.studies.stability_loss import THINNEST_NECK

COLUMNS = ["c0", "L", "pearls", "period", "k", "status", "lambda2_pearl", "lambda2_upper", "upper_mode",
           "v_localized", "localized_status", "message"]  # fmt: skip

_FEWEST_FOR_PROCESSES = 8
"""Below this many values of ``c0``, starting processes costs more than it saves."""

NEAREST = -6.0
"""Scaled period, 2 pi and an eighth of a percent, nearest to ``2 pi`` at which a series of energies is tried."""


def least_energies(c0: float, lengths: Sequence[float], v: float) -> list[dict[str, object]]:
    """The number of equal pearls of least energy at a reduced volume, among all numbers with ``k < 1``, on tubes of one ``c0``.

    Each number's branch is followed from the cylinder to ``v``; those that do not reach it are left out. Localized and
    unequal pearls are not among them.

    Returns:
        For each length ``v, pearls_least_energy, E_least_energy``; the last two empty where no branch reaches that volume.
    """
    counts = [range(1, math.ceil(Tube(c0, length).length / (2 * math.pi))) for length in lengths]
    found = _energies(
        c0, sorted({length / m for length, several in zip(lengths, counts, strict=True) for m in several}), v
    )
    rows: list[dict[str, object]] = []
    for length, several in zip(lengths, counts, strict=True):
        energies = {m: energy for m in several if (energy := found[length / m]) is not None}
        best = min(energies, key=lambda m: energies[m], default=None)
        rows.append({"v": v, "pearls_least_energy": best, "E_least_energy": None if best is None else energies[best]})
    return rows


def _energies(c0: float, periods: Sequence[float], v: float) -> dict[float, float | None]:
    """``E/A`` of pearls of several periods where they first reach a volume: a series in the period where it is smooth."""

    def resolved(low: float, high: float) -> tuple[float, float, Array]:
        def sample(t: float) -> Array:
            energy = _energy_at(Tube(c0, unscaled(low + t * (high - low))), 1, v)
            if energy is None:
                raise Unresolved("some pearls do not reach the volume")
            return np.array([energy])

        coefficients, error, _ = series(sample, TOLERANCE, *DEGREES, hopeless=HOPELESS)
        if error > TOLERANCE:
            raise Unresolved("the energy is not smooth in the period")
        return low, high, coefficients[:, 0]

    u = scaled(np.array(periods))
    pieces = in_pieces(resolved, NEAREST, float(u.max()), u, FEWEST) if len(u) else []
    energies: dict[float, float | None] = {}
    for low, high, coefficients in pieces:
        here = (low <= u) & (u <= high)
        values = chebval((2 * u[here] - low - high) / (high - low), coefficients)
        energies |= dict(zip(np.array(periods)[here].tolist(), values.tolist(), strict=True))
    return energies | {p: _energy_at(Tube(c0, p), 1, v) for p in periods if p not in energies}


def _energy_at(tube: Tube, m: int, v: float) -> float | None:
    """``E/A`` of ``m`` equal pearls at reduced volume ``v``, where their branch first reaches it."""
    problem, u, tangent = pearling_onset(tube, m)

    def reached(point: Solution[PearlProblem]) -> bool:
        return bool((point.observables["v"] - v) * (1 - v) <= 0)

    def stop(point: Solution[PearlProblem]) -> str | None:
        return "reached" if reached(point) else "a neck" if point.observables["r_min"] < THINNEST_NECK else None

    path = follow(Solution(problem, u, tangent), PathOptions(max_step=1.0), stop)
    if len(path.points) < 2 or not reached(path.points[-1]):
        return None
    before, after = path.points[-2:]
    difference = before.observables["v"] - v
    try:
        return Segment(before, after).root(lambda point: point.observables["v"] - v, difference).observables["E"]
    except PathEnd:
        return None


def rows_of(c0: float, lengths: Sequence[float], v: float | None = None) -> list[dict[str, object]]:
    """The rows of one ``c0``."""
    rows = [found.period_row() for found in first_pearls(c0, lengths)[0]]
    if v is None:
        return rows
    return [row | least for row, least in zip(rows, least_energies(c0, lengths, v), strict=True)]


def _rows(case: tuple[float, Sequence[float], float | None]) -> list[dict[str, object]]:
    return rows_of(*case)


def scan(
    curvatures: Sequence[float], lengths: Sequence[float], v: float | None = None, processes: int | None = None
) -> Iterator[list[dict[str, object]]]:
    """The rows of each ``c0``, in order, over processes (``studies.parallel``)."""
    return in_processes(_rows, [(c0, lengths, v) for c0 in curvatures], processes, _FEWEST_FOR_PROCESSES, 1)


def pearl_periods(
    c0: float | str | Iterable[float],
    lengths: float | str | Iterable[float],
    *,
    v: float | None = None,
    processes: int | None = None,
    progress: bool | None = None,
) -> pd.DataFrame:
    """Number of pearls, their period, the stable interval and the localized pearl's branch point, for every length.

    Args:
        c0: spontaneous curvature: a number, several, or a text like ``0.3,0.48``.
        lengths: tube lengths in radii, likewise (``7.5:120:0.5``).
        v: a reduced volume, to find the number of equal pearls of least energy at it, too; not 1.
        processes: how many to use over the values of ``c0`` (``None``: as many as help).
        progress: show a bar on standard error (``None``: if that is a terminal).

    Returns:
        A row a ``(c0, L)``: ``c0, L, pearls, period, k, status, lambda2_pearl, lambda2_upper, upper_mode, v_localized,
        localized_status, message``; with ``v`` also ``v, pearls_least_energy, E_least_energy``. The straight tube is
        stable for ``lambda2_pearl < lambda2 < lambda2_upper``. An interrupted scan returns the rows that are done.

    Raises:
        InputError: an argument that cannot be used.
    """
    lengths = as_numbers("lengths", lengths)
    if v is not None and positive("v", v) == 1:
        raise InputError("v", "at v = 1 all pearls are the cylinder", "give a volume above or below")
    lengths = [Tube(0.0, length).length for length in lengths]
    curvatures = as_numbers("c0", c0)
    processes = None if processes is None else whole("processes", processes)
    rows: list[dict[str, object]] = []
    stopped = Interruption()
    total = len(curvatures) * len(lengths)
    with progress_bar("tube", total, shown=progress) as bar:
        with stopped:
            for found in scan(curvatures, lengths, v, processes):
                rows += found
                bar.update(len(found))
        if stopped.happened:
            say(f"interrupted: {len(rows)} of {total} rows are done and kept", begin="")
    extra = [] if v is None else ["v", "pearls_least_energy", "E_least_energy"]
    table = pd.DataFrame(rows, columns=COLUMNS + extra)
    return table.astype({name: "Int64" for name in ("pearls", "pearls_least_energy") if name in table})
