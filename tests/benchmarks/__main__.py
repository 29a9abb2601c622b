"""All benchmarks, into one table: ``python tests/benchmarks [WORD ...]``; with words, only the works that contain one.

The rows are written to ``docs/benchmarks.md``, too; those that were not measured stay there as they are.
"""

from __future__ import annotations

import os

os.environ.update({"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import commands  # noqa: F401  each registers its rows
import flow  # noqa: F401
import mesh  # noqa: F401
import robustness  # noqa: F401
import scans  # noqa: F401
import series  # noqa: F401
import tubes  # noqa: F401
from rows import ROWS

import pearls  # noqa: F401

PAGE = Path(__file__).parents[2] / "docs" / "benchmarks.md"
MARK = "<!-- measured by: python tests/benchmarks -->\n"


def main(words: list[str]) -> None:
    """Measure, print row by row, and write the page."""
    head, _, table = PAGE.read_text().partition(MARK)
    title = ["| work | ours | peer | peer / ours | limit |", "|---|---|---|---|---|"]
    rows = {line.split(" | ")[0].removeprefix("| "): line for line in table.splitlines()[3:]}
    print(*title, sep="\n")
    for work, measure in ROWS.items():
        if not words or any(word in work for word in words):
            found = measure()
            rows[work] = f"| {work} | {found.ours} | {found.peer} | {found.ratio} | {found.limit} |"
            print(rows[work], flush=True)
    lines = title + [rows[work] for work in ROWS if work in rows]
    PAGE.write_text(f"{head}{MARK}\n" + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
