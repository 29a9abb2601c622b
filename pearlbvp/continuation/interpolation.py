"""Guesses between known solutions of a path."""

from __future__ import annotations

import math

import numpy as np

from pearlbvp.continuation.problem import Array


def interpolate(at: float, known: dict[float, Array]) -> Array:
    """A guess at arclength ``at`` by Lagrange interpolation through the up to six nearest of the known solutions."""
    nodes = sorted(known, key=lambda s: abs(s - at))[:6]
    guess = np.zeros_like(known[nodes[0]])
    for s in nodes:
        guess += known[s] * math.prod((at - other) / (s - other) for other in nodes if other != s)
    return guess
