"""A branch in a few lines: what it is of, where it leads, what happens on it, why it ends."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pearlbvp.representation import span
from pearlbvp.units import RADII, Units

if TYPE_CHECKING:
    from pearlbvp.continuation.branch import Branch, BranchPoint, SpecialPoint

MOST_SPECIAL = 14
"""Special points named one by one."""


def described(branch: Branch[Any], units: Units = RADII) -> str:
    """Family, ``c0``, ``L``, number of points, range of ``v``, special points, reason of the end.

    Args:
        branch: of any family.
        units: of the numbers.
    """
    observed = [entry.observables for entry in branch.points]
    words = [f"{family(branch)} branch", f"{len(observed)} point{'s' if len(observed) > 1 else ''}"]
    for name in ("c0", "L", "v"):
        if all(name in found for found in observed):
            words.append(f"{name} = {span([units.to_user(name, found[name]) for found in observed])}")
    within = [special for special in branch.special if special.kind not in ("start", "stop", "end")]
    lines = [", ".join(words), *(f"  {_special(branch, special)}" for special in within[:MOST_SPECIAL])]
    if len(within) > MOST_SPECIAL:
        lines.append(f"  and {len(within) - MOST_SPECIAL} more special points")
    return "\n".join([*lines, f"  end: {units.said(branch.reason)}"])


def family(branch: Branch[Any]) -> str:
    """Of a branch's shapes."""
    return str(getattr(branch.points[-1].point.problem, "family", "nameless"))


def _special(branch: Branch[Any], special: SpecialPoint[Any]) -> str:
    words = [f"point {special.index}: {special.kind}"]
    observed = branch.at(special).observables
    if "v" in observed:
        words.append(f"v = {observed['v']:.8g}")
    if special.block is not None:
        words.append(str(special.block))
    if special.change:
        words.append(f"{special.change:+d} unstable")
    if not special.converged:
        words.append("not located")
    return ", ".join(words)


def described_point(entry: BranchPoint[Any]) -> str:
    """A point of a branch in one line: its numbers and its stability."""
    numbers = [f"{name} = {value:.8g}" for name, value in entry.observables.items()]
    spectrum = entry.spectrum
    if hasattr(spectrum, "n_unstable"):
        numbers.append(f"n_unstable = {spectrum.n_unstable}" if spectrum.complete else "n_unstable unknown")
        numbers.append(f"mu_crit = {spectrum.mu_crit:.6g}")
    return ", ".join(numbers)
