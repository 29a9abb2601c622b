"""Tubes measured in physical units, a row each, and their equilibria at a given tension with solute in them.

A column's name is that of its quantity with its unit, ``tension[mN/m]``; here they become pure numbers
(``docs/theory/osmotic.md``), and here results get their units back.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import pandas as pd

from pearlbvp.continuation.path import PathEnd
from pearlbvp.errors import InputError, SpectrumError
from pearlbvp.helfrich import choice, whole
from pearlbvp.messages import say
from pearlbvp.progress import progress as progress_bar
from pearlbvp.studies.osmotic import OsmoticTube, Pearl, pearls_of_periods
from pearlbvp.studies.parallel import in_processes
from pearlbvp.tables import read_table
from pearlbvp.theory.osmotic import straight_potential, straight_size, straight_unstable

Convention = Literal["physicists", "mem3dg"]
"""Whose bending rigidity and spontaneous curvature: ``kappa/2 (2H - C0)^2``, or ``kappa (H - c0)^2``."""

BOLTZMANN, GAS = 1.380649e-23, 8.31446261815324
"""In J/K and J/(mol K), exact since 2019."""

LENGTHS = {"nm": 1e-9, "um": 1e-6, "m": 1.0}
CONCENTRATIONS = {"mOsm": 1.0, "Osm": 1e3, "mM": 1.0, "M": 1e3, "mol/m^3": 1.0}
UNITS: Mapping[str, Mapping[str, float]] = {
    **dict.fromkeys(("radius", "length", "spacing", "measured"), LENGTHS),
    "c0": {"1/nm": 1e9, "1/um": 1e6, "1/m": 1.0},
    "tension": {"mN/m": 1e-3, "uN/m": 1e-6, "pN/um": 1e-6, "N/m": 1.0},
    "kappa": {"kT": BOLTZMANN, "pN*nm": 1e-21, "J": 1.0},
    **dict.fromkeys(("osmolarity", "solute"), CONCENTRATIONS),
    "temperature": {"K": 1.0},
    "dilution": {"": 1.0},
}
"""Quantities of a case and what their units are in SI; ``kT`` is of the row's temperature."""

USUAL = {"temperature": 310.0, "dilution": 1.0}
NEEDED = ("tension", "kappa", "osmolarity", "solute", "length")

RESULTS = ["status", "equilibria", "pearls", "bead[nm]", "neck[nm]", "volume", "pressure[Pa]", "force[pN]", "energy[pN]",
           "n_unstable", "critical", "excess", "straight[nm]", "straight_unstable", "stable_spacings[nm]",
           "best_spacing[nm]", "best_bead[nm]", "message"]  # fmt: skip


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
        """From quantities in SI units, ``kappa`` by the Boltzmann constant where it is in kT.

        Raises:
            InputError: the quantity that cannot be used, and what to do.
        """
        for name in (*NEEDED[1:], "temperature", "dilution"):
            if not 0 < row.get(name, math.nan) < math.inf:
                raise InputError(f"{name}: it is {row.get(name, 'missing')}; give a number above 0")
        if not math.isfinite(row.get("tension", math.nan)):
            raise InputError(f"tension: it is {row.get('tension', 'missing')}; give a number")
        # (kappa/2)(2H - C0)^2 = 2 kappa (H - C0/2)^2
        double = 2 if convention == "physicists" else 1
        rigidity, c0, given = double * row["kappa"], row.get("c0", math.nan) / double, row.get("radius", math.nan)
        ratio = row["tension"] / rigidity
        if math.isnan(c0):
            if not given > 0:
                raise InputError("radius: it is missing, and so is c0; give one of the two")
            if 1 / (4 * given**2) < ratio:
                most = rigidity / (4 * given**2)
                raise InputError(
                    f"tension: {row['tension'] * 1e3:g} mN/m is above {most * 1e3:.4g} mN/m, beyond which no spontaneous "
                    "curvature makes this radius that of the straight tube without a pressure; give less, or c0"
                )
            c0 = math.sqrt(1 / (4 * given**2) - ratio)
        elif c0**2 + ratio <= 0:
            raise InputError("tension: no straight tube is in equilibrium without a pressure; give more, or another c0")
        unit = 1 / (2 * math.sqrt(c0**2 + ratio))
        reference = (given if given > 0 else unit) / unit
        pressure = GAS * row["temperature"] / row["dilution"] * unit**3 / rigidity  # of a mole by cubic metre
        spacing = row.get("spacing", math.nan)
        tube = OsmoticTube(
            c0 * unit, row["solute"] * reference**2 * pressure, row["osmolarity"] * pressure, row["length"] / unit
        )
        if spacing > row["length"]:
            raise InputError("spacing: it is longer than the tube; give less, or a longer one")
        period = spacing / unit if spacing > 0 else None
        return cls(tube, period, row.get("measured", math.nan) / unit, unit, rigidity, reference)


