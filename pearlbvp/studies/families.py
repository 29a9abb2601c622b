"""Which families of shapes there are: those of the package, and those that others add.

A family is one object (``membrane.Family``) in one file. Another package adds its own by an entry point of the group
``pearlbvp.families`` that names it, or a script by ``register``.
"""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import entry_points

from pearlbvp.errors import InputError
from pearlbvp.membrane import Family, MembraneProblem

ROOMS = {
    "pearl": "pearlbvp.shapes.pearling",
    "ring": "pearlbvp.shapes.ring",
    "coil": "pearlbvp.tube.onset",
    "buckle": "pearlbvp.tube.onset",
}
"""Where the package's own families are, so that each is imported only by who needs it."""

GROUP = "pearlbvp.families"

_added: dict[str, Family] = {}


def register(family: Family) -> None:
    """Add a family: branches of it, their files and the command line know it from here on.

    Raises:
        InputError: its name is taken.
    """
    if family.name in ROOMS or _added.get(family.name, family) is not family:
        raise InputError("family", f"there is a {family.name!r} already", "give another name")
    _added[family.name] = family


def names() -> list[str]:
    """Names of all families."""
    return [*ROOMS, *_added, *(entry.name for entry in entry_points(group=GROUP) if entry.name not in _added)]


def family(name: str) -> Family:
    """The family of a name.

    Raises:
        InputError: there is none.
    """
    if name not in tuple(names()):
        raise InputError("family", f"{name!r} is none", f"choose one of {', '.join(names())}")
    if name in ROOMS:
        return next(found for found in import_module(ROOMS[name]).FAMILIES if found.name == name)
    if name not in _added:
        for entry in entry_points(group=GROUP):
            if entry.name == name:
                register(entry.load())
    return _added[name]


def problem(stored_as: object) -> type[MembraneProblem] | None:
    """The class of problems that files call so, of any family or on meshes; None where there is none."""
    if stored_as == "mesh":
        from pearlbvp.mesh.problem import MeshProblem

        return MeshProblem
    own = {"pearl": "pearl", "ring": "ring", "tube": "coil"}
    others = [own[stored_as]] if stored_as in own else [name for name in names() if name not in ROOMS]
    return next((found for found in (family(name).problem for name in others) if found.stored_as == stored_as), None)
