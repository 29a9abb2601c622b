"""``pearlbvp flow``."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pearlbvp.commands.arguments import FamilyName, File, ModeNumbers, Number
from pearlbvp.commands.command import Command, Option, options_given, words_of_this_command
from pearlbvp.commands.output import (
    DONE,
    INTERRUPTED,
    SOME_FAILED,
    check_distinct,
    check_ending,
    check_outputs,
    outputs,
    radius_option,
    write,
)
from pearlbvp.errors import InputError
from pearlbvp.messages import say

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pearlbvp.units import Units

GIVEN = ("profile", "mesh", "resume")
"""Starts that are shapes as they are, which nothing perturbs and no branch leads to."""

BUMP = -0.125
"""Size of the perturbation where none is given, in radii."""


@click.command(
    cls=Command,
    epilog="Examples:  pearlbvp flow --from b.h5 --point A2 --perturb bump --delta -0.125 --out f.csv --plot f.png  |  "
    "pearlbvp flow --from b.h5 --point v=1.02 --perturb critical --delta 0.02 --keep --movie f.gif  |  "
    "pearlbvp flow --family buckle --c0 0 --length 10 --point C --perturb critical --delta 0.3 --plot c.png  |  "
    "pearlbvp flow --resume f.h5 --time 100 --save-end e.h5  |  "
    "pearlbvp flow --from b.h5 --point A2 --nodes 2000 --out f.csv  |  "
    "pearlbvp flow --mesh tube.ply --c0 0 --length 10 --time 5 --movie f.gif  |  "
    "pearlbvp flow --c0 0 --length 0.5 --radius 0.05 --point v=1.1 --delta=-0.005 --out f.csv",
)
@click.option("--from", "source", cls=Option, excludes=("resume",), type=File(), metavar="FILE.h5",
              help="A saved branch of any family.")  # fmt: skip
@click.option("--family", cls=Option, excludes=(*GIVEN, "source"), type=FamilyName(), default="pearl", show_default=True,
              help="Without --from: the branch that is followed to --point NAME=VALUE.")  # fmt: skip
@click.option("--c0", cls=Option, excludes=("source", "resume"), type=Number("c0"),
              help="Without --from: spontaneous curvature.")  # fmt: skip
@click.option("--length", cls=Option, excludes=("source", "resume"), type=Number("length"), metavar="L",
              help="Without --from: axial period of the tube.")  # fmt: skip
@click.option("--mode", cls=Option, excludes=(*GIVEN, "source"), type=ModeNumbers(),
              help="Without --from: waves along and around the tube.")  # fmt: skip
@click.option("--profile", cls=Option, excludes=("source", "resume"), type=File(), metavar="FILE.csv",
              help="Start from radii instead: columns x and r of one period, with --c0 and --length.")  # fmt: skip
@click.option("--mesh", cls=Option, excludes=("source", "resume", "profile"), type=File(), metavar="FILE",
              help="Start from a triangulated tube instead, one period, with --c0 and --length: VTU, VTP, VTK, PLY, OBJ, STL, "
              "OFF or MSH, repaired where needed.")  # fmt: skip
@click.option("--pressure", cls=Option, needs=("profile", "mesh"), type=Number("pressure"),
              help="With --profile or --mesh, --law area: lambda2.  [default: 0]")  # fmt: skip
@click.option("--point", cls=Option, excludes=GIVEN, default="-1", show_default=True, metavar="K|NAME=VALUE|A2",
              help="The start: a point's number, a column's value, or a name of the paper.")  # fmt: skip
@click.option("--perturb", cls=Option, excludes=GIVEN, type=click.Choice(["bump", "critical", "none"]), default="bump",
              show_default=True, help="A bump, or the most unstable vector.")  # fmt: skip
@click.option("--delta", cls=Option, excludes=GIVEN, type=Number("delta"),
              help="Size of the perturbation.  [default: -0.125 R]")  # fmt: skip
@click.option("--xi", cls=Option, excludes=GIVEN, type=Number("xi"),
              help="The bump is 1/(1 + xi x^2), on tubes and meshes times cos(phi).  [default: 1/R^2]")  # fmt: skip
@click.option("--centre", cls=Option, excludes=GIVEN, type=Number("centre"),
              help="Axial position of the bump.  [default: 0]")  # fmt: skip
@click.option("--keep", cls=Option, excludes=GIVEN, is_flag=True,
              help="Move the perturbed shape back to the area and volume it had.")  # fmt: skip
@click.option("--law", cls=Option, excludes=("resume",), type=click.Choice(["area and volume", "area", "diffusion"]),
              default="area and volume", show_default=True,
              help="What is kept; area: at given pressure; diffusion: the H^-1 flow.")  # fmt: skip
@click.option("--tube", "symmetric", cls=Option, excludes=GIVEN, is_flag=True, flag_value=False, default=True,
              help="Let pearls flow among all tubes, not only axisymmetric ones.")  # fmt: skip
@click.option("--points", cls=Option, excludes=("resume",), type=click.IntRange(min=8),
              help="Of an axisymmetric shape.  [default: 128]")  # fmt: skip
@click.option("--size", cls=Option, excludes=GIVEN, type=ModeNumbers(),
              help="Waves of a tube, along and around.  [default: 12,12, of pearls 24,6]")  # fmt: skip
@click.option("--nodes", cls=Option, excludes=GIVEN, type=int, metavar="N",
              help="Let the shape flow as a triangulated tube of so many vertices.")  # fmt: skip
@click.option("--discretization", cls=Option, excludes=("resume",), type=click.Choice(["subdivision", "cotangent"]),
              help="Of a triangulated tube.  [default: subdivision]")  # fmt: skip
@click.option("--time", "until", type=Number("t"), help="Stop at that time.")
@click.option(
    "--velocity",
    type=Number("velocity"),
    default=1e-6,
    show_default="1e-6 / R^3",
    help="A stable shape slower than this rests.",
)
@click.option("--max-seconds", type=Number(), default=600.0, show_default=True, help="Give up after so long.")
@click.option("--save", type=File(), metavar="FILE.h5", help="Save the flow, also on the way.")
@click.option("--save-end", type=File(), metavar="FILE.h5",
              help="Save the shape it rests on as a branch of one point, for pearlbvp resume.")  # fmt: skip
@click.option("--resume", type=File(), metavar="FILE.h5", help="Go on from a saved flow.")
@click.option("--movie", type=File(), metavar="FILE.gif", help="Write a movie.")
@outputs
@radius_option
def flow(
    source: Path | None,
    resume: Path | None,
    save: Path | None,
    save_end: Path | None,
    movie: Path | None,
    out: Path | None,
    plot: Path | None,
    until: float | None,
    velocity: float,
    max_seconds: float,
    units: Units,
    **start: Any,
) -> int:
    """Let a perturbed shape of a branch flow at fixed area and volume, until it rests on a stable shape.

    Columns: t, E, lambda1, lambda2, area_error, volume_error (relative changes), velocity (the largest along the normal), v,
    amplitude, r_min, r_max, area (by that of the straight tube), v_reduced, M, force; a row for every accepted step, and a
    second one at the same time where the shape is refined or remeshed. A perturbed shape has another area than the
    branch's: it is similar to one of area 1 on a tube of length L/area with c0 times area, whose v is v_reduced = v/area^2;
    compare that with pearlbvp branch. How the flow ends goes to standard error: on which shape it rests, and how stable
    that is to all perturbations of this tube.

    A bump is 1/(1 + xi x^2) times cos(phi) on --tube, --nodes and all but pearls; pearls as graphs have it without
    cos(phi), so their start is another one.

    By --law area, E + lambda2 V falls and E may rise, and volume_error is the volume's real change.

    With --radius all that is given and written is in its unit: the velocity is -dF, of dimension 1/length^3, so times have
    that of length^4 (by --law diffusion of length^6); with --kappa the velocity is a pressure, and times count in nm/Pa.
    """
    from pearlbvp.files import writable, write_whole
    from pearlbvp.studies import saved

    given, branch = options_given(click.get_current_context()), None
    if source is not None:
        branch = saved.load(source, "--from")
        start["family"] = saved.family_of(branch)
    _in_radii(given, start, units)
    out, plot = check_outputs(out, plot)
    save = None if save is None else writable("--save", save)
    check_ending("--movie", movie, (".gif",))
    movie = None if movie is None else writable("--movie", movie)
    save_end = None if save_end is None else writable("--save-end", save_end)
    read = {"--from": source, "--resume": resume, "--profile": start["profile"], "--mesh": start["mesh"]}
    written = {"--out": out, "--plot": plot, "--movie": movie, "--save-end": save_end}
    for outputs_and_inputs in ({**read, **written}, {"--from": source, **written, "--save": save}):
        check_distinct(
            {name: None if p is None else Path(os.path.realpath(p)) for name, p in outputs_and_inputs.items()}
        )
    from pearlbvp.flows.driver import NEXT, FlowOptions, resumed
    from pearlbvp.flows.driver import start as beginning
    from pearlbvp.progress import progress
    from pearlbvp.studies import flow as study

    with progress("step") as bar:

        def checkpoint(state: Any) -> None:
            bar.set_postfix(t=units.text("t", state.t, ".5g"), refresh=False)
            bar.update(len(state.record.rows["t"]) - bar.n)
            if save is not None:
                with contextlib.suppress(InputError):  # on a full disk, which may have room again
                    study.save(state, save, "--save", units)

        if resume is not None:
            state = study.load(resume, "--resume")
        else:
            problem, q = _start(branch, **start)
            try:
                state = beginning(problem, q)
            except InputError as error:  # of the shape, which the user knows as where it comes from
                raise (error.named(_origin(start)) if error.argument == "q" else error) from None
        units = units.of_flow(state.problem.law)
        settings: dict[str, Any] = {
            "velocity": _rate(units, "velocity", velocity) if "velocity" in given else velocity,
            "max_seconds": max_seconds,
            "checkpoint": checkpoint,
            "every": 2.0,
        }
        if until is not None:
            settings["until"] = _rate(units, "t", until, "until")
            if settings["until"] <= state.t * (1 + NEXT):
                now = units.text("t", state.t)
                raise InputError("--time", f"the saved flow is at t = {now} already", "give a later time")
        result = resumed(state, FlowOptions(**settings))
    table = result.state.columns(units)
    end = cache(lambda: _end(result, save_end, units))  # which takes a while: after the table is written

    def write_tables(path: Path) -> None:
        from pearlbvp.figures.movie import write_movie

        write_movie(result.state, path, units=units)

    def draw() -> Figure:
        from pearlbvp.figures.flow import draw_flow

        return draw_flow(result.state, table, units=units)

    others: list[Callable[[], object]] = []
    if save is not None:
        others.append(lambda: study.save(result.state, save, "--save", units))
    if save_end is not None:
        others.append(lambda: None if end()[0] is None else saved.save(end()[0], save_end, "--save-end", units))
    if movie is not None:
        others.append(lambda: write_whole("--movie", movie, write_tables))
    write(table, out, plot, draw, others)
    advice = f"; {result.advice}" if result.advice else ""
    say(f"{result.status}: {words_of_this_command(units.said(result.reason) + advice)}")
    branch, words = end()
    if words:
        say(words)
    if result.status == "interrupted":
        return INTERRUPTED
    return DONE if result.complete and (save_end is None or branch is not None) else SOME_FAILED


def _rate(units: Units, quantity: str, value: str | float, argument: str = "velocity") -> float:
    """A positive time or velocity of a flow, whose law the units know, in radii."""
    from pearlbvp.helfrich import positive

    return units.from_user(quantity, positive(argument, units.number(quantity, value, argument)))


def _origin(start: dict[str, Any]) -> str:
    """Where a flow's first shape is from, as it was typed."""
    return next((f"--{name}: {start[name]}" for name in ("profile", "mesh") if start[name] is not None), "--point")


