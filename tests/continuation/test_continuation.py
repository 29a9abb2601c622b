"""Path following and Chebyshev resolution on algebraic curves that are known exactly: nothing of membranes here."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from support.curves import Curve

from pearlbvp.continuation import PathOptions, follow
from pearlbvp.continuation.branch import Status
from pearlbvp.continuation.chebyshev import Unresolved, in_pieces, resolve, series
from pearlbvp.continuation.following import BranchOptions, continue_branch
from pearlbvp.continuation.solution import Solution
from pearlbvp.errors import SpectrumError

CIRCLE = Curve(lambda x, y: x**2 + y**2 - 1, lambda x, y: np.array([2 * x, 2 * y]))
PITCHFORK = Curve(lambda x, y: x * (y - x**2), lambda x, y: np.array([y - 3 * x**2, x]))


def start(problem, u, tangent):
    u = np.array(u, dtype=float)
    return Solution(problem, u, np.array(tangent, dtype=float))


def test_circle_is_followed_through_both_folds():
    first = start(CIRCLE, [1, 0], [0, 1])
    path = follow(
        first, PathOptions(step=0.1, max_step=0.3), lambda p: "round" if 0 > p.u[1] > -0.9 and p.u[0] > 0 else None
    )
    assert path.complete
    angles = np.unwrap([math.atan2(p.u[1], p.u[0]) for p in path.points])
    assert (np.diff(angles) > 0).all()
    assert angles[-1] > 1.5 * math.pi
    assert max(abs(p.u @ p.u - 1) for p in path.points) < 1e-12
    # Steps may grow to 0.3 but no tangent may turn by more than 30 degrees.
    assert np.diff(angles).max() < math.radians(30) + 1e-6


def test_branch_of_a_pitchfork_is_left_along_its_tangent():
    path = follow(start(PITCHFORK, [0, 0], [1, 0]), PathOptions(step=0.1), lambda p: "far" if p.u[1] > 0.5 else None)
    assert path.complete
    assert all(p.u[1] == pytest.approx(p.u[0] ** 2, abs=1e-12) for p in path.points)


def test_a_path_that_ends_says_why():
    cusp = Curve(lambda x, y: y**2 - x**3 - 1e-14, lambda x, y: np.array([-3 * x**2, 2 * y]))
    path = follow(
        start(cusp, [1, 1], np.array([-2, -3]) / math.sqrt(13)), PathOptions(step=0.1, min_step=1e-3), lambda p: None
    )
    assert not path.complete
    assert "min_step" in path.reason


class Unknown(Curve):
    """A circle on whose upper part stability cannot be known."""

    def spectrum(self, u):
        if u[1] > 0.8:
            raise SpectrumError("its stability would take too many modes")
        return super().spectrum(u)


def test_a_branch_ends_where_its_stability_cannot_be_known_not_a_long_step_before():
    first = start(Unknown(CIRCLE.f, CIRCLE.gradient), [0, -1], [1, 0])
    options = BranchOptions(PathOptions(step=0.1, max_step=0.5), folds=())
    branch = continue_branch(first, options)
    assert (branch.status, branch.reason) == (Status.FAILED, "its stability would take too many modes")
    assert 0 < math.asin(0.8) - math.asin(branch.points[-1].u[1]) < 0.2
    assert len(branch.points) < 14


@dataclass(frozen=True)
class Touching(Curve):
    """A circle whose solutions pass through themselves on its upper part, as far as is known."""

    exactly: bool

    def clearance(self, u):
        beyond = u[1] - 0.8
        return -beyond if self.exactly else -math.inf if beyond > 0 else math.inf


@pytest.mark.parametrize(("exactly", "farthest"), [(True, 1e-12), (False, 0.2)])
def test_a_branch_ends_where_its_surface_touches_itself(exactly, farthest):
    first = start(Touching(CIRCLE.f, CIRCLE.gradient, exactly), [0, -1], [1, 0])
    branch = continue_branch(first, BranchOptions(PathOptions(step=0.1, max_step=0.5), folds=()))
    assert branch.status is Status.CONTACT
    assert -1e-12 < math.asin(0.8) - math.asin(branch.points[-1].u[1]) < farthest
    assert [special.kind for special in branch.special] == ["start", "end"]


def test_max_points_is_a_reason_too():
    path = follow(start(CIRCLE, [1, 0], [0, 1]), PathOptions(max_points=5), lambda p: None)
    assert (len(path.points), path.complete) == (5, False)
    assert "max_points" in path.reason


def test_functions_along_the_circle_are_resolved_to_rounding():
    path = follow(
        start(CIRCLE, [1, 0], [0, 1]), PathOptions(step=0.1, max_step=0.3), lambda p: "far" if p.u[0] < -0.9 else None
    )
    functions = resolve(path.points, lambda problem, u: np.array([u[0], u[1], math.atan2(u[1], u[0])]), tolerance=1e-12)
    (x,) = functions.crossings(0)  # the circle's top
    np.testing.assert_allclose(functions(np.array([x]))[0], [0, 1, math.pi / 2], atol=1e-11)
    (x,) = functions.crossings(1, derivative=1)
    np.testing.assert_allclose(functions(np.array([x]))[0, 1], 1, atol=1e-11)
    samples = functions(np.linspace(0, len(functions.coefficients), 301))
    np.testing.assert_allclose(samples[:, 0] ** 2 + samples[:, 1] ** 2, 1, atol=1e-10)


def test_at_a_pitchfork_even_functions_are_polynomials_of_the_square():
    path = follow(start(PITCHFORK, [0, 0], [1, 0]), PathOptions(step=0.1), lambda p: "far" if p.u[1] > 0.5 else None)
    functions = resolve(path.points, lambda problem, u: np.array([u[1], u[0] ** 4]), pitchfork=True)
    assert functions.solutions == 9
    (x,) = functions.crossings(0, 0.3)
    np.testing.assert_allclose(functions(np.array([x]))[0], [0.3, 0.09], atol=1e-14)
    assert functions.crossings(0, 7.0).size == 0
    first, never = functions.first_crossings(0, np.array([0.3, 7.0]))
    assert first == pytest.approx(x, abs=1e-14)
    assert np.isnan(never)


def test_the_first_of_several_crossings_lies_before_the_first_turn():
    """Around the circle from the right: ``x = cos s`` falls through a level, comes back, and passes it again."""
    path = follow(start(CIRCLE, [1, 0], [0, 1]), PathOptions(step=0.3, max_step=0.3, max_points=30), lambda p: None)
    functions = resolve(path.points, lambda problem, u: u.copy())
    levels = np.array([0.9, 0.2, -0.7])
    np.testing.assert_allclose(functions(functions.first_crossings(0, levels))[:, 0], levels, atol=1e-12)
    assert (functions(functions.first_crossings(0, levels))[:, 1] > 0).all()  # on the upper half, passed first
    assert all(len(functions.crossings(0, level)) > 1 for level in levels)
    many = np.concatenate((np.linspace(-0.999, 0.999, 200), [2.0]))  # also beside the turns; the last is nowhere
    each = [min(functions.crossings(0, level), default=np.nan) for level in many]
    np.testing.assert_allclose(functions.first_crossings(0, many), each, atol=1e-10)


def test_a_kink_between_two_points_is_unresolved():
    path = follow(
        start(CIRCLE, [1, 0], [0, 1]), PathOptions(step=0.3, max_step=0.3), lambda p: "far" if p.u[0] < 0.5 else None
    )
    with pytest.raises(Unresolved, match="shorter steps"):
        resolve(path.points, lambda problem, u: np.array([abs(u[1] - 0.2)]))


def test_steps_must_be_ordered():
    with pytest.raises(ValueError, match="min_step"):
        PathOptions(step=1.0, max_step=0.1)


def test_an_interval_is_halved_until_what_is_not_smooth_lies_in_no_piece():
    def resolved(low, high):
        coefficients, error, _ = series(lambda t: np.array([abs(low + t * (high - low) - 0.3)]), 1e-12, 4, 8)
        if error > 1e-12:
            raise Unresolved("a kink")
        return low, high, coefficients

    wanted = np.linspace(0, 1, 200)
    pieces = in_pieces(resolved, 0.0, 1.0, wanted, 10)
    assert not any(low < 0.3 < high for low, high, _ in pieces)
    assert sum(high - low for low, high, _ in pieces) > 0.9
    for low, high, coefficients in pieces:
        x = np.linspace(low, high, 5)
        y = (2 * x - low - high) / (high - low)
        np.testing.assert_allclose(np.polynomial.chebyshev.chebval(y, coefficients[:, 0]), abs(x - 0.3), atol=1e-14)
