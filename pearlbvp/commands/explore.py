"""``pearlbvp explore``."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pearlbvp.commands.arguments import File
from pearlbvp.commands.command import Command
from pearlbvp.commands.output import DONE, check_distinct, check_ending, radius_option
from pearlbvp.messages import counted, say

if TYPE_CHECKING:
    from pearlbvp.units import Units


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp explore b.h5 --out page.html  |  pearlbvp explore b.h5 k.h5 --x v --y lambda2 --out page.html",
)
@click.argument("files", type=File(), nargs=-1, required=True, metavar="FILE.h5 ...")
@click.option(
    "--x", default="", metavar="COLUMN", help="Drawn to the right at first: any column.  [default: v, of flows alone t]"
)
@click.option("--y", default="E", show_default=True, metavar="COLUMN", help="Drawn upwards at first: any column.")
@click.option("--out", required=True, type=File(), metavar="FILE.html", help="Write the page there.")
@radius_option
def explore(files: tuple[Path, ...], x: str, y: str, out: Path, units: Units) -> int:
    """Saved branches and flows as one page for a browser, which needs no network: diagram, shapes, profiles, growth rates.

    A click or the arrow keys choose a point. Its shape can be turned and coloured by its curvatures or by the perturbation
    that grows fastest; flows play.
    """
    from pearlbvp.files import writable, write_whole

    check_ending("--out", out, (".html", ".htm"))
    target = writable("--out", out)
    for file in files:
        check_distinct({"FILE": Path(os.path.realpath(file)), "--out": target})
    from pearlbvp.progress import progress

    with progress("branch", doing="reading") as bar:
        from pearlbvp.commands.diagram import names_of
        from pearlbvp.explorer.page import explorer

        bar.leave = False
        shown = {name: _loaded(file) for name, file in zip(names_of(files), files, strict=True)}
    page = explorer(shown, x, y, units=units)
    write_whole("--out", target, lambda path: path.write_text(page.text, encoding="utf-8"))
    size = len(page.text.encode()) / 1e6
    what = counted(len(shown), "branch or flow", "branches or flows")
    say(f"{out}: {what}, {size:.2f} MB; open it in a browser", begin="")
    return DONE


def _loaded(file: Path) -> Any:
    """A saved branch or flow.

    Raises:
        InputError: it is neither.
    """
    from pearlbvp.flows.checkpoint import KIND
    from pearlbvp.hdf5 import kind_of
    from pearlbvp.studies import flow, saved

    if kind_of("FILE", file) == KIND:
        return flow.load(file, "FILE")
    return saved.load(file, "FILE")
