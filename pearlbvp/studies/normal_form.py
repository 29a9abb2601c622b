"""How do branches leave a branch point: on which side, how fast, stable or not? Normal forms of secondary branch points.

At fixed area and volume the amplitude ``y`` of the new wave obeys ``dy/dt = y (rate (v - v_0) + cubic y^2)``. ``rate`` is the
derivative of the neutral growth rate by ``v`` along the branch; ``cubic = -rate v_2`` where ``v = v_0 + v_2 y^2`` along the new
one, because both vanish there together. Its own perturbation then has the growth rate ``-2 rate (v - v_0)``.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from pearlbvp.continuation.branch import Branch, SpecialPoint
from pearlbvp.continuation.normal_form import NormalForm, at_zero, normal_form
from pearlbvp.continuation.path import correct
from pearlbvp.newton import NewtonOptions
from pearlbvp.studies.branch import known_branch
from pearlbvp.studies.onward import Centre

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ["number", "point", "block", "lambda2", "v", "form", "rate", "cubic", "criticality", "lambda1_2", "lambda2_2",
           "v_2", "E_2", "message"]  # fmt: skip


def form_at(branch: Branch[Any], special: SpecialPoint, centre: Centre = "pearl") -> NormalForm:
    """The normal form of a branch point, in the space in which the new branch lives.

    Args:
        branch: of any family.
        special: one of its branch points.
        centre: of pearls, where the new branch is centred, as ``switched`` takes it.

    Raises:
        ValueError: the point was not located, or its wave is not axisymmetric.
    """
    if special.kind != "bp" or not special.converged:
        raise ValueError(f"special: {special.kind} at point {special.index} is no located branch point")
    point = branch.at(special)
    problem, (u, tangent) = point.problem.lift(special.block, centre, point.u, point.tangent)
    breaks = special.block != point.problem.trivial_block
    return normal_form(problem, u, tangent, symmetric=breaks)


def rate_by_volume(branch: Branch[Any], special: SpecialPoint) -> float:
    """Derivative of the neutral growth rate of a branch point by the reduced volume, along the branch."""
    entry = branch.at(special)
    problem, u, tangent = entry.problem, entry.u, entry.tangent
    place = int(np.abs(problem.block_rates(u, special.block, entry.spectrum)).argmin())

    def beside(s: float) -> tuple[float, float]:
        there, _ = correct(problem, u + s * tangent, tangent, u, s, NewtonOptions())
        rate = problem.block_rates(there.u, special.block, entry.spectrum)[place]
        return float(rate), problem.observables(there.u)["v"]

    def slopes(h: float) -> np.ndarray:
        ahead, behind = beside(h), beside(-h)
        return np.array([(a - b) / (2 * h) for a, b in zip(ahead, behind, strict=True)])

    by_rate, by_v = at_zero(slopes)
    return float(by_rate / by_v)


def normal_forms(branch: Branch[Any]) -> pd.DataFrame:
    """The normal forms of all branch points of a branch.

    Returns:
        A row a branch point: ``number``, ``point``, ``block``, ``lambda2, v``; ``form`` (``pitchfork`` or ``transcritical``;
        empty, with the reason in ``message``, where there is none); ``rate`` and ``cubic`` of the reduced equation and its
        ``criticality``, amplitudes measured in the problem's inner product; ``lambda1_2, lambda2_2, v_2, E_2``: changes of the
        observables by the amplitude's square.
    """
    import pandas as pd

    rows = []
    for number, special in enumerate(known_branch(branch).find("bp"), start=1):
        observed = branch.at(special).observables
        row: dict[str, Any] = dict.fromkeys(COLUMNS, math.nan) | {
            "number": number, "point": special.index, "block": str(special.block), "form": "", "criticality": "",
            "lambda2": observed["lambda2"], "v": observed["v"], "message": "",
        }  # fmt: skip
        rows.append(row)
        try:
            form = form_at(branch, special)
        except ValueError as error:
            row["message"] = str(error)
            continue
        row["form"] = "pitchfork" if form.pitchfork else "transcritical"
        row |= {f"{name}_2": value for name, value in form.quadratic.items()}
        if form.pitchfork and special.block != branch.at(special).problem.trivial_block:
            row["rate"] = rate_by_volume(branch, special)
            row["cubic"] = -row["rate"] * row["v_2"]
            row["criticality"] = "supercritical" if row["cubic"] < 0 else "subcritical"
    return pd.DataFrame(rows, columns=COLUMNS)
