"""Which pearl period appears on a tube, over which range is the tube stable, and when does a localized pearl take over?"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np
import pandas as pd

from pearlbvp.continuation import PathOptions, Solution, follow
from pearlbvp.continuation.chebyshev import Unresolved
from pearlbvp.continuation.path import PathEnd
from pearlbvp.continuation.segment import Segment
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, positive, whole
from pearlbvp.messages import say
from pearlbvp.numbers import as_numbers
from pearlbvp.progress import progress as progress_bar
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.shapes.pearling import pearling_onset
from pearlbvp.studies.localized import THINNEST_NECK, PeriodicPearls
from pearlbvp.studies.parallel import in_processes
from pearlbvp.theory.dispersion import stable_interval

COLUMNS = ["c0", "L", "pearls", "period", "k", "status", "lambda2_pearl", "lambda2_upper", "upper_mode",
           "v_localized", "localized_status", "message"]  # fmt: skip

_FEWEST_FOR_PROCESSES = 16
"""Below this many cases, starting processes costs more than it saves."""


def pearl_period(c0: float, length: float) -> dict[str, object]:
    """One row of the scan: the pearls that the straight tube of a length loses stability to."""
    tube = Tube(c0, length)
    interval = stable_interval(tube)
    row: dict[str, object] = {"c0": tube.c0, "L": tube.length, "message": ""}
    if not interval.exists:
        message = "the straight tube of this length is stable for no lambda2"
        return row | {"status": "no_stable_cylinder", "localized_status": "no_stable_cylinder", "message": message}
    row |= {"lambda2_upper": interval.upper, "upper_mode": "{}:{}".format(*interval.upper_mode)}
    if interval.lower_mode is None:
        message = "no pearls with k < 1 fit a tube of this length: nothing ends its stable interval from below"
        return row | {"status": "none_in_range", "localized_status": "none_in_range", "message": message}
    pearls = interval.lower_mode[0]
    row |= {"pearls": pearls, "period": tube.length / pearls, "k": tube.wave_number(pearls), "status": "found",
            "lambda2_pearl": interval.lower}  # fmt: skip
    if pearls == 1:
        return row | {"localized_status": "single_pearl"}
    try:
        found = PeriodicPearls.trace(tube.c0, tube.length / pearls, pearls).row(pearls)
    except (Unresolved, np.linalg.LinAlgError) as error:
        found = {"status": "failed", "message": str(error)}
    return row | {"v_localized": found.get("v"), "localized_status": found["status"], "message": found["message"]}


def least_energy(c0: float, length: float, v: float) -> dict[str, object]:
    """The number of equal pearls of least energy at a reduced volume, among all numbers with ``k < 1``.

    Each number's branch is followed from the cylinder to ``v``; those that do not reach it are left out. Localized and
    unequal pearls are not among them.

    Returns:
        ``v, pearls_least_energy, E_least_energy``; the last two empty where no branch reaches that volume.
    """
    tube = Tube(c0, length)
    energies: dict[int, float] = {}
    for m in range(1, math.ceil(length / (2 * math.pi))):
        if tube.wave_number(m) < 1:
            energy = _energy_at(tube, m, v)
            if energy is not None:
                energies[m] = energy
    best = min(energies, key=lambda m: energies[m], default=None)
    return {"v": v, "pearls_least_energy": best, "E_least_energy": None if best is None else energies[best]}


def _energy_at(tube: Tube, m: int, v: float) -> float | None:
    """``E/A`` of ``m`` equal pearls at reduced volume ``v``, where their branch first reaches it."""
    problem, u, tangent = pearling_onset(tube, m)

    def stop(point: Solution[PearlProblem]) -> str | None:
        observed = point.observables
        return "there" if (observed["v"] - v) * (1 - v) <= 0 else "neck" if observed["r_min"] < THINNEST_NECK else None

    path = follow(Solution(problem, u, tangent), PathOptions(max_step=1.0), stop)
    if path.reason != "there" or len(path.points) < 2:
        return None
    before, after = path.points[-2:]
    difference = before.observables["v"] - v
    try:
        return Segment(before, after).root(lambda point: point.observables["v"] - v, difference).observables["E"]
    except PathEnd:
        return None


def _row(case: tuple[float, float, float | None]) -> dict[str, object]:
    c0, length, v = case
    row = pearl_period(c0, length)
    return row if v is None else row | least_energy(c0, length, v)


def scan(cases: list[tuple[float, float, float | None]], processes: int | None = None) -> Iterator[dict[str, object]]:
    """Rows for cases ``(c0, length, v)``, in order, over processes (``studies.parallel``)."""
    return in_processes(_row, cases, processes, _FEWEST_FOR_PROCESSES)


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
        processes: how many to use (``None``: as many as help).
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
        raise InputError("v: at v = 1 all pearls are the cylinder; give a volume above or below")
    cases = [(value, Tube(value, length).length, v) for value in as_numbers("c0", c0) for length in lengths]
    processes = None if processes is None else whole("processes", processes)
    rows: list[dict[str, object]] = []
    with progress_bar("tube", len(cases), shown=progress) as bar:
        try:
            for row in scan(cases, processes):
                rows.append(row)
                bar.update()
        except KeyboardInterrupt:
            say(f"interrupted: {len(rows)} of {len(cases)} rows are done and kept", begin="")
    extra = [] if v is None else ["v", "pearls_least_energy", "E_least_energy"]
    table = pd.DataFrame(rows, columns=COLUMNS + extra)
    return table.astype({name: "Int64" for name in ("pearls", "pearls_least_energy") if name in table})
