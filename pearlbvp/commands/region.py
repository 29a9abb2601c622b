"""``pearlbvp region``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pearlbvp.commands.arguments import Numbers
from pearlbvp.commands.command import Command
from pearlbvp.commands.output import INTERRUPTED, check_outputs, outputs, processes_option, radius_option, write

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pearlbvp.units import Units


@click.command(
    cls=Command,
    epilog="Example:  pearlbvp region --c0 0.48,0.55 --periods 4.5:8:0.5 --pearls 1,2,4,inf --out r.csv --plot r.png",
)
@click.option("--c0", type=Numbers("c0"), required=True, help="Spontaneous curvatures.")
@click.option("--periods", type=Numbers("period"), required=True, help="Axial periods of one pearl.")
@click.option(
    "--pearls", default="1,2,4,8,inf", show_default=True,
    help="Numbers of pearls on the tube; inf for a tube of any length.",
)  # fmt: skip
@click.option(
    "--starts", type=click.IntRange(min=0), default=6, show_default=True,
    help="Relax so many random shapes of each period, to find pearls that no branch from the straight tube leads to.",
)  # fmt: skip
@processes_option
@outputs
@radius_option
def region(
    c0: list[float],
    periods: list[float],
    pearls: str,
    starts: int,
    processes: int | None,
    out: Path | None,
    plot: Path | None,
    units: Units,
) -> int:
    """Where equal pearls are stable, in the plane of period and volume.

    Columns: those of `localized`, v_from, v_to, from_limit, n_from, theta_from, to_limit, n_to, theta_to. A row an
    interval of volumes, v_from to v_to, on which so many pearls are stable; each end is at a wave that begins to grow,
    a fold, the unduloid (infinite multipliers), the straight tube, or a thin neck. v, lambda1, ... are at the end that
    is not the straight tube.
    """
    from pearlbvp.studies.region import stability_region

    out, plot = check_outputs(out, plot)
    curvatures = [units.tube(value, periods[0]).c0 for value in c0]
    lengths = [units.tube(c0[0], period).length for period in periods]
    found = stability_region(curvatures, lengths, pearls, starts=starts, processes=processes)
    done, table = set(zip(found["c0"], found["period"], strict=True)), units.columns(found)

    def draw() -> Figure:
        from pearlbvp.figures.region import draw_region

        return draw_region(table, units)

    status = write(table, out, plot, draw)
    return status if len(done) == len(set(curvatures)) * len(set(lengths)) else INTERRUPTED
