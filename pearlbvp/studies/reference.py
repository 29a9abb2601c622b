"""Put other people's numbers beside a table."""

from __future__ import annotations

import csv
import os
from collections.abc import Sequence

import numpy as np
import pandas as pd

from pearlbvp.errors import InputError


def read_reference(
    path: str | os.PathLike[str], columns: Sequence[str] | None = None, optional: Sequence[str] = ()
) -> pd.DataFrame:
    """A CSV file with a header, all of numbers; lines that begin with ``#`` are comments.

    Args:
        path: of the file.
        columns: those that are wanted; others are not looked at, and may be of words.
        optional: those that are taken, too, where they are there.

    Raises:
        InputError: it cannot be read, a line is not of as many numbers as the header has names, or a column is missing.
    """
    try:
        with open(path, newline="", encoding="utf-8") as file:
            lines = [line for line in csv.reader(file) if line and not line[0].startswith("#")]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(f"compare: {path} cannot be read as CSV ({reason}); give a table with a header") from None
    if len(lines) < 2:
        raise InputError(f"compare: {path} holds no table; it needs a header and at least one row")
    header, *rows = lines
    for row in rows:
        if len(row) != len(header):
            raise InputError(f"compare: {path} has {len(header)} columns but a row of {len(row)}: {','.join(row)}")
    missing = [name for name in columns or () if name not in header]
    if missing:
        raise InputError(f"compare: {path} has no column {', '.join(missing)}; its columns are {', '.join(header)}")
    chosen = [(i, name) for i, name in enumerate(header) if columns is None or name in (*columns, *optional)]
    return pd.DataFrame({name: [_number(path, row[i]) for row in rows] for i, name in chosen})


def _number(path: str | os.PathLike[str], text: str) -> float:
    try:
        return float(text) if text.strip() else float("nan")
    except ValueError:
        raise InputError(f"compare: {path} holds {text!r}, which is no number; leave such columns out") from None


def beside(table: pd.DataFrame, reference: pd.DataFrame) -> pd.DataFrame:
    """Append the columns of ``reference`` to the rows of ``table`` that agree with it in all columns they share.

    Raises:
        InputError: they share no column, the reference has none besides, or no row agrees, or two do.
    """
    keys = [name for name in reference.columns if name in table.columns]
    added = [name for name in reference.columns if name not in table.columns]
    if not keys or not added:
        wanted = ", ".join(table.columns[:3])
        raise InputError(f"compare: the file needs columns to match ({wanted}) and others to put beside them")
    differences = [np.subtract.outer(table[name].to_numpy(float), reference[name].to_numpy(float)) for name in keys]
    match = np.all([np.isclose(difference, 0, atol=1e-9) for difference in differences], axis=0)
    if not match.any():
        raise InputError(f"compare: no row of the file agrees with the table in {', '.join(keys)}")
    if (match.sum(axis=1) > 1).any():
        raise InputError(f"compare: two rows of the file agree with the same row of the table in {', '.join(keys)}")
    result = table.copy()
    for name in added:
        values = reference[name].to_numpy()
        result[name] = [values[row.argmax()] if row.any() else float("nan") for row in match]
    return result