def equilibria(
    cases: str | os.PathLike[str] | pd.DataFrame,
    *,
    convention: Convention = "physicists",
    processes: int | None = None,
    progress: bool | None = None,
) -> pd.DataFrame:
    """Pearled equilibria of tubes at given tensions with solute in them, a row a case.

    The pressure is ``p = (R T / dilution)(solute V0 / V - osmolarity)`` with ``V0`` the volume of the straight tube of the
    given radius (else of that without a pressure).

    Args:
        cases: a table or the name of a CSV file. Columns: ``tension[mN/m], kappa[kT], osmolarity[mM], solute[mM],
            length[nm]`` (of the whole tube), and ``radius[nm]`` or ``c0[1/nm]``; where they are, ``spacing[nm]`` of the
            pearls, ``measured[nm]`` (diameter of their beads), ``temperature[K]`` (310 unless given) and ``dilution`` (1).
            Other units are ``um, m, uN/m, pN/um, N/m, pN*nm, J, M, mOsm, Osm, mol/m^3``.
        convention: of ``kappa`` and ``c0``: ``physicists``, ``kappa/2 (2H - c0)^2``, or ``mem3dg``, ``kappa (H - c0)^2``.
        processes: how many to use (``None``: as many as help).
        progress: show a bar on standard error (``None``: if that is a terminal).

    Returns:
        The cases with what was found. ``status`` is ``found``; ``straight`` where there are no such pearls and the straight
        tube is stable, whose numbers these are then; ``none`` where it is not; or ``failed``. ``bead`` and ``neck`` are
        diameters, ``volume`` is by ``V0``, ``energy`` the potential by length above the straight tube's, ``n_unstable``
        counts the waves that grow on as many pearls as fill the tube (``pearls``), ``excess`` is ``measured/bead - 1``.
        ``stable_spacings`` are those that fit the tube, ``best_spacing`` that of the lowest potential, ``best_bead`` the
        diameter there. An interrupted run returns the rows that are done.

    Raises:
        InputError: an argument, or a number in a row, that cannot be used.

    Example:
        >>> import pearlbvp as pb
        >>> table = pb.equilibria("data/axon_pearls.csv", convention="mem3dg")
    """
    choice("convention", convention, get_args(Convention))
    processes = None if processes is None else whole("processes", processes)
    table = cases if isinstance(cases, pd.DataFrame) else read_cases(cases)
    todo = [_case(i, row, convention) for i, row in enumerate(_in_si(table), 1)]
    rows: list[dict[str, object]] = []
    with progress_bar("case", len(todo), shown=progress) as bar:
        try:
            for row in in_processes(equilibrium_row, todo, processes, fewest=16):
                rows.append(row)
                bar.update()
        except KeyboardInterrupt:
            say(f"interrupted: {len(rows)} of {len(todo)} rows are done and kept", begin="")
    found = pd.DataFrame(rows, columns=RESULTS, index=table.index[: len(rows)])
    whole_numbers = {name: "Int64" for name in ("equilibria", "pearls", "n_unstable", "straight_unstable")}
    return table.iloc[: len(rows)].join(found.astype(whole_numbers))


def _heading(name: str, unit: str) -> str:
    return f"{name}[{unit}]" if unit else name


def read_cases(path: str | os.PathLike[str]) -> pd.DataFrame:
    """The columns of a CSV file that say something of a case.

    Raises:
        InputError: it cannot be read.
    """
    names = [_heading(name, unit) for name, units in UNITS.items() for unit in units]
    return pd.DataFrame(read_table("CASES", path, [], optional=names))


