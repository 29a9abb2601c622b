"""Outlines that cross themselves: trochoids, and spheres that overlap, in closed form."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from pearlbvp.collocation import PiecewisePolynomial, gauss_scheme
from pearlbvp.collocation.polynomial import all_points
from pearlbvp.continuation.branch import Status
from pearlbvp.helfrich import Tube
from pearlbvp.stability.profile import Profile, outline_crosses_itself
from pearlbvp.studies.branch import branch_options, family_branch


@pytest.mark.parametrize(("a", "crosses"), [(0.9, False), (1.02, True), (2.0, True)])
def test_a_trochoid_has_loops_where_its_point_is_outside_of_the_wheel(a, crosses):
    t = np.linspace(0, 2 * np.pi, 401) + 0.3
    assert outline_crosses_itself(t - a * np.sin(t), 3 - a * np.cos(t), 2 * np.pi) is crosses


@pytest.mark.parametrize(("period", "crosses"), [(2.1, False), (1.9, True)])
def test_beads_on_a_thread_touch_where_they_are_a_diameter_apart(period, crosses):
    """From neck to neck: a thread of radius 0.1 into a sphere of radius 1, beyond the widest place on either side."""
    angle = np.linspace(-np.pi + 0.1, -0.1, 201)
    x, r = np.cos(angle), -np.sin(angle) + 0.05
    half = period / 2
    assert outline_crosses_itself(np.r_[-half, x, half], np.r_[0.02, r, 0.02], period) is crosses


def overhanging(a):
    """``x = t + a sin 2t``, ``r = 2 - cos t`` on half a period, by its arclength."""
    t = np.linspace(0, np.pi, 4001)
    dx, dr = 1 + 2 * a * np.cos(2 * t), np.sin(t)
    s = CubicSpline(t, np.hypot(dx, dr)).antiderivative()(t)
    mesh = np.linspace(0, 1, 301)
    t = CubicSpline(s, t)(all_points(mesh, gauss_scheme(4)) * s[-1])
    dx, dr, r = 1 + 2 * a * np.cos(2 * t), np.sin(t), 2 - np.cos(t)
    size = np.hypot(dx, dr)
    psi, bend = np.unwrap(np.arctan2(dr, dx)), (dx * np.cos(t) + dr * 4 * a * np.sin(2 * t)) / size**3
    states = np.column_stack((r, psi, (dx / size / r - bend) / 2, np.zeros_like(r)))
    return Profile(PiecewisePolynomial(mesh, states), s[-1], True, 0.0, 0.0, 0.0, 2 * np.pi)


@pytest.mark.parametrize("a", [0.7, 1.6, 1.85, 2.4])
def test_the_clearance_of_an_outline_is_that_of_its_places_across_the_axis(a):
    t = np.arccos(-1 / (2 * a)) / 2
    assert overhanging(a).clearance() == pytest.approx(2 * (np.pi - t - a * np.sin(2 * t)), abs=2e-6)


def test_what_overhangs_nowhere_has_the_period_for_its_clearance():
    assert overhanging(0.3).clearance() == 2 * np.pi


def test_pearls_that_overhang_end_where_they_meet_their_mirror_image():
    """Discs of a stack: an outline by its own angle, as a sum over many points."""
    branch = family_branch(Tube(-1.0, 4.0), "pearl", (1, 0), branch_options({"v": 0.2}))
    last = branch.points[-1]
    assert branch.status is Status.CONTACT
    profile = last.problem.profile(last.u)
    sigma = (np.arange(20000) + 0.5) / 20000
    x = np.cumsum(np.cos(profile.at(sigma)[:, 1])) * profile.arclength / 20000
    least = x[1:-1][(x[1:-1] < x[:-2]) & (x[1:-1] < x[2:])]
    most = x[1:-1][(x[1:-1] > x[:-2]) & (x[1:-1] > x[2:])]
    assert min(least.min(), profile.period / 2 - most.max()) == pytest.approx(0, abs=1e-4)
    assert all(point.clearance > 0 for point in branch.points[:-1])
