"""What commands that draw have in common: whose settings they draw by, what energies are above, shapes at their places."""

from __future__ import annotations

import contextlib
import importlib
import logging
import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pearlbvp.commands.command import Option
from pearlbvp.messages import say

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pearlbvp.continuation.branch import Branch
    from pearlbvp.studies.energies import Reference
    from pearlbvp.units import Units


def drawing(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options."""
    for decorate in (
        click.option("--shapes", cls=Option, needs=("plot",), is_flag=True,
                     help="With --plot: one diagram, with shapes at their places."),
        click.option("--reference", cls=Option, needs=("plot",), metavar="tube|NAME|FILE.h5",
                     help="With --plot: energies as differences from that of the straight tube, or of a branch at the same v."),
    ):  # fmt: skip
        command = decorate(command)
    return command


def reference_of(named: str | None, branches: Mapping[str, Branch[Any]] | None = None) -> Reference | None:
    """What energies are drawn above: one of the branches by its name, else a saved one.

    Raises:
        InputError: there is no such branch.
    """
    if named is None:
        return None
    from pearlbvp.studies import saved
    from pearlbvp.studies.energies import Reference

    if Path(named).suffix and named not in (branches or {}):
        return Reference.of(saved.load(Path(named), "reference"))
    return Reference.of(named, branches)


def say_what_is_missing(reference: Reference | None, branches: Mapping[str, Branch[Any]]) -> None:
    """Say which branches go beyond the reference's volumes, where nothing is drawn."""
    beyond = [] if reference is None else [name for name, branch in branches.items() if reference.misses(branch)]
    if beyond and reference is not None:
        say(f"{reference.words} has not all volumes of {', '.join(beyond)}, whose energies are drawn as far as it goes")


def branch_figure(branch: Branch[Any], units: Units, reference: Reference | None, shapes: bool) -> Figure:
    """The picture of one branch."""
    from pearlbvp.figures.branch import along, draw_branch

    say_what_is_missing(reference, {"the branch": branch})
    if shapes:
        from pearlbvp.figures.diagram import draw_plane

        return draw_plane({"": branch}, along(branch), units=units, reference=reference, shapes=True)
    return draw_branch(branch, units=units, reference=reference)


def draw_on_our_own_terms() -> None:
    """Keep what a user's matplotlib is set to out of this process, before it is loaded: its ``backend`` need not even exist.

    A notebook's backend comes with ``!pearlbvp``; a ``matplotlibrc`` may be broken, or ask for LaTeX that is not there.
    """
    if "matplotlib" in sys.modules:
        return
    os.environ |= {"MPLBACKEND": "agg", "MATPLOTLIBRC": os.devnull}
    if not os.environ.get("SOURCE_DATE_EPOCH", "").isdigit():  # PDF and PostScript would end in a trace
        os.environ["SOURCE_DATE_EPOCH"] = "0"  # the date in PostScript, which is otherwise another in every run
    logging.getLogger("matplotlib").setLevel(logging.CRITICAL)  # of its folder for caches, which may be anywhere
    if os.path.exists("matplotlibrc"):  # which beats all others
        with contextlib.chdir(os.path.dirname(__file__)):
            importlib.import_module("matplotlib")
