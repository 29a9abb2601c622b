"""Profiles from elsewhere: places along the axis and radii there, as one period of a tube, closed or open."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError
from pearlbvp.units import Sentence

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


def one_period(x: Array, r: Array, length: float) -> CubicSpline:
    """The periodic cubic spline through the rows of a profile.

    Args:
        x, r: places, growing or falling from row to row, with at most one leap back by a period; radii there. In radii.
        length: the period.

    Raises:
        InputError: it is no graph over one period, rows are missing, or it is of a tube with quite another radius.
    """
    x, r = np.asarray(x, dtype=float), np.asarray(r, dtype=float)
    _check_rows(x, r)
    x, r = _growing(x, r, length)
    _check_radius(x, r)
    _check_extent(x, length)
    end = min(x[-1] - x[-2], x[1] - x[0])
    gap = length - (x[-1] - x[0])
    if abs(gap) < CLOSED * end:
        slope = float(np.abs(np.diff(r) / np.diff(x)).max())
        if abs(r[-1] - r[0]) > slope * abs(gap) + DIFFERENT * np.ptp(r):
            raise InputError(
                "profile: its ends are one period apart, but r differs there; make them the same, or drop one"
            )
        x, r = x[:-1], r[:-1]
    return CubicSpline(np.append(x, x[0] + length), np.append(r, r[0]), bc_type="periodic")


def _check_rows(x: Array, r: Array) -> None:
    if x.ndim != 1 or x.shape != r.shape or len(x) < 4:
        raise InputError("profile: give four or more places x and as many radii r, all finite")
    wrong = ~(np.isfinite(x) & np.isfinite(r))
    if wrong.any():
        raise InputError(
            f"profile: x or r in row {int(wrong.argmax()) + 1} is not finite; complete it, or leave it out"
        )
    if r.min() <= 0:
        raise InputError(f"profile: r in row {int(r.argmin()) + 1} is not positive; give distances from the axis")


def _growing(x: Array, r: Array, length: float) -> tuple[Array, Array]:
    """The rows in growing order, each place once.

    What is neither in order nor begins again once is not sorted: it might be the outline of a tube that overhangs.
    """
    if (np.diff(x) < 0).sum() > len(x) / 2:
        x, r = x[::-1], r[::-1]
    (back,) = np.nonzero(np.diff(x) < 0)
    if len(back) == 1 and x[-1] <= x[0]:
        cut = int(back[0]) + 1
        x, r = np.append(x[cut:], x[:cut]), np.append(r[cut:], r[:cut])
    if (np.diff(x) < 0).any():
        raise InputError(
            "profile: x must grow from row to row, within one period; sort the rows, or give another shape if it overhangs"
        )
    again = np.diff(x) == 0
    if (again & (np.abs(np.diff(r)) > DIFFERENT * np.ptp(r))).any():
        text = "profile: two rows have x = {x:.6g} but different r; leave one out"
        raise InputError(Sentence(text, x=float(x[:-1][again][0])))
    kept = np.append(True, ~again)
    if kept.sum() < 4:
        raise InputError("profile: give four or more places x and as many radii r, all finite")
    return x[kept], r[kept]


def _check_extent(x: Array, length: float) -> None:
    """Whether the places fill one period, and no more."""
    steps, span = np.diff(x), x[-1] - x[0]
    lack, whole = length - span, (span + np.median(steps)) / length
    if lack < -CLOSED * min(steps[0], steps[-1]):
        text = (
            "profile: x runs over {x:.6g}, more than the period {length:.6g}"
            f" (about {whole:.3g} periods); give the rows of one period, or the length of the whole"
        )
        raise InputError(Sentence(text, x=float(span), length=length))
    if lack > (EVEN if steps.max() < EVEN * steps.min() else GAP) * steps.max():
        text = "profile: x runs over {x:.6g} of the period {length:.6g} only; give the rows of a whole period, or its length"
        raise InputError(Sentence(text, x=float(span), length=length))


def _check_radius(x: Array, r: Array) -> None:
    """Whether the profile is of a tube with about the radius 1: that of the cylinder of its area."""
    along = np.append(np.diff(x), np.median(np.diff(x)))  # the last step leads to the next period
    across = np.roll(r, -1) - r
    found = float((np.hypot(along, across) * (r + np.roll(r, -1)) / 2).sum() / along.sum())
    if not 1 / FARTHEST_RADIUS < found < FARTHEST_RADIUS:
        text = "radius: the tube's radius is about {r:.3g}, not {L:g}; give --radius {r:.3g}"
        raise InputError(Sentence(text, r=found, L=1.0))
