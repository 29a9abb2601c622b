"""The one exception for a user's mistake, so that it is never confused with a defect of ours."""


class InputError(ValueError):
    """An argument that cannot be used. The message is one line that names the argument and the remedy."""
