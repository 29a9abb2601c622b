"""All branches of pearls that are reached from the cylinder, up to a depth: an automatic bifurcation diagram."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from pearlbvp.continuation.branch import Branch, BranchOptions
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.shapes.pearl import Centre, PearlProblem
from pearlbvp.studies.branch import branch_options, pearl_branch, switched

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Diagram:
    """Branches by name.

    Attributes:
        branches: ``3`` is the branch of three equal pearls, ``3/1`` the one that crosses it at its first branch point,
            ``3/1 neck`` that centred on a neck.
        skipped: branch points that were not followed, by name, and why.
    """

    branches: dict[str, Branch[PearlProblem]]
    skipped: dict[str, str]

    def table(self) -> pd.DataFrame:
        """All tables under one another, with the branch's name in the first column."""
        import pandas as pd

        tables = [branch.table().assign(branch=name) for name, branch in self.branches.items()]
        table = pd.concat(tables, ignore_index=True)
        return table[["branch", *(name for name in table if name != "branch")]]


def diagram(
    c0: float,
    length: float,
    depth: int = 1,
    options: BranchOptions | None = None,
    progress: Callable[[str], None] = lambda name: None,
) -> Diagram:
    """Follow every branch of pearls with ``k < 1``, and from their branch points on, to a depth.

    Args:
        c0: spontaneous curvature.
        length: axial period of the tube.
        depth: 0 for branches from the cylinder only, 1 for those that cross them, and so on.
        options: where branches stop and how they step, from ``branch_options``; by default they go to ``v = 1.1``.
        progress: called with the name of each branch before it is followed.

    Returns:
        The branches. A branch point whose new shapes are not axisymmetric, or that was not located, is skipped, and so
        is a branch that has been found before (it starts at the same solution and ends at the same).

    Raises:
        InputError: an argument that cannot be used.
    """
    tube = Tube(c0, length)
    if depth != int(depth) or depth < 0:
        raise InputError(f"depth: {depth} must be a whole number, 0 or more")
    options = options or branch_options({"v": 1.1})
    branches: dict[str, Branch[PearlProblem]] = {}
    skipped: dict[str, str] = {}

    def add(name: str, branch: Branch[PearlProblem], level: int) -> None:
        branches[name] = branch
        if level >= depth:
            return
        for number, special in enumerate(branch.find("bp"), start=1):
            both: tuple[Centre, ...] = ("pearl", "neck") if special.block.parity is None else ("pearl",)
            for centre in both:
                child = f"{name}/{number}" + (" neck" if centre == "neck" else "")
                progress(child)
                try:
                    found = switched(branch, number, options, centre=centre)
                except InputError as error:
                    skipped[child] = str(error)
                    continue
                twin = next((other for other, known in branches.items() if _same(known, found)), None)
                if twin is not None:
                    skipped[child] = f"it is the branch {twin}"
                else:
                    add(child, found, level + 1)

    for m in range(1, math.ceil(tube.length / (2 * math.pi))):
        if tube.wave_number(m) < 1:
            progress(str(m))
            add(str(m), pearl_branch(tube.c0, tube.length, m, options), 0)
    return Diagram(branches, skipped)


def _same(one: Branch[PearlProblem], two: Branch[PearlProblem]) -> bool:
    """Whether two branches start and end at the same solutions, as far as their observables tell."""
    return all(
        abs(one.points[place].observables[name] - two.points[place].observables[name]) < 1e-6
        for place in (0, -1)
        for name in ("lambda1", "v", "E", "r_max")
    )
