"""A branch as a smooth curve: between computed points every number is a cubic by arclength (Hermite), from its slopes there.

The slopes come from the tangents, so that two points say as much of a curve as four would without them: the error is of the
fourth order in the step (C. de Boor, A Practical Guide to Splines (Springer 1978), ch. IV: ``h^4 max|y''''| / 384``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.solution import DIFFERENCE, Solution

if TYPE_CHECKING:
    import pandas as pd

BETWEEN = 16
"""Steps from one point of a branch to the next."""


@dataclass(frozen=True)
class Hermite:
    """What the curve is made of.

    Attributes:
        table: rows of the branch's points.
        leaving, arriving: of every column of numbers, derivatives by the share of the way from one point to the next, at
            the first of the two and at the second: a row less.
    """

    table: pd.DataFrame
    leaving: pd.DataFrame
    arriving: pd.DataFrame


def hermite(branch: Branch[Any]) -> Hermite:
    """Values and slopes at a branch's points.

    Columns that are no observables, like growth rates, have slopes by which they are monotone between neighbours (PCHIP).
    """
    import pandas as pd

    table, points = branch.table(), branch.points
    lengths = np.array([(_length(p, q), -_length(q, p)) for p, q in pairwise(points)]).reshape(-1, 2)
    last = len(points) - 1
    slopes = pd.DataFrame([_slopes(point, i > 0, i < last) for i, point in enumerate(points)])
    ways = np.concatenate(([0.0], np.cumsum(np.abs(lengths[:, 0]))))
    leaving, arriving = pd.DataFrame(index=range(last)), pd.DataFrame(index=range(last))
    for name in table.select_dtypes("number").columns.drop(["point", "n_unstable"]):
        if name in slopes:
            ends = slopes[name].to_numpy()
            leaving[name], arriving[name] = lengths[:, 0] * ends[:-1], lengths[:, 1] * ends[1:]
        else:
            ends = _monotone(ways, table[name].to_numpy(float, na_value=np.nan))
            leaving[name], arriving[name] = np.diff(ways) * ends[:-1], np.diff(ways) * ends[1:]
    return Hermite(table, leaving, arriving)


def curve(branch: Branch[Any], between: int = BETWEEN) -> pd.DataFrame:
    """A branch's table with rows between its points; their number ``point`` is a fraction, nothing is special there.

    ``n_unstable`` between two points is the larger of theirs: a stretch is stable where neither of its ends is unstable.
    """
    import pandas as pd

    found = hermite(branch)
    table = found.table
    if len(table) == 1:
        return table
    t = np.arange(between)[:, None] / between
    rows = {}
    for name in table:
        values = table[name]
        if name in found.leaving:
            y = values.to_numpy(float, na_value=np.nan)
            rows[name] = np.append(_cubic(t, y, found.leaving[name].to_numpy(), found.arriving[name].to_numpy()), y[-1])
        elif name == "point":
            rows[name] = np.append((values.to_numpy(float)[:-1] + t).T.ravel(), values.iloc[-1])
        else:
            rows[name] = np.full(between * (len(table) - 1) + 1, "", dtype=object)
            rows[name][::between] = values
    unstable = table["n_unstable"]
    larger = np.maximum(unstable[:-1].to_numpy(float, na_value=np.nan), unstable[1:].to_numpy(float, na_value=np.nan))
    rows["n_unstable"] = np.append(np.repeat(larger, between), np.nan)
    rows["n_unstable"][::between] = unstable.to_numpy(float, na_value=np.nan)
    return pd.DataFrame(rows).astype({"n_unstable": "Int64"})


def _cubic(t: Array, y: Array, leaving: Array, arriving: Array) -> Array:
    """Values at shares ``t``, shape (T, 1), of all intervals, one after another; the first of each is the point itself."""
    start, step = y[:-1], np.diff(y)
    found = start + t * (leaving + t * (3 * step - 2 * leaving - arriving + t * (leaving + arriving - 2 * step)))
    found[0] = start
    return np.asarray(found.T.ravel())


def _length(here: Solution[Any], there: Solution[Any]) -> float:
    """Arclength to a neighbour in the norm of ``here``, negative against the tangent.

    The chord, as that of a circle that has the tangent here: ``c phi / sin phi`` with the angle ``phi`` between the two. It
    differs from the curve's by ``O(h^4)``.
    """
    problem = here.problem
    chord = problem.transfer(there.problem, there.u) - here.u
    length = math.sqrt(problem.inner(chord, chord))
    if length == 0:
        return 0.0
    cosine = problem.inner(here.tangent, chord) / length
    angle = math.acos(min(1.0, abs(cosine)))
    return math.copysign(length * (angle / math.sin(angle) if angle else 1.0), cosine)


def _slopes(point: Solution[Any], before: bool, after: bool) -> dict[str, float]:
    """Derivatives of observables by arclength, by differences of second order to the sides on which the branch has points.

    Where a branch begins, as at the straight tube, an amplitude has a kink.
    """
    if before and after:
        return dict(point.slopes)
    side = DIFFERENCE if after else -DIFFERENCE
    here, near, far = (point.problem.observables(point.u + s * side * point.tangent) for s in (0, 1, 2))
    return {name: (4 * near[name] - 3 * here[name] - far[name]) / (2 * side) for name in here}


def _monotone(ways: Array, values: Array) -> Array:
    """Slopes of numbers that are known on some points, monotone between neighbours; not a number at the others."""
    slopes = np.full(len(values), np.nan)
    known = np.isfinite(values) & (np.diff(ways, prepend=-1.0) > 0)
    if known.sum() > 1:
        from scipy.interpolate import PchipInterpolator  # a fifth of a second to import, and only pictures need it

        slopes[known] = PchipInterpolator(ways[known], values[known]).derivative()(ways[known])
    return slopes
