"""Scans: answers are those of the studies, nothing finished is lost or done twice, and what cannot be done is a row."""

import os
import signal
import sqlite3
import subprocess
import sys
import time
from concurrent.futures import Executor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from support.commands import run

import pearlbvp as pb
from pearlbvp.errors import InputError
from pearlbvp.scans import run as runs
from pearlbvp.scans.case import Case, Outcome
from pearlbvp.scans.engines import Here, TimedOut, dask, given, local, within
from pearlbvp.scans.questions import MANY, QUESTIONS, Question
from pearlbvp.scans.run import units_of
from pearlbvp.scans.scan import cases_of, scan, scanned, table_of
from pearlbvp.scans.store import Store
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.localized import localized_pearls
from pearlbvp.studies.pearl_series import FEWEST
from pearlbvp.theory.elastica import ring_at

DISPERSION = QUESTIONS["dispersion"]


def test_rows_are_those_of_the_studies(tmp_path):
    lengths = [15, 22.5, 30]
    found = scan("localized", tmp_path / "s.sqlite", c0=0.48, period=7.5, L=lengths, workers=1)
    pd.testing.assert_frame_equal(found, localized_pearls(0.48, 7.5, lengths), check_dtype=False)
    found = scan("region", tmp_path / "s.sqlite", c0=0.48, period=[7.5, 8], pearls=[2, 3], workers=1)
    alone = [localized_pearls(0.48, period, [2 * period, 3 * period]) for period in (7.5, 8)]
    pd.testing.assert_frame_equal(found, pd.concat(alone, ignore_index=True), check_dtype=False)
    found = scan("dispersion", tmp_path / "s.sqlite", c0=[0.3], L=[10], workers=1)
    assert found["lambda2"].tolist() == pb.dispersion(pb.Tube(0.3, 10))["lambda2"].tolist()


def test_a_branch_is_asked_at_volumes_on_either_side(tmp_path):
    volumes = [0.99, 1.02, 1.04]
    found = scan("branch", tmp_path / "s.sqlite", c0=0.0, L=10, family="pearl", mode="1:0", v=volumes, workers=1)
    assert found["v"].tolist() == volumes
    assert found["status"].tolist() == ["none_in_range", "found", "found"]
    alone = pb.branch(pb.Tube(0.0, 10), "pearl", (1, 0), until={"v": 1.04})[-1]
    assert found["lambda2"][2] == pytest.approx(alone.observables["lambda2"], abs=1e-8)


def test_a_branch_is_asked_up_to_where_it_ends(tmp_path):
    """Rings of two lobes touch themselves below v = 0.28, whatever their stability."""
    volumes = [0.2, 0.3, 0.5]
    found = scan("branch", tmp_path / "s.sqlite", c0=0.0, L=10, family="ring", mode="0:2", v=volumes, workers=1)
    assert found["status"].tolist() == ["none_in_range", "found", "found"]
    assert "the surface touches itself" in found["message"][0]
    for v, lambda2 in zip(volumes[1:], found["lambda2"][1:], strict=True):
        assert lambda2 == pytest.approx(ring_at(2, "v", v).lambda2, abs=1e-8)


def test_shapes_of_a_tube_are_asked_by_volume(tmp_path):
    found = scan("phases", tmp_path / "s.sqlite", c0=0.48, L=[7.5], v=[1.005, 1.02], workers=1)
    expected = pb.phases(pb.Tube(0.48, 7.5), [1.005, 1.02], starts=12, processes=1)
    assert (found["branch"].tolist(), found["rank"].tolist()) == (["1", "1"], [1, 1])
    for name in ("E", "starts", "rest_here"):
        assert found[name].tolist() == expected.table[name].tolist()
    assert set(found["status"]) == {"found"}
    with pytest.raises(InputError, match="^volumes: no tube of that area"):
        scan("phases", tmp_path / "s.sqlite", c0=0.48, L=10, v=1.6, workers=1)


def test_pearls_of_the_critical_period_are_those_that_the_tube_loses_its_stability_to(tmp_path):
    found = scan("localized", tmp_path / "s.sqlite", c0=0.48, period="critical", L=[5, 16, 30], workers=1)
    expected = pb.pearl_periods(0.48, [5, 16, 30], processes=1)
    assert found["v"].tolist()[1:] == expected["v_localized"].tolist()[1:]
    assert found["status"].tolist() == expected["localized_status"].tolist()


class Counting(Here):
    """An executor that knows what it was asked."""

    def __init__(self):
        self.units = []

    def submit(self, fn, /, unit, *rest):
        self.units.append(unit)
        return super().submit(fn, unit, *rest)


