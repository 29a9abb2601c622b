"""The one exception for a user's mistake, so that it is never confused with a defect of ours."""

from __future__ import annotations


class InputError(ValueError):
    """An argument that cannot be used. The message is one line: ``argument: what; remedy``."""

    @property
    def argument(self) -> str:
        """The argument that the message names."""
        return str(self.args[0]).partition(":")[0]

    def named(self, argument: str) -> InputError:
        """The same of an argument that its user knows by another name."""
        return InputError(self.args[0].replace(f"{self.argument}:", f"{argument}:", 1))


class SpectrumError(ArithmeticError):
    """The growth rates of a solution cannot be computed, or not well enough; the message says why and what to do."""


def interrupted(error: BaseException | None) -> bool:
    """Whether an error comes from an interruption by the user: compiled code turns that into others, one upon another."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None
