"""Pearls in reduced modes: as cosines of ``x``, in whose larger spaces the symmetry about the axis may break."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.problem import LiftError
from pearlbvp.held import Held
from pearlbvp.stability.profile import Profile
from pearlbvp.tube.conversion import in_modes
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.problem import TubeProblem
from pearlbvp.tube.shapes import TubeParameters
from pearlbvp.tube.symmetry import axisymmetric_symmetry, pearl_symmetry

OVERSAMPLED = 8
"""Points by waves: the radius has far shorter ones than are kept, which must not be taken for longer ones."""


def pearls_in_modes(
    along: Callable[[float], tuple[Profile, float]], cells: int, free: Sequence[str], held: Held
) -> tuple[TubeProblem, Array, Array]:
    """Pearls of a branch in reduced modes, on the whole tube, the first point of the profile at ``x = 0``.

    Args:
        along: profile and reduced volume of the pearls, by the step along the tangent of their branch.
        cells: periods on the tube.
        free: parameters that vary on the branch, in the names of ``TubeParameters``, others among them.
        held: what is held while stability is judged.

    Returns:
        The problem, its solution and the unit tangent there, the same parameters free.

    Raises:
        LiftError: the profile is no graph over its axis, its neck is too thin, or Newton's method finds no solution.
    """

    def shape(step: float, waves: int) -> tuple[dict[Mode, float], dict[str, float]]:
        profile, v = along(step)
        points = OVERSAMPLED * waves
        c = np.fft.rfft(profile.radii_at(profile.period * np.arange(points) / points), norm="forward")[:waves]
        known = {Mode("sigma", 0): float(c[0].real)}
        for i, wave in enumerate(2 * c[1:], 1):
            known[Mode("sigma", cells * i)] = float(wave.real)
            known[Mode("sigma", cells * i, "sin")] = -float(wave.imag)
        values = profile.lambda1, profile.lambda2, v, profile.c0, profile.period * cells
        return known, dict(zip(TubeParameters._fields, values, strict=True))

    profile, _ = along(0.0)
    if not profile.is_graph:
        raise LiftError("the pearls overhang, so that reduced modes cannot describe what branches off")
    symmetry = pearl_symmetry(cells) if profile.half else axisymmetric_symmetry(cells)
    lambda1, lambda2, v, c0, length = shape(0.0, 2)[1].values()
    names = tuple(name for name in TubeParameters._fields if name in free)
    problem = TubeProblem(symmetry, c0, length, (16, 0), held=held, free=names, lambda1=lambda1, lambda2=lambda2, v=v)
    return in_modes(problem, shape)