def test_what_is_finished_is_not_done_again_and_other_cases_are_added(tmp_path):
    first, second = Counting(), Counting()
    scan("dispersion", tmp_path / "s.sqlite", c0=[0.3], L="10:14:1", executor=first)
    both = scan("dispersion", tmp_path / "s.sqlite", c0=[0.3], L="10:16:1", executor=second)
    assert (len(first.units), len(second.units)) == (5, 2)
    assert [unit[0].parameters[1] for unit in first.units] == [10, 14, 12, 11, 13]
    assert both["L"].unique().tolist() == [10, 11, 12, 13, 14, 15, 16]


def test_an_interrupted_scan_keeps_what_is_finished(tmp_path):
    class Interrupted(Counting):
        def submit(self, fn, /, unit, *rest):
            if len(self.units) == 3:
                raise KeyboardInterrupt
            return super().submit(fn, unit, *rest)

    with pytest.raises(KeyboardInterrupt):
        scan("dispersion", tmp_path / "s.sqlite", c0=[0.3], L="10:16:1", executor=Interrupted())
    with Store(tmp_path / "s.sqlite") as kept:
        progress = kept.progress("dispersion", {})
        assert (progress.running, sum(progress.counts.values())) == (False, 7)
        assert progress.counts["done"] in (2, 3)


SCAN = """
import sys
from pearlbvp.scans.scan import scan
scan("dispersion", sys.argv[1], c0="0.3,0.48", L="10:25:0.25", workers=int(sys.argv[2]), progress=False)
"""


def test_a_killed_scan_goes_on_with_nothing_lost_and_the_same_table(tmp_path):
    """Killed with its workers at several moments; every outcome that was in the store stays as it was."""
    whole = scan("dispersion", tmp_path / "w.sqlite", c0="0.3,0.48", L="10:25:0.25", workers=1)
    path, known = tmp_path / "k.sqlite", {}
    for delay in (0.05, 0.3, 0.6):
        work = subprocess.Popen([sys.executable, "-c", SCAN, path, "1"], start_new_session=True)
        while not path.exists() and work.poll() is None:
            time.sleep(0.005)
        time.sleep(delay)
        os.killpg(work.pid, signal.SIGKILL)
        work.wait()
        with Store(path, writing=True) as kept:
            now = {case: found for case, found in kept.outcomes("dispersion", {})}
            assert {case: now.get(case) for case in known} == known
            known = now
    again = scan("dispersion", path, c0="0.3,0.48", L="10:25:0.25", workers=1)
    assert again.to_csv() == whole.to_csv()


def _kill_or_answer(cases):
    if cases[0].parameters[0] == 3.0:
        os.kill(os.getpid(), signal.SIGKILL)
    return [[{"c0": case.parameters[0], "v": 1.0}] for case in cases]


def _fail_or_answer(cases):
    if any(case.parameters[0] == 3.0 for case in cases):
        raise ValueError("three is too much")
    return [[{"c0": case.parameters[0], "v": 1.0}] for case in cases]


def _take_long(cases):
    until = time.monotonic() + (60 if cases[0].parameters[0] == 3.0 else 0)
    while time.monotonic() < until:
        pass
    return [[{"c0": case.parameters[0], "v": 1.0}] for case in cases]


def _asked(monkeypatch, tmp_path, rows, engine, **how):
    """The table of seven cases of a question that is answered by ``rows``."""
    question = Question("trial", ("c0",), ("c0", "status", "v", "message"), rows)
    monkeypatch.setitem(QUESTIONS, "trial", question)
    cases = cases_of(question, {"c0": "0:6:1"})
    with Store(tmp_path / "s.sqlite", writing=True) as kept:
        scanned(question, kept.ask(cases, {}), kept, engine, workers=2, progress=False, **how)
        return table_of(question, kept)


def _one_failed(table, said):
    assert table["c0"].tolist() == list(range(7))
    assert table["status"].isna().tolist() == [True, True, True, False, True, True, True]
    assert said in table["message"][3]


def test_a_case_that_raises_is_a_row_and_the_scan_goes_on(monkeypatch, tmp_path):
    _one_failed(_asked(monkeypatch, tmp_path, _fail_or_answer, local(1)), "three is too much")


def test_a_case_that_takes_too_long_is_a_row_and_the_scan_goes_on(monkeypatch, tmp_path):
    _one_failed(_asked(monkeypatch, tmp_path, _take_long, local(1), seconds=0.2), "longer than 0.2 s")


