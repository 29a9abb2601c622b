"""AUTO-07p on the half cell of pearls: its executable, built from its library (Debian: ``auto-07p``, with ``gfortran``)."""

from __future__ import annotations

import functools
import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from rows import of_process

LIBRARY = Path("/usr/lib/auto-07p/lib")

DIGITS = 1.5e-10
"""Error of ``lambda2`` below which the eleven digits of ``fort.8`` show none."""

BRANCH_POINT, WANTED = 6, -4
"""Types of solutions in ``fort.8``: a branch point, a value of ``UZSTOP``."""


@functools.cache
def built() -> Path | None:
    """The folder of the executable; None where AUTO-07p is not installed."""
    if shutil.which("gfortran") is None or not LIBRARY.is_dir():
        return None
    folder = Path(tempfile.mkdtemp(prefix="pearlbvp-auto-"))
    for file in ("pearl.f90", "c.pearl"):
        shutil.copy(Path(__file__).parent / "auto07p" / file, folder)
    objects = sorted(str(path) for path in LIBRARY.glob("*.o"))
    command = ["gfortran", "-O3", "-fopenmp", "-fallow-argument-mismatch", "pearl.f90", *objects, "-o", "pearl.exe"]
    subprocess.run(command, cwd=folder, check=True)
    return folder


def run(folder: Path, constants: dict[str, str], more: str = "", halves: int = 1) -> float:
    """CPU seconds of one run with some constants changed, its start included, which takes milliseconds.

    Args:
        folder: of the executable.
        constants: those of ``c.pearl`` that change.
        more: further lines of constants.
        halves: half pearls on half of the tube: 1 for a period of their own, 2 for two pearls.
    """
    text = (folder / "c.pearl").read_text()
    for name, value in constants.items():
        text = re.sub(rf"\b{name} = [^,\n]*", f"{name} = {value}", text)
    (folder / "fort.2").write_text(f"{text}\n{more}\n")
    return of_process([str(folder / "pearl.exe")], str(folder), HALVES=str(halves))


@dataclass(frozen=True)
class Written:
    """A solution in ``fort.8``: its type, label and parameters.

    The parameters are ``lambda2, lambda1, arclength, v, c0`` and the length of the half tube.
    """

    kind: int
    label: int
    parameters: list[float]


def solutions(folder: Path) -> list[Written]:
    """All solutions that the last run wrote."""
    lines, found = (folder / "fort.8").read_text().splitlines(), []
    while lines:
        header = [int(word) for word in lines[0].split()[:9]]
        block, lines = lines[1 : 1 + header[8]], lines[1 + header[8] :]
        found.append(Written(header[2], header[3], [float(word) for word in " ".join(block[-6:]).split()][:6]))
    return found
