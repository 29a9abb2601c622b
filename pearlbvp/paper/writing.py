"""A figure of the paper as files: a table for each panel, its samples, and its numbers beside the printed ones."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pandas as pd

from pearlbvp.continuation.branch import Branch, SpecialPoint, Status
from pearlbvp.errors import InputError
from pearlbvp.paper.printed import beside_printed
from pearlbvp.paper.sheet import Samples, Sheet, sample_table


def tables_of(figure: str, sheet: Sheet) -> Iterator[tuple[str, pd.DataFrame]]:
    """Names of files without an ending, and what is in them."""
    for panel in sheet.panels:
        yield panel_name(figure, panel.letter), panel.table()
    if sheet.samples:
        yield f"{figure}_samples", sample_table(sheet.samples)
    beside = beside_printed(figure, sheet.values)
    if len(beside):
        yield f"{figure}_printed", beside


def panel_name(figure: str, letter: str) -> str:
    """``c00f_a1``."""
    return f"{figure}_{letter}"


def sample_branch(figure: str, samples: Samples, name: str) -> Branch[Any]:
    """A sample as a branch of one point, to save, to show and to go on from.

    Raises:
        InputError: the figure has no sample of that name.
    """
    if name not in samples:
        known = ", ".join(samples) or "none"
        raise InputError("point", f"{figure} has no sample {name!r}", f"its samples are {known}")
    special: list[SpecialPoint] = [SpecialPoint("start", 0), SpecialPoint("end", 0)]
    return Branch([samples[name]], special, Status.GIVEN, f"it is sample {name} of Fig. {figure}")
