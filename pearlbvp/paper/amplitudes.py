"""Amplitude equations beside computed branches: Figs. ampc00f, cmf1b and c005f2 (d)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pearlbvp.continuation.branch import Branch
from pearlbvp.helfrich import Tube, WaveNumbers
from pearlbvp.paper.cases import primary
from pearlbvp.paper.sheet import Curves, Sheet
from pearlbvp.studies.amplitude import predicted_branch
from pearlbvp.studies.branch import curve
from pearlbvp.theory.amplitude import Family, amplitude_equation

PLANES = (("v", "wave"), ("lambda2", "wave"), ("lambda2", "lambda1"))
"""What the paper draws: amplitude over volume and over pressure, and one multiplier over the other."""


def panels(letter: str, mode: WaveNumbers, branches: Mapping[Family, Branch[Any]]) -> tuple[Curves, ...]:
    """Computed branches of a mode with what the amplitude equation predicts, in the three planes."""
    computed = {family: curve(branch) for family, branch in branches.items()}
    predicted = {}
    for family, table in computed.items():
        tube = Tube(float(table["c0"].iloc[0]), float(table["L"].iloc[0]))
        largest = amplitude_equation(tube, mode).amplitude_at(family, float(table["v"].iloc[-1]))
        predicted[family] = predicted_branch(tube.c0, tube.L, mode, family, largest=largest).table()
    known, foretold = {str(f): t for f, t in computed.items()}, {str(f): t for f, t in predicted.items()}
    return tuple(Curves(f"{letter}{i}", x, y, known, {}, foretold) for i, (x, y) in enumerate(PLANES, start=1))


def _coefficients(label: str, tube: Tube, mode: WaveNumbers) -> dict[tuple[str, str], float]:
    """``a``, ``b`` or ``b1, b2``, and ``alpha2`` by ``A^2`` and without it, as the paper writes them.

    ``lambda1 = lambda1(m,n) + alpha2 eps^2`` with ``alpha2 = (coefficient) A^2 - beta2``.
    """
    equation = amplitude_equation(tube, mode)
    beta2 = 1.0 if equation.cubic(equation.preferred) * equation.a < 0 else -1.0
    found = {"a": equation.a, "alpha2_by_A2": equation.alpha2, "alpha2_constant": -beta2}
    found |= {"b": equation.b1} if len(equation.families) == 1 else {"b1": equation.b1, "b2": equation.b2}
    return {(label, name): float(value) for name, value in found.items()}


def ampc00f() -> Sheet:
    """Pearls, coils and buckles at ``c0 = 0``, ``L = 10``."""
    tube, short = Tube(0.0, 10.0), {"max_step": 0.08}
    pearls = primary(0.0, 10.0, "pearl", (1, 0), "v", 1.1, **short)
    others: dict[Family, Branch[Any]] = {
        "coil": primary(0.0, 10.0, "coil", (1, 1), "v", 0.95, **short),
        "buckle": primary(0.0, 10.0, "buckle", (1, 1), "v", 0.95, **short),
    }
    values = _coefficients("pearling", tube, (1, 0)) | _coefficients("wrinkling", tube, (0, 2))
    values |= _coefficients("coils, buckles", tube, (1, 1)) | _coefficients("coils, buckles (5.1)", tube, (1, 1))
    return Sheet((*panels("a", (1, 0), {"pearl": pearls}), *panels("b", (1, 1), others)), values)


def cmf1b() -> Sheet:
    """Wrinkles at ``c0 = -1``, ``L = 10``."""
    rings = primary(-1.0, 10.0, "ring", (0, 2), "v", 0.95, max_step=0.06)
    return Sheet(panels("", (0, 2), {"ring": rings}), _coefficients("wrinkling", Tube(-1.0, 10.0), (0, 2)))


def coil_and_buckle_panels(letter: str, c0: float, length: float, v: float) -> tuple[Curves, ...]:
    """Coils and buckles of one turn beside their amplitude equations, to a volume."""
    branches: dict[Family, Branch[Any]] = {
        "coil": primary(c0, length, "coil", (1, 1), "v", v, max_step=0.06),
        "buckle": primary(c0, length, "buckle", (1, 1), "v", v, max_step=0.06),
    }
    return panels(letter, (1, 1), branches)


def coefficients_of_coils(c0: float, length: float) -> dict[tuple[str, str], float]:
    """Coefficients of eq. (ampsys) of a tube."""
    return _coefficients("coils, buckles", Tube(c0, length), (1, 1))
