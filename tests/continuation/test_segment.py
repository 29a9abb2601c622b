"""Where a number has a value between two points of a circle: by one Newton's method, and where that declines."""

import math

import numpy as np
import pytest
from support.curves import Curve

from pearlbvp.continuation.segment import Segment
from pearlbvp.continuation.solution import Solution

CIRCLE = Curve(lambda x, y: x**2 + y**2 - 1, lambda x, y: np.array([2 * x, 2 * y]))


def on_circle(first, last):
    """The arc between two angles."""
    return Segment(
        *(Solution(CIRCLE, np.array([math.cos(t), math.sin(t)]), np.array([-math.sin(t), math.cos(t)])) for t in (first, last))
    )  # fmt: skip


def found(segment, number):
    def excess(point):
        return number(point.u)

    return segment.where(excess, (excess(segment.first), excess(segment.last)))


@pytest.mark.parametrize(
    ("number", "exact"),
    [
        (lambda u: u[1] - 0.3, math.asin(0.3)),
        (lambda u: u[0] - 0.9, math.acos(0.9)),
        (lambda u: u[0] ** 3 + u[1] - 1.1, None),
    ],
)
def test_a_number_s_value_is_found_on_the_circle(number, exact):
    point = found(on_circle(0.1, 0.6), number)
    x, y = point.u
    assert abs(number(point.u)) < 1e-15
    assert x**2 + y**2 == pytest.approx(1, abs=1e-15)
    assert 0.1 < math.atan2(y, x) < 0.6
    np.testing.assert_allclose(point.tangent, [-y, x], atol=1e-12)
    if exact is not None:
        assert math.atan2(y, x) == pytest.approx(exact, abs=1e-14)


def test_a_kink_and_a_place_off_the_segment_are_declined():
    assert found(on_circle(0.1, 0.6), lambda u: max(u[1], 0.31) - 0.31 - 1e-3 * (u[1] < 0.31)) is None  # a jump
    # A value that is 1e-3 beyond the last point, as where the number turns between the two.
    segment = on_circle(0.1, 0.6)
    assert segment.where(lambda point: point.u[1] - math.sin(0.62), (-0.5, 0.1)) is None
