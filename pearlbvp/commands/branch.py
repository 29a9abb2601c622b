"""``pearlbvp branch``."""

from __future__ import annotations

from typing import Any

import click

from pearlbvp.commands.arguments import FamilyName, ModeNumbers, Nodes, Number, Numbers, check_meshable
from pearlbvp.commands.command import Command, Option
from pearlbvp.commands.following import Following, fix_option, following, save_option


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp branch pearl --c0 0 --length 10 --until v=1.3 --save b.h5 --plot b.png  |  "
    "pearlbvp branch ring --c0=-1 --length 10 --mode 0,3 --plot r.png  |  "
    "pearlbvp branch coil --c0 0.48 --length 10 --until v=0.85 --save c.h5  |  "
    "pearlbvp branch coil --c0 0 --length 10 --nodes 1500 --until v=0.95 --save m.h5 --plot m.png  |  "
    "pearlbvp branch pearl --c0 0.3 --length 10 --fix tension,osmotic=50 --until v=1.1  |  "
    "pearlbvp branch pearl --c0 0.75 --length 10 --shape=-0.3,0.5 --volume 1.0 --until v=1.1",
)
@click.argument("family", type=FamilyName())
@click.option("--c0", type=Number("c0"), required=True, help="Spontaneous curvature.")
@click.option("--length", type=Number("length"), required=True, metavar="L", help="Axial period of the tube.")
@click.option(
    "--mode",
    type=ModeNumbers(),
    help="Waves along and around the tube.  [default: 1,0 for pearls, 0,2 for rings, 1,1 for coils and buckles]",
)
@click.option(
    "--nodes",
    type=Nodes(),
    metavar="N",
    help="Follow the branch on a triangulated tube of about N vertices.  [default: profiles or reduced modes]",
)
@click.option(
    "--discretization",
    cls=Option,
    needs=("nodes",),
    type=click.Choice(["subdivision", "cotangent"]),
    default="subdivision",
    show_default=True,
    help="With --nodes: the surface is the limit of Loop's subdivision, or the polyhedron.",
)
@click.option(
    "--tolerance",
    cls=Option,
    excludes=("nodes",),
    type=Number(),
    help="Error of the profile.  [default: 1e-9 for pearls, 1e-10 for rings]",
)
@click.option(
    "--shape",
    cls=Option,
    needs=("volume",),
    excludes=("nodes", "mode"),
    type=Numbers("shape"),
    metavar="A1,A2,..",
    help="Of pearls: start from the shape of least energy near r = 1 + sum of A_k cos(2 pi k x / L), at --volume.",
)
@click.option("--volume", cls=Option, needs=("shape",), type=Number(), help="With --shape: its reduced volume.")
@click.option(
    "--cells",
    cls=Option,
    needs=("shape",),
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="With --shape: periods on the tube that stability is judged on; L is that of one.",
)
@fix_option()
@click.option("--pressure", cls=Option, excludes=("fix",), is_flag=True, help="The same as --fix area,pressure.")
@save_option
@following
def branch(
    family: str,
    c0: float,
    length: float,
    mode: tuple[int, int] | None,
    nodes: int | None,
    discretization: Any,
    tolerance: float | None,
    shape: list[float] | None,
    volume: float | None,
    cells: int,
    fix: str,
    pressure: bool,
    **how: Any,
) -> int:
    """Follow a branch of pearls, rings, coils or buckles, with special points and the stability of every point.

    Columns: point, special (start, bp, fold:NAME, cmc, stop, end), lambda1, lambda2, v, E, amplitude, r_min,
    r_max, n_unstable, mu_crit (largest growth rate over all perturbations that fit the tube), critical (its n,
    and its wave number j per periods on the tube; of rings, coils and buckles its symmetry), c0, L, mu_error (of
    growth rates, as rigid motions show it), wave (2A of the largest wave cos(kx + n phi) of the surface over the straight tube,
    empty where the axis is not inside of it), M (integral of the mean curvature), force (along the axis, dE/dL at fixed
    area and volume), of coils torque (dE/d(twist)), with --fix osmotic=N osmolarity (lambda2 + N/V), with ade=ALPHA M0.

    With --fix tension the membrane comes from a reservoir, with pressure the water, with osmotic=N water only (N of solute
    stays inside, nRT/Vr by 2 kappa), with force the ends are pulled, not held, and ade=ALPHA adds area-difference elasticity:
    the same shapes, another stability.

    Special points are numbered from the branch's start (with --shape: from the shape, either way), as `switch`, `follow`
    and `show` number them, also where `resume` goes on.

    Exit status: 0, 1 where --until was not reached or something could not be computed (all points are written), 2 for input
    that cannot be used.

    Branches end where the surface touches itself; coils, buckles and what branches off from them where a section is no longer
    star-shaped. A saved branch goes on by `resume`, `switch`, `vary` and `follow`.

    With --nodes the surface is a mesh, which needs no sections; one to two seconds a point at 500, ten at 3000. Where mu_error
    is not small beside mu_crit, n_unstable is not certain; of the rest two numbers of nodes tell the error. Of subdivision
    surfaces at v = 0.95, 500 nodes give multipliers to 2e-3 and amplitudes to 1e-2, 3000 to 6e-5 and 1e-3; cotangents give 2e-2
    and 2e-1, 6e-3 and 3e-2. critical is symmetric, breaking or all; bp,bp are two that lead to one branch. Where the mesh is
    renewed, the branch jumps by the mesh's error.
    """
    asked = Following(**how).checked()
    tube = asked.units.tube(c0, length)
    fix = "area,pressure" if pressure else asked.units.fix(fix, tube.length * cells)
    waves = None if shape is None else [asked.units.from_user("shape", amplitude) for amplitude in shape]
    if nodes is not None:
        check_meshable(tube.length)

    def follow(options: Any) -> Any:
        from pearlbvp.studies.branch import asked_branch

        return asked_branch(
            tube, family, mode, options, shape=waves, volume=volume, cells=None if waves is None else cells,
            nodes=nodes, discretization=None if nodes is None else discretization, fix=fix, tolerance=tolerance,
        )  # fmt: skip

    return asked.run(follow, "" if waves is not None else "; the other half of this branch has the same shapes")
