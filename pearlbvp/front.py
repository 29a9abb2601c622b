"""What ``import pearlbvp as pb`` offers: the questions that people ask of tubes, answered by the rooms below."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from pearlbvp.branches import Branch, Until, followed_by
from pearlbvp.continuation import branch as core
from pearlbvp.continuation import solution as solutions
from pearlbvp.errors import InputError
from pearlbvp.held import Held
from pearlbvp.helfrich import Tube, WaveNumbers, known_tube, whole

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from pearlbvp.shape_flow import Flow
    from pearlbvp.studies.branch import Discretization
    from pearlbvp.theory.amplitude import Family


def branch(
    tube: Tube,
    family: str,
    mode: WaveNumbers | None = None,
    *,
    until: Until | None = None,
    shape: Sequence[float] | None = None,
    volume: float | None = None,
    cells: int | None = None,
    nodes: int | None = None,
    discretization: Discretization | None = None,
    fix: str | Held = "area,volume",
    tolerance: float | None = None,
    **how: Any,
) -> Branch:
    """The branch of a family that leaves the straight tube at a mode, with stability and special points.

    With ``shape``, the branch of pearls through the shape of least energy near a guess: a way to branches that nothing joins to
    the straight tube. It leads from there to smaller and to larger volume; ``until`` holds either way.

    Args:
        tube: the straight tube, ``Tube(c0, L)``.
        family: ``pearl``, ``ring``, ``coil``, ``buckle``, or one that was added.
        mode: waves along and around the tube; by default the family's first.
        until: where to stop: ``{"v": 1.1}`` for a column's value, ``{"bp": 1}`` for the first branch point.
        shape: of pearls, amplitudes ``a_1, a_2, ...`` of the guess ``r = 1 + sum of a_k cos(2 pi k x / L)``.
        volume: with ``shape``, the reduced volume at which the energy is minimised.
        cells: with ``shape``, how many of its periods the tube has that stability is judged on; ``L`` is that of one.
        nodes: on a triangulated tube of about so many vertices.
        discretization: ``subdivision`` or ``cotangent`` with ``nodes``; ``modes`` for reduced modes.
        fix: what is held while stability is judged: ``area,volume``, or ``tension`` for ``area``; ``pressure`` or ``osmotic=N``
            for ``volume``; ``force`` for ``length``; ``ade=ALPHA`` besides (``held.known_held``).
        tolerance: estimated error of the profile at which its mesh is refined, of pearls and rings.
        how: ``max_points`` (200), ``step`` (first) and ``max_step`` (0.5) along the branch.

    Raises:
        InputError: an argument that cannot be used.

    Examples:
        >>> import pearlbvp as pb
        >>> pearls = pb.branch(pb.Tube(c0=0.48, L=15), "pearl", (2, 0), until={"v": 1.01})
        >>> localized = pearls.switch(1, until={"v": 1.02})
        >>> localized[-1].spectrum.n_unstable
        0
        >>> unequal = pb.branch(pb.Tube(c0=0.75, L=10), "pearl", shape=[-0.3, 0.5], volume=1.0, until={"v": 1.01})
        >>> round(float(unequal.table().v.min()), 4)  # where they become equal
        0.9747
    """
    from pearlbvp.studies.branch import asked_branch

    def follow(options: Any) -> core.Branch[Any]:
        return asked_branch(
            tube, family, mode, options, shape=shape, volume=volume, cells=cells, nodes=nodes,
            discretization=discretization, fix=fix, tolerance=tolerance,
        )  # fmt: skip

    return followed_by(follow, until, how)


def load(path: str | os.PathLike[str]) -> Branch | Flow:
    """A branch or a flow that was saved. Nothing in the file is executed.

    A flow is at its last shape, as its status ``saved`` says; ``resume`` goes on from there.

    Raises:
        InputError: the file is neither, or is not whole.
    """
    from pearlbvp.flows.checkpoint import KIND
    from pearlbvp.hdf5 import kind_of

    if kind_of("path", path) == KIND:
        from pearlbvp.shape_flow import Flow
        from pearlbvp.studies import flow

        return Flow.of(flow.result(flow.load(path)))
    from pearlbvp.studies import saved

    return Branch.of(saved.load(path, "path"))


def dispersion(tube: Tube, max_m: int | None = None, max_n: int = 4) -> pd.DataFrame:
    """Every branch point of the straight tube with at most so many waves along it and around it, by increasing ``lambda2``.

    Raises:
        InputError: an argument that cannot be used.
    """
    from pearlbvp.studies.dispersion import branch_points

    known_tube(tube)
    return branch_points(tube.c0, tube.length, max_m, max_n)


def predicted_branch(
    tube: Tube, mode: WaveNumbers, family: Family | None = None, largest: float | None = None
) -> pd.DataFrame:
    """The branch that the amplitude equation of a mode predicts, to leading order, with the columns of a branch's table.

    ``Branch.compared`` has a computed branch beside it.

    Args:
        tube: the straight tube.
        mode: waves along and around the tube.
        family: ``pearl``, ``ring``, ``coil`` or ``buckle``; by default the mode's, or that of the two that is stable at onset.
        largest: amplitude ``A`` at which it ends, in radii; by default 0.2, or less where slaved waves would outgrow it.

    Raises:
        InputError: an argument that cannot be used.

    Examples:
        >>> import pearlbvp as pb
        >>> table = pb.predicted_branch(pb.Tube(c0=0, L=10), (1, 0))
        >>> bool(table.v.is_monotonic_increasing), round(float(table.wave.iloc[-1]), 9)  # pearls; the wave is 2A
        (True, 0.4)
    """
    from pearlbvp.studies import amplitude as study

    known_tube(tube)
    return study.predicted_branch(tube.c0, tube.length, mode, family, largest).table()


def plot_shapes(points: Iterable[solutions.Solution[Any]], titles: Iterable[str] = (), columns: int = 4) -> Figure:
    """Shapes beside one another, stable ones blue, unstable ones brown, all to one scale.

    Args:
        points: points of branches, of any family.
        titles: one for each; by default its volume and its number of unstable directions.
        columns: how many stand side by side.

    Raises:
        InputError: there are no points, or not as many titles, or an argument that cannot be used.

    Examples:
        >>> import pearlbvp as pb
        >>> tube = pb.Tube(c0=0, L=10)
        >>> picture = pb.plot_shapes([pb.branch(tube, family, until={"v": 0.98})[-1] for family in ("coil", "buckle")])
        >>> [text.get_text() for text in picture.texts]
        ['v = 0.9800, stable', 'v = 0.9800, 1 unstable']
    """
    from pearlbvp.figures.surface import draw_surfaces
    from pearlbvp.studies.branch import known_points

    points, titles = known_points(points), list(titles)
    if titles and len(titles) != len(points):
        raise InputError("titles", f"there are {len(titles)} for {len(points)} points", "give one for each, or none")
    return draw_surfaces(points, titles, whole("columns", columns))


def amplitude(tube: Tube, modes: Iterable[WaveNumbers]) -> pd.DataFrame:
    """Coefficients of the amplitude equations of some modes, and which of their branches are stable at onset.

    Raises:
        InputError: an argument that cannot be used.
    """
    from pearlbvp.studies.amplitude import coefficients

    known_tube(tube)
    return coefficients(tube.c0, tube.length, modes)
