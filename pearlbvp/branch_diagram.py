"""All branches that are reached from the straight tube, with the verbs of an ordinary analysis: nothing is computed here."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from pearlbvp.branches import Branch, Until
from pearlbvp.continuation import branch as core
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, WaveNumbers, known_tube
from pearlbvp.progress import progress
from pearlbvp.studies import diagram as study
from pearlbvp.studies.branch import branch_options, known_branch
from pearlbvp.units import RADII, Units

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Diagram(study.Diagram):
    """Branches by name: ``branches["3/1"]`` is what crosses three equal pearls at their first branch point."""

    def plot(self, x: str = "v", y: str = "E", title: str = "", units: Units = RADII) -> Figure:
        """Two columns of all branches, unstable parts dashed, special points marked.

        Raises:
            InputError: there is no such column.
        """
        from pearlbvp.figures.diagram import draw_plane

        table = units.columns(self.table())
        for name in (x, y):
            if name not in table:
                raise InputError("column", f"{name} is not in the table", f"take one of {', '.join(map(str, table))}")
        return draw_plane(table, x, y, title, units)


def diagram(
    tube: Tube | Mapping[str, core.Branch[Any]],
    depth: int = 1,
    *,
    modes: Iterable[WaveNumbers] | None = None,
    until: Until | None = None,
    processes: int = 0,
) -> Diagram:
    """All branches from the straight tube, and from their branch points on, to a depth; or branches that there are, together.

    Args:
        tube: the straight tube; or branches by name, of which nothing is computed and the other arguments say nothing.
        depth: 0 for branches from the straight tube only, 1 for those that cross them, too, and so on.
        modes: follow every family of these; by default all pearls of ``k < 1``.
        until: where every branch stops.
        processes: how many to work in; 0 for one a core.

    Returns:
        Branches by name (``branches``), and why others were not followed (``skipped``); ``table()`` and ``plot()``. Where it is
        interrupted, what there is, and ``complete`` is false.

    Raises:
        InputError: an argument that cannot be used.

    Example:
        ``pb.diagram(pb.Tube(c0=0.48, L=15), until={"v": 1.05}).plot("v", "lambda2")``, or
        ``pb.diagram({"pearls": pearls, "coils": coils}).plot()``
    """
    if isinstance(tube, Mapping):
        if not tube:
            raise InputError("tube", "there are no branches in it", "give some by name, or a tube")
        return Diagram({str(name): Branch.of(known_branch(each)) for name, each in tube.items()}, {})
    options = None if until is None else branch_options(until)
    known_tube(tube)
    with progress("branch") as bar:

        def follow(name: str) -> None:
            bar.set_description(name, refresh=False)
            bar.update()

        found = study.diagram(tube.c0, tube.length, depth, options, follow, modes=modes, processes=processes)
    carried = {field.name: getattr(found, field.name) for field in fields(found)}
    return Diagram(**carried | {"branches": {name: Branch.of(each) for name, each in found.branches.items()}})
