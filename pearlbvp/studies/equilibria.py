"""Equilibria of tubes at a given tension with solute in them, a row each, in physical units."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from typing import get_args

import numpy as np
import pandas as pd

from pearlbvp.continuation.path import PathEnd
from pearlbvp.errors import Interruption, SpectrumError
from pearlbvp.helfrich import choice, whole
from pearlbvp.messages import say
from pearlbvp.progress import progress as progress_bar
from pearlbvp.scale import Convention
from pearlbvp.studies.cases import Case, cases_of, read_cases
from pearlbvp.studies.osmotic import Pearl, pearls_of_periods
from pearlbvp.studies.parallel import in_processes
from pearlbvp.theory.osmotic import straight_potential, straight_size, straight_unstable

RESULTS = ["status", "equilibria", "pearls", "bead[nm]", "neck[nm]", "volume", "pressure[Pa]", "force[pN]", "energy[pN]",
           "n_unstable", "critical", "excess", "straight[nm]", "straight_unstable", "stable_spacings[nm]",
           "best_spacing[nm]", "best_bead[nm]", "message"]  # fmt: skip


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
            length[nm]`` (of the whole tube), and ``radius[nm]`` or ``C0[1/nm]``; where they are, ``spacing[nm]`` of the
            pearls, ``measured[nm]`` (diameter of their beads), ``temperature[K]`` (310 unless given) and ``dilution`` (1).
            Any unit of these quantities will do. ``C0`` is that of ``(2H - C0)^2``, ``c0`` that of ``(H - c0)^2``.
        convention: of ``kappa``: ``physicists``, ``kappa/2 (2H - C0)^2``, or ``mem3dg``, ``kappa (H - c0)^2``.
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

    Examples:
        >>> import pearlbvp as pb
        >>> table = pb.equilibria("data/axon_pearls.csv", convention="mem3dg")
    """
    choice("convention", convention, get_args(Convention))
    processes = None if processes is None else whole("processes", processes)
    table = cases if isinstance(cases, pd.DataFrame) else read_cases(cases)
    todo = list(cases_of(table, convention))
    rows: list[dict[str, object]] = []
    stopped = Interruption()
    with progress_bar("case", len(todo), shown=progress) as bar:
        with stopped:
            for row in in_processes(equilibrium_row, todo, processes, fewest=16):
                rows.append(row)
                bar.update()
        if stopped.happened:
            say(f"interrupted: {len(rows)} of {len(todo)} rows are done and kept", begin="")
    found = pd.DataFrame(rows, columns=RESULTS, index=table.index[: len(rows)])
    whole_numbers = {name: "Int64" for name in ("equilibria", "pearls", "n_unstable", "straight_unstable")}
    return table.iloc[: len(rows)].join(found.astype(whole_numbers))


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
