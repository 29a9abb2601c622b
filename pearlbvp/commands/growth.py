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


@click.command(cls=Command, epilog="Example:  pearlbvp growth --tension 1.5 --plot g.png")
@click.option("--c0", type=Number(), default=0.0, show_default=True, help="Spontaneous curvature.")
@click.option(
    "--tension", type=Number(), required=True, help="Tension lambda1 of the straight tube, Sigma R^2/(2 kappa)."
)
@click.option("--length", type=Number(), metavar="L", help="Axial period of the tube.  [default: any wave fits]")
@click.option(
    "--wave-numbers",
    cls=Option,
    type=Numbers(),
    excludes=["length"],
    help="Wave numbers along the tube.  [default: 30, beyond all that grow]",
)
@click.option(
    "--max-m",
    cls=Option,
    type=int,
    needs=["length"],
    help="Most waves along the tube.  [default: beyond all that grow]",
)
@click.option("--max-n", type=int, default=2, show_default=True, help="Most waves around the tube.")
@click.option(
    "--viscosity-ratio",
    type=Number(),
    default=1.0,
    show_default=True,
    help="Viscosity of the fluid inside, by that of the fluid outside.",
)
@click.option(
    "--membrane-viscosity",
    type=Number(),
    default=0.0,
    show_default=True,
    help="Surface viscosity of the membrane by the viscosity of the fluid outside, a length.",
)
@outputs
@radius_option
def growth(
    c0: float, tension: float, length: float | None, wave_numbers: list[float] | None, max_m: int | None, max_n: int,
    viscosity_ratio: float, membrane_viscosity: float, out: Path | None, plot: Path | None, units: Units,
) -> int:  # fmt: skip
    """How fast waves of the straight tube grow in water, which is the fastest, and when pearls do.

    Columns: m (with a length), n (waves along and around), k, type, wavelength, rate (in fluids inside and
    outside, the membrane incompressible; in units of 2 kappa/(eta R^3)), mu and mu_diffusion (of the flow at fixed
    area and volume, and of diffusion, each with mobility 1), role (fastest), c0, L, lambda1, lambda2, lambda1_lower
    and lambda1_pearl (no wave grows at tensions between them, pearls do above).
    """
    from pearlbvp.studies import growth as study
    from pearlbvp.units import FLUIDS

    out, plot = check_outputs(out, plot)
    units = units.of_flow(FLUIDS)
    surface_viscosity = units.from_user("membrane_viscosity", membrane_viscosity)
    fluids = {"viscosity_ratio": viscosity_ratio, "membrane_viscosity": surface_viscosity}
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

        curves = study.curves(table, **fluids)
        title = f"c0 = {c0:g}, tension {tension:g}" + ("" if length is None else f", L = {length:g}")
        return draw_growth(written, units.columns(curves), title, units)

    return write(written, out, plot, draw)
