"""Normal forms of branch points: against amplitude equations, and against branches that leave secondary branch points."""

import numpy as np
import pytest
from support.curves import Curve

from pearlbvp.continuation.following import BranchOptions
from pearlbvp.continuation.normal_form import normal_form
from pearlbvp.continuation.path import PathOptions
from pearlbvp.continuation.switching import leave
from pearlbvp.helfrich import Tube
from pearlbvp.shapes.pearling import pearling_onset
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.localized import localized_pearls
from pearlbvp.studies.normal_form import COLUMNS, form_at, normal_forms, rate_by_volume
from pearlbvp.studies.onward import switched
from pearlbvp.theory.amplitude import amplitude_equation


def test_a_pitchfork_and_a_transcritical_crossing_in_the_plane():
    tiny = 1e-13  # the Jacobian at a branch point found by computation is not exactly singular
    pitchfork = Curve(
        lambda x, y: y * (x - 3 * y**2 + 2 * x * y**2) + tiny * y,
        lambda x, y: [y * (1 + 2 * y**2), x - 9 * y**2 + 6 * x * y**2 + tiny],
    )
    form = normal_form(pitchfork, np.zeros(2), np.array([1.0, 0.0]), names=("x",))
    assert form.pitchfork
    assert form.quadratic["x"] == pytest.approx(3, rel=1e-8)
    crossing = Curve(lambda x, y: y * (x - 0.5 * y) + tiny * y, lambda x, y: [y, x - y + tiny])
    assert normal_form(crossing, np.zeros(2), np.array([1.0, 0.0])).slope == pytest.approx(0.5, rel=1e-8)


def test_a_transcritical_branch_is_left_along_its_own_tangent():
    """Exact: ``y = 2 x`` crosses ``y = 0``; and three pearls, whose branch of one larger pearl turns in volume at once."""
    tiny = 1e-13
    crossing = Curve(lambda x, y: y * (x - 0.5 * y) + tiny * y, lambda x, y: [y, x - y + tiny])
    options = BranchOptions(PathOptions(step=0.1, max_step=0.1, max_points=4), folds=())
    line = leave(crossing, np.zeros(2), np.array([1.0, 0.0]), None, options)
    np.testing.assert_allclose([point.u[1] - 2 * point.u[0] for point in line.points], 0, atol=1e-10)
    assert len(line.points) == 4


def test_three_pearls_give_way_to_a_larger_one_by_a_jump():
    pearls = family_branch(Tube(0.48, 22), "pearl", (3, 0), branch_options({"bp": 1}))
    start = pearls.points[-1].observables
    assert start["v"] == pytest.approx(localized_pearls(0.48, 22 / 3, 22).v.iloc[0], abs=1e-9)
    larger, smaller = (switched(pearls, 1, branch_options({"v": 1.0065}), grow=grow) for grow in (True, False))
    table = larger.table()
    turn = larger.find("fold:v")[0].index
    assert table.v[turn] < start["v"] < table.v.iloc[-1]
    assert list(table.n_unstable[turn + 1 :]) == [0] * (len(table) - turn - 1)
    # The other half leads straight to larger volumes, and is unstable.
    assert smaller.table().v.is_monotonic_increasing
    assert smaller.points[-1].spectrum.n_unstable > 0
    # One curve through the branch point: the slope of the volume is the same on both halves, and not zero.
    slopes = [branch.points[0].slopes["v"] for branch in (larger, smaller)]
    assert slopes[0] == pytest.approx(-slopes[1], rel=1e-6)
    assert abs(slopes[0]) > 1e-4


@pytest.mark.parametrize(("c0", "length", "m"), [(0.0, 10, 1), (0.48, 15, 2), (0.4, 20, 1)])
def test_at_the_cylinder_it_is_the_amplitude_equation(c0, length, m):
    problem, u, direction = pearling_onset(Tube(c0, length), m, degree=7, intervals=12)
    along = np.zeros_like(u)
    free = problem.discretization.free
    for name, change in (("lambda1", -1.0), ("lambda2", 1.0)):  # the cylinders
        along[u.size - len(free) + free.index(name)] = change
    form = normal_form(problem, u, along, direction)
    amplitude = problem.discretization.values(form.direction)[0, 0] / 2
    equation = amplitude_equation(Tube(c0, length), (m, 0))
    found = {name: value / amplitude**2 for name, value in form.quadratic.items()}
    assert found["lambda2"] == pytest.approx(-equation.b1 / equation.a, rel=1e-8)
    assert found["lambda1"] == pytest.approx(equation.alpha2 + equation.b1 / equation.a, rel=1e-8)
    assert found["v"] == pytest.approx(-2 * equation.a, rel=1e-8)


def test_a_secondary_branch_point_predicts_the_localized_branch():
    """Volumes, pressures and growth rates along the localized branch, as it leaves pearls of period 7.5 on L = 15."""
    pearls = family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.02}))
    table = normal_forms(pearls)
    assert list(table.columns) == COLUMNS
    assert list(table.form) == ["pitchfork"]
    row, special = table.iloc[0], pearls.find("bp")[0]
    assert row.criticality == "supercritical"
    assert row.cubic == pytest.approx(-row.rate * row.v_2)
    assert pytest.approx(-row.lambda2 / 2 * row.v_2, rel=1e-8) == row.E_2
    branch = switched(pearls, 1, branch_options(step=0.003, max_step=0.003, max_points=14))
    rows = branch.table().iloc[4:]
    ratio = (rows.lambda2 - row.lambda2) / (rows.v - row.v)
    assert np.polyfit(rows.v - row.v, ratio, 2)[-1] == pytest.approx(row.lambda2_2 / row.v_2, rel=1e-5)
    rates = rows.mu_crit / (rows.v - row.v)
    assert np.polyfit(rows.v - row.v, rates, 2)[-1] == pytest.approx(-2 * row.rate, rel=1e-3)
    assert rate_by_volume(pearls, special) == row.rate
    assert form_at(pearls, special, "neck").quadratic["v"] == pytest.approx(row.v_2, rel=1e-6)
    with pytest.raises(ValueError, match="^special: "):
        form_at(pearls, pearls.special[0])
