"""``pearlbvp amplitude`` and ``pearlbvp amplitude-map``."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pearlbvp.commands.arguments import File, ModeNumbers, Number, Numbers
from pearlbvp.commands.command import Command
from pearlbvp.commands.output import check_distinct, check_outputs, outputs, write, write_table
from pearlbvp.errors import InputError

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@click.command(cls=Command, epilog="Example:  pearlbvp amplitude --c0 0 --length 10 --mode 1,1 --plot a.png")
@click.option("--c0", type=Number("c0"), required=True, help="Spontaneous curvature.")
@click.option("--length", type=Number("length"), required=True, metavar="L", help="Axial period of the tube.")
@click.option("--mode", "modes", type=ModeNumbers(), required=True, multiple=True,
              help="Waves along and around the tube; may be given several times.")  # fmt: skip
@click.option("--family", type=click.Choice(["pearl", "ring", "coil", "buckle"]),
              help="Of the first mode's branches the one to predict.  [default: the one that is stable]")  # fmt: skip
@click.option("--largest", type=Number("wave"), metavar="A",
              help="Predict up to this amplitude.  [default: 0.2, or less near a resonance]")  # fmt: skip
@click.option("--branch", type=File(), metavar="FILE.csv",
              help="Write the predicted branch there.")  # fmt: skip
@click.option("--compare", type=File(), metavar="BRANCH.csv",
              help="A computed branch: draw it too, and write it beside the prediction in the table of --branch.")  # fmt: skip
@outputs
def amplitude(
    c0: float,
    length: float,
    modes: tuple[tuple[int, int], ...],
    family: str | None,
    largest: float | None,
    branch: Path | None,
    compare: Path | None,
    out: Path | None,
    plot: Path | None,
) -> int:
    """Amplitude equations of the branches that leave the straight tube, in closed form.

    Columns: c0, L, m, n, type, lambda2, lambda1, a, b (or b1, b2), alpha2, stable (the family that is stable at
    its onset at fixed area and volume), role, criticality. Amplitudes are in radii: u = 2 A cos(kx + n phi). All is in
    units of the tube's radius.

    The predicted branch has the columns of `branch`, growth rates to leading order. With --compare its columns are A, v
    and, of lambda1, lambda2, E and wave (2 A), the computed and the predicted value at that v, the error relative to the
    change since the onset, and the order in A at which it falls.
    """
    from pearlbvp.files import writable
    from pearlbvp.helfrich import Tube
    from pearlbvp.studies.amplitude import COMPARED, WAVE, coefficients, compared, predicted_branch
    from pearlbvp.studies.reference import read_reference
    from pearlbvp.theory.amplitude import amplitude_equation, family_named

    out, plot = check_outputs(out, plot)
    branch = None if branch is None else writable("--branch", branch)
    start = None if compare is None else Path(os.path.realpath(compare))
    check_distinct({"--compare": start, "--out": out, "--plot": plot, "--branch": branch})
    idle = [name for name, value in (("--family", family), ("--largest", largest), ("--compare", compare)) if value]
    if idle and branch is None and plot is None:
        raise InputError(f"{idle[0]}: it shapes the predicted branch only; give --branch or --plot, too")
    tube = Tube(c0, length)
    table = coefficients(tube.c0, tube.length, modes)
    equation = amplitude_equation(tube, modes[0])
    chosen = family_named(family) if family else equation.preferred
    computed = None if compare is None else read_reference(compare, ("v", *COMPARED, "c0", "L"), (WAVE,))
    predicted: dict[str, pd.DataFrame] = {
        name: predicted_branch(tube.c0, tube.length, modes[0], name, largest).table()
        for name in (equation.families if family is None else (chosen,))
    }
    others: list[Callable[[], object]] = []
    if branch is not None:
        rows = predicted[chosen] if computed is None else compared(computed, equation, chosen)
        others.append(lambda: write_table("--branch", branch, rows))

    def draw() -> Figure:
        from pearlbvp.figures.amplitude import draw_prediction

        title = f"c0 = {tube.c0:g}, L = {tube.length:g}, mode ({equation.m},{equation.n})"
        return draw_prediction(predicted, computed, title)

    return write(table, out, plot, draw, others)


@click.command(
    "amplitude-map",
    cls=Command,
    epilog="Example:  pearlbvp amplitude-map --c0=-1:0.48:0.02 --lengths 6.5:40:0.5 --plot m.png",
)
@click.option("--c0", type=Numbers("c0"), required=True, help="Spontaneous curvatures.")
@click.option("--lengths", type=Numbers("length"), required=True, help="Tube lengths.")
@click.option(
    "--meetings",
    type=File(),
    metavar="FILE.csv",
    help="Write where two modes become critical at once.",
)
@outputs
def amplitude_map(
    c0: list[float], lengths: list[float], meetings: Path | None, out: Path | None, plot: Path | None
) -> int:
    """Which mode destabilizes the straight tube at either end of its stable interval, and what branches off there.

    Columns: c0, L, lower_mode (m:n), lower_lambda2, lower_criticality, upper_mode, upper_lambda2, upper_type,
    upper_criticality, stable (ring, coil, buckle or pearl), message. All is in units of the tube's radius.
    """
    from pearlbvp.files import writable
    from pearlbvp.studies.amplitude import exchange_curve, instability_map, meeting_points

    out, plot = check_outputs(out, plot)
    meetings = None if meetings is None else writable("--meetings", meetings)
    check_distinct({"--out": out, "--plot": plot, "--meetings": meetings})
    table = instability_map(c0, lengths)
    others: list[Callable[[], object]] = []
    if meetings is not None:
        others.append(lambda: write_table("--meetings", meetings, meeting_points(c0, lengths)))

    def draw() -> Figure:
        from pearlbvp.figures.amplitude import draw_map

        return draw_map(table, exchange_curve(c0))

    return write(table, out, plot, draw, others)
