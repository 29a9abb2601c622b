"""Tubes without any symmetry, in the modes of their flow, as an energy to be minimised at fixed area and volume."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.flows.tube import TubeFlow
from pearlbvp.tube.modes import Mode

TRIALS, ROUGHNESS = 8, (0.2, 1.5)
"""Of random tubes: how many are tried, and sizes of their waves."""


@dataclass(frozen=True)
class TubeLandscape:
    """Energy and constraints of tubes in modes (``minimum.Landscape``).

    Attributes:
        flow: the modes.
        v: reduced volume.
    """

    flow: TubeFlow
    v: float

    @cached_property
    def scales(self) -> Array:
        """Bending energy has the fourth powers of the wave numbers."""
        k = 2 * math.pi / self.flow.length
        return np.array([1 / (1 + (mode.p * k) ** 2 + mode.b**2) for mode in self.flow.modes])

    def energy(self, q: Array) -> float:
        """Energy by area."""
        return self.flow.energy(q)

    def gradient(self, q: Array) -> Array:
        """Of the energy."""
        return self.flow.residual(q, np.zeros_like(q), np.zeros(2))

    def constraints(self, q: Array) -> Array:
        """Area and volume, less what they are to be."""
        return np.asarray(self.flow.constraints(q) - [1.0, self.v / 2])

    def constraint_rows(self, q: Array) -> Array:
        """Of the constraints."""
        return self.flow.constraint_rows(q)

    def hessian(self, q: Array, multipliers: Array) -> Array:
        """Of energy and constraints."""
        return self.flow.jacobian(q, np.zeros_like(q), multipliers, 0.0)

    def random(self, random: np.random.Generator) -> Array:
        """A random smooth tube of the right area: of several that of the nearest volume."""
        place = self.flow.modes.index(Mode("sigma", 0))
        found = []
        for _ in range(TRIALS):
            q = random.uniform(*ROUGHNESS) * random.standard_normal(len(self.scales)) * self.scales**2
            q[place] = 1.0
            for _ in range(8):  # the mean radius that has the area
                lack = self.constraints(q)[0]
                q[place] -= lack / self.constraint_rows(q)[0, place]
                if abs(lack) < 1e-3:
                    found.append(q)
                    break
        return min(
            found, key=lambda q: abs(float(self.constraints(q)[1])), default=self.flow.packed({Mode("sigma", 0): 1.0})
        )
