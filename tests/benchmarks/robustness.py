"""Cylinder, pearls, branch point, localized pearl on L = 15, over 15 meshes, 4 tolerances and 3 step sizes.

A run succeeds where its branch point is the first one, within 1e-8 of the reference in ``lambda2``, and its localized pearl at
``v = 1.1`` within 1e-7 in ``lambda2``, and stable. The references are those of the finest setting, and the table's
(``pearlbvp localized``).
"""

from __future__ import annotations

import itertools
import shutil

import auto
from rows import Row, row

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


def auto_end(intervals: int, tolerance: float, step: float) -> float:
    """The same by AUTO-07p: ``lambda2`` at the end of the localized pearls; not a number where they are not reached.

    With ``EPSS`` below 1e-3 it gives branch points up that it passes, and at 1e-3 places them to some four digits; what
    branches off has all that its mesh allows, for it ends by an ``EPSS`` of its own.
    """
    folder = auto.built()
    assert folder is not None
    constants = {"NTST": f"{intervals}", "NMX": "2000", "EPSL": f"{tolerance}", "EPSU": f"{tolerance}"}
    constants |= {"DSMAX": f"{step}", "EPSS": "1e-3", "ITMX": "50"}
    auto.run(folder, constants | {"ISP": "2"}, "UZSTOP = {4: 1.012}", halves=2)
    points = [found for found in auto.solutions(folder) if found.kind == auto.BRANCH_POINT]
    if not points:
        return float("nan")
    shutil.copy(folder / "fort.8", folder / "fort.3")
    onward = {"EPSS": "1e-8", "ISP": "0", "IRS": f"{points[0].label}", "ISW": "-1"}
    auto.run(folder, constants | onward, "UZSTOP = {4: 1.1}", halves=2)
    ends = [found.parameters[0] for found in auto.solutions(folder) if found.kind == auto.WANTED]
    return ends[-1] if ends else float("nan")


@row("cylinder, branch point, localized pearl: of 180 settings those that arrive")
def robustness() -> Row:
    """Ours to 1e-8 at the branch point and 1e-7 at the end; AUTO-07p, whose meshes have the size they are given, to less."""
    expected = float(localized_pearls(0.48, 7.5, 15).lambda2.iloc[0])
    _, far, _ = run(48, 1e-11, 0.02)
    settings = list(itertools.product(MESHES, TOLERANCES, STEPS))
    good = 0
    for setting in settings:
        try:
            branch_point, last, unstable = run(*setting)
        except (ValueError, ArithmeticError):
            continue
        good += abs(branch_point - expected) < 1e-8 and abs(last - far) < 1e-7 and unstable == 0
    if auto.built() is None:
        return Row(f"{good} to 1e-7", limit=f"{len(settings)}")
    errors = [abs(auto_end(*setting) - far) for setting in settings]
    coarse, fine = (sum(error < largest for error in errors) for largest in (1e-3, 1e-7))
    return Row(f"{good} to 1e-7", f"AUTO-07p: {coarse} to 1e-3, {fine} to 1e-7", limit=f"{len(settings)}")
