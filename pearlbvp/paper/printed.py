"""Numbers that the paper prints, beside those that are computed."""

from __future__ import annotations

import math
from importlib import resources
from io import StringIO

import pandas as pd

from pearlbvp.paper.sheet import Values

COLUMNS = ["figure", "label", "quantity", "printed", "computed", "difference", "verdict", "right", "why"]

AGREES, ERRATUM, OTHERWISE = "agrees", "erratum", "otherwise"
"""Verdicts: to the printed digits; not, and the right value is known; not, for the reason that ``why`` gives."""


def printed_values() -> pd.DataFrame:
    """The numbers as they are printed, texts all: ``figure, label, quantity, printed, right, why``."""
    text = resources.files("pearlbvp.paper").joinpath("printed.csv").read_text(encoding="utf-8")
    return pd.read_csv(StringIO(text), dtype=str, comment="#", keep_default_na=False)


def half_digit(number: str) -> float:
    """Half a unit of the last digit of a decimal number: what rounding may have changed.

    Examples:
        >>> half_digit("-0.95")
        0.005
    """
    digits = number.partition(".")[2]
    return 0.5 * 10.0 ** -len(digits)


def agrees(computed: float, number: str) -> bool:
    """Whether a number is a printed one within a unit of its last digit after the point, or rounds to a whole one.

    (A unit, for the paper cuts digits off as well as it rounds.)

    Examples:
        >>> agrees(0.668, "0.66"), agrees(0.671, "0.66"), agrees(0.0, "1")
        (True, False, False)
    """
    allowed = half_digit(number) * (2 if "." in number else 1)
    return abs(computed - float(number)) < allowed * (1 - 1e-9)


def beside_printed(figure: str, values: Values) -> pd.DataFrame:
    """The printed numbers of a figure with the computed ones, their difference and a verdict: ``COLUMNS``."""
    printed = printed_values()
    rows = []
    for _, row in printed[printed["figure"] == figure].iterrows():
        computed = float(values[row["label"], row["quantity"]])
        if agrees(computed, row["printed"]):
            verdict = AGREES
        else:
            verdict = ERRATUM if row["right"] and agrees(computed, row["right"]) else OTHERWISE
        difference = computed - float(row["printed"])
        number = float(row["printed"]), computed, difference, verdict
        right = float(row["right"]) if row["right"] else math.nan
        rows.append((figure, row["label"], row["quantity"], *number, right, row["why"]))
    return pd.DataFrame(rows, columns=COLUMNS)
