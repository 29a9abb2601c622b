"""Quantities with units, as people write them: ``50nm``, ``20kT``, ``1/(150nm)``, ``0.01mN/m``.

pint knows the units. It is loaded where a text has one only, because that takes a third of a second, and it sees a text only
after that was found to be one number and its unit: it would read ``1 2nm`` as 2 nm, and work on ``9^9^9`` for ever.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

from pearlbvp.errors import InputError

if TYPE_CHECKING:
    import pint

BOLTZMANN = 1.380649e-23
"""In J/K, exact since 2019 (SI Brochure, 9th edition, §2.2)."""

LONGEST = 80
"""Characters of a quantity."""

_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_POWER = r"(?:(?:\^|\*\*)[+-]?\d(?!\d)|⁻?[¹²³⁴⁵⁶⁷⁸⁹])"
_NAME = rf"(?:[^\W\d_]|[Åµ°])+(?:_[A-Za-z]+)?{_POWER}?"
_PRODUCT = rf"{_NAME}(?:(?:\s*[*/·.]\s*|\s+){_NAME})*"
_FACTOR = rf"(?:{_NAME}|\(\s*{_PRODUCT}\s*\))"
_UNITS = rf"{_FACTOR}(?:(?:\s*[*/·.]\s*|\s+){_FACTOR})*"
QUANTITY = rf"\s*[+-]?{_NUMBER}\s*(?:\*?\s*{_UNITS}|/\s*(?:{_UNITS}|\(\s*{_NUMBER}\s*\*?\s*{_UNITS}\s*\)))\s*"
"""One number and its unit, or a number by one with its unit."""


class Dimension(NamedTuple):
    """Powers of length, time and energy that a quantity is measured in.

    ``spontaneous`` is 1 of a spontaneous curvature, of which two conventions are in use: ``c0`` of ``(H - c0)^2``, and
    ``C0 = 2 c0`` of ``(2H - C0)^2``.
    """

    length: int = 0
    time: int = 0
    energy: int = 0
    spontaneous: int = 0

    def powers(self, length: str) -> str:
        """A unit of it where units have no names: of ``length``, of ``2kappa`` and of the flow's time ``T``.

        Examples:
            >>> Dimension(-2, energy=1).powers("R"), Dimension().powers("R")
            ('2kappa R^-2', '1')
        """
        factors = (("2kappa", self.energy), (length, self.length), ("T", self.time))
        return " ".join(name if power == 1 else f"{name}^{power}" for name, power in factors if power) or "1"


NUMBER, LENGTH, CURVATURE, AREA, VOLUME = Dimension(), Dimension(1), Dimension(-1), Dimension(2), Dimension(3)
ENERGY, FORCE, TENSION, PRESSURE = (Dimension(length, energy=1) for length in (0, -1, -2, -3))

WORDS: Mapping[Dimension, str] = {
    NUMBER: "a plain number, like 1.1", LENGTH: "a length, like 50nm", CURVATURE: "a curvature, like 1/(150nm)",
    AREA: "an area, like 3um^2", VOLUME: "a volume, like 3um^3", ENERGY: "an energy, like 20kT",
    FORCE: "a force, like 10pN", TENSION: "a tension, like 0.01mN/m", PRESSURE: "a pressure, like 10Pa",
    Dimension(time=1): "a time, like 2s", Dimension(time=-1): "a rate, like 3/s", Dimension(1, -1): "a velocity, like 1um/s",
    Dimension(-3, 1, 1): "a viscosity, like 1mPa.s",
}  # fmt: skip
"""What quantities of a dimension are called, for refusals."""


class Amount(NamedTuple):
    """A quantity in SI units.

    Attributes:
        text: as it was written.
        value: in metres, seconds and joules.
        dimension: its powers of these.
        magnitude, unit: the number before its unit, and the unit in ASCII, ``nm``.
    """

    text: str
    value: float
    dimension: Dimension
    magnitude: float
    unit: str


def has_unit(text: str) -> bool:
    """Whether a text looks like a quantity and is no plain number."""
    try:
        float(text)
    except ValueError:
        return re.match(r"\s*[+-]?[.\d]", text) is not None and re.search(r"[^\W\d]|°", text) is not None
    return False


def read(argument: str, text: str, temperature: float = 310.0) -> Amount:
    """A quantity from its text.

    Args:
        argument: its name, for the message.
        text: a number and its unit.
        temperature: in kelvin, for those in ``kT``.

    Raises:
        InputError: it is no number with a unit, not finite, or no quantity of mechanics.
    """
    value, powers, magnitude, unit = _parsed(argument, text, temperature)
    metre, second, mass = (powers.pop(f"[{name}]", 0) for name in ("length", "time", "mass"))
    # A joule is kg m^2/s^2: the energy has the power of the mass, and that leaves these of metre and second.
    exponents = metre - 2 * mass, second + 2 * mass, mass
    if powers or not all(float(power).is_integer() for power in exponents):
        raise InputError(argument, f"{text} is not measured in lengths, times and energies", "check its unit")
    return Amount(text, value, Dimension(*(int(power) for power in exponents)), magnitude, unit)


COLDEST, HOTTEST = 200.0, 500.0
"""Temperatures in K between which there are membranes in water, with room to either side."""


def kelvins(argument: str, text: str) -> float:
    """A temperature in kelvin, from ``310K`` or ``37degC``.

    Raises:
        InputError: it is no temperature, or one at which there is no membrane in water, as where degrees were meant.
    """
    value, powers, *_ = _parsed(argument, text, 1.0) if has_unit(text) else (0.0, {})
    if powers != {"[temperature]": 1} or not COLDEST < value < HOTTEST:
        raise InputError(argument, f"{text} is no temperature of a membrane", "give one like 310K or 37degC")
    return value


def _parsed(argument: str, text: str, temperature: float) -> tuple[float, dict[str, float], float, str]:
    """Value in SI units, powers by dimension, the number as written and its unit."""
    wrong = InputError(argument, f"{text[:LONGEST]!r} is no number with a unit that is known", _advice(text))
    if len(text) > LONGEST or not re.fullmatch(QUANTITY, text):
        raise wrong
    import pint

    plain = re.sub(r"(?<=[^\W\d_])\s*[.·]\s*(?=[^\W\d_])", "*", text)
    try:
        found: pint.Quantity[float] = _registry(temperature).Quantity(plain)
        value = float(found.to_base_units().magnitude)
        unit = f"{found.units:~C}".replace("µ", "u").replace("Å", "angstrom")
        powers = {name: float(power) for name, power in found.dimensionality.items() if power}  # type: ignore[arg-type]
    except (pint.PintError, ArithmeticError, AttributeError, ValueError, TypeError):
        raise wrong from None
    if not math.isfinite(value):
        raise InputError(argument, f"{text} is not finite", "give an ordinary quantity")
    return value, powers, float(found.magnitude), unit


def _advice(text: str) -> str:
    """What to write instead."""
    if re.fullmatch(rf"\s*[+-]?{_NUMBER}\s*/\s*{_NUMBER}\s*[^\W\d].*", text):
        return "put what it is divided by in brackets, like 1/(150nm)"
    return "write one like 50nm, 1/(150nm), 20kT or 0.01mN/m"


@cache
def _registry(temperature: float) -> pint.UnitRegistry[float]:
    """Units, ``kT`` among them, at a temperature in kelvin."""
    import pint

    registry: pint.UnitRegistry[float] = pint.UnitRegistry(autoconvert_offset_to_baseunit=True)
    registry.define(f"kT = {BOLTZMANN * temperature!r} joule = kT = kBT = k_BT")
    return registry


class Measured(float):
    """A number that is written with its unit behind it: ``50 nm``, ``0.01/nm``.

    Attributes:
        unit: its name, or nothing.
        space: what stands between them.
    """

    unit: str
    space: str

    def __new__(cls, value: float, unit: str, space: str = " ") -> Measured:
        """A number of a unit."""
        measured = super().__new__(cls, value)
        measured.unit = unit.removeprefix("1")
        measured.space = space if unit and measured.unit == unit else ""
        return measured

    def __format__(self, form: str) -> str:
        return super().__format__(form) + self.space + self.unit


def unit_text(powers: Mapping[str, int]) -> str:
    """A unit in ASCII that pint reads, too: ``1/nm^3``, ``Pa/nm``, ``nm/s``."""
    above = [name + (f"^{power}" if power > 1 else "") for name, power in powers.items() if power > 0]
    below = [name + (f"^{-power}" if power < -1 else "") for name, power in powers.items() if power < 0]
    return "/".join(["*".join(above) or "1", *below]) if above or below else ""
