"""Random starts: they come to rest on branches that are followed otherwise, and lead to those that are not."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pearlbvp.continuation.following import continue_branch
from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.phases import phases
from pearlbvp.studies.search import Search
from pearlbvp.studies.spheres import strings_of_spheres
from pearlbvp.studies.starts import Start, at_rest, starts_within
from pearlbvp.theory.elastica import ring_at

GRAPH = Path(__file__).parents[2] / "data" / "graph_c0_075.csv"


def test_starts_come_to_rest_on_a_branch_that_was_followed():
    found = phases(Tube(0.48, 10), [1.05, 1.1], modes=[(1, 0)], depth=0, starts=6, seed=3)
    assert found.rested == {"1": 6}
    assert (not found.origins, not found.restless) == (True, True)
    assert set(found.table["rest_here"]) == {6}
    assert "6 of 6 random starts" in found.rests_on


@pytest.mark.parametrize(
    ("axisymmetric", "v", "family", "mode"), [(True, 1.1, "pearl", (1, 0)), (False, 0.9, "coil", (1, 1))]
)
def test_what_is_minimised_is_what_is_followed(axisymmetric, v, family, mode):
    tube = Tube(0.0, 10)
    rest, end = (
        at_rest(Start(tube, v, (0, 1), axisymmetric)),
        family_branch(tube, family, mode, branch_options({"v": v})),
    )
    for name in ("E", "lambda1", "lambda2"):
        assert rest.value(name) == pytest.approx(end.points[-1].value(name), abs=1e-8)
    assert rest.spectrum.n_unstable == 0
    assert rest.value("E") == pytest.approx(end.points[-1].value("E"), abs=1e-9)


def test_a_symmetric_tube_that_few_modes_take_for_a_minimum_leads_on_to_one_that_is():
    """Wrinkles at ``c0 = -1`` on ``L = 10`` are unstable below ``v = 0.87565``: to a wave along them.

    The energy of the wrinkled tube with one wave is that of its branch, followed on twice as many modes.
    """
    wrinkled = at_rest(Start(Tube(-1.0, 10), 0.86, (0, 2), False))
    assert (wrinkled.problem.repeats, wrinkled.spectrum.n_unstable) == ((1, 2), 0)
    assert wrinkled.value("E") == pytest.approx(2.35926042685, abs=1e-10)
    assert 0 < ring_at(2, "v", 0.86).energy(-1.0) - wrinkled.value("E") < 1e-3


def test_a_start_leads_to_a_branch_that_was_not_followed():
    """Coils, where wrinkles alone are asked for: the whole branch, back to where the straight tube begins."""
    found = phases(Tube(0.0, 10), [0.92, 0.95], modes=[(0, 2)], depth=0, starts=2)
    (name,) = found.origins
    coil = family_branch(Tube(0.0, 10), "coil", (1, 1), branch_options({"v": 0.92})).points[-1]
    assert found.shapes(0.92)[name].value("E") == pytest.approx(coil.value("E"), abs=1e-9)
    (row,) = found.table[(found.table["v"] == 0.92) & (found.table["branch"] == name)].itertuples()
    assert (row.family, row.rank, row.starts) == ("coil", 1, 2)
    assert row.rest_here == found.rested[name] > 0


def test_the_same_seed_makes_the_same_starts():
    cases = starts_within(Tube(0.0, 10), 0.9, 1.1, 5, 7)
    assert cases == starts_within(Tube(0.0, 10), 0.9, 1.1, 5, 7) != starts_within(Tube(0.0, 10), 0.9, 1.1, 5, 8)
    assert np.diff([case.v for case in cases]).min() > 0
    first, again = at_rest(cases[-1]), at_rest(cases[-1])
    assert np.array_equal(first.u, again.u)


def test_one_large_and_three_smaller_pearls_are_found_that_no_branch_leads_to():
    """Stable from ``v = 0.974637`` to 1.3, as the flow showed: where they begin to be, another branch crosses, not the tube."""
    found = phases(Tube(0.75, 20), [0.97, 1.0], depth=0, modes=[(3, 0)], starts=4)
    (event,) = found.transitions[found.transitions["event"] == "stable"].itertuples()
    assert event.branch.startswith("start")
    assert event.v == pytest.approx(0.974637, abs=1e-6)
    assert (event.other, event.critical) == ("", "n=0 j=0/1 even")
    assert found.shapes(1.0)[event.branch].problem.repeats == (1, 0)


def test_a_sphere_on_a_tether_comes_to_the_pearls_that_leave_two_equal_ones():
    """The paper's P, whose end at ``lambda1 = 30`` is known from two equal pearls of period 5, which it leaves (data)."""
    known = pd.read_csv(GRAPH, comment="#").set_index("branch").loc["P"]
    onwards = branch_options({"lambda1": 30.0}, max_step=20)
    found = Search.of({})
    strings_of_spheres(Tube(0.75, 10), found, 1.0, 1.3, 0, lambda shape: continue_branch(shape, onwards))
    end = found.branches["spheres 1"].points[-1]
    assert end.spectrum.n_unstable == known.n_unstable == 0
    assert end.value("v") == pytest.approx(known.v_to, abs=1e-7)
    assert end.value("E") == pytest.approx(known.E_to, abs=1e-7)
