"""Polynomials through samples against the functions themselves, which are known in closed form."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pearlbvp.continuation.leja import ROUGH, sampled, through


def both(function):
    """Samples of one function at 0 and 1, and the function of one ``t``."""
    return lambda t: np.array([function(t)]), {t: np.array([function(t)]) for t in (0.0, 1.0)}


@given(st.lists(st.floats(-1, 1), min_size=2, max_size=6), st.integers(-50, 200).map(lambda k: k / 100))
def test_a_polynomial_is_met_between_its_samples_at_them_and_beyond(coefficients, t):
    at = np.linspace(0, 1, len(coefficients))
    values = np.polynomial.Polynomial(coefficients)(at)[:, None]
    found, product = through(at, values, np.array([t, at[1]]))
    expected = np.polynomial.Polynomial(coefficients)(np.array([t, at[1]]))
    np.testing.assert_allclose(found[:, 0], expected, atol=1e-11)
    np.testing.assert_allclose(product, [abs(np.prod(t - at)), 0], atol=1e-12)


def test_a_rational_function_takes_samples_by_the_rate_of_its_pole():
    """The error falls by ``3 + sqrt 8`` a sample, the sum of the half axes of the ellipse through the pole at ``t = 2``."""
    sample, known = both(lambda t: 1 / (2 - t))
    t = np.linspace(0, 1, 300)
    for tolerance in (1e-4, 1e-8, 1e-12):
        found = sampled(sample, known, tolerance, 40)
        assert np.abs(found(t)[:, 0] - 1 / (2 - t)).max() < tolerance
        assert len(found.at) <= 5 - math.log(tolerance) / math.log(3 + math.sqrt(8))


def test_what_is_known_already_serves():
    sample, known = both(math.exp)
    alone = sampled(sample, known, 1e-11, 40)
    inside = {t: np.array([math.exp(t)]) for t in (0.15, 0.5, 0.8)}
    asked = []
    more = sampled(lambda t: asked.append(t) or sample(t), known | inside, 1e-11, 40)
    assert len(asked) <= len(alone.at) - 2 - len(inside) + 1
    np.testing.assert_allclose(more(np.array([0.33]))[:, 0], math.exp(0.33), atol=1e-11)


@pytest.mark.parametrize("wanted", [0.7, 0.05, 0.002])
def test_the_end_lies_a_little_beyond_what_is_wanted(wanted):
    """The function is wanted to ``e^(20 wanted)``, though at 1 it is much larger."""
    sample, known = both(lambda t: math.exp(20 * t))
    found = sampled(sample, known, 1e-11, 40, lambda f: math.exp(20 * wanted) - f[:, 0])
    assert wanted < found.end < 1.1 * wanted
    t = np.linspace(0, found.end, 100)
    np.testing.assert_allclose(found(t)[:, 0], np.exp(20 * t), atol=1e-10 * (1 + math.exp(20 * wanted)))


def test_rounding_is_seen_for_what_it_is():
    random, tolerance = np.random.default_rng(0), 1e-11
    sample, known = both(lambda t: math.cos(t) + 1e-10 * random.standard_normal())
    found = sampled(sample, known, tolerance, 33)
    assert len(found.at) < 20
    assert tolerance < found.error < ROUGH * tolerance


def test_a_kink_is_not_resolved():
    sample, known = both(lambda t: abs(t - 0.3))
    found = sampled(sample, known, 1e-11, 20)
    assert len(found.at) == 20
    assert found.error > 1e-3
