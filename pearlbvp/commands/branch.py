"""``pearlbvp branch``."""

from __future__ import annotations

import contextlib
import os
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pearlbvp.commands.arguments import (
    ModeNumbers,
    Nodes,
    Number,
    Numbers,
    SpecialKind,
    Until,
    check_meshable,
    wanted_places,
)
from pearlbvp.commands.command import Command, of_this_command
from pearlbvp.commands.output import (
    DONE,
    INTERRUPTED,
    SOME_FAILED,
    check_distinct,
    check_outputs,
    outputs,
    radius_option,
    write,
)
from pearlbvp.errors import InputError
from pearlbvp.messages import say

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pearlbvp.helfrich import Tube
    from pearlbvp.units import Units


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp branch pearl --c0 0 --length 10 --until v=1.3 --save b.h5 --plot b.png  |  "
    "pearlbvp branch pearl --resume b.h5 --until v=1.34  |  "
    "pearlbvp branch pearl --resume b.h5 --switch 1 --centre neck --until v=1.2  |  "
    "pearlbvp branch pearl --c0 0.75 --length 10 --shape=-0.3,0.5 --volume 1.0 --until v=1.1  |  "
    "pearlbvp branch coil --c0 0.48 --length 10 --until v=0.85 --save c.h5  |  "
    "pearlbvp branch coil --resume c.h5 --switch 1 --plot mixed.png  |  "
    "pearlbvp branch coil --resume c.h5 --follow bp:1 --vary L  |  "
    "pearlbvp branch coil --c0 0 --length 10 --nodes 1500 --until v=0.95 --save m.h5 --plot m.png  |  "
    "pearlbvp branch coil --resume m.h5 --until v=0.9",
)
@click.argument("family", type=click.Choice(["pearl", "ring", "coil", "buckle"]))
@click.option("--c0", type=Number(), help="Spontaneous curvature.")
@click.option("--length", type=Number(), metavar="L", help="Axial period of the tube.")
@click.option(
    "--mode",
    type=ModeNumbers(),
    help="Waves along and around the tube.  [default: 1,0 for pearls, 0,2 for rings, 1,1 for coils and buckles]",
)
@click.option(
    "--shape",
    type=Numbers(),
    metavar="A1,A2,..",
    help="Start from the shape of least energy near r = 1 + sum of A_k cos(2 pi k x / L), at --volume.",
)
@click.option("--volume", type=Number(), help="With --shape: its reduced volume.")
@click.option(
    "--cells",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="With --shape: periods on the tube that stability is judged on; L is that of one.",
)
@click.option(
    "--until",
    type=Until(),
    multiple=True,
    help="Stop exactly there: v=1.1, or the K-th special point from the branch's start on: bp, bp:2, fold:v, fold:v:2, cmc. "
    "May be given several times; the first reached counts.",
)
@click.option(
    "--max-points",
    type=click.IntRange(min=2),
    default=200,
    show_default=True,
    help="End after so many; special ones come on top.",
)
@click.option("--step", type=Number(), help="First step along the branch.  [default: 0.1, or the largest]")
@click.option("--max-step", type=Number(), default=0.5, show_default=True, help="Largest step along the branch.")
@click.option(
    "--nodes",
    type=Nodes(),
    metavar="N",
    help="Follow the branch on a triangulated tube of about N vertices.  [default: profiles or reduced modes]",
)
@click.option(
    "--discretization",
    type=click.Choice(["subdivision", "cotangent"]),
    default="subdivision",
    show_default=True,
    help="With --nodes: the surface is the limit of Loop's subdivision, or the polyhedron.",
)
@click.option("--tolerance", type=Number(), help="Error of the profile.  [default: 1e-9 for pearls, 1e-10 for rings]")
@click.option("--pressure", is_flag=True, help="Stability at fixed area and given pressure, not fixed volume.")
@click.option("--save", type=click.Path(path_type=Path), metavar="FILE.h5", help="Save the whole branch.")
@click.option("--resume", type=click.Path(path_type=Path), metavar="FILE.h5", help="Go on from a saved branch.")
@click.option("--switch", type=int, metavar="K", help="With --resume: follow the branch at its K-th bp instead.")
@click.option("--centre", type=click.Choice(["pearl", "neck"]), default="pearl", show_default=True,
              help="With --switch, of pearls: what the new shapes are centred on.")  # fmt: skip
