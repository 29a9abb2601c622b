"""Rows of the table of benchmarks: each a function that measures, registered under the work that it does.

Times are CPU seconds of one thread: the wall clock of a shared machine is noise. What is compared runs in pairs, in turn, and the
ratio is the median of the pairs' with its quartiles.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

ALONE = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


@dataclass(frozen=True)
class Row:
    """What was measured, as the table shows it.

    Attributes:
        ours, peer: times, and what else there is to say of them.
        ratio: of the peer's time to ours.
        limit: what ours must not exceed.
    """

    ours: str
    peer: str = ""
    ratio: str = ""
    limit: str = ""


ROWS: dict[str, Callable[[], Row]] = {}


def row(work: str) -> Callable[[Callable[[], Row]], Callable[[], Row]]:
    """Register a function as the row of some work."""

    def registered(function: Callable[[], Row]) -> Callable[[], Row]:
        ROWS[work] = function
        return function

    return registered


def of_process(command: Sequence[str], folder: str | None = None, **environment: str) -> float:
    """CPU seconds of a command, which must succeed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, cwd=folder, env=ALONE | environment, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def of_call(function: Callable[[], object]) -> float:
    """CPU seconds of a call."""
    before = time.process_time()
    function()
    return time.process_time() - before


def least(measure: Callable[[], float], repeats: int = 7) -> float:
    """The shortest of some times, after one that is not counted."""
    measure()
    return min(measure() for _ in range(repeats))


def paired(ours: Callable[[], float], peer: Callable[[], float], repeats: int = 9) -> tuple[float, float, str]:
    """Median times of both, in turn, and the ratio of the peer's to ours with its quartiles."""
    ours(), peer()
    pairs = [(ours(), peer()) for _ in range(repeats)]
    low, middle, high = statistics.quantiles([other / own for own, other in pairs])
    return (
        *(statistics.median(times) for times in zip(*pairs, strict=True)),
        f"{middle:.1f} ({low:.1f} to {high:.1f})",
    )


def written(seconds: float) -> str:
    """``12 ms`` or ``1.23 s``."""
    return f"{seconds:.2f} s" if seconds >= 0.1 else f"{1e3 * seconds:.0f} ms"
