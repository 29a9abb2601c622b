"""Signs of life of what takes long: a bar on standard error, if that is a terminal or a notebook's."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

SECONDS = 0.5
"""Between two looks at the clock."""

PATIENCE = 2.0
"""Seconds before a notebook shows a bar: what is done by then leaves nothing in it."""


@contextmanager
def progress(unit: str, total: int | None = None, *, shown: bool | None = None, doing: str = "") -> Iterator[Any]:
    """A bar that is there at once and counts seconds by itself, however long a step takes.

    Args:
        unit: what is counted.
        total: how many there are, where that is known.
        shown: whether to show it; by default if standard error is a terminal, or that of a notebook, where it is removed
            at the end.
        doing: words before it.

    Yields:
        A ``tqdm`` bar: ``update()`` counts.
    """
    from tqdm import tqdm  # a tenth of a second to import, and only what takes longer needs it

    notebook = shown is None and _in_notebook()
    disable = True if sys.stderr is None else not shown if shown is not None else None if not notebook else False
    later = {"delay": PATIENCE, "leave": False} if notebook else {}
    with tqdm(total=total, unit=unit, desc=doing or None, disable=disable, file=sys.stderr, **_size(), **later) as bar:
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


def _in_notebook() -> bool:
    """Whether standard error is that of a notebook's kernel, which is no terminal but shows what is written at once."""
    return type(sys.stderr).__module__.partition(".")[0] == "ipykernel"


def _size() -> dict[str, int]:
    """A size for terminals that do not say how large they are, on which nothing would be drawn; others say so themselves."""
    try:
        return {} if os.get_terminal_size(sys.stderr.fileno()).columns else {"ncols": 80, "nrows": 24}
    except (OSError, ValueError, AttributeError):  # no terminal, or no file
        return {}


def _count(bar: Any, done: threading.Event) -> None:
    """Draw a bar again until all is done, after its delay."""
    if done.wait(bar.delay):
        return
    bar.delay = 0  # so that closing it removes it
    bar.refresh()
    while not done.wait(SECONDS):
        bar.refresh()
