"""The one exception for a user's mistake, so that it is never confused with a defect of ours."""


class InputError(ValueError):
    """An argument that cannot be used. The message is one line that names the argument and the remedy."""


class SpectrumError(ArithmeticError):
    """The growth rates of a solution cannot be computed, or not well enough; the message says why and what to do."""


def interrupted(error: BaseException | None) -> bool:
    """Whether an error comes from an interruption by the user: compiled code turns that into others, one upon another."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None
