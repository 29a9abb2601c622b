"""Profiles from elsewhere: places along the axis and radii there, as one period of a tube, closed or open.

The energy's gradient is of fourth order, so that what few digits leave out, which is nothing to the eye, is most of it: a sine
of amplitude 0.1 in 40 rows of three decimals has a tension of -120 instead of -2.4. Such rows are smoothed: by the fewest waves
that meet them to within their rounding.
"""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import solve_triangular

from pearlbvp.arrays import Array, Integers
from pearlbvp.errors import InputError
from pearlbvp.messages import counted
from pearlbvp.rounding import NEGLIGIBLE, deviation, steps
from pearlbvp.tables import read_table
from pearlbvp.units import RADII, Sentence, Units

CLOSED = 0.25
"""Distance of the last place from where the period ends, in steps, below which it is there to its own precision.

Digits of tables are fewer than those of the period, and rounding moves places by far less than a step. A place that does lie
so near is not missed: its neighbour at the beginning of the next period tells the same.
"""

DIFFERENT = 0.01
"""Difference of radii one period apart, by their range, beyond which they are not the same."""

GAP = 3.0
"""Stretch from the last place to the next period, in the longest step, beyond which rows are missing there."""

EVEN = 1.5
"""The same where steps are even, and the largest ratio of such steps."""

FARTHEST_RADIUS = 3.0
"""Factor between a profile's radius and the tube's beyond which they are in different units."""


WAVES = (16, 64, 256)
"""Waves that are tried, in turn: rows of thousands need few, and the work grows with their square."""

SPARE = 3
"""Rows that there are at least beyond the numbers of a smooth profile; without any, everything would fit."""

SHARE = 5
"""One of so many rows at least is beyond them, too."""

COST = 2.0
"""What a further number has to take off the sum of squared errors, by the logarithm of the number of rows.

Schwarz's criterion (Ann. Statist. 6 (1978) 461) has 1; but rows of one wave are alike in twos and fours, and so is their
rounding, which makes waves of its own.
"""

LARGEST = 3.0
"""Square of the largest rounding error, half a step, by the mean square of all."""

EVIDENT = 0.1
"""Share of fourth differences from which on rounding that cannot be smoothed is said."""

AT_ONCE = 20_000
"""Rows that are put into equations at a time, for the sake of memory."""


@dataclass(frozen=True)
class Rows:
    """Rows of a profile, and what a user should know of them.

    Attributes:
        x, r: places and radii.
        said: what was done to them; empty where nothing was.
    """

    x: Array
    r: Array
    said: str = ""


def one_period(x: Array, r: Array, length: float) -> CubicSpline:
    """The periodic cubic spline through the rows of a profile.

    Args:
        x, r: places, growing or falling from row to row, with at most one leap back by a period; radii there. In radii.
        length: the period.

    Raises:
        InputError: it is no graph over one period, rows are missing, or it is of a tube with quite another radius.
    """
    x, r = np.asarray(x, dtype=float), np.asarray(r, dtype=float)
    kept = _kept(x, r, length)
    return _spline(x[kept], r[kept], length)


def _spline(x: Array, r: Array, length: float) -> CubicSpline:
    return CubicSpline(np.append(x, x[0] + length), np.append(r, r[0]), bc_type="periodic")


def _kept(x: Array, r: Array, length: float, allowed: float | None = None) -> Integers:
    """The rows of one period in order, each place once; ``allowed`` is by how much r may differ where places are the same.

    Raises:
        InputError: see ``one_period``.
    """
    _check_rows(x, r)
    order = _growing(x, r, allowed)
    x, r = x[order], r[order]
    _check_radius(x, r)
    _check_extent(x, length)
    end = min(x[-1] - x[-2], x[1] - x[0])
    gap = length - (x[-1] - x[0])
    if abs(gap) < CLOSED * end:
        slope = float(np.abs(np.diff(r) / np.diff(x)).max())
        if abs(r[-1] - r[0]) > slope * abs(gap) + DIFFERENT * np.ptp(r):
            raise InputError(
                "profile", "its ends are one period apart, but r differs there", "make them the same, or drop one"
            )
        return order[:-1]
    return order


def read_profile(
    name: str, path: str | os.PathLike[str], length: float, points: int = 128, units: Units = RADII
) -> Rows:
    """Columns ``x`` and ``r`` of a table in radii, without its rounding; of one without a header the first is ``x``.

    Args:
        name: the argument's name, for the message.
        path: of the table, in the user's unit, or in those that stand in the columns' names: ``x[nm]``.
        length: of a period, in radii.
        points: as for ``without_rounding``.
        units: of the user.

    Raises:
        InputError: the table cannot be read, is in a unit that cannot be converted, or is no profile.
    """
    table = read_table(name, path, ("x", "r"), unnamed=("x", "r"))

    def in_radii(column: str, values: Array) -> Array:
        return units.from_user(column, units.from_heading(name, column, table.headings[column], values))

    x, r = np.array(table["x"]), np.array(table["r"])
    rounded = in_radii("x", steps(x)), in_radii("r", steps(r))
    return without_rounding(in_radii("x", x), in_radii("r", r), length, *rounded, points=points)


