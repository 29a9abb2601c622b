"""Pearls of all periods from series: CPU time of scans over lengths, and how far they are from a continuation each.

python tests/benchmarks/series.py [values of c0] [lengths of each]
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time

import numpy as np

from pearlbvp.atlas import localized
from pearlbvp.studies.first_pearls import first_pearls
from pearlbvp.studies.localized import losses_at
from pearlbvp.theory.dispersion import stable_wave_numbers

COMMANDS = ("--c0 0.3,0.48 --lengths 7.5:120:0.5", "--c0 0.48 --lengths 7.5:1007.4:0.1", "--c0 0.48 --lengths 15")


def command(question: str) -> float:
    """CPU seconds of a whole ``pearlbvp period``, the least of three."""
    times = []
    for _ in range(3):
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        with tempfile.TemporaryDirectory() as folder:
            arguments = ["period", *question.split(), "--processes", "1", "--out", f"{folder}/p.csv"]
            subprocess.run([sys.executable, "-m", "pearlbvp", *arguments], check=True)
        times.append(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before)
    return min(times)


def compared(c0: float, lengths: list[float]) -> tuple[int, int, float, float, float]:
    """Rows with several pearls, rows that differ in what they say, the largest difference, and both CPU times."""
    start = time.process_time()
    found, _ = first_pearls(c0, lengths)
    middle = time.process_time()
    rows, differing, largest = 0, 0, 0.0
    for one in found:
        if one.pearls is None or one.pearls == 1:
            continue
        (alone,) = losses_at(c0, one.tube.length / one.pearls, [one.pearls])
        rows += 1
        if (alone.status, alone.message) != (one.outcome.status, one.outcome.message):
            differing += 1
        elif alone.values is not None and one.outcome.values is not None:
            largest = max(largest, float(np.abs(np.subtract(alone.values, one.outcome.values)).max()))
    return rows, differing, largest, middle - start, time.process_time() - middle


def looked_up(count: int) -> None:
    """Print what the atlas's numbers are worth at random places, and what they cost."""
    random = np.random.default_rng(0)
    c0, pearls = random.uniform(0.26, 0.49, 100_000), random.integers(2, 41, 100_000)
    low, high = stable_wave_numbers(c0, pearls)
    period = 2 * np.pi / (low + random.uniform(0.001, 0.999, c0.size) * (high - low))
    start = time.process_time()
    found = np.array(localized(c0, period, pearls)).T
    each = (time.process_time() - start) / c0.size
    errors = [
        np.abs(np.subtract(losses_at(c0[i], period[i], [int(pearls[i])])[0].values, found[i])) for i in range(count)
    ]
    print(f"atlas: {1e6 * each:.1f} microseconds; off by {np.max(errors):.0e} at {count} places")


def main() -> None:
    """Print the tables."""
    count, many = (int(text) for text in (sys.argv[1:3] + ["20", "200"][len(sys.argv) - 1 :]))
    for question in COMMANDS:
        print(f"pearlbvp period {question:40s} {command(question):6.2f} s")
    looked_up(10 * count)
    random = np.random.default_rng(0)
    for c0 in sorted(random.uniform(0.255, 0.505, count)):
        lengths = random.uniform(8, 200 if c0 > 0.28 else 600, many).tolist()
        rows, differing, largest, fast, slow = compared(float(c0), lengths)
        print(
            f"c0 = {c0:.4f}: {rows:4d} rows, {differing} differ in status or message, numbers by {largest:.0e}; "
            f"{fast:.2f} s, {slow:.2f} s one by one"
        )


if __name__ == "__main__":
    main()
