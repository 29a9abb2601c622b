"""``pearlbvp scan``: any question over many tubes, each finished case kept in a store."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from pearlbvp.commands.arguments import File, Number, Numbers, Written
from pearlbvp.commands.command import Command, of_this_command
from pearlbvp.commands.output import (
    DONE,
    INTERRUPTED,
    PICTURES,
    SOME_FAILED,
    check_distinct,
    check_ending,
    print_table,
    radius_option,
    write_table,
)
from pearlbvp.commands.units import enter_units
from pearlbvp.errors import InputError
from pearlbvp.messages import say
from pearlbvp.scans.questions import QUESTIONS, Question

if TYPE_CHECKING:
    from pearlbvp.scans.store import Store
    from pearlbvp.units import Units

TABLES = (".csv", ".parquet", ".json")


class Words(Numbers):
    """Numbers, or a word instead of them."""

    def __init__(self, quantity: str, word: str) -> None:
        super().__init__(quantity)
        self.word = word

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Parse the text."""
        return value if value == self.word else super().convert(value, param, ctx)


OPTIONS: Mapping[str, Callable[[Any], Any]] = {
    "c0": click.option("--c0", type=Numbers("c0"), required=True, help="Spontaneous curvatures."),
    "L": click.option("--lengths", "L", type=Numbers("length"), required=True, metavar="NUMBERS", help="Tube lengths."),
    "period": click.option(
        "--period", type=Words("period", "critical"), required=True, metavar="NUMBERS|critical",
        help="Periods of the pearls, or that of the pearls that each tube loses its stability to.",
    ),
    "pearls": click.option("--pearls", type=Numbers(), default="2,3,4,6,8,16", show_default=True, help="On the tube."),
    "family": click.argument("family"),
    "mode": click.option("--mode", required=True, metavar="m,n", help="Waves along and around the tube."),
    "growth L": click.option(
        "--lengths", "L", type=Words("length", "any"), default="any", show_default=True, metavar="NUMBERS|any",
        help="Tube lengths; on any, waves of all lengths fit.",
    ),
    "lambda1": click.option("--tension", "lambda1", type=Numbers("tension"), required=True, metavar="NUMBERS",
                            help="Of the straight tube, like 1e-3mN/m; numbers are lambda1, by Sigma R^2/(2 kappa)."),
    "viscosity_ratio": click.option("--viscosity-ratio", type=Numbers(), default="1", show_default=True, metavar="NUMBERS",
                                    help="Viscosities of the fluid inside, by that of the fluid outside."),
    "membrane_viscosity": click.option("--membrane-viscosity", type=Numbers("membrane_viscosity"), default="0",
                                       show_default=True, metavar="NUMBERS",
                                       help="Of the membrane, like 5e-9Pa.s.m; without --viscosity by that of the fluid "
                                       "outside, a length."),
    "v": click.option("--volumes", "v", type=Numbers(), required=True, metavar="NUMBERS", help="Reduced volumes."),
}  # fmt: skip
"""Options by the names of questions' parameters, with the question where it has one of its own."""

VISCOSITY = click.option(
    "--viscosity", metavar="ETA", help="Of the fluid outside, like 1mPa.s: rates of growth are in 1/s."
)
"""For what is written of a question in fluids."""

IN_UNITS = ("c0", "L", "period", "lambda1", "membrane_viscosity")
"""Parameters that the user's unit changes."""


STORE = click.option("--store", type=File(), metavar="FILE.sqlite", required=True,
                     help="Keeps the cases; made where there is none.")  # fmt: skip
EXPORTS = (
    click.option("--plot", type=File(), metavar="FILE.png", help="Draw a picture of what is finished."),
    click.option("--columns", metavar="NAME,NAME", help="Write these columns of the table, in this order.  [default: all]"),
    click.option("--export", "--out", type=File(), metavar="FILE.csv|.parquet",
                 help="Write the table of what is finished, in the order of the cases."),
)  # fmt: skip
ENGINES = (
    click.option("--seconds", type=Number(), help="That a continuation may take.  [default: as long as it needs]"),
    click.option("--scheduler", metavar="tcp://HOST:PORT", help="Compute on a Dask cluster."),
    click.option("--workers", metavar="N|dask:N", help="Processes on this machine.  [default: one a core]"),
)


def decorated(command: Any, *decorators: Any) -> Any:
    """A command with options, the last first."""
    for decorate in decorators:
        command = decorate(command)
    return command


class Scan(click.Group):
    """The group of all questions; alone, it looks at a store."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a question's command, or the group's own, in the words of the command line."""
        try:
            enter_units(ctx)
            return super().invoke(ctx)
        except InputError as error:
            raise of_this_command(error) from None


