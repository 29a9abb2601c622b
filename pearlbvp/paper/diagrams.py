"""Bifurcation diagrams and samples: Figs. f0 (c), c00f, cmf1, c005f2, c05f1, c05f1l and c1f1.

The paper gives parameters of three samples (Table ptab1); the others lie where the text and the pictures have them, at
the values written here.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import pandas as pd

from pearlbvp.continuation.branch import Branch
from pearlbvp.helfrich import Tube, cylinder_lambda1
from pearlbvp.paper.amplitudes import coefficients_of_coils, coil_and_buckle_panels
from pearlbvp.paper.cases import at, primary, secondary, unequal_pearls
from pearlbvp.paper.flows import to_unequal_pearls
from pearlbvp.paper.sheet import Course, Curves, Panel, Samples, Shapes, Sheet, values_of
from pearlbvp.studies.branch import curve
from pearlbvp.studies.normal_form import normal_forms
from pearlbvp.theory.dispersion import stable_interval

Values = dict[tuple[str, str], float]


def _planes(letter: str, branches: Mapping[str, Branch[Any]], samples: Samples) -> tuple[Curves, ...]:
    """``E`` over ``v``, and one multiplier over the other: of branches that begin at ``lambda2`` below 0, and above."""
    tables = {name: curve(branch) for name, branch in branches.items()}
    planes = [Curves(f"{letter}1", "v", "E", tables, samples)]
    begin = {name: branch.points[0].observables["lambda2"] for name, branch in branches.items()}
    sides = [side for side in (-1, 1) if any(side * start > 0 for start in begin.values())]
    for number, side in enumerate(sides, start=2):
        chosen = {name: table for name, table in tables.items() if side * begin[name] > 0}
        reach = pd.concat(list(chosen.values()))["lambda2"]
        tube = next(iter(branches.values())).points[0].observables
        straight = cylinders(tube["c0"], tube["L"], float(reach.min()), float(reach.max()))
        points = {name: at for name, at in samples.items() if side * at.observables["lambda2"] > 0}
        planes.append(Curves(f"{letter}{number}", "lambda2", "lambda1", chosen | {"cylinders": straight}, points))
    return tuple(planes)


def cylinders(c0: float, length: float, lowest: float, highest: float) -> pd.DataFrame:
    """The straight tube over an interval of pressures (eq. (socon)); ``n_unstable`` is 1 where it is not stable."""
    interval = stable_interval(Tube(c0, length))
    ends = [end for end in (interval.lower, interval.upper) if lowest < end < highest]
    lambda2 = np.unique(np.concatenate((np.linspace(lowest, highest, 41), ends)))
    outside = (lambda2 < interval.lower) | (lambda2 > interval.upper) | (not interval.exists)
    lambda1 = [cylinder_lambda1(value, c0) for value in lambda2]
    return pd.DataFrame({"lambda2": lambda2, "lambda1": lambda1, "n_unstable": outside.astype(int), "special": ""})


def _onsets(branches: Mapping[str, Branch[Any]]) -> Values:
    """Multipliers where branches leave the straight tube."""
    return {(f"onset of {name}", q): branch.points[0].observables[q] for name, branch in branches.items()
            for q in ("lambda1", "lambda2")}  # fmt: skip


def _special(label: str, branch: Branch[Any], place: str) -> Values:
    """``v`` and the multipliers at a special point."""
    return {(label, q): at(branch, place).observables[q] for q in ("v", "lambda1", "lambda2")}


@cache
def c00f() -> Sheet:
    """``c0 = 0``, ``L = 10``: pearls, coils, buckles, wrinkles, and what branches off from wrinkles (E)."""
    wrinkled = (0.0, 10.0, "ring", (0, 2), "v", 0.86)
    wrinkles = primary(*wrinkled)
    branches = {
        "pearls": primary(0.0, 10.0, "pearl", (1, 0), "lambda2", -5.0),
        "coils": primary(0.0, 10.0, "coil", (1, 1), "v", 0.86),
        "buckles": primary(0.0, 10.0, "buckle", (1, 1), "v", 0.88),
        "wrinkles": wrinkles,
        "wrinkles that buckle": secondary(3, 0.86, *wrinkled),
    }
    samples = {
        "A1": at(branches["pearls"], "v=1.02"),
        "A2": at(branches["pearls"], "lambda2=-3.165"),
        "B": at(branches["coils"], "lambda2=1.387"),
        "C": at(branches["buckles"], "lambda2=1.29"),
        "D": at(wrinkles, "v=0.95"),
        "E": branches["wrinkles that buckle"].points[-1],
    }
    panels: tuple[Panel, ...] = (*_planes("a", branches, samples), Shapes("b", samples))
    return Sheet(panels, values_of(samples) | _onsets(branches), samples)


def f0() -> Sheet:
    """Four shapes of ``c0 = 0``, ``L = 10``, those of Fig. c00f."""
    samples = {name: c00f().samples[given] for name, given in zip("ABCD", ("A2", "B", "C", "D"), strict=True)}
    return Sheet((Shapes("c", samples),), {}, samples)


def cmf1() -> Sheet:
    """``c0 = -1``, ``L = 10``: wrinkles first, and oblates embedded in them (E)."""
    wrinkled = (-1.0, 10.0, "ring", (0, 2), "v", 0.8)
    wrinkles = primary(*wrinkled)
    branches = {
        "pearls": primary(-1.0, 10.0, "pearl", (1, 0), "lambda2", -5.0),
        "coils": primary(-1.0, 10.0, "coil", (1, 1), "v", 0.9),
        "buckles": primary(-1.0, 10.0, "buckle", (1, 1), "v", 0.95),
        "wrinkles": wrinkles,
        "oblates in wrinkles": secondary(1, 0.85, *wrinkled),
    }
    samples = {
        "A": at(branches["pearls"], "lambda2=-3.5"),
        "B": at(branches["coils"], "v=0.95"),
        "C": at(branches["buckles"], "v=0.975"),
        "D1": at(wrinkles, "lambda2=1.55"),
        "D2": at(wrinkles, "lambda2=1.62"),
        "E": branches["oblates in wrinkles"].points[-1],
    }
    values = values_of(samples) | _onsets(branches) | _special("first branch point of wrinkles", wrinkles, "bp:1")
    return Sheet((*_planes("a", branches, samples), Shapes("b", samples)), values, samples)


def c005f2() -> Sheet:
    """``c0 = 0.48``, ``L = 10``: coils and buckles exchange stability along a branch between them (C)."""
    coiled = (0.48, 10.0, "coil", (1, 1), "v", 0.85)
    coils = primary(*coiled)
    branches = {
        "coils": coils,
        "buckles": primary(0.48, 10.0, "buckle", (1, 1), "v", 0.89),
        "between": secondary(1, None, *coiled),
    }
    samples = {
        "A": at(coils, "v=0.88"),
        "B": at(branches["buckles"], "v=0.95"),
        "C": branches["between"].points[2],
    }
    near = {"coils at onset": coils.points[1], "buckles at onset": branches["buckles"].points[1]}
    between_stable = float(all(p.spectrum.n_unstable == 0 for p in branches["between"].points[1:-1]))
    values = values_of(samples) | values_of(near) | coefficients_of_coils(0.48, 10.0)
    values |= {("between", "stable"): between_stable, ("coils", "folds_in_lambda2"): len(coils.find("fold:lambda2"))}
    values |= {("buckles", "folds_in_lambda2"): len(branches["buckles"].find("fold:lambda2"))}
    panels: tuple[Panel, ...] = (
        *_planes("a", branches, samples),
        Shapes("b", samples),
        *coil_and_buckle_panels("d", 0.48, 10.0, 0.95),
    )
    return Sheet(panels, values, samples)


def c05f1() -> Sheet:
    """``c0 = 0.48``, ``L = 15``: two pearls (A), the localized pearl (B), one pearl (C), coils (D, F) and buckles (E)."""
    pearled = (0.48, 15.0, "pearl", (2, 0), "v", 1.06)
    two = primary(*pearled)
    branches = {
        "two pearls": two,
        "localized pearl": secondary(1, 1.1, *pearled),
        "one pearl": primary(0.48, 15.0, "pearl", (1, 0), "v", 1.1),
        "coils": primary(0.48, 15.0, "coil", (1, 1), "v", 0.85),
        "buckles": primary(0.48, 15.0, "buckle", (1, 1), "v", 0.88),
        "coils of two turns": primary(0.48, 15.0, "coil", (2, 1), "v", 0.9),
    }
    samples = {
        "A1": at(two, "v=1.005"),
        "A2": at(two, "v=1.04"),
        "B": at(branches["localized pearl"], "v=1.04"),
        "C": at(branches["one pearl"], "v=1.04"),
        "D": at(branches["coils"], "v=0.92"),
        "E": at(branches["buckles"], "v=0.92"),
        "F": at(branches["coils of two turns"], "v=0.95"),
    }
    values = values_of(samples) | _onsets(branches) | _special("first branch point of two pearls", two, "bp:1")
    values[("one pearl", "stable")] = float(any(p.spectrum.n_unstable == 0 for p in branches["one pearl"].points))
    onset = normal_forms(two).iloc[0]
    values[("localized pearl", "supercritical")] = float(onset["criticality"] == "supercritical")
    return Sheet((*_planes("a", branches, samples), Shapes("c", samples)), values, samples)


def c05f1l() -> Sheet:
    """``c0 = 0.48``, ``L = 30``: four pearls (A), the localized pearl (B), two, three and one pearls, coils (F)."""
    pearled = (0.48, 30.0, "pearl", (4, 0), "v", 1.04)
    four = primary(*pearled)
    branches = {
        "four pearls": four,
        "localized pearl": secondary(1, 1.1, *pearled),
        "two pearls": primary(0.48, 30.0, "pearl", (2, 0), "v", 1.1),
        "one pearl": primary(0.48, 30.0, "pearl", (1, 0), "v", 1.1),
        "three pearls": primary(0.48, 30.0, "pearl", (3, 0), "v", 1.1),
        "coils": primary(0.48, 30.0, "coil", (1, 1), "v", 0.9),
    }
    samples = {
        "A": at(four, "v=1.02"),
        "B": at(branches["localized pearl"], "v=1.05"),
        "C": at(branches["two pearls"], "v=1.05"),
        "D": at(branches["one pearl"], "v=1.05"),
        "E": at(branches["three pearls"], "v=1.05"),
        "F": at(branches["coils"], "v=0.95"),
    }
    values = values_of(samples) | _onsets(branches)
    values[("one pearl", "branch_points")] = len(branches["one pearl"].find("bp"))
    return Sheet((_planes("a", branches, samples)[0], Shapes("b", samples)), values, samples)


def c1f1() -> Sheet:
    """``c0 = 0.75``, ``L = 10``: one pearl (A) with two folds, two equal (C), two unequal pearls (P), the flow to them."""
    branches = {
        "one pearl (A)": primary(0.75, 10.0, "pearl", (1, 0), "lambda2", -5.0),
        "two unequal pearls (P)": unequal_pearls(),
        "two equal pearls (C)": primary(0.75, 10.0, "pearl", (2, 0), "lambda2", -4.0),
    }
    one, unequal = branches["one pearl (A)"], branches["two unequal pearls (P)"]
    samples = {
        "A1": at(one, "lambda2=-0.52"),
        "A2": at(one, "lambda2=-1.5"),
        "A3": at(one, "lambda2=-4.5"),
        "P1": at(unequal, "v=0.98"),
        "P2": at(unequal, "v=1.03"),
        "P3": at(unequal, "v=1.1"),
        "C": at(branches["two equal pearls (C)"], "lambda2=-3"),
    }
    values = values_of(samples)
    for number in (1, 2):
        values |= _special(f"fold {number} of A", one, f"fold:v:{number}")
    stable = [
        any(p.spectrum.n_unstable == 0 for p in branches[name].points)
        for name in ("one pearl (A)", "two equal pearls (C)")
    ]
    values |= {("A", "stable"): float(stable[0]), ("C anywhere", "stable"): float(stable[1])}
    first, last = {n: samples[n] for n in ("A1", "A2", "A3")}, {n: samples[n] for n in ("P1", "P2", "P3", "C")}
    course = to_unequal_pearls(samples["A1"])
    panels: tuple[Panel, ...] = (
        *_planes("a", branches, samples),
        Shapes("b", first),
        Course("c", course),
        Shapes("d", last),
    )
    return Sheet(panels, values, samples)
