"""``pearlbvp growth``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pearlbvp.commands.arguments import Number, Numbers
from pearlbvp.commands.command import Command, Option
from pearlbvp.commands.output import check_outputs, outputs, radius_option, write
from pearlbvp.messages import say

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pearlbvp.units import Units


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp growth --radius 0.7um --kappa 20kT --tension 1e-3mN/m --viscosity 1mPa.s --plot g.png  |  "
    "pearlbvp growth --c0 0 --tension 1.5",
)
@click.option("--c0", type=Number("c0"), default=0.0, show_default=True, help="Spontaneous curvature.")
@click.option("--tension", type=Number("tension"), required=True,
              help="Of the straight tube, like 1e-3mN/m; a number is lambda1, by Sigma R^2/(2 kappa).")  # fmt: skip
@click.option("--viscosity", type=Number("viscosity"), metavar="ETA",
              help="Of the fluid outside, like 1mPa.s: rates are then in 1/s.  [default: rates count in 1/ETA]")  # fmt: skip
@click.option("--viscosity-ratio", type=Number(), default=1.0, show_default=True, metavar="RATIO",
              help="Viscosity of the fluid inside, by that of the fluid outside.")  # fmt: skip
@click.option("--membrane-viscosity", type=Number("membrane_viscosity"), default=0.0, show_default=True, metavar="ETA",
              help="Of the membrane, like 5e-9Pa.s.m; without --viscosity by that of the fluid outside, a length.")  # fmt: skip
@click.option(
    "--length", type=Number("length"), metavar="L", help="Axial period of the tube.  [default: any wave fits]"
)
@click.option("--wave-numbers", cls=Option, type=Numbers("wave_numbers"), excludes=["length"], metavar="NUMBERS",
              help="Wave numbers along the tube.  [default: 30, beyond all that grow]")  # fmt: skip
@click.option(
    "--max-m", cls=Option, type=int, needs=["length"], help="Most waves along it.  [default: beyond all that grow]"
)
@click.option("--max-n", type=int, default=2, show_default=True, help="Most waves around the tube.")
@outputs
@radius_option
def growth(
    c0: float, tension: float, viscosity: str | None, viscosity_ratio: float, membrane_viscosity: float | str,
    length: float | None, wave_numbers: list[float] | None, max_m: int | None, max_n: int,
    out: Path | None, plot: Path | None, units: Units,
) -> int:  # fmt: skip
    """How fast waves of the straight tube grow in water, which is the fastest, and when pearls do.

    Columns: m (with a length), n (waves along and around), k, type, wavelength, rate (in fluids inside and
    outside, the membrane incompressible; without --viscosity in units of 2 kappa/(ETA R^3)), mu and mu_diffusion
    (of the flow at fixed area and volume, and of diffusion, each by its mobility), role (fastest), c0, L, lambda1,
    lambda2, lambda1_lower and lambda1_pearl (no wave grows at tensions between them, pearls do above), force (along the axis).
    """
    from pearlbvp.studies import growth as study
    from pearlbvp.viscosity import in_fluids, membrane_viscosity_of

    out, plot = check_outputs(out, plot)
    units = in_fluids(units, viscosity)
    fluids = {
        "viscosity_ratio": viscosity_ratio,
        "membrane_viscosity": membrane_viscosity_of(units, membrane_viscosity),
    }
    table = study.growth(
        units.from_user("c0", c0),
        units.from_user("tension", tension),
        None if length is None else units.from_user("length", length),
        wave_numbers=None if wave_numbers is None else [units.from_user("wave_numbers", k) for k in wave_numbers],
        max_m=max_m,
        max_n=max_n,
        **fluids,
    )
    written = units.columns(table)
    say(units.said(study.summary(table)))

    def draw() -> Figure:
        from pearlbvp.figures.growth import draw_growth

        return draw_growth(written, units.columns(study.curves(table, **fluids)), units.said(study.title(table)), units)

    return write(written, out, plot, draw)
