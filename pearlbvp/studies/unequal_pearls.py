"""Stable unequal pearls: axisymmetric tubes with several bellies that differ, like one large pearl and three smaller ones.

They come from random shapes of least energy, as branches from the straight tube do not lead to all of them; each is followed
to smaller and to larger volume, and the stretches on which it is stable on its tube are the rows of a table.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pearlbvp.continuation.following import BranchOptions
from pearlbvp.continuation.solution import Solution
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, whole
from pearlbvp.numbers import as_numbers
from pearlbvp.progress import progress as progress_bar
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.studies.branch import branch_options
from pearlbvp.studies.equal_pearls import Stretch, stable_alone
from pearlbvp.studies.parallel import in_processes
from pearlbvp.studies.phases import WithinVolumes
from pearlbvp.studies.region import known_pearls
from pearlbvp.studies.shape import both_ways
from pearlbvp.studies.starts import Start, at_rest, branch_of
from pearlbvp.studies.stretches import Piece, pieces
from pearlbvp.studies.waves_on_periods import stable_by_number

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ["c0", "L", "periods", "v_from", "v_to", "from_limit", "n_from", "theta_from", "to_limit", "n_to", "theta_to",
           "v", "E", "lambda1", "lambda2", "r_min", "bellies", "radii"]  # fmt: skip

RIPPLE = 0.01
"""Height of a belly above its necks that is none."""

SHORTEST = 1e-6
"""Length of an interval of volumes that is none."""


def unequal_pearls(
    c0: float | str | Iterable[float],
    lengths: float | str | Iterable[float],
    *,
    periods: str | float | Iterable[float] = (1, 2, 4, 8, math.inf),
    volumes: tuple[float, float] = (0.92, 1.3),
    starts: int = 12,
    seed: int = 0,
    processes: int | None = 1,
    progress: bool | None = None,
) -> pd.DataFrame:
    """Intervals of volumes on which unequal pearls are stable on a tube, as far as random shapes come to them.

    Args:
        c0: spontaneous curvature: a number, several, or a text like ``0.5:2:0.5``.
        lengths: of the tubes, likewise.
        periods: numbers of such lengths that are looked at.
        volumes: range in which they are looked for and followed.
        starts: random shapes of each tube that are relaxed.
        seed: of these.
        processes: how many to use over the tubes (``None``: as many as help).
        progress: show a bar on standard error (``None``: if that is a terminal).

    Returns:
        A row an interval: ``c0``, ``L``, ``periods`` of that length on which it is stable (``inf`` for any number), then
        ``v_from, v_to, from_limit, n_from, theta_from, to_limit, n_to, theta_to`` as ``stability_region`` has them
        (``volume``: the end of the range), and of the shape in the middle ``v, E, lambda1, lambda2, r_min, bellies, radii``,
        number and radii of the bellies along the tube, from one plane of reflection on.

    Raises:
        InputError: an argument that cannot be used.
    """
    import pandas as pd

    low, high = map(float, volumes)
    if not 0 < low < high:
        raise InputError("volumes", f"{low:g} to {high:g} is no range", "give two that increase, above 0")
    counts, starts, seed = known_pearls(periods), whole("starts", starts), whole("seed", seed, 0)
    cases = [
        (Tube(value, length), counts, low, high, starts, seed)
        for value in as_numbers("c0", c0)
        for length in as_numbers("lengths", lengths)
    ]
    rows: list[dict[str, Any]] = []
    with progress_bar("tube", len(cases), shown=progress) as bar:
        for found in in_processes(_rows, cases, processes, FEWEST, 1):
            rows += found
            bar.update()
    return pd.DataFrame(rows, columns=COLUMNS).astype({"n_from": "Int64", "n_to": "Int64"})


FEWEST = 4
"""Tubes from which on several processes are of use."""


def _rows(case: tuple[Tube, list[float], float, float, int, int]) -> list[dict[str, Any]]:
    """The rows of a tube."""
    tube, counts, low, high, starts, seed = case
    known: list[Piece] = []
    rows = []
    for i in range(starts):
        v = low + (high - low) * (i + 0.5) / starts
        shape = at_rest(Start(tube, v, (seed, i), True))
        if isinstance(shape, str) or shape.spectrum.n_unstable or shape.problem.cells > 1 or branch_of(shape, known):
            continue
        branch = both_ways(shape.problem, shape.u, _towards(low, low, high), _towards(high, low, high))
        known += pieces("known", branch)
        for count, stretches in stable_by_number(list(stable_alone(branch)), counts).items():
            rows += [row for stretch in stretches if (row := _row(tube, count, stretch))]
    return sorted(rows, key=lambda row: (row["periods"], row["v_from"], row["v_to"]))


def _towards(v: float, low: float, high: float) -> BranchOptions:
    """Options of a branch to one end of a range of volumes."""
    return replace(branch_options({"v": v}, max_points=300, max_step=2.0), limit=WithinVolumes(low, high))


def _row(tube: Tube, periods: float, stretch: Stretch) -> dict[str, Any]:
    """The columns of a stretch of unequal pearls; nothing where they are equal, or it is none."""
    low, high = sorted(stretch.ends, key=lambda end: end.observed["v"])
    middle = (low.observed["v"] + high.observed["v"]) / 2
    point = min(stretch.points, key=lambda point: abs(point.value("v") - middle))
    radii = belly_radii(point)
    if len(radii) < 2 or max(radii) - min(radii) < RIPPLE or high.observed["v"] - low.observed["v"] < SHORTEST:
        return {}
    low, high = (end._replace(kind="volume") if end.kind == "not followed" else end for end in (low, high))
    shown = {name: point.value(name) for name in ("v", "E", "lambda1", "lambda2", "r_min")}
    words = " ".join(f"{radius:.4f}" for radius in radii)
    ends = low.columns("from") | high.columns("to")
    return {"c0": tube.c0, "L": tube.length, "periods": periods, **ends, **shown, "bellies": len(radii), "radii": words}


def belly_radii(point: Solution[PearlProblem]) -> list[float]:
    """Radii of the bellies of one period in order, those that rise above both of their necks."""
    from scipy.signal import find_peaks

    r = point.problem.profile(point.u).outline()[1][:-1]
    neck = int(np.argmin(r))
    tops, _ = find_peaks(np.append(np.roll(r, -neck), r[neck]), prominence=RIPPLE)
    return [float(r[i]) for i in sorted((tops + neck) % len(r))]
