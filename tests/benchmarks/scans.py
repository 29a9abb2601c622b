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
from pathlib import Path

from rows import ALONE, Row, row

import pearlbvp as pb

KILLS, SEED = 100, 17
LOCALIZED = {"c0": "0.27:0.49:0.01", "period": "critical", "L": "15:301:6.5"}


def _seconds(workers: int, folder: str) -> tuple[float, int]:
    """Wall-clock seconds and rows of the localized scan."""
    begun = time.perf_counter()
    table = pb.scan("localized", Path(folder) / f"{workers}.sqlite", workers=workers, progress=False, **LOCALIZED)
    return time.perf_counter() - begun, len(table)


@row("scan of localized pearls, c0 from 0.27 to 0.49: 1,035 cases on two processes, wall clock")
def localized() -> Row:
    """Two processes beside one, with the time that they take to start."""
    with tempfile.TemporaryDirectory() as folder:
        pb.localized_pearls(0.48, 7.5, 15)
        one, cases = _seconds(1, folder)
        two, _ = _seconds(2, folder)
    return Row(
        f"{two:.1f} s", f"one process: {one:.1f} s, {60 * cases / one:,.0f} cases a minute", f"{one / two:.1f}", "20 s"
    )


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
    lost = twice = 0
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
    return Row(f"{lost} lost, {twice} twice, {'the same' if same else 'OTHER'} bytes", limit="0, 0, the same")
