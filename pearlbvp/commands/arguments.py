"""Types of the command line's arguments: each parses a text, or says in one line what is wrong with it."""

from __future__ import annotations

import os
import re
from abc import ABC, abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from pearlbvp.dimensions import QUANTITIES
from pearlbvp.errors import InputError
from pearlbvp.quantities import has_unit
from pearlbvp.units import Sentence, Units


class Written(str):
    """An argument that has a unit: it is read when the units of the command are known (``in_units``)."""


class Quantity(click.ParamType, ABC):  # type: ignore[type-arg]
    """What may have a unit."""

    @abstractmethod
    def in_units(self, value: Any, units: Units, param: click.Parameter) -> Any:
        """What was written, in the user's unit."""


class Numbers(Quantity):
    """A list of numbers: ``15,30,45`` or ``start:stop:step``, of a quantity that may have a unit, or of none."""

    name = "numbers"

    def __init__(self, quantity: str = "") -> None:
        self.quantity = quantity

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> list[float] | Written:
        """Parse the text; a range contains both its ends."""
        from pearlbvp.numbers import parse_numbers

        if self.quantity and isinstance(value, str) and any(has_unit(word) for word in re.split("[,:]", value)):
            return Written(value)
        return value if isinstance(value, list) else parse_numbers(_option(param), value)

    def in_units(self, text: Written, units: Units, param: click.Parameter) -> list[float] | Written:
        """The numbers in the user's unit; times, which depend on the law of a flow, are left to that."""
        return text if QUANTITIES[self.quantity].time else self.read(text, units, _option(param))

    def read(self, text: Written, units: Units, option: str) -> list[float]:
        """The numbers in the user's unit."""
        from pearlbvp.numbers import parse_numbers

        def number(found: re.Match[str]) -> str:
            return repr(units.number(self.quantity, found[0], option)) if has_unit(found[0]) else found[0]

        return parse_numbers(option, re.sub("[^,:]+", number, text))


class Number(Quantity):
    """One finite number, of a quantity that may have a unit, or of none."""

    name = "number"

    def __init__(self, quantity: str = "") -> None:
        self.quantity = quantity

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float | Written:
        """Parse the text."""
        from pearlbvp.helfrich import finite

        if self.quantity and isinstance(value, str) and has_unit(value):
            return Written(value)
        return finite(_option(param), value)

    def in_units(self, text: Written, units: Units, param: click.Parameter) -> float | Written:
        """The number in the user's unit; a time, which depends on the law of a flow, is left to that."""
        return text if QUANTITIES[self.quantity].time else units.number(self.quantity, text, _option(param))


class File(click.ParamType):  # type: ignore[type-arg]
    """A file's name, which a Path would take from ``name/`` as well."""

    name = "file"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """Take the text; whether there is such a file is seen where it is used."""
        if isinstance(value, str) and value.endswith(tuple(filter(None, (os.sep, os.altsep)))):
            named = param.metavar.partition(".")[0] if isinstance(param, click.Argument) and param.metavar else None
            raise InputError(named or _option(param), f"{value} is a folder's name", "give a file's name")
        return Path(value)


def _option(param: click.Parameter | None) -> str:
    return param.opts[0] if param is not None else "argument"


class FamilyName(click.ParamType):  # type: ignore[type-arg]
    """The name of a family of shapes, of the package or added to it."""

    name = "family"

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        """The package's own, for the help."""
        return "[pearl|ring|coil|buckle]"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Look it up."""
        from pearlbvp.studies.families import names

        if value not in names():
            raise InputError("FAMILY", f"{value!r} is none", f"choose one of {', '.join(names())}")
        return str(value)


class Nodes(click.ParamType):  # type: ignore[type-arg]
    """Vertices of a mesh: a whole number."""

    name = "nodes"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """Parse the text."""
        try:
            return int(value)
        except ValueError:
            from pearlbvp.mesh.families import MOST_NODES

            raise InputError(
                "--nodes", f"{value!r} is not a number of vertices", f"give a whole one up to {MOST_NODES}"
            ) from None


def check_meshable(length: float) -> None:
    """Refuse a tube of which no number of nodes makes good triangles.

    Raises:
        InputError: it is too long.
    """
    from pearlbvp.mesh.families import MOST_NODES, fewest

    if (needed := fewest(length)) > MOST_NODES:
        text = f"{{L:g}} {{L_unit}} are too long for a mesh: it would need {needed} nodes, of which {MOST_NODES} fit in memory"
        raise InputError("--length", Sentence(text, L=length), "give a shorter tube")


class Until(Quantity):
    """``NAME=VALUE``, or a special point: ``bp``, ``bp:2``, ``fold:v``, ``fold:v:2``, ``cmc``."""

    name = "name=value|kind[:k]"

    def in_units(self, several: Sequence[tuple[str, float | Written]], units: Units, param: click.Parameter) -> Any:
        """The same with values in the user's unit."""
        option = _option(param)
        named = [(units.plain(option, name), value) for name, value in several]
        return tuple((name, units.number(name, value, option)) for name, value in named)

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, float | Written]:
        """Split and parse the text: column and value, or kind and number, 1 where none is given."""
        from pearlbvp.helfrich import finite
        from pearlbvp.numbers import as_whole

        name, equals, number = str(value).partition("=")
        if equals:
            return name.strip(), Written(number) if has_unit(number) else finite("--until", number)  # type: ignore[arg-type]
        kind, _, last = name.strip().rpartition(":")
        which = as_whole(last)
        kind, count = (name.strip(), 1) if which is None or not kind else (kind, which)
        if kind.partition(":")[0] not in ("bp", "cmc", "fold"):
            raise InputError(
                "--until", f"{value!r} must be NAME=VALUE, like v=1.1, or a special point, like bp, bp:2, fold:v or cmc"
            )
        return kind, count


def wanted_places(until: Sequence[tuple[str, float]], units: Units) -> dict[str, float]:
    """What several ``Until`` ask for, in radii: columns and values, kinds of special points and numbers.

    Raises:
        InputError: one is given twice.
    """
    names = [name for name, _ in until]
    for name in names:
        if names.count(name) > 1:
            raise InputError("--until", f"{name} is given twice", "give it once")
    return {name: units.named_from_user(name, value) for name, value in until}


class SpecialKind(click.ParamType):  # type: ignore[type-arg]
    """``KIND:K``: the K-th special point of a kind."""

    name = "kind:k"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[str, int]:
        """Split and parse the text."""
        from pearlbvp.numbers import as_whole

        kind, _, last = str(value).rpartition(":")
        number = as_whole(last)
        if not (kind == "bp" or kind.startswith("fold:")) or number is None:
            raise InputError("KIND:K", f"{value!r} must be bp:K or fold:NAME:K, like fold:v:1")
        return kind, number


class ModeNumbers(click.ParamType):  # type: ignore[type-arg]
    """``m,n``: waves along and around the tube."""

    name = "m,n"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, int]:
        """Split and parse the text."""
        from pearlbvp.numbers import as_whole

        m, n = (as_whole(part) for part in str(value).partition(",")[::2])
        if m is None or n is None:
            raise InputError("--mode", f"{value!r} must be two whole numbers m,n, like 1,0")
        return m, n
