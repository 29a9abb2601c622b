"""``pearlbvp region``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pearlbvp.commands.arguments import Number, Numbers
from pearlbvp.commands.command import Command
from pearlbvp.commands.output import check_outputs, outputs, radius_option, write

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pearlbvp.units import Units


@click.command(
    cls=Command,
    epilog="Example:  pearlbvp region --c0 0.48 --periods 6.6:10:0.1 --pearls 2,4,8 --out r.csv --plot r.png",
)
@click.option("--c0", type=Number("c0"), required=True, help="Spontaneous curvature.")
@click.option("--periods", type=Numbers("period"), required=True, help="Axial periods of one pearl, above 2 pi.")
@click.option(
    "--pearls", type=Numbers(), default="2,3,4,6,8,16", show_default=True, help="Numbers of pearls on the tube."
)
@outputs
@radius_option
def region(
    c0: float, periods: list[float], pearls: list[float], out: Path | None, plot: Path | None, units: Units
) -> int:
    """Where periodic pearls are stable, in the plane of period and volume.

    Columns: those of `localized`, a row for each period and number of pearls. Where status is found, the pearls
    are stable from v = 1 to the v of the row.
    """
    from pearlbvp.studies.region import stability_region

    out, plot = check_outputs(out, plot)
    tubes = [units.tube(c0, period) for period in periods]
    table = units.columns(stability_region(tubes[0].c0, [tube.length for tube in tubes], pearls))

    def draw() -> Figure:
        from pearlbvp.figures.region import draw_region

        return draw_region(table, units)

    return write(table, out, plot, draw)
