"""A scan: cases are computed by an engine, and what is finished is kept at once."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from contextlib import ExitStack
from typing import Any, NamedTuple

from pearlbvp.errors import interrupted
from pearlbvp.scans.case import Case, Outcome, coarse_first
from pearlbvp.scans.engines import Engine, TimedOut, cores, within
from pearlbvp.scans.questions import ANY, CRITICAL, MANY, QUESTIONS, Question
from pearlbvp.scans.store import Store

Unit = tuple[Case, ...]
"""Cases that are answered together, by one continuation."""


class Answer(NamedTuple):
    """What became of the cases of a unit, and series that were computed for them."""

    outcomes: list[Outcome]
    series: Sequence[bytes] = ()


AHEAD = 2
"""Units a worker that wait where it finds them at once."""


def units_of(question: Question, cases: Sequence[Case]) -> list[Unit]:
    """Cases that are answered together, in an order whose beginnings are coarse maps."""
    units = []
    for group in _grouped(cases, question.together):
        parts = [group] if question.apart is None else _grouped(group, question.apart)
        units += parts if len(parts) < MANY else [group]
    return [units[index] for index in coarse_first(len(units))]


def _grouped(cases: Sequence[Case], by: Callable[[Case], tuple[Any, ...]]) -> list[Unit]:
    """Cases with equal answers, in their order."""
    groups: dict[tuple[Any, ...], list[Case]] = {}
    for case in cases:
        groups.setdefault(by(case), []).append(case)
    return [tuple(group) for group in groups.values()]


def answer(unit: Unit, seconds: float | None = None, known: Sequence[bytes] = ()) -> Answer:
    """What becomes of the cases of a unit, from series that are known; runs in a worker.

    Where the whole ends in an error its cases are tried one by one, so that only those fail that must.
    """
    question = QUESTIONS[unit[0].question]
    try:
        rows, series = within(seconds, question.answered, unit, known)
    except TimedOut:
        return Answer([failure(case, f"it took longer than {seconds:g} s; allow more") for case in unit])
    except Exception as error:
        if interrupted(error):  # inside compiled code
            raise KeyboardInterrupt from error
        if len(unit) > 1:
            return Answer([outcome for case in unit for outcome in answer((case,), seconds).outcomes])
        return Answer([failure(unit[0], str(error) or type(error).__name__)])
    return Answer([_outcome(found) for found in rows], series)


def _outcome(rows: Sequence[Any]) -> Outcome:
    failed = [row for row in rows if row.get("status") == "failed"]
    return Outcome(tuple(rows), "failed" if failed else "done", str(failed[0].get("message", "")) if failed else "")


def failure(case: Case, message: str) -> Outcome:
    """A case that could not be answered: a row that says why."""
    question = QUESTIONS[case.question]
    known = {
        name: value
        for name, value in zip(question.parameters, case.parameters, strict=True)
        if name in question.columns and value not in (CRITICAL, ANY)  # no words among a column's numbers
    }
    return Outcome(({**known, "status": "failed", "message": message},), "failed", message)


def run(
    question: Question,
    cases: Sequence[Case],
    store: Store,
    engine: Engine,
    *,
    workers: int = 0,
    seconds: float | None = None,
    finished: Callable[[int], object] = lambda count: None,
) -> None:
    """Answer cases and keep what is finished.

    Args:
        question: of the cases.
        cases: that are not finished.
        store: where they are kept.
        engine: where they are computed.
        workers: how many the engine has; 0 for one a core.
        seconds: that a unit may take.
        finished: is told how many cases each arrival brings.

    Raises:
        InputError: the store cannot be written to, or the engine not be reached; what is finished is kept.
        KeyboardInterrupt: so that whoever asked knows; what is finished is kept.
    """
    waiting = deque(units_of(question, cases))
    suspects: deque[Unit] = deque()  # were in work when a worker died: one by one, the one that kills is found

    def begin(executor: Executor, unit: Unit) -> Future[Answer]:
        c0 = question.series_of(unit[0])
        return executor.submit(answer, unit, seconds, () if c0 is None else store.series(c0))

    def keep(unit: Unit, found: Answer) -> None:
        store.put(dict(zip(unit, found.outcomes, strict=True)), question.settings)
        store.put_series(question.series_of(unit[0]), found.series)
        finished(len(unit))

    while waiting or suspects:
        lost = _until_lost(waiting, suspects, begin, keep, engine, AHEAD * (workers or cores()))
        if len(lost) == 1:
            died = "its worker process died, perhaps for want of memory"
            keep(lost[0], Answer([failure(case, died) for case in lost[0]]))
        else:
            suspects.extend(lost)


def _until_lost(
    waiting: deque[Unit],
    suspects: deque[Unit],
    begin: Callable[[Executor, Unit], Future[Answer]],
    keep: Callable[[Unit, Answer], object],
    engine: Engine,
    window: int,
) -> list[Unit]:
    """Work until all is done or a worker dies; what was in work then is returned.

    Units that were in work when one died are done alone, so that the next death tells which it was.
    """
    with ExitStack() as stack:
        executor: Executor = stack.enter_context(engine())
        working: dict[Future[Answer], Unit] = {}
        try:
            while waiting or suspects or working:
                while (suspects and not working) or (waiting and not suspects and len(working) < window):
                    unit = suspects.popleft() if suspects else waiting.popleft()
                    try:
                        working[begin(executor, unit)] = unit
                    except BrokenExecutor:
                        return [*working.values(), unit]
                done, _ = wait(working, return_when=FIRST_COMPLETED)
                lost = []
                for future in done:
                    unit = working.pop(future)
                    found = _result(unit, future)
                    if found is None:
                        lost.append(unit)
                    else:
                        keep(unit, found)
                if lost:
                    return lost + _lost(working, keep)
        except BaseException as error:
            for future, unit in working.items():
                if not future.cancel() and future.done() and isinstance(error, KeyboardInterrupt):
                    found = _result(unit, future)
                    if found is not None:
                        keep(unit, found)
            raise
    return []


def _result(unit: Unit, future: Future[Answer]) -> Answer | None:
    """What a worker answered; None if it died."""
    try:
        return future.result()
    except BrokenExecutor:
        return None
    except Exception as error:  # of the engine: an answer's own are outcomes
        why = " ".join(str(error).split())[:200] or type(error).__name__
        return Answer([failure(case, why) for case in unit])


def _lost(working: dict[Future[Answer], Unit], keep: Callable[[Unit, Answer], object]) -> list[Unit]:
    """What was in work when a worker died, but for what was finished."""
    lost = []
    for future, unit in working.items():
        found = _result(unit, future)
        if found is None:
            lost.append(unit)
        else:
            keep(unit, found)
    return lost
