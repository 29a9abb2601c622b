"""The one exception for a user's mistake, so that it is never confused with a defect of ours."""

from __future__ import annotations

from collections.abc import Callable
from types import TracebackType


class InputError(ValueError):
    """An argument that cannot be used, said in one line: ``argument: what; remedy``.

    Attributes:
        argument: its name, as who gave it knows it.
        what: what is wrong with it.
        remedy: what to do; empty where ``what`` says it by what is wanted.

    Examples:
        >>> print(InputError("volume", "-1 is not positive", "give one like 1.1"))
        volume: -1 is not positive; give one like 1.1
    """

    def __init__(self, argument: str, what: str, remedy: str = "") -> None:
        super().__init__(argument, what, remedy)
        self.argument, self.what, self.remedy = argument, what, remedy

    def __str__(self) -> str:
        return f"{self.argument}: " + self.why  # a sum, which leaves a sentence its numbers

    @property
    def why(self) -> str:
        """What is wrong, and the remedy."""
        return self.what + "; " + self.remedy if self.remedy else self.what

    def named(self, argument: str) -> InputError:
        """The same of an argument that its user knows by another name."""
        return InputError(argument, self.what, self.remedy)

    def worded(self, words: Callable[[str], str]) -> InputError:
        """The same in other words, as in another unit of length."""
        return InputError(self.argument, words(self.what), words(self.remedy))


class SpectrumError(ArithmeticError):
    """The growth rates of a solution cannot be computed, or not well enough; the message says why and what to do."""


class Interruption:
    """``with`` it: an interruption by the user ends what is in it, and it is ``happened``; other errors go on.

    Examples:
        >>> stopped = Interruption()
        >>> with stopped:
        ...     raise KeyboardInterrupt
        >>> stopped.happened
        True
    """

    happened = False

    def __enter__(self) -> Interruption:
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: TracebackType | None) -> bool:
        caught = isinstance(error, KeyboardInterrupt | SystemError) and interrupted(error)
        self.happened |= caught
        return caught


def interrupted(error: BaseException | None) -> bool:
    """Whether an error comes from an interruption by the user: compiled code turns that into others, one upon another."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None
