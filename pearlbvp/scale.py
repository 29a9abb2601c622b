"""What a physical tube is measured by: its unit of length, its bending rigidity in one of two conventions, its temperature.

The package's energy counts in ``2 kappa``, where ``kappa`` is that of ``kappa/2 (2H - C0)^2`` (W. Helfrich, Z. Naturforsch.
C 28 (1973) 693), ``C0 = 2 c0``. Where it is written ``kappa (H - c0)^2``, as in Mem3DG and pde2path, ``kappa`` is twice that
one: the package's energy counts in it (``docs/theory/model.md``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

from pearlbvp.errors import InputError
from pearlbvp.helfrich import choice, positive
from pearlbvp.quantities import ENERGY, LENGTH, WORDS, Amount, Dimension, kelvins, read, unit_text

Convention = Literal["physicists", "mem3dg"]
CONVENTIONS: Mapping[Convention, float] = {"physicists": 2.0, "mem3dg": 1.0}
"""How many of their ``kappa`` the energy counts in, and how many ``c0`` their spontaneous curvature is."""

BODY = 310.0
"""Temperature of a body, in kelvin, where none is given."""

SMALLEST, LARGEST = (1e-11, 1e-24), (1.0, 1e-9)
"""Radius in metres and rigidity in joules beyond which they are mistakes."""

NAMED: Mapping[tuple[int, int], tuple[str, float]] = {
    (-2, 1): ("mN/m", 1e-3), (-1, 1): ("pN", 1e-12), (0, 1): ("pN*nm", 1e-21)
}  # fmt: skip
"""Units of tension, force and energy by their powers of length and energy, and what they are in SI units."""


@dataclass(frozen=True)
class Scale:
    """The units of a physical tube.

    Attributes:
        unit: of length, as it was written: ``nm``.
        metre: one of it in metres.
        energy: what the package's energy counts in, in joules; None where no rigidity is known, and energies count in it.
        kappa: the rigidity as it was written, or empty.
        temperature: in kelvin.
        convention: of ``kappa`` and the spontaneous curvature.
    """

    unit: str
    metre: float
    energy: float | None = None
    kappa: str = ""
    temperature: float = BODY
    convention: Convention = "physicists"

    @classmethod
    def of(cls, radius: str, kappa: str | None, temperature: str | None, convention: str) -> tuple[float, Scale]:
        """A tube's radius in its unit, and its scale, from texts.

        Raises:
            InputError: one of them cannot be used.
        """
        kelvin = BODY if temperature is None else kelvins("temperature", temperature)
        choice("convention", convention, tuple(CONVENTIONS))
        size = _amount("radius", radius, kelvin, LENGTH, SMALLEST[0], LARGEST[0])
        magnitude, unit = (size.magnitude, size.unit) if size.unit.isalpha() else (size.value, "m")
        scale = cls(unit, size.value / magnitude, None, "", kelvin, convention)  # type: ignore[arg-type]
        return magnitude, scale if kappa is None else scale.with_kappa(kappa)

    def with_kappa(self, kappa: str) -> Scale:
        """The same with a rigidity.

        Raises:
            InputError: it is no energy that one has.
        """
        rigidity = _amount("kappa", kappa, self.temperature, ENERGY, SMALLEST[1], LARGEST[1])
        energy = rigidity.value * CONVENTIONS[self.convention]
        return replace(self, energy=energy, kappa="".join(kappa.split(" ")) if " " in kappa else kappa)

    @property
    def spontaneous(self) -> float:
        """How many ``c0`` the spontaneous curvature of the convention is."""
        return CONVENTIONS[self.convention]

    def measure(self, dimension: Dimension, second: float | None) -> tuple[float, str]:
        """What a quantity counts in beside powers of the radius in its unit, and the unit in which it is written.

        Lengths count in the unit of length, energies in pN nm, forces in pN, tensions in mN/m, all others in Pa, lengths and
        seconds. Where no rigidity is known, energies are numbers.

        Args:
            dimension: of the quantity.
            second: the unit of the package's time in seconds, if times are measured.
        """
        length, time, energy, spontaneous = dimension
        energy = 0 if self.energy is None else energy
        factor = self.spontaneous**spontaneous * (second or 1.0) ** time
        if self.energy is None or energy == 0:
            return factor, unit_text({self.unit: length, "s": time})
        factor *= self.energy**energy
        if time == 0 and (length, energy) in NAMED:
            name, size = NAMED[length, energy]
            return factor * self.metre**length / size, name
        # J^e unit^l = Pa^e m^(3 e) unit^l = Pa^e unit^(l + 3 e) by metre^(-3 e).
        return factor / self.metre ** (3 * energy), unit_text({"Pa": energy, self.unit: length + 3 * energy, "s": time})

    def in_si(self, dimension: Dimension) -> float:
        """What one of the unit that ``measure`` writes a quantity in is in SI units."""
        length, _, energy, _ = dimension
        energy = 0 if self.energy is None else energy
        if energy and dimension.time == 0 and (length, energy) in NAMED:
            return NAMED[length, energy][1]
        return self.metre ** (length + 3 * energy)

    def number(self, argument: str, text: str, dimension: Dimension, unit: str) -> float:
        """A quantity in the unit in which those of its dimension are written.

        Args:
            argument: its name, for the message.
            text: a number and its unit.
            dimension: that it must have.
            unit: the name of that unit, for the message.

        Raises:
            InputError: it is of another dimension, or the rigidity is missing that it needs.
        """
        amount, wanted = read(argument, text, self.temperature), dimension._replace(spontaneous=0)
        if self.energy is None:
            if amount.dimension == wanted and wanted.energy:
                raise InputError(argument, f"{text} takes the bending rigidity", "give kappa=20kT or the like, too")
            wanted = wanted._replace(energy=0)
        if amount.dimension != wanted:
            advice = WORDS.get(wanted, f"one in {unit}")
            raise InputError(argument, f"{text} is {said(amount)}", f"give {advice}")
        return float(f"{amount.value / self.in_si(wanted):.15g}")

    def options(self, radius: str) -> str:
        """What a command needs to be in the same units."""
        kappa = f" --kappa {self.kappa} --temperature {self.temperature:g}K" if self.kappa else ""
        convention = "" if self.convention == "physicists" else f" --convention {self.convention}"
        return f" --radius {radius}{self.unit}{kappa}{convention}"

    def texts(self, radius: str) -> dict[str, str]:
        """What ``of`` makes it from."""
        texts = {
            "radius": f"{radius}{self.unit}",
            "temperature": f"{self.temperature!r}K",
            "convention": self.convention,
        }
        return texts | {"kappa": self.kappa} if self.kappa else texts

    def to_tree(self) -> dict[str, Any]:
        """As numbers and words, to be saved."""
        tree = {"unit": self.unit, "metre": self.metre, "temperature": self.temperature, "convention": self.convention}
        return tree if self.energy is None else tree | {"kappa": self.kappa, "energy": self.energy}

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> Scale:
        """The inverse of ``to_tree``.

        Raises:
            ValueError, LookupError, TypeError: something is missing, or does not fit.
        """
        unit, kappa, convention = str(tree["unit"]), str(tree.get("kappa", "")), str(tree["convention"])
        choice("convention", convention, tuple(CONVENTIONS))
        if not unit.isalpha() or not kappa.isprintable():
            raise ValueError("no unit")
        energy = positive("energy", tree["energy"]) if kappa else None
        numbers = positive("metre", tree["metre"]), positive("temperature", tree["temperature"])
        return cls(unit, numbers[0], energy, kappa, numbers[1], convention)  # type: ignore[arg-type]


def _amount(argument: str, text: str, kelvin: float, wanted: Dimension, least: float, most: float) -> Amount:
    """A positive quantity of a dimension, within bounds.

    Raises:
        InputError: it is none.
    """
    amount = read(argument, text, kelvin)
    if amount.dimension != wanted:
        raise InputError(argument, f"{text} is {said(amount)}", f"give {WORDS[wanted]}")
    if amount.value <= 0:
        raise InputError(argument, f"{text} must be positive", f"give {WORDS[wanted]}")
    if not least <= amount.value <= most:
        unit = "m" if wanted == LENGTH else "J"
        raise InputError(argument, f"{text} is not between {least:g} and {most:g} {unit}", "check its unit")
    return amount


def said(amount: Amount) -> str:
    """What a quantity is, in words."""
    words = WORDS.get(amount.dimension)
    return "of another kind" if words is None else words.partition(",")[0]
