"""The automatic diagram on L = 15 at c0 = 0.48: everything that the paper's figure c05f1 has of axisymmetric branches."""

import numpy as np
import pytest

from pearlbvp.continuation.branch import Status
from pearlbvp.errors import InputError
from pearlbvp.studies.branch import branch_options
from pearlbvp.studies.diagram import diagram
from pearlbvp.studies.localized import localized_pearls


def test_diagram_of_the_paper_s_figure():
    names = []
    found = diagram(0.48, 15, 1, branch_options({"v": 1.05}), progress=names.append)
    assert list(found.branches) == ["1", "2", "2/1"]
    table = found.table()
    assert set(names) >= set(found.branches)
    onset = table.groupby("branch").lambda2.first()
    assert onset["1"] == pytest.approx(-0.4208, abs=5e-5)
    assert onset["2"] == pytest.approx(-0.2432, abs=5e-5)
    assert onset["2/1"] == pytest.approx(localized_pearls(0.48, 7.5, 15).lambda2.iloc[0], abs=1e-10)
    # Only the localized pearl is stable at v = 1.05, and it has the least energy there.
    last = table.groupby("branch").last()
    np.testing.assert_allclose(last.v, 1.05, atol=1e-12)
    assert last.n_unstable.to_dict()["2/1"] == 0
    assert (last.n_unstable.drop("2/1") > 0).all()
    assert last.E.astype(float).idxmin() == "2/1"


def test_what_bends_is_followed_from_pearls_and_what_is_not_followed_is_said():
    options = {"pearl": branch_options({"v": 1.033}), "mixed": branch_options(max_points=2)}
    found = diagram(0.75, 10, 1, options, refused=lambda branch, special: "as asked" * (special.block.parity == "even"))
    assert list(found.branches) == ["1", "1/1"]
    assert found.skipped == {"1/2": "as asked"}
    bent = found.branches["1/1"]
    assert bent.points[0].problem.symmetry.fold == 1
    assert bent.points[-1].observables["v"] < bent.points[0].observables["v"]


def test_what_leaves_rings_is_followed():
    options = {"ring": branch_options({"bp": 1}), "mixed": branch_options(max_points=2)}
    found = diagram(0, 10, 1, options, modes=[(0, 2)])
    assert not found.skipped
    assert list(found.branches) == ["ring 0:2", "ring 0:2/1"]
    left, new = found.branches["ring 0:2"].points[-1], found.branches["ring 0:2/1"]
    for name in ("lambda1", "lambda2", "v", "E"):
        assert new.points[0].observables[name] == pytest.approx(left.observables[name], abs=1e-9)
    assert new.points[-1].observables["r_min"] < new.points[0].observables["r_min"]


@pytest.mark.parametrize("depth", [-1, 0.5])
def test_depth_is_a_whole_number(depth):
    with pytest.raises(InputError, match="^depth: "):
        diagram(0.48, 15, depth)


def test_an_interrupted_diagram_keeps_the_branches_before_and_ends():
    """One branch is whole, the next is cut, the third is not begun."""

    def interrupt(branch):
        if branch.points[-1].observables["v"] < 0.995:
            raise KeyboardInterrupt

    options = branch_options({"v": 1.01}, max_points=40, progress=interrupt)
    down = branch_options({"v": 0.98}, max_points=40, progress=interrupt)
    found = diagram(0.48, 15, 1, {"pearl": options, "coil": down, "buckle": down}, modes=[(2, 0), (1, 1)])
    assert not found.complete
    assert list(found.branches) == ["2", "coil 1:1"]
    assert found.branches["2"].complete
    assert found.branches["coil 1:1"].status is Status.INTERRUPTED
    assert len(found.branches["coil 1:1"].points) > 1
    assert found.branches["coil 1:1"].points[-1].observables["v"] < 1
