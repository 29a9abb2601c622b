"""Which of coils, buckles and wrinkles are stable where their modes meet? A table over c0 and volume."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from pearlbvp.errors import SpectrumError
from pearlbvp.helfrich import Tube
from pearlbvp.numbers import as_numbers
from pearlbvp.studies.branch import branch_options, family_branch
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