def look(
    context: click.Context,
    store: Path | None,
    status: bool,
    retry: str | None,
    export: Path | None,
    plot: Path | None,
    columns: str | None,
    question: str | None,
    viscosity: str | None,
    workers: str | None,
    scheduler: str | None,
    seconds: float | None,
    units: Units,
) -> int | None:
    """Ask one question of many tubes, on all cores or a cluster, and keep each finished case.

    Interrupt it, even by a power cut, and run the same again: it goes on. Other values of the parameters are added
    to those that are there. Without a question it looks at a store, also while a scan is at work on it.
    """
    if context.invoked_subcommand is not None:
        for param in context.command.params:
            if context.get_parameter_source(str(param.name)) is ParameterSource.COMMANDLINE:
                name = context.invoked_subcommand
                raise InputError(
                    param.opts[0], f"it stands before {name}, which would not see it", f"give it behind {name}"
                )
        return None
    if store is None:
        raise InputError("--store", "give the file of a scan, or a question to ask", "see --help")
    from pearlbvp.scans.store import Store

    checked(export, plot)
    with Store(store, writing=retry is not None, name="--store") as kept:
        if not (export or plot or retry):
            for asked in _questions(kept, question):
                _say_status(kept, asked)
            return DONE
        asked, *others = _questions(kept, question)
        if others:
            names = ", ".join(one.name for one in (asked, *others))
            raise InputError("--question", f"the store holds {names}", "say which")
        units = _of_question(asked, units, viscosity)
        chosen = _chosen(asked, columns)
        result = DONE
        if retry is not None:
            from pearlbvp.scans.scan import engine_of, scanned

            engine, count = engine_of(workers, scheduler)
            cases = kept.retry(asked.name, asked.settings)
            result = _interruptible(
                lambda: scanned(asked, cases, kept, engine, workers=count, seconds=seconds), len(cases)
            )
        if status:
            _say_status(kept, asked)
        return max(result, _written(asked, kept, None, export, plot, chosen, units, shown=False))


def _of_question(question: Question, units: Units, viscosity: str | None) -> Units:
    """The units of a question's table."""
    from pearlbvp.viscosity import in_fluids

    if question.fluids:
        return in_fluids(units, viscosity)
    if viscosity is not None:
        raise InputError("--viscosity", f"{question.name} has no rates of motions in fluids", "leave it out")
    return units


def _chosen(question: Question, columns: str | None) -> list[str]:
    """The columns that are to be written."""
    if columns is None:
        return list(question.columns)
    names = [name.strip() for name in columns.split(",")]
    for name in names:
        if name not in question.columns or names.count(name) > 1:
            why = f"{name} is there twice" if name in question.columns else f"{question.name} has no column {name!r}"
            raise InputError("--columns", why, f"choose of {', '.join(question.columns)}")
    return names


def _questions(store: Store, name: str | None) -> list[Question]:
    """The questions that a store has cases of, or the one that is asked for."""
    from pearlbvp.scans.questions import question_named

    names = store.questions()
    if not names:
        raise InputError("--store", f"{store.path} holds no cases yet")
    if name is not None and name not in names:
        raise InputError("--question", f"the store holds no {name}, but {', '.join(names)}")
    return [question_named(one) for one in ([name] if name else names)]


def _say_status(store: Store, question: Question) -> None:
    """Print how far a scan is."""
    found = store.progress(question.name, question.settings)
    counts = ", ".join(f"{count} {name}" for name, count in found.counts.items() if count)
    click.echo(f"{question.name}: {counts or 'no cases of this version'}")
    if found.running:
        left = "" if found.seconds_left is None else f"; about {_duration(found.seconds_left)} left"
        click.echo(f"a scan is at work{left}")
    if found.others:
        click.echo(f"{found.others} cases of other versions of the package are left out")
    for case, message in found.failures:
        values = ", ".join(
            f"{name} = {value:g}" if isinstance(value, float) else f"{name} = {value}"
            for name, value in zip(question.parameters, case.parameters, strict=True)
        )
        click.echo(f"failed: {values}: {message}")


def _duration(seconds: float) -> str:
    minutes, hours = seconds / 60, seconds / 3600
    return f"{seconds:.0f} s" if minutes < 2 else f"{minutes:.0f} min" if hours < 2 else f"{hours:.1f} h"


def checked(export: Path | None, plot: Path | None) -> None:
    """Refuse files that cannot be written before anything is computed."""
    from pearlbvp.files import writable

    if export is not None and str(export) != "-":
        check_ending("--export", export, TABLES)
        writable("--export", export)
    check_ending("--plot", plot, PICTURES)
    if plot is not None:
        writable("--plot", plot)
    check_distinct({"--export": export, "--plot": plot})


