"""A command whose errors name its options as they are typed: ``--max-points``, not ``max_points``."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import click

from pearlbvp.errors import InputError
from pearlbvp.units import RADII, Units

ALSO = {"length": ("--periods", "--period", "--lengths"), "v": ("--volume",)}
"""Options that hold what the package calls otherwise, where a command has none of its name."""


class Command(click.Command):
    """A command of the package: what its studies say of an argument is said of the option that it came from."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run it.

        Raises:
            InputError: as the command does, in the words of the command line.
        """
        try:
            return super().invoke(ctx)
        except InputError as error:
            raise InputError(as_typed(_units(ctx).said(error.args[0]), self.params)) from None


def as_typed(message: str, params: Sequence[click.Parameter]) -> str:
    """A message with the names of arguments as options: the first word before a colon, and elsewhere names with a ``_``.

    Args:
        message: ``name: what; remedy``.
        params: of the command.
    """
    options = {param.name: param.opts[0] for param in params if isinstance(param, click.Option) and param.name}
    options |= {typed.lstrip("-"): typed for typed in options.values()}

    def typed(name: str) -> str:
        if name in options:
            return options[name]
        return next((option for option in ALSO.get(name, ()) if option in options.values()), name)

    subject, colon, rest = message.partition(":")
    if colon:
        message = re.sub(r"^\w+", lambda word: typed(word[0]), subject) + colon + rest
    return re.sub(r"(?<![\w-])[a-z]+_[a-z_]+\b", lambda word: options.get(word[0], word[0]), message)


def of_this_command(message: str) -> str:
    """The same, of the command that runs, in its user's unit."""
    context = click.get_current_context()
    return as_typed(_units(context).said(message), context.command.params)


def _units(context: click.Context) -> Units:
    """The unit of a command's numbers: by ``--radius`` where it has that."""
    units: Units = context.params.get("units", RADII)
    return units
