"""Tables of numbers as other programs write them: CSV of any separator, with a header or none, comments, any line ends."""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches

from pearlbvp.errors import InputError
from pearlbvp.files import MOST_TEXT, read_whole
from pearlbvp.numbers import as_whole

COMMENTS = ("#", "%")

BYTE_ORDER_MARKS = ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"), (b"\xef\xbb\xbf", "utf-8-sig"))

WORKBOOKS = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1")
"""How files of spreadsheet programs begin, those of today and older ones."""


class Table(dict[str, list[float]]):
    """Columns of numbers by their names.

    Attributes:
        headings: the names as they are written, with units: ``L[nm]``.
    """

    def __init__(self, columns: Mapping[str, list[float]], headings: Mapping[str, str]) -> None:
        super().__init__(columns)
        self.headings = headings


def name_of(heading: str) -> str:
    """A column's name without the unit that stands in brackets behind it: ``L`` of ``L[nm]``."""
    return heading.partition("[")[0].strip() if heading.endswith("]") else heading


ALIKE = 0.8
"""Share of letters, by ``difflib``, from which on a name is another's with a mistake in it."""


def refuse_misspelt(name: str, headings: Iterable[str], known: Iterable[str]) -> None:
    """Refuse a heading that is no known name but nearly one: what it holds would be left out without a word.

    Raises:
        InputError: the heading, and the name that was meant.
    """
    names = {each.casefold(): each for each in known}
    for heading in map(str, headings):
        word = name_of(heading).casefold()
        if word not in names and (meant := get_close_matches(word, names, 1, ALIKE)):
            right = names[meant[0]] + heading.removeprefix(name_of(heading))
            raise InputError(name, f"the column {heading} is none that is known", f"rename it to {right}, or remove it")


def read_table(
    name: str,
    path: str | os.PathLike[str],
    columns: Sequence[str] | None = None,
    unnamed: Sequence[str] = (),
    optional: Sequence[str] = (),
) -> Table:
    """Columns of a table in a file.

    The first line that is no comment is the header; the one before it, if that is a comment with the wanted names. Separators
    are commas, semicolons, tabs or spaces; decimal commas are read where the separator is another, or in quotation marks.
    Spaces around names, a byte-order mark, Excel's first line that names the separator, and a unit in brackets behind a name
    are no part of them; capital and small letters are one where no name is the very one. Empty entries are NaN, empty rows are
    none; what is written must be finite.

    Args:
        name: the argument's name, for the message.
        path: of the file.
        columns: those that are wanted; others are not looked at, and may be of words.
        unnamed: names of the columns of a table without any header.
        optional: columns that are taken where they are.

    Raises:
        InputError: it cannot be read, a line is not of as many numbers as the header has names, or a column is missing.
    """
    lines = _text(name, path).splitlines()
    rows, above = _rows(lines)
    if not rows:
        raise InputError(name, f"{path} holds no table", "it needs a header and at least one row")
    header, first = [word.strip().strip("\ufeff") for word in rows[0]], 2
    if all(_is_number(word) for word in header):
        named = columns and set(columns) <= set(map(name_of, above)) and len(above) == len(header)
        header = above if named else list(unnamed)
        first = 1
        if len(header) != len(rows[0]):
            wanted = ", ".join(columns or unnamed)
            remedy = f"write one: {wanted}" if wanted else "write one"
            raise InputError(name, f"{path} has no line with the names of its columns", remedy)
    rows = rows[first - 1 :]
    if not rows:
        raise InputError(name, f"{path} holds no table", "it needs a header and at least one row")
    for row in rows:
        if len(row) != len(header):
            decimal = len(row) > len(header) and all(as_whole(word) is not None for word in row)
            raise InputError(
                name,
                f"{path} has {len(header)} columns but a row of {len(row)}: {','.join(row)[:80]}",
                "write decimal points where commas are no separators" if decimal else "complete it",
            )
    written, header = header, _as_wanted(name, path, header, [*(columns or ()), *optional])
    chosen = list(header) if columns is None else list(columns)
    chosen += [column for column in optional if column in header and column not in chosen]
    refuse_misspelt(name, [word for word in header if word not in chosen], optional)
    missing = [column for column in chosen if column not in header]
    if missing:
        raise InputError(
            name, f"{path} has no column {', '.join(missing)}", f"its columns are {', '.join(written)[:200]}"
        )
    twice = [column for column in chosen if header.count(column) > 1]
    if twice:
        raise InputError(name, f"{path} has two columns {twice[0]!r}", "rename one of them")
    places = [(header.index(column), column) for column in chosen]
    return Table(
        {column: [_number(name, path, row[i], column, k) for k, row in enumerate(rows, first)] for i, column in places},
        {column: written[i] for i, column in places},
    )


