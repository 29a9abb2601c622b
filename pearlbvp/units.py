"""Units: the one place that converts quantities into those in which a user reads and writes them.

The package computes with tubes of radius 1 and energies that count in ``2 kappa``. A tube of any radius is similar to one of
those (paper, §1): what is given is converted at the door, and what is written - columns, axes, sentences, surfaces - on its
way out, both by the dimension that a quantity's name has (``dimensions``). By a radius that is a plain number, energies and
the flow's mobility are 1, so that tension, pressure and energy by area are powers of length, and so is time, whose power
depends on the flow. By a radius with a unit, lengths have that unit; with a bending rigidity, energies are physical, too
(``scale``).

The same conversion leads from the end of a flow, whose area is ``s`` times that of its tube, to the similar shape of a branch:
``Units(s).from_user`` divides its lengths by ``s`` and multiplies its tension by ``s^2`` (``studies.flow_end``).
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, SupportsIndex, TypeVar

from pearlbvp.conversion import SUPERSCRIPTS, Conversion, Value
from pearlbvp.dimensions import AXES, QUANTITIES
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, finite, positive
from pearlbvp.quantities import Dimension, Measured, has_unit, read
from pearlbvp.reservoirs import in_radii
from pearlbvp.scale import CONVENTIONS, Scale

if TYPE_CHECKING:
    import pandas as pd

Parts = tuple[tuple[str, Mapping[str, Any]], ...]
"""Texts, each with the values of its fields."""

Surface = TypeVar("Surface")
"""A triangulated surface: a dataclass with ``vertices`` and ``length``."""

HEADER, UNITS = "header", "units"
"""Where a table keeps its columns' names with units, and their units, until it is written."""


