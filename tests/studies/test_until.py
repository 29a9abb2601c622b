"""Branches that stop at a special point, or at a value that their start has already."""

import io

import numpy as np
import pandas as pd
import pytest
from support.commands import run

from pearlbvp.continuation.segment import Segment
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.localized import localized_pearls
from pearlbvp.studies.onward import followed, resumed, switched, varied
from pearlbvp.studies.saved import load, save
from pearlbvp.studies.shape import shape_branch


def table_of(out):
    return pd.read_csv(io.StringIO(out), keep_default_na=False)


def of_family(family, options):
    return {
        "pearl": lambda: family_branch(Tube(0.48, 30), "pearl", (4, 0), options),
        "ring": lambda: family_branch(Tube(-1.0, 10), "ring", (0, 2), options),
        "coil": lambda: family_branch(Tube(0.48, 10), "coil", (1, 1), options),
        "mesh": lambda: family_branch(Tube(0.48, 15), "pearl", (2, 0), options, nodes=180),
    }[family]()


@pytest.mark.parametrize("family", ["pearl", "ring", "coil", "mesh"])
def test_a_branch_stops_at_its_first_branch_point(family):
    branch = of_family(family, branch_options({"bp": 1}))
    last = branch.points[-1]
    assert branch.complete
    assert branch.kinds(len(branch.points) - 1) in (["bp", "stop"], ["bp", "bp", "stop"])
    assert len(branch.find("bp")) == branch.kinds(len(branch.points) - 1).count("bp")
    neutral = branch.find("bp")[0].block
    rates = last.problem.block_rates(last.u, neutral, last.spectrum)
    assert np.abs(rates).min() < 1e-8
    other = of_family(family, branch_options({"bp": 1}, step=0.05, max_step=0.21))
    assert other.points[-1].observables["v"] == pytest.approx(last.observables["v"], abs=1e-9)


def test_the_first_branch_point_of_pearls_is_that_of_localized_pearls():
    branch = family_branch(Tube(0.48, 30), "pearl", (4, 0), branch_options({"bp": 1}))
    assert branch.points[-1].observables["v"] == pytest.approx(localized_pearls(0.48, 7.5, 30).v.iloc[0], abs=1e-10)


def test_the_second_fold_is_the_least_volume_behind_the_first():
    branch = family_branch(Tube(0.75, 10), "pearl", (1, 0), branch_options({"fold:v": 2}))
    folds = [special.index for special in branch.find("fold:v")]
    assert folds[1] == len(branch.points) - 1
    volumes = np.array([entry.observables["v"] for entry in branch.points])
    assert volumes.argmax() == folds[0]
    assert volumes[folds[0] :].argmin() == len(volumes) - 1 - folds[0]
    # -2 dE/dv = lambda2: energy and volume turn together.
    assert "fold:E" in branch.kinds(folds[1])
    beyond = resumed(branch, branch_options({"v": volumes[-1] + 1e-4}))
    assert beyond.complete
    assert len(beyond.find("fold:v")) == 2


def test_any_column_s_fold_is_one_and_a_value_that_comes_first_counts():
    plain = family_branch(Tube(0.75, 10), "pearl", (1, 0), branch_options({"fold": 1}))
    assert plain.kinds(len(plain.points) - 1) == ["fold:E", "stop"]
    widest = family_branch(Tube(0.48, 10), "coil", (1, 1), branch_options({"fold:r_min": 1, "v": 0.95}))
    assert widest.kinds(len(widest.points) - 1) == ["stop"]
    assert widest.points[-1].observables["v"] == pytest.approx(0.95, abs=1e-12)


def test_pearls_stop_at_constant_mean_curvature():
    branch = family_branch(Tube(0.75, 10), "pearl", (2, 0), branch_options({"cmc": 1}, max_points=70))
    last = branch.points[-1]
    assert branch.kinds(len(branch.points) - 1) == ["cmc", "stop"]
    assert np.ptp(last.problem.profile(last.u).states.values[:, 2]) < 1e-10


