"""Quantities of a tube of radius 1 in another unit, and back: by powers of its radius and of its rigidity."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Self, TypeVar

from pearlbvp.dimensions import LAW, QUANTITIES, TIME_POWERS
from pearlbvp.helfrich import positive
from pearlbvp.quantities import Dimension
from pearlbvp.scale import Scale

Value = TypeVar("Value")
"""A number or an array of them."""

SUPERSCRIPTS = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Conversion:
    """What ``Units``, which says what the attributes are, does with numbers."""

    radius: float = 1.0
    given: bool = False
    law: str = LAW
    scale: Scale | None = None
    second: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", positive("radius", self.radius))

    def of_flow(self, law: str) -> Self:
        """The same units, times being those of a flow."""
        return replace(self, law=law)

    def in_time(self, second: float) -> Self:
        """The same units, where the package's unit of time is known, in seconds."""
        return replace(self, second=positive("time", second))

    def _resolved(self, dimension: Dimension) -> Dimension:
        """A dimension without time, where that counts in a flow's of mobility 1: in powers of length, and in 1/energy."""
        if self.second is not None:
            return dimension
        length = dimension.length + TIME_POWERS[self.law] * dimension.time
        return dimension._replace(length=length, time=0, energy=dimension.energy - dimension.time)

    def _power(self, dimension: Dimension) -> int:
        return self._resolved(dimension).length

    def _factor(self, dimension: Dimension) -> float:
        """What a quantity is multiplied by beside the power of the radius."""
        return 1.0 if self.scale is None else self.scale.measure(self._resolved(dimension), self.second)[0]

    def to_user(self, name: str, value: Value) -> Value:
        """What a quantity of a tube of radius 1 is in the user's unit."""
        return self._converted(value, QUANTITIES[name])

    def _converted(self, value: Any, dimension: Dimension) -> Any:
        factor = self._factor(dimension)
        return self._scaled(value if factor == 1 else value * factor, self._power(dimension))

    def from_user(self, name: str, value: Value) -> Value:
        """What a quantity in the user's unit is on a tube of radius 1."""
        dimension = QUANTITIES[name]
        factor = self._factor(dimension)
        found = value if factor == 1 else value / factor  # type: ignore[operator]
        return self._scaled(found, -self._power(dimension))

    def _scaled(self, value: Any, power: int) -> Any:
        if power == 0 or self.radius == 1:
            return value
        return value * self.radius**power if power > 0 else value / self.radius**-power

    def _heading(self, name: str, dimension: Dimension) -> str:
        """A column's name with its unit, by which it can be read back: ``L[nm]``; plain numbers have none."""
        unit = "" if self.scale is None else self.scale.measure(self._resolved(dimension), self.second)[1]
        return f"{self.symbol(name)}[{unit}]" if unit else name

    def _named(self, dimension: Dimension) -> str:
        """The unit of a dimension, or what it is made of where units have no names."""
        if self.scale is None:
            return dimension.powers("U" if self.given else "R")
        return self.scale.measure(self._resolved(dimension), self.second)[1] or "1"

    def symbol(self, name: str) -> str:
        """What a quantity is called: the spontaneous curvature is ``C0`` where it is that of ``(2H - C0)^2``."""
        return "C0" if name == "c0" and self.scale is not None and self.scale.spontaneous != 1 else name

    def unit(self, name: str) -> str:
        """The unit of a quantity, ``1/radius²`` or ``1/nm^2``; empty of plain numbers."""
        if self.scale is not None:
            return self.scale.measure(self._resolved(QUANTITIES[name]), self.second)[1]
        power, one = self._power(QUANTITIES[name]), "unit" if self.given else "radius"
        if power == 1:
            return "units" if self.given else "radii"
        raised = one + (str(abs(power)).translate(SUPERSCRIPTS) if abs(power) > 1 else "")
        return "" if power == 0 else raised if power > 0 else f"1/{raised}"
