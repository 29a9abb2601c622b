"""``pearlbvp diagram``."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pearlbvp.commands.arguments import File, ModeNumbers, Number, Until, wanted_places
from pearlbvp.commands.command import Command, Option, words_of_this_command
from pearlbvp.commands.drawing import drawing, reference_of, say_what_is_missing
from pearlbvp.commands.following import fix_option
from pearlbvp.commands.output import (
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

    from pearlbvp.continuation.branch import Branch
    from pearlbvp.units import Units


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp diagram b.h5 l.h5 --x v --y E --plot d.png  |  "
    "pearlbvp diagram b.h5 l.h5 --reference b --shapes --plot e.png  |  "
    "pearlbvp diagram --c0 0.48 --length 15 --depth 1 --out t.csv --plot d.png  |  "
    "pearlbvp diagram --c0 0 --length 10 --depth 0 --mode 1,0 --mode 1,1 --mode 0,2 --processes 2 --plot d.png",
)
@click.argument("files", type=File(), nargs=-1, metavar="[FILE.h5 ...]")
@click.option("--x", default="v", show_default=True, metavar="COLUMN", help="Drawn to the right: any column.")
@click.option("--y", default="E", show_default=True, metavar="COLUMN", help="Drawn upwards: any column.")
@click.option("--c0", cls=Option, excludes=("files",), type=Number("c0"), help="Without files: spontaneous curvature.")
@click.option(
    "--length",
    cls=Option,
    excludes=("files",),
    type=Number("length"),
    metavar="L",
    help="Without files: axial period of the tube.",
)
@click.option(
    "--depth",
    cls=Option,
    excludes=("files",),
    type=click.IntRange(min=0),
    default=1,
    show_default=True,
    help="Without files: 0 for branches from the straight tube, 1 for those that cross them, too, and so on.",
)
@click.option(
    "--mode", "modes", cls=Option, excludes=("files",), type=ModeNumbers(), multiple=True,
    help="Without files: follow every family of these modes.  [default: all pearls of k < 1]",
)  # fmt: skip
@click.option(
    "--until", cls=Option, excludes=("files",), type=Until(), multiple=True,
    help="Without files: where every branch stops.  [default: pearls at v=1.1, mixed tubes at 0.9, others at 0.85]",
)  # fmt: skip
@click.option(
    "--processes",
    cls=Option,
    excludes=("files",),
    type=click.IntRange(min=1),
    help="Without files: how many.  [default: one a core]",
)
@fix_option(excludes=("files",))
@outputs
@drawing
@radius_option
def diagram(
    files: tuple[Path, ...],
    x: str,
    y: str,
    c0: float | None,
    length: float | None,
    depth: int,
    modes: tuple[tuple[int, int], ...],
    until: tuple[tuple[str, float], ...],
    processes: int | None,
    fix: str,
    out: Path | None,
    plot: Path | None,
    reference: str | None,
    shapes: bool,
    units: Units,
) -> int:
    """Several branches in one table and one picture: saved ones, or all that leave the straight tube, to a depth.

    Columns: branch (the file's name; 3 for three pearls, coil 1:1, 3/1 for what leaves 3 at its first branch point), then
    those of `branch`. Unstable parts are dashed; circles are branch points, crosses folds. Where branches are of tubes of
    different c0 or L, that is said, beside their names in the picture too.
    """
    out, plot = check_outputs(out, plot)
    for file in files:
        check_distinct({"FILE": Path(os.path.realpath(file)), "--out": out, "--plot": plot})
    if not files and (c0 is None or length is None):
        raise InputError("FILE, --c0, --length", "give saved branches, or c0 and length of a tube")
    x, y = ("c0" if name == "C0" else name for name in (x, y))  # as it is headed in physical units
    _check_columns(x, y)
    if reference is not None and y != "E":
        raise InputError("reference", "it is for energies", "leave it out, or draw --y E")
    from pearlbvp.studies.diagram import together, tubes_apart

    branches, complete = _saved(files), True
    if not files:
        branches, complete = _computed(c0, length, depth, modes, until, processes, fix, units)  # type: ignore[arg-type]
    energies, table = reference_of(reference, branches), units.columns(together(branches))
    for option, name in (("--x", x), ("--y", y)):
        if name not in table:
            raise InputError(option, f"no branch here has {name}", "choose another column")

    def draw() -> Figure:
        from pearlbvp.figures.diagram import draw_plane

        say_what_is_missing(energies, branches)
        return draw_plane(branches, x, y, units=units, reference=energies, shapes=shapes)

    status = write(table, out, plot, draw)
    if apart := tubes_apart(table, units):
        say("the branches are of different tubes: " + "; ".join(f"{name}: {tube}" for name, tube in apart.items()))
    if not complete:
        return INTERRUPTED
    return status if files or not any(branch.failed for branch in branches.values()) else SOME_FAILED


def _check_columns(*names: str) -> None:
    """Refuse what is no column with numbers.

    Raises:
        InputError: the option, and the columns that there are.
    """
    from pearlbvp.studies.branch import COLUMNS, FURTHER

    numbers = [name for name in (*COLUMNS, *FURTHER) if name not in ("point", "special", "critical")]
    for option, name in zip(("--x", "--y"), names, strict=True):
        if name not in numbers:
            raise InputError(option, f"{name!r} is no column with numbers", f"choose one of {', '.join(numbers)}")


def _saved(files: tuple[Path, ...]) -> dict[str, Branch[Any]]:
    """Saved branches, by their names."""
    from pearlbvp.studies import saved

    return {name: saved.load(file, "FILE") for name, file in zip(names_of(files), files, strict=True)}


def names_of(files: tuple[Path, ...]) -> list[str]:
    """What several files are called: each by the shortest part of its path that is its own.

    Raises:
        InputError: one is given twice.
    """
    stems = [file.stem for file in files]
    names = [file.stem if stems.count(file.stem) == 1 else str(file) for file in files]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise InputError("FILE", f"{twice} is given twice", "give it once")
    return names


def _computed(
    c0: float,
    length: float,
    depth: int,
    modes: tuple[tuple[int, int], ...],
    until: tuple[tuple[str, float], ...],
    processes: int | None,
    fix: str,
    units: Units,
) -> tuple[dict[str, Branch[Any]], bool]:
    """All branches of a tube to a depth, and whether they are all: else it was interrupted.

    Raises:
        InputError: an argument that cannot be used, or there are none.
    """
    from pearlbvp.progress import progress

    with progress("branch") as bar:
        from pearlbvp.studies.branch import branch_options
        from pearlbvp.studies.diagram import diagram as study

        tube = units.tube(c0, length)
        options: Any = branch_options(wanted_places(until, units)) if until else None

        def follow(name: str) -> None:
            bar.set_description(name, refresh=False)
            bar.update()

        found = study(
            tube.c0, tube.length, depth, options, follow, modes=list(modes) or None, processes=processes or 0,
            fix=units.fix(fix, tube.length),
        )  # fmt: skip
    if not found.complete:
        if not found.branches:
            raise KeyboardInterrupt
        say("interrupted: these are the branches that were followed before")
    for name, why in found.skipped.items():
        say(f"{name} was not followed: {words_of_this_command(why)}")
    for name, branch in found.branches.items():
        if branch.failed:
            say(f"{name} ends: {words_of_this_command(branch.reason)}")
    if not found.branches:
        raise InputError("--mode", "no branch could be followed", "choose other modes, or another length")
    return found.branches, found.complete
