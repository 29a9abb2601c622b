"""Files of tables: CSV, Parquet or JSON by the ending, each with what made it and what its columns mean.

CSV has them beside it, where "CSV on the Web" looks for them (W3C, Model for Tabular Data and Metadata on the Web, 2015,
§5.3): programs that read tables read on, and those that know of it find units and meaning. Parquet keeps them as the table's
``attrs``, JSON as a "Table Schema" that ``pandas.read_json(orient="table")`` reads.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pearlbvp._version import __version__
from pearlbvp.columns import meaning
from pearlbvp.errors import InputError
from pearlbvp.tables import name_of
from pearlbvp.units import HEADER, UNITS, headed

if TYPE_CHECKING:
    import pandas as pd

METADATA = "-metadata.json"
"""What is added to a CSV file's name."""

DIGITS = 12
"""Of numbers in text."""


def write_table(option: str, path: Path, table: pd.DataFrame) -> None:
    """Write a table, beside its name and renamed; ``option`` is what an error names.

    Raises:
        InputError: it cannot be written, or what Parquet needs is not installed.
    """
    from pearlbvp.files import write_whole

    about = described(table)
    written = headed(table)
    written.attrs = {str(key): value for key, value in about.items()}
    write = WRITERS.get(path.suffix.lower(), _csv)
    try:
        write_whole(option, path, lambda beside: write(beside, written))
    except ImportError:
        raise InputError(option, "Parquet needs pyarrow", "install pearlbvp[parquet], or write .csv") from None
    if write is _csv and path.is_file():
        metadata = json.dumps(_on_the_web(path.name, about), indent=1, ensure_ascii=False) + "\n"
        write_whole(option, path.with_name(path.name + METADATA), lambda beside: beside.write_text(metadata, "utf-8"))


def described(table: pd.DataFrame) -> dict[str, Any]:
    """What made a table, and of each column, by its name in the file, its unit and meaning."""
    context = click.get_current_context(silent=True)
    command = None if context is None else context.find_root().obj
    header, units = (table.attrs.get(kept, {}) for kept in (HEADER, UNITS))
    columns = {}
    for name in map(str, table):
        heading = header.get(name, name)
        unit = units.get(name) or ("" if name_of(heading) == heading else heading.partition("[")[2][:-1])
        columns[heading] = {key: text for key, text in (("unit", unit), ("meaning", meaning(heading))) if text}
    return {"program": f"pearlbvp {__version__}", "command": command, "units": UNNAMED, "columns": columns}


UNNAMED = (
    "R: radius of the straight tube; U: the unit of length in which --radius is given; 2kappa: twice the bending rigidity of "
    "kappa/2 (2H - C0)^2; T: time of the flow or of the fluids; 1: a plain number"
)
"""What the units are that have no name."""


def _csv(path: Path, table: pd.DataFrame) -> None:
    table.to_csv(path, index=False, float_format=f"%.{DIGITS}g")


def _json(path: Path, table: pd.DataFrame) -> None:
    """A Table Schema and its rows; a number that is not defined is null."""
    from pandas.io.json import build_table_schema

    about = dict(table.attrs)
    known = about.pop("columns")
    schema: dict[str, Any] = build_table_schema(table, index=False)
    schema["fields"] = [field | known[field["name"]] for field in schema["fields"]]
    rows = [{name: _plain(value) for name, value in row.items()} for row in table.to_dict("records")]
    path.write_text(json.dumps(about | {"schema": schema, "data": rows}, ensure_ascii=False) + "\n", "utf-8")


def _plain(value: Any) -> Any:
    """A number or a text as JSON has it."""
    value = value.item() if hasattr(value, "item") else value
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None
    return value if value is None or isinstance(value, (bool, int)) else str(value)


WRITERS: Mapping[str, Callable[[Path, pd.DataFrame], None]] = {
    ".parquet": lambda path, table: table.to_parquet(path, index=False), ".json": _json
}  # fmt: skip
"""By the ending; all others are CSV."""


def _on_the_web(name: str, about: Mapping[str, Any]) -> dict[str, Any]:
    """The metadata of a CSV file; units and what made it are terms of schema.org and Dublin Core."""
    terms = {"unit": "schema:unitText", "meaning": "dc:description"}
    columns = [
        {"titles": heading} | {terms[key]: text for key, text in known.items()}
        for heading, known in about["columns"].items()
    ]
    return {
        "@context": "http://www.w3.org/ns/csvw",
        "url": name,
        "dc:creator": about["program"],
        "dc:source": about["command"],
        "dc:description": about["units"],
        "tableSchema": {"columns": columns},
    }
