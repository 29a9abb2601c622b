"""Which shape a tube takes, with the verbs of an ordinary analysis: nothing is computed here."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from typing import TYPE_CHECKING

from pearlbvp.helfrich import Tube, WaveNumbers
from pearlbvp.progress import progress
from pearlbvp.studies import phases as study
from pearlbvp.units import RADII, Units

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Phases(study.Phases):
    """Which shapes a tube takes: ``table``, ``transitions``, ``ranges``, ``shapes(v)``, and a picture."""

    def plot(self, units: Units = RADII) -> Figure:
        """Energies above the least, which shape that is, and what it looks like.

        Raises:
            InputError: it has one volume only.
        """
        from pearlbvp.figures.phases import draw_phases

        return draw_phases(self, units)


def phases(
    tube: Tube,
    volumes: float | str | Iterable[float],
    depth: int = 1,
    *,
    modes: Iterable[WaveNumbers] | None = None,
    unstable: int = 2,
    flows: bool = False,
    starts: int = 0,
    seed: int = 0,
    nodes: int = study.NODES,
    processes: int = 0,
) -> Phases:
    """Which shape the tube takes at which volume: all stable shapes that were found, the least, and where that changes.

    Args:
        tube: the straight tube.
        volumes: reduced volumes, or a text like ``0.6:1.3:0.01``.
        depth: 0 for branches from the straight tube only, 1 for those that cross them, too, and so on.
        modes: follow every family of these; by default all pearls of ``k < 1`` and the first others.
        unstable: what crosses a branch is followed where so many directions, or fewer, are unstable.
        flows: let shapes flow where they lose their stability, to see what they fall to.
        starts: random shapes that are relaxed, to find stable ones that the branches do not lead to.
        seed: of the random shapes: the same seed, the same shapes.
        nodes: where reduced modes describe a branch no further, follow it on triangles with about so many vertices; 0 for
            branches that end there.
        processes: how many to work in; 0 for one a core.

    Returns:
        Tables (``table``, ``transitions``, ``ranges``), shapes (``shapes(v)``), a picture (``plot()``), and what they rest on.
        Where it is interrupted, what follows from what was computed before: ``complete`` is false, ``lacking`` says what is not
        there.

    Raises:
        InputError: an argument that cannot be used.

    Examples:
        >>> import pearlbvp as pb
        >>> found = pb.phases(pb.Tube(0.48, 15), [1.005, 1.01], modes=[(2, 0)])
        >>> list(found.ranges.branch), list(found.shapes(1.01))
        (['2', '2/1'], ['2/1'])
    """
    with progress("branch") as bar:
        found = study.phases(tube, volumes, depth=depth, modes=modes, unstable=unstable, flows=flows, starts=starts, seed=seed,
                             nodes=nodes, processes=processes,
                             progress=lambda name: bar.update())  # fmt: skip
    return Phases(**{field.name: getattr(found, field.name) for field in fields(found)})
