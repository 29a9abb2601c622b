"""Put other people's numbers beside a table."""

from __future__ import annotations

import os

import numpy as np
import pandas as pd

from pearlbvp.errors import InputError


def beside(table: pd.DataFrame, path: str | os.PathLike[str]) -> pd.DataFrame:
    """Append the columns of a CSV file to the rows of ``table`` that agree with it in all columns they share.

    Args:
        table: the computed table.
        path: a CSV file whose shared columns are numbers; lines that begin with ``#`` are comments.

    Raises:
        InputError: the file cannot be read, or shares no column with the table, or has none besides.
    """
    try:
        reference = pd.read_csv(path, comment="#")
    except (OSError, ValueError) as error:
        raise InputError(f"compare: {path} cannot be read as CSV ({str(error).splitlines()[0]})") from None
    keys = [name for name in reference.columns if name in table.columns]
    added = [name for name in reference.columns if name not in table.columns]
    if not keys or not added:
        raise InputError(f"compare: {path} needs columns to match ({', '.join(table.columns[:3])}) and others to add")
    if not all(pd.api.types.is_numeric_dtype(reference[name]) for name in keys):
        raise InputError(f"compare: in {path} the columns {', '.join(keys)} must be numbers")
    match = np.all([np.isclose(np.subtract.outer(table[name].to_numpy(float), reference[name].to_numpy(float)), 0,
                               atol=1e-9) for name in keys], axis=0)  # fmt: skip
    result = table.copy()
    for name in added:
        result[name] = [reference[name].iloc[row.argmax()] if row.any() else None for row in match]
    return result
