"""Many cases over several processes, their rows in order."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from functools import cache
from typing import TypeVar

from pearlbvp.messages import say

Case = TypeVar("Case")
Row = TypeVar("Row")


def in_processes(
    function: Callable[[Case], Row], cases: Sequence[Case], processes: int | None, fewest: int, batch: int = 4
) -> Iterator[Row]:
    """What a function makes of each case, in order, each as soon as it and those before it are done.

    Args:
        function: of a module, so that other processes find it.
        cases: what to compute.
        processes: how many to use; by default one a core, or none besides this one for a few cases. Each is kept to
            one BLAS thread. What is left when one of them is killed, for want of memory say, is done here.
        fewest: cases below which starting processes costs more than it saves.
        batch: cases that a process takes at once.
    """
    processes = processes and max(1, min(processes, len(cases)))
    if processes == 1 or (len(cases) < fewest and processes is None):
        yield from map(function, cases)
        return
    from joblib import Parallel, delayed, parallel_config  # a fifth of a second to import, and only scans need it

    done, parent = 0, os.getpid()
    try:
        with parallel_config("loky", n_jobs=processes or -1, inner_max_num_threads=1):
            for row in Parallel(return_as="generator", batch_size=batch)(
                delayed(_in_worker)(function, case, parent) for case in cases
            ):
                yield row
                done += 1
    except BrokenProcessPool:
        say(f"a worker process was killed; the other {len(cases) - done} are done in one")
        yield from map(function, cases[done:])


def _in_worker(function: Callable[[Case], Row], case: Case, parent: int) -> Row:
    if os.getpid() != parent:
        serve(parent)
    return function(case)


@cache
def serve(parent: int) -> None:
    """Leave Ctrl-C, which all processes of a terminal get, to the parent, and end within a second of it if that is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(1)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
