"""The straight cylinder and its scaling."""

import numpy as np
import pandas as pd
import pytest

from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, cylinder_energy, cylinder_lambda1
from pearlbvp.theory.dispersion import critical_lambda2, growth_rate
from pearlbvp.units import Units


def test_cylinder_makes_the_energy_stationary():
    # Per unit length a cylinder of radius r has F = 2 pi r (1/(2r) - c0)^2 + lambda1 2 pi r + lambda2 pi r^2.
    c0, lambda2 = 0.3, -0.7
    lambda1 = cylinder_lambda1(lambda2, c0)

    def free_energy(r):
        return 2 * np.pi * r * ((0.5 / r - c0) ** 2 + lambda1) + lambda2 * np.pi * r**2

    eps = 1e-5
    assert (free_energy(1 + eps) - free_energy(1 - eps)) / (2 * eps) == pytest.approx(0, abs=1e-9)
    assert cylinder_energy(c0) == pytest.approx((0.5 - c0) ** 2)


def test_dimensional_tube():
    tube = Units(2.0).tube(0.24, 60.0)
    assert (tube.c0, tube.length) == (0.48, 30.0)


def test_columns_in_other_units_follow_the_paper_s_dispersion_at_any_radius():
    # Paper, eq. (eigs) with r: mu = -q^2/2 + (r l2 + 1/r^2) q - (l2/r + 1/(2 r^4)) - (1/r - 2 c0) k^2/r, q = k^2 + n^2/r^2
    r, c0, k = 2.0, 0.2, 0.35
    table = pd.DataFrame({"k": [k * r], "lambda2": [float(critical_lambda2(k * r, 0, c0 * r))], "v": [1.2]})
    scaled = Units(r).columns(table)
    lambda2 = scaled["lambda2"].iloc[0]
    q = k**2
    mu = -(q**2) / 2 + (r * lambda2 + r**-2) * q - (lambda2 / r + 0.5 * r**-4) - (1 / r - 2 * c0) * k**2 / r
    assert mu == pytest.approx(0, abs=1e-15)
    assert scaled["k"].iloc[0] == pytest.approx(k)
    assert scaled["v"].iloc[0] == 1.2


def test_growth_rates_at_any_radius_are_the_paper_s():
    # the same equation away from its zero
    r, c0, k, lambda2 = 2.0, 0.2, 0.35, 0.3
    at_one = pd.DataFrame({"mu_crit": [float(growth_rate(k * r, 0, lambda2 * r**3, c0 * r))], "mu_error": [16.0]})
    scaled = Units(r).columns(at_one)
    q = k**2
    mu = -(q**2) / 2 + (r * lambda2 + r**-2) * q - (lambda2 / r + 0.5 * r**-4) - (1 / r - 2 * c0) * k**2 / r
    assert abs(mu) > 0.01
    assert scaled["mu_crit"].iloc[0] == pytest.approx(mu, rel=1e-12)
    assert scaled["mu_error"].iloc[0] == 1


@pytest.mark.parametrize("length", [0, -1, float("nan"), float("inf"), "ten", None])
def test_length_must_be_positive(length):
    with pytest.raises(InputError, match="^length: "):
        Tube(0.0, length)


@pytest.mark.parametrize("c0", [float("nan"), float("-inf"), "x"])
def test_c0_must_be_finite(c0):
    with pytest.raises(InputError, match="^c0: "):
        Tube(c0, 10)
