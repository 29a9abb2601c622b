"""What all commands share that follow a branch: options, signs of life, saving on the way, what is written at the end."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pearlbvp.commands.arguments import File, Number, Until, wanted_places
from pearlbvp.commands.command import Option, words_of_this_command
from pearlbvp.commands.drawing import branch_figure, drawing, reference_of
from pearlbvp.commands.output import (
    DONE,
    INTERRUPTED,
    SOME_FAILED,
    check_distinct,
    check_outputs,
    outputs,
    radius_option,
    write,
)
from pearlbvp.errors import InputError
from pearlbvp.messages import say

if TYPE_CHECKING:
    from pearlbvp.continuation.branch import Branch
    from pearlbvp.continuation.following import BranchOptions
    from pearlbvp.studies.energies import Reference
    from pearlbvp.units import Units

save_option = click.option(
    "--save", type=File(), metavar="FILE.h5", help="Save the whole branch."
)  # fmt: skip


def fix_option(default: str | None = "area,volume", **how: Any) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """The option of all commands that judge stability: what is held; ``default`` is None where what was held stays."""
    return click.option(
        "--fix", cls=Option, default=default, show_default=default is not None, metavar="WHAT",
        help="What is held while stability is judged: area or tension, volume, pressure or osmotic=N (osmotic=300mM), "
        "length or force, ade=ALPHA (ade=60kT)." + ("" if default else "  [default: what was held]"), **how,
    )  # fmt: skip


def following(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options that all commands share that follow a branch, but ``--save``."""
    for decorate in (
        radius_option,
        drawing,
        outputs,
        click.option("--max-step", type=Number(), default=0.5, show_default=True, help="Largest step along the branch."),
        click.option("--step", type=Number(), help="First step along the branch.  [default: 0.1, or the largest]"),
        click.option("--max-points", type=click.IntRange(min=2), default=200, show_default=True,
                     help="End after so many new points, special ones and where it goes on from among them."),
        click.option("--until", type=Until(), multiple=True,
                     help="Stop exactly there: v=1.1, or the K-th special point from the branch's start on: bp, bp:2, fold:v, "
                     "fold:v:2, cmc, fold (of any column). May be given several times; the first reached counts."),
    ):  # fmt: skip
        command = decorate(command)
    return command


@dataclass(frozen=True)
class Following:
    """What was asked of a branch that is followed, by those options; files are checked before anything is computed.

    Attributes:
        until: where to stop.
        max_points, step, max_step: of the branch.
        out, plot, save: files, or None.
        units: of the user.
        reference: what energies are drawn above: a name, or a file.
        shapes: whether they are drawn at their places.
        start: the file that it starts from, or None.
    """

    until: tuple[tuple[str, float], ...]
    max_points: int
    step: float | None
    max_step: float
    out: Path | None
    plot: Path | None
    units: Units
    reference: str | None
    shapes: bool
    save: Path | None = None
    start: Path | None = None

    def checked(self) -> Following:
        """The same with its files' links resolved.

        Raises:
            InputError: a file that cannot be written, or has two meanings.
        """
        from pearlbvp.files import writable

        out, plot = check_outputs(self.out, self.plot)
        save = None if self.save is None else writable("--save", self.save)
        start = None if self.start is None else Path(os.path.realpath(self.start))
        check_distinct({"FILE": start, "--out": out, "--plot": plot})
        check_distinct({"--out": out, "--plot": plot, "--save": save})
        return replace(self, out=out, plot=plot, save=save, start=start)

    def run(self, follow: Callable[[BranchOptions], Branch[Any]], other_way: str = "") -> int:
        """Follow a branch, and write and say what is to be known of it.

        Args:
            follow: the study, called with where to stop and how to step.
            other_way: advice for a branch that leads away from what was wanted.

        Returns:
            The exit status.
        """
        from pearlbvp.progress import progress

        wanted, reference = wanted_places(self.until, self.units), reference_of(self.reference)
        with progress("point") as bar:
            from pearlbvp.continuation.following import kept
            from pearlbvp.studies.branch import branch_options

            checkpoint = _Checkpoint(self.save, self.units)

            def count(so_far: Branch[Any]) -> None:
                bar.set_postfix(v=f"{so_far.points[-1].observables['v']:.5f}", refresh=False)
                bar.update(len(so_far.points) - bar.n)
                checkpoint(so_far)

            def locating(done: int, of: int) -> None:
                bar.set_postfix_str(f"{done} of {of} special points located", refresh=False)

            steps = {"max_points": self.max_points, "step": self.step, "max_step": self.max_step}
            found = kept(follow, branch_options(wanted, progress=count, locating=locating, **steps))  # type: ignore[arg-type]
        return self._written(found, wanted, reference, other_way)

    def _written(
        self, found: Branch[Any], wanted: Mapping[str, float], reference: Reference | None, other_way: str
    ) -> int:
        from pearlbvp.continuation.branch import Status
        from pearlbvp.studies import saved
        from pearlbvp.studies.branch import shown

        table = self.units.columns(shown(found.table()))
        saves = [] if self.save is None else [lambda: saved.save(found, self.save, "--save", self.units)]  # type: ignore[arg-type]
        write(table, self.out, self.plot, lambda: branch_figure(found, self.units, reference, self.shapes), saves)
        if not found.complete:
            say(f"the branch ends: {words_of_this_command(found.reason)}{other_way if found.astray else ''}")
        if found.status is Status.INTERRUPTED:
            return INTERRUPTED
        return SOME_FAILED if found.failed or (wanted and not found.complete) else DONE

    def fixed(self, branch: Branch[Any], fix: str | None) -> str | None:
        """What is to be held from a point of a saved branch on, in radii.

        Raises:
            InputError: a unit that cannot be used.
        """
        if fix is None:
            return None
        point = branch.points[-1]
        if "L" not in point.problem.constant and self.units.fix(fix, 1.0) != self.units.fix(fix, 2.0):
            raise InputError(
                "fix", "L varies along the branch, and so does the solute at a concentration", "give osmotic=N"
            )
        return self.units.fix(fix, point.observables["L"])

    def load(self) -> Branch[Any]:
        """The saved branch that it starts from.

        Raises:
            InputError: the file is none.
        """
        from pearlbvp.studies import saved

        return saved.load(self.start, "FILE")  # type: ignore[arg-type]


class _Checkpoint:
    """Saves the branch so far now and then, so that a run that is killed keeps its points."""

    def __init__(self, path: Path | None, units: Units, seconds: float = 2.0) -> None:
        self.path, self.units, self.seconds, self.last = path, units, seconds, time.monotonic()

    def __call__(self, branch: Any) -> None:
        if self.path is not None and time.monotonic() - self.last > self.seconds:
            from pearlbvp.studies.saved import save

            with contextlib.suppress(InputError):  # a full disk may have room again; the end says what was not saved
                save(branch, self.path, units=self.units)
            self.last = time.monotonic()
