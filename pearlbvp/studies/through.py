"""The branch through a solution that somebody has in hand: of a branch, or solved for again on a mesh."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.following import BranchOptions, continue_branch
from pearlbvp.continuation.solution import Solution
from pearlbvp.errors import InputError
from pearlbvp.studies.branch import known_options, known_point


def through(point: Solution[Any], options: BranchOptions | None = None, *, upwards: bool = True) -> Branch[Any]:
    """The branch through a solution, towards larger or smaller volume at first.

    Args:
        point: the solution; ``studies.mesh.on_mesh`` makes one on a mesh.
        options: where to stop and how to step.
        upwards: whether ``v`` grows at first.

    Raises:
        InputError: it is no solution, or ``v`` does not vary on its branch.
    """
    problem = known_point(point).problem
    if "v" not in getattr(problem, "varying", ()):
        raise InputError("point", "v does not vary on its branch", "resume that branch, or vary it from there")
    if problem.own_mesh(point.u) is not None:
        from pearlbvp.studies.mesh import branch_from

        return branch_from(problem, point.u, known_options(options), upwards=upwards)
    start = point if (point.slopes["v"] > 0) == upwards else replace(point, tangent=-point.tangent)
    return continue_branch(start, known_options(options))
