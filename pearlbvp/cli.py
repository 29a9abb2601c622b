"""The command line: parses arguments, calls studies, writes CSV and PNG. No mathematics.

Everything that takes time to import is imported by the command that needs it, so that ``--help`` answers at once.
"""

from __future__ import annotations

import importlib
import multiprocessing
import os
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pearlbvp._version import __version__
from pearlbvp.arguments import ModeNumbers, Number, Numbers, SpecialKind, Until
from pearlbvp.errors import InputError

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

DONE, SOME_FAILED, UNUSABLE, INTERRUPTED = 0, 1, 2, 130

_BLAS_THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def _outputs(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options that all commands with a table share."""
    for decorate in (
        click.option("--radius", type=Number(), default=1.0, show_default=True, metavar="R",
                     help="Radius of the straight tube, in the unit of all lengths given and written."),
        click.option("--plot", type=click.Path(path_type=Path), metavar="FILE.png", help="Draw a picture."),
        click.option("--out", type=click.Path(path_type=Path), metavar="FILE.csv",
                     help="Write the table there instead of on standard output."),
    ):  # fmt: skip
        command = decorate(command)
    return command


def _call(module: str, name: str, arguments: tuple[Any, ...]) -> Any:
    return getattr(importlib.import_module(module), name)(*arguments)


def _computed_aside(module: str, name: str, *arguments: Any, figures: str | None) -> Any:
    """The result of a study's function, from a second process, while this one loads pandas and matplotlib.

    Loading compiled code and loading the libraries for tables and pictures take about a second each.
    """
    method = "fork" if sys.platform.startswith("linux") else None  # elsewhere forking is not safe
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context(method)) as pool:
        future = pool.submit(_call, module, name, arguments)
        importlib.import_module("pandas")
        if figures is not None:
            importlib.import_module(figures)
        return future.result()


def _check_outputs(out: Path | None, plot: Path | None) -> tuple[Path | None, Path | None]:
    """Where table and picture are written, links resolved, before anything is computed for them."""
    from pearlbvp.files import writable

    out = None if out is None else writable("--out", out)
    plot = None if plot is None else writable("--plot", plot)
    if out is not None and out == plot and (out.is_file() or not out.exists()):
        raise InputError(f"--plot: {plot} is the table's file already; give the picture another name")
    return out, plot


def _write(table: pd.DataFrame, out: Path | None, plot: Path | None, draw: Callable[[], Figure]) -> int:
    """Write table and picture; the exit status says whether some rows failed."""
    from pearlbvp.files import write_whole

    if out is None:
        sys.stdout.write(table.to_csv(index=False, float_format="%.12g"))
        sys.stdout.flush()
    else:
        write_whole("--out", out, lambda path: table.to_csv(path, index=False, float_format="%.12g"))
    if plot is not None:
        from pearlbvp.figures.canvas import save_png

        figure = draw()
        write_whole("--plot", plot, lambda path: save_png(figure, path))
    failed = 0
    for column in ("status", "localized_status"):
        if column in table:
            failed = max(failed, int((table[column] == "failed").sum()))
    if failed:
        print(f"pearlbvp: {failed} of {len(table)} rows failed; the message column says why", file=sys.stderr)
    return SOME_FAILED if failed else DONE


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="pearlbvp")
def cli() -> None:
    """Bifurcations of Helfrich cylinders: membrane tubes of fixed area and volume.

    Lengths are in radii of the straight tube, E is the energy by area, lambda1 the tension, lambda2 the
    pressure difference. Lists of numbers: 15,30,45 or start:stop:step with both ends.
    """


@cli.command(epilog="Example:  pearlbvp dispersion --c0 0.48 --length 30")
@click.option("--c0", type=Number(), required=True, help="Spontaneous curvature.")
@click.option("--length", type=Number(), required=True, metavar="L", help="Axial period of the tube.")
@click.option("--max-m", type=int, help="Most waves along the tube.  [default: all pearls with k < 1 and two more]")
@click.option("--max-n", type=int, default=4, show_default=True, help="Most waves around the tube.")
@_outputs
def dispersion(
    c0: float, length: float, max_m: int | None, max_n: int, out: Path | None, plot: Path | None, radius: float
) -> int:
    """Branch points of the straight tube, and which of them end its stable interval.

    Columns: m, n (waves along and around), k, type, lambda2, lambda1, kernel (its dimension without
    translations), role (lower or upper: the ends of the interval in which the tube is stable).
    """
    from pearlbvp.helfrich import Tube, in_units_of_radius
    from pearlbvp.studies.dispersion import branch_points, instability_curves

    out, plot = _check_outputs(out, plot)
    tube = Tube.from_dimensional(c0, length, radius)
    table = branch_points(tube.c0, tube.length, max_m, max_n)

    def draw() -> Figure:
        from pearlbvp.figures.dispersion import draw_dispersion

        curves = instability_curves(tube.c0, max(1.6, float(table["k"].max())), int(table["n"].max()))
        return draw_dispersion(table, curves, f"c0 = {tube.c0:g}, L = {tube.length:g}")

    return _write(in_units_of_radius(table, radius), out, plot, draw)


@cli.command(
    epilog="Example:  pearlbvp localized --c0 0.48 --period 7.5 --lengths 15,30,45,60 --out t.csv --plot t.png"
)
@click.option("--c0", type=Number(), required=True, help="Spontaneous curvature.")
@click.option("--period", type=Number(), required=True, metavar="P", help="Axial period of the pearls, above 2 pi.")
@click.option("--lengths", type=Numbers(), required=True, help="Tube lengths, multiples of the period.")
@click.option("--compare", type=click.Path(path_type=Path), metavar="FILE.csv",
              help="Put this table's columns beside the rows that agree in c0, period and L; v_... is drawn too.")  # fmt: skip
@_outputs
def localized(
    c0: float,
    period: float,
    lengths: list[float],
    compare: Path | None,
    out: Path | None,
    plot: Path | None,
    radius: float,
) -> int:
    """Where periodic pearls give way to one localized pearl, for many lengths at once.

    Columns: c0, period, L, pearls, status, lambda1, lambda2, v, E, amplitude, message. Status is found,
    unstable_at_onset, none_in_range, no_stable_cylinder or failed.
    """
    from pearlbvp.helfrich import Tube, in_units_of_radius, positive

    out, plot = _check_outputs(out, plot)
    tube = Tube.from_dimensional(c0, positive("--period", period), positive("--radius", radius))
    reference = None
    if compare is not None:
        from pearlbvp.studies.reference import read_reference

        reference = read_reference(compare)
    rows = _computed_aside(
        "pearlbvp.studies.localized", "localized_rows", tube.c0, tube.length, [length / radius for length in lengths],
        figures="pearlbvp.figures.localized" if plot else None,
    )  # fmt: skip
    import pandas as pd

    table = in_units_of_radius(pd.DataFrame(rows), radius)
    if reference is not None:
        from pearlbvp.studies.reference import beside

        table = beside(table, reference)

    def draw() -> Figure:
        from pearlbvp.figures.localized import draw_localized

        return draw_localized(table)

    return _write(table, out, plot, draw)


@cli.command(epilog="Example:  pearlbvp period --c0 0.48 --lengths 7.5:120:0.5 --out p.csv --plot p.png")
@click.option("--c0", type=Numbers(), required=True, help="Spontaneous curvature, one or several.")
@click.option("--lengths", type=Numbers(), required=True, help="Tube lengths.")
@click.option(
    "--volume", type=Number(), help="Find the number of equal pearls of least energy at this reduced volume, too."
)
@click.option("--processes", type=click.IntRange(min=1), help="How many to use.  [default: one a core]")
@_outputs
def period(
    c0: list[float],
    lengths: list[float],
    volume: float | None,
    processes: int | None,
    out: Path | None,
    plot: Path | None,
    radius: float,
) -> int:
    """The pearl period that appears on a tube, its stable range, and where a localized pearl takes over.

    Columns: c0, L, pearls, period, k, status, lambda2_pearl and lambda2_upper (ends of the straight tube's
    stable interval), upper_mode (m:n), v_localized, localized_status, message.
    """
    from pearlbvp.helfrich import Tube, in_units_of_radius
    from pearlbvp.studies.period import pearl_periods

    out, plot = _check_outputs(out, plot)
    scaled = [[Tube.from_dimensional(value, length, radius) for length in lengths] for value in c0]
    table = pearl_periods(
        [tubes[0].c0 for tubes in scaled], [tube.length for tube in scaled[0]], v=volume, processes=processes
    )
    table = in_units_of_radius(table, radius)

    def draw() -> Figure:
        from pearlbvp.figures.period import draw_periods

        return draw_periods(table)

    status = _write(table, out, plot, draw)
    return INTERRUPTED if len(table) < len(c0) * len(lengths) else status


@cli.command(epilog="Example:  pearlbvp region --c0 0.48 --periods 6.6:10:0.1 --pearls 2,4,8 --out r.csv --plot r.png")
@click.option("--c0", type=Number(), required=True, help="Spontaneous curvature.")
@click.option("--periods", type=Numbers(), required=True, help="Axial periods of one pearl, above 2 pi.")
@click.option(
    "--pearls", type=Numbers(), default="2,3,4,6,8,16", show_default=True, help="Numbers of pearls on the tube."
)
@_outputs
def region(
    c0: float, periods: list[float], pearls: list[float], out: Path | None, plot: Path | None, radius: float
) -> int:
    """Where periodic pearls are stable, in the plane of period and volume.

    Columns: those of `localized`, a row for each period and number of pearls. Where status is found, the pearls
    are stable from v = 1 to the v of the row.
    """
    from pearlbvp.helfrich import Tube, in_units_of_radius
    from pearlbvp.studies.region import stability_region

    out, plot = _check_outputs(out, plot)
    tubes = [Tube.from_dimensional(c0, period, radius) for period in periods]
    table = in_units_of_radius(stability_region(tubes[0].c0, [tube.length for tube in tubes], pearls), radius)

    def draw() -> Figure:
        from pearlbvp.figures.region import draw_region

        return draw_region(table)

    return _write(table, out, plot, draw)


@cli.command(
    epilog="Examples:  pearlbvp branch pearl --c0 0 --length 10 --until v=1.3 --save b.h5 --plot b.png  |  "
    "pearlbvp branch pearl --resume b.h5 --until v=1.34  |  "
    "pearlbvp branch pearl --resume b.h5 --switch 1 --centre neck --until v=1.2  |  "
    "pearlbvp branch pearl --c0 0.75 --length 10 --shape=-0.3,0.5 --volume 1.0 --until v=1.1"
)
@click.argument("family", type=click.Choice(["pearl"]))
@click.option("--c0", type=Number(), help="Spontaneous curvature.")
@click.option("--length", type=Number(), metavar="L", help="Axial period of the tube.")
@click.option("--mode", type=ModeNumbers(), default="1,0", show_default=True, help="Waves along and around the tube.")
@click.option(
    "--shape",
    type=Numbers(),
    metavar="A1,A2,..",
    help="Start from the shape of least energy near r = 1 + sum of A_k cos(2 pi k x / L), at --volume.",
)
@click.option("--volume", type=Number(), help="With --shape: its reduced volume.")
@click.option(
    "--cells",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="With --shape: periods on the tube that stability is judged on; L is that of one.",
)
@click.option("--until", type=Until(), multiple=True, help="Stop exactly there; the first reached counts.")
@click.option(
    "--max-points", type=click.IntRange(min=2), default=200, show_default=True, help="End after so many more."
)
@click.option("--step", type=Number(), help="First step along the branch.  [default: 0.1, or the largest]")
@click.option("--max-step", type=Number(), default=0.5, show_default=True, help="Largest step along the branch.")
@click.option("--tolerance", type=Number(), default=1e-9, show_default=True, help="Error of the profile.")
@click.option("--pressure", is_flag=True, help="Stability at fixed area and given pressure, not fixed volume.")
@click.option("--save", type=click.Path(path_type=Path), metavar="FILE.h5", help="Save the whole branch.")
@click.option("--resume", type=click.Path(path_type=Path), metavar="FILE.h5", help="Go on from a saved branch.")
@click.option("--switch", type=int, metavar="K", help="With --resume: follow the branch at its K-th bp instead.")
@click.option("--centre", type=click.Choice(["pearl", "neck"]), default="pearl", show_default=True,
              help="With --switch: what the new shapes are centred on.")  # fmt: skip
@click.option("--vary", type=click.Choice(["c0", "L"]), help="With --resume: vary this from a point on, at fixed v.")
@click.option(
    "--follow",
    type=SpecialKind(),
    metavar="KIND:K",
    help="With --vary: follow this fold or branch point (fold:v:1, bp:2) instead, in both parameters.",
)
@click.option(
    "--keep", type=click.Choice(["v", "lambda2"]), default="v", show_default=True, help="With --vary: what stays."
)
@click.option("--point", type=int, default=-1, help="With --vary: from which point.  [default: the last]")
@click.option("--down", is_flag=True, help="With --vary: towards smaller values.")
@click.option("--shrink", is_flag=True, help="With --switch: the half on which the tube shrinks at its centre.")
@_outputs
def branch(
    family: str,
    c0: float | None,
    length: float | None,
    mode: tuple[int, int],
    shape: list[float] | None,
    volume: float | None,
    cells: int,
    until: tuple[tuple[str, float], ...],
    max_points: int,
    step: float | None,
    max_step: float,
    tolerance: float,
    pressure: bool,
    save: Path | None,
    resume: Path | None,
    switch: int | None,
    centre: str,
    vary: str | None,
    follow: tuple[str, int] | None,
    keep: str,
    point: int,
    down: bool,
    shrink: bool,
    out: Path | None,
    plot: Path | None,
    radius: float,
) -> int:
    """Follow a branch of shapes, with its special points and the stability of every point.

    Columns: point, special (start, bp, fold:NAME, cmc, stop, end), lambda1, lambda2, v, E, amplitude, r_min,
    r_max, n_unstable, mu_crit (largest growth rate over all perturbations that fit the tube), critical (its n,
    and its wave number j per periods on the tube), c0, L.
    """
    from pearlbvp.files import writable
    from pearlbvp.helfrich import LENGTH_POWER, Tube, in_units_of_radius

    out, plot = _check_outputs(out, plot)
    save = None if save is None else writable("--save", save)
    if resume is None and (c0 is None or length is None):
        raise InputError("--c0, --length: give both, or --resume a saved branch")
    if resume is not None and (c0 is not None or length is not None):
        raise InputError("--resume: the saved branch has its own c0 and length; leave --c0 and --length out")
    if (switch is not None or vary is not None) and resume is None:
        raise InputError("--switch, --vary: they need --resume, the saved branch that they start from")
    if follow is not None and save is not None:
        raise InputError("--save: a curve in two parameters cannot be saved; write its table with --out")
    if switch is not None and vary is not None:
        raise InputError("--switch, --vary: choose one of them")
    if (shape is None) != (volume is None) or (shape is not None and resume is not None):
        raise InputError("--shape, --volume: give both, with --c0 and --length and without --resume")
    given = _given(click.get_current_context())
    for needed, options_of_it in _BRANCH_OPTIONS.items():
        unused = sorted(given & options_of_it)
        if needed not in given and unused:
            raise InputError(f"--{unused[0]}: it goes with --{needed}; give that too, or leave it out")
    unused = sorted(given & {"mode", "tolerance", "pressure"})
    if resume is not None and unused:
        raise InputError(f"--{unused[0]}: the saved branch has its own; leave it out")
    if mode[1] != 0:
        raise InputError(f"--mode: pearls have n = 0, so {mode[0]},{mode[1]} is none of them; give {max(mode[0], 1)},0")
    from tqdm import tqdm

    from pearlbvp.studies import branch as study

    wanted = {name: value / radius ** LENGTH_POWER.get(name, 0) for name, value in until}
    with tqdm(unit="point", disable=None) as bar:
        checkpoint = _Checkpoint(save)

        def progress(so_far: Any) -> None:
            bar.set_postfix(v=f"{so_far.points[-1].observables['v']:.5f}", refresh=False)
            bar.update(len(so_far.points) - bar.n)
            checkpoint(so_far)

        options = study.branch_options(wanted, max_points=max_points, step=step, max_step=max_step, progress=progress)
        fixed: Any = "area" if pressure else "area and volume"
        if shape is not None:
            tube = Tube.from_dimensional(c0, length, radius)  # type: ignore[arg-type]
            scaled = [amplitude / radius for amplitude in shape]
            found = study.shape_branch(
                tube.c0, tube.length, volume or 0, scaled, options, cells=cells, tolerance=tolerance, fixed=fixed
            )
        elif resume is None:
            tube = Tube.from_dimensional(c0, length, radius)  # type: ignore[arg-type]
            found = study.pearl_branch(tube.c0, tube.length, mode[0], options, tolerance=tolerance, fixed=fixed)
        elif vary is not None and follow is not None:
            found = study.followed(study.load(resume), *follow, vary, options, upwards=not down)  # type: ignore[assignment]
        elif vary is not None:
            found = study.varied(study.load(resume), point, vary, options, keep=keep, upwards=not down)
        elif switch is None:
            found = study.resumed(study.load(resume), options)
        else:
            found = study.switched(study.load(resume), switch, options, centre=centre, grow=not shrink)  # type: ignore[arg-type]
    table = in_units_of_radius(found.table()[study.COLUMNS], radius)
    if save is not None:
        study.save(found, save)

    def draw() -> Figure:
        from pearlbvp.figures.branch import draw_branch

        return draw_branch(found, table)

    _write(table, out, plot, draw)
    if not found.complete:
        print(f"pearlbvp: the branch ends: {found.reason}", file=sys.stderr)
    if found.reason == "interrupted":
        return INTERRUPTED
    return SOME_FAILED if wanted and not found.complete else DONE


_BRANCH_OPTIONS = {
    "vary": {"keep", "point", "down", "follow"},
    "switch": {"centre", "shrink"},
    "shape": {"cells"},
}
"""Options of ``branch`` that say nothing without another."""


def _given(context: click.Context) -> set[str]:
    """Names of the options that stand on the command line."""
    source = click.core.ParameterSource.COMMANDLINE
    return {name for name in context.params if context.get_parameter_source(name) == source}


class _Checkpoint:
    """Saves the branch so far now and then, so that a run that is killed keeps its points."""

    def __init__(self, path: Path | None, seconds: float = 2.0) -> None:
        self.path, self.seconds, self.last = path, seconds, time.monotonic()

    def __call__(self, branch: Any) -> None:
        if self.path is not None and time.monotonic() - self.last > self.seconds:
            from pearlbvp.studies.branch import save

            save(branch, self.path)
            self.last = time.monotonic()


def main(arguments: list[str] | None = None) -> None:
    """Run the command line and leave with its exit status: 0 done, 1 some rows failed, 2 unusable input."""
    for name in _BLAS_THREADS:  # before numpy is loaded: our matrices are small, threads only slow them down
        os.environ.setdefault(name, "1")
    try:
        status = _run(arguments)
        sys.stdout.flush()
    except BrokenPipeError:  # the reader of our standard output has had enough
        _drop_standard_output()
        status = DONE
    except OSError as error:
        print(f"pearlbvp: standard output: {error.strerror}; free space or use --out", file=sys.stderr)
        _drop_standard_output()
        status = UNUSABLE
    sys.exit(status)


def _run(arguments: list[str] | None) -> int:
    """The command's exit status; what a user did wrong is said in one line."""
    try:
        return int(cli.main(args=arguments, prog_name="pearlbvp", standalone_mode=False) or DONE)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        return UNUSABLE
    except click.ClickException as error:
        message = " ".join(error.format_message().split())
        print(f"pearlbvp: {message} (see --help)", file=sys.stderr)
        return UNUSABLE
    except InputError as error:
        print(f"pearlbvp: {error}", file=sys.stderr)
        return UNUSABLE
    except (click.Abort, KeyboardInterrupt):
        print("pearlbvp: interrupted", file=sys.stderr)
        return INTERRUPTED
    except SystemError as error:  # what an interruption inside compiled code turns into
        if not isinstance(error.__cause__ or error.__context__, KeyboardInterrupt):
            raise
        print("pearlbvp: interrupted", file=sys.stderr)
        return INTERRUPTED


def _drop_standard_output() -> None:
    """Let nothing more be written, so that the interpreter's own flush at exit cannot fail again."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
