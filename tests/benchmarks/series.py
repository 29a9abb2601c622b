"""Pearls of all periods from series, and of all tubes from the atlas, beside a continuation for each."""

from __future__ import annotations

import numpy as np
from rows import Row, of_call, row, written

import pearlbvp as pb
from pearlbvp.studies.first_pearls import FirstPearls, first_pearls
from pearlbvp.studies.localized import losses_at
from pearlbvp.studies.stability_loss import Outcome
from pearlbvp.theory.dispersion import stable_wave_numbers

CURVATURES, LENGTHS, PLACES = 16, 150, 100_000


def _alone(found: FirstPearls) -> Outcome:
    """The same by a continuation."""
    assert found.pearls is not None
    return losses_at(found.tube.c0, found.tube.length / found.pearls, [found.pearls])[0]


@row(f"localized pearls of {LENGTHS} random lengths for each of {CURVATURES} random c0 from 0.255 to 0.5")
def series() -> Row:
    """Where what is said differs, and the largest difference of a number."""
    random = np.random.default_rng(0)
    differing, largest, fast, slow = 0, 0.0, 0.0, 0.0
    for c0 in random.uniform(0.255, 0.5, CURVATURES).tolist():
        lengths = random.uniform(8, 200 if c0 > 0.28 else 600, LENGTHS).tolist()
        both: list[list[FirstPearls]] = []
        fast += of_call(lambda c0=c0, lengths=lengths, both=both: both.append(first_pearls(c0, lengths)[0]))
        several = [found for found in both[0] if found.pearls is not None and found.pearls > 1]
        outcomes: list[Outcome] = []
        slow += of_call(lambda several=several, outcomes=outcomes: outcomes.extend(map(_alone, several)))
        for found, alone in zip(several, outcomes, strict=True):
            if (found.outcome.status, found.outcome.message) != (alone.status, alone.message):
                differing += 1
            elif alone.values is not None and found.outcome.values is not None:
                largest = max(largest, float(np.abs(np.subtract(alone.values, found.outcome.values)).max()))
    what = f"{differing} rows differ in status or message, numbers by {largest:.0e}"
    return Row(f"{written(fast)}; {what}", f"one by one: {written(slow)}", f"{slow / fast:.1f}", "0 rows, 1e-9")


@row("one localized pearl in the atlas, and its error at 200 random places")
def atlas() -> Row:
    """Two to forty pearls of any period, c0 from 0.26 to 0.49."""
    random = np.random.default_rng(0)
    c0, pearls = random.uniform(0.26, 0.49, PLACES), random.integers(2, 41, PLACES)
    low, high = stable_wave_numbers(c0, pearls)
    period = 2 * np.pi / (low + random.uniform(0.001, 0.999, PLACES) * (high - low))
    pb.atlas.localized(c0[:1], period[:1], pearls[:1])
    each = of_call(lambda: pb.atlas.localized(c0, period, pearls)) / PLACES
    some = slice(0, 200)
    alone: list[Outcome] = []
    peer = of_call(
        lambda: alone.extend(
            losses_at(*case, [count])[0]
            for *case, count in zip(c0[some].tolist(), period[some].tolist(), pearls[some].tolist(), strict=True)
        )
    )
    found = np.array(pb.atlas.localized(c0[some], period[some], pearls[some])).T
    error = np.abs(found - np.array([one.values for one in alone])).max()
    one = peer / len(alone)
    return Row(f"{1e6 * each:.0f} µs, error {error:.0e}", f"continuation: {written(one)}", f"{one / each:,.0f}", "1e-8")