def test_a_resumed_branch_goes_on_to_the_next_special_point(tmp_path):
    first = family_branch(Tube(0.48, 30), "pearl", (4, 0), branch_options({"bp": 1}))
    save(first, tmp_path / "b.h5")
    second = resumed(load(tmp_path / "b.h5"), branch_options({"bp": 2}))
    at_once = family_branch(Tube(0.48, 30), "pearl", (4, 0), branch_options({"bp": 2}))
    assert [branch.points[-1].observables["v"] for branch in (second, at_once)] == pytest.approx(
        [at_once.points[-1].observables["v"]] * 2, abs=1e-10
    )
    assert len(second.find("bp")) == 2
    assert second.points[-1].observables["v"] > first.points[-1].observables["v"] + 1e-3


def test_varied_and_followed_curves_stop_at_special_points():
    folds = family_branch(Tube(0.75, 10), "pearl", (1, 0), branch_options({"fold:v": 1}))
    curve = followed(folds, "fold:v", 1, "c0", branch_options({"fold:v": 1, "c0": 0.55}, max_step=0.2), upwards=False)
    assert curve.complete
    coils = family_branch(Tube(0.48, 10), "coil", (1, 1), branch_options({"v": 0.88}))
    by_c0 = varied(coils, -1, "c0", branch_options({"bp": 1, "c0": 0.7}))
    assert by_c0.kinds(len(by_c0.points) - 1) == ["bp", "stop"]
    last = by_c0.points[-1]
    assert last.observables["v"] == pytest.approx(0.88, abs=1e-12)
    # Where the coil at fixed v loses stability while c0 grows, the coil at that c0 does while v varies.
    again = family_branch(Tube(last.observables["c0"], 10), "coil", (1, 1), branch_options({"bp": 1, "v": 0.8}))
    assert again.points[-1].observables["v"] == pytest.approx(0.88, abs=1e-6)


@pytest.mark.parametrize("value", [0, 1.5, -1])
def test_special_points_are_counted_from_one(value):
    with pytest.raises(InputError, match=r"^until: .* count them from 1"):
        branch_options({"bp": value})


@pytest.mark.parametrize("family", ["pearl", "ring", "coil", "buckle"])
@pytest.mark.parametrize("wanted", [("v", 1.0), ("amplitude", 0.0), ("r_max", 1.0), ("wave", 0.0)])
def test_the_straight_tube_s_own_values_are_reached_at_once(family, wanted):
    options = branch_options(dict([wanted]))
    if family == "pearl":
        branch = family_branch(Tube(0.48, 30), "pearl", (4, 0), options)
    elif family == "ring":
        branch = family_branch(Tube(-1.0, 10), "ring", (0, 3), options)
    else:
        branch = family_branch(Tube(-0.4, 12), family, (1, 1), options, discretization="modes")
    assert (len(branch.points), branch.complete, branch.kinds(0)) == (1, True, ["start", "stop"])


@pytest.mark.parametrize("kind", ["subdivision", "cotangent"])
@pytest.mark.parametrize("wanted", [("v", 1.0), ("E", 0.25)])
def test_a_mesh_of_the_straight_tube_has_its_values_to_the_mesh_s_accuracy(kind, wanted):
    branch = family_branch(
        Tube(0.0, 10), "coil", (1, 1), branch_options(dict([wanted])), nodes=200, discretization=kind
    )
    assert (len(branch.points), branch.complete) == (1, True)


