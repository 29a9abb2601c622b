"""Guesses between known solutions of a path."""

from __future__ import annotations

import math

import numpy as np

from pearlbvp.arrays import Array


def interpolate(at: float, known: dict[float, Array], apart: float = 0.0) -> Array:
    """A guess at arclength ``at`` by Lagrange interpolation through the up to six nearest of the known solutions.

    Args:
        at: arclength.
        known: solutions by arclength.
        apart: of solutions nearer to each other than this only one is taken: their differences would be rounding.
    """
    nodes: list[float] = []
    for s in sorted(known, key=lambda s: abs(s - at)):
        if len(nodes) < 6 and all(abs(s - other) > apart for other in nodes):
            nodes.append(s)
    guess = np.zeros_like(known[nodes[0]])
    for s in nodes:
        guess += known[s] * math.prod((at - other) / (s - other) for other in nodes if other != s)
    return guess
