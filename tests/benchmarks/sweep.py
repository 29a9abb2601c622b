"""A thousand branches over the whole range of tubes, modes and steps: right answers or reasons, and their CPU time.

python tests/benchmarks/sweep.py [cases] [first seed] [seconds a case]
"""

from __future__ import annotations

import faulthandler
import signal
import sys
import time
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent))

from support.sweep import drawn, faults


class TooLong(BaseException):
    """A case that takes too long."""


def main() -> None:
    """Print what is wrong, and a summary."""
    count, first, seconds = (int(text) for text in (sys.argv[1:4] + ["1000", "0", "60"][len(sys.argv) - 1 :]))
    faulthandler.enable()

    def late(number: int, frame: object) -> None:
        where = "".join(traceback.format_stack(frame)[-6:])  # type: ignore[arg-type]
        raise TooLong(where)

    signal.signal(signal.SIGPROF, late)
    bad, times = 0, []
    for seed in range(first, first + count):
        case, before = drawn(seed), time.process_time()
        try:
            signal.setitimer(signal.ITIMER_PROF, seconds)
            found, branch = faults(case)
            signal.setitimer(signal.ITIMER_PROF, 0)
        except TooLong as error:
            found, branch = [f"over {seconds} s\n{error}"], None
        except Exception:
            signal.setitimer(signal.ITIMER_PROF, 0)
            found, branch = [traceback.format_exc(limit=-6)], None
        times.append(time.process_time() - before)
        if (branch is not None and len(sys.argv) > 4) or times[-1] > 5:
            v = branch.points[-1].observables["v"] if branch else float("nan")
            print(
                f"{seed}: {case} {times[-1]:.1f} s, {len(branch.points) if branch else 0} points to v={v:.6f}: "
                f"{branch.reason if branch else ''}",
                flush=True,
            )
        if found:
            bad += 1
            print(f"WRONG {seed}: {case}: {times[-1]:.1f} s: " + "; ".join(found[:3]), flush=True)
    times.sort()
    print(
        f"{count} cases, {bad} wrong; median {times[count // 2]:.2f} s, 99 of 100 within {times[int(0.99 * count)]:.1f} s, "
        f"longest {times[-1]:.1f} s"
    )


if __name__ == "__main__":
    main()
