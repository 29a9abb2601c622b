"""A branch between its points: cubics whose slopes are those of the branch."""

from dataclasses import replace

import numpy as np
import pytest
from support.curves import Curve

from pearlbvp.continuation.branch import Branch, Status
from pearlbvp.continuation.curve import curve, hermite
from pearlbvp.continuation.solution import Solution
from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch

ELLIPSE = Curve(lambda x, y: (x / 2) ** 2 + y**2 - 1, lambda x, y: (x / 2, 2 * y))


def ellipse(count, turned=()):
    """Points of an ellipse with axes 2 and 1, from one end of the longer axis to the other; tangents of some turned round."""
    points = []
    for i, t in enumerate(np.linspace(0, np.pi, count)):
        sign = -1.0 if i in turned else 1.0
        points.append(Solution.along(ELLIPSE, np.array([2 * np.cos(t), np.sin(t)]), sign * np.array([-2 * np.sin(t), np.cos(t)])))  # fmt: skip
    return Branch(points, [], Status.GIVEN, "")


def off(branch):
    """Largest distance of the curve from the ellipse, to leading order."""
    rows = curve(branch)
    x, y = rows["x"].to_numpy(), rows["y"].to_numpy()
    return np.abs(ELLIPSE.f(x, y) / np.hypot(x / 2, 2 * y)).max()


def test_the_error_is_of_the_fourth_order_in_the_step():
    errors = np.array([off(ellipse(count)) for count in (17, 33, 65)])
    np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), 4, atol=0.35)
    assert errors[0] < 3e-4


def test_six_points_of_a_circle_make_a_circle_to_the_error_of_one_cubic():
    """A quarter's cubic with tangents of length ``pi/2`` is off by 1.5e-2 of the radius; a sixth of half a circle's by 3e-5."""
    circle = Curve(lambda x, y: (x**2 + y**2 - 1) / 2, lambda x, y: (x, y))
    points = [Solution.along(circle, np.array([np.cos(t), np.sin(t)]), np.array([-np.sin(t), np.cos(t)])) for t in np.linspace(0, np.pi, 6)]  # fmt: skip
    found = hermite(Branch(points, [], Status.GIVEN, ""))
    np.testing.assert_allclose(
        np.hypot(found.leaving["x"], found.leaving["y"]), np.pi / 5, rtol=1e-9
    )  # the arc's own length
    rows = curve(Branch(points, [], Status.GIVEN, ""), 64)
    chord, middle = np.cos(np.pi / 10), rows.iloc[32]
    # at the middle: both ends' mean and an eighth of the tangents' difference (the cubic's value at 1/2)
    assert np.hypot(middle["x"], middle["y"]) == pytest.approx(chord + np.pi / 5 * np.sin(np.pi / 10) / 4, rel=1e-9)
    assert np.abs(np.hypot(rows["x"], rows["y"]) - 1).max() < 5e-4


def test_tangents_that_lead_backwards_say_the_same():
    np.testing.assert_allclose(
        curve(ellipse(9, turned=(0, 3, 8)))[["x", "y"]], curve(ellipse(9))[["x", "y"]], atol=1e-12
    )


def test_a_branch_of_pearls_between_its_points_is_what_smaller_steps_compute():
    tube = Tube(0.48, 15)
    fine, *coarse = (
        family_branch(tube, "pearl", (2, 0), branch_options({"v": 1.05}, step=h, max_step=h)) for h in (0.05, 0.2, 0.1)
    )
    exact = fine.table().query("v > 1.01")
    for name, most in (("lambda1", 2e-5), ("E", 5e-7)):
        errors = []
        for branch in coarse:
            rows = curve(branch, 1500)
            errors.append(np.abs(np.interp(exact["v"], rows["v"], rows[name]) - exact[name]).max())
        assert errors[0] < most
        assert errors[1] < errors[0] / 8, (name, errors)  # 16 for small steps
    slopes = hermite(coarse[0])  # -2 dE/dv = lambda2 along every branch
    for place, end in ((slice(None, -1), slopes.leaving), (slice(1, None), slopes.arriving)):
        np.testing.assert_allclose(end["E"], -slopes.table["lambda2"][place].to_numpy() / 2 * end["v"], atol=1e-7)


def test_an_amplitude_leaves_the_straight_tube_in_a_line_and_its_volume_in_a_parabola():
    branch = family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.01}))
    rows = curve(branch, 64)
    near = rows[rows["point"].between(0.05, 0.5)]
    power = {name: np.polyfit(np.log(near["point"]), np.log(np.abs(near[name])), 1)[0] for name in ("amplitude",)}
    assert power["amplitude"] == pytest.approx(1, abs=0.02)
    assert np.polyfit(np.log(near["point"]), np.log(near["v"] - 1), 1)[0] == pytest.approx(2, abs=0.05)
    whole = rows[rows["point"] % 1 == 0].reset_index(drop=True)
    for name in ("v", "E", "mu_crit", "wave", "special", "n_unstable"):
        assert (whole[name] == branch.table()[name]).all()


class Sometimes(Curve):
    """With a number that some points do not have."""

    def further(self, u):
        return {"wave": u[1] if u[0] < 0.5 else np.nan}


def test_a_curve_is_interrupted_where_a_number_is_missing_and_goes_through_all_others():
    problem = Sometimes(ELLIPSE.f, ELLIPSE.gradient)
    branch = Branch([replace(point, problem=problem) for point in ellipse(9).points], [], Status.GIVEN, "")
    rows, known = curve(branch, 10), branch.table()["wave"]
    assert known.notna().tolist() == [False] * 4 + [True] * 5
    assert rows["wave"].notna().tolist() == [False] * 40 + [True] * 41
    np.testing.assert_array_equal(rows["wave"][::10], known)
    assert rows["wave"].max() <= known.max()  # monotone between neighbours
