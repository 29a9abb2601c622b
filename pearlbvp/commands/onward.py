"""``pearlbvp resume``, ``switch``, ``vary`` and ``follow``: on from a saved branch."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from pearlbvp.commands.arguments import File, SpecialKind
from pearlbvp.commands.command import Command
from pearlbvp.commands.following import Following, fix_option, following, save_option
from pearlbvp.errors import InputError
from pearlbvp.messages import say

file_argument = click.argument("file", type=File(), metavar="FILE.h5")
down_option = click.option("--down", is_flag=True, help="Begin towards smaller values.  [default: towards --until]")
name_argument = click.argument("name", type=click.Choice(["c0", "L"]))


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp resume b.h5 --until v=1.34 --save b.h5  |  pearlbvp resume c.h5 --until bp:2 --plot c.png",
)
@file_argument
@click.option("--fix", hidden=True)
@save_option
@following
def resume(file: Path, fix: str | None, **how: Any) -> int:
    """Go on from the last point of a saved branch, or of the end of a flow; the table is that of the whole branch.

    Columns and exit status are those of `branch`. Special points are numbered from the branch's start, as `show` numbers them;
    one that the branch has already is answered at once. What was held while stability was judged stays.
    """
    if fix is not None:
        raise InputError(
            "fix", "a branch is judged by one thing throughout", "give it to branch, or go on by switch or vary"
        )
    from pearlbvp.studies import onward

    asked = Following(**how, start=file).checked()
    branch = asked.load()

    def follow(options: Any) -> Any:
        there = onward.wanted_there(branch, options)
        if there is not None:
            v = branch.at(there).observables["v"]
            say(
                f"the wanted {there.kind} is point {there.index} of the branch already, at v = {v:.8g}; nothing was computed"
            )
        for name in onward.led_away(branch, options):
            say(f"{name} moves away from its wanted value where the branch ends, and comes to it only where it turns")
        return onward.resumed(branch, options)

    return asked.run(follow)


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp switch b.h5 1 --until v=1.2 --save l.h5  |  pearlbvp switch b.h5 1 --fix tension,pressure  |  "
    "pearlbvp switch b.h5 1 --centre neck --plot l.png",
)
@file_argument
@click.argument("number", type=click.IntRange(min=1), metavar="K")
@click.option("--centre", type=click.Choice(["pearl", "neck"]),
              help="Of pearls: what the new shapes are centred on.  [default: pearl]")  # fmt: skip
@click.option("--shrink", is_flag=True, help="Follow the half on which the tube shrinks at its centre.")
@fix_option(None)
@save_option
@following
def switch(file: Path, number: int, centre: Any, shrink: bool, fix: str | None, **how: Any) -> int:
    """Follow the branch that crosses a saved one at its K-th branch point (bp).

    Columns and exit status are those of `branch`. Of rings, coils and buckles the new branch is followed in reduced modes, as
    long as sections are star-shaped, and of pearls where it is not axisymmetric; of meshes on meshes, where two branch
    points in a row (bp,bp) lead to one branch.
    """
    from pearlbvp.studies.onward import switched

    asked = Following(**how, start=file).checked()
    branch = asked.load()
    fix = asked.fixed(branch, fix)
    other = "without --shrink" if shrink else "with --shrink"
    return asked.run(
        lambda options: switched(branch, number, options, centre=centre, grow=not shrink, fix=fix),
        f"; {other} it goes the other way, which at a pitchfork has the same shapes",
    )


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp vary b.h5 c0 --until c0=0.6  |  pearlbvp vary b.h5 L --point 4 --keep lambda2 --down",
)
@file_argument
@name_argument
@click.option("--point", type=int, default=-1, help="From which point (negative: from the end).  [default: the last]")
@click.option(
    "--keep", type=click.Choice(["v", "lambda2"]), default="v", show_default=True, help="What stays as it is there."
)
@down_option
@fix_option(None)
@save_option
@following
def vary(file: Path, name: str, point: int, keep: str, down: bool, fix: str | None, **how: Any) -> int:
    """Vary c0 or L from a point of a saved branch on, at fixed v (not of rings or meshes).

    Columns and exit status are those of `branch`.
    """
    from pearlbvp.studies.onward import varied

    asked = Following(**how, start=file).checked()
    branch = asked.load()
    fix = asked.fixed(branch, fix)
    return asked.run(
        lambda options: varied(branch, point, name, options, keep=keep, upwards=False if down else None, fix=fix),
        "; leave --down out" if down else "; give --down",
    )


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp follow c.h5 bp:1 L --out l.csv  |  pearlbvp follow b.h5 fold:v:1 c0 --down --plot f.png",
)
@file_argument
@click.argument("which", type=SpecialKind(), metavar="KIND:K")
@name_argument
@down_option
@fix_option(None)
@following
def follow(file: Path, which: tuple[str, int], name: str, down: bool, fix: str | None, **how: Any) -> int:
    """Follow a fold (fold:v:1) or a branch point (bp:2) of a saved branch while c0 or L varies, too.

    Columns and exit status are those of `branch`. The curve is a table and a picture; it cannot be saved.
    """
    from pearlbvp.studies.onward import followed

    asked = Following(**how, start=file).checked()
    branch = asked.load()
    fix = asked.fixed(branch, fix)
    return asked.run(
        lambda options: followed(branch, *which, name, options, upwards=False if down else None, fix=fix),
        "; leave --down out" if down else "; give --down",
    )
