"""``pearlbvp equilibria``."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pearlbvp.commands.arguments import File
from pearlbvp.commands.command import Command
from pearlbvp.commands.output import INTERRUPTED, check_distinct, check_outputs, outputs, processes_option, write
from pearlbvp.scale import CONVENTIONS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pearlbvp.scale import Convention


@click.command(
    cls=Command,
    epilog="Example:  pearlbvp equilibria data/axon_pearls.csv --convention mem3dg --out e.csv --plot e.png",
)
@click.argument("cases", type=File(), metavar="CASES.csv")
@click.option("--convention", type=click.Choice(list(CONVENTIONS)), default="physicists", show_default=True,
              help="Of kappa: kappa/2 (2H - C0)^2, or kappa (H - c0)^2, where it is twice as large.")  # fmt: skip
@processes_option
@outputs
def equilibria(cases: Path, convention: Convention, processes: int | None, out: Path | None, plot: Path | None) -> int:
    """Pearls of tubes in physical units, at a given tension and with solute in them.

    CASES.csv has a row a tube, its columns named by quantity and any unit of it: tension[mN/m], kappa[kT], osmolarity[mM]
    outside, solute[mM] inside at the volume of the straight tube, length[nm], radius[nm] (of the straight tube without a
    pressure) or C0[1/nm] (of (2H - C0)^2; c0 is that of (H - c0)^2); if wanted, spacing[nm] of the pearls, measured[nm]
    (diameter of their beads), temperature[K] (310), dilution (1; divides all osmotic pressures).

    Columns: those of the file, then status (found, straight, none, failed), equilibria (how many shapes), pearls (that fill
    the tube), bead[nm] and neck[nm] (diameters), volume (by the straight tube's), pressure[Pa], force[pN], energy[pN] (by
    length, above the straight tube's), n_unstable (waves that grow), critical (the fastest), excess (measured/bead - 1),
    straight[nm] and straight_unstable (the straight tube's diameter and growing waves), stable_spacings[nm] (that fit the
    tube), best_spacing[nm] and best_bead[nm] (of lowest energy), message.
    """
    from pearlbvp.studies.cases import read_cases
    from pearlbvp.studies.equilibria import equilibria

    out, plot = check_outputs(out, plot)
    check_distinct({"CASES": Path(os.path.realpath(cases)), "--out": out, "--plot": plot})
    read = read_cases(cases)
    table = equilibria(read, convention=convention, processes=processes)

    def draw() -> Figure:
        from pearlbvp.figures.equilibria import draw_equilibria

        return draw_equilibria(table)

    status = write(table, out, plot, draw)
    return INTERRUPTED if len(table) < len(read) else status
