"""``pearlbvp reproduce``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pearlbvp.commands.arguments import File
from pearlbvp.commands.command import Command, Option
from pearlbvp.commands.output import DONE, print_table, write_table
from pearlbvp.errors import InputError
from pearlbvp.messages import say

if TYPE_CHECKING:
    from pearlbvp.paper.sheet import Sheet


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp reproduce --list  |  pearlbvp reproduce c05f1 --out paper  |  "
    "pearlbvp reproduce all --out paper --format pdf  |  pearlbvp reproduce cmf1 --point D2 --out paper",
)
@click.argument("figure", required=False, metavar="[FIGURE|TABLE|all]")
@click.option("--list", "listed", is_flag=True, help="Which figures and tables there are, and which panels.")
@click.option("--out", type=File(), metavar="DIR", help="Folder for the files, made where there is none.")
@click.option("--format", "endings", type=click.Choice(["png", "pdf", "svg"]), multiple=True, default=("png",),
              show_default=True, help="Of pictures; several may be given.")  # fmt: skip
@click.option(
    "--style", cls=Option, needs=("out",), metavar="FILE.mplstyle", help="Draw pictures by a style of matplotlib's."
)
@click.option("--point", cls=Option, needs=("out",), metavar="NAME",
              help="Only this sample of the figure, like D2: its row, picture, and a file for show, resume, flow.")  # fmt: skip
def reproduce(figure: str | None, listed: bool, out: Path | None, endings: tuple[str, ...], point: str | None) -> int:
    """Figures and tables of the paper by Meiners and Uecker, panel by panel, beside the numbers that it prints.

    For each panel a picture and its data as CSV; for each figure its samples, and FIGURE_printed.csv with the columns figure,
    label, quantity, printed, computed, difference, verdict (agrees: within a unit of the last printed digit; erratum;
    otherwise), right (where the paper errs), why. The printed numbers of all that was asked for go to standard output, too.
    """
    from pearlbvp.paper.catalogue import CATALOGUE, listing, names

    if listed:
        print_table(listing())
        return DONE
    if figure is None or out is None:
        remedy = "give FIGURE --out DIR, or --list to see which figures there are"
        raise InputError("figure" if figure is None else "out", "it is missing", remedy)
    wanted = names(figure)
    if point is not None and len(wanted) > 1:
        raise InputError("point", "it is a sample of one figure", "give that instead of all")
    from pearlbvp.progress import progress

    folder, tables = _folder(out), []
    if point is not None:
        _write_sample(wanted[0], CATALOGUE[wanted[0]].compute(), point, folder, endings)
        return DONE
    with progress("figure", total=len(wanted)) as bar:
        for name in wanted:
            tables.append(_write_sheet(name, CATALOGUE[name].compute(), folder, endings))
            bar.update()
    import pandas as pd

    beside = pd.concat(tables, ignore_index=True)
    print_table(beside)
    if len(beside):
        said = ", ".join(f"{(beside['verdict'] == word).sum()} {word}" for word in ("agrees", "erratum", "otherwise"))
        say(f"{len(beside)} printed numbers: {said}; the files are in {folder}")
    return DONE


def _folder(out: Path) -> Path:
    """The folder, made.

    Raises:
        InputError: it is a file, or cannot be made.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError("out", f"{out} cannot be made a folder ({error.strerror})", "give another") from None
    return out


def _write_sheet(name: str, sheet: Sheet, folder: Path, endings: tuple[str, ...]) -> Any:
    """Write a figure's files; returns its printed numbers."""
    from pearlbvp.figures.paper import draw_panel
    from pearlbvp.paper.printed import beside_printed
    from pearlbvp.paper.writing import panel_name, tables_of

    for file, table in tables_of(name, sheet):
        write_table("--out", folder / f"{file}.csv", table)
    for panel in sheet.panels:
        _write_picture(draw_panel(panel), folder / panel_name(name, panel.letter), endings)
    return beside_printed(name, sheet.values)


def _write_sample(name: str, sheet: Sheet, point: str, folder: Path, endings: tuple[str, ...]) -> None:
    """Write one sample's files."""
    from pearlbvp.figures.paper import draw_panel
    from pearlbvp.paper.sheet import Shapes
    from pearlbvp.paper.writing import panel_name, sample_branch
    from pearlbvp.studies.saved import save

    branch = sample_branch(name, sheet.samples, point)
    chosen, file = Shapes(point, {point: branch.points[0]}), panel_name(name, point)
    write_table("--out", folder / f"{file}.csv", chosen.table())
    _write_picture(draw_panel(chosen), folder / file, endings)
    save(branch, folder / f"{file}.h5")
    print_table(chosen.table())


def _write_picture(figure: Any, path: Path, endings: tuple[str, ...]) -> None:
    """A picture in some formats."""
    from pearlbvp.figures.canvas import save_figure
    from pearlbvp.files import write_whole

    for ending in endings:
        write_whole("--out", path.with_name(f"{path.name}.{ending}"), lambda beside: save_figure(figure, beside))
