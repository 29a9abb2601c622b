"""In which part of the plane of period and volume are pearls stable? (What pattern formation calls the Busse balloon.)

On a tube of so many periods, or of any length, equal pearls are stable on intervals of volumes: some begin at the straight
tube, others at finite amplitude, next to unduloids, or on branches that nothing joins to the straight tube.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.path import PathEnd
from pearlbvp.errors import InputError, Interruption, SpectrumError
from pearlbvp.helfrich import Tube, whole
from pearlbvp.messages import say
from pearlbvp.numbers import as_numbers
from pearlbvp.progress import progress as progress_bar
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.studies.equal_pearls import STARTS, Stretch, comes_to_unduloid, equal_pearls, stable_alone
from pearlbvp.studies.localized import COLUMNS as LOCALIZED
from pearlbvp.studies.parallel import in_processes
from pearlbvp.studies.pearl_starts import bellies
from pearlbvp.studies.waves_on_periods import stable_by_number
from pearlbvp.units import Sentence

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = [*LOCALIZED, "v_from", "v_to", "from_limit", "n_from", "theta_from", "to_limit", "n_to", "theta_to"]

SHORTEST = 1e-10
"""Length of an interval of volumes that is none."""

SAME = 1e-6
"""Difference of volumes and energies up to which intervals are one."""

CUT = "not followed"
"""What intervals end at where a branch could not be followed."""

FAILED = "pearls could not be followed"

NONE = "no stable pearls of this period were found"


def known_pearls(pearls: str | float | Iterable[float]) -> list[float]:
    """Numbers of pearls, in order, ``inf`` for a tube of any length.

    Raises:
        InputError: one that is no whole number from 1 on.
    """
    words = pearls.split(",") if isinstance(pearls, str) else pearls if isinstance(pearls, Iterable) else [pearls]
    counts: list[float] = []
    for word in words:
        counts += [math.inf] if str(word).strip() == "inf" else as_numbers("pearls", word)
    if not counts or any(count < 1 or count % 1 for count in counts if count != math.inf):
        raise InputError("pearls", "the numbers must be whole and 1 or more, or inf for a tube of any length")
    return sorted(set(counts))


def stability_region(
    c0: float | str | Iterable[float],
    periods: float | str | Iterable[float],
    pearls: str | float | Iterable[float] = (1, 2, 4, 8, math.inf),
    *,
    starts: int = STARTS,
    processes: int | None = 1,
    progress: bool | None = None,
) -> pd.DataFrame:
    """All intervals of volumes on which equal pearls are stable, by period, for several numbers of pearls.

    Args:
        c0: spontaneous curvature: a number, several, or a text like ``0.5:2:0.1``.
        periods: axial periods of one pearl, likewise (``4:10:0.25``).
        pearls: numbers of pearls on the tube, 1 or more; ``inf`` for a tube of any length.
        starts: random shapes of each period that are relaxed, to find pearls that no branch from the straight tube leads to.
        processes: how many to use over the periods (``None``: as many as help).
        progress: show a bar on standard error (``None``: if that is a terminal).

    Returns:
        A row an interval, or one without volumes where there is none: ``c0, period, L, pearls, status, lambda1, lambda2, v,
        E, amplitude, message, v_from, v_to, from_limit, n_from, theta_from, to_limit, n_to, theta_to``. The pearls are stable
        for ``v_from < v < v_to``; each end is at a ``wave`` (``n`` around, phase ``theta`` a period) that begins to grow, a
        ``fold`` of the volume, the ``unduloid`` of infinite multipliers, the ``straight tube``, or a ``thin neck`` (of radius
        0.03, where the search ends). ``v`` and the numbers beside it are at the end that is not the straight tube; where
        neither is, at ``v_to``. ``status`` is ``found``, ``unstable_at_onset`` where there is no interval, or ``failed``.

    Raises:
        InputError: an argument that cannot be used.

    Examples:
        >>> table = stability_region(0.48, 7.5, [2], starts=0)
        >>> round(table.v_to[0], 5), table.to_limit[0], table.n_to[0]
        (1.00811, 'wave', 0)
    """
    import pandas as pd

    counts, starts = known_pearls(pearls), whole("starts", starts, 0)
    lengths = as_numbers("periods", periods)
    cases = [(Tube(value, length), counts, starts) for value in as_numbers("c0", c0) for length in lengths]
    rows: list[dict[str, object]] = []
    stopped = Interruption()
    with progress_bar("period", len(cases), shown=progress) as bar:
        with stopped:
            for found in in_processes(_rows, cases, processes, FEWEST, 1):
                rows += found
                bar.update()
        if stopped.happened:
            say(f"interrupted: {len(rows)} rows are done and kept", begin="")
    return pd.DataFrame(rows, columns=COLUMNS).astype({"n_from": "Int64", "n_to": "Int64"})


FEWEST = 8
"""Periods from which on several processes are of use."""


def _rows(case: tuple[Tube, list[float], int]) -> list[dict[str, object]]:
    """The rows of one period."""
    tube, counts, starts = case
    try:
        intervals, said = _intervals(tube, counts, starts)
    except InputError as error:
        return [_row(tube, count, {"status": "failed", "message": str(error)}) for count in counts]
    except (PathEnd, SpectrumError, np.linalg.LinAlgError) as error:
        return [_row(tube, count, {"status": "failed", "message": f"{FAILED} ({error})"}) for count in counts]
    rows = []
    for count, found in intervals.items():
        if not found:
            nothing = {"status": "unstable_at_onset", "message": Sentence.joined(NONE, "; ", said) if said else NONE}
            rows.append(_row(tube, count, nothing))
        rows += [_row(tube, count, {"status": "found", **values, "message": said}) for values in found]
    return rows


def _intervals(tube: Tube, counts: list[float], starts: int) -> tuple[dict[float, list[dict[str, Any]]], str]:
    """The intervals by number of pearls, and what else is to be said.

    Raises:
        InputError, PathEnd, SpectrumError, numpy.linalg.LinAlgError: they cannot be computed.
    """
    branches = equal_pearls(tube.c0, tube.length, starts=starts)
    stretches = stable_by_number([s for branch in branches for s in stable_alone(branch) if _is_equal(s)], counts)
    said = next(filter(None, map(_cut, branches)), "")
    return {count: _distinct(map(_interval, stretches[count])) for count in counts}, said


def _distinct(intervals: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Intervals in order, each once; of a branch that was followed to its end elsewhere no part of it."""
    found: list[dict[str, Any]] = []
    for one in sorted(filter(None, intervals), key=lambda values: (values["v_from"], values["v_to"])):
        if not found or any(abs(one[name] - found[-1][name]) > SAME for name in ("v_from", "v_to", "E")):
            found.append(one)

    def is_part(one: dict[str, Any], other: dict[str, Any]) -> bool:
        within = other["v_from"] - SAME <= one["v_from"] and one["v_to"] <= other["v_to"] + SAME
        return other is not one and within and CUT in (one["from_limit"], one["to_limit"])

    return [one for one in found if not any(is_part(one, other) for other in found)]


