"""``pearlbvp dispersion``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pearlbvp.commands.arguments import Number
from pearlbvp.commands.command import Command
from pearlbvp.commands.output import check_outputs, outputs, radius_option, write

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pearlbvp.units import Units


@click.command(cls=Command, epilog="Example:  pearlbvp dispersion --c0 0.48 --length 30")
@click.option("--c0", type=Number("c0"), required=True, help="Spontaneous curvature.")
@click.option("--length", type=Number("length"), required=True, metavar="L", help="Axial period of the tube.")
@click.option("--max-m", type=int, help="Most waves along the tube.  [default: all pearls with k < 1 and two more]")
@click.option("--max-n", type=int, default=4, show_default=True, help="Most waves around the tube.")
@outputs
@radius_option
def dispersion(
    c0: float, length: float, max_m: int | None, max_n: int, out: Path | None, plot: Path | None, units: Units
) -> int:
    """Branch points of the straight tube, and which of them end its stable interval.

    Columns: m, n (waves along and around), k, type, lambda2, lambda1, kernel (its dimension without
    translations), role (lower or upper: the ends of the interval in which the tube is stable), force
    (along the axis; of coils and buckles Euler's, -pi k^2/2).
    """
    from pearlbvp.studies.dispersion import branch_points, instability_curves

    out, plot = check_outputs(out, plot)
    tube = units.tube(c0, length)
    table = branch_points(tube.c0, tube.length, max_m, max_n)
    written = units.columns(table)

    def draw() -> Figure:
        from pearlbvp.figures.dispersion import draw_dispersion

        curves = instability_curves(tube.c0, max(1.6, float(table["k"].max())), int(table["n"].max()))
        return draw_dispersion(written, units.columns(curves), units.tube_text(tube), units)

    return write(written, out, plot, draw)
