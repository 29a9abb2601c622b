"""Which of coils, buckles, wrinkles and mixed tubes are stable where modes meet, or exchange stability? Tables over tubes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from pearlbvp.continuation.branch import Branch
from pearlbvp.errors import SpectrumError
from pearlbvp.helfrich import Tube
from pearlbvp.numbers import as_numbers
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.onward import switched
from pearlbvp.theory.codimension_two import exchange_lengths
from pearlbvp.theory.meeting import meeting_curvature

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ["offset", "c0", "L", "m", "family", "v", "lambda2", "E", "n_unstable", "mu_crit", "least"]


def meeting_table(
    length: float, m: int, offsets: str | Iterable[float], volumes: str | Iterable[float]
) -> pd.DataFrame:
    """Coils, buckles and wrinkles of a tube next to the ``c0`` at which wrinkles (0, 2) and coiling waves (m, 1) meet.

    Args:
        length: the tube's.
        m: coiling waves along it.
        offsets: of ``c0`` from ``-1/4 + k^2/4``; at 0 itself the branches cannot be told apart at their start.
        volumes: reduced volumes below 1.

    Returns:
        A row a shape with the columns ``COLUMNS``: where a family has left the range on its way to a volume, it has none.
        ``n_unstable`` counts all perturbations that fit the tube at fixed area and volume; ``least`` says of a row whether it
        has the least energy of those of its tube and volume.

    Raises:
        InputError: an argument that cannot be used.
    """
    import pandas as pd

    at = meeting_curvature(Tube(0.0, length).wave_number(m) ** 2)
    rows = []
    for offset in as_numbers("offsets", offsets):
        tube = Tube(at + offset, length)
        for family, mode in (("coil", (m, 1)), ("buckle", (m, 1)), ("ring", (0, 2))):
            for v in as_numbers("volumes", volumes):
                try:
                    end = family_branch(tube, family, mode, branch_options({"v": v}, max_points=60)).points[-1]
                except SpectrumError:
                    continue
                if abs(end.observables["v"] - v) > 1e-9:
                    continue
                found = (end.observables[name] for name in ("v", "lambda2", "E"))
                rows.append(
                    (offset, tube.c0, length, m, family, *found, end.spectrum.n_unstable, end.spectrum.mu_crit, False)
                )
    table = pd.DataFrame(rows, columns=COLUMNS)
    table["least"] = table["E"] <= table.groupby(["offset", "v"])["E"].transform("min")
    return table


ENDS = ["v_coil", "lambda2_coil", "v_buckle", "lambda2_buckle"]
EXCHANGE_COLUMNS = ["c0", "exchange", "L", *ENDS, "n_mixed", "both_stable"]


def exchange_table(
    c0: str | Iterable[float], offsets: str | Iterable[float], lowest: float = 0.93, near: float = 5.0
) -> pd.DataFrame:
    """Coils and buckles (1, 1) next to the length at which they exchange stability, and the mixed tubes that join them.

    Args:
        c0: spontaneous curvatures.
        offsets: of the length from the shortest exchange beyond ``near``.
        lowest: volume at which branches end.
        near: length below which exchanges are left out.

    Returns:
        A row a tube with the columns ``EXCHANGE_COLUMNS``: ``v_coil`` and ``v_buckle`` are where the two families become stable
        and unstable, empty where neither does; the mixed tubes join these two points, and have ``n_mixed`` unstable directions.
        ``both_stable`` says whether between them coils and buckles are stable together; else neither is.

    Raises:
        InputError: an argument that cannot be used.
    """
    import pandas as pd

    rows = []
    for value in as_numbers("c0", c0):
        exchange = exchange_lengths(value, shortest=near)[0]
        for offset in as_numbers("offsets", offsets):
            tube = Tube(value, exchange + offset)
            ends = [_exchange(tube, family, lowest) for family in ("coil", "buckle")]
            if any(end is None for end in ends):
                rows.append((value, exchange, tube.L, *[math.nan] * 5, ""))
                continue
            (coils, number, coil), (_, _, buckle) = (end for end in ends if end is not None)
            halfway = {"v": (coil["v"] + buckle["v"]) / 2}
            mixed = switched(coils, number, branch_options(halfway, step=1e-2, max_step=1e-2)).points[-1]
            places = coil["v"], coil["lambda2"], buckle["v"], buckle["lambda2"]
            rows.append((value, exchange, tube.L, *places, mixed.spectrum.n_unstable, bool(coil["v"] > buckle["v"])))
    return pd.DataFrame(rows, columns=EXCHANGE_COLUMNS)


def _exchange(tube: Tube, family: str, lowest: float) -> tuple[Branch[Any], int, Mapping[str, float]] | None:
    """A family's branch, the first branch point at which its own waves exchange stability, and what is observed there."""
    branch = family_branch(tube, family, (1, 1), branch_options({"v": lowest}, max_step=0.3))
    for number, special in enumerate(branch.find("bp"), 1):
        if str(special.block) == {"coil": "j=2", "buckle": "x odd phi odd"}[family]:
            return branch, number, branch.at(special).observables
    return None
