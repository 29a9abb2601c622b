"""Put other people's numbers beside a table."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
import pandas as pd

from pearlbvp.errors import InputError
from pearlbvp.tables import name_of, read_table
from pearlbvp.units import RADII, Units

KEYS = ("c0", "period", "L")
"""Columns that tell which row of a table of localized pearls is which."""

SAME = 1e-6
"""Relative difference at which two numbers are one: tables differ in their digits."""


def read_reference(
    path: str | os.PathLike[str],
    columns: Sequence[str] | None = None,
    optional: Sequence[str] = (),
    units: Units = RADII,
) -> pd.DataFrame:
    """A CSV file with a header, all of numbers; lines that begin with ``#`` are comments.

    Columns whose names have units, ``L[nm]``, are converted to those of the user; others are in them.

    Args:
        path: of the file.
        columns: those that are wanted; others are not looked at, and may be of words.
        optional: those that are taken, too, where they are there.
        units: of the user. Without ``columns`` those of ``KEYS`` are converted, others keep their units in their names.

    Raises:
        InputError: it cannot be read, a line is not of as many numbers as the header has names, or a column is missing, or has
            no number where one is needed; a unit is of another dimension, or there is none to convert it to.
    """
    read = read_table("compare", path, columns, optional=optional if columns else KEYS)
    table = pd.DataFrame(
        {name: units.from_heading("compare", name, read.headings[name], np.array(read[name])) for name in read}
    )
    for name in columns or [key for key in KEYS if key in table]:
        if table[name].isna().any():
            raise InputError(
                "compare", f"{path} has an empty entry in column {name}", "give a number there, or leave out its row"
            )
    return table


def beside(table: pd.DataFrame, reference: pd.DataFrame) -> pd.DataFrame:
    """Append the columns of ``reference`` to the rows of ``table`` that are of the same tube: ``c0``, ``period`` and ``L``.

    Raises:
        InputError: the reference lacks one of these or has none besides, or one that the table has; no row agrees, or two do.
    """
    missing = [name for name in KEYS if name not in reference.columns]
    added = [name for name in reference.columns if name not in KEYS]
    if missing or not added:
        lacks = f"lacks {', '.join(missing)}" if missing else "has none besides"
        raise InputError(
            "compare",
            f"the file needs columns to match, {', '.join(KEYS)}, and others to put beside them",
            f"it {lacks}",
        )
    taken = [name_of(name) for name in added if name_of(name) in table.columns]
    if taken:
        raise InputError(
            "compare", f"the file's column {taken[0]} is in the table already", f"rename it, to {taken[0]}_other say"
        )
    pairs = [(table[name].to_numpy(float)[:, None], reference[name].to_numpy(float)) for name in KEYS]
    match = np.all([np.isclose(*pair, rtol=SAME, atol=1e-9) for pair in pairs], axis=0)
    if not match.any():
        raise InputError(
            "compare", f"no row of the file agrees with the table in {', '.join(KEYS)}", "give one of this tube"
        )
    if (match.sum(axis=1) > 1).any():
        raise InputError("compare", f"two rows of the file are of the same {', '.join(KEYS)}", "leave one out")
    result = table.copy()
    for name in added:
        values = reference[name].to_numpy()
        result[name] = [values[row.argmax()] if row.any() else float("nan") for row in match]
    return result
