"""Outlines that cross themselves: trochoids, and spheres that overlap, in closed form."""

import numpy as np
import pytest

from pearlbvp.stability.profile import outline_crosses_itself


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
