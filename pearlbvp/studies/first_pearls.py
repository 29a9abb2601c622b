"""The pearls that straight tubes lose their stability to, and where they give way to one localized pearl."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from pearlbvp.helfrich import Tube
from pearlbvp.studies.localized import check_period, localized_row, pearls_on
from pearlbvp.studies.pearl_series import PearlSeries, losses
from pearlbvp.studies.stability_loss import Ending, Outcome, at_onset
from pearlbvp.theory.dispersion import StableInterval, stable_intervals


@dataclass(frozen=True)
class FirstPearls:
    """The first pearls of a straight tube.

    Attributes:
        tube: the straight tube.
        interval: in which it is stable.
        outcome: how its pearls lose stability, or why there are none.
    """

    tube: Tube
    interval: StableInterval
    outcome: Outcome

    @property
    def pearls(self) -> int | None:
        """How many there are; None where there are none."""
        return self.interval.lower_mode[0] if self.interval.exists and self.interval.lower_mode else None

    def row(self) -> dict[str, object]:
        """As in the table of ``localized_pearls``, at their own period."""
        if self.pearls is None:
            return {"c0": self.tube.c0, "period": math.nan, "L": self.tube.length, **self.outcome.row()}
        return localized_row(self.tube, self.tube.length / self.pearls, self.pearls, self.outcome)

    def period_row(self) -> dict[str, object]:
        """As in the table of ``period.pearl_periods``."""
        row: dict[str, object] = {"c0": self.tube.c0, "L": self.tube.length, "message": self.outcome.message}
        if not self.interval.exists:
            return row | {"status": self.outcome.status, "localized_status": self.outcome.status}
        row |= {"lambda2_upper": self.interval.upper, "upper_mode": "{}:{}".format(*self.interval.upper_mode)}
        if self.pearls is None:
            return row | {"status": self.outcome.status, "localized_status": self.outcome.status}
        row |= {"pearls": self.pearls, "period": self.tube.length / self.pearls, "status": "found",
                "k": self.tube.wave_number(self.pearls), "lambda2_pearl": self.interval.lower}  # fmt: skip
        if self.outcome.ending is Ending.ALONE:
            return row | {"localized_status": "single_pearl", "message": ""}
        values = self.outcome.values
        return row | {"localized_status": self.outcome.status, "v_localized": None if values is None else values.v}


def first_pearls(
    c0: float, lengths: Sequence[float], known: Sequence[PearlSeries] = ()
) -> tuple[list[FirstPearls], list[PearlSeries]]:
    """The first pearls of straight tubes of one ``c0``, by as few continuations as that takes.

    Args:
        c0: spontaneous curvature.
        lengths: of the tubes.
        known: series of this ``c0`` from before.

    Returns:
        One for each length, and the series that were computed for them.

    Raises:
        InputError: a tube that cannot be.
    """
    tubes = [Tube(c0, length) for length in lengths]
    intervals = stable_intervals(float(c0), np.array([tube.length for tube in tubes]))
    counts = [interval.lower_mode[0] if interval.lower_mode else 1 for interval in intervals]
    pearls = (
        (tube.length / m, m, _without_continuation(at)) for tube, m, at in zip(tubes, counts, intervals, strict=True)
    )
    outcomes, new = _outcomes(c0, pearls, known)
    return [FirstPearls(*each) for each in zip(tubes, intervals, outcomes, strict=True)], new


def pearls_of_periods(
    c0: float, tubes: Sequence[tuple[float, float]], known: Sequence[PearlSeries] = ()
) -> tuple[list[dict[str, object]], list[PearlSeries]]:
    """Rows of ``localized_pearls`` for tubes and periods of one ``c0``, by as few continuations as that takes.

    Args:
        c0: spontaneous curvature.
        tubes: lengths, and the periods of the pearls on them.
        known: series of this ``c0`` from before.

    Returns:
        A row for each, and the series that were computed for them.

    Raises:
        InputError: a tube or a period that cannot be, or a length that is no multiple of its period.
    """
    counts = [pearls_on(length, check_period(period)) for length, period in tubes]
    intervals = stable_intervals(float(c0), np.array([Tube(c0, length).length for length, _ in tubes]))
    pearls = ((period, m, at_onset(at, m)) for (_, period), m, at in zip(tubes, counts, intervals, strict=True))
    outcomes, new = _outcomes(c0, pearls, known)
    return [
        localized_row(Tube(c0, length), period, count, outcome)
        for (length, period), count, outcome in zip(tubes, counts, outcomes, strict=True)
    ], new


def _outcomes(
    c0: float, pearls: Iterable[tuple[float, int, Outcome | None]], known: Sequence[PearlSeries]
) -> tuple[list[Outcome], list[PearlSeries]]:
    """Outcomes of pearls of a period and number, those that were known first; and the series that were computed for others."""
    periods, counts, before = zip(*pearls, strict=True)
    wanted = np.array([outcome is None for outcome in before])
    found, new = losses(float(c0), np.array(periods)[wanted], np.array(counts)[wanted], known)
    computed = iter(found)
    return [next(computed) if outcome is None else outcome for outcome in before], new


def _without_continuation(interval: StableInterval) -> Outcome | None:
    """What the straight tube's stable interval tells already."""
    if interval.exists and interval.lower_mode is None:
        return Outcome(Ending.NO_PEARLS)
    return at_onset(interval, 0 if interval.lower_mode is None else interval.lower_mode[0])