def _interruptible(work: Callable[[], object], total: int) -> int:
    """Do it, and say what an interruption leaves; the exit status."""
    try:
        work()
    except KeyboardInterrupt:
        say(f"interrupted: what is finished of {total} cases is kept; run the same again to go on", begin="")
        return INTERRUPTED
    return DONE


def _written(
    question: Question,
    store: Store,
    cases: Any,
    export: Path | None,
    plot: Path | None,
    chosen: list[str],
    units: Units,
    *,
    shown: bool,
) -> int:
    """Write the table and the picture of what is finished; the exit status says whether cases failed."""
    from pearlbvp.scans.scan import table_of

    if not (shown or export or plot):
        return DONE
    table = units.columns(table_of(question, store, cases))
    if export is not None and str(export) != "-":
        write_table("--export", export, table[chosen])
    elif shown or export is not None:
        print_table(table[chosen])
    if plot is not None:
        from pearlbvp.figures.canvas import save_figure
        from pearlbvp.figures.scan import draw_scan
        from pearlbvp.files import write_whole

        figure = draw_scan(table, question.name, question.parameters, question.drawn, units, role=question.role)
        write_whole("--plot", plot, lambda path: save_figure(figure, path))
    failed = int((table["status"] == "failed").sum())
    if failed:
        say(f"{failed} of {len(table)} rows failed; the message column says why")
    return SOME_FAILED if failed else DONE


def _told(value: float, units: Units) -> float:
    """A number in radii, without the rounding of units: a tube in nm is the same case as in um."""
    return float(f"{value:.13g}") if units.given else value


def _ask(question: Question) -> click.Command:
    """The command of a question."""

    def ask(
        store: Path,
        export: Path | None,
        plot: Path | None,
        columns: str | None,
        units: Units,
        workers: str | None,
        scheduler: str | None,
        seconds: float | None,
        viscosity: str | None = None,
        **parameters: Any,
    ) -> int:
        from pearlbvp.scans.scan import cases_of, engine_of, scanned
        from pearlbvp.scans.store import Store

        checked(export, plot)
        units, chosen = _of_question(question, units, viscosity), _chosen(question, columns)
        for name in parameters:
            if isinstance(parameters[name], Written):  # a time's unit is that of motions in fluids
                parameters[name] = Numbers(name).read(parameters[name], units, f"--{name.replace('_', '-')}")
            if name in IN_UNITS and not isinstance(parameters[name], str):
                parameters[name] = [_told(units.from_user(name, value), units) for value in parameters[name]]
        if "family" in parameters:
            parameters["mode"] = parameters["mode"].replace(",", ":")
        cases = cases_of(question, parameters)
        engine, count = engine_of(workers, scheduler)
        with Store(store, writing=True, name="--store") as kept:
            left = kept.ask(cases, question.settings)

            def work() -> None:
                scanned(question, left, kept, engine, workers=count, seconds=seconds, total=len(cases))

            status = _interruptible(work, len(cases))
            return max(status, _written(question, kept, cases, export, plot, chosen, units, shown=True))

    ask.__doc__ = f"{question.says}\n\n    Columns: {', '.join(question.columns)}."
    own = [OPTIONS.get(f"{question.name} {name}") or OPTIONS[name] for name in reversed(question.parameters)]
    fluids = [VISCOSITY] if question.fluids else []
    command = decorated(ask, radius_option, *fluids, *EXPORTS, *ENGINES, STORE, *own)
    example = f"Example:  pearlbvp scan {question.example}"
    made: click.Command = click.command(question.name, cls=Command, epilog=example)(command)
    return made


scan: click.Group = click.group(
    "scan",
    cls=Scan,
    invoke_without_command=True,
    epilog="Examples:  pearlbvp scan localized --c0 0.26:0.49:0.01 --period critical --lengths 15:300:7.5 "
    "--store scan.sqlite --workers 8  |  pearlbvp scan --store scan.sqlite --export scan.csv --plot scan.png  |  "
    "pearlbvp scan --store scan.sqlite --retry failed",
)(
    decorated(
        click.pass_context(look),
        radius_option,
        VISCOSITY,
        *EXPORTS,
        *ENGINES,
        click.option("--question", metavar="NAME", help="Which of those that the store holds."),
        click.option("--retry", type=click.Choice(["failed"]), help="Compute those again that failed."),
        click.option(
            "--status", is_flag=True, help="How many cases are done, why others failed, how long the rest takes."
        ),
        click.option("--store", type=File(), metavar="FILE.sqlite", help="Of the scan."),
    )
)
for _question_asked in QUESTIONS.values():
    scan.add_command(_ask(_question_asked))
