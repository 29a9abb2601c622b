"""Public names of a package, each imported from the room in which it lives when it is first asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def offered(
    package: str, homes: Mapping[str, str], *others: str
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """``__getattr__`` and ``__dir__`` of a package.

    Args:
        package: its name.
        homes: public names, and where in the package each lives: ``room:name``, or ``room:`` for a room itself.
        others: public names that are there from the beginning.
    """

    def get(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}; see dir({package})")
        room, _, found = homes[name].partition(":")
        module = import_module(f"{package}.{room}")
        return getattr(module, found) if found else module

    return get, lambda: sorted([*homes, *others])
