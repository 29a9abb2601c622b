"""The paper's flows: Figs. c0f2 (with Table ptab1), cmf2, c05f2 and c1f1 (c).

Shapes are perturbed as eqs. (flp1) and (flp2) say, by the sizes of Table ptab1 where it has them.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from pearlbvp.continuation.solution import Solution
from pearlbvp.flows.driver import FlowOptions
from pearlbvp.flows.record import FlowResult
from pearlbvp.paper.cases import at, primary
from pearlbvp.paper.sheet import Course, Sheet, values_of
from pearlbvp.studies.flow_end import recognized
from pearlbvp.studies.flow_start import FlowStart, solution_start

COARSE = FlowOptions(resolution=1e-3)
"""Details down to a thousandth of a radius, which is what pictures show."""


@cache
def _c0f2() -> dict[str, tuple[Solution[Any], FlowResult, dict[str, float]]]:
    """Sample, flow, and relative changes of area and volume by the perturbation, of the four flows."""
    pearl = at(primary(0.0, 10.0, "pearl", (1, 0), "lambda2", -5.0), "lambda2=-3.165")
    coil = primary(0.0, 10.0, "coil", (1, 1), "lambda2", 1.387).points[-1]
    buckle = primary(0.0, 10.0, "buckle", (1, 1), "lambda2", 1.29).points[-1]
    starts = {
        "A2": (pearl, solution_start(pearl, symmetric=False, size=(20, 6)), "bump", -0.125, None, None),
        "B": (coil, solution_start(coil), "bump", -0.25, 2.5, None),
        "C": (buckle, solution_start(buckle), "bump", -0.25, None, COARSE),
        "C*": (buckle, solution_start(buckle), "critical", 0.3, None, None),
    }
    found = {}
    for name, (sample, start, kind, delta, centre, options) in starts.items():
        q = start.perturbed(kind, delta, centre=centre)  # type: ignore[arg-type]
        found[name] = (sample, start.flow(q, options).uninterrupted(), _changes(start, q))
    return found


def _changes(start: FlowStart, q: Any) -> dict[str, float]:
    """Relative changes of area and volume."""
    kept, now = start.problem.constraints(start.q), start.problem.constraints(q)
    return {"area_change": float(now[0] / kept[0] - 1), "volume_change": float(now[-1] / kept[-1] - 1)}


def _ends(result: FlowResult) -> dict[str, float]:
    """What is printed of an end: multipliers, and whether it is stable."""
    last = result.table().iloc[-1]
    return {"lambda1_end": float(last["lambda1"]), "lambda2_end": float(last["lambda2"]),
            "stable_end": float(result.status == "steady")}  # fmt: skip


def c0f2() -> Sheet:
    """From perturbed pearls, coils and buckles at ``c0 = 0``, ``L = 10``."""
    flows = _c0f2()
    panels = tuple(
        Course(letter, flows[name][1]) for letter, name in (("a", "A2"), ("b", "B"), ("c1", "C"), ("c2", "C*"))
    )
    values = {(name, q): value for name, (_, result, _) in flows.items() for q, value in _ends(result).items()}
    return Sheet(panels, values | _families({name: run[1] for name, run in flows.items()}))


def _families(runs: dict[str, FlowResult]) -> dict[tuple[str, str], float]:
    """``ends_as_FAMILY``: 1 where the end is of it, else 0."""
    names = ("pearl", "ring", "coil", "buckle", "mixed")
    ends = {name: recognized(result.equilibrium).family for name, result in runs.items() if result.equilibrium}
    return {(name, f"ends_as_{family}"): float(end == family) for name, end in ends.items() for family in names}


def ptab1() -> Sheet:
    """Table ptab1: spectra of A2, B and C, what the perturbations change, and where the flows end."""
    flows = _c0f2()
    values = values_of({name: run[0] for name, run in flows.items()})
    for name, (_, result, changes) in flows.items():
        values |= {(name, quantity): value for quantity, value in (changes | _ends(result)).items()}
    return Sheet((), values)


def cmf2() -> Sheet:
    """From perturbed wrinkles, coils and buckles at ``c0 = -1``, ``L = 10``."""
    wrinkles = primary(-1.0, 10.0, "ring", (0, 2), "lambda2", 1.62, discretization="modes").points[-1]
    coil = primary(-1.0, 10.0, "coil", (1, 1), "v", 0.95, discretization="modes").points[-1]
    buckle = primary(-1.0, 10.0, "buckle", (1, 1), "v", 0.975, discretization="modes").points[-1]
    starts = {
        "D2": solution_start(wrinkles, size=(12, 14)),
        "B": solution_start(coil),
        "C": solution_start(buckle),
    }
    runs = {
        name: start.flow(start.perturbed("bump", -0.25, keep=name == "D2"), COARSE).uninterrupted()
        for name, start in starts.items()
    }
    panels = tuple(Course(letter, runs[name]) for letter, name in zip("abc", runs, strict=True))
    return Sheet(panels, _families(runs))


def c05f2() -> Sheet:
    """From two pearls at ``c0 = 0.48``, ``L = 15`` to the localized pearl."""
    branch = primary(0.48, 15.0, "pearl", (2, 0), "v", 1.06)
    sample = at(branch, "v=1.02")
    start = solution_start(sample)
    result = start.flow(start.perturbed("critical", 0.02, keep=True)).uninterrupted()
    return Sheet((Course("a", result),), {("A2", q): value for q, value in _ends(result).items()})


def to_unequal_pearls(sample: Solution[Any]) -> FlowResult:
    """From one pearl at ``c0 = 0.75``, pushed along its unstable vector at its own area and volume."""
    start = solution_start(sample)
    return start.flow(start.perturbed("critical", 0.05, keep=True)).uninterrupted()
