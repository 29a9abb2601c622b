"""All branches that are reached from the straight tube, with the verbs of an ordinary analysis: nothing is computed here."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
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


@dataclass(frozen=True, repr=False)
class Diagram(study.Diagram):
    """Branches by name: ``branches["3/1"]`` is what crosses three equal pearls at their first branch point.

    Attributes:
        called: whether somebody gave the names, which then stand in pictures, too.
    """

    called: bool = False

    def plot(
        self,
        x: str = "v",
        y: str = "E",
        title: str = "",
        units: Units = RADII,
        *,
        reference: core.Branch[Any] | str | None = None,
        shapes: bool = False,
    ) -> Figure:
        """Two columns of all branches, unstable parts dashed, special points marked.

        Args:
            x, y: columns.
            title: of the picture.
            units: of the axes.
            reference: draw energies as differences from that of the straight tube (``"tube"``), of one of the branches by
                its name, or of a branch, at the same volume.
            shapes: draw shapes at their places.

        Raises:
            InputError: there is no such column, or no such reference.
        """
        from pearlbvp.figures.diagram import draw_plane
        from pearlbvp.studies.energies import Reference

        table = self.table()
        for name in (x, y):
            if name not in table:
                raise InputError("column", f"{name} is not in the table", f"take one of {', '.join(map(str, table))}")
        energies = None if reference is None else Reference.of(reference, self.branches)
        return draw_plane(self.branches, x, y, title, units, reference=energies, shapes=shapes, called=self.called)


def diagram(
    tube: Tube | Mapping[str, core.Branch[Any]],
    depth: int = 1,
    *,
    modes: Iterable[WaveNumbers] | None = None,
    until: Until | None = None,
    nodes: int = 0,
    processes: int = 0,
) -> Diagram:
    """All branches from the straight tube, and from their branch points on, to a depth; or branches that there are, together.

    Args:
        tube: the straight tube; or branches by name, of which nothing is computed and the other arguments say nothing.
        depth: 0 for branches from the straight tube only, 1 for those that cross them, too, and so on.
        modes: follow every family of these; by default all pearls of ``k < 1``.
        until: where every branch stops.
        nodes: where reduced modes describe a branch no further, follow it on triangles with about so many vertices; 0 for
            branches that end there.
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
        return Diagram({str(name): Branch.of(known_branch(each)) for name, each in tube.items()}, {}, called=True)
    options = None if until is None else branch_options(until)
    known_tube(tube)
    with progress("branch") as bar:

        def follow(name: str) -> None:
            bar.set_description(name, refresh=False)
            bar.update()

        found = study.diagram(
            tube.c0, tube.length, depth, options, follow, modes=modes, nodes=nodes, processes=processes
        )
    carried = {field.name: getattr(found, field.name) for field in fields(found)}
    return Diagram(**carried | {"branches": {name: Branch.of(each) for name, each in found.branches.items()}})
