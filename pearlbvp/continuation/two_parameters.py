"""Curves of folds and of branch points in two parameters.

With one more parameter free, solutions form a surface. A scalar condition picks a curve on it: that an observable turns
along the curves of fixed second parameter (a fold), or that a growth rate is zero (a branch point). Newton's method needs
the condition's derivative in the surface's two directions and in that of the residual only, which central differences
give (compare the minimally augmented systems of W. Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria
(SIAM 2000), chapter 4). Where the second parameter turns along a curve of folds there is a cusp, of branch points a place
where two of them meet.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.branch import Branch, SpecialPoint
from pearlbvp.continuation.following import BranchOptions, continue_branch
from pearlbvp.continuation.problem import Problem
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.switching import tangent_along
from pearlbvp.representation import brief

_EPS = 1e-5

NOISE = 1e-6
"""Corrections below this that no longer shrink are those of a condition that is known no better: growth rates of shapes with
thin necks, say, have the rounding of a fourth derivative. Elsewhere Newton's method goes on to its tolerance."""


class Condition(Protocol):
    """A scalar function on the surface of solutions."""

    def neutral_block(self, surface: CurveOnSurface) -> Any:
        """The symmetry block in which a growth rate is zero all along the curve; None where none is."""

    def __call__(self, surface: CurveOnSurface, u: Array) -> float:
        """Its value at a solution."""


@dataclass(frozen=True)
class FoldCondition:
    """An observable turns along the curve of fixed second parameter.

    Attributes:
        name: the observable.
        neutral: whether it is the one that perturbations keep, so that a growth rate is zero where it turns.
    """

    name: str
    neutral: bool

    def neutral_block(self, surface: CurveOnSurface) -> Any:
        """The problem's own, where what turns is what perturbations keep; else None."""
        return surface.base.trivial_block if self.neutral else None

    def __call__(self, surface: CurveOnSurface, u: Array) -> float:
        """Derivative of the observable along that curve."""
        tangent = surface.curve_tangent(u)
        ahead = surface.base.observables(u + _EPS * tangent)[self.name]
        behind = surface.base.observables(u - _EPS * tangent)[self.name]
        return float((ahead - behind) / (2 * _EPS))


@dataclass(frozen=True)
class NeutralCondition:
    """A growth rate is zero.

    Attributes:
        block: its symmetry block.
        like: a spectrum that says how finely to resolve it.
    """

    __repr__ = brief

    block: Any
    like: Any

    def neutral_block(self, surface: CurveOnSurface) -> Any:
        """That of the growth rate."""
        return self.block

    def __call__(self, surface: CurveOnSurface, u: Array) -> float:
        """The growth rate of the block that is nearest to zero."""
        rates = surface.base.block_rates(u, self.block, self.like)
        return float(rates[np.abs(rates).argmin()])


def _of_the_base(name: str) -> Any:
    """An attribute that a curve shares with the problem on whose surface of solutions it lies."""
    return property(lambda curve: getattr(curve.base, name))


