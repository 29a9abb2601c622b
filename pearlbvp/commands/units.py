"""The units that a command is in: by its options, or by those of the saved file that it goes on from."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from pearlbvp.commands.arguments import Quantity, Until, Written
from pearlbvp.errors import InputError
from pearlbvp.quantities import has_unit
from pearlbvp.units import RADII, Units

OPTIONS = ("radius", "kappa", "temperature", "convention")
"""Parameters that say in which units a command is."""

FILES = {"file": "FILE", "files": "FILE", "source": "--from", "resume": "--resume"}
"""Parameters that are saved branches or flows, and how they are typed."""


def enter_units(context: click.Context) -> None:
    """Put a command's ``units`` in the place of the options that make them, and its arguments with units into those.

    Raises:
        InputError: an argument that cannot be used.
    """
    params = context.params
    if "radius" not in params:
        return
    given = {name: params.pop(name) for name in OPTIONS if name in params}
    if context.get_parameter_source("convention") == click.core.ParameterSource.DEFAULT:
        given["convention"] = None
    units = params["units"] = _units(
        {name: text for name, text in given.items() if text is not None},
        _saved(params, any_of=given["radius"] is not None),
    )
    for param in context.command.params:
        name, kind = str(param.name), param.type
        value = params.get(name)
        if isinstance(kind, Quantity) and (isinstance(value, Written) or (isinstance(kind, Until) and value)):
            params[name] = kind.in_units(value, units, param)


def _units(given: dict[str, str], saved: Units) -> Units:
    """Units by the options that are given, and by those of the saved file where they are not."""
    if not given.keys() & {"radius", "kappa"} and not saved.given:
        for name in given:
            raise InputError(f"--{name}", "it says what kappa is, and there is none", "give --radius and --kappa, too")
        return RADII
    if not given:
        return saved
    merged = {**saved.texts(), **given} if has_unit(given.get("radius", "1nm")) else given
    return Units.of(**{"radius": "1"} | merged)


def _saved(params: dict[str, Any], any_of: bool) -> Units:
    """Units of the files that a command goes on from, which must agree or ``any_of`` them will do; radii where they have none.

    Raises:
        InputError: they are of different ones.
    """
    found = RADII
    for name, typed in FILES.items():
        value = params.get(name)
        paths: Sequence[Path] = () if not value else value if isinstance(value, tuple) else (value,)
        for path in paths:
            own = Units.of_file(path, typed)
            if own.given and found.given and own != found and not any_of:
                raise InputError(typed, f"{path} is saved in other units than the one before", "give --radius for all")
            found = own if own.given else found
    return found