@dataclass(frozen=True)
class Units(Conversion):
    """The unit in which a user measures, by the radius that the straight tube has in it.

    Attributes:
        radius: of the straight tube in the user's unit of length.
        given: whether the user gave it; else the unit is the radius itself.
        law: the flow whose time, velocities and growth rates are measured.
        scale: the unit's name and the rigidity, if the radius has a unit.
        second: the package's unit of time in seconds, if it is known; else times count in that of a flow of mobility 1.

    Raises:
        InputError: the radius is no positive number.
    """

    @classmethod
    def of(
        cls,
        radius: str | float,
        kappa: str | None = None,
        temperature: str | None = None,
        convention: str = "physicists",
    ) -> Units:
        """Units by a tube's radius and rigidity.

        Args:
            radius: of the straight tube: ``"50nm"``, or a number.
            kappa: bending rigidity, ``"20kT"``; without it energies, tensions and pressures count in it.
            temperature: of ``kT``, ``"310K"`` by default.
            convention: ``physicists``: ``kappa/2 (2H - C0)^2``, or ``mem3dg``: ``kappa (H - c0)^2``.

        Raises:
            InputError: one of them cannot be used.

        Examples:
            >>> units = Units.of("50nm", "20kT")
            >>> round(units.to_user("lambda1", 0.75), 5), units.unit("lambda1")  # mN/m, where long pearls appear
            (0.05136, 'mN/m')
        """
        if isinstance(radius, str) and has_unit(radius):
            number, scale = Scale.of(radius, kappa, temperature, convention)
            return cls(number, given=True, scale=scale)
        if kappa is not None:
            raise InputError("kappa", "it needs the radius with its unit", "give radius=50nm or the like, too")
        return cls(positive("radius", radius), given=True)  # type: ignore[arg-type]

    @classmethod
    def of_file(cls, path: str | os.PathLike[str], name: str = "path") -> Units:
        """Units that a branch or a flow is saved in; radii where it has none, or where there is no such file.

        Args:
            path: of the file; its reader refuses one that holds no branch or flow.
            name: the argument's name, for the message.

        Raises:
            InputError: the units in it cannot be read.
        """
        from pearlbvp.hdf5 import group_of

        try:
            return cls.from_tree(group_of(name, path, "units"))
        except (ValueError, LookupError, TypeError):
            raise InputError(name, f"the units in {path} cannot be read", "give an intact copy") from None

    def number(self, name: str, text: str | float, argument: str) -> float:
        """A quantity in the user's unit, from a number that is in it or from a text with a unit of its own.

        Args:
            name: of the quantity; one that means nothing stays as it is, for the study to refuse.
            text: ``500`` or ``"500nm"``.
            argument: the argument's name, for the message.

        Raises:
            InputError: it is neither, not finite, of another dimension, or the radius or the rigidity is missing that it needs.
        """
        if not isinstance(text, str) or not has_unit(text):
            return finite(argument, text)  # type: ignore[arg-type]
        if self.scale is None:
            read(argument, text)  # which refuses what is no quantity
            raise InputError(
                argument, f"{text} has a unit, so the radius needs one", "give radius=50nm or the like, too"
            )
        if name not in QUANTITIES:
            return read(argument, text, self.scale.temperature).magnitude
        return self.scale.number(argument, text, self._resolved(QUANTITIES[name]), self.unit(name))

    def from_heading(self, argument: str, name: str, heading: str, values: Value) -> Value:
        """A column in the user's unit, as a table has it that may be in another: ``L[um]``; one without a unit stays.

        Args:
            argument: what the table is, for the message.
            name: of the quantity.
            heading: the column's name in the table. ``C0[1/nm]`` is the spontaneous curvature of ``(2H - C0)^2``,
                ``c0[1/nm]`` that of ``(H - c0)^2``.
            values: its numbers.

        Raises:
            InputError: the unit is of another dimension, or the radius or the rigidity is missing that it needs.
        """
        symbol, bracket, unit = heading.removesuffix("]").partition("[")
        if not bracket or name not in QUANTITIES or not heading.endswith("]"):
            return values
        factor = self.number(name, f"1{unit.removeprefix('1')}", f"{argument}: column {heading}")
        if self.scale is not None and QUANTITIES[name].spontaneous:
            factor *= self.scale.spontaneous / CONVENTIONS["physicists" if symbol.strip() == "C0" else "mem3dg"]
        return values * factor  # type: ignore[operator, return-value]

    def named_from_user(self, name: str, value: Value) -> Value:
        """As ``from_user``, of a name that a user wrote: one that means nothing stays, for the study to refuse."""
        return self.from_user(name, value) if name in QUANTITIES else value

    def plain(self, argument: str, name: str) -> str:
        """The package's name of a quantity that a user wrote as columns have it: the spontaneous curvature may be ``C0``.

        Raises:
            InputError: it is written as the other convention has it, half or twice as large.
        """
        name = name.strip()
        if name not in ("c0", "C0"):
            return name
        if name != self.symbol("c0"):
            own = self.symbol("c0")
            raise InputError(
                argument,
                f"the spontaneous curvature is {own} here, as in the tables, and {name} is twice or half of it",
                f"give {own}=VALUE",
            )
        return "c0"

    def place_from_user(self, text: str) -> str:
        """A point's name given in the user's unit; only that of ``NAME=VALUE`` changes.

        Raises:
            InputError: the value is no number, or the spontaneous curvature's name is that of the other convention.
        """
        name, equals, value = text.partition("=")
        if not equals:
            return text
        name = self.plain("point", name)
        return f"{name}={self.named_from_user(name, self.number(name, value, 'point'))!r}"

    def tube(self, c0: float | str, length: float | str) -> Tube:
        """The tube of radius 1 that a tube is similar to: ``c0 r``, ``L / r`` (paper, §1).

        Raises:
            InputError: an argument that cannot be used.
        """
        curvature, period = self.number("c0", c0, "c0"), positive("length", self.number("length", length, "length"))
        return Tube(self.from_user("c0", curvature), self.from_user("length", period))

    def fix(self, text: str, length: float) -> str:
        """What is held, in pure numbers, from a text in which solute is a concentration, or a modulus an energy.

        Args:
            text: ``"tension,osmotic=300mM"``, ``"ade=60kT"``.
            length: of the whole tube, in radii.

        Raises:
            InputError: a unit of another dimension, or the radius or the rigidity is missing.
        """
        return in_radii(text, self.scale, self.to_user("osmolarity", 1.0), length)

    def radii(self, **quantities: Any) -> dict[str, Any]:
        """Quantities as a tube of radius 1 has them, by their names: what functions take in radii.

        Args:
            quantities: numbers in the user's unit, texts with units of their own, or lists of them.

        Raises:
            InputError: one cannot be used.

        Examples:
            >>> Units.of("50nm", "20kT").radii(L="2um", v=1.1)
            {'L': 40.0, 'v': 1.1}
        """

        def one(name: str, value: str | float) -> float:
            return self.named_from_user(name, self.number(name, value, name))

        return {
            name: [one(name, each) for each in value] if isinstance(value, (list, tuple)) else one(name, value)
            for name, value in quantities.items()
        }

    def table(self, table: pd.DataFrame) -> pd.DataFrame:
        """A table of a tube of radius 1 in the user's unit, as it is written: with the units in the names of its columns."""
        return headed(self.columns(table))

    def columns(self, table: pd.DataFrame, **apart: Dimension) -> pd.DataFrame:
        """A table of a tube of radius 1 in the user's unit; ``headed`` then writes the units into its header.

        Args:
            table: every column of numbers has a name of ``QUANTITIES``; words stay, messages have their numbers converted.
            apart: dimensions that columns have in this table only.
        """
        import pandas as pd

        known = {**QUANTITIES, **apart}
        empty = {str(name) for name in table if table[name].isna().all()}  # of what type they would be is not known
        numbers = [
            name
            for name in map(str, table)
            if name in known or (name not in empty and pd.api.types.is_numeric_dtype(table[name]))
        ]
        moved = [
            name
            for name in numbers
            if name not in empty and (self._power(known[name]) or self._factor(known[name]) != 1)
        ]
        found = table.assign(**{name: self._converted(pd.to_numeric(table[name]), known[name]) for name in moved})
        if "message" in table:
            found["message"] = table["message"].map(self.said)
        found.attrs[UNITS] = {name: self._named(known[name]) for name in numbers}
        if self.scale is not None:
            found.attrs[HEADER] = {name: self._heading(name, known[name]) for name in numbers}
        return found

    def surface(self, surface: Surface) -> Surface:
        """A triangulated surface about a tube of radius 1 in the user's unit."""
        return self._resized(surface, 1)

    def surface_from_user(self, surface: Surface) -> Surface:
        """A triangulated surface in the user's unit about a tube of radius 1."""
        return self._resized(surface, -1)

    def _resized(self, surface: Any, power: int) -> Any:
        vertices, length = (self._scaled(value, power) for value in (surface.vertices, surface.length))
        return replace(surface, vertices=vertices, length=length)

    def text(self, name: str, value: float, form: str = "g") -> str:
        """A quantity of a tube of radius 1 in the user's unit, which is written where it has a name."""
        return format(self.measured(name, value), form)

    def measured(self, name: str, value: float) -> Measured:
        """The same, to be formatted."""
        return self.named(name, self.to_user(name, value))

    def named(self, name: str, value: float) -> Measured:
        """A quantity in the user's unit, to be formatted with its name, if that has one."""
        return Measured(value, self.unit(name) if self.scale else "")

    def tube_text(self, tube: Tube, form: str = "g") -> str:
        """A tube in the user's unit: ``c0 = 0.48, L = 30``."""
        return f"{self.symbol('c0')} = {self.text('c0', tube.c0, form)}, L = {self.text('L', tube.length, form)}"

    def axis_label(self, name: str, words: str | None = None) -> str:
        """What an axis says: the quantity in words, by default those of ``AXES``, and its unit."""
        words = words or AXES[name].replace("curvature c0", f"curvature {self.symbol('c0')}")
        unit = re.sub(r"\^(\d)", lambda power: power[1].translate(SUPERSCRIPTS), self.unit(name)).replace("*", " ")
        return f"{words} ({unit})" if unit else words

    def note(self) -> str:
        """What a picture says of its unit of length, where that is not the radius; else empty."""
        if self.scale is None:
            return f"radius of the straight tube: {self.radius:g} units" if self.given else ""
        kappa = f", bending rigidity: {self.scale.kappa}" if self.scale.kappa else ""
        return f"radius of the straight tube: {self.radius:g} {self.scale.unit}{kappa}"

    def said(self, text: str) -> str:
        """A sentence in the user's unit; one without such numbers stays."""
        return self.told(text.parts) if isinstance(text, Sentence) else text

    def told(self, parts: Parts) -> str:
        """The text of a sentence's parts."""
        return "".join(self._told(words, values) if values else words for words, values in parts)

    def _told(self, words: str, values: Mapping[str, Any]) -> str:
        """One part: numbers have their units' names, if they have any, unless the words have them."""
        fields: dict[str, Any] = {"radius_option": self.options()}
        for name, value in values.items():
            if name in QUANTITIES:
                fields[f"{name}_unit"] = self.unit(name)
            if isinstance(value, str):
                fields[name] = value
                continue
            named = self.scale is not None and f"{{{name}_unit}}" not in words
            space = "" if re.search(rf"--[\w-]+ (\w+=)?\{{{name}\b", words) else " "  # an option's value is one word
            fields[name] = Measured(self.to_user(name, value), self.unit(name) if named else "", space)
        return words.replace("c0 = {c0", f"{self.symbol('c0')} = {{c0").format(**fields)

    def options(self) -> str:
        """What a command needs to be in these units, after a space; nothing in radii."""
        if self.scale is not None:
            return self.scale.options(f"{self.radius:.12g}")
        return f" --radius {self.radius:.12g}" if self.given else ""

    def to_tree(self) -> dict[str, Any]:
        """As numbers and words, to be saved with what was computed in these units; empty where they are plain numbers."""
        return {} if self.scale is None else {"radius": self.radius, **self.scale.to_tree()}

    def texts(self) -> dict[str, str]:
        """What ``of`` makes them from."""
        return {} if self.scale is None else self.scale.texts(f"{self.radius!r}")

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> Units:
        """The inverse of ``to_tree``.

        Raises:
            ValueError, LookupError, TypeError: something is missing, or does not fit.
        """
        return cls(tree["radius"], given=True, scale=Scale.from_tree(tree)) if tree else RADII