def without_rounding(x: Array, r: Array, length: float, x_steps: Array, r_steps: Array, *, points: int = 128) -> Rows:
    """The rows of a profile in a file, smoothed where its digits are too few to tell how it is curved.

    The smooth profile has as few waves as what is known of the errors allows: each further one must lessen the distances from
    the rows by more than rounding alone would, and those that remain must be such as rounding leaves. Places that were equally
    far apart before they were rounded are so again. Rows of enough digits are returned as they are.

    Args:
        x, r, length: as for ``one_period``.
        x_steps, r_steps: to which each number was rounded (``rounding.steps``), in radii, too.
        points: evenly spaced, at which the profile is going to be used: what lies closer is not resolved anyway.

    Raises:
        InputError: as ``one_period``, and where rows at one place differ by more than their rounding.
    """
    x, r = np.asarray(x, dtype=float), np.asarray(r, dtype=float)
    _check_rows(x, r)
    slopes = np.abs(np.diff(r))[np.diff(x) != 0] / np.abs(np.diff(x)[np.diff(x) != 0])
    steepest = float(np.quantile(slopes, 0.9)) if slopes.size else 0.0
    kept = _kept(x, r, length, 2 * float(np.max(r_steps) + steepest * np.max(x_steps)))
    twice = len(x) - len(np.unique(x))
    said = f"left out {counted(twice, 'row')} at places that are there already" if twice else ""
    own_x, own_r, x_steps, r_steps = x[kept], r[kept], x_steps[kept], r_steps[kept]
    places, x_errors = _even(own_x, x_steps, length)
    errors = np.hypot(deviation(r_steps), _slopes(places, own_r, length) * x_errors)
    share = _share(_spline(own_x, own_r, length), errors, length, min(len(own_x), points))
    if share < NEGLIGIBLE:
        return Rows(x, r, said)
    found = _fewest_waves(places, own_r, errors, length)
    if found is not None and x_errors.any():  # whose effect is known by the slopes of the smooth profile only
        errors = np.hypot(deviation(r_steps), _slopes(places, found[0], length) * x_errors)
        found = _fewest_waves(places, own_r, errors, length) or found
    if found is None:
        text = Sentence("r is rounded to {r:.2g}, which", r=float(r_steps.max()))
        why = " decides about its curvature, and no smooth profile is as near to it: forces and multipliers at first are off"
        return Rows(x, r, Sentence.joined(said, "; " if said else "", text, why) if share > EVIDENT else said)
    smooth, waves = found
    moved = float(np.abs(smooth - own_r).max())
    if moved == 0:
        return Rows(x, r, said)
    text = Sentence("r is rounded to {r:.2g}, too few digits for its curvature", r=float(r_steps.max()))
    by = Sentence(f": smoothed by {counted(waves, 'wave')}, which moves rows by up to {{r:.2g}}", r=moved)
    return Rows(places, smooth, Sentence.joined(said, "; " if said else "", text, by))


def _even(x: Array, x_steps: Array, length: float) -> tuple[Array, Array]:
    """Places, and their standard errors: equally far apart and exact, where they are so but for their rounding."""
    count, coarse = len(x), float(x_steps.max())
    number = np.arange(count)
    for step in (length / count, float(np.polyfit(number, x, 1)[0])):
        away = x - step * number
        if np.ptp(away) <= 1.01 * coarse:
            return step * number + (away.max() + away.min()) / 2, np.zeros(count)
    return x, deviation(x_steps)


def _slopes(x: Array, r: Array, length: float) -> Array:
    """Slopes over four steps: over one, they would be those of the rounding."""
    whole_x = np.concatenate((x[-2:] - length, x, x[:2] + length))
    whole_r = np.concatenate((r[-2:], r, r[:2]))
    return np.asarray((whole_r[4:] - whole_r[:-4]) / (whole_x[4:] - whole_x[:-4]))


def _share(spline: CubicSpline, errors: Array, length: float, count: int) -> float:
    """How much of the fourth differences is rounding, whose own are the square root of 70 times as large."""
    r = spline(spline.x[0] + length * np.arange(count) / count)
    for _ in range(4):
        r = np.roll(r, -1) - r
    seen, noise = float(np.sqrt((r**2).mean())), float(np.sqrt(70 * (errors**2).mean()))
    return noise / seen if seen > 1e-14 else 0.0


