"""How fast does a single wave on pearls grow, of any length along the tube, whether or not it fits?"""

from __future__ import annotations

from typing import Any

from pearlbvp.arrays import Array
from pearlbvp.continuation.solution import Solution
from pearlbvp.errors import InputError
from pearlbvp.helfrich import finite, whole
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.stability.bloch import SecondVariation
from pearlbvp.studies.branch import known_point


def growth_rates(point: Solution[Any], n: int, theta: float) -> Array:
    """Growth rates of the perturbations ``e^{i n phi} e^{i theta x/period}`` of pearls, largest first.

    Perturbations are resolved as finely as in the point's own spectrum, and the same is held; rigid motions are not left out.

    Args:
        point: of a branch of pearls.
        n: waves around the tube.
        theta: phase a period, in radians.

    Raises:
        InputError: an argument that cannot be used, or a point of another family.
    """
    problem = known_point(point).problem
    if not isinstance(problem, PearlProblem):
        what = f"a {problem.family} is not made of equal periods along the axis, as pearls are"
        raise InputError("point", what, "its spectrum has the waves that fit it")
    variation = SecondVariation.of(problem.profile(point.u), point.spectrum.points)
    return variation.growth_rates(whole("n", n, 0), finite("theta", theta), held=problem.held)
