"""Signs of life of what takes long: a bar on standard error, if that is a terminal."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

SECONDS = 0.5
"""Between two looks at the clock."""


@contextmanager
def progress(unit: str, total: int | None = None, *, shown: bool | None = None, doing: str = "") -> Iterator[Any]:
    """A bar that is there at once and counts seconds by itself, however long a step takes.

    Args:
        unit: what is counted.
        total: how many there are, where that is known.
        shown: whether to show it; by default if standard error is a terminal.
        doing: words before it.

    Yields:
        A ``tqdm`` bar: ``update()`` counts.
    """
    from tqdm import tqdm  # a tenth of a second to import, and only what takes longer needs it

    disable = True if sys.stderr is None else None if shown is None else not shown
    with tqdm(total=total, unit=unit, desc=doing or None, disable=disable, file=sys.stderr, **_size()) as bar:
        if bar.disable:
            yield bar
            return
        done = threading.Event()
        clock = threading.Thread(target=_count, args=(bar, done), daemon=True)
        clock.start()
        try:
            yield bar
        except BaseException:
            bar.leave = False  # what went wrong is said without it
            raise
        finally:
            done.set()
            clock.join()


def _size() -> dict[str, int]:
    """A size for terminals that do not say how large they are, on which nothing would be drawn; others say so themselves."""
    try:
        return {} if os.get_terminal_size(sys.stderr.fileno()).columns else {"ncols": 80, "nrows": 24}
    except (OSError, ValueError, AttributeError):  # no terminal, or no file
        return {}


def _count(bar: Any, done: threading.Event) -> None:
    """Draw a bar again until all is done."""
    while not done.wait(SECONDS):
        bar.refresh()
