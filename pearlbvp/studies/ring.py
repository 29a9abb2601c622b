"""Branches of rings, the wrinkled tubes, from the straight cylinder to self-contact, with stability on the whole tube."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from pearlbvp.collocation.scheme import Array
from pearlbvp.continuation.branch import Branch, BranchOptions, BranchPoint, continue_branch, start_point
from pearlbvp.continuation.path import Point, correct_at
from pearlbvp.continuation.switching import leave
from pearlbvp.errors import InputError, SpectrumError
from pearlbvp.helfrich import Tube, choice, whole
from pearlbvp.newton import NewtonOptions
from pearlbvp.shapes.ring import RingProblem, ring_onset
from pearlbvp.stability.bloch import Fixed
from pearlbvp.studies.branch import COLUMNS, FIXED, accuracy, known_options, numbered, wanted_there
from pearlbvp.studies.ends import RESOLVED
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.problem import TubeProblem
from pearlbvp.tube.symmetry import ODD_PHI, ring_symmetry
from pearlbvp.units import Sentence

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
    tube, n, tolerance, options = Tube(c0, length), whole("mode", n, 2), accuracy(tolerance), known_options(options)
    choice("fixed", fixed, FIXED)
    problem, u, tangent = ring_onset(tube, n, tolerance=tolerance, fixed=fixed)
    return _to_contact(start_point(problem, u, tangent), options, at_bifurcation=True)


def ring_resumed(branch: Branch[RingProblem], options: BranchOptions) -> Branch[RingProblem]:
    """A branch of rings continued from its last point; that and what follows as one branch, as ``saved.resumed`` has it.

    Raises:
        InputError: its last ring touches itself.
    """
    options = known_options(options)
    if wanted_there(branch, options) is not None:
        return branch
    last = branch.points[-1].point
    if last.observables["gap"] < TOUCHING:
        raise InputError("resume: the branch ends where the ring touches itself, so nothing follows; branch off before")
    return branch.extended(_to_contact(last, options.beyond(branch), at_bifurcation=branch.ends_at_bifurcation))


def ring_switched(
    branch: Branch[RingProblem], number: int, options: BranchOptions, *, grow: bool = True
) -> Branch[TubeProblem]:
    """The branch of tubes that crosses a branch of rings at its branch point ``number`` (the first is 1).

    Its shapes are no rings: waves along the tube on the wrinkles (``oblates embedded in wrinkling``, wrinkled buckles). They
    are followed in reduced modes, as long as the sections are star-shaped.

    Args:
        branch: a branch of rings.
        number: which of its branch points.
        options: where to stop and how to step.
        grow: follow the half on which the largest new mode grows; on a pitchfork the two are the same shapes.

    Raises:
        InputError: there is no such branch point, or it was not located, or the ring there is not star-shaped.
    """
    special, options = numbered(branch, number), known_options(options)
    problem, u, tangent = reduced(branch.at(special).point)
    c, parity = special.block.c, special.block.parity
    block = problem.symmetry.block(special.block.j, c, ODD_PHI if parity == "odd" else 0)
    return leave(problem, u, tangent, block, options, grow=grow)


def reduced(point: Point[RingProblem]) -> tuple[TubeProblem, Array, Array]:
    """A ring in reduced modes: problem, unknown and unit tangent of the branch of rings.

    Raises:
        InputError: its section is not star-shaped about its centre.
    """
    ring, observed = point.problem, point.observables
    problem = TubeProblem(ring_symmetry(ring.n), ring.c0, ring.length, (0, 8), fixed=_tube_fixed(ring.fixed))
    while True:
        try:
            radii = ring.radius_cosines(point.u, problem.size[1] + 1)
        except ValueError:
            raise InputError(
                f"switch: at v = {observed['v']:.4f} the ring is not star-shaped about its centre, as tubes need it"
            ) from None
        known = {Mode("sigma", 0, "cos", ring.n * i): float(a) for i, a in enumerate(radii)}
        guess = np.append(problem.packed(known), [observed[name] for name in ("lambda1", "lambda2", "v")])
        moved = problem.remesh(guess)
        if moved is None:
            break
        problem = moved[0]
    result, tangent = correct_at(problem, guess, NewtonOptions(max_iterations=10))
    if not result.converged:
        raise InputError(f"switch: the ring at v = {observed['v']:.4f} could not be taken over ({result.message})")
    tangent *= np.sign(point.tangent @ _volume_direction(point))
    return problem, result.u, tangent / np.sqrt(problem.inner(tangent, tangent))


def _volume_direction(point: Point[RingProblem]) -> Array:
    """Unit vector of the reduced volume in a ring's unknown."""
    unit = np.zeros_like(point.u)
    unit[-1] = 1.0
    return unit


def _tube_fixed(fixed: Fixed) -> Literal["area and volume", "area"]:
    return "area" if fixed == "area" else "area and volume"


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
    """Why a branch of rings ends at a point, or None.

    Raises:
        SpectrumError: its growth rates are not known well enough.
    """
    if point.observables["gap"] < -TOUCHING:
        return CONTACT
    if point.spectrum.residual > RESOLVED:
        text = "its spectrum is known to {rate:.0e} only; take a smaller tolerance"
        raise SpectrumError(Sentence(text, rate=point.spectrum.residual))
    return None


__all__ = ["COLUMNS", "CONTACT", "ring_branch", "ring_resumed", "ring_switched"]