def _in_radii(given: set[str], start: dict[str, Any], units: Units) -> None:
    """Turn lengths and their powers in the options of a start into those of a tube of radius 1; defaults are in radii."""
    for name in given & {"c0", "length", "delta", "centre", "xi", "pressure"}:
        start[name] = units.from_user(name, start[name])
    start["point"] = units.place_from_user(start["point"])
    start["units"] = units


def _end(result: Any, save_end: Path | None, units: Units) -> tuple[Any, str]:
    """What a flow rests on, as a branch of one point, and its stability to all perturbations, in words.

    Returns:
        The branch, or None where the end is no point of one; words, which say that where it matters.
    """
    from pearlbvp.studies.flow_end import described, end_branch, similarity

    try:
        branch = end_branch(result)
    except InputError as error:  # an end that is no point of a branch: the flow's own word stands
        said = error.worded(units.said)
        if save_end is not None:
            return None, str(said.named("--save-end"))
        rests = result.equilibrium is not None and result.equilibrium.converged
        return None, said.why if rests else ""
    spectrum = branch.points[0].spectrum
    counted = f"n_unstable = {spectrum.n_unstable}"
    if result.state.problem.law != "diffusion":  # whose equilibria are stable alike, but at other rates
        rate = similarity(result.equilibrium).to_user("mu_crit", spectrum.mu_crit)
        counted += f", mu_crit = {units.text('mu_crit', rate, '.4g')} ({spectrum.critical})"
    return branch, f"{described(result.equilibrium)}; to all perturbations of this tube: {counted}"


