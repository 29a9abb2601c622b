"""The scan of pearl periods: against the localized tables, over processes, and its answers for odd cases."""

import math

import pytest

from pearlbvp.errors import InputError
from pearlbvp.studies.localized import localized_pearls
from pearlbvp.studies.period import COLUMNS, pearl_periods, rows_of
from pearlbvp.theory.dispersion import critical_lambda2


def test_scan_agrees_with_the_table_of_each_period():
    table = pearl_periods(0.48, [15, 30, 34.5, 60], progress=False)
    assert list(table.columns) == COLUMNS
    for row in table.itertuples():
        assert row.status == row.localized_status == "found"
        alone = localized_pearls(0.48, row.period, [row.L]).iloc[0]
        assert alone.v == pytest.approx(row.v_localized, abs=1e-10)
        # The first pearls: no other number of pearls appears at a larger lambda2.
        for m in range(1, 12):
            k = 2 * math.pi * m / row.L
            if k < 1:
                assert float(critical_lambda2(k, 0, 0.48)) <= row.lambda2_pearl
        assert row.k == pytest.approx(2 * math.pi / row.period)
        assert row.upper_mode == "1:1"
        assert row.lambda2_upper == pytest.approx(0.04 + (2 * math.pi / row.L) ** 2 / 2)


def test_processes_change_nothing():
    lengths = [14 + 0.5 * i for i in range(18)]
    one = pearl_periods([0.3, 0.48], lengths, processes=1, progress=False)
    two = pearl_periods([0.3, 0.48], lengths, processes=2, progress=False)
    assert list(one.c0) == [0.3] * 18 + [0.48] * 18
    assert one.equals(two)


def test_odd_cases_are_answers():
    assert rows_of(0.6, [30.0])[0]["status"] == "no_stable_cylinder"
    (single,) = rows_of(0.0, [10.0])
    assert (single["status"], single["pearls"], single["localized_status"]) == ("found", 1, "single_pearl")
    (short,) = rows_of(0.48, [6.0])
    assert short["status"] == "none_in_range"
    assert "k < 1" in short["message"]


def test_below_one_quarter_the_longest_pearl_comes_first():
    table = pearl_periods(0.1, [10, 40, 90], progress=False)
    assert list(table.pearls) == [1, 1, 1]
    assert table.lambda2_pearl.is_monotonic_increasing or table.lambda2_pearl.is_monotonic_decreasing


def test_no_bar_where_nobody_watches(capsys):
    pearl_periods(0.48, [15])
    assert capsys.readouterr().err == ""


def test_an_interrupted_scan_keeps_its_rows(monkeypatch, capsys):
    from pearlbvp.studies import period

    def interrupted(curvatures, lengths, v, processes):
        yield period.rows_of(curvatures[0], lengths)
        raise KeyboardInterrupt

    monkeypatch.setattr(period, "scan", interrupted)
    assert len(pearl_periods([0.3, 0.48], [15, 30], progress=False)) == 2
    assert "2 of 4 rows" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("c0", "lengths", "name"), [(0.48, [], "lengths"), ([], [10], "c0"), ("x", [10], "c0"), (0.48, [0], "length")]
)
def test_mistakes(c0, lengths, name):
    with pytest.raises(InputError, match=f"^{name}: "):
        pearl_periods(c0, lengths)


def test_every_case_of_an_iterator():
    assert len(pearl_periods(iter([0.4, 0.48]), iter([20, 21]), progress=False)) == 4
    assert pearl_periods("0.4,0.48", "20:21:1", progress=False).equals(
        pearl_periods([0.4, 0.48], [20, 21], progress=False)
    )


@pytest.mark.parametrize("processes", [0, -3, "2"])
def test_processes_are_counted(processes):
    with pytest.raises(InputError, match="^processes: "):
        pearl_periods(0.48, [15], processes=processes)


def test_modes_near_one_quarter_do_not_break_the_table():
    table = pearl_periods(0.27, "66:76:2", progress=False)
    assert set(table.localized_status) <= {"found", "single_pearl"}
