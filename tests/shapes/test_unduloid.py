"""Unduloids in closed form are where branches of pearls have infinite multipliers."""

import numpy as np
import pytest

from pearlbvp.helfrich import Tube
from pearlbvp.shapes.unduloid import unduloid_pearl
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.phases import phases
from pearlbvp.studies.search import Search
from pearlbvp.studies.unduloids import beside_unduloids
from pearlbvp.theory.unduloid import unduloid_of


def test_a_branch_passes_the_unduloid_of_its_period():
    """Continuation and the closed form have nothing in common but the model."""
    branch = family_branch(Tube(0.75, 10), "pearl", (2, 0), branch_options({"cmc": 1}))
    place, exact = branch.points[-1].observables, unduloid_of(5)
    assert place["v"] == pytest.approx(exact.v, abs=1e-10)
    assert place["r_min"] == pytest.approx((1 - exact.shape) / (2 * exact.mean), abs=1e-8)
    assert place["r_max"] == pytest.approx((1 + exact.shape) / (2 * exact.mean), abs=1e-8)
    assert place["E"] == pytest.approx((exact.mean - 0.75) ** 2, abs=1e-10)
    known = Search.of({"2": branch})
    beside_unduloids(Tube(0.75, 10), known, 0.96, 1, 2, lambda shape: branch)
    assert list(known.branches) == ["2"]


def test_it_solves_the_equations_of_the_chart_of_large_multipliers():
    coarse, fine = (
        float(np.abs(problem.residual(u)).max())
        for problem, u in (unduloid_pearl(0.3, unduloid_of(5), intervals=n) for n in (24, 48))
    )
    assert fine < 1e-7
    assert coarse / fine > 2**4.5  # what collocation leaves, with the order of its polynomials' derivatives
    assert unduloid_of(6.4) is None  # longer than the cylinder's neutral wave, 2 pi
    assert unduloid_of(2 * np.pi - 1e-4).v == pytest.approx(1, abs=1e-6)


def test_pearls_beside_an_unduloid_are_followed_where_nothing_leads_there():
    found = phases(Tube(0.75, 10), [0.96, 0.98], depth=0, modes=[(0, 2)], starts=1)
    branch = found.branches["unduloid 2"]
    assert branch.at(branch.find("cmc")[0]).value("v") == pytest.approx(unduloid_of(5).v, abs=1e-9)
