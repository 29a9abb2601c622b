"""Branches over the whole range of tubes, seeded, and what must be true of each: a right answer, or an end with its reason."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from pearlbvp.continuation.branch import Branch
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.diagram import Diagram, diagram
from pearlbvp.theory.dispersion import growth_rate

FAMILIES = ("pearl", "ring", "coil", "buckle")


@dataclass(frozen=True)
class Case:
    """A branch to follow for some points.

    Attributes:
        family: of the branch.
        c0, length: of the tube.
        m, n: the mode that it leaves the straight tube in.
        max_step: the longest step.
        max_points: where it stops at the latest.
    """

    family: str
    c0: float
    length: float
    m: int
    n: int
    max_step: float
    max_points: int = 10

    def follow(self) -> Branch[Any]:
        """The branch."""
        options = branch_options(max_points=self.max_points, max_step=self.max_step)
        if self.family == "pearl":
            return family_branch(Tube(self.c0, self.length), "pearl", (self.m, 0), options)
        if self.family == "ring":
            return family_branch(Tube(self.c0, self.length), "ring", (0, self.n), options)
        return family_branch(Tube(self.c0, self.length), self.family, (self.m, self.n), options, discretization="modes")  # type: ignore[arg-type]


def drawn(seed: int, max_points: int = 10) -> Case:
    """A case: lengths 0.3 to 300, c0 from -50 to 50, half of them within 2, modes to 40."""
    rng = np.random.default_rng(seed)

    def spread(low: float, high: float) -> float:
        return float(math.exp(rng.uniform(math.log(low), math.log(high))))

    family = FAMILIES[rng.integers(4)]
    c0 = float(rng.uniform(-2, 2)) if rng.random() < 0.5 else float(rng.choice((-1, 1))) * spread(0.1, 50)
    length, max_step = spread(0.3, 300), spread(0.05, 3)
    m = 0 if family == "ring" else round(spread(1, 40))
    n = {
        "pearl": 0,
        "ring": round(spread(2, 40)),
        "coil": 1,
        "buckle": 1 if rng.random() < 0.6 else round(spread(1, 40)),
    }
    return Case(family, round(c0, 5), round(length, 5), m, n[family], round(max_step, 3), max_points)


def unstable_on_the_cylinder(case: Case, lambda2: float) -> int:
    """Waves that grow on the straight tube, counted in closed form; the neutral ones are not."""
    largest = math.sqrt(3 + 2 * abs(lambda2) + 2 * abs(1 - 2 * case.c0)) + 1
    m = np.arange(math.ceil(largest * case.length / (2 * math.pi)) + 2)
    n = np.arange(math.ceil(largest) + 2)
    k = 2 * math.pi * m[:, None] / case.length
    mu = growth_rate(k, n[None, :], lambda2, case.c0)
    size = (k**2 + n[None, :] ** 2 + 1) ** 2 + abs(lambda2) * (k**2 + n[None, :] ** 2)
    multiplicity = np.where(m[:, None] > 0, 2, 1) * np.where(n[None, :] > 0, 2, 1)
    multiplicity[0, 0] = 0  # keeps neither area nor volume
    return int(multiplicity[mu > 1e-11 * size].sum())


def faults(case: Case) -> tuple[list[str], Branch[Any] | None]:
    """What is wrong with the branch of a case (nothing, or sentences), and the branch."""
    try:
        branch = case.follow()
    except InputError as refusal:
        return ([] if str(refusal).count("\n") == 0 and ";" in str(refusal) else [f"refused badly: {refusal}"]), None
    found = []
    if not branch.reason or "\n" in branch.reason:
        found.append(f"ends with the reason {branch.reason!r}")
    start = branch.points[0]
    if start.spectrum.complete:
        expected = unstable_on_the_cylinder(case, start.observables["lambda2"])
        if start.spectrum.n_unstable != expected:
            found.append(f"{start.spectrum.n_unstable} unstable directions at the start, {expected} in closed form")
    return found + unlike_the_work(branch), branch


def unlike_the_work(branch: Branch[Any]) -> list[str]:
    """Where the energy along a branch changes otherwise than by ``-lambda2 dv/2``."""
    found = []
    for before, after in zip(branch.points[:-1], branch.points[1:], strict=True):
        error, allowed = work(before, after)
        # Growth rates are known about as well as the solutions that they are of.
        allowed += max(before.spectrum.residual, after.spectrum.residual)
        if not error <= allowed:
            found.append(f"E changes by {error:.1e} more than -lambda2 dv/2, where {allowed:.1e} is allowed")
    return found


def drawn_diagram(seed: int) -> tuple[Diagram, int]:
    """All branches of two modes of a tube to a depth, for some points, and the depth: c0 from -2 to 1.5, lengths 3 to 40."""
    rng = np.random.default_rng((17, seed))
    c0, length, depth = round(float(rng.uniform(-2, 1.5)), 3), round(float(rng.uniform(3, 40)), 2), int(rng.integers(2))
    modes = [(1, 0), (2, 0), (1, 1), (0, 2), (0, 3), (2, 1), (1, 2), (3, 0)]
    chosen = [modes[i] for i in rng.choice(len(modes), 2, replace=False)]
    options = branch_options(max_points=5, max_step=float(rng.choice([0.2, 0.5, 1.0])))
    return diagram(c0, length, depth, options, modes=chosen, processes=1), depth


def faults_of_diagram(found: Diagram, depth: int) -> list[str]:
    """What is wrong with a diagram: branches that begin off their parents, or are neither followed nor said to be skipped."""
    faults = [f"{name}: {fault}" for name, branch in found.branches.items() for fault in unlike_the_work(branch)]
    told = {**found.skipped, **{name: branch.reason for name, branch in found.branches.items()}}
    faults += [f"{name} ends with the reason {why!r}" for name, why in told.items() if not why or "\n" in why]
    faults += [f"{name} is followed and skipped" for name in found.skipped if name in found.branches]
    faults += [f"{name} is a twin of none" for name, other in found.twins.items() if other not in found.branches]
    for name, branch in found.branches.items():
        if name.count("/") < depth:
            children = {f"{name}/{number + 1}" for number in range(len(branch.find("bp")))}
            faults += [f"{child} is neither followed nor skipped" for child in children - told.keys()]
        parent, _, number = name.rpartition("/")
        if not parent:
            continue
        leaves = found.branches[parent]
        there = leaves.at(leaves.find("bp")[int(number.split()[0]) - 1])
        for column in ("v", "E", "lambda2", "r_max"):
            gap = abs(there.value(column) - branch.points[0].value(column))
            if gap > 1e-7 * (1 + abs(there.value(column))):
                faults.append(f"{name} begins off its parent: {column} by {gap:.1e}")
    return faults


def work(before: Any, after: Any) -> tuple[float, float]:
    """By how much ``E`` changes otherwise than by ``-lambda2 dv/2`` between two points, and how much that may be.

    ``lambda2`` and ``v`` are cubic polynomials of a parameter along the branch, by their values and slopes at both ends. What
    these leave out is a fraction of what straight lines do.
    """
    names = ("lambda2", "v")
    ends = [point.slopes for point in (before, after)]
    if any(not np.isfinite(end[name]) for end in ends for name in names):
        return 0.0, 0.0  # multipliers pass through infinity
    chord = before.problem.transfer(after.problem, after.u) - before.u
    length = math.sqrt(before.problem.inner(chord, chord))
    cubics = []
    for name in names:
        a, b = before.observables[name], after.observables[name]
        da, db = ends[0][name] * length, ends[1][name] * length
        cubics.append(np.polynomial.Polynomial([a, da, 3 * (b - a) - 2 * da - db, 2 * (a - b) + da + db]))
    pressure, volume = cubics
    curved = (pressure * volume.deriv()).integ()(1.0)
    a, b = before.observables, after.observables
    straight = (a["lambda2"] + b["lambda2"]) * (b["v"] - a["v"]) / 2
    size = 1 + abs(a["E"]) + (abs(a["lambda2"]) + abs(b["lambda2"])) * (abs(b["v"] - a["v"]) + 1e-3)
    return abs(b["E"] - a["E"] + curved / 2), 1e-8 * size + 0.3 * abs(curved - straight)
