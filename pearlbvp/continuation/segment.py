"""The stretch of a path between two computed points, and where a function vanishes on it."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Generic

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.crossing import correct_beside
from pearlbvp.continuation.interpolation import interpolate
from pearlbvp.continuation.path import LARGEST_KINK, SAFETY, PathEnd, correct, correct_to
from pearlbvp.continuation.problem import P
from pearlbvp.continuation.solution import Solution
from pearlbvp.newton import NewtonOptions, NewtonResult
from pearlbvp.representation import brief
from pearlbvp.roots import NoRoot, root

BESIDE = 1e-9
"""Largest residual of a solution beside a branch point."""

BEYOND = (1.02, 1.1)
"""Lengths, by the segment's, up to which a sign change is looked for that lies beyond the last point on another mesh."""

ROUGH = 1e-10
"""Size of what Newton's method leaves of a number, by its change on the segment, at which the number is none that is smooth."""


@dataclass(frozen=True)
class Segment(Generic[P]):
    """Points between ``first`` and ``last``, by their arclength along the first one's tangent.

    Attributes:
        first, last: consecutive points of a path, possibly on different meshes.
    """

    __repr__ = brief

    first: Solution[P]
    last: Solution[P]
    _known: dict[float, Solution[P]] = field(default_factory=dict, repr=False)
    _nodes: dict[float, Array] = field(default_factory=dict, repr=False)
    _rates: list[float] = field(default_factory=lambda: [1e4], repr=False)

    @property
    def length(self) -> float:
        """Arclength of the last point along the first one's tangent."""
        problem = self.first.problem
        return problem.inner(self.first.tangent, problem.transfer(self.last.problem, self.last.u) - self.first.u)

    def _guess(self, s: float) -> Array:
        """From the tangent at the first point through what is known up to the last, or through the points of ``refine``."""
        if self._nodes:
            return interpolate(s, self._nodes)
        base, tangent = self.first.u, self.first.tangent
        known = {at: point.u for at, point in self._known.items()}
        known.setdefault(self.length, self.first.problem.transfer(self.last.problem, self.last.u))
        bends = {at: (u - base - at * tangent) / at**2 for at, u in known.items()}
        bend = interpolate(s, bends, apart=abs(self.length) / 50)
        return np.asarray(base + s * tangent + s**2 * bend)

    def point(self, s: float) -> Solution[P]:
        """The solution at arclength ``s``, on the first point's mesh.

        Where Newton's method fails, as it does beside a branch point of the problem itself, points about it tell how the
        path goes on across the null vector there (``refine``).

        Raises:
            PathEnd: there is no solution, or no such points are known.
        """
        if s == 0:
            return self.first
        if s not in self._known:
            problem, base, tangent = self.first.problem, self.first.u, self.first.tangent
            guess = self._guess(s)
            rate = self._rates[-1]
            result, direction = correct(problem, guess, tangent, base, s, NewtonOptions(max_iterations=10), rate)
            u = result.u
            if result.converged and result.iterations > 1:
                self._rates.append(SAFETY * result.rate)
            if not result.converged:
                u, direction = self._beside(guess), tangent
                if not np.abs(problem.residual(u)).max() < BESIDE:
                    raise PathEnd(f"no solution between two points of the path: {result.message}; take shorter steps")
            else:
                direction = self._tangent(result, direction)
            self._known[s] = replace(Solution.along(problem, u, direction), iterations=result.iterations)
        return self._known[s]

    def _tangent(self, result: NewtonResult, direction: Array) -> Array:
        """The tangent exactly at a solution, not at the last iterate but one, where that is of another direction."""
        if result.correction > 1e-10:
            unit = np.zeros(result.u.size)
            unit[-1] = 1.0
            with suppress(np.linalg.LinAlgError):
                return self.first.problem.solve(result.u, unit, self.first.tangent)
        return direction

    def _beside(self, guess: Array) -> Array:
        """The guess corrected in all but the null vector's direction, where enough points about it are known."""
        if self._nodes:
            with suppress(np.linalg.LinAlgError):
                return correct_beside(self.first.problem, guess, self.first.tangent)
        return guess

    def refine(self, around: float) -> None:
        """Compute points about an arclength, ever denser, to interpolate through where the corrector fails."""
        nodes = {0.0: self.first.u}
        for distance in (1.0, 0.4, 0.15, 0.05):
            for s in (around - distance * self.length, around + distance * self.length):
                if 0 < s <= self.length or distance == 1.0:
                    s = min(max(s, 0.0), self.length)
                    with suppress(PathEnd):
                        nodes[s] = self.point(s).u
        if len(nodes) > 4:
            self._nodes.update(nodes)

    def where(self, excess: Callable[[Solution[P]], float], ends: tuple[float, float]) -> Solution[P] | None:
        """The point where a smooth number has a value, by one Newton's method; None where that leads off the segment.

        Args:
            excess: of a point's number over the value.
            ends: of its values at the two ends, of opposite signs.
        """
        problem, base, tangent, length = self.first.problem, self.first.u, self.first.tangent, self.length

        def value(u: Array) -> float:
            return excess(Solution(problem, u, tangent))

        low, high = (0.0, ends[0]), (length, ends[1])
        for _ in range(3):  # regula falsi, on guesses
            s = low[0] + (high[0] - low[0]) * low[1] / (low[1] - high[1])
            found = value(self._guess(s))
            low, high = ((s, found), high) if found * low[1] > 0 else (low, (s, found))
        result, direction = correct_to(problem, self._guess(s), tangent, value, NewtonOptions(max_iterations=8))
        if not result.converged or not abs(value(result.u)) <= ROUGH * abs(ends[1] - ends[0]):
            return None
        s = problem.inner(tangent, result.u - base)
        off = result.u - self._guess(s)
        reach = 1 + 1e-9 if self.last.problem is problem else BEYOND[0]
        if not 0 < s / length < reach or math.sqrt(problem.inner(off, off)) > LARGEST_KINK * abs(length):
            return None
        direction = self._tangent(result, direction)
        return replace(Solution.along(problem, result.u, direction), iterations=result.iterations)

    def root(
        self, function: Callable[[Solution[P]], float], at_first: float, tolerance: float = 1e-13, noise: float = 0.0
    ) -> Solution[P]:
        """The point where a function changes its sign (``roots.root``).

        Args:
            function: of a point.
            at_first: its value at the first point; that at the last has the opposite sign.
            tolerance: of the arclength, relative to one plus the segment's.
            noise: values smaller than this are zero.

        Raises:
            PathEnd: no sign change on the first point's mesh, or the corrector fails.
        """

        def value(s: float) -> float:
            if s == 0:
                return at_first
            try:
                found = function(self.point(s))
            except PathEnd:
                self.refine(s)
                found = function(self.point(s))
            return 0.0 if abs(found) < noise else found

        # The value at the last point is that on the last point's mesh: compute it on this one. Where the meshes differ, what
        # lies just before the last point on its own mesh may lie just beyond it on this one.
        other_mesh = self.first.problem is not self.last.problem
        ends = [share * self.length for share in ((1.0, *BEYOND) if other_mesh else (1.0,))]
        end = next((s for s in ends if value(s) * at_first <= 0), None)
        if end is None:
            raise PathEnd("a sign change between two points is lost on the first one's mesh; take shorter steps")
        try:
            return self.point(root(value, 0.0, end, tolerance * (1 + abs(self.length))))
        except NoRoot as error:
            raise PathEnd("a sign change between two points cannot be located; take shorter steps") from error
