"""Whole commands, start-up included, with compiled loops at hand."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from rows import Row, least, of_process, row, written

FOLDER = Path(tempfile.mkdtemp(prefix="pearlbvp-benchmarks-"))
"""Where commands save what others begin with."""

PEARLS = f"branch pearl --c0 0.48 --length 15 --mode 2,0 --until v=1.015 --save {FOLDER / 'b.h5'}"

COMMANDS = {
    "localized --c0 0.48 --period 7.5 --lengths 15,30,45,60": 1.0,
    PEARLS: 1.5,
    "branch ring --c0=-1 --length 10": 1.5,
    "branch coil --c0 0 --length 10 --until v=0.94": 1.5,
    "period --c0 0.3,0.48 --lengths 7.5:120:0.5 --processes 1": 2.0,
    "period --c0 0.48 --lengths 7.5:1007.4:0.1 --processes 1": 4.0,
    f"flow --from {FOLDER / 'b.h5'} --perturb critical --delta 0.02 --keep": 1.5,
}
"""Limits of their CPU seconds."""


def _measured(command: str, limit: float) -> Callable[[], Row]:
    def measure() -> Row:
        if "--from" in command:
            of_process([sys.executable, "-m", "pearlbvp", *PEARLS.split()])
        seconds = least(lambda: of_process([sys.executable, "-m", "pearlbvp", *command.split()]))
        return Row(written(seconds), limit=written(limit))

    return measure


for _command, _limit in COMMANDS.items():
    row(f"`pearlbvp {_command.replace(f'{FOLDER}/', '')}`")(_measured(_command, _limit))