def _in_si(table: pd.DataFrame) -> Iterator[dict[str, float]]:
    """Rows by quantity in SI units; a quantity that is missing in one has its usual value, or none.

    Raises:
        InputError: a column is missing, is there twice in different units, or holds what is no number.
    """
    columns: dict[str, np.ndarray] = {}
    for name, units in UNITS.items():
        there = {full: factor for unit, factor in units.items() if (full := _heading(name, unit)) in table}
        if len(there) > 1:
            raise InputError(f"CASES: {name} is there twice, as {' and '.join(there)}; leave one out")
        if not there and name in NEEDED:
            choices = ", ".join(_heading(name, unit) for unit in units)
            raise InputError(f"CASES: there is no column of the {name}; give one, called {choices}")
        for full, factor in there.items():
            try:
                columns[name] = factor * table[full].to_numpy(float)
            except (TypeError, ValueError):
                raise InputError(f"CASES: the column {full} holds what is no number; give numbers") from None
    for i in range(len(table)):
        row = USUAL | {name: float(values[i]) for name, values in columns.items() if not math.isnan(values[i])}
        if _heading("kappa", "kT") in table and "kappa" in row:
            row["kappa"] *= row["temperature"]
        yield row


def _case(number: int, row: Mapping[str, float], convention: Convention) -> Case:
    try:
        return Case.of(row, convention)
    except InputError as error:
        raise InputError(f"CASES: row {number}, {error}") from None


def equilibrium_row(case: Case) -> dict[str, object]:
    """What is known of one case, by the names of ``RESULTS``."""
    tube, nm = case.tube, 1e9 * case.unit
    size = straight_size(tube.solute, tube.osmolarity)
    row: dict[str, object] = {
        "straight[nm]": 2 * size * nm,
        "straight_unstable": straight_unstable(tube.c0, size, tube.length),
        "message": "",
    }
    asked = [] if case.period is None else [case.period]
    try:
        found = pearls_of_periods(tube, [*asked, *tube.periods])
        stable = [pearl for period in tube.periods for pearl in found[period] if pearl.spectrum.n_unstable == 0]
    except (PathEnd, SpectrumError, np.linalg.LinAlgError) as error:
        return row | {"status": "failed", "message": str(error)}
    best = min(stable, key=_potential, default=None)
    row["stable_spacings[nm]"] = " ".join(dict.fromkeys(f"{pearl.observables['L'] * nm:.5g}" for pearl in stable))
    if best is not None:
        row |= {"best_spacing[nm]": best.observables["L"] * nm, "best_bead[nm]": 2 * best.observables["r_max"] * nm}
    here: Sequence[Pearl] = found[case.period] if case.period is not None else [best] if best is not None else []
    row["equilibria"] = len(here)
    if here:
        shown = min(here, key=lambda pearl: (pearl.spectrum.n_unstable, _potential(pearl)))
        more = f"{len(here)} shapes are in equilibrium here; the one shown has the fewest growing waves"
        return row | _pearl(case, shown) | {"status": "found", "message": more if len(here) > 1 else ""}
    if row["straight_unstable"] == 0:
        return row | _straight(case, size) | {"status": "straight", "message": "the straight tube is stable"}
    message = "no equal pearls of this spacing are connected to the straight tube, which is unstable"
    return row | {"status": "none", "message": message}


def _potential(pearl: Pearl) -> float:
    return pearl.observables["potential"]


def _pearl(case: Case, pearl: Pearl) -> dict[str, object]:
    """Numbers of a pearl."""
    o, spectrum = pearl.observables, pearl.spectrum
    own = {"pearls": pearl.problem.cells, "n_unstable": spectrum.n_unstable, "critical": str(spectrum.critical)}
    return own | _measures(case, o["r_max"], o["r_min"], o["v"], o["lambda2"], o["force"], o["potential"])


def _straight(case: Case, size: float) -> dict[str, object]:
    """Numbers of the straight tube."""
    tube = case.tube
    lambda2 = tube.osmolarity - tube.solute / size**2
    force = math.pi * (1 - lambda2 * size**3 - 2 * tube.c0 * size) / size
    potential = straight_potential(tube.c0, tube.solute, tube.osmolarity)
    return {"n_unstable": 0} | _measures(case, size, size, size**2, lambda2, force, potential)


def _measures(
    case: Case, bead: float, neck: float, v: float, lambda2: float, force: float, potential: float
) -> dict[str, object]:
    """In their units: pressure ``-kappa lambda2 / R^3``, force and energy by length ``kappa / R`` times what they are."""
    tube, nm, newton = case.tube, 1e9 * case.unit, case.rigidity / case.unit
    return {
        "bead[nm]": 2 * bead * nm,
        "neck[nm]": 2 * neck * nm,
        "volume": v / case.reference**2,
        "pressure[Pa]": -lambda2 * newton / case.unit**2,
        "force[pN]": 1e12 * newton * force,
        "energy[pN]": 1e12 * newton * (potential - straight_potential(tube.c0, tube.solute, tube.osmolarity)),
        "excess": case.measured / (2 * bead) - 1,
    }
