"""``pearlbvp phases``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pearlbvp.commands.arguments import File, ModeNumbers, Number, Numbers
from pearlbvp.commands.command import Command, Option, words_of_this_command
from pearlbvp.commands.output import (
    INTERRUPTED,
    check_distinct,
    check_outputs,
    outputs,
    processes_option,
    radius_option,
    write,
    write_table,
)
from pearlbvp.errors import InputError
from pearlbvp.messages import counted, say

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pearlbvp.studies.phases import Phases
    from pearlbvp.units import Units


MOST_NAMED = 6
"""Branch points of one reason that are named one by one."""


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp phases --c0 0.48 --length 15 --volumes 1:1.2:0.01 --out p.csv --transitions t.csv "
    "--plot p.png  |  "
    "pearlbvp phases --c0 0 --length 10 --volumes 0.8:1.3:0.01 --mode 1,0 --mode 1,1 --depth 0 --plot p.png",
)
@click.option("--c0", type=Number("c0"), required=True, help="Spontaneous curvature.")
@click.option("--length", type=Number("length"), metavar="L", required=True, help="Axial period of the tube.")
@click.option("--volumes", type=Numbers(), required=True, help="Reduced volumes: 0.6:1.3:0.01, or a list.")
@click.option(
    "--depth", type=click.IntRange(min=0), default=1, show_default=True,
    help="0 for branches from the straight tube, 1 for those that cross them, too, and so on.",
)  # fmt: skip
@click.option(
    "--mode", "modes", type=ModeNumbers(), multiple=True,
    help="Follow every family of these modes.  [default: pearls of k < 1, the first four others by lambda2, and 0,2]",
)  # fmt: skip
@click.option(
    "--unstable", type=click.IntRange(min=0), default=2, show_default=True,
    help="Follow what crosses a branch where so many directions, or fewer, are unstable.",
)  # fmt: skip
@click.option(
    "--flows",
    cls=Option,
    needs=("transitions",),
    is_flag=True,
    help="Let shapes flow where they lose their stability, to see what they fall to.",
)
@click.option(
    "--starts", type=click.IntRange(min=0), default=100, show_default=True,
    help="Relax so many random shapes, to find stable ones that the branches do not lead to.",
)  # fmt: skip
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True,
    help="Of the random shapes: the same, the same shapes.",
)  # fmt: skip
@click.option(
    "--nodes", type=click.IntRange(min=0), default=3000, show_default=True,
    help="Where reduced modes describe a branch no further, follow it on triangles of so many vertices; 0: end it there.",
)  # fmt: skip
@processes_option
@click.option(
    "--transitions", type=File(), metavar="FILE.csv",
    help="Write where the least shape changes, and where shapes gain or lose stability.",
)  # fmt: skip
@outputs
@radius_option
def phases(
    c0: float,
    length: float,
    volumes: list[float],
    depth: int,
    modes: tuple[tuple[int, int], ...],
    unstable: int,
    flows: bool,
    starts: int,
    seed: int,
    nodes: int,
    processes: int | None,
    transitions: Path | None,
    out: Path | None,
    plot: Path | None,
    units: Units,
) -> int:
    """Which shape a tube takes: all stable shapes that are found at each volume, and where the least one changes.

    Columns: v, branch (as diagram names them), family, symmetry, rank (1 has the least energy), E, excess over the least,
    lambda1, lambda2, force, n_unstable, mu_crit, critical, amplitude, r_min, r_max, c0, L, branches and depth (what the
    ranks rest on), message, starts (random ones that were relaxed), rest_here (how many came to rest on the branch), origin (of
    a branch that they alone lead to: where it meets others), multiplicity (branches that are this one, shifted or mirrored).
    Of the transitions: v, event (maxwell, continuous or jump: the least shape changes at equal energies, continuously, or
    because one begins or ends; stable, unstable: as v grows; end: of what could be followed), branch, other, E, E_other,
    lambda2, lambda2_other, special, critical, falls_to, c0, L, message.
    Unstable parts are dashed.
    """
    from pearlbvp.files import writable

    out, plot = check_outputs(out, plot)
    transitions = None if transitions is None else writable("--transitions", transitions)
    if plot is not None and len(set(volumes)) < 2:
        raise InputError("--plot", "one volume makes no picture", "give several, like 0.9:1.1:0.01")
    check_distinct({"--out": out, "--plot": plot, "--transitions": transitions})
    found = _found(c0, length, volumes, depth, modes, unstable, flows, (starts, seed), nodes, processes, units)
    if found.ranges.empty and plot is not None:
        say("there is no picture: which shapes are the least was not computed")
        plot = None

    def draw() -> Figure:
        from pearlbvp.figures.phases import draw_phases

        return draw_phases(found, units=units)

    events = units.columns(found.transitions)
    others = [] if transitions is None else [lambda: write_table("--transitions", transitions, events)]
    status = write(units.columns(found.table), out, plot, draw, others)
    _tell(found, units)
    return status if found.complete else INTERRUPTED


def _found(
    c0: float, length: float, volumes: list[float], depth: int, modes: tuple[tuple[int, int], ...],
    unstable: int, flows: bool, random: tuple[int, int], nodes: int, processes: int | None, units: Units,
) -> Phases:  # fmt: skip
    from pearlbvp.progress import progress

    with progress("branch") as bar:
        from pearlbvp.studies.phases import phases as study

        def follow(name: str) -> None:
            bar.set_description(name, refresh=False)
            bar.update()

        return study(units.tube(c0, length), volumes, depth=depth, modes=list(modes) or None, unstable=unstable, flows=flows,
                     starts=random[0], seed=random[1], nodes=nodes, processes=processes or 0, progress=follow)  # fmt: skip


def _tell(found: Phases, units: Units) -> None:
    """What the statements rest on, and which shape is the least where."""
    for why in dict.fromkeys(found.skipped.values()):
        names = [name for name in found.skipped if found.skipped[name] == why]
        more = f" and {len(names) - MOST_NAMED} more" * (len(names) > MOST_NAMED)
        say(f"not followed: {', '.join(names[:MOST_NAMED])}{more}: {words_of_this_command(why)}")
    for name, why in found.unfinished.items():
        say(f"{name} ends: {words_of_this_command(why)}")
    for low, high, name in found.ranges.itertuples(index=False):
        say(f"v = {low:.8g} to {high:.8g}: {f'the least is {name}' if name else 'no stable shape was found'}")
    for name, where in found.origins.items():
        say(f"{name} is a branch that a random start led to; it meets {where or 'no branch that is known'}")
    for why, count in found.restless.items():
        say(f"{counted(count, 'start')} came not to rest: {why}")
    say(f"the least of {found.rests_on}")