class Fragile(Executor):
    """An executor whose worker dies of one case and takes what is in work with it."""

    def __init__(self):
        self.inside, self.broken = ThreadPoolExecutor(1), False

    def submit(self, fn, /, unit, *rest):
        if self.broken:
            raise BrokenProcessPool("a worker died")
        if unit[0].parameters[0] == 3.0:
            self.broken = True
        future = self.inside.submit(fn, unit, *rest) if not self.broken else self.inside.submit(_die)
        return future


def _die():
    raise BrokenProcessPool("a worker died")


def test_the_case_that_kills_its_worker_is_found_and_the_others_are_done(monkeypatch, tmp_path):
    def engine():
        return given(Fragile())()

    table = _asked(monkeypatch, tmp_path, _fail_or_answer, engine)
    _one_failed(table, "its worker process died")


def test_failed_cases_are_done_again_when_that_is_asked(monkeypatch, tmp_path):
    _asked(monkeypatch, tmp_path, _fail_or_answer, local(1))
    question = Question("trial", ("c0",), ("c0", "status", "v", "message"), _take_long)
    monkeypatch.setitem(QUESTIONS, "trial", question)
    with Store(tmp_path / "s.sqlite", writing=True) as kept:
        assert kept.progress("trial", {}).counts == {"done": 6, "failed": 1, "waiting": 0}
        failed = kept.retry("trial", {})
        assert [case.parameters for case in failed] == [(3.0,)]
        kept.put({failed[0]: Outcome(({"c0": 3.0, "v": 2.0},))}, {})
        assert table_of(question, kept)["v"].tolist() == [1, 1, 1, 2, 1, 1, 1]


def test_time_is_up_in_any_thread():
    with ThreadPoolExecutor(1) as pool, pytest.raises(TimedOut):
        pool.submit(within, 0.1, _take_long, [Case("trial", (3.0,))]).result()
    assert within(5, lambda: 3) == 3


def test_two_scans_do_not_write_one_store_but_another_may_look(tmp_path):
    path = tmp_path / "s.sqlite"
    with Store(path, writing=True) as kept:
        kept.ask([Case("dispersion", (0.3, 10.0))], {})
        with pytest.raises(InputError, match="a scan is at work"):
            Store(path, writing=True)
        with Store(path) as looked:
            assert looked.progress("dispersion", {}).counts["waiting"] == 1
            assert looked.running
    with Store(path) as looked:
        assert not looked.running


