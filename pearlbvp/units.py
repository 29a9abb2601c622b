"""Units of length: the one place that knows the dimension of every quantity, and the unit in which a user reads and writes it.

The package computes with tubes of radius 1. A tube of any radius is similar to one of those (paper, §1): what is given is
converted at the door, and what is written - columns, axes, sentences, surfaces - on its way out, both by the dimension that a
quantity's name has here. The bending modulus and the flow's mobility are 1, so tension, pressure and energy by area are powers
of length, and so is time, whose power depends on the flow.

The same conversion leads from the end of a flow, whose area is ``s`` times that of its tube, to the similar shape of a branch:
``Units(s).from_user`` divides its lengths by ``s`` and multiplies its tension by ``s^2`` (``studies.flow_end``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple, SupportsIndex, TypeVar

from pearlbvp.helfrich import Tube, finite, positive

if TYPE_CHECKING:
    import pandas as pd

Value = TypeVar("Value")
"""A number or an array of them."""

Parts = tuple[tuple[str, Mapping[str, Any]], ...]
"""Texts, each with the values of its fields."""

Surface = TypeVar("Surface")
"""A triangulated surface: a dataclass with ``vertices`` and ``length``."""


class Dimension(NamedTuple):
    """Powers of length and of the flow's time that a quantity is measured in."""

    length: int = 0
    time: int = 0


NUMBER, LENGTH, CURVATURE, AREA, VOLUME = Dimension(), Dimension(1), Dimension(-1), Dimension(2), Dimension(3)
TENSION, PRESSURE = Dimension(-2), Dimension(-3)
"""Also of an energy by area: ``(H - c0)^2`` is the square of a curvature; ``lambda1 A`` and ``lambda2 V`` are energies."""
FORCE = Dimension(-1)
"""An energy by length. Energies themselves, and torques, are numbers."""
TIME, RATE, VELOCITY = Dimension(time=1), Dimension(time=-1), Dimension(1, -1)

QUANTITIES: Mapping[str, Dimension] = {
    **dict.fromkeys(("L", "length", "period", "x", "r", "y", "z", "r_min", "r_max", "amplitude", "wave", "gap",
                     "delta", "centre", "shape", "edge", "M"), LENGTH),
    **dict.fromkeys(("c0", "k", "H"), CURVATURE),
    "force": FORCE,
    **dict.fromkeys(("lambda1", "E", "E_least_energy"), TENSION),
    **dict.fromkeys(("lambda2", "lambda2_pearl", "lambda2_upper", "lower_lambda2", "upper_lambda2", "pressure"), PRESSURE),
    "area": AREA, "volume": VOLUME, "volume_by_length": AREA, "xi": Dimension(-2),
    "t": TIME, "velocity": VELOCITY, **dict.fromkeys(("mu_crit", "mu_error", "rate"), RATE),
    **dict.fromkeys(("v", "v_localized", "v_reduced", "area_error", "volume_error", "quality_worst", "quality_mean",
                     "m", "n", "point", "pearls", "pearls_least_energy", "kernel", "n_unstable", "nodes", "triangles",
                     "slope", "torque", "phi", "psi", "vertex", "i", "j"), NUMBER),
}  # fmt: skip
"""Dimensions by the names that columns, options and the numbers of sentences have."""

WORDS: Mapping[str, str] = {
    "L": "length L", "x": "axial position x", "k": "wave number k", "c0": "spontaneous curvature c0",
    "v": "reduced volume v", "E": "energy by area E/A", "lambda1": "tension lambda1", "lambda2": "pressure lambda2",
    "force": "axial force", "torque": "torque", "M": "integrated mean curvature M",
    "t": "time t", "velocity": "largest velocity", "r": "distance from the axis",
}  # fmt: skip
"""What the axes of pictures say of quantities, before their units."""

LAW = "area and volume"
TIME_POWERS: Mapping[str, int] = {LAW: 4, "area": 4, "diffusion": 6}
"""Powers of length in the time of each flow: velocities are ``-dF``, or its Laplacian for diffusion."""