@click.option(
    "--vary",
    type=click.Choice(["c0", "L"]),
    help="With --resume: vary this from a point on, at fixed v (not of rings).",
)
@click.option(
    "--follow",
    type=SpecialKind(),
    metavar="KIND:K",
    help="With --vary: follow this fold or branch point (fold:v:1, bp:2) instead, in both parameters.",
)
@click.option(
    "--keep", type=click.Choice(["v", "lambda2"]), default="v", show_default=True, help="With --vary: what stays."
)
@click.option("--point", type=int, default=-1, help="With --vary: from which point.  [default: the last]")
@click.option("--down", is_flag=True, help="With --vary: towards smaller values.")
@click.option("--shrink", is_flag=True, help="With --switch: the half on which the tube shrinks at its centre.")
@outputs
@radius_option
def branch(
    family: str,
    c0: float | None,
    length: float | None,
    mode: tuple[int, int] | None,
    shape: list[float] | None,
    volume: float | None,
    cells: int,
    until: tuple[tuple[str, float], ...],
    max_points: int,
    step: float | None,
    max_step: float,
    nodes: int | None,
    discretization: str,
    tolerance: float | None,
    pressure: bool,
    save: Path | None,
    resume: Path | None,
    switch: int | None,
    centre: str,
    vary: str | None,
    follow: tuple[str, int] | None,
    keep: str,
    point: int,
    down: bool,
    shrink: bool,
    out: Path | None,
    plot: Path | None,
    units: Units,
) -> int:
    """Follow a branch of pearls, rings, coils or buckles, with special points and the stability of every point.

    Columns: point, special (start, bp, fold:NAME, cmc, stop, end), lambda1, lambda2, v, E, amplitude, r_min,
    r_max, n_unstable, mu_crit (largest growth rate over all perturbations that fit the tube), critical (its n,
    and its wave number j per periods on the tube; of rings, coils and buckles its symmetry), c0, L, mu_error (of
    growth rates, as rigid motions show it), wave (2A of the largest wave cos(kx + n phi) of the surface over the straight tube,
    empty where the axis is not inside of it).

    Special points are numbered from the branch's start (with --shape: from the shape, either way), as --switch, --follow and
    `show` number them, also where --resume goes on; one that a saved branch has already is answered at once.

    Exit status: 0, 1 where --until was not reached or something could not be computed (all points are written), 2 for input
    that cannot be used.

    Rings end where they touch themselves; coils, buckles and what branches off from them where a section is no longer
    star-shaped. Branches that --switch leads to from a ring, coil or buckle are resumed under that name, too.

    With --nodes the surface is a mesh, which needs no sections; one to two seconds a point at 500, ten at 3000. Where mu_error
    is not small beside mu_crit, n_unstable is not certain; of the rest two numbers of nodes tell the error. Of subdivision
    surfaces at v = 0.95, 500 nodes give multipliers to 2e-3 and amplitudes to 1e-2, 3000 to 6e-5 and 1e-3; cotangents give 2e-2
    and 2e-1, 6e-3 and 3e-2. critical is symmetric, breaking or all; bp,bp are two that lead to one branch. Where the mesh is
    renewed, the branch jumps by the mesh's error. A branch on a mesh is resumed and switched under any family's name.
    """
    from pearlbvp.files import writable

    out, plot = check_outputs(out, plot)
    save = None if save is None else writable("--save", save)
    start = None if resume is None else Path(os.path.realpath(resume))
    check_distinct({"--resume": start, "--out": out, "--plot": plot})
    check_distinct({"--out": out, "--plot": plot, "--save": save})
    if resume is None and (c0 is None or length is None):
        raise InputError("--c0, --length: give both, or --resume a saved branch")
    if resume is not None and (c0 is not None or length is not None):
        raise InputError("--resume: the saved branch has its own c0 and length; leave --c0 and --length out")
    wanted = wanted_places(until, units)
    given = given_options(click.get_current_context())
    if nodes is not None:
        unused = sorted(given & NOT_OF_MESHES)
        if unused:
            raise InputError(f"--{unused[0]}: it does not go with a mesh; leave it or --nodes out")
    if (switch is not None or vary is not None) and resume is None:
        raise InputError("--switch, --vary: they need --resume, the saved branch that they start from")
    if follow is not None and save is not None:
        raise InputError("--save: a curve in two parameters cannot be saved; write its table with --out")
    unused = sorted(given & {"keep", "point"})
    if follow is not None and unused:
        raise InputError(f"--{unused[0]}: a curve in two parameters (--follow) does not have it; leave one of them out")
    if switch is not None and vary is not None:
        raise InputError("--switch, --vary: choose one of them")
    if (shape is None) != (volume is None) or (shape is not None and resume is not None):
        raise InputError("--shape, --volume: give both, with --c0 and --length and without --resume")
    for needed, options_of_it in _BRANCH_OPTIONS.items():
        unused = sorted(given & options_of_it)
        if needed not in given and unused:
            raise InputError(f"--{unused[0]}: it goes with --{needed}; give that too, or leave it out")
    unused = sorted(given & {"mode", "tolerance", "pressure", "nodes"})
    if resume is not None and unused:
        raise InputError(f"--{unused[0]}: the saved branch has its own; leave it out")
    mode = mode or MODES[family]
    if family != "pearl":
        unused = sorted(given & PEARLS_ONLY)
        if unused:
            raise InputError(f"--{unused[0]}: it is for pearls only; leave it out with {family}")
    elif mode[1] != 0:
        raise InputError(f"--mode: pearls have n = 0, so {mode[0]},{mode[1]} is none of them; give {max(mode[0], 1)},0")
    from pearlbvp.progress import progress as progress_bar

    with progress_bar("point") as bar:
        from pearlbvp.continuation.branch import MOVED_AWAY
        from pearlbvp.studies import branch as study
        from pearlbvp.studies import saved

        known = None if resume is None else saved.load(resume)
        if known is not None:
            _check_kind(family, saved.kind_of(known), given)
        checkpoint = _Checkpoint(save)

        def progress(so_far: Any) -> None:
            bar.set_postfix(v=f"{so_far.points[-1].observables['v']:.5f}", refresh=False)
            bar.update(len(so_far.points) - bar.n)
            checkpoint(so_far)

        options = study.branch_options(wanted, max_points=max_points, step=step, max_step=max_step, progress=progress)
        accuracy = {} if tolerance is None else {"tolerance": tolerance}
        fixed: Any = "area" if pressure else "area and volume"
        found: Any
        there: Any = None
        if known is None:
            tube = units.tube(c0, length)  # type: ignore[arg-type]
            if shape is not None:
                waves = [units.from_user("shape", amplitude) for amplitude in shape]
                found = study.shape_branch(
                    tube.c0, tube.length, volume or 0, waves, options, cells=cells, fixed=fixed, **accuracy
                )
            elif nodes is not None:
                found = _on_a_mesh(family, tube, mode, options, nodes, kind=discretization, fixed=fixed)
            else:
                found = _from_the_cylinder(family, tube, mode, options, fixed, accuracy)
        elif vary is not None and follow is not None:
            found = study.followed(known, *follow, vary, options, upwards=not down)
        elif vary is not None:
            found = study.varied(known, point, vary, options, keep=keep, upwards=not down)
        elif switch is not None:
            found = saved.switched(known, switch, options, centre=centre, grow=not shrink)
        else:
            there = study.wanted_there(known, options)
            found = saved.resumed(known, options)
    table = units.columns(found.table()[study.COLUMNS])
    saves = [] if save is None else [lambda: saved.save(found, save)]

    def draw() -> Figure:
        from pearlbvp.figures.branch import draw_branch

        return draw_branch(found, table, units=units)

    write(table, out, plot, draw, saves)
    if there is not None:
        v = found.at(there).observables["v"]
        say(
            f"the wanted {there.kind} is point {there.index} of the branch already, at v = {v:.8g}; nothing was computed"
        )
        return DONE
    if not found.complete:
        advice = ""
        if MOVED_AWAY in found.reason:
            advice = _other_way(vary, down, switch, shrink, from_cylinder=known is None and shape is None)
        say(f"the branch ends: {of_this_command(found.reason)}{advice}")
    if found.reason == "interrupted":
        return INTERRUPTED
    return SOME_FAILED if found.failed or (wanted and not found.complete) else DONE


