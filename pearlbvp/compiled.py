"""Compiled inner loops: one decorator for all of them, kept on disk, and one word to the user while they compile.

What is kept is machine code in pickles, and a pickle can run anything: so none is opened but the user's own (or the
superuser's), from a folder that nobody else can write to, and whose SHA-256 is right. Files that fail are removed and made
again. Each function has a file for each signature, written beside its name and renamed, and no index over all of them: so
processes that compile at once do not meet, and a run that is killed leaves nothing half done.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import pickle
import stat
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import event
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.runtime import rtsys
from numba.core.serialize import dumps
from numba.misc.appdirs import AppDirs

from pearlbvp.errors import interrupted
from pearlbvp.messages import say

F = TypeVar("F", bound=Callable[..., Any])

DIGEST = 32
"""Bytes of a SHA-256, with which every file begins."""


def compiled(function: F) -> F:
    """Compile ``function`` with numba at its first call and keep the machine code on disk for later processes.

    It is kept in the user's cache folder (or where ``NUMBA_CACHE_DIR`` says), not in the package's: files there that
    the installer does not know of would outlive the package and hide the next one. Where nothing can be kept, the
    function is compiled in each process, to the same code.
    """
    dispatcher: Any = numba.njit(error_model="numpy", fastmath={"contract"})(function)
    dispatcher._cache = _Kept(function)
    return cast(F, dispatcher)


class _Kept(NullCache):
    """The machine code of one function on disk, a file a signature: what numba asks of a cache."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.name = f"{function.__module__}.{function.__qualname__}"

    @property
    def cache_path(self) -> str:
        """The folder."""
        return str(folder())

    def _file(self, sig: Any, codegen: Any) -> Path:
        """One name for each signature, processor and version of Python and numba."""
        key = repr((self.name, sig, codegen.magic_tuple(), sys.version, numba.__version__))
        return folder() / f"{self.name.rpartition('.')[2]}-{hashlib.sha256(key.encode()).hexdigest()[:16]}.nbc"

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """What was kept, or None where it has to be compiled: a file that cannot be trusted is removed."""
        file = self._file(sig, target_context.codegen())
        if unusable() or not os.path.lexists(file):
            return None
        try:
            if not _own(file):
                raise ValueError("somebody else's")
            content = file.read_bytes()
            if hashlib.sha256(content[DIGEST:]).digest() != content[:DIGEST]:
                raise ValueError("damaged")
            rtsys.initialize(target_context)
            return CompileResult._rebuild(target_context, *pickle.loads(content[DIGEST:]))
        except Exception as error:  # whatever is wrong with it, it is made again
            if interrupted(error):
                raise
            announcement.damaged = True
            with contextlib.suppress(OSError):
                file.unlink()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep what was compiled, or go on without where that is not possible: on a full disk, say."""
        if unusable() or data.library.has_dynamic_globals:
            return
        content = dumps(data._reduce())
        file, temporary = self._file(sig, data.codegen), None
        try:
            handle, temporary = tempfile.mkstemp(prefix=".", dir=file.parent)
            with open(handle, "wb") as beside:
                beside.write(hashlib.sha256(content).digest() + content)
            os.replace(temporary, file)
            temporary = None
        except OSError as error:
            announcement.not_kept(error.strerror or str(error))
        finally:
            if temporary is not None:
                with contextlib.suppress(OSError):
                    os.unlink(temporary)


@functools.cache
def folder() -> Path:
    """Where the code of these sources is kept: another folder after any change, for compiled functions call each other."""
    chosen = numba.config.CACHE_DIR  # type: ignore[attr-defined]
    home = Path(chosen) / "pearlbvp" if chosen else Path(AppDirs("pearlbvp", appauthor=False).user_cache_dir)
    sources = hashlib.sha256()
    for file in sorted(Path(__file__).parent.rglob("*.py")):
        content = file.read_bytes()
        if b"@compiled" in content:
            sources.update(content)
    return home / sources.hexdigest()[:16]


@functools.cache
def unusable() -> str:
    """Why nothing can be kept, or an empty text."""
    home = folder().parent
    try:
        home.parent.mkdir(parents=True, exist_ok=True)
        for path in (home, folder()):
            path.mkdir(mode=0o700, exist_ok=True)
            if not _own(path):
                return f"{path} belongs to somebody else, or others can write to it"
        with tempfile.TemporaryFile(dir=folder()):
            return ""
    except OSError as error:
        return f"{error.filename or home} cannot be written to ({error.strerror})"


def _own(path: Path) -> bool:
    """Whether a file or folder is the user's or the superuser's, and nobody else can write to it."""
    if not hasattr(os, "getuid"):  # on Windows the folder of a user is his own
        return True
    found = path.lstat()
    return found.st_uid in (0, os.getuid()) and not found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


class _Announcement(event.Listener):
    """Says once a process, on standard error, that our loops are being compiled. Silent when they come from disk."""

    def __init__(self) -> None:
        self.said = self.failed = self.damaged = False

    def on_start(self, event: Any) -> None:
        """Compilation begins."""
        if self.said or not event.data["dispatcher"].py_func.__module__.startswith("pearlbvp."):
            return
        self.said = True
        if why := unusable():
            when = f"in every run, for {why}; set NUMBA_CACHE_DIR to a folder of yours"
        elif self.damaged:
            when = f"again: what was kept of them in {folder()} was damaged or not yours, and is removed"
        else:
            when = "once after installation, which takes about ten seconds"
        say(f"compiling its inner loops {when} ...")

    def on_end(self, event: Any) -> None:
        """Nothing is said."""

    def not_kept(self, why: str) -> None:
        """What was compiled could not be written."""
        if not self.failed:
            self.failed = True
            say(f"compiling again in the next run: {folder()} cannot be written to ({why})")


announcement = _Announcement()
event.register("numba:compile", announcement)
