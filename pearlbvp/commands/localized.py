"""``pearlbvp localized``."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pearlbvp.commands.arguments import File, Number, Numbers
from pearlbvp.commands.command import Command
from pearlbvp.commands.output import check_distinct, check_outputs, outputs, radius_option, write

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pearlbvp.units import Units


@click.command(
    cls=Command,
    epilog="Example:  pearlbvp localized --c0 0.48 --period 7.5 --lengths 15,30,45,60 --out t.csv --plot t.png",
)
@click.option("--c0", type=Number("c0"), required=True, help="Spontaneous curvature.")
@click.option(
    "--period", type=Number("period"), required=True, metavar="P", help="Axial period of the pearls, above 2 pi."
)
@click.option("--lengths", type=Numbers("length"), required=True, help="Tube lengths, multiples of the period.")
@click.option("--compare", type=File(), metavar="FILE.csv",
              help="Put this table's columns beside the rows that agree in c0, period and L; v_... is drawn too.")  # fmt: skip
@outputs
@radius_option
def localized(
    c0: float,
    period: float,
    lengths: list[float],
    compare: Path | None,
    out: Path | None,
    plot: Path | None,
    units: Units,
) -> int:
    """Where periodic pearls give way to one localized pearl, for many lengths at once.

    Columns: c0, period, L, pearls, status, lambda1, lambda2, v, E, amplitude, message. Status is found,
    unstable_at_onset, none_in_range, no_stable_cylinder or failed.
    """
    from pearlbvp.helfrich import positive

    out, plot = check_outputs(out, plot)
    start = None if compare is None else Path(os.path.realpath(compare))
    check_distinct({"--compare": start, "--out": out, "--plot": plot})
    tube = units.tube(c0, positive("--period", period))
    reference = None
    if compare is not None:
        from pearlbvp.studies.reference import read_reference

        reference = read_reference(compare, units=units)
    scaled = [units.from_user("L", length) for length in lengths]
    import pandas as pd

    from pearlbvp.studies.localized import localized_rows

    rows = localized_rows(tube.c0, tube.length, scaled)

    table = units.columns(pd.DataFrame(rows))
    if reference is not None:
        from pearlbvp.studies.reference import beside

        table = beside(table, reference)

    def draw() -> Figure:
        from pearlbvp.figures.localized import draw_localized

        return draw_localized(table, units)

    return write(table, out, plot, draw)
