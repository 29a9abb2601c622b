"""Where scans keep their cases: one SQLite file, in which what is finished is safe from kills and power cuts.

Written by one process at a time, the scan itself, as results arrive; read by as many as want to, meanwhile. Cases are known by
a hash of their canonical form, the tolerances and the package's version: another version's are others, and stay beside.
"""

from __future__ import annotations

import json
import sqlite3
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from pearlbvp._version import __version__
from pearlbvp.errors import InputError
from pearlbvp.files import held, writable
from pearlbvp.scans.case import Case, Outcome, Value

APPLICATION = 0x70726C73
"""What SQLite calls the application's number, by which a store is known from other programs' databases: ``prls``."""

SCHEMA = """
CREATE TABLE IF NOT EXISTS cases (
    key TEXT PRIMARY KEY, question TEXT NOT NULL, parameters TEXT NOT NULL, settings TEXT NOT NULL, version TEXT NOT NULL,
    status TEXT NOT NULL DEFAULT 'waiting', message TEXT NOT NULL DEFAULT '', rows TEXT NOT NULL DEFAULT '[]', finished REAL
)
"""

SERIES = """
CREATE TABLE IF NOT EXISTS series (c0 REAL NOT NULL, version TEXT NOT NULL, content BLOB NOT NULL)
"""

RECENT = 200
"""Finished cases whose pace tells how long the others will take."""


@dataclass(frozen=True)
class Progress:
    """How far a question's scan is.

    Attributes:
        counts: cases by ``done``, ``failed`` and ``waiting``.
        failures: those that failed and why.
        others: cases of other versions or tolerances.
        running: whether a scan is at work on them.
        seconds_left: at the pace of the latest, where one runs and has a pace.
    """

    counts: Mapping[str, int]
    failures: tuple[tuple[Case, str], ...]
    others: int
    running: bool
    seconds_left: float | None


