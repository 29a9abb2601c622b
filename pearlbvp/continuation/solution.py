"""A solution of a problem on its path: what is to be known of it is computed when it is first asked for, and kept."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Generic

from pearlbvp.arrays import Array
from pearlbvp.continuation.problem import P
from pearlbvp.continuation.spectrum import Spectrum

DIFFERENCE = 1e-5
"""Step of the central differences along the tangent."""


@dataclass(frozen=True, eq=False)
class Solution(Generic[P]):
    """A solution.

    Attributes:
        problem: the problem on the mesh that ``u`` lives on.
        u: the unknown.
        tangent: unit tangent of the path.
        iterations: Newton iterations that it took.
        step: length of the step to try from here; 0 for that of the options.
        known: its growth rates, where they are known already, or cannot be.
    """

    problem: P
    u: Array
    tangent: Array
    iterations: int = 0
    step: float = 0.0
    known: Spectrum | None = field(default=None, repr=False)

    @classmethod
    def along(cls, problem: P, u: Array, direction: Array) -> Solution[P]:
        """A solution to start from, its tangent made a unit vector."""
        return cls(problem, u, direction / math.sqrt(problem.inner(direction, direction)))

    @cached_property
    def observables(self) -> Mapping[str, float]:
        """Named numbers of the solution."""
        return self.problem.observables(self.u)

    @cached_property
    def further(self) -> Mapping[str, float]:
        """Numbers that no step needs."""
        return self.problem.further(self.u)

    @cached_property
    def clearance(self) -> float:
        """How far the surface is from touching itself (``Problem.clearance``)."""
        return self.problem.clearance(self.u)

    @cached_property
    def spectrum(self) -> Spectrum:
        """Growth rates in all symmetry blocks.

        Raises:
            SpectrumError, numpy.linalg.LinAlgError: they cannot be computed.
        """
        return self.problem.spectrum(self.u) if self.known is None else self.known

    @cached_property
    def slopes(self) -> Mapping[str, float]:
        """Derivatives of the observables along the tangent, by central differences."""
        ahead, behind = (self.problem.observables(self.u + s * self.tangent) for s in (DIFFERENCE, -DIFFERENCE))
        return {name: (ahead[name] - behind[name]) / (2 * DIFFERENCE) for name in ahead}

    def computed(self) -> Solution[P]:
        """Itself, with all computed that a branch shows: an interruption finds it whole, or not at all.

        Raises:
            SpectrumError, numpy.linalg.LinAlgError: the growth rates cannot be computed.
        """
        self.observables, self.spectrum  # noqa: B018
        return self

    def value(self, name: str) -> float:
        """A number of the solution: an observable, ``mu_crit``, or one that no step needs (``Problem.further``)."""
        if name == "mu_crit":
            return self.spectrum.mu_crit
        return float(self.observables[name] if name in self.observables else self.further[name])

    def turned(self) -> Solution[P]:
        """The same solution, the path leading the other way; its growth rates are the same."""
        return replace(self, tangent=-self.tangent, known=self.spectrum)

    def __repr__(self) -> str:
        numbers = [f"{name} = {value:.8g}" for name, value in self.observables.items()]
        return f"Solution({', '.join(numbers)})"
