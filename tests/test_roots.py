"""Zeros of functions of one variable, against closed forms and Brent's method."""

import math

import pytest
from scipy.optimize import brentq

from pearlbvp.roots import MOST, NoRoot, root

CASES = {
    "linear": (lambda x: x - 0.3, 0, 1, 0.3),
    "square root of two": (lambda x: x * x - 2, 0, 2, math.sqrt(2)),
    "cosine": (math.cos, 1, 4, math.pi / 2),
    "triple": (lambda x: (x - 0.7) ** 3, 0, 1, 0.7),
    "steep": (lambda x: math.tanh(1e6 * (x - 0.123456789)), -1, 5, 0.123456789),
    "jump": (lambda x: -1.0 if x < 0.25 else 3.0, 0, 1, 0.25),
    "backwards": (lambda x: math.exp(-x) - 0.5, 3, 0, math.log(2)),
    "near a pole": (lambda x: 1 / x - 1e3, 1e-9, 1, 1e-3),
    "far": (lambda x: x**9 - 1e27, 0, 1e6, 1e3),
}


@pytest.mark.parametrize("case", CASES)
def test_zeros_are_those_of_closed_forms_in_no_more_calls_than_brent_s(case):
    function, first, last, exact = CASES[case]
    calls = []

    def counted(x):
        calls.append(x)
        return function(x)

    found = root(counted, first, last, 1e-13)
    flat = 1e-4 if case == "triple" else 0  # where values of rounding's size surround the zero
    assert abs(found - exact) <= 2e-13 + 2e-14 * abs(exact) + flat
    ours = len(calls)
    calls.clear()
    brentq(counted, first, last, xtol=1e-13, rtol=1e-14, disp=False)
    assert ours <= 1.5 * len(calls) + 4
    assert min(calls) >= min(first, last)
    assert max(calls) <= max(first, last)


def test_a_zero_at_an_end_is_found_there():
    assert root(lambda x: x - 1, 1, 2, 1e-12) == 1
    assert root(lambda x: x - 1, 0, 1, 1e-12) == 1


def test_what_has_no_zero_is_said_to_have_none():
    with pytest.raises(NoRoot, match="does not change its sign between 1 and 2"):
        root(lambda x: x, 1, 2, 1e-12)
    with pytest.raises(NoRoot, match="is not a number"):
        root(lambda x: math.nan if 0 < x < 1 else x - 0.5, 0, 1, 1e-12)
    with pytest.raises(NoRoot, match=f"within {MOST} evaluations"):
        root(lambda x: math.copysign(1.0, x - 1 / 3 - 1e-17), -1, 1, 0.0, 0.0)