class Store:
    """A store that is open; use it in a ``with`` statement.

    Args:
        path: of the file; one that is written is made where there is none.
        writing: hold it for a scan.
        name: the argument's name, for messages.

    Raises:
        InputError: it is no store or a broken one, or another scan is at work on it.
    """

    # The lock is taken before the database is opened and given back behind it: that closing a file takes a process's other
    # locks on it away is how POSIX has it, and SQLite's are such.
    def __init__(self, path: str | Path, *, writing: bool = False, name: str = "store") -> None:
        self.name = name
        self.path = writable(name, path, locked=True)
        if not writing and not self.path.is_file():
            raise InputError(name, f"there is no file {path}", "give one that a scan wrote")
        if self.path.exists() and not self.path.is_file():
            raise InputError(name, f"{path} is no ordinary file but a device or a pipe", "give a file's name")
        try:
            self._held = held(self.path)
        except OSError as error:
            raise InputError(name, f"{path} cannot be written ({error.strerror})", "choose another place") from None
        self.running = self._held is None
        if writing and self.running:
            raise InputError(name, f"a scan is at work on {path}", "wait for its end, or give another file")
        if not writing:
            self._let_go()
        try:
            with self._understood():
                self._database = sqlite3.connect(self.path, timeout=10, isolation_level=None)
                self._prepare(writing)
        except InputError:
            self._let_go()
            raise

    def _prepare(self, writing: bool) -> None:
        """Make a new store, or see that this is one."""
        number = self._database.execute("PRAGMA application_id").fetchone()[0]
        tables = self._database.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall()
        if number != APPLICATION and (tables or not writing):
            raise InputError(self.name, f"{self.path} is another program's database", "give another file")
        if writing:
            self._database.execute("PRAGMA journal_mode = WAL")
            self._database.execute("PRAGMA synchronous = FULL")  # what is finished outlives a power cut
            self._database.execute(f"PRAGMA application_id = {APPLICATION}")
            self._database.execute(SCHEMA)
            self._database.execute(SERIES)
        columns = {row[1] for row in self._database.execute("PRAGMA table_info(cases)")}
        if not {"key", "question", "parameters", "settings", "version", "status", "rows", "finished"} <= columns:
            raise InputError(self.name, f"{self.path} is no whole store", "give another file")

    @contextmanager
    def _understood(self) -> Iterator[None]:
        """SQLite's errors in one line."""
        try:
            yield
        except sqlite3.OperationalError as error:
            why, remedy = str(error), "choose another place"
            if "full" in why:
                why, remedy = "the disk is full; what is finished is kept", "free space and run the same again"
            elif "locked" in why:
                why, remedy = "another program holds it", "close it there"
            raise InputError(self.name, f"{self.path}: {why}", remedy) from None
        except sqlite3.DatabaseError as error:
            raise InputError(
                self.name, f"{self.path} is no store or a broken one ({error})", "give another file"
            ) from None

    def __enter__(self) -> Store:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._database.close()
        self._let_go()

    def _let_go(self) -> None:
        if self._held is not None:
            self._held.close()

    def ask(self, cases: Sequence[Case], settings: Mapping[str, Value]) -> list[Case]:
        """Note cases that are wanted.

        Returns:
            Those that are not finished, in their order; what failed before is finished, see ``retry``.
        """
        rows = [
            (
                case.key(settings, __version__),
                case.question,
                json.dumps(case.parameters),
                json.dumps(dict(settings)),
                __version__,
            )
            for case in cases
        ]
        with self._understood(), self._at_once():
            self._database.executemany(
                "INSERT INTO cases (key, question, parameters, settings, version) VALUES (?, ?, ?, ?, ?)"
                " ON CONFLICT DO NOTHING", rows,
            )  # fmt: skip
            waiting = {key for (key,) in self._database.execute("SELECT key FROM cases WHERE status = 'waiting'")}
        return [case for case, row in zip(cases, rows, strict=True) if row[0] in waiting]

    def put(self, outcomes: Mapping[Case, Outcome], settings: Mapping[str, Value]) -> None:
        """Keep what became of cases; it is on the disk when this returns."""
        rows = [
            (
                found.status,
                found.message,
                json.dumps(found.rows, default=_plain),
                time.time(),
                case.key(settings, __version__),
            )
            for case, found in outcomes.items()
        ]
        with self._understood(), self._at_once():
            self._database.executemany(
                "UPDATE cases SET status = ?, message = ?, rows = ?, finished = ? WHERE key = ?", rows
            )

    def series(self, c0: float) -> list[bytes]:
        """The series that cases of a ``c0`` are answered from, of this version."""
        with self._understood():
            found = self._database.execute(
                "SELECT content FROM series WHERE c0 = ? AND version = ? ORDER BY rowid", (c0, __version__)
            )
            return [content for (content,) in found]

    def put_series(self, c0: float | None, contents: Sequence[bytes]) -> None:
        """Keep new ones."""
        with self._understood(), self._at_once():
            self._database.executemany(
                "INSERT INTO series (c0, version, content) VALUES (?, ?, ?)",
                [(c0, __version__, content) for content in contents],
            )

    @contextmanager
    def _at_once(self) -> Iterator[None]:
        """All or nothing."""
        self._database.execute("BEGIN IMMEDIATE")
        try:
            yield
        except BaseException:
            if self._database.in_transaction:
                self._database.execute("ROLLBACK")
            raise
        self._database.execute("COMMIT")

    def retry(self, question: str, settings: Mapping[str, Value]) -> list[Case]:
        """Let cases that failed wait again, and return them."""
        failed = self._cases(question, settings, "failed")
        with self._understood(), self._at_once():
            self._database.executemany(
                "UPDATE cases SET status = 'waiting', message = '' WHERE key = ?",
                [(_key(case, settings),) for case in failed],
            )
        return failed

    def _cases(self, question: str, settings: Mapping[str, Value], status: str) -> list[Case]:
        found = self._select("parameters", question, settings, status)
        return sorted((Case(question, tuple(json.loads(text))) for (text,) in found), key=Case.place)

    def _select(
        self, what: str, question: str, settings: Mapping[str, Value], status: str | None = None
    ) -> list[tuple[Any, ...]]:
        """Columns of a question's cases of this version and these settings."""
        wanted = [question, json.dumps(dict(settings)), __version__] + ([] if status is None else [status])
        where = "question = ? AND settings = ? AND version = ?" + ("" if status is None else " AND status = ?")
        with self._understood():
            return self._database.execute(f"SELECT {what} FROM cases WHERE {where}", wanted).fetchall()

    def questions(self) -> list[str]:
        """The questions that it has cases of."""
        with self._understood():
            return [name for (name,) in self._database.execute("SELECT DISTINCT question FROM cases ORDER BY question")]

    def waiting(self, question: str, settings: Mapping[str, Value]) -> list[Case]:
        """Cases that no scan has finished, in order."""
        return self._cases(question, settings, "waiting")

    def outcomes(self, question: str, settings: Mapping[str, Value]) -> list[tuple[Case, Outcome]]:
        """All finished cases in the order of their parameters, whatever the order in which they were finished."""
        found = [
            (Case(question, tuple(json.loads(parameters))), Outcome(tuple(json.loads(rows)), status, message))
            for parameters, status, message, rows in self._select(
                "parameters, status, message, rows", question, settings
            )
            if status != "waiting"
        ]
        return sorted(found, key=lambda pair: pair[0].place())

    def progress(self, question: str, settings: Mapping[str, Value]) -> Progress:
        """How far the question's scan is."""
        found = self._select("status, parameters, message, finished", question, settings)
        counts = {status: sum(row[0] == status for row in found) for status in ("done", "failed", "waiting")}
        failures = sorted(
            ((Case(question, tuple(json.loads(row[1]))), row[2]) for row in found if row[0] == "failed"),
            key=lambda pair: pair[0].place(),
        )
        with self._understood():
            (total,) = self._database.execute("SELECT count(*) FROM cases WHERE question = ?", (question,)).fetchone()
        recent = sorted(row[3] for row in found if row[3] is not None)[-RECENT:]
        pace = (recent[-1] - recent[0]) / (len(recent) - 1) if len(recent) > 1 else None
        left = pace * counts["waiting"] if self.running and pace is not None else None
        return Progress(counts, tuple(failures), total - len(found), self.running, left)


def _key(case: Case, settings: Mapping[str, Value]) -> str:
    return case.key(settings, __version__)


def _plain(value: Any) -> Any:
    """A number of NumPy as one of Python; a missing whole number as nothing."""
    import pandas as pd

    return None if value is pd.NA else value.item()
