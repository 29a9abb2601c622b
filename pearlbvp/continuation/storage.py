"""Branches as trees of arrays, numbers and words, to be saved and read back; see ``hdf5`` for the files.

Layout: ``kind, status, reason``; ``problems/0 ...`` (each mesh once); ``points/0 ...`` with ``u, tangent``, the
number of their problem, their ``observables`` and ``spectrum``; ``special/0 ...``. Problems, spectra describe
themselves (``to_tree``).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pearlbvp.continuation.branch import Branch, SpecialPoint, Status
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.spectrum import Spectrum

KIND = "pearlbvp branch"
"""What files of branches call themselves."""

UNDEFINED = ("residual",)
"""Numbers that may be NaN: the error of growth rates, where no rigid motion tells it."""


def branch_tree(branch: Branch[Any]) -> dict[str, Any]:
    """A branch as a tree."""
    problems = {id(entry.problem): entry.problem for entry in branch.points}
    numbers = {known: number for number, known in enumerate(problems)}
    return {
        "kind": branch.points[0].problem.stored_as,
        "reason": str(branch.reason),  # a sentence with numbers as it is in radii, like all that is saved
        "status": branch.status.value,
        "problems": {str(number): problem.to_tree() for number, problem in enumerate(problems.values())},
        "points": {
            str(index): _point_tree(entry, numbers[id(entry.problem)]) for index, entry in enumerate(branch.points)
        },
        "special": {str(i): _special_tree(found, branch) for i, found in enumerate(branch.special)},
    }


def _point_tree(entry: Solution[Any], problem: int) -> dict[str, Any]:
    return {
        "u": entry.u, "tangent": entry.tangent, "problem": problem, "iterations": entry.iterations, "step": entry.step,
        "observables": entry.observables, "spectrum": entry.spectrum.to_tree(),
    }  # fmt: skip


def _special_tree(found: SpecialPoint, branch: Branch[Any]) -> dict[str, Any]:
    low, high = found.interval
    tree = {
        "kind": found.kind, "index": found.index, "change": found.change, "converged": found.converged,
        "low": low, "high": high,
    }  # fmt: skip
    if found.block is None:
        return tree
    return tree | {"block": list(branch.points[found.index].spectrum.rates).index(found.block)}


def branch_of_tree(tree: Mapping[str, Any], kinds: Mapping[str, Any]) -> Branch[Any]:
    """The inverse of ``branch_tree``.

    Args:
        tree: as ``branch_tree`` makes it.
        kinds: classes of problems, by what files call them.

    Raises:
        ValueError, LookupError, TypeError: something is missing in the tree, or does not fit.
    """
    problems = [kinds[tree["kind"]].from_tree(problem) for problem in _in_order(tree["problems"])]
    points = [_point(point, problems) for point in _in_order(tree["points"])]
    if not points:
        raise ValueError("a branch without points")
    special = [_special(found, points) for found in _in_order(tree["special"])]
    return Branch(points, special, Status(tree["status"]), str(tree["reason"]))


def _in_order(trees: Mapping[str, Any]) -> list[Any]:
    return [trees[str(i)] for i in range(len(trees))]


def _point(tree: Mapping[str, Any], problems: list[Any]) -> Solution[Any]:
    problem, u, tangent = problems[tree["problem"]], tree["u"], tree["tangent"]
    if u.shape != tangent.shape:
        raise ValueError("a point's unknown and tangent do not fit")
    spectrum = Spectrum.from_tree(tree["spectrum"], problem.block)
    if spectrum.rates and not math.isfinite(spectrum.mu_crit):  # this also fails where a block has no rates
        raise ValueError("a point's growth rates do not fit")
    solution = Solution(problem, u, tangent, int(tree["iterations"]), float(tree["step"]), spectrum)
    return solution.computed()  # fails where u does not fit its mesh


def _special(tree: Mapping[str, Any], points: list[Solution[Any]]) -> SpecialPoint:
    index = int(tree["index"])
    blocks = list(points[index].spectrum.rates)
    block = blocks[tree["block"]] if "block" in tree else None
    interval = float(tree["low"]), float(tree["high"])
    return SpecialPoint(str(tree["kind"]), index, block, int(tree["change"]), bool(tree["converged"]), interval)