def test_files_that_are_no_stores_are_refused(tmp_path):
    (tmp_path / "text").write_text("c0,L\n" * 1000)
    other = sqlite3.connect(tmp_path / "other.sqlite")
    other.execute("CREATE TABLE cases (name TEXT)")
    other.commit()
    other.close()
    whole = tmp_path / "whole.sqlite"
    scan("dispersion", whole, c0=[0.3], L="10:30:1", workers=1)
    content = whole.read_bytes()
    (tmp_path / "cut").write_bytes(content[: len(content) // 2])
    for name in ("text", "other.sqlite", "cut", "none", "folder/none"):
        for writing in (False, True):
            if (name, writing) == ("none", True):
                continue
            with pytest.raises(InputError, match="store: "), Store(tmp_path / name, writing=writing) as kept:
                kept.outcomes("dispersion", {})


def test_a_scheduler_that_does_not_answer_is_named(monkeypatch):
    pytest.importorskip("distributed")
    from pearlbvp.scans import engines

    monkeypatch.setattr(engines, "PATIENCE", 0.5)
    with pytest.raises(InputError, match="scheduler: tcp://127.0.0.1:9 does not answer"), dask("tcp://127.0.0.1:9")():
        pass


CHILD = "import os, time; from pearlbvp.studies.parallel import serve; serve(os.getppid()); print(1, flush=True); time.sleep(60)"
PARENT = "import subprocess, sys; subprocess.run([sys.executable, '-c', sys.argv[1]])"


def test_a_worker_ends_when_its_parent_is_killed():
    """Of the parent that is killed only the child holds standard output, which ends with it."""
    with subprocess.Popen([sys.executable, "-c", PARENT, CHILD], stdout=subprocess.PIPE) as parent:
        assert parent.stdout.readline() == b"1\n"
        parent.kill()
        begun = time.monotonic()
        assert parent.stdout.read() == b""
    assert time.monotonic() - begun < 30


def test_many_periods_of_a_c0_come_from_a_series_and_are_those_of_a_continuation_each(tmp_path):
    """60 periods, more than the continuations that a series takes; further ones need none."""
    question = QUESTIONS["region"]
    assert MANY == FEWEST
    some, many = (cases_of(question, {"c0": 0.45, "period": f"7:10:{step}", "pearls": "2,5"}) for step in (0.1, 0.05))
    assert (len(units_of(question, some)), len(units_of(question, many))) == (31, 1)
    found = scan("region", tmp_path / "s.sqlite", c0=0.45, period="7:10:0.05", pearls="2,5", workers=1)
    with Store(tmp_path / "s.sqlite") as kept:
        assert kept.series(0.45)
    rows = found[found["status"] == "found"].iloc[::20]
    assert len(rows) > 2
    for _, row in rows.iterrows():
        (alone,) = localized_pearls(0.45, row.period, [row.L]).itertuples()
        assert [row.lambda2, row.v, row.amplitude] == pytest.approx([alone.lambda2, alone.v, alone.amplitude], abs=1e-9)


def test_what_is_missing_among_whole_numbers_is_kept(tmp_path):
    """Waves of a tube without a length have no number along it."""
    found = scan(
        "growth", tmp_path / "s.sqlite", c0=0, lambda1=1.5, L="any", viscosity_ratio=1, membrane_viscosity=0, workers=1
    )
    assert found["m"].isna().all()
    assert found["n"].unique().tolist() == [0, 1, 2]


def test_a_cluster_that_does_not_start_is_named(monkeypatch):
    distributed = pytest.importorskip("distributed")

    def fail(**options):
        raise RuntimeError("Nanny failed to start.")

    monkeypatch.setattr(distributed, "LocalCluster", fail)
    with pytest.raises(InputError, match="^workers: the cluster did not start .Nanny failed"), dask(2)():
        pass


def test_units_are_answered_case_by_case_where_the_whole_fails(monkeypatch):
    question = Question("trial", ("c0",), ("c0", "status", "v", "message"), _fail_or_answer)
    monkeypatch.setitem(QUESTIONS, "trial", question)
    outcomes = runs.answer(tuple(Case("trial", (float(i),)) for i in range(5))).outcomes
    assert [outcome.status for outcome in outcomes] == ["done", "done", "done", "failed", "done"]


def test_a_cluster_gives_the_same_bytes_as_one_process(tmp_path):
    def exported(name, **engine):
        tables = [
            scan("dispersion", tmp_path / name, c0=[0.3, 0.48], L="10:20:1", **engine),
            scan("localized", tmp_path / name, c0=[0.48], period=[7.5], L=[15, 30], **engine),
        ]
        paths = [tmp_path / f"{name}{i}.csv" for i in range(2)]
        for table, path in zip(tables, paths, strict=True):
            table.to_csv(path)
        return [path.read_bytes() for path in paths]

    assert exported("dask", workers="dask:2") == exported("one", workers=1)


def test_tables_are_read_back_from_parquet(tmp_path, capsys):
    store, table = tmp_path / "s.sqlite", tmp_path / "t.parquet"
    question = ["--c0", "0.48", "--period", "7.5", "--lengths", "15,30"]
    assert run(capsys, "scan", "localized", *question, "--store", store, "--workers", "1", "--out", table)[0] == 0
    expected = localized_pearls(0.48, 7.5, [15, 30])
    pd.testing.assert_frame_equal(pd.read_parquet(table), expected, check_dtype=False)


def test_further_lengths_are_answered_from_the_series_that_are_kept(tmp_path, monkeypatch):
    from pearlbvp.studies import pearl_series

    scan("period", tmp_path / "s.sqlite", c0=[0.4], L="18:80:0.5", workers=1)

    def refuse(*arguments):
        raise AssertionError("a continuation")

    monkeypatch.setattr(pearl_series.PearlSeries, "over", refuse)
    monkeypatch.setattr(pearl_series, "losses_at", refuse)
    periods = scan("period", tmp_path / "s.sqlite", c0=[0.4], L="18:80:0.25", workers=1)
    assert (periods.localized_status == "found").all()
    pearls = scan("localized", tmp_path / "s.sqlite", c0=[0.4], period="critical", L="18:80:0.25", workers=1)
    np.testing.assert_allclose(pearls.v, periods.v_localized, atol=1e-9)
    monkeypatch.undo()
    row = periods[periods.L == 33.5].iloc[0]
    assert localized_pearls(0.4, row.period, 33.5).v[0] == pytest.approx(row.v_localized, abs=1e-9)


def test_without_growth_rates_a_branch_leads_to_the_same_shapes():
    tube, options = pb.Tube(0.48, 15), branch_options({"v": 1.02})
    whole = family_branch(tube, "pearl", (2, 0), options)
    scout = family_branch(tube, "pearl", (2, 0), replace(options, folds=(), stability=False))
    assert (len(whole.find("bp")) > 0, scout.find("bp"), scout.points[-1].spectrum.rates) == (True, [], {})
    assert scout.points[-1].observables == pytest.approx(whole.points[-1].observables, abs=1e-8)