@dataclass(frozen=True)
class CurveOnSurface(Problem):
    """The problem of a curve on a surface of solutions, as ``continuation`` takes it.

    Attributes:
        base: the problem with both parameters free: two unknowns more than equations.
        fixed: unit vector of the second parameter among the unknowns.
        reference: a tangent of the curve of fixed second parameter.
        condition: what holds on the curve.
    """

    __repr__ = brief

    base: Problem
    fixed: Array
    reference: Array
    condition: Condition

    inner, observables, further, poles, limit, walls, clearance = map(
        _of_the_base, ("inner", "observables", "further", "poles", "limit", "walls", "clearance")
    )
    constant, family, headline, trivial_block, conserved = map(
        _of_the_base, ("constant", "family", "headline", "trivial_block", "conserved")
    )

    @property
    def shapes(self) -> Any:
        """The base: special or not, these are its solutions."""
        return self.base

    def curve_tangent(self, u: Array) -> Array:
        """Tangent, with inner product 1 with the reference, of the curve of fixed second parameter through ``u``."""
        rhs = np.zeros(u.size)
        rhs[-2] = 1.0
        tangent: Array = self.base.solve(u, rhs, np.vstack((self.reference, self.fixed)))
        return tangent

    def residual(self, u: Array) -> Array:
        """The base's equations and the condition."""
        return np.append(self.base.residual(u), self.condition(self, u))

    def solve(self, u: Array, rhs: Array, row: Array | None = None) -> Array:
        """Bordered solve; see ``Problem.solve``."""
        columns = rhs.reshape(u.size, -1)
        sides = columns.shape[1]
        wide = np.zeros((u.size, sides + 2))
        wide[:-2, :sides] = columns[:-2]
        wide[-2, sides] = wide[-1, sides + 1] = 1.0
        found = self.base.solve(u, wide, np.vstack((self.reference, self.fixed)))
        particular, basis = found[:, :sides], found[:, sides:]
        # Two conditions on the two coordinates in the surface's tangent plane.
        matrix = np.array([[self._slope(u, z) for z in basis.T], [self.inner(row, z) for z in basis.T]])
        known = np.array(
            [
                columns[-2] - [self._slope(u, x) for x in particular.T],
                columns[-1] - [self.inner(row, x) for x in particular.T],
            ]
        )
        result: Array = particular + basis @ np.linalg.solve(matrix, known)
        return result.reshape(rhs.shape)

    def _slope(self, u: Array, direction: Array) -> float:
        """Derivative of the condition in a direction."""
        size = np.sqrt(self.inner(direction, direction))
        if size == 0:
            return 0.0
        step = 1e-4 / size
        return (self.condition(self, u + step * direction) - self.condition(self, u - step * direction)) / (2 * step)

    def transfer(self, other: CurveOnSurface, u: Array) -> Array:
        """As the base does."""
        return self.base.transfer(other.base, u)

    def remesh(self, u: Array, *others: Array) -> tuple[CurveOnSurface, list[Array]] | None:
        """A fitted mesh for the base, and a reference tangent from here."""
        tangent = self.curve_tangent(u)
        tangent = tangent / np.sqrt(self.inner(tangent, tangent))
        moved = self.base.remesh(u, tangent, *others)
        if moved is None:
            if abs(self.inner(tangent, self.reference)) > 0.9:
                return None
            return replace(self, reference=tangent), [u, *others]
        base, (u, tangent, *others_moved) = moved
        fixed = np.zeros(u.size)
        # Parameters stand last in every unknown, in the same order.
        place = self.fixed.size - int(np.flatnonzero(self.fixed)[0])
        fixed[fixed.size - place] = 1.0
        return replace(self, base=base, fixed=fixed, reference=tangent), [u, *others_moved]

    def spectrum(self, u: Array) -> Any:
        """That of the base, without the rate that is zero by the condition: its sign would be that of rounding."""
        found = self.base.spectrum(u)
        block = self.condition.neutral_block(self)
        if block is None:
            return found
        rates = found.rates[block]
        return replace(found, rates={**found.rates, block: np.delete(rates, np.abs(rates).argmin())})

    def block_rates(self, u: Array, block: Any, like: Any) -> Array:
        """Those of the base, without the rate that is zero by the condition."""
        rates: Array = self.base.block_rates(u, block, like)
        if block == self.condition.neutral_block(self):
            rates = np.delete(rates, np.abs(rates).argmin())
        return rates


def follow(
    branch: Branch[Any],
    special: SpecialPoint,
    second: str,
    options: BranchOptions,
    *,
    upwards: bool = True,
) -> Branch[CurveOnSurface]:
    """Follow a fold or a branch point of a branch while a second parameter varies.

    Args:
        branch: a branch.
        special: one of its special points, a ``fold:NAME`` or a ``bp``.
        second: the parameter to vary, as the problem's ``with_one_more_free`` takes it.
        options: where to stop and what to watch; turning points of ``second`` are cusps of a fold.
        upwards: whether the second parameter is to grow at first.

    Raises:
        ValueError: the special point is neither, or was not located.
    """
    if not special.converged or not (special.kind == "bp" or special.kind.startswith("fold:")):
        raise ValueError(f"special: {special.kind} at point {special.index} is no located fold or branch point")
    entry = branch.at(special)
    base, (u, tangent), place = entry.problem.with_one_more_free(second, entry.u, entry.tangent)
    fixed = np.zeros(u.size)
    fixed[place] = 1.0
    condition: Condition
    if special.kind == "bp":
        condition = NeutralCondition(special.block, entry.spectrum)
    else:
        name = special.kind.removeprefix("fold:")
        condition = FoldCondition(name, neutral=name == entry.problem.conserved)
    curve = CurveOnSurface(base, fixed, tangent / np.sqrt(base.inner(tangent, tangent)), condition)
    direction = tangent_along(curve, u, fixed if upwards else -fixed)
    newton = replace(options.path.newton, rounding=max(options.path.newton.rounding, NOISE))
    options = replace(options, path=replace(options.path, newton=newton))
    return continue_branch(Solution.along(curve, u, direction), options)
