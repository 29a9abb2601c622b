"""``pearlbvp amplitude`` and ``pearlbvp amplitude-map``."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pearlbvp.commands.arguments import File, ModeNumbers, Number, Numbers
from pearlbvp.commands.command import Command
from pearlbvp.commands.output import check_distinct, check_outputs, outputs, radius_option, write, write_table
from pearlbvp.errors import InputError

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from pearlbvp.units import Units


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
@radius_option
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
    units: Units,
) -> int:
    """Amplitude equations of the branches that leave the straight tube, in closed form.

    Columns: c0, L, m, n, type, lambda2, lambda1, a, b (or b1, b2), alpha2, stable (the family that is stable at
    its onset at fixed area and volume), role, criticality. The wave is u = 2 A cos(kx + n phi), and
    dA/dt = A (a p + b A^2) where lambda2 has changed by p since the onset.

    The predicted branch has the columns of `branch`, growth rates to leading order. With --compare its columns are A, v
    and, of lambda1, lambda2, E and wave (2 A), the computed and the predicted value at that v, the error relative to the
    change since the onset, and the order in A at which it falls.
    """
    from pearlbvp.files import writable
    from pearlbvp.studies.amplitude import COMPARED, WAVE, coefficients, compared, predicted_branch
    from pearlbvp.studies.reference import read_reference
    from pearlbvp.theory.amplitude import amplitude_equation, family_named

    out, plot = check_outputs(out, plot)
    branch = None if branch is None else writable("--branch", branch)
    start = None if compare is None else Path(os.path.realpath(compare))
    check_distinct({"--compare": start, "--out": out, "--plot": plot, "--branch": branch})
    idle = [name for name, value in (("--family", family), ("--largest", largest), ("--compare", compare)) if value]
    if idle and branch is None and plot is None:
        raise InputError(idle[0], "it shapes the predicted branch only", "give --branch or --plot, too")
    tube = units.tube(c0, length)
    largest = None if largest is None else units.from_user("wave", largest)
    table = coefficients(tube.c0, tube.length, modes)
    equation = amplitude_equation(tube, modes[0])
    chosen = family_named(family) if family else equation.preferred
    computed = None
    if compare is not None:
        read = read_reference(compare, ("v", *COMPARED, "c0", "L"), (WAVE,), units)
        computed = read.assign(**{name: units.from_user(name, read[name]) for name in map(str, read)})
    predicted: dict[str, pd.DataFrame] = {
        name: predicted_branch(tube.c0, tube.length, modes[0], name, largest).table()
        for name in (equation.families if family is None else (chosen,))
    }
    others: list[Callable[[], object]] = []
    if branch is not None:
        rows = predicted[chosen] if computed is None else compared(computed, equation, chosen)
        others.append(lambda: write_table("--branch", branch, units.columns(rows)))

    def draw() -> Figure:
        from pearlbvp.figures.amplitude import draw_prediction

        title = f"{units.tube_text(tube)}, mode ({equation.m},{equation.n})"
        lines = {name: units.columns(rows) for name, rows in predicted.items()}
        return draw_prediction(lines, None if computed is None else units.columns(computed), title, units)

    return write(units.columns(table), out, plot, draw, others)


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
@radius_option
def amplitude_map(
    c0: list[float], lengths: list[float], meetings: Path | None, out: Path | None, plot: Path | None, units: Units
) -> int:
    """Which mode destabilizes the straight tube at either end of its stable interval, and what branches off there.

    Columns: c0, L, lower_mode (m:n), lower_lambda2, lower_criticality, upper_mode, upper_lambda2, upper_type,
    upper_criticality, stable (ring, coil, buckle or pearl), message.
    """
    from pearlbvp.files import writable
    from pearlbvp.studies.amplitude import exchange_curve, instability_map, meeting_points

    out, plot = check_outputs(out, plot)
    meetings = None if meetings is None else writable("--meetings", meetings)
    check_distinct({"--out": out, "--plot": plot, "--meetings": meetings})
    curvatures = [units.tube(value, lengths[0]).c0 for value in c0]
    periods = [units.tube(c0[0], length).length for length in lengths]
    table = units.columns(instability_map(curvatures, periods))
    others: list[Callable[[], object]] = []
    if meetings is not None:
        others.append(lambda: write_table("--meetings", meetings, units.columns(meeting_points(curvatures, periods))))

    def draw() -> Figure:
        from pearlbvp.figures.amplitude import draw_map

        return draw_map(table, units.columns(exchange_curve(curvatures)), units)

    return write(table, out, plot, draw, others)
