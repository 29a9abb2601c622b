"""Branches of rings, the wrinkled tubes, from the straight cylinder to self-contact, with stability on the whole tube."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from pearlbvp.continuation.branch import Branch, BranchOptions, BranchPoint, continue_branch, start_point
from pearlbvp.continuation.path import Point
from pearlbvp.continuation.storage import read_branch, write_branch
from pearlbvp.errors import InputError
from pearlbvp.files import writable, write_whole
from pearlbvp.helfrich import Tube
from pearlbvp.shapes.ring import RingProblem, ring_onset
from pearlbvp.stability.bloch import Fixed
from pearlbvp.stability.planar import MOST_WAVES, PlanarSpectrum, PlanarVariation
from pearlbvp.studies.branch import COLUMNS, RESOLVED, branch_options

CONTACT = "the ring touches itself; beyond, it would pass through itself"
TOUCHING = 1e-9
"""Gap below which a ring touches itself."""


def ring_branch(
    c0: float,
    length: float,
    n: int = 2,
    options: BranchOptions | None = None,
    *,
    tolerance: float = 1e-10,
    fixed: Fixed = "area and volume",
) -> Branch[RingProblem]:
    """The branch of rings of ``n`` lobes, from the straight cylinder on to where a ring touches itself.

    Args:
        c0: spontaneous curvature; shapes do not depend on it, energy, tension and stability do.
        length: axial period of the tube, in radii; only stability depends on it.
        n: number of lobes, from 2 on.
        options: where to stop and how to step, from ``studies.branch.branch_options``.
        tolerance: estimated error of the profile at which the mesh is refined.
        fixed: what the perturbations keep that stability is judged by.

    Returns:
        The branch; ``branch.table()`` has the columns ``COLUMNS``, and ``gap``, the width of a lobe at its narrowest place.
        It ends exactly at self-contact where nothing that was asked for comes before.

    Raises:
        InputError: an argument that cannot be used.
    """
    tube = Tube(c0, length)
    if not 1e-13 <= tolerance <= 1e-3:
        raise InputError(f"tolerance: {tolerance:g} is not between 1e-13 and 1e-3")
    problem, u, tangent = ring_onset(tube, n, tolerance=tolerance, fixed=fixed)
    if PlanarVariation.of(problem.profile(u)).most_waves(tube.length) > MOST_WAVES:
        raise InputError(
            f"length: more than {MOST_WAVES} waves along L = {tube.length:g} may grow; take a shorter tube"
        )
    return _to_contact(start_point(problem, u, tangent), options or branch_options(), at_bifurcation=True)


def ring_resumed(branch: Branch[RingProblem], options: BranchOptions) -> Branch[RingProblem]:
    """A branch of rings continued from its last point; that and what follows as one branch.

    Raises:
        InputError: its last ring touches itself.
    """
    last = branch.points[-1].point
    if last.observables["gap"] < TOUCHING:
        raise InputError("resume: the branch ends where the ring touches itself, so nothing follows; branch off before")
    whole = replace(options, progress=lambda so_far: options.progress(branch.extended(so_far)))
    return branch.extended(_to_contact(last, whole, at_bifurcation=len(branch.points) == 1))


def _to_contact(start: Point[RingProblem], options: BranchOptions, *, at_bifurcation: bool) -> Branch[RingProblem]:
    """The branch from a point on, stopped exactly where the gap closes: there it cannot go on, whoever asked for more."""
    bounded = replace(options, until={**options.until, "gap": 0.0}, limit=_limit)
    branch = continue_branch(start, bounded, at_bifurcation=at_bifurcation)
    last = branch.points[-1].observables
    if not branch.complete or abs(last["gap"]) > TOUCHING:
        return branch
    special = [replace(s, kind="end") if s.kind == "stop" else s for s in branch.special]
    return Branch(branch.points, special, CONTACT, complete=False)


def _limit(point: BranchPoint[RingProblem]) -> str | None:
    if point.observables["gap"] < -TOUCHING:
        return CONTACT
    if not point.spectrum.complete:
        return f"more than {MOST_WAVES} waves along the tube may grow; take a shorter tube"
    if point.spectrum.residual > RESOLVED:
        return f"its spectrum is known to {point.spectrum.residual:.0e} only; take a smaller tolerance"
    return None


def save_rings(branch: Branch[RingProblem], path: str | os.PathLike[str]) -> None:
    """Save a branch of rings as HDF5, whole or not at all.

    Raises:
        InputError: the place cannot be written to.
    """
    write_whole("save", writable("save", path), lambda temporary: write_branch(branch, temporary))


def load_rings(path: str | os.PathLike[str]) -> Branch[RingProblem]:
    """Load a branch that ``save_rings`` saved. Nothing in the file is executed.

    Raises:
        InputError: the file is no saved branch of rings, or is not whole.
    """
    if not Path(path).is_file():
        raise InputError(f"resume: there is no file {path}; give one that --save wrote")
    return read_branch(Path(path), RingProblem.from_tree, PlanarSpectrum.from_tree)


__all__ = ["COLUMNS", "CONTACT", "load_rings", "ring_branch", "ring_resumed", "save_rings"]
