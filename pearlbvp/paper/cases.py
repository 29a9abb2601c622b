"""The branches and the samples of the paper's cases. A branch that several figures show is followed once."""

from __future__ import annotations

from functools import cache
from typing import Any

from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.solution import Solution
from pearlbvp.helfrich import Tube, WaveNumbers
from pearlbvp.studies.branch import Discretization, branch_options, family_branch
from pearlbvp.studies.onward import switched
from pearlbvp.studies.point import chosen
from pearlbvp.studies.shape import shape_branch


@cache
def primary(
    c0: float,
    length: float,
    family: str,
    mode: WaveNumbers,
    column: str,
    value: float,
    *,
    max_step: float = 0.5,
    discretization: Discretization | None = None,
) -> Branch[Any]:
    """A branch from the straight tube, as far as a column has a value (special points: their number)."""
    options = branch_options({column: value}, max_step=max_step)
    return family_branch(Tube(c0, length), family, mode, options, discretization=discretization)


@cache
def secondary(number: int, v: float | None, *of: Any) -> Branch[Any]:
    """The branch that crosses a ``primary`` one, of these arguments, at its branch point of that number.

    Args:
        number: of the branch point.
        v: volume at which it ends, None for as far as it goes.
        of: arguments of ``primary``.
    """
    return switched(primary(*of), number, branch_options({} if v is None else {"v": v}))


@cache
def unequal_pearls() -> Branch[Any]:
    """P of Fig. c1f1: two pearls of different size, found as a shape of least energy."""
    return shape_branch(0.75, 10, 1.0, [-0.28, 0.47], branch_options({"v": 1.15}, max_points=60))


def at(branch: Branch[Any], place: str) -> Solution[Any]:
    """A point of a branch, by what ``studies.point.chosen`` takes: ``v=1.02``, ``bp:1``, a number."""
    return chosen(branch, place)
