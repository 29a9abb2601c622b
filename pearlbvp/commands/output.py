"""What all commands share: options for tables and pictures, writing them, exit status."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pearlbvp.commands.arguments import File
from pearlbvp.commands.command import Option, of_this_command
from pearlbvp.commands.tables import write_table
from pearlbvp.errors import InputError
from pearlbvp.files import check_ending, is_device
from pearlbvp.messages import drop, say, why_not_written
from pearlbvp.scale import CONVENTIONS
from pearlbvp.units import headed

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

DONE, SOME_FAILED, UNUSABLE, INTERRUPTED = 0, 1, 2, 130
"""Exit status."""


PICTURES = (".png", ".pdf", ".svg", ".eps", ".ps", ".jpg", ".jpeg", ".tif", ".tiff", ".webp")
"""Endings of pictures: what matplotlib writes without further programs."""


style_option = click.option(
    "--style", cls=Option, needs=("plot", "movie"), metavar="FILE.mplstyle",
    help="Draw it by a style: a file of matplotlib's settings (fonts, sizes, lines, resolution), or one of its own by name, "
    "like seaborn-v0_8-paper.",
)  # fmt: skip


processes_option = click.option(
    "--processes", type=click.IntRange(min=1), help="How many to use.  [default: one a core]"
)


def outputs(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options that all commands with a table share."""
    for decorate in (
        style_option,
        click.option("--plot", type=File(), metavar="FILE.png",
                     help="Draw a picture (PNG, PDF, SVG, ... by the ending)."),
        click.option("--out", type=File(), metavar="FILE.csv",
                     help="Write the table there instead of on standard output (-): CSV, .parquet or .json, with units and "
                     "meaning of its columns, of CSV in FILE.csv-metadata.json."),
    ):  # fmt: skip
        command = decorate(command)
    return command


def radius_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """For commands that convert all that is given and written by the ``units`` that they are called with: their options."""
    for decorate in (
        click.option("--convention", type=click.Choice(list(CONVENTIONS)), default="physicists", show_default=True,
                     help="Of kappa and c0 with --radius 50nm: physicists write kappa/2 (2H - c0)^2, Mem3DG kappa (H - c0)^2, "
                     "where kappa is twice theirs and c0 half of theirs. Without units c0 is the latter."),
        click.option("--temperature", metavar="T", help="Of kT.  [default: 310K]"),
        click.option("--kappa", metavar="KAPPA",
                     help="Bending rigidity, like 20kT: tensions are then in mN/m, pressures in Pa, forces in pN."),
        click.option("--radius", metavar="R",
                     help="Radius of the straight tube, like 50nm: then all that is given may have a unit, and columns have "
                     "theirs in their names, like L[nm]; numbers without one are in those. Or a number, in one's own unit.  "
                     "[default: 1: the unit is the radius]"),
    ):  # fmt: skip
        command = decorate(command)
    return command


def print_table(table: pd.DataFrame) -> None:
    """Write a table on standard output."""
    try:
        sys.stdout.write(headed(table).to_csv(index=False, float_format="%.12g"))
        sys.stdout.flush()
    except BrokenPipeError:  # the reader has had enough, which is no failure
        raise
    except OSError as error:
        drop(sys.stdout)
        raise why_not_written(error) from None


def check_outputs(out: Path | None, plot: Path | None) -> tuple[Path | None, Path | None]:
    """Where table and picture are written, links resolved, before anything is computed for them.

    ``--out -`` is standard output, where the table goes without ``--out``, too.
    """
    from pearlbvp.files import writable

    check_ending("--plot", plot, PICTURES)
    out = None if out is None or str(out) == "-" else writable("--out", out)
    plot = None if plot is None else writable("--plot", plot)
    check_distinct({"--out": out, "--plot": plot})
    return out, plot


def check_distinct(paths: Mapping[str, Path | None]) -> None:
    """Refuse two options with the same file, which would overwrite each other; devices take what they get.

    Raises:
        InputError: the second option's name, and what it collides with.
    """
    known: dict[Path, str] = {}
    for option, path in paths.items():
        if path is None or is_device(path):
            continue
        if path in known:
            raise InputError(option, f"{path} is the file of {known[path]} already", "give it another name")
        known[path] = option


def write(
    table: pd.DataFrame,
    out: Path | None,
    plot: Path | None,
    draw: Callable[[], Figure],
    others: Sequence[Callable[[], object]] = (),
) -> int:
    """Write the table, then what else there is, then the picture: each even where another cannot be written.

    Args:
        table: for ``out``, or standard output.
        out, plot: where to.
        draw: makes the picture.
        others: write the command's other files.

    Returns:
        The exit status, which says whether some rows failed.

    Raises:
        InputError: what could not be written, on one line.
    """

    def draw_and_save() -> None:
        if plot is None:
            return
        from pearlbvp.figures.canvas import save_figure
        from pearlbvp.files import write_whole

        figure = draw()
        write_whole("--plot", plot, lambda path: save_figure(figure, path))

    first = (lambda: print_table(table)) if out is None else (lambda: write_table("--out", out, table))
    _all_of((first, *others, draw_and_save))
    failed = 0
    for column in ("status", "localized_status"):
        if column in table:
            failed = max(failed, int((table[column] == "failed").sum()))
    if failed:
        say(f"{failed} of {len(table)} rows failed; the message column says why")
    return SOME_FAILED if failed else DONE


def _all_of(writers: Sequence[Callable[[], object]]) -> None:
    """Call each, even where another failed; what was computed is not lost because one disk is full.

    Raises:
        InputError: what failed.
    """
    failures: list[InputError] = []
    broken: BrokenPipeError | None = None
    for write in writers:
        try:
            write()
        except InputError as error:
            failures.append(of_this_command(error))
        except BrokenPipeError as error:
            broken = error
    if failures:
        first, *others = failures
        raise InputError(first.argument, first.what, "; ".join(filter(None, (first.remedy, *map(str, others)))))
    if broken is not None:
        raise broken