def headed(table: pd.DataFrame) -> pd.DataFrame:
    """A table that ``Units.columns`` made, with the units in the names of its columns: ``L[nm]``."""
    return table.rename(columns=table.attrs.get(HEADER, {}))


RADII = Units()
"""The radius is the unit of length."""


class Sentence(str):
    """A sentence with numbers that have dimensions: a text as it is in radii, which ``Units.said`` puts into any unit.

    Attributes:
        parts: texts with fields of ``str.format``, and the values of the fields by the names of their quantities.
    """

    parts: Parts

    def __new__(cls, text: str, /, **values: Any) -> Sentence:
        """From a text like ``a neck of {r:.2g} {r_unit}`` and what its fields hold: quantities of ``QUANTITIES``, or words.

        ``{radius_option}`` is what a command needs that repeats such numbers.
        """
        return cls._of(((text, values),))

    @classmethod
    def joined(cls, *pieces: str) -> Sentence:
        """Sentences and plain texts one after the other."""
        return cls._of(
            tuple(part for piece in pieces for part in (piece.parts if isinstance(piece, Sentence) else ((piece, {}),)))
        )

    @classmethod
    def _of(cls, parts: Parts) -> Sentence:
        sentence = super().__new__(cls, RADII.told(parts))
        sentence.parts = parts
        return sentence

    def replace(self, old: str, new: str, count: SupportsIndex = -1, /) -> Sentence:
        """As a text's, in the words between its numbers."""
        return Sentence._of(tuple((words.replace(old, new, count), values) for words, values in self.parts))

    def __add__(self, other: str) -> Sentence:
        """What is appended to a sentence leaves it its numbers."""
        return Sentence.joined(self, other)

    def __radd__(self, other: str) -> Sentence:
        """And what is put before it."""
        return Sentence.joined(other, self)

    def __reduce__(self) -> tuple[Any, ...]:
        """As its parts, so that what another process says keeps its numbers."""
        return Sentence._of, (self.parts,)
