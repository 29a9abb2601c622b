"""Which figures and tables of the paper there are, and what of them is computed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import pandas as pd

from pearlbvp.errors import InputError
from pearlbvp.paper import amplitudes, diagrams, flows, straight
from pearlbvp.paper.printed import printed_values
from pearlbvp.paper.sheet import Sheet
from pearlbvp.studies.localized import localized_pearls


@dataclass(frozen=True)
class Entry:
    """A figure or a table.

    Attributes:
        title: what it shows.
        panels: the paper's letters, in order.
        compute: makes it.
        missing: panels that are not computed, and why.
    """

    title: str
    panels: tuple[str, ...]
    compute: Callable[[], Sheet]
    missing: str = ""


def ptt1() -> Sheet:
    """Where one localized pearl branches from pearls of period 7.5, over the tube's length (eq. (ptt1))."""
    found = localized_pearls(c0=0.48, period=7.5, lengths=[15, 30, 45, 60])
    return Sheet((), {(f"L = {L:g}", "v"): float(v) for L, v in zip(found["L"], found["v"], strict=True)})


CATALOGUE = {
    "f0": Entry("shapes in experiments and computed", ("c",), diagrams.f0, "a, b: photographs of experiments"),
    "neigs": Entry("instabilities of the straight tube", ("a", "b", "c", "d", "e_regions", "e_rates"), straight.neigs),
    "stabfig": Entry("stability of coils and buckles by b1, b2", ("a",), straight.stabfig),
    "c00f": Entry("c0 = 0, L = 10: branches and samples", ("a1", "a2", "a3", "b"), diagrams.c00f),
    "ampc00f": Entry("c0 = 0: amplitude equations", ("a1", "a2", "a3", "b1", "b2", "b3"), amplitudes.ampc00f),
    "c0f2": Entry("c0 = 0: flows", ("a", "b", "c1", "c2"), flows.c0f2),
    "ptab1": Entry("table: spectra of samples, ends of flows", (), flows.ptab1),
    "cmf1": Entry("c0 = -1, L = 10: branches and samples", ("a1", "a2", "a3", "b"), diagrams.cmf1),
    "cmf2": Entry("c0 = -1: flows", ("a", "b", "c"), flows.cmf2),
    "cmf1b": Entry("c0 = -1: amplitude equation of wrinkles", ("1", "2", "3"), amplitudes.cmf1b),
    "c005f2": Entry("c0 = 0.48, L = 10: coils and buckles", ("a1", "a2", "b", "d1", "d2", "d3"), diagrams.c005f2,
                    "c: sample C stands with A and B in b"),
    "c05f1": Entry("c0 = 0.48, L = 15: branches and samples", ("a1", "a2", "a3", "c"), diagrams.c05f1),
    "c05f2": Entry("c0 = 0.48, L = 15: flow to the localized pearl", ("a",), flows.c05f2),
    "c05f1l": Entry("c0 = 0.48, L = 30: branches and samples", ("a1", "b"), diagrams.c05f1l),
    "ptt1": Entry("table: localized pearls by length", (), ptt1),
    "c1f1": Entry("c0 = 0.75, L = 10: branches, samples, flow", ("a1", "a2", "b", "c", "d"), diagrams.c1f1),
}  # fmt: skip
"""By the paper's labels, in its order. (Fig. fvol, a sketch of how a volume is cut, has nothing to compute.)"""


def names(wanted: str) -> list[str]:
    """Figures by one's name, or ``all``.

    Raises:
        InputError: the paper has none of that name.
    """
    if wanted != "all" and wanted not in CATALOGUE:
        raise InputError("figure", f"the paper has no {wanted!r}", f"give all, or one of {', '.join(CATALOGUE)}")
    return list(CATALOGUE) if wanted == "all" else [wanted]


def listing() -> pd.DataFrame:
    """``figure, title, panels, printed_numbers, not_computed``, a row each."""
    counts = printed_values()["figure"].value_counts()
    rows = [(name, e.title, " ".join(e.panels), int(counts.get(name, 0)), e.missing) for name, e in CATALOGUE.items()]
    return pd.DataFrame(rows, columns=["figure", "title", "panels", "printed_numbers", "not_computed"])
