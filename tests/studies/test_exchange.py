"""The table of coils, buckles and what joins them: from the other end, and against the amplitude equations."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.meeting import EXCHANGE_COLUMNS, exchange_table
from pearlbvp.studies.onward import switched
from pearlbvp.theory.codimension_two import exchange_lengths

TABLE = Path(__file__).parents[2] / "data" / "coils_and_buckles.csv"


@pytest.fixture(scope="module")
def table():
    return pd.read_csv(TABLE, comment="#")


def test_both_limits_tend_to_the_straight_tube_where_the_amplitude_equations_exchange(table):
    """Volumes linear in the length, extrapolated from two lengths to ``v = 1``; beyond there are none."""
    assert list(table.columns) == EXCHANGE_COLUMNS
    for c0, rows in table.groupby("c0"):
        exact = exchange_lengths(c0, shortest=5.0)[0]
        assert (rows["v_coil"].isna() == (rows["L"] > exact)).all()
        near = rows.dropna(subset="v_coil").sort_values("L").iloc[-2:]
        for name in ("v_coil", "v_buckle"):
            (l0, l1), (v0, v1) = near["L"], near[name]
            assert l1 + (1 - v1) * (l1 - l0) / (v1 - v0) == pytest.approx(exact, abs=5e-3)


def test_the_gap_is_of_second_order_and_says_who_is_stable_in_it(table):
    """Where coils begin to be stable above the end of the buckles both are, and what joins them is not."""
    rows = table.dropna(subset="v_coil")
    gap = rows["v_coil"] - rows["v_buckle"]
    assert ((rows["n_mixed"] == 1) == (gap > 0)).all()
    assert (rows["both_stable"].astype(str) == (gap > 0).astype(str)).all()
    for c0 in (0.1, 0.48):
        one = gap[rows["c0"] == c0].to_numpy()
        orders = np.log2(one[:-1] / one[1:])  # lengths 0.4, 0.2, 0.1 from the exchange
        np.testing.assert_allclose(orders, 2, atol=0.15)


def test_mixed_tubes_join_the_coils_and_the_buckles_of_the_table(table):
    """From the buckles on, in a frame at rest, to the point that the coils have in a turning one."""
    row = table[(table["c0"] == 0.48) & table["v_coil"].notna()].iloc[-1]
    buckles = family_branch(Tube(0.48, row["L"]), "buckle", (1, 1), branch_options({"v": 0.995}, max_step=0.3))
    assert buckles.at(buckles.find("bp")[0]).observables["v"] == pytest.approx(row["v_buckle"], abs=1e-9)
    mixed = switched(buckles, 1, branch_options(max_points=12, max_step=0.1))
    assert "pitchfork" in mixed.reason
    assert mixed.points[-1].observables["v"] == pytest.approx(row["v_coil"], abs=1e-7)
    again = exchange_table([0.48], [row["L"] - row["exchange"]], lowest=0.995).iloc[0]
    for name in ("v_coil", "lambda2_coil", "v_buckle", "lambda2_buckle"):
        assert again[name] == pytest.approx(row[name], abs=1e-9)
