"""Ask one question of many tubes: the cases, the store, the engine, and the table of what is finished."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any

from pearlbvp.errors import InputError
from pearlbvp.files import named
from pearlbvp.helfrich import Tube, positive, whole
from pearlbvp.numbers import as_numbers, as_whole, several
from pearlbvp.progress import progress as progress_bar
from pearlbvp.scans import engines
from pearlbvp.scans.case import Case, Value
from pearlbvp.scans.questions import ANY, CRITICAL, Question, question_named
from pearlbvp.scans.run import run
from pearlbvp.scans.store import Store

if TYPE_CHECKING:
    import pandas as pd

MOST_CASES = 1_000_000

Values = float | str | Iterable[float] | Sequence[str]
"""A value of a parameter, several, or a text like ``15:300:15``."""


def cases_of(question: Question, parameters: Mapping[str, Values | None]) -> list[Case]:
    """Every combination of the values of a question's parameters, in order.

    Args:
        question: whose cases.
        parameters: values by the names of the question's parameters, in radii.

    Raises:
        InputError: a parameter is missing, is none of the question's, or has a value that no tube has.
    """
    for name in parameters:
        if name not in question.parameters:
            raise InputError(name, f"{question.name} has no such parameter", f"it has {', '.join(question.parameters)}")
    values = []
    for name in question.parameters:
        given = parameters.get(name)
        if given is None:
            raise InputError(name, f"{question.name} needs it", "give one value or several")
        values.append(_values(name, given))
    count = 1
    for numbers in values:
        count *= len(numbers)
    if count > MOST_CASES:
        raise InputError(
            question.parameters[0], f"{count:,} cases are too many", f"give fewer values, up to {MOST_CASES:,} cases"
        )
    cases = list(dict.fromkeys(Case(question.name, found) for found in itertools.product(*values)))
    for case in cases:
        question.check(case)
    return sorted(cases, key=Case.place)


def _values(name: str, given: Any) -> list[Value]:
    """The values of one parameter."""
    if name in ("family", "mode"):
        return [given] if isinstance(given, str) else [str(word) for word in several(given)]
    if name == "period" and isinstance(given, str) and given == CRITICAL:
        return [CRITICAL]
    if name == "L" and isinstance(given, str) and given == ANY:
        return [ANY]
    numbers = as_numbers(name, given)
    if name == "pearls":
        return [whole(name, number, 2) for number in numbers]
    if name in ("lambda1", "membrane_viscosity"):
        return list(numbers)
    tubes = {"c0": lambda c0: Tube(c0, 10.0).c0, "L": lambda length: Tube(0.0, length).length}
    known = tubes.get("L" if name == "period" else name, lambda number: positive(name, number))
    try:
        return [known(number) for number in numbers]
    except InputError as error:
        raise error.named(name) from None


def engine_of(workers: int | str | None, scheduler: str | None = None) -> tuple[engines.Engine, int]:
    """Where cases are computed, and by how many workers.

    Args:
        workers: a number of processes on this machine, by default one a core; ``dask:8`` for a Dask cluster of so many.
        scheduler: address of a Dask scheduler instead.

    Raises:
        InputError: it is neither.
    """
    if scheduler is not None:
        if workers is not None:
            raise InputError("workers", "the scheduler has its own", "leave one of the two out")
        return engines.dask(scheduler), 4 * engines.cores()
    if workers is None:
        return engines.local(engines.cores()), engines.cores()
    number = as_whole(workers.removeprefix("dask:")) if isinstance(workers, str) else workers
    if number is None:
        raise InputError(
            "workers", f"{workers!r} is no number of processes", "give one, or dask:8 for a cluster of so many"
        )
    count = whole("workers", number)
    if count > MOST_WORKERS:
        raise InputError("workers", f"{count} are too many for one machine", f"give {MOST_WORKERS} at most")
    return (engines.dask if str(workers).startswith("dask:") else engines.local)(count), count


MOST_WORKERS = 1000
"""Processes that this machine may be asked for."""


def scan(
    question: str,
    store: str | os.PathLike[str],
    *,
    workers: int | str | None = None,
    scheduler: str | None = None,
    executor: Executor | None = None,
    seconds: float | None = None,
    progress: bool | None = None,
    **parameters: Values | None,
) -> pd.DataFrame:
    """Answer a question for every combination of its parameters; what is finished in the store already is kept.

    Interrupted, by Ctrl-C, a kill or a power cut, it goes on from there when it is called again.

    Args:
        question: ``dispersion, localized, period, region, amplitude-map`` or ``branch``.
        store: file that keeps the cases; made where there is none.
        workers: processes on this machine, by default one a core; ``"dask:8"`` for a Dask cluster of so many.
        scheduler: address of a Dask scheduler, ``"tcp://host:8786"``.
        executor: one of one's own, of ``concurrent.futures``' interface.
        seconds: that a continuation may take.
        progress: show a bar on standard error (``None``: if that is a terminal).
        parameters: those of the question (``questions.QUESTIONS``), in radii: a number, several, or a text like ``15:300:15``.

    Returns:
        The rows of these cases, in their order.

    Raises:
        InputError: an argument that cannot be used.

    Examples:
        >>> import pearlbvp as pb
        >>> table = pb.scan("localized", "scan.sqlite", c0="0.3,0.48", period=7.5, L="15:60:7.5", workers=1)  # doctest: +SKIP
    """
    asked = question_named(question)
    cases = cases_of(asked, parameters)
    engine, count = (engines.given(executor), 0) if executor is not None else engine_of(workers, scheduler)
    with Store(named("store", store), writing=True) as kept:
        scanned(asked, kept.ask(cases, asked.settings), kept, engine, workers=count, seconds=seconds, total=len(cases),
                progress=progress)  # fmt: skip
        return table_of(asked, kept, cases)


def scanned(
    question: Question,
    cases: Sequence[Case],
    store: Store,
    engine: engines.Engine,
    *,
    workers: int,
    seconds: float | None = None,
    total: int | None = None,
    progress: bool | None = None,
) -> None:
    """Answer cases with a bar that knows how many there are in all; see ``run``."""
    seconds = None if seconds is None else positive("seconds", seconds)
    if not cases:
        return
    with progress_bar("case", total or len(cases), shown=progress) as bar:
        bar.update((total or len(cases)) - len(cases))
        run(question, cases, store, engine, workers=workers, seconds=seconds, finished=bar.update)


def table_of(question: Question, store: Store, cases: Sequence[Case] | None = None) -> pd.DataFrame:
    """The rows of a question's finished cases in the order of their parameters: all of a store's, or given ones."""
    import pandas as pd

    wanted = None if cases is None else set(cases)
    rows = [
        row
        for case, outcome in store.outcomes(question.name, question.settings)
        if wanted is None or case in wanted
        for row in outcome.rows
    ]
    table = pd.DataFrame(rows, columns=list(question.columns))
    return table.astype(dict.fromkeys(question.integers, "Int64"))
