"""``pearlbvp period``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pearlbvp.commands.arguments import Number, Numbers
from pearlbvp.commands.command import Command
from pearlbvp.commands.output import INTERRUPTED, check_outputs, outputs, processes_option, radius_option, write

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pearlbvp.units import Units


@click.command(cls=Command, epilog="Example:  pearlbvp period --c0 0.48 --lengths 7.5:120:0.5 --out p.csv --plot p.png")
@click.option("--c0", type=Numbers("c0"), required=True, help="Spontaneous curvature, one or several.")
@click.option("--lengths", type=Numbers("length"), required=True, help="Tube lengths.")
@click.option(
    "--volume", type=Number(), help="Find the number of equal pearls of least energy at this reduced volume, too."
)
@processes_option
@outputs
@radius_option
def period(
    c0: list[float],
    lengths: list[float],
    volume: float | None,
    processes: int | None,
    out: Path | None,
    plot: Path | None,
    units: Units,
) -> int:
    """The pearl period that appears on a tube, its stable range, and where a localized pearl takes over.

    Columns: c0, L, pearls, period, k, status, lambda2_pearl and lambda2_upper (ends of the straight tube's
    stable interval), upper_mode (m:n), v_localized, localized_status, message.
    """
    from pearlbvp.studies.period import pearl_periods

    out, plot = check_outputs(out, plot)
    tubes = [units.tube(c0[0], length) for length in lengths]
    curvatures = [units.tube(value, lengths[0]).c0 for value in c0]
    table = units.columns(pearl_periods(curvatures, [tube.length for tube in tubes], v=volume, processes=processes))

    def draw() -> Figure:
        from pearlbvp.figures.period import draw_periods

        return draw_periods(table, units)

    status = write(table, out, plot, draw)
    return INTERRUPTED if len(table) < len(c0) * len(lengths) else status