def _fewest_waves(x: Array, r: Array, errors: Array, length: float) -> tuple[Array, int] | None:
    """The rows on the profile of as few waves as the errors ask for, and how many; None if none is as near as rounding is.

    One orthogonal triangularization tells the sums of squares of all numbers of waves.
    """
    count = len(x)
    gap = float(np.diff(np.append(x, x[0] + length)).max())
    most = min((count - max(SPARE, count // SHARE) - 1) // 2, int(length / (2 * gap)), WAVES[-1])
    phase = 2 * np.pi * (x - x[0]) / length
    for waves in sorted({min(number, most) for number in WAVES}):
        triangle = np.zeros((0, 2 * waves + 2))
        for rows in np.split(np.arange(count), range(AT_ONCE, count, AT_ONCE)):
            block = np.column_stack((_waves(phase[rows], waves), r[rows])) / errors[rows, None]
            triangle = np.asarray(np.linalg.qr(np.vstack((triangle, block)), mode="r"))
        left = np.append(np.cumsum(triangle[::-1, -1] ** 2)[::-1], 0.0)
        sizes = 2 * np.arange(waves + 1) + 1
        number = int((left[sizes] + COST * np.log(count) * sizes).argmin())
        size = int(sizes[number])
        if left[size] <= LARGEST * (count - size) and (number < waves or waves == most):
            values = solve_triangular(triangle[:size, :size], triangle[:size, -1])
            return np.asarray(_waves(phase, number) @ values), number
    return None


def _waves(phase: Array, number: int) -> Array:
    """1, and cosine and sine of each wave in turn, at phases of the first."""
    angles = np.outer(phase, np.arange(1, number + 1))
    both = np.stack((np.cos(angles), np.sin(angles)), axis=2).reshape(len(phase), 2 * number)
    return np.column_stack((np.ones(len(phase)), both))


def _check_rows(x: Array, r: Array) -> None:
    if x.ndim != 1 or x.shape != r.shape or len(x) < 4:
        raise InputError("profile", "give four or more places x and as many radii r, all finite")
    wrong = ~(np.isfinite(x) & np.isfinite(r))
    if wrong.any():
        raise InputError(
            "profile", f"x or r in row {int(wrong.argmax()) + 1} is not finite", "complete it, or leave it out"
        )
    if r.min() <= 0:
        raise InputError("profile", f"r in row {int(r.argmin()) + 1} is not positive", "give distances from the axis")


def _growing(x: Array, r: Array, allowed: float | None) -> Integers:
    """The rows in growing order, each place once, r differing by no more than ``allowed`` where one is there again.

    What is neither in order nor begins again once is not sorted: it might be the outline of a tube that overhangs.
    """
    order = np.arange(len(x))
    if (np.diff(x) < 0).sum() > len(x) / 2:
        order = order[::-1]
    (back,) = np.nonzero(np.diff(x[order]) < 0)
    if len(back) == 1 and x[order[-1]] <= x[order[0]]:
        order = np.roll(order, -int(back[0]) - 1)
    x, r = x[order], r[order]
    if (np.diff(x) < 0).any():
        raise InputError(
            "profile",
            "x must grow from row to row, within one period",
            "sort the rows, or give another shape if it overhangs",
        )
    again = np.diff(x) == 0
    if (again & (np.abs(np.diff(r)) > (DIFFERENT * np.ptp(r) if allowed is None else allowed))).any():
        what = Sentence("two rows have x = {x:.6g} but different r", x=float(x[:-1][again][0]))
        raise InputError("profile", what, "leave one out")
    kept = order[np.append(True, ~again)]
    if len(kept) < 4:
        raise InputError("profile", "give four or more places x and as many radii r, all finite")
    return kept


def _check_extent(x: Array, length: float) -> None:
    """Whether the places fill one period, and no more."""
    steps, span = np.diff(x), x[-1] - x[0]
    lack, whole = length - span, (span + np.median(steps)) / length
    if lack < -CLOSED * min(steps[0], steps[-1]):
        text = f"x runs over {{x:.6g}}, more than the period {{length:.6g}} (about {whole:.3g} periods)"
        what = Sentence(text, x=float(span), length=length)
        raise InputError("profile", what, "give the rows of one period, or the length of the whole")
    if lack > (EVEN if steps.max() < EVEN * steps.min() else GAP) * steps.max():
        what = Sentence("x runs over {x:.6g} of the period {length:.6g} only", x=float(span), length=length)
        raise InputError("profile", what, "give the rows of a whole period, or its length")


def _check_radius(x: Array, r: Array) -> None:
    """Whether the profile is of a tube with about the radius 1: that of the cylinder of its area."""
    along = np.append(np.diff(x), np.median(np.diff(x)))  # the last step leads to the next period
    across = np.roll(r, -1) - r
    found = float((np.hypot(along, across) * (r + np.roll(r, -1)) / 2).sum() / along.sum())
    if not 1 / FARTHEST_RADIUS < found < FARTHEST_RADIUS:
        what = Sentence("the tube's radius is about {r:.3g}, not {L:g}", r=found, L=1.0)
        raise InputError("radius", what, Sentence("give radius={r:.3g}", r=found))
