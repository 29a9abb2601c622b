import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.studies.localized import localized_pearls
from pearlbvp.theory.amplitude import AmplitudeEquation
from pearlbvp.theory.dispersion import critical_wave_number, growth_rate
from pearlbvp.theory.modulation import local_cubic, loss_of_stability, marginal_c0

TABLE = Path(__file__).parents[2] / "data" / "long_trains.csv"


def v_s(c0, pearls):
    """Where pearls of the critical period lose stability, by collocation and continuation."""
    period = 2 * math.pi / critical_wave_number(c0)
    table = localized_pearls(c0, period, [count * period for count in pearls])
    assert (table.status == "found").all()
    return table


@pytest.mark.parametrize("c0", [0.26, 0.3, 0.4, 0.48, 0.4884, 0.499])
def test_the_local_coefficient_by_the_amplitude_equation(c0):
    k = critical_wave_number(c0)
    equation = AmplitudeEquation(Tube(c0, 2 * math.pi / k), 1, 0)
    mean = float(growth_rate(0, 0, equation.lambda2, c0))
    assert local_cubic(c0) == pytest.approx(equation.b1 - equation.alpha2**2 / mean, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("c0", [0.3, 0.4, 0.45])
def test_the_law_is_the_limit_of_computed_branch_points(c0):
    """The next term is of order ``1/L^2``: of two lengths the limit follows, and with one of half the length the order."""
    table = v_s(c0, (32, 64, 128))
    scaled = ((table.v - 1) * table.L**2).to_numpy()
    errors = scaled - loss_of_stability(c0)
    np.testing.assert_allclose(errors[:-1] / errors[1:], 4, rtol=0.02)
    assert (4 * scaled[2] - scaled[1]) / 3 == pytest.approx(loss_of_stability(c0), rel=2e-5)


def test_beyond_the_marginal_c0_long_trains_stay_stable():
    margin = marginal_c0()
    assert local_cubic(margin - 1e-6) > 0 > local_cubic(margin + 1e-6)
    assert loss_of_stability(margin + 1e-6) == math.inf
    below, above = (v_s(c0, (256, 1024)).v.to_numpy() - 1 for c0 in (margin - 0.01, 0.495))
    assert below[1] == pytest.approx(below[0] / 16, rel=0.2)  # it falls like 1/L^2
    assert above[1] == pytest.approx(above[0], rel=0.12)  # it has a limit above 1


def test_the_table_in_data():
    table = pd.read_csv(TABLE)
    for row in table.sample(3, random_state=1).itertuples():
        assert v_s(row.c0, [256]).v.item() - 1 == pytest.approx(row.excess_256, rel=1e-6, abs=1e-12)
    np.testing.assert_allclose(table.limit, [loss_of_stability(c0) for c0 in table.c0], rtol=1e-11)


@pytest.mark.parametrize("c0", [0.25, 0.5, -1.0, math.nan])
def test_other_tubes_have_no_such_pearls(c0):
    with pytest.raises(InputError, match=r"^c0: "):
        loss_of_stability(c0)
