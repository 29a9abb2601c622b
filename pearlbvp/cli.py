"""The command line: the group of all commands, and how a run ends. No mathematics.

Everything that takes time to import is imported by the command that needs it, so that ``--help`` answers at once.
"""

from __future__ import annotations

import contextlib
import shlex
import signal
import sys
from concurrent.futures.process import BrokenProcessPool

import click

from pearlbvp._version import __version__
from pearlbvp.commands.amplitude import amplitude, amplitude_map
from pearlbvp.commands.branch import branch
from pearlbvp.commands.diagram import diagram
from pearlbvp.commands.dispersion import dispersion
from pearlbvp.commands.drawing import draw_on_our_own_terms
from pearlbvp.commands.equilibria import equilibria
from pearlbvp.commands.explore import explore
from pearlbvp.commands.flow import flow
from pearlbvp.commands.growth import growth
from pearlbvp.commands.localized import localized
from pearlbvp.commands.mesh import mesh
from pearlbvp.commands.onward import follow, resume, switch, vary
from pearlbvp.commands.output import DONE, INTERRUPTED, SOME_FAILED, UNUSABLE
from pearlbvp.commands.period import period
from pearlbvp.commands.phases import phases
from pearlbvp.commands.region import region
from pearlbvp.commands.reproduce import reproduce
from pearlbvp.commands.scan import scan
from pearlbvp.commands.show import show
from pearlbvp.errors import InputError, interrupted
from pearlbvp.files import shortened
from pearlbvp.messages import drop, open_streams, say, why_not_written


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="pearlbvp")
def cli() -> None:
    """Bifurcations of Helfrich cylinders: membrane tubes of fixed area and volume.

    Lengths are in radii of the straight tube, E is the energy by area, lambda1 the tension, lambda2 the
    pressure difference. Lists of numbers: 15,30,45 or start:stop:step with both ends.
    """


for command in (
    dispersion, growth, amplitude, amplitude_map, localized, period, region, equilibria,
    branch, resume, switch, vary, follow, show, diagram, explore, phases, flow, mesh, scan, reproduce,
):  # fmt: skip
    cli.add_command(command)


def main(arguments: list[str] | None = None) -> None:
    """Run the command line and leave with its exit status: 0 done, 1 some rows failed, 2 unusable input."""
    draw_on_our_own_terms()
    with contextlib.suppress(ValueError):  # in a thread signals are not ours
        if signal.getsignal(signal.SIGINT) is signal.SIG_DFL:  # else whoever started us wants none
            signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGTERM, signal.default_int_handler)  # as by Ctrl-C, what was computed is written
    open_streams()
    try:
        status = _run(arguments)
        sys.stdout.flush()
    except BrokenPipeError:  # the reader of our standard output has had enough
        drop(sys.stdout)
        status = DONE
    except OSError as error:
        if error.filename is None:
            say(str(why_not_written(error)))
        else:
            say(f"{shortened(error.filename)}: {error.strerror or error}; free space or choose another place")
        drop(sys.stdout)
        status = UNUSABLE
    if arguments is None:
        # All is written: while the process and its workers end, an interruption would only leave a trace.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
    sys.exit(status)


def _run(arguments: list[str] | None) -> int:
    """The command's exit status; what a user did wrong is said in one line."""
    try:
        words = sys.argv[1:] if arguments is None else [str(word) for word in arguments]
        typed = shlex.join(["pearlbvp", *words])  # for the tables that it writes
        return int(cli.main(args=words, prog_name="pearlbvp", standalone_mode=False, obj=typed) or DONE)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        return UNUSABLE
    except click.ClickException as error:
        message = " ".join(error.format_message().split())
        say(f"{message} (see --help)")
        return UNUSABLE
    except InputError as error:
        say(str(error))
        return UNUSABLE
    except (click.Abort, KeyboardInterrupt, SystemError) as error:  # compiled code turns an interruption into the last
        if not interrupted(error):  # click takes the end of any file for one
            raise
        say("interrupted")
        return INTERRUPTED
    except (BrokenProcessPool, MemoryError) as error:
        what = "a process of it was killed" if isinstance(error, BrokenProcessPool) else "there is too little memory"
        say(f"{what}, perhaps for want of memory; ask for less at once")
        return SOME_FAILED
