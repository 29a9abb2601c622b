"""What is said beside results: lines on standard error, dropped where they cannot be written, for no result hangs on them."""

from __future__ import annotations

import contextlib
import errno
import os
import sys
from typing import Any

from pearlbvp.errors import InputError

PROGRAM = "pearlbvp: "
"""What lines begin with, so that it is seen in a script whose they are."""


def say(text: str, begin: str = PROGRAM) -> None:
    """Write a line on standard error, beside a progress bar where there is one; closed, full or gone, it takes nothing."""
    if sys.stderr is None:
        return
    bars = sys.modules.get("tqdm")
    write: Any = print if bars is None else bars.tqdm.write
    try:
        write(f"{begin}{text}", file=sys.stderr)
        sys.stderr.flush()
    except (OSError, ValueError):  # the last of a file that was closed
        drop(sys.stderr)


def drop(stream: Any) -> None:
    """Let nothing more be written to a stream, so that the interpreter's own flush at exit cannot fail again."""
    with contextlib.suppress(OSError, ValueError):  # one that is no file of the system
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, stream.fileno())
        os.close(nothing)


def open_streams() -> None:
    """Give standard streams that are closed a number of the system's, which a file that is written would get otherwise.

    Standard output can still not be written to, as its owner wanted; what is said on standard error is dropped.
    """
    if sys.stdin is None:
        sys.stdin = open(_taken(os.O_RDONLY))  # noqa: SIM115
    if sys.stdout is None:
        sys.stdout = open(_taken(os.O_RDONLY), "w")  # noqa: SIM115
    if sys.stderr is None:
        sys.stderr = open(_taken(os.O_WRONLY), "w", errors="backslashreplace")  # noqa: SIM115


def _taken(flags: int) -> int:
    """The lowest free number, of the null device; other processes get it, too."""
    number = os.open(os.devnull, flags)
    os.set_inheritable(number, True)
    return number


def why_not_written(error: OSError) -> InputError:
    """Why standard output took nothing, and what to do."""
    if error.errno == errno.EBADF:
        return InputError("standard output", "it is closed", "open it, or use --out")
    return InputError("standard output", error.strerror or str(error), "free space or use --out")


def counted(number: int, one: str, many: str = "") -> str:
    """``1 face`` or ``3 faces``."""
    return f"{number} {one if number == 1 else many or one + 's'}"
