"""``pearlbvp mesh``."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pearlbvp.commands.arguments import File, Nodes, Number, check_meshable
from pearlbvp.commands.command import Command, options_given
from pearlbvp.commands.following import fix_option
from pearlbvp.commands.output import check_distinct, check_outputs, radius_option, write
from pearlbvp.errors import InputError
from pearlbvp.messages import say

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from pearlbvp.units import Units


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp mesh --length 10 --nodes 2000 --out tube.obj  |  "
    "pearlbvp mesh --from b.h5 --point v=1.2 --nodes 3000 --out pearl.vtu --plot pearl.png  |  "
    "pearlbvp mesh --from b.h5 --point A2 --solve --out a2.ply",
)
@click.option("--from", "source", type=File(), metavar="FILE.h5", help="A saved branch of any family.")
@click.option("--point", default="-1", show_default=True, metavar="K|NAME=VALUE|A2",
              help="With --from: a point's number, a column's value, or a name of the paper.")  # fmt: skip
@click.option("--length", type=Number("length"), metavar="L", help="Without --from: axial period of the straight tube.")
@click.option("--c0", type=Number("c0"), help="Without --from: spontaneous curvature, for the energy.  [default: 0]")
@click.option("--nodes", type=Nodes(), metavar="N", help="Vertices, to within a tenth.  [default: 3000]")
@click.option("--discretization", type=click.Choice(["subdivision", "cotangent"]), default="subdivision",
              show_default=True, help="Of the energy, and with --solve of the equilibrium.")  # fmt: skip
@click.option("--solve", is_flag=True, help="Let Newton's method find the equilibrium of the mesh at the same volume.")
@fix_option(None, needs=("solve",))
@click.option(
    "--out", type=File(), metavar="FILE.vtu|.ply|.obj|.fe", help="Write the mesh there (.fe: for Surface Evolver)."
)
@click.option("--plot", type=File(), metavar="FILE.png", help="Draw a picture of the surface.")
@radius_option
def mesh(
    source: Path | None,
    point: str,
    length: float | None,
    c0: float | None,
    nodes: int | None,
    discretization: Any,
    solve: bool,
    fix: str | None,
    out: Path | None,
    plot: Path | None,
    units: Units,
) -> int:
    """Make a triangulated tube: the straight one, or any shape of a saved branch.

    Columns (one row, on standard output): nodes, triangles, quality_worst, quality_mean (longest edge times perimeter by
    twice the area; 3.46 is best), area, volume (of the flat triangles), c0, L, E (of the discretization); with --solve
    also lambda1, lambda2, v, amplitude, r_min, r_max, n_unstable, mu_crit, critical, mu_error (of growth rates, as rigid
    motions show it), M (integral of the mean curvature) and the axial force, of the equilibrium on the mesh.

    The mesh is one period, cut where it begins again. A shape of a branch on a mesh comes with its own triangles.
    """
    given = options_given(click.get_current_context())
    _refuse_idle(given)
    _, plot = check_outputs(None, plot)
    if out is not None:
        from pearlbvp.mesh.files import writable_mesh

        out = writable_mesh("--out", out)
    start = None if source is None else Path(os.path.realpath(source))
    check_distinct({"--from": start, "--out": out, "--plot": plot})
    from pearlbvp.progress import progress

    with progress("step", 3 if solve else 1, doing="mesh") as bar:
        from pearlbvp.studies.mesh import NODES, mesh_table

        nodes = NODES if nodes is None else nodes
        if source is None:
            from pearlbvp.mesh.families import tube_mesh

            tube = units.tube(c0 or 0.0, length)  # type: ignore[arg-type]
            check_meshable(tube.length)
            surface, title = tube_mesh(tube.length, nodes), f"straight tube, L = {units.text('L', tube.length)}"
            table = mesh_table(surface, tube.c0, discretization)
        else:
            from pearlbvp.studies import saved
            from pearlbvp.studies.point import chosen

            branch = saved.load(source, "--from")
            at = chosen(branch, units.place_from_user(point), saved.family_of(branch))
            held = None if fix is None else units.fix(fix, at.observables["L"])
            own = sorted(given & {"nodes", "discretization"})
            if own and at.problem.own_mesh(at.u) is not None:
                raise InputError(f"--{own[0]}", "the branch is on a mesh, which is taken as it is", "leave it out")
            surface, table = _of_a_point(at, nodes, discretization, solve, held, bar)
            title = f"v = {at.observables['v']:.4f}, L = {units.text('L', at.observables['L'])}"
        bar.update()
    others: list[Callable[[], object]] = []
    if out is not None:
        from pearlbvp.mesh.files import write_mesh

        others.append(lambda: write_mesh(units.surface(surface), out, c0=units.to_user("H", float(table["c0"][0]))))

    def draw() -> Figure:
        from pearlbvp.figures.mesh import draw_mesh

        counted = f"{title}: {surface.count} nodes, {len(surface.triangles)} triangles"
        return draw_mesh(units.surface(surface), title=counted, units=units)

    status = write(units.columns(table), None, plot, draw, others)
    if solve and abs(table["mu_crit"][0]) < DOUBTFUL * table["mu_error"][0]:
        say("mu_crit is not much larger than mu_error, so n_unstable is not certain; give more --nodes")
    return status


DOUBTFUL = 3.0
"""Growth rates by their error, below which their sign is not certain."""


def _refuse_idle(given: set[str]) -> None:
    """Refuse options that say nothing beside others, or too few.

    Raises:
        InputError: the first of them, and what to do.
    """
    if "source" in given:
        for name in sorted(given & {"c0", "length"}):
            raise InputError(f"--{name}", "a saved branch has its own", "leave it out with --from")
        return
    if "length" not in given:
        raise InputError(
            "--length, --from", "neither is given", "give the length of a straight tube, or a saved branch"
        )
    if "point" in given:
        raise InputError("--point", "it is one of a saved branch", "give that with --from")
    if "solve" in given:
        raise InputError("--solve", "the straight tube is an equilibrium at any pressure", "give a shape with --from")


def _of_a_point(at: Any, nodes: int, kind: Any, solve: bool, fix: str | None, bar: Any) -> tuple[Any, pd.DataFrame]:
    """Mesh and row of a point of a branch; ``bar`` shows two steps of its equilibrium."""
    from pearlbvp.studies.mesh import equilibrium_table, mesh_table, meshed, shape_mesh

    if not solve:
        own = at.problem.own_mesh(at.u) is not None
        surface = shape_mesh(at, nodes)
        return surface, mesh_table(surface, at.observables["c0"], at.problem.kind if own else kind)
    bar.set_description("equilibrium")
    problem, u = meshed(at, nodes, kind=kind, fix=fix)
    bar.update()
    bar.set_description("growth rates")
    table = equilibrium_table(problem, u)
    bar.update()
    return problem.surface(u), table
