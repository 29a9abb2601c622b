"""Branches as trees of arrays, numbers and words, to be saved and read back; see ``hdf5`` for the files.

Layout: ``kind, reason, complete, failed``; ``problems/0 ...`` (each mesh once); ``points/0 ...`` with ``u, tangent``, the
number of their problem, their ``observables`` and ``spectrum``; ``special/0 ...``. Problems, spectra describe
themselves (``to_tree``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from pearlbvp.continuation.branch import Branch, BranchPoint, SpecialPoint
from pearlbvp.continuation.path import Point

KIND = "pearlbvp branch"
"""What files of branches call themselves."""

UNDEFINED = ("residual",)
"""Numbers that may be NaN: the error of growth rates, where no rigid motion tells it."""

Reader = Callable[[Mapping[str, Any]], Any]


def branch_tree(branch: Branch[Any]) -> dict[str, Any]:
    """A branch as a tree."""
    kind: Any = branch.points[0].point.problem
    problems = {id(entry.point.problem): entry.point.problem for entry in branch.points}
    numbers = {known: number for number, known in enumerate(problems)}
    return {
        "kind": kind.stored_as,
        "reason": str(branch.reason),  # a sentence with numbers as it is in radii, like all that is saved
        "complete": branch.complete,
        "failed": branch.failed,
        "problems": {str(number): problem.to_tree() for number, problem in enumerate(problems.values())},
        "points": {
            str(index): _point_tree(entry, numbers[id(entry.point.problem)])
            for index, entry in enumerate(branch.points)
        },
        "special": {str(i): _special_tree(found, branch) for i, found in enumerate(branch.special)},
    }


def _point_tree(entry: BranchPoint[Any], problem: int) -> dict[str, Any]:
    point = entry.point
    return {
        "u": point.u, "tangent": point.tangent, "problem": problem, "iterations": point.iterations, "step": point.step,
        "observables": point.observables, "spectrum": entry.spectrum.to_tree(),
    }  # fmt: skip


def _special_tree(found: SpecialPoint[Any], branch: Branch[Any]) -> dict[str, Any]:
    low, high = found.interval
    tree = {
        "kind": found.kind, "index": found.index, "change": found.change, "converged": found.converged,
        "low": low, "high": high,
    }  # fmt: skip
    if found.block is None:
        return tree
    return tree | {"block": list(branch.points[found.index].spectrum.rates).index(found.block)}


def branch_of_tree(tree: Mapping[str, Any], kinds: Mapping[str, tuple[Reader, Reader]]) -> Branch[Any]:
    """The inverse of ``branch_tree``.

    Args:
        tree: as ``branch_tree`` makes it.
        kinds: for each kind of problem the inverses of its and its spectra's ``to_tree``.

    Raises:
        ValueError, LookupError, TypeError: something is missing in the tree, or does not fit.
    """
    problem_from, spectrum_from = kinds[tree["kind"]]
    problems = [problem_from(problem) for problem in _in_order(tree["problems"])]
    points = [_point(point, problems, spectrum_from) for point in _in_order(tree["points"])]
    if not points:
        raise ValueError("a branch without points")
    special = [_special(found, points) for found in _in_order(tree["special"])]
    return Branch(points, special, str(tree["reason"]), bool(tree["complete"]), bool(tree.get("failed", False)))


def _in_order(trees: Mapping[str, Any]) -> list[Any]:
    return [trees[str(i)] for i in range(len(trees))]


def _point(tree: Mapping[str, Any], problems: list[Any], spectrum_from: Reader) -> BranchPoint[Any]:
    problem, u, tangent = problems[tree["problem"]], tree["u"], tree["tangent"]
    if u.shape != tangent.shape:
        raise ValueError("a point's unknown and tangent do not fit")
    order = problem.observables(u)  # files sort names; this also fails where u does not fit its mesh
    observables = {name: float(tree["observables"][name]) for name in order}
    point = Point(problem, u, tangent, observables, int(tree["iterations"]), float(tree["step"]))
    spectrum = spectrum_from(tree["spectrum"])
    if not math.isfinite(spectrum.mu_crit):  # this also fails where a block has no rates
        raise ValueError("a point's growth rates do not fit")
    return BranchPoint(point, spectrum)


def _special(tree: Mapping[str, Any], points: list[BranchPoint[Any]]) -> SpecialPoint[Any]:
    index = int(tree["index"])
    blocks = list(points[index].spectrum.rates)
    block = blocks[tree["block"]] if "block" in tree else None
    interval = float(tree["low"]), float(tree["high"])
    return SpecialPoint(str(tree["kind"]), index, block, int(tree["change"]), bool(tree["converged"]), interval)
