"""Cylinder, pearls, branch point, localized pearl on L = 15, over 15 meshes, 4 tolerances and 3 step sizes.

Run as ``python tests/benchmarks/robustness.py``. A run succeeds where its branch point is the first one, within 1e-8 of the
reference in ``lambda2``, and its localized pearl at ``v = 1.1`` within 1e-7 in ``lambda2``, and stable. The references are
those of the finest setting, and the table's (``pearlbvp localized``).
"""

from __future__ import annotations

import itertools
import os
import time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from pearlbvp.continuation.following import continue_branch
from pearlbvp.continuation.solution import Solution
from pearlbvp.helfrich import Tube
from pearlbvp.shapes.pearling import pearling_onset
from pearlbvp.studies.branch import branch_options
from pearlbvp.studies.localized import localized_pearls
from pearlbvp.studies.onward import switched

MESHES = (4, 5, 6, 7, 8, 9, 10, 12, 14, 16, 20, 24, 28, 32, 40)
TOLERANCES = (1e-7, 1e-8, 1e-9, 1e-10)
STEPS = (0.02, 0.1, 0.4)


def run(intervals: int, tolerance: float, step: float) -> tuple[float, float, int]:
    """``lambda2`` at the first branch point, ``lambda2`` of the localized pearl at v = 1.1, and its unstable count."""
    problem, u, tangent = pearling_onset(Tube(0.48, 15), 2, intervals=intervals, tolerance=tolerance)
    options = {"step": step, "max_step": 5 * step, "max_points": 2000}
    pearls = continue_branch(
        Solution.along(problem, u, tangent), branch_options({"v": 1.012}, **options), at_bifurcation=True
    )
    localized = switched(pearls, 1, branch_options({"v": 1.1}, **options))
    last = localized.points[-1]
    branch_point = pearls.at(pearls.find("bp")[0]).observables["lambda2"]
    return branch_point, last.observables["lambda2"] if localized.complete else float("nan"), last.spectrum.n_unstable


def main() -> None:
    """Print the runs that failed and how many did not."""
    expected = float(localized_pearls(0.48, 7.5, 15).lambda2.iloc[0])
    _, far, _ = run(48, 1e-11, 0.02)
    good, start, settings = 0, time.perf_counter(), list(itertools.product(MESHES, TOLERANCES, STEPS))
    for setting in settings:
        try:
            branch_point, last, unstable = run(*setting)
        except (ValueError, ArithmeticError) as error:
            print(setting, error)
            continue
        if abs(branch_point - expected) < 1e-8 and abs(last - far) < 1e-7 and unstable == 0:
            good += 1
        else:
            print(setting, f"{branch_point - expected:.1e} {last - far:.1e} {unstable} unstable")
    print(f"{good} of {len(settings)} runs arrive, in {time.perf_counter() - start:.0f} s")


if __name__ == "__main__":
    main()
