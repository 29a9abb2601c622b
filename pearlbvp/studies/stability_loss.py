"""How pearls lose their stability: to a localized pearl, to something else, or not at all; and the words for it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from pearlbvp.theory.dispersion import StableInterval
from pearlbvp.units import Sentence

THINNEST_NECK = 0.1
"""Radius of the neck at which the search along the pearls ends."""


class Ending(Enum):
    """What ends the stability of the straight tube, or of its pearls: a status, and a message about a detail."""

    NO_CYLINDER = "no_stable_cylinder", "the straight tube of this length is stable for no lambda2"
    NO_PEARLS = (
        "none_in_range",
        "no pearls with k < 1 fit a tube of this length: nothing ends its stable interval from below",
    )
    NOT_FIRST = "unstable_at_onset", "the straight tube is unstable there already (first: {})"
    ALONE = "none_in_range", "one pearl fills the tube: there are no others for it to stand out from"
    FOUND = "found", ""
    FOLD = (
        "none_in_range",
        "the pearls lose stability at a fold in v = {:.6g} before any localized pearl branches off",
    )
    AROUND = (
        "none_in_range",
        "the pearls lose stability to a wave of n = {} before any localized pearl branches off",
    )
    STABLE = "none_in_range", "the pearls stay stable until their necks are thinner than {r:g} {r_unit}"
    CUT = "failed", "the pearls could not be followed far enough: "
    FAILED = "failed", "{}"


class LocalizedPearl(NamedTuple):
    """The pearls at the branch point of the localized pearl; ``E`` by area, ``amplitude`` half the belly's radius minus
    the neck's.
    """  # fmt: skip

    lambda1: float
    lambda2: float
    v: float
    E: float
    amplitude: float


@dataclass(frozen=True)
class Outcome:
    """What became of pearls.

    Attributes:
        ending: what ended their stability.
        detail: of it, for the message: a number or words.
        values: at the branch point, where one was found.
    """

    ending: Ending
    detail: float | str = ""
    values: LocalizedPearl | None = None

    @property
    def status(self) -> str:
        """As tables have it."""
        return str(self.ending.value[0])

    @property
    def message(self) -> str:
        """Why there is no branch point; empty where there is one."""
        text = str(self.ending.value[1])
        if self.ending is Ending.STABLE:
            return Sentence(text, r=THINNEST_NECK)
        if self.ending is Ending.CUT and isinstance(self.detail, str):
            return Sentence.joined(text, self.detail)
        return text.format(self.detail)

    def row(self) -> dict[str, object]:
        """The columns ``status, message, lambda1, lambda2, v, E, amplitude``, without those that have no value."""
        values = {} if self.values is None else self.values._asdict()
        return {"status": self.status, **values, "message": self.message}


def at_onset(interval: StableInterval, pearls: int) -> Outcome | None:
    """What keeps pearls from being stable at their onset, given the straight tube's stable interval; or None."""
    if not interval.exists:
        return Outcome(Ending.NO_CYLINDER)
    if interval.lower_mode != (pearls, 0):
        first = "none" if interval.lower_mode is None else f"{interval.lower_mode[0]} pearls"
        return Outcome(Ending.NOT_FIRST, first)
    return Outcome(Ending.ALONE) if pearls == 1 else None