def _row(tube: Tube, pearls: float, values: Mapping[str, object]) -> dict[str, object]:
    row = {"c0": tube.c0, "period": tube.length, "L": pearls * tube.length, "pearls": pearls, **values}
    return {name: row.get(name) for name in COLUMNS}


def _cut(branch: Branch[PearlProblem]) -> str:
    """What of a branch is not known because it could not be followed; empty where it ends for good."""
    last = branch.points[-1]
    if not branch.failed or comes_to_unduloid(branch):
        return ""
    return Sentence.joined(f"a branch was followed to v = {last.value('v'):.6g} only: ", branch.reason)


def _is_equal(stretch: Stretch) -> bool:
    """Whether some of its shapes have one belly a period: smaller ones may appear on its necks."""
    return any(bellies(point) <= 1 for point in stretch.points)


def _interval(stretch: Stretch) -> dict[str, Any]:
    """The columns of a stretch; nothing where it is none."""
    low, high = sorted(stretch.ends, key=lambda end: end.observed["v"])
    if high.observed["v"] - low.observed["v"] < SHORTEST:
        return {}
    at = low if high.kind == "straight tube" else high
    shown = {name: at.observed[name] for name in ("lambda1", "lambda2", "v", "E", "amplitude")}
    return shown | low.columns("from") | high.columns("to")
