"""Compiled inner loops: one decorator for all of them, cached on disk, and one word to the user while they compile."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from numba.core import event
from numba.misc.appdirs import AppDirs

F = TypeVar("F", bound=Callable[..., Any])


def compiled(function: F) -> F:
    """Compile ``function`` with numba at its first call and keep the machine code on disk for later processes.

    It is kept in the user's cache folder (or where ``NUMBA_CACHE_DIR`` says), not in the package's: files there that
    the installer does not know of would outlive the package and hide the next one. Where nothing can be written, the
    function is compiled in each process.
    """
    config: Any = numba.config
    chosen = config.CACHE_DIR
    config.CACHE_DIR = chosen or AppDirs("pearlbvp", appauthor=False).user_cache_dir
    try:
        dispatcher: Any = numba.njit(cache=True, error_model="numpy", fastmath={"contract"})(function)
    except RuntimeError:  # numba's "no locator available": there is nowhere to keep the cache
        dispatcher = numba.njit(error_model="numpy")(function)
    finally:
        config.CACHE_DIR = chosen
    return cast(F, dispatcher)


class _Announcement(event.Listener):
    """Says once a process, on standard error, that our loops are being compiled. Silent when they come from disk."""

    def __init__(self) -> None:
        self.said = False

    def on_start(self, event: Any) -> None:
        ours = event.data["dispatcher"].py_func.__module__.startswith("pearlbvp.")
        if ours and not self.said:
            self.said = True
            print("pearlbvp: compiling its inner loops, once after installation (about 15 s) ...", file=sys.stderr)

    def on_end(self, event: Any) -> None:
        """Nothing to say."""


event.register("numba:compile", _Announcement())
