"""The tables of stable pearls in ``data``: by Floquet's multipliers, by closed forms, and one against the other."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pearlbvp.helfrich import Tube
from pearlbvp.stability.floquet import neutral_cosines
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.region import COLUMNS
from pearlbvp.studies.unequal_pearls import COLUMNS as UNEQUAL
from pearlbvp.studies.unequal_pearls import unequal_pearls
from pearlbvp.theory.unduloid import unduloid_of

DATA = Path(__file__).parents[2] / "data"
EQUAL = pd.read_csv(DATA / "stable_pearls.csv", comment="#")
OTHERS = pd.read_csv(DATA / "unequal_pearls.csv", comment="#")
FOUND = EQUAL[EQUAL.status == "found"]


def interval(c0, period, pearls):
    rows = FOUND[(FOUND.c0 == c0) & (FOUND.period == period) & (FOUND.pearls == pearls)]
    return rows.iloc[-1]


def test_what_is_stable_on_more_pearls_is_stable_on_fewer():
    """Inclusion of the intervals, for each number of pearls in those of half as many; infinitely many in all."""
    assert list(EQUAL.columns) == [*COLUMNS]
    assert list(OTHERS.columns) == [*UNEQUAL]
    for _, rows in FOUND.groupby(["c0", "period"]):
        for fewer, more in ((1, 2), (2, 4), (4, 8), (8, math.inf)):
            outer = rows[rows.pearls == fewer]
            for row in rows[rows.pearls == more].itertuples():
                assert ((outer.v_from <= row.v_from + 1e-9) & (row.v_to <= outer.v_to + 1e-9)).any()


def test_ends_at_unduloids_are_where_these_are_in_closed_form():
    rows = FOUND[FOUND.from_limit == "unduloid"]
    assert len(rows) > 20
    np.testing.assert_allclose(rows.v_from, [unduloid_of(period).v for period in rows.period], atol=1e-10)
    assert rows.pearls.eq(1).all()


def test_pearls_of_finite_period_are_stable_beyond_half_on_a_tube_of_any_length():
    """What ends that is an infinitely long wave, along the tube or across, or a neck that is too thin to go on."""
    endless = FOUND[FOUND.pearls == math.inf]
    assert endless[endless.c0 > 0.5].c0.nunique() > 2
    for side in ("from", "to"):
        ends = endless[endless[f"{side}_limit"] != "thin neck"]
        assert ends[f"n_{side}"].isin([0, 1]).all()
        assert (ends[f"theta_{side}"] == 0).all()


@pytest.mark.parametrize(
    ("c0", "period", "pearls", "side"), [(0.55, 5, 4, "from"), (0.55, 5, 4, "to"), (0.6, 4, 2, "to")]
)
def test_limits_are_where_a_floquet_multiplier_says(c0, period, pearls, side):
    """On the branch that leaves the straight tube, found again from its volume."""
    row = interval(c0, period, pearls)
    v, n, theta = (row[name] for name in (f"v_{side}", f"n_{side}", f"theta_{side}"))
    end = family_branch(Tube(c0, period), "pearl", (1, 0), branch_options({"v": v})).points[-1]
    assert end.value("v") == pytest.approx(v, abs=1e-11)
    other = neutral_cosines(end.problem.profile(end.u), int(n))[1]
    assert other == pytest.approx(2 * math.cos(theta), abs=2e-6)


@pytest.mark.parametrize(("length", "pearls"), [(10, 2), (20, 4)])
def test_unequal_pearls_become_stable_where_equal_ones_stop_to_be(length, pearls):
    """At c0 = 0.75: two and four pearls of period 5, and P and one large and three smaller pearls, meet at branch points."""
    equal = interval(0.75, 5, pearls)
    meeting = OTHERS[(OTHERS.c0 == 0.75) & (length == OTHERS.L) & (OTHERS.periods == 1)]
    gaps = (meeting.v_from - equal.v_to).abs()
    assert gaps.min() < 2e-8
    assert meeting.v_to[gaps.idxmin()] == pytest.approx(1.3)
    assert meeting.bellies[gaps.idxmin()] == pearls


def test_unequal_pearls_are_found_again_from_other_random_shapes():
    rows = OTHERS[(OTHERS.c0 == 0.75) & (OTHERS.L == 10) & (OTHERS.periods == 1)]
    again = unequal_pearls(0.75, 10, periods=1, starts=3, seed=1)
    for one in again.itertuples():
        assert ((rows.v_from - one.v_from).abs() < 1e-9).any()
    assert len(again)