def _start(
    branch: Any, *, family: str, c0: float | None, length: float | None, mode: tuple[int, int] | None, point: str,
    perturb: Any, delta: float | None, xi: float | None, centre: float | None, keep: bool, profile: Path | None,
    mesh: Path | None, points: int | None, pressure: float | None, law: Any, discretization: Any, units: Units,
    **tube: Any,
) -> tuple[Any, Any]:  # fmt: skip
    """Problem and coordinates of the start."""
    shape = profile or mesh
    if c0 is None or length is None:
        if shape is not None:
            raise InputError(
                f"--{'mesh' if profile is None else 'profile'}", "it goes with --c0 and --length", "give both"
            )
        if branch is None:
            raise InputError("--c0, --length", "give both, or a saved branch with --from")
    how = {"law": law, "points": points, "discretization": discretization}
    if shape is not None:
        from pearlbvp.helfrich import Tube
        from pearlbvp.studies.flow_shape import read_profile, shape_start
        from pearlbvp.studies.flow_start import known_points

        given = Tube(c0, length)  # type: ignore[arg-type]
        if profile is None:
            from pearlbvp.mesh.files import read_surface

            surface, said = read_surface(shape, given.length, units, "--mesh")
            found: Any = surface
        else:
            found = read_profile("profile", shape, given.length, known_points(points), units)
            said = f"{shape.name}: {units.said(found.said)}" if found.said else ""
        if said:
            say(said)
        return shape_start(found, given, pressure=pressure, **how)
    from pearlbvp.studies.flow_start import solution_start
    from pearlbvp.studies.point import chosen

    if branch is None:
        branch, point = _followed(family, c0, length, mode, point), "-1"  # type: ignore[arg-type]
    start = solution_start(chosen(branch, point, family), **how, **tube)
    delta = BUMP if delta is None and perturb != "none" else delta
    return start.problem, start.perturbed(perturb, delta, xi=xi, centre=centre, keep=keep)


