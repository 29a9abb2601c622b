"""``pearlbvp show``."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pearlbvp.commands.arguments import File
from pearlbvp.commands.command import Command, Option, options_given
from pearlbvp.commands.output import (
    DONE,
    check_distinct,
    check_ending,
    check_outputs,
    outputs,
    radius_option,
    write,
    write_table,
)
from pearlbvp.errors import InputError
from pearlbvp.messages import say

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pearlbvp.units import Units

SURFACES = (".csv", ".obj", ".ply", ".vtu", ".fe")
"""Endings of files with surfaces."""


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp show b.h5  |  pearlbvp show b.h5 --plot b.png  |  "
    "pearlbvp show b.h5 --point bp --profile p.csv  |  pearlbvp show k.h5 --point v=0.95 --surface k.vtu",
)
@click.argument("file", type=File(), metavar="FILE.h5")
@click.option(
    "--point",
    cls=Option,
    needs=("profile", "surface"),
    metavar="K|NAME=VALUE|KIND:K",
    help="Of which point: its number, a column's value, or a special point (bp, fold:v:2).  [default: the last]",
)
@click.option("--profile", type=File(), metavar="FILE.csv", help="Write the point's profile there.")
@click.option(
    "--surface",
    type=File(),
    metavar="FILE.csv|.obj|.ply|.vtu|.fe",
    help="Write the point's surface there: as a grid of points, or as triangles (.fe: for Surface Evolver).",
)
@click.option(
    "--samples",
    cls=Option,
    needs=("profile",),
    type=click.IntRange(min=4),
    default=400,
    show_default=True,
    help="With --profile: steps of a period, or around a section.",
)
@click.option(
    "--nodes",
    cls=Option,
    needs=("surface",),
    type=click.IntRange(min=20),
    default=3000,
    show_default=True,
    help="With --surface: points, about.",
)
@outputs
@radius_option
def show(
    file: Path,
    point: str | None,
    profile: Path | None,
    surface: Path | None,
    samples: int,
    nodes: int,
    out: Path | None,
    plot: Path | None,
    units: Units,
) -> int:
    """Show a saved branch, the end of a flow, or a saved flow, without computing anything.

    The table is that of `branch`; on standard error stand the family, special points, and why the branch ends. A point's
    profile has the columns x, r, psi (angle of the tangent), H (mean curvature) on the whole tube; that of a ring is its
    section, y, z, psi, H; that of a coil its section at x = 0, y, z. A surface in CSV is a grid: x, y, z, i (along the tube), j
    (around it).

    Only computed points are shown: where NAME=VALUE lies between two, the nearer one is taken, which is said.
    """
    from pearlbvp.files import writable

    out, plot = check_outputs(out, plot)
    check_ending("--surface", surface, SURFACES)
    check_ending("--profile", profile, (".csv",))
    profile = None if profile is None else writable("--profile", profile)
    surface = None if surface is None else writable("--surface", surface)
    check_distinct(
        {
            "FILE": Path(os.path.realpath(file)),
            "--out": out,
            "--plot": plot,
            "--profile": profile,
            "--surface": surface,
        }
    )
    from pearlbvp.flows.checkpoint import KIND
    from pearlbvp.hdf5 import kind_of

    if kind_of("FILE", file) == KIND:
        shape = next(
            (name for name in ("profile", "surface") if name in options_given(click.get_current_context())), None
        )
        if shape is not None:
            raise InputError(
                f"--{shape}",
                f"{file} is a saved flow, which has none",
                f"write its end with pearlbvp flow --resume {file} --save-end E.h5, and show that",
            )
        return _flow(file, out, plot, units)
    return _branch(file, point or "-1", profile, surface, samples, nodes, out, plot, units)


def _branch(
    file: Path,
    point: str,
    profile: Path | None,
    surface: Path | None,
    samples: int,
    nodes: int,
    out: Path | None,
    plot: Path | None,
    units: Units,
) -> int:
    """Show a saved branch."""
    from pearlbvp.progress import progress

    others: list[Callable[[], object]] = []
    note = ""
    with progress("step", doing="reading") as bar:
        from pearlbvp.studies import export, saved
        from pearlbvp.studies.branch import shown

        bar.leave = False  # what is shown says more
        branch = saved.load(file, "FILE")
        table = units.columns(shown(branch.table()))
        if profile is not None or surface is not None:
            index, note = export.stored(branch, units.place_from_user(point))
            at = branch.points[index]
            if profile is not None:
                rows = units.columns(export.profile_table(at, samples))
                others.append(lambda: write_table("--profile", profile, rows))
            if surface is not None:
                others.append(_surface_writer(at, nodes, surface, units))

    def draw() -> Figure:
        from pearlbvp.figures.branch import draw_branch

        return draw_branch(branch, table, units=units)

    status = write(table, out, plot, draw, others)
    if note:
        say(units.said(note))
    say(branch.described(units.said, units.measured, units.symbol), begin="")
    return status


def _surface_writer(at: Any, nodes: int, path: Path, units: Units) -> Callable[[], object]:
    """What writes a point's surface as the ending says."""
    if path.suffix.lower() in ("", ".csv"):
        from pearlbvp.studies.export import surface_table

        rows = units.columns(surface_table(at, nodes))
        return lambda: write_table("--surface", path, rows)
    from pearlbvp.mesh.files import write_mesh
    from pearlbvp.studies.mesh import shape_mesh

    mesh = shape_mesh(at, nodes)
    return lambda: write_mesh(units.surface(mesh), path, c0=units.to_user("H", at.observables["c0"]), name="--surface")


def _flow(file: Path, out: Path | None, plot: Path | None, units: Units) -> int:
    """Show a saved flow."""
    from pearlbvp.helfrich import Tube
    from pearlbvp.studies.flow import load

    state = load(file, "FILE")
    units = units.of_flow(state.problem.law)
    table = state.columns(units)

    def draw() -> Figure:
        from pearlbvp.figures.flow import draw_flow

        return draw_flow(state, table, units=units)

    write(table, out, plot, draw)
    tube = units.tube_text(Tube(state.problem.c0, state.problem.length), ".8g")
    say(
        f"a flow, saved at t = {units.text('t', state.t, '.8g')}: {len(table)} steps, {tube}\n"
        f"  it goes on with pearlbvp flow --resume {file}, which can save its end (--save-end)",
        begin="",
    )
    return DONE