MODES = {"pearl": (1, 0), "ring": (0, 2), "coil": (1, 1), "buckle": (1, 1)}
"""Modes that the families have unless others are given."""

PEARLS_ONLY = {"shape", "volume", "centre"}
"""Options that rings, coils and buckles do not have."""

NOT_OF_MESHES = {"shape", "volume", "cells", "vary", "tolerance"}
"""Options that branches on meshes do not have."""


def _on_a_mesh(family: Any, tube: Tube, mode: tuple[int, int], options: Any, nodes: int, **how: Any) -> Any:
    """The branch of a family that leaves the straight tube at a mode, on a triangulated tube."""
    from pearlbvp.studies.mesh import mesh_branch

    check_meshable(tube.length)
    return mesh_branch(tube.c0, tube.length, family, mode, nodes, options, **how)


def _from_the_cylinder(
    family: str, tube: Tube, mode: tuple[int, int], options: Any, fixed: Any, accuracy: dict[str, float]
) -> Any:
    """The branch of a family that leaves the straight tube at a mode."""
    if family == "pearl":
        from pearlbvp.studies.branch import pearl_branch

        return pearl_branch(tube.c0, tube.length, mode[0], options, fixed=fixed, **accuracy)
    if family == "ring":
        from pearlbvp.studies.ring import ring_branch

        if mode[0] != 0:
            raise InputError(
                f"--mode: rings do not depend on x, so {mode[0]},{mode[1]} is none of them; give 0,{mode[1]}"
            )
        return ring_branch(tube.c0, tube.length, mode[1], options, fixed=fixed, **accuracy)
    if accuracy:
        raise InputError(f"--tolerance: it is for pearls and rings; leave it out with {family}")
    from pearlbvp.studies.tube import tube_branch

    try:
        return tube_branch(tube.c0, tube.length, family, mode, options, fixed=fixed)  # type: ignore[arg-type]
    except InputError as error:  # what the study calls a family is the command's own name: the mode is to be changed
        if not str(error).startswith("family:"):  # a sentence, perhaps, with numbers in the user's unit
            raise
        raise InputError(str(error).replace("family:", "--mode:", 1)) from None


