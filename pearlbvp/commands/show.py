"""``pearlbvp show``."""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pearlbvp.commands.branch import given_options
from pearlbvp.commands.command import Command
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

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

SURFACES = (".csv", ".obj", ".ply", ".vtu")
"""Endings of files with surfaces."""


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp show b.h5  |  pearlbvp show b.h5 --plot b.png  |  "
    "pearlbvp show b.h5 --point bp --profile p.csv  |  pearlbvp show k.h5 --point v=0.95 --surface k.vtu",
)
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.h5")
@click.option(
    "--point",
    metavar="K|NAME=VALUE|KIND:K",
    help="Of which point: its number, a column's value, or a special point (bp, fold:v:2).  [default: the last]",
)
@click.option("--profile", type=click.Path(path_type=Path), metavar="FILE.csv", help="Write the point's profile there.")
@click.option(
    "--surface",
    type=click.Path(path_type=Path),
    metavar="FILE.csv|.obj|.ply|.vtu",
    help="Write the point's surface there: as a grid of points, or as triangles.",
)
@click.option(
    "--samples",
    type=click.IntRange(min=4),
    default=400,
    show_default=True,
    help="With --profile: steps of a period, or around a section.",
)
@click.option(
    "--nodes", type=click.IntRange(min=20), default=3000, show_default=True, help="With --surface: points, about."
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
    radius: float,
) -> int:
    """Show a saved branch, the end of a flow, or a saved flow, without computing anything.

    The table is that of `branch`; on standard error stand the family, special points, and why the branch ends. A point's
    profile has the columns x, r, psi (angle of the tangent), H (mean curvature) on the whole tube; that of a ring is its
    section, y, z, psi, H; that of a coil its section at x = 0, y, z. A surface in CSV is a grid: x, y, z, i (along the tube), j
    (around it).

    Only computed points are shown: where NAME=VALUE lies between two, the nearer one is taken, which is said.
    """
    from pearlbvp.files import writable
    from pearlbvp.helfrich import positive

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
    given = given_options(click.get_current_context())
    for name, needed in (("point", ("profile", "surface")), ("samples", ("profile",)), ("nodes", ("surface",))):
        if name in given and not given & set(needed):
            raise InputError(f"--{name}: it goes with --{' or --'.join(needed)}; give that too, or leave it out")
    positive("--radius", radius)
    from pearlbvp.continuation.storage import format_of
    from pearlbvp.flow.checkpoint import FORMAT

    if format_of(file) == FORMAT:
        shape = next((name for name in ("profile", "surface") if name in given), None)
        if shape is not None:
            raise InputError(
                f"--{shape}: {file} is a saved flow, which has none; write its end with pearlbvp flow --resume {file} "
                "--save-end E.h5, and show that"
            )
        return _flow(file, out, plot, radius)
    return _branch(file, point or "-1", profile, surface, samples, nodes, out, plot, radius)


def _branch(
    file: Path,
    point: str,
    profile: Path | None,
    surface: Path | None,
    samples: int,
    nodes: int,
    out: Path | None,
    plot: Path | None,
    radius: float,
) -> int:
    """Show a saved branch."""
    from pearlbvp.continuation.description import described
    from pearlbvp.helfrich import LENGTH_POWER, in_units_of_radius
    from pearlbvp.studies import export, saved
    from pearlbvp.studies.branch import COLUMNS
    from pearlbvp.studies.point import in_radii

    branch = saved.load(file, "FILE")
    table = in_units_of_radius(branch.table()[COLUMNS], radius)
    if profile is not None or surface is not None:
        index, note = export.stored(branch, in_radii(point, radius, LENGTH_POWER))
        at = branch.points[index].point
        if profile is not None:
            rows = export.profile_table(at, samples)
            write_table("--profile", profile, in_units_of_radius(rows, radius, x=1, y=1, z=1, r=1, H=-1))
        if surface is not None:
            _write_surface(at, nodes, surface, radius)
        if note:
            print(f"pearlbvp: {note}", file=sys.stderr)

    def draw() -> Figure:
        from pearlbvp.figures.branch import draw_branch

        return draw_branch(branch, table)

    status = write(table, out, plot, draw)
    print(described(branch, radius), file=sys.stderr)
    return status


def _write_surface(at: Any, nodes: int, path: Path, radius: float) -> None:
    """Write a point's surface as the ending says."""
    if path.suffix.lower() in ("", ".csv"):
        from pearlbvp.helfrich import in_units_of_radius
        from pearlbvp.studies.export import surface_table

        write_table("--surface", path, in_units_of_radius(surface_table(at, nodes), radius, x=1, y=1, z=1))
        return
    from pearlbvp.mesh.files import write_mesh
    from pearlbvp.studies.mesh import shape_mesh

    mesh = shape_mesh(at, nodes)
    write_mesh(replace(mesh, vertices=radius * mesh.vertices, length=radius * mesh.length), path)


def _flow(file: Path, out: Path | None, plot: Path | None, radius: float) -> int:
    """Show a saved flow."""
    from pearlbvp.flow.record import length_powers
    from pearlbvp.helfrich import in_units_of_radius
    from pearlbvp.studies.flow import load

    state = load(file)
    powers = length_powers(state.problem.law)
    table: pd.DataFrame = in_units_of_radius(state.record.table(), radius, **powers)
    unit = radius ** powers["t"]

    def draw() -> Figure:
        from pearlbvp.figures.flow import draw_flow

        return draw_flow(state, table, unit=unit)

    write(table, out, plot, draw)
    model = getattr(state.problem, "reference", state.problem)  # of a flow on a mesh, that knows the model
    words = f"{len(table)} steps, c0 = {model.c0 / radius:.8g}, L = {model.length * radius:.8g}"
    print(
        f"a flow, saved at t = {state.t * unit:.8g}: {words}\n"
        f"  it goes on with pearlbvp flow --resume {file}, which can save its end (--save-end)",
        file=sys.stderr,
    )
    return DONE
