"""Pearls of period 7.5 at c0 = 0.48, their whole branch and a branch point on it, beside AUTO-07p at equal error.

Errors are those of ``lambda2``, against our own finest setting, which two other meshes confirm to 2e-12. Of AUTO's
settings the fastest is taken that is at least as accurate as ours, or shows no error in its eleven digits.
"""

from __future__ import annotations

import itertools

import auto
from rows import Row, least, of_call, paired, row, written

from pearlbvp.continuation import PathOptions, Solution, follow
from pearlbvp.continuation.segment import Segment
from pearlbvp.helfrich import Tube
from pearlbvp.shapes.pearling import pearling_onset
from pearlbvp.studies.localized import PeriodicPearls, localized_pearls

END = 1.15


def end_of_branch(degree: int, intervals: int, tolerance: float, max_step: float) -> float:
    """``lambda2`` at the end of the branch."""
    problem, u, tangent = pearling_onset(Tube(0.48, 7.5), degree=degree, intervals=intervals, tolerance=tolerance)
    options = PathOptions(step=0.05, max_step=max_step, max_points=5000)
    path = follow(Solution(problem, u, tangent), options, lambda p: "past" if p.observables["v"] >= END else None)
    before, last = path.points[-2:]
    found = Segment(before, last).root(lambda p: p.observables["v"] - END, before.observables["v"] - END)
    return found.observables["lambda2"]


def auto_settings(exact: float) -> list[tuple[float, float, dict[str, str]]]:
    """CPU seconds, error and constants of AUTO-07p for ``NCOL`` 4 to 7, several meshes and longest steps."""
    folder, found = auto.built(), []
    assert folder is not None
    for degree, intervals, step in itertools.product(
        (4, 5, 6, 7), (10, 15, 20, 25, 30, 40, 60), ("0.05", "0.2", "0.5", "2.0")
    ):
        constants = {"NCOL": str(degree), "NTST": str(intervals), "DSMAX": step, "NMX": "5000", "EPSS": "1e-8"}
        seconds = auto.run(folder, constants, f"UZSTOP = {{4: {END}}}")
        lambda2, _, _, v, _, _ = auto.solutions(folder)[-1].parameters
        if abs(v - END) < 1e-9:
            found.append((seconds, abs(lambda2 - exact), constants))
    return found


def against_auto(degree: int, intervals: int, tolerance: float, max_step: float) -> Row:
    """One of our settings beside AUTO's best."""
    exact = end_of_branch(7, 60, 1e-12, 0.1)
    error = abs(end_of_branch(degree, intervals, tolerance, max_step) - exact)
    folder = auto.built()
    if folder is None:
        return Row(f"{of_call(lambda: end_of_branch(degree, intervals, tolerance, max_step)):.3f} s, error {error:.0e}")
    as_good = [setting for setting in auto_settings(exact) if setting[1] <= max(error, auto.DIGITS)]
    _, other, constants = min(as_good, key=lambda setting: setting[0])
    ours, peer, ratio = paired(
        lambda: of_call(lambda: end_of_branch(degree, intervals, tolerance, max_step)),
        lambda: auto.run(folder, constants, f"UZSTOP = {{4: {END}}}"),
    )
    shown = f"error {other:.0e}" if other > auto.DIGITS else "no error in 11 digits"
    setting = f"NCOL {constants['NCOL']}, NTST {constants['NTST']}"
    return Row(f"{written(ours)}, error {error:.0e}", f"AUTO-07p: {written(peer)}, {shown} ({setting})", ratio)


@row(f"pearls from onset to v = {END}, 8 to 9 digits")
def loose() -> Row:
    """The error that a picture's reader cannot see, ten times over."""
    return against_auto(6, 6, 1e-5, 0.5)


@row(f"pearls from onset to v = {END}, 11 digits")
def tight() -> Row:
    """The package's default."""
    return against_auto(7, 8, 1e-8, 1.0)


BRANCH_POINT = {"ISP": "2", "EPSS": "1e-6", "ITMX": "50", "NMX": "3000"}
"""AUTO's constants for a branch point: with a smaller ``EPSS`` it gives most of them up."""


def branch_point_beside_auto(largest: float | None) -> Row:
    """Ours by default, beside AUTO's fastest setting with at most an error, or its most accurate one."""

    def ours() -> float:
        return float(localized_pearls(0.48, 7.5, 15).lambda2[0])

    exact = PeriodicPearls.trace(0.48, 7.5, 2, intervals=24, degree=7).rows([2])[0]["lambda2"]
    assert isinstance(exact, float)
    own, folder = abs(ours() - exact), auto.built()
    if folder is None:
        return Row(f"{written(least(lambda: of_call(ours)))}, error {own:.0e}")
    found, more = [], "UZSTOP = {4: 1.012}"
    for degree, intervals, step in itertools.product((4, 5, 6, 7), (10, 15, 20, 30, 40), ("0.02", "0.05", "0.1")):
        constants = BRANCH_POINT | {"NCOL": str(degree), "NTST": str(intervals), "DSMAX": step}
        seconds = auto.run(folder, constants, more, halves=2)
        places = [solution.parameters[0] for solution in auto.solutions(folder) if solution.kind == auto.BRANCH_POINT]
        found += [(seconds, abs(place - exact), constants) for place in places[:1]]
    if largest is None:
        _, error, constants = min(found, key=lambda setting: setting[1])
    else:
        _, error, constants = min(setting for setting in found if setting[1] <= largest)
    own_seconds, peer, ratio = paired(lambda: of_call(ours), lambda: auto.run(folder, constants, more, halves=2))
    setting = f"NCOL {constants['NCOL']}, NTST {constants['NTST']}, DSMAX {constants['DSMAX']}"
    return Row(
        f"{written(own_seconds)}, error {own:.0e}", f"AUTO-07p: {written(peer)}, error {error:.0e} ({setting})", ratio
    )


@row("branch point of the localized pearl, L = 15, 7 digits")
def branch_point() -> Row:
    """What AUTO-07p reaches soonest."""
    return branch_point_beside_auto(1e-7)


@row("branch point of the localized pearl, L = 15, all digits that there are")
def exact_branch_point() -> Row:
    """What AUTO-07p reaches at best."""
    return branch_point_beside_auto(None)


@row("localized table of 1,000 lengths, in process")
def many_lengths() -> Row:
    """All from one continuation; beside it what four lengths take."""
    few, many = ([7.5 * n for n in range(2, 2 + count)] for count in (4, 1000))
    seconds, four = (least(lambda n=n: of_call(lambda: localized_pearls(0.48, 7.5, n))) for n in (many, few))  # type: ignore[misc]
    return Row(f"{written(seconds)} (4 lengths: {written(four)})", limit="twice the time of 4 lengths")
