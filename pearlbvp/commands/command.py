"""A command whose errors name its options as they are typed: ``--max-points``, not ``max_points``."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import Any

import click

from pearlbvp.commands.units import enter_units
from pearlbvp.errors import InputError
from pearlbvp.units import RADII, Units

ALSO = {
    "length": ("--periods", "--period", "--lengths"), "v": ("--volume",), "kind": ("KIND:K",), "number": ("KIND:K",),
    "vary": ("NAME",),
}  # fmt: skip
"""Options that hold what the package calls otherwise, where a command has none of its name."""


class Option(click.Option):
    """An option that says what it needs and excludes where it is declared, by the names of parameters.

    Attributes:
        needs: it says nothing without one of these.
        excludes: it does not go with any of these.
    """

    def __init__(self, *args: Any, needs: Sequence[str] = (), excludes: Sequence[str] = (), **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.needs, self.excludes = tuple(needs), tuple(excludes)


def options_given(context: click.Context) -> set[str]:
    """Names of the parameters that stand on the command line."""
    source = click.core.ParameterSource.COMMANDLINE
    return {name for name, value in context.params.items()
            if context.get_parameter_source(name) == source and value not in ((), None)}  # fmt: skip


def _word(argument: click.Argument) -> str:
    """An argument as the help writes it, without what says that it may repeat."""
    return (argument.metavar or str(argument.name).upper()).strip("[]. ")


def check_options(context: click.Context) -> None:
    """Refuse options that do not go with each other, or say nothing.

    Raises:
        InputError: the option, and what it needs or excludes.
    """
    on_line = options_given(context)
    typed = {str(param.name): _word(param) if isinstance(param, click.Argument) else param.opts[0]
             for param in context.command.params}  # fmt: skip
    for param in context.command.params:
        if not isinstance(param, Option) or param.name not in on_line:
            continue
        other = next((name for name in param.excludes if name in on_line), None)
        if other is not None:
            raise InputError(param.opts[0], f"it does not go with {typed[other]}", "leave one of the two out")
        if param.needs and not on_line & set(param.needs):
            words = " or ".join(typed[name] for name in param.needs if name in typed)
            raise InputError(param.opts[0], f"it goes with {words}", "give that too, or leave it out")


class Command(click.Command):
    """A command of the package: what its studies say of an argument is said of the option that it came from."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the line, of which click would take the last of several values without a word.

        Raises:
            InputError: an option of one value is there twice.
        """
        _, _, order = self.make_parser(ctx).parse_args(args=list(args))
        for param in order:
            if isinstance(param, click.Option) and not (param.multiple or param.is_flag) and order.count(param) > 1:
                raise InputError(param.opts[0], "it is given twice", "give it once")
        return super().parse_args(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        """Run it.

        Raises:
            InputError: as the command does, in the words of the command line.
        """
        try:
            check_options(ctx)
            enter_units(ctx)
            with style_of(ctx):
                return super().invoke(ctx)
        except InputError as error:
            raise of_this_command(error) from None


def style_of(context: click.Context) -> AbstractContextManager[None]:
    """Draw by a command's ``--style``, which is no argument of its function, and is read before anything is computed.

    Raises:
        InputError: it cannot be used.
    """
    style = context.params.pop("style", None)
    if style is None:
        return nullcontext()
    from pearlbvp.figures.style import styled

    return styled(style)


def option_of(argument: str, params: Sequence[click.Parameter]) -> str:
    """The option or word of a command that an argument of Python comes from, if any; its name is the argument's first word."""
    words = {str(param.name): _word(param) for param in params if isinstance(param, click.Argument)}
    options = words | _options(params)

    def typed(name: str) -> str:
        if name in options:
            return options[name]
        return next((option for option in ALSO.get(name, ()) if option in options.values()), name)

    return re.sub(r"^\w+", lambda word: typed(word[0]), argument)


def as_typed(message: str, params: Sequence[click.Parameter]) -> str:
    """Words with the names of arguments as options.

    They are names with a ``_``, those that are to be given (``give radius=2``) and those in brackets (``(keep=v)``,
    ``(nodes)``).

    Args:
        message: of what is wrong, or what to do.
        params: of the command.
    """
    options = _options(params)
    message = re.sub(r"(?<![\w-])[a-z]+_[a-z_]+\b", lambda word: options.get(word[0], word[0]), message)
    given = r"(?:(?<=\()|(?<=give ))([a-z]+)(=|(?=\)))"
    return re.sub(given, lambda word: options[word[1]] + " " * len(word[2]) if word[1] in options else word[0], message)


def _options(params: Sequence[click.Parameter]) -> dict[str, str]:
    """Options by their arguments' names in Python, and by their own."""
    options = {param.name: param.opts[0] for param in params if isinstance(param, click.Option) and param.name}
    return options | {typed.lstrip("-"): typed for typed in options.values()}


def words_of_this_command(message: str) -> str:
    """A message in the words of the command that runs, and its user's unit."""
    context = click.get_current_context()
    return as_typed(_units(context).said(message), context.command.params)


def of_this_command(error: InputError) -> InputError:
    """What is wrong with an argument, of the option that it came from, in the words of the command that runs."""
    named = error.named(option_of(error.argument, click.get_current_context().command.params))
    return named.worded(words_of_this_command)


def _units(context: click.Context) -> Units:
    """The unit of a command's numbers: by ``--radius`` where it has that."""
    units: Units = context.params.get("units", RADII)
    return units
