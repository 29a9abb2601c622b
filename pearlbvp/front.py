"""What ``import pearlbvp as pb`` offers: the questions that people ask of tubes, answered by the rooms below."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from pearlbvp.branches import Branch, Until, followed_by
from pearlbvp.continuation import branch as core
from pearlbvp.held import Held
from pearlbvp.helfrich import Tube, WaveNumbers, known_tube

if TYPE_CHECKING:
    import pandas as pd

    from pearlbvp.shape_flow import Flow
    from pearlbvp.studies.branch import Discretization


def branch(
    tube: Tube,
    family: str,
    mode: WaveNumbers | None = None,
    *,
    until: Until | None = None,
    nodes: int | None = None,
    discretization: Discretization | None = None,
    fix: str | Held = "area,volume",
    tolerance: float | None = None,
    **how: Any,
) -> Branch:
    """The branch of a family that leaves the straight tube at a mode, with stability and special points.

    Args:
        tube: the straight tube, ``Tube(c0, L)``.
        family: ``pearl``, ``ring``, ``coil``, ``buckle``, or one that was added.
        mode: waves along and around the tube; by default the family's first.
        until: where to stop: ``{"v": 1.1}`` for a column's value, ``{"bp": 1}`` for the first branch point.
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
    """
    from pearlbvp.studies.branch import family_branch

    def follow(options: Any) -> core.Branch[Any]:
        return family_branch(
            tube, family, mode, options, nodes=nodes, discretization=discretization, fix=fix, tolerance=tolerance
        )

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


def amplitude(tube: Tube, modes: Iterable[WaveNumbers]) -> pd.DataFrame:
    """Coefficients of the amplitude equations of some modes, and which of their branches are stable at onset.

    Raises:
        InputError: an argument that cannot be used.
    """
    from pearlbvp.studies.amplitude import coefficients

    known_tube(tube)
    return coefficients(tube.c0, tube.length, modes)
