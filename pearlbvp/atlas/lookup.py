"""What the atlas tells of given pearls, and where it tells nothing."""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pearlbvp.arrays import Array
from pearlbvp.atlas.series import CURVATURES, Atlas, scaled
from pearlbvp.errors import InputError
from pearlbvp.studies.amplitude_series import at_shares, first_losses
from pearlbvp.theory.dispersion import stable_wave_numbers

AT_ONCE = 4096
"""Pearls looked up together, to bound the memory."""

MARGIN = 3e-4
"""Share of a band of wave numbers next to its ends where numbers are not known to 1e-8: pearls lose stability near onset."""


class LocalizedPearls(NamedTuple):
    """Pearls at the branch point of the localized pearl, as arrays; ``E`` by area, ``amplitude`` half the belly's radius minus
    the neck's.
    """  # fmt: skip

    lambda1: Array
    lambda2: Array
    v: Array
    E: Array
    amplitude: Array


def holds(c0: ArrayLike, period: ArrayLike, pearls: ArrayLike) -> NDArray[np.bool_]:
    """Whether the atlas has these pearls: 0.26 <= c0 <= 0.49, and 2 or more that are stable at their onset. Broadcasts."""
    c0, period, pearls = (np.asarray(given, dtype=float) for given in (c0, period, pearls))
    inside = (CURVATURES[0] <= c0) & (c0 <= CURVATURES[1])
    whole = (pearls >= 2) & (pearls == np.floor(pearls)) & np.isfinite(pearls)
    short, long = _periods(np.where(inside, c0, CURVATURES[0]), np.where(whole, pearls, 2))
    return np.asarray(inside & whole & (short <= period) & (period <= long))


def _periods(c0: ArrayLike, pearls: ArrayLike) -> tuple[Array, Array]:
    """The shortest and longest of so many pearls that the atlas has."""
    low, high = stable_wave_numbers(c0, pearls)
    margin = MARGIN * (high - low)
    return 2 * np.pi / (high - margin), 2 * np.pi / (low + margin)


def localized(c0: ArrayLike, period: ArrayLike, pearls: ArrayLike) -> LocalizedPearls:
    """Where pearls give way to one localized pearl, to 1e-8, in microseconds.

    Args:
        c0: spontaneous curvature, from 0.26 to 0.49.
        period: of one pearl, in radii of the straight tube.
        pearls: how many of them there are, 2 or more.

    Returns:
        Arrays of the shape that the arguments broadcast to.

    Raises:
        InputError: the atlas does not have one of them (``holds``); the message says what it has.

    Examples:
        >>> import pearlbvp as pb
        >>> round(float(pb.atlas.localized(0.48, 7.5, 2).v), 6)
        1.008111
    """
    c0, period, pearls = np.broadcast_arrays(*(np.asarray(given, dtype=float) for given in (c0, period, pearls)))
    had = holds(c0, period, pearls)
    if not had.all():
        raise _not_held(*(float(given[~had][0]) for given in (c0, period, pearls)))
    flat = [np.ravel(given) for given in (c0, period, pearls)]
    found = np.empty((c0.size, 5))
    for start in range(0, c0.size, AT_ONCE):
        here = slice(start, start + AT_ONCE)
        found[here] = _looked_up(*(given[here] for given in flat))
    return LocalizedPearls(*(column.reshape(c0.shape) for column in found.T))


def _looked_up(c0: Array, period: Array, pearls: Array) -> Array:
    """``LocalizedPearls`` as columns, shape (K, 5)."""
    atlas = _atlas()
    piece = np.searchsorted([one.high for one in atlas.pieces[:-1]], scaled(c0))
    found = np.empty((len(c0), 5))
    for number in np.unique(piece).tolist():
        here = piece == number
        c = atlas.pieces[number].at(c0[here], period[here])
        share = first_losses(c, pearls[here].astype(np.int64))
        found[here, :4] = at_shares(c, share)[:, :4]
        found[here, 4] = np.sqrt(share * atlas.reach(c0[here]))
    return found


@cache
def _atlas() -> Atlas:
    return Atlas.load()


def _not_held(c0: float, period: float, pearls: float) -> InputError:
    """Why the atlas does not have some pearls."""
    if not (2 <= pearls < math.inf and pearls == int(pearls)):
        return InputError(
            "pearls", f"{pearls:g} is no number of pearls that can lose stability to one of them", "give 2 or more"
        )
    if not CURVATURES[0] <= c0 <= CURVATURES[1]:
        low, high = CURVATURES
        return InputError("c0", f"the atlas has {low:g} to {high:g}, not {c0:g}", "use localized_pearls")
    short, long = (float(end) for end in _periods(c0, pearls))
    return InputError(
        "period",
        f"{pearls:g} pearls of period {period:.9g} radii are not stable at their onset, or hardly (c0 = {c0:g})",
        f"give one from {short:.6g} to {long:.6g}",
    )