SUPERSCRIPTS = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Units:
    """The unit in which a user measures, by the radius that the straight tube has in it.

    Attributes:
        radius: of the straight tube in the user's unit of length.
        given: whether the user gave it; else the unit is the radius itself.
        law: the flow whose time, velocities and growth rates are measured.

    Raises:
        InputError: the radius is no positive number.
    """

    radius: float = 1.0
    given: bool = False
    law: str = LAW

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", positive("radius", self.radius))

    def of_flow(self, law: str) -> Units:
        """The same units, times being those of a flow."""
        return replace(self, law=law)

    def _power(self, dimension: Dimension) -> int:
        return dimension.length + TIME_POWERS[self.law] * dimension.time

    def to_user(self, name: str, value: Value) -> Value:
        """What a quantity of a tube of radius 1 is in the user's unit."""
        return self._scaled(value, self._power(QUANTITIES[name]))

    def from_user(self, name: str, value: Value) -> Value:
        """What a quantity in the user's unit is on a tube of radius 1."""
        return self._scaled(value, -self._power(QUANTITIES[name]))

    def _scaled(self, value: Any, power: int) -> Any:
        if power == 0 or self.radius == 1:
            return value
        return value * self.radius**power if power > 0 else value / self.radius**-power

    def named_from_user(self, name: str, value: Value) -> Value:
        """As ``from_user``, of a name that a user wrote: one that means nothing stays, for the study to refuse."""
        return self.from_user(name, value) if name in QUANTITIES else value

    def place_from_user(self, text: str) -> str:
        """A point's name given in the user's unit; only that of ``NAME=VALUE`` changes.

        Raises:
            InputError: the value is no number.
        """
        name, equals, value = text.partition("=")
        if not equals:
            return text
        return f"{name}={self.named_from_user(name, finite('point', value))!r}"  # type: ignore[arg-type]

    def tube(self, c0: float, length: float) -> Tube:
        """The tube of radius 1 that a tube is similar to: ``c0 r``, ``L / r`` (paper, §1).

        Raises:
            InputError: an argument that cannot be used.
        """
        return Tube(self.from_user("c0", finite("c0", c0)), self.from_user("length", positive("length", length)))

    def columns(self, table: pd.DataFrame, **apart: Dimension) -> pd.DataFrame:
        """A table of a tube of radius 1 in the user's unit.

        Args:
            table: every column of numbers has a name of ``QUANTITIES``; words stay.
            apart: dimensions that columns have in this table only.
        """
        import pandas as pd

        known = {**QUANTITIES, **apart}
        empty = {str(name) for name in table if table[name].isna().all()}  # of what type they would be is not known
        numbers = [str(name) for name in table if name in known or pd.api.types.is_numeric_dtype(table[name])]
        powers = {name: self._power(known[name]) for name in numbers if name not in empty}
        scaled = {name: self._scaled(pd.to_numeric(table[name]), power) for name, power in powers.items() if power}
        return table.assign(**scaled)

    def surface(self, surface: Surface) -> Surface:
        """A triangulated surface about a tube of radius 1 in the user's unit."""
        return self._resized(surface, 1)

    def surface_from_user(self, surface: Surface) -> Surface:
        """A triangulated surface in the user's unit about a tube of radius 1."""
        return self._resized(surface, -1)

    def _resized(self, surface: Any, power: int) -> Any:
        vertices, length = (self._scaled(value, power) for value in (surface.vertices, surface.length))
        return replace(surface, vertices=vertices, length=length)

    def unit(self, name: str) -> str:
        """The unit of a quantity, ``1/radius²``; empty of plain numbers."""
        power, one = self._power(QUANTITIES[name]), "unit" if self.given else "radius"
        if power == 1:
            return "units" if self.given else "radii"
        raised = one + (str(abs(power)).translate(SUPERSCRIPTS) if abs(power) > 1 else "")
        return "" if power == 0 else raised if power > 0 else f"1/{raised}"

    def axis_label(self, name: str, words: str | None = None) -> str:
        """What an axis says: the quantity in words, by default those of ``WORDS``, and its unit."""
        words, unit = words or WORDS[name], self.unit(name)
        return f"{words} ({unit})" if unit else words

    def note(self) -> str:
        """What a picture says of its unit of length, where that is not the radius; else empty."""
        return f"radius of the straight tube: {self.radius:g} units" if self.given else ""

    def said(self, text: str) -> str:
        """A sentence in the user's unit; one without such numbers stays."""
        return self.told(text.parts) if isinstance(text, Sentence) else text

    def told(self, parts: Parts) -> str:
        """The text of a sentence's parts."""
        return "".join(words.format(**self._fields(values)) if values else words for words, values in parts)

    def _fields(self, values: Mapping[str, Any]) -> dict[str, Any]:
        numbers = {
            name: value if isinstance(value, str) else self.to_user(name, value) for name, value in values.items()
        }
        option = f" --radius {self.radius:.12g}" if self.given else ""
        return (
            numbers
            | {f"{name}_unit": self.unit(name) for name in values if name in QUANTITIES}
            | {"radius_option": option}
        )


RADII = Units()
"""The radius of the straight tube as the unit of length."""


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
