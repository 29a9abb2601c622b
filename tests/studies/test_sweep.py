"""Branches drawn from the whole range of tubes, modes and steps: each is right, or ends with a reason, and never in a trace."""

from __future__ import annotations

import pytest
from support.sweep import Case, drawn, drawn_diagram, faults, faults_of_diagram, unstable_on_the_cylinder

from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch

SLOW = {1, 4, 9, 20, 22, 28, 39}
"""Cases of several seconds or more each, which the benchmark has."""


@pytest.mark.parametrize("seed", sorted(set(range(45)) - SLOW))
def test_branches_of_any_tube_are_right_or_end_with_a_reason(seed):
    found, _ = faults(drawn(seed, max_points=4))
    assert not found


@pytest.mark.parametrize(
    ("c0", "length"), [(-1.0, 40), (0.25, 40), (1.5, 40), (0.48, 60), (0.25, 100), (0.25, 0.32), (0.25, 0.37)]
)
def test_buckles_of_long_and_short_tubes(c0, length):
    """On these more waves may grow than the solution's own points tell apart."""
    found, branch = faults(Case("buckle", c0, length, 1, 1, 0.5, 5))
    assert not found
    assert branch.points[-1].observables["v"] < 0.9999
    assert all(entry.spectrum.complete for entry in branch.points)


@pytest.mark.parametrize(("c0", "length", "m"), [(-1.13361, 3.81249, 2), (2.45951, 2.16036, 4), (0.23098, 3.81383, 4)])
def test_all_that_grows_on_a_coil_is_counted(c0, length, m):
    """Dozens of waves, more of a kind than a spectrum keeps at least, and of many turns in the coil's frame."""
    branch = family_branch(Tube(c0, length), "coil", (m, 1), branch_options(max_points=2))
    start = branch.points[0]
    expected = unstable_on_the_cylinder(Case("coil", c0, length, m, 1, 0.5), start.observables["lambda2"])
    assert start.spectrum.n_unstable == expected > 20


@pytest.mark.parametrize("seed", [2, 9, 12, 16, 28])
def test_diagrams_of_any_tube_name_all_that_crosses_and_follow_it_from_there(seed):
    assert not faults_of_diagram(*drawn_diagram(seed))