def _followed(family: str, c0: float, length: float, mode: tuple[int, int] | None, point: str) -> Any:
    """The branch of a family, to the point that is wanted of it.

    Raises:
        InputError: the point has no value, or is not reached.
    """
    from pearlbvp.helfrich import Tube, finite
    from pearlbvp.numbers import as_whole
    from pearlbvp.studies.branch import branch_options, family_branch
    from pearlbvp.studies.point import sample
    from pearlbvp.units import Sentence

    name, equals, value = point.partition("=")
    if not equals and as_whole(point) is not None:
        raise InputError("--point", "without --from, give NAME=VALUE, like v=1.02, for how far the branch is followed")
    stop = dict([(name, finite("point", value)) if equals else sample(family, c0, length, point)])  # type: ignore[arg-type]
    if stop.get("v") == 1:
        raise InputError(
            "--point",
            "v=1 is the straight tube, where the branch begins",
            "give a value on the branch, or save it with pearlbvp branch --save for --from and --point 0",
        )
    try:
        options = branch_options(stop)
    except InputError as error:
        raise error.named("point") from None
    branch = family_branch(Tube(c0, length), family, mode, options)
    if not branch.complete:
        (wanted, number), *_ = stop.items()
        place = Sentence(f"{wanted} = {{{wanted}:.9g}} is not reached (", **{wanted: number})
        advice = "follow the branch with pearlbvp branch --save, and give that with --from"
        raise InputError("--point", Sentence.joined(place, branch.reason, ")"), advice)
    return branch