def _as_wanted(name: str, path: str | os.PathLike[str], header: list[str], wanted: Sequence[str]) -> list[str]:
    """The header with the names that are wanted as they are wanted: ``X`` and ``x[nm]`` are ``x`` where there is no ``x``.

    Raises:
        InputError: two columns could be one that is wanted.
    """
    found = list(header)
    for column in wanted:
        places = [i for i, own in enumerate(header) if name_of(own).casefold() == column.casefold()]
        if column in header or not places:
            continue
        if len(places) > 1:
            both = " and ".join(repr(header[i]) for i in places[:2])
            raise InputError(
                name, f"{path} has the columns {both}, either of which may be {column}", "rename one of them"
            )
        found[places[0]] = column
    return found


def _text(name: str, path: str | os.PathLike[str]) -> str:
    content = read_whole(name, path, MOST_TEXT)
    if content.startswith(WORKBOOKS):
        raise InputError(name, f"{path} is a workbook of a spreadsheet program, not CSV", "save its table as CSV there")
    encoding = next((found for mark, found in BYTE_ORDER_MARKS if content.startswith(mark)), "utf-8")
    try:
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:  # of names and comments only; numbers are the same
            text = content.decode("latin-1")
    except UnicodeError:
        text = "\0"
    if "\0" in text:
        raise InputError(name, f"{path} cannot be read as CSV (it is no text)", "give a table with a header")
    return text


def _rows(lines: Sequence[str]) -> tuple[list[list[str]], list[str]]:
    """The lines that are no comments, in words, and the words of the comment above the first."""
    kept: list[str] = []
    above = ""
    separator = _separator(lines)
    for i, line in enumerate(lines):
        if line.strip().startswith(COMMENTS):
            above = above if kept else line.strip().lstrip("".join(COMMENTS))
        elif line.strip().strip(separator) and not (i == 0 and _named_separator(line)):
            kept.append(line.partition("#")[0].rstrip())
    if not kept:
        return [], []
    rows = [row for row in _split(kept, separator) if any(word.strip() for word in row)]
    if len(rows) > 1 and all(row[-1] == "" for row in rows):  # a separator at the end of each line
        rows = [row[:-1] for row in rows]
    rows = [[_with_point(word) for word in row] for row in rows]
    return rows, [word.strip() for word in _split([above], separator)[0]]


def _separator(lines: Sequence[str]) -> str:
    """What stands between the words: as the first line says, or as the first one of the table shows."""
    if lines and (named := _named_separator(lines[0])):
        return named
    first = next((line for line in lines if line.strip() and not line.strip().startswith(COMMENTS)), "")
    return next((mark for mark in (";", "\t", ",") if mark in first), " ")


def _named_separator(line: str) -> str:
    """The separator that a first line like ``sep=;`` names, as Excel writes and reads it; else nothing."""
    name, equals, mark = line.strip(" \r\n").partition("=")
    return mark if equals and name.strip().casefold() == "sep" and mark in (";", "\t", ",", " ") else ""


def _split(lines: list[str], separator: str) -> list[list[str]]:
    if separator == " ":
        return [line.split() for line in lines]
    try:
        return [row or [""] for row in csv.reader(lines, delimiter=separator, skipinitialspace=True)]
    except csv.Error:  # a quotation without an end, or a line of more than 100,000 characters
        return [line.split(separator) for line in lines]


def _with_point(word: str) -> str:
    """A number with a decimal comma as Python writes it; other words as they are."""
    changed = word.replace(",", ".", 1)
    return changed if "." not in word and _is_number(changed) else word


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _number(name: str, path: str | os.PathLike[str], word: str, column: str, row: int) -> float:
    try:
        number = float(word) if word.strip() else math.nan
    except ValueError:
        raise InputError(
            name,
            f"{path} holds {word[:40]!r}, which is no number, in column {column} of row {row}",
            "leave such columns out",
        ) from None
    if word.strip() and not math.isfinite(number):
        raise InputError(
            name,
            f"{path} holds {word.strip()[:40]!r} in column {column} of row {row}, which is not finite",
            "give a number, or leave it empty",
        )
    return number