def _check_kind(family: str, kind: str, given: set[str]) -> None:
    """Refuse a saved branch of another family, or an option that it does not have. Meshes know of no family: each will do.

    Raises:
        InputError: the family or option, and what to give instead.
    """
    if kind == "mesh":
        if "centre" in given:
            raise InputError("--centre: new shapes on a mesh are centred on the middle of the period; leave it out")
        return
    if (family == "pearl") != (kind == "pearl"):
        raise InputError(
            f"--resume: the saved branch is one of {kind}s, not of {family}s; say so, or give another file"
        )


def _other_way(vary: str | None, down: bool, switch: int | None, shrink: bool, *, from_cylinder: bool) -> str:
    """Advice for a branch that leads away from where it should, where it has another direction."""
    if vary is not None:
        return "; leave --down out" if down else "; give --down"
    if switch is not None:
        other = "without --shrink" if shrink else "with --shrink"
        return f"; {other} it goes the other way, which at a pitchfork has the same shapes"
    return "; the other half of this branch has the same shapes" if from_cylinder else ""


_BRANCH_OPTIONS = {
    "vary": {"keep", "point", "down", "follow"},
    "switch": {"centre", "shrink"},
    "shape": {"cells"},
    "nodes": {"discretization"},
}
"""Options of ``branch`` that say nothing without another."""


def given_options(context: click.Context) -> set[str]:
    """Names of the options that stand on the command line."""
    source = click.core.ParameterSource.COMMANDLINE
    return {name for name in context.params if context.get_parameter_source(name) == source}


class _Checkpoint:
    """Saves the branch so far now and then, so that a run that is killed keeps its points."""

    def __init__(self, path: Path | None, seconds: float = 2.0) -> None:
        self.path, self.seconds, self.last = path, seconds, time.monotonic()

    def __call__(self, branch: Any) -> None:
        if self.path is not None and time.monotonic() - self.last > self.seconds:
            from pearlbvp.studies.saved import save

            with contextlib.suppress(InputError):  # a full disk may have room again; the end says what was not saved
                save(branch, self.path)
            self.last = time.monotonic()
