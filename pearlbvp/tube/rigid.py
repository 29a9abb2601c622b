"""Rigid motions of a tube in its modes: shifts along and across the axis, and the turn about it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.tube.modes import Mode


def _along(mode: Mode) -> tuple[float, Mode] | None:
    """Derivative of a mode by ``k x``: a factor and a mode."""
    if not mode.p:
        return None
    turned = mode._replace(along="sin" if mode.along == "cos" else "cos")
    return (-mode.p if mode.along == "cos" else mode.p), turned


def _turned(mode: Mode) -> tuple[float, Mode] | None:
    """What a turn about the axis makes of a mode: ``i d`` of the centre, ``-sigma_phi`` of the section."""
    if mode.part == "sigma":
        if not mode.b:
            return None
        turned = mode._replace(around="sin" if mode.around == "cos" else "cos")
        return (mode.b if mode.around == "cos" else -mode.b), turned
    return (1.0, mode._replace(part="z")) if mode.part == "y" else (-1.0, mode._replace(part="y"))


def rigid_motions(known: Mapping[Mode, float], modes: Sequence[Mode], turns: int) -> list[Array]:
    """The parts of all rigid motions in a block's modes: those that are not zero there, each of shape (modes,).

    Args:
        known: coefficients of the solution's modes.
        modes: of a symmetry block.
        turns: of the frame on the tube's length.
    """
    place = {mode: i for i, mode in enumerate(modes)}
    found = []
    for motion in (_along, _turned):
        vector = np.zeros(len(modes))
        for mode, value in known.items():
            image = motion(mode)
            if image is not None and image[1] in place:
                vector[place[image[1]]] += image[0] * value
        found.append(vector)
    # Shifts across the axis, e^{-i turns k x} in the turning frame, and that times i.
    shifts = [{("y", "cos"): 1.0, ("z", "sin"): -1.0}, {("y", "sin"): 1.0, ("z", "cos"): 1.0}]
    for shift in shifts:
        vector = np.zeros(len(modes))
        for (part, along), value in shift.items():
            mode = Mode(part, turns, along)  # type: ignore[arg-type]
            if mode in place:
                vector[place[mode]] = value
        found.append(vector)
    return [vector for vector in found if np.abs(vector).max(initial=0.0) > 1e-12]
