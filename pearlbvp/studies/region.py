"""In which part of the plane of period and volume are pearls stable? (What pattern formation calls the Busse balloon.)

Pearls of a period are stable from their onset at ``v = 1`` to the volume at which the localized pearl branches off, which
depends on how many of them there are: each number of pearls has its own boundary over the period.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from pearlbvp.errors import InputError
from pearlbvp.numbers import as_numbers
from pearlbvp.progress import progress as progress_bar
from pearlbvp.studies.localized import localized_rows

if TYPE_CHECKING:
    import pandas as pd


def stability_region(
    c0: float,
    periods: float | str | Iterable[float],
    pearls: str | Iterable[float] = (2, 3, 4, 6, 8, 16),
    *,
    progress: bool | None = None,
) -> pd.DataFrame:
    """Upper ends of the stable range of periodic pearls, over the period, for several numbers of pearls.

    Args:
        c0: spontaneous curvature.
        periods: axial periods of one pearl, above ``2 pi``: a number, several, or a text like ``6.6:10:0.1``.
        pearls: numbers of pearls on the tube, 2 or more.
        progress: show a bar on standard error (``None``: if that is a terminal).

    Returns:
        A row a period and number, with the columns of ``localized_pearls``. Where ``status`` is ``found`` the pearls are
        stable for ``1 < v < v of the row``; where it is ``unstable_at_onset`` they are not stable at onset.

    Raises:
        InputError: an argument that cannot be used.
    """
    import pandas as pd

    wanted = as_numbers("pearls", pearls)
    counts = [int(count) for count in wanted if count == int(count) and count >= 2]
    if len(counts) < len(wanted):
        raise InputError(
            "pearls", "the numbers must be whole and 2 or more", "one pearl has no others to lose its stability to"
        )
    rows: list[dict[str, object]] = []
    values = as_numbers("periods", periods)
    with progress_bar("period", len(values), shown=progress) as bar:
        for period in values:
            rows += localized_rows(c0, period, [count * period for count in counts])
            bar.update()
    return pd.DataFrame(rows)
