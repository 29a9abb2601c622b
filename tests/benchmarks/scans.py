"""Scans: cases a minute, on one process and on two, and what a hundred kills leave of one."""

from __future__ import annotations

import itertools
import os
import random
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from rows import ALONE, Row, row

import pearlbvp as pb

KILLS, SEED = 100, 17
LOCALIZED = {"c0": "0.27:0.49:0.01", "period": "critical", "L": "15:301:6.5"}
TWICE = {**LOCALIZED, "c0": "0.27:0.49:0.005"}
"""Long enough for the second in which workers start to be small beside it."""


def _seconds(workers: int, parameters: dict[str, str]) -> tuple[float, float, int]:
    """Wall-clock and CPU seconds of a localized scan, and its rows."""
    with tempfile.TemporaryDirectory() as folder:
        begun, before = time.perf_counter(), os.times()
        store = Path(folder) / "scan.sqlite"
        table = pb.scan("localized", store, workers=workers, progress=False, **parameters)  # type: ignore[arg-type]
        seconds, after = time.perf_counter() - begun, os.times()
    return seconds, sum(after[:4]) - sum(before[:4]), len(table)


def _beside_one(parameters: dict[str, str]) -> Row:
    """Two processes, with the time that they take to start, beside one that has started."""
    pb.localized_pearls(0.48, 7.5, 15)
    one, cpu, cases = _seconds(1, parameters)
    two, both, _ = _seconds(2, parameters)
    return Row(
        f"{two:.1f} s, CPU {both:.1f} s",
        f"one process: {one:.1f} s, CPU {cpu:.1f} s, {60 * cases / one:,.0f} cases a minute",
        f"{one / two:.2f}",
    )


@row("scan of localized pearls, c0 from 0.27 to 0.49: 1,035 cases on two processes, wall clock")
def localized() -> Row:
    """The table of 1,000 cases."""
    return replace(_beside_one(LOCALIZED), limit="20 s")


@row("scan of localized pearls, c0 from 0.27 to 0.49: 2,025 cases on two processes, wall clock")
def localized_twice() -> Row:
    """What a second process brings."""
    return replace(_beside_one(TWICE), limit="ratio 1.8 or more")


def _finished(store: Path) -> dict[str, float]:
    """When each finished case was finished."""
    if not store.exists():
        return {}
    with sqlite3.connect(f"file:{store}?mode=ro", uri=True) as database:
        try:
            return dict(database.execute("SELECT key, finished FROM cases WHERE status = 'done'"))
        except sqlite3.OperationalError:  # killed before it had a table
            return {}


@row(f"scan killed at {KILLS} random moments and resumed: cases lost, computed twice, other bytes in the table")
def killed() -> Row:
    """The whole group is killed; a finished case must stay as it is, and the table be that of a scan in peace."""
    moments = random.Random(SEED)
    lost = twice = hit = 0
    with tempfile.TemporaryDirectory() as folder:
        for attempt in itertools.count():
            store = Path(folder) / "killed.sqlite"
            command = [sys.executable, "-m", "pearlbvp", "scan", "dispersion", "--c0=-20:0.48:0.16", "--lengths", "10:300:5",
                       "--store", str(store), "--workers", "2", "--out", str(Path(folder) / "killed.csv")]  # fmt: skip
            before = _finished(store)
            scan = subprocess.Popen(command, env=ALONE, start_new_session=True, stderr=subprocess.DEVNULL)
            if attempt == KILLS:
                scan.wait()
            else:
                time.sleep(moments.uniform(0.5, 3.0))
                if scan.poll() is None:
                    hit += 1
                    os.killpg(scan.pid, signal.SIGKILL)
                scan.wait()
            after = _finished(store)
            lost += len(before.keys() - after.keys())
            twice += sum(after[key] != when for key, when in before.items() if key in after)
            if attempt == KILLS:
                break
        peace = [word.replace("killed", "peace") for word in command]
        subprocess.run(peace, env=ALONE, check=True, capture_output=True)
        same = (Path(folder) / "killed.csv").read_bytes() == (Path(folder) / "peace.csv").read_bytes()
    return Row(
        f"{lost} lost, {twice} twice, {'the same' if same else 'OTHER'} bytes; {hit} kills of a scan at work",
        limit="0, 0, the same",
    )