def test_whatever_a_branch_starts_from_has_its_own_values(tmp_path):
    pearls = family_branch(Tube(0.48, 30), "pearl", (4, 0), branch_options({"v": 1.01}))
    rounded = float(f"{pearls.points[-1].observables['E']:.12g}")  # as a table has it
    assert len(resumed(pearls, branch_options({"E": rounded})).points) == len(pearls.points)
    again = resumed(pearls, branch_options({"v": 1.01}))
    assert again.complete
    assert again.kinds(len(again.points) - 1) == ["stop"]
    localized = switched(pearls, 1, branch_options({"v": pearls.at(pearls.find("bp")[0]).observables["v"]}))
    assert (len(localized.points), localized.complete) == (1, True)
    by_c0 = varied(pearls, -1, "c0", branch_options({"c0": 0.48}))
    assert (len(by_c0.points), by_c0.complete) == (1, True)
    shape = shape_branch(0.75, 10, 1.0, [-0.28, 0.47], branch_options({"v": 1.0}))
    assert (len(shape.points), shape.complete, shape.kinds(0)) == (1, True, ["start", "stop"])


def test_a_branch_that_stopped_at_its_start_goes_on_from_there():
    start = family_branch(Tube(0.48, 30), "pearl", (4, 0), branch_options({"v": 1.0}))
    whole = resumed(start, branch_options({"v": 1.005}))
    direct = family_branch(Tube(0.48, 30), "pearl", (4, 0), branch_options({"v": 1.005}))
    assert whole.complete
    assert whole.points[-1].observables["E"] == pytest.approx(direct.points[-1].observables["E"], abs=1e-12)
    assert whole.find("bp") == direct.find("bp") == []


def test_the_command_line_stops_at_special_points_and_says_what_it_does_not_know(capsys):
    status, out, _ = run(capsys, "branch", "pearl", "--c0", 0.48, "--length", 30, "--mode", "4,0", "--until", "bp:2")
    table = table_of(out)
    assert (status, table.special.iloc[-1], table.special.str.contains("bp").sum()) == (0, "bp,stop", 2)
    for text, named in (("bp:0", "0"), ("fold:x", "fold:x"), ("nothing", "nothing"), ("fold:c0", "c0")):
        status, _, err = run(capsys, "branch", "pearl", "--c0", 0.48, "--length", 30, "--until", text)
        assert status == 2
        assert err.startswith("pearlbvp: --until: ")
        assert named in err
    status, _, err = run(
        capsys, "branch", "pearl", "--c0", 0.48, "--length", 30, "--until", "v=1.1", "--until", "v=1.2"
    )
    assert (status, "v is given twice" in err) == (2, True)


def test_a_special_point_that_does_not_come_is_exit_status_one(capsys):
    status, out, err = run(
        capsys, "branch", "buckle", "--c0", 0, "--length", 10, "--until", "fold:v", "--max-points", 4
    )
    assert status == 1
    assert "--max-points = 4 reached" in err
    assert table_of(out).special.iloc[-1] == "end"


@pytest.mark.parametrize(
    ("tube", "family", "mode", "until", "names"),
    [
        (Tube(0.48, 15), "pearl", (2, 0), {"v": 1.01}, ("v", "lambda2", "E", "r_min", "wave")),
        (Tube(-1.0, 10), "ring", (0, 2), {"v": 0.85}, ("v", "lambda2", "gap")),
        (Tube(0.48, 10), "coil", (1, 1), {"v": 0.93}, ("v", "lambda1", "r_min")),
        (Tube(0.0, 10), "buckle", (1, 1), {"v": 0.98}, ("v", "E")),
    ],
)
def test_a_wanted_value_is_found_where_brent_s_method_finds_it(tube, family, mode, until, names):
    points = family_branch(tube, family, mode, branch_options(until)).points
    for name in names:
        ends = points[-2].value(name), points[-1].value(name)
        value = 0.3 * ends[0] + 0.7 * ends[1]

        def excess(point, name=name, value=value):
            return point.value(name) - value

        segment = Segment(points[-2], points[-1])
        direct, slow = segment.where(excess, (ends[0] - value, ends[1] - value)), segment.root(excess, ends[0] - value)
        np.testing.assert_allclose(direct.u, slow.u, atol=1e-12)
        np.testing.assert_allclose(direct.tangent, slow.tangent, atol=1e-9)
        assert direct.value(name) == pytest.approx(value, abs=1e-13)
