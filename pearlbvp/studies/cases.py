"""Tubes in physical units with solute in them, a row of a table each, in pure numbers (``docs/theory/osmotic.md``).

A column is called by its quantity, with its unit in brackets: ``tension[mN/m]``.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError
from pearlbvp.quantities import COLDEST, CURVATURE, ENERGY, HOTTEST, LENGTH, NUMBER, PRESSURE, TENSION, Dimension, read
from pearlbvp.scale import BODY, CONVENTIONS, Convention
from pearlbvp.studies.osmotic import OsmoticTube
from pearlbvp.tables import name_of, read_table, refuse_misspelt

KNOWN: Mapping[str, tuple[Dimension, str]] = {
    "temperature": (NUMBER, "K"), "dilution": (NUMBER, ""),
    **dict.fromkeys(("length", "radius", "spacing", "measured"), (LENGTH, "nm")), "c0": (CURVATURE, "1/nm"),
    "tension": (TENSION, "mN/m"), "kappa": (ENERGY, "kT"), **dict.fromkeys(("osmolarity", "solute"), (PRESSURE, "mM")),
}  # fmt: skip
"""Quantities of a case and a unit of each. Concentrations are pressures, by the ``kT`` of each particle; the
temperature is first, as others take it."""

AGREE = 1e-3
"""Relative difference of a radius that is given, with fewer digits perhaps, and the one that ``c0`` means."""

USUAL = {"temperature": BODY, "dilution": 1.0}
NEEDED = ("kappa", "osmolarity", "solute", "length", "temperature", "dilution")
"""What must be there, and above 0; the tension must be there."""


@dataclass(frozen=True)
class Case:
    """A row in pure numbers, and the units that they are measured in.

    Attributes:
        tube: the tube.
        period: of the pearls asked for, None for those of least potential among the stable ones.
        measured: diameter of the beads, by the unit of length; not a number where it is not given.
        unit: of length, in m: the radius of the straight tube without a pressure difference.
        rigidity: ``kappa`` of ``kappa (H - c0)^2``, in J.
        reference: radius of the tube whose volume the solute was measured in, by the unit.
    """

    tube: OsmoticTube
    period: float | None
    measured: float
    unit: float
    rigidity: float
    reference: float

    @classmethod
    def of(cls, row: Mapping[str, float], convention: Convention) -> Case:
        """From quantities in SI units, NaN where there are none; ``c0`` is that of ``(H - c0)^2``.

        Raises:
            InputError: the quantity that cannot be used, and what to do.
        """
        for name in NEEDED:
            if not 0 < row[name] < math.inf:
                raise InputError(name, "it is missing, or no number above 0", "give one")
        if not COLDEST < row["temperature"] < HOTTEST:
            raise InputError(
                "temperature", f"no membrane is in water at {row['temperature']:g} K", "give it in K, like 310"
            )
        if not math.isfinite(row["tension"]):
            raise InputError("tension", "it is missing", "give a number")
        if row["measured"] <= 0:
            raise InputError("measured", "no bead has a diameter of 0 or less", "leave it empty where there is none")
        rigidity, c0, given = row["kappa"] * CONVENTIONS[convention], row["c0"], row["radius"]
        ratio = row["tension"] / rigidity
        if math.isnan(c0):
            if not given > 0:
                raise InputError("radius", "it is missing, and so is c0", "give one of the two")
            if 1 / (4 * given**2) < ratio:
                most = rigidity / (4 * given**2)
                raise InputError(
                    "tension",
                    f"{row['tension'] * 1000.0:g} mN/m is above {most * 1000.0:.4g} mN/m, beyond "
                    "which no spontaneous curvature makes this radius that of the straight tube without "
                    "a pressure",
                    "give less, or c0",
                )
            c0 = math.sqrt(1 / (4 * given**2) - ratio)
        elif c0**2 + ratio <= 0:
            raise InputError(
                "tension", "no straight tube is in equilibrium without a pressure", "give more, or another c0"
            )
        unit = 1 / (2 * math.sqrt(c0**2 + ratio))
        if given > 0 and abs(given / unit - 1) > AGREE:
            raise InputError(
                "radius", f"by c0 and the tension it is {unit * 1000000000.0:.6g} nm", "give one of the two"
            )
        reference = (given if given > 0 else unit) / unit
        pressure = unit**3 / rigidity / row["dilution"]
        tube = OsmoticTube(
            c0 * unit, row["solute"] * reference**2 * pressure, row["osmolarity"] * pressure, row["length"] / unit
        )
        if row["spacing"] > row["length"]:
            raise InputError("spacing", "it is longer than the tube", "give less, or a longer one")
        period = row["spacing"] / unit if row["spacing"] > 0 else None
        return cls(tube, period, row["measured"] / unit, unit, rigidity, reference)


def read_cases(path: str | os.PathLike[str]) -> pd.DataFrame:
    """The columns of a CSV file that say something of a case, called as they are there.

    Raises:
        InputError: it cannot be read.
    """
    found = read_table("CASES", path, [], optional=list(KNOWN))
    return pd.DataFrame(found).rename(columns=found.headings)


def cases_of(table: pd.DataFrame, convention: Convention) -> Iterator[Case]:
    """The cases of a table.

    Raises:
        InputError: a column or a number, with its row, that cannot be used.
    """
    columns = _in_si(table)
    for i in range(len(table)):
        try:
            yield Case.of({name: float(values[i]) for name, values in columns.items()}, convention)
        except InputError as error:
            raise InputError("CASES", f"row {i + 1}, {error.argument}: {error.what}", error.remedy) from None


def _in_si(table: pd.DataFrame) -> dict[str, Array]:
    """Columns by quantity in SI units; what is not there has its usual value, or is NaN.

    Raises:
        InputError: a column is missing or there twice, its unit is none of its quantity, or it holds what is no number.
    """
    refuse_misspelt("CASES", map(str, table), KNOWN)
    columns: dict[str, Array] = {}
    for name, (dimension, usual) in KNOWN.items():
        headings = [str(heading) for heading in table if name_of(str(heading)).casefold() == name]
        if len(headings) > 1:
            raise InputError("CASES", f"{name} is there twice, as {' and '.join(headings)}", "leave one out")
        if not headings and name in ("tension", *NEEDED) and name not in USUAL:
            raise InputError("CASES", f"there is no column of the {name}", f"give one, called {name}[{usual}]")
        values = np.full(len(table), math.nan)
        for heading in headings:
            try:
                values = table[heading].to_numpy(float)
            except (TypeError, ValueError):
                raise InputError("CASES", f"the column {heading} holds what is no number", "give numbers") from None
            factor, power = _unit(heading, dimension, usual)
            values = values * factor * (columns["temperature"] ** power if power else 1.0)
            if name == "temperature" and _in_degrees(heading):
                values = values + FREEZING
            if heading.startswith("C0"):  # (2H - C0)^2 = 4 (H - C0/2)^2
                values = values / 2
        columns[name] = np.where(np.isnan(values), USUAL.get(name, math.nan), values)
    return columns


FREEZING = 273.15
"""In K."""


def _in_degrees(heading: str) -> bool:
    """Whether a temperature is in degrees Celsius."""
    return heading.partition("[")[2].removesuffix("]").strip() in ("degC", "°C")


def _unit(heading: str, dimension: Dimension, usual: str) -> tuple[float, int]:
    """What a column's unit is in SI units at 1 K, and the power of the temperature that it goes by, as ``kT`` does.

    Raises:
        InputError: it has none, or none of its quantity.
    """
    unit = heading.partition("[")[2].removesuffix("]").strip()
    wrong = InputError(
        "CASES", f"the column {heading} has no unit of its quantity", f"write it like {name_of(heading)}[{usual}]"
    )
    if dimension == NUMBER:
        if unit not in ("", usual) and not (usual == "K" and _in_degrees(heading)):
            raise wrong
        return 1.0, 0
    text = f"1{unit.removeprefix('1')}" + "*kT/particle" * (usual == "mM")
    try:
        cold, warm = (read("CASES", text, kelvin) for kelvin in (1.0, 2.0))
    except InputError:
        raise wrong from None
    if cold.dimension != dimension:
        raise wrong
    return cold.value, round(math.log2(warm.value / cold.value))
