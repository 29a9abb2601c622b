"""Interruptions of what is built on branches: what was computed is kept, and no part of it is taken for the whole."""

from dataclasses import replace

import pandas as pd
import pytest
from support.commands import run

from pearlbvp.continuation.following import continue_branch
from pearlbvp.errors import InputError, Interruption
from pearlbvp.flows import driver
from pearlbvp.helfrich import Tube
from pearlbvp.scans.scan import scan
from pearlbvp.studies import branch as studies_branch
from pearlbvp.studies import falls, region, starts, transitions
from pearlbvp.studies import phases as study
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.diagram import Diagram
from pearlbvp.studies.phases import phases
from pearlbvp.studies.stretches import pieces

TUBE, VOLUMES = Tube(0.0, 6.5), [0.95, 1.01, 1.02]


@pytest.fixture(scope="module")
def whole():
    """Wrinkles, followed from the tube, and what only starts lead to."""
    found = phases(TUBE, VOLUMES, modes=[(0, 2)], depth=0, starts=4, seed=1)
    assert (found.complete, found.starts, len(found.branches), len(found.transitions)) == (True, 4, 3, 4)
    return found


def again(whole, monkeypatch, complete=True, names=None, **how):
    """The same from the branches that it has."""
    known = {name: branch for name, branch in whole.branches.items() if names is None or name in names}
    monkeypatch.setattr(study, "diagram", lambda *_, **more: Diagram(known, {}, complete=complete))
    return phases(TUBE, VOLUMES, depth=0, **how)


def stopped_at(monkeypatch, room, name, number):
    """Interrupt a function of a room at a call."""
    function, calls = getattr(room, name), []

    def interrupted(*arguments, **more):
        calls.append(None)
        if len(calls) == number:
            raise KeyboardInterrupt
        return function(*arguments, **more)

    monkeypatch.setattr(room, name, interrupted)


def test_the_starts_before_an_interruption_count(whole, monkeypatch):
    stopped_at(monkeypatch, starts, "at_rest", 3)
    found = again(whole, monkeypatch, names=["ring 0:2"], starts=4, seed=1, flows=True)
    said = "2 of 4 random starts were relaxed"
    assert (found.complete, found.lacking) == (False, [said])
    assert found.starts == found.rested.total() + found.restless.total() == 2
    assert set(found.table["starts"]) == {2}
    assert found.table["message"].str.contains(f"interrupted: {said}").all()
    assert said in repr(found)
    assert (found.transitions["falls_to"] == "").all()  # flows would take long


def test_branches_before_an_interruption_are_told(whole, monkeypatch):
    found = again(whole, monkeypatch, complete=False)
    assert found.lacking == ["not all branches were followed"]
    assert found.table["message"].str.contains("interrupted: not all branches were followed").all()
    pd.testing.assert_series_equal(found.table["E"], whole.table["E"])
    with pytest.raises(KeyboardInterrupt):
        again(whole, monkeypatch, complete=False, names=[])


@pytest.mark.parametrize(
    ("room", "name", "call", "rows", "events", "said"),
    [
        (study, "_stable_at", 3, 2, 4, "2 of 3 volumes are in the table"),
        (transitions, "equal_energies", 1, 3, 2, "where the least shape changes was not computed"),
        (transitions, "_of_stability", 2, 3, 3, "not all transitions were computed"),
    ],
)
def test_phases_keep_what_was_tabulated(whole, monkeypatch, room, name, call, rows, events, said):
    stopped_at(monkeypatch, room, name, call)
    found = again(whole, monkeypatch)
    assert found.lacking == [said]
    assert (len(found.table), len(found.transitions)) == (rows, events)
    for column in ("v", "E", "branch"):
        assert list(found.table[column]) == list(whole.table[column][:rows])
    assert found.ranges.empty == (name == "equal_energies")


def test_a_flow_that_is_interrupted_is_no_fall(monkeypatch):
    """It would be said to come to no rest, and the next to flow."""
    pearls = family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.01}))
    (stable,) = [piece for piece in pieces("2", pearls) if piece.stable]
    unstable = [piece for piece in pieces("2", pearls) if not piece.stable]
    stopped_at(monkeypatch, driver._Run, "_step", 3)
    with pytest.raises(KeyboardInterrupt):
        falls.falls_to(stable, True, unstable, [stable])


def test_a_scan_keeps_no_part_of_a_branch_as_an_answer(tmp_path, monkeypatch):
    asked = {"c0": 0.0, "L": 10, "family": "pearl", "mode": "1:0", "v": [1.01, 1.02]}
    points = []

    def interrupted(start, options, **more):
        def progress(so_far):
            points.append(so_far)
            if len(points) == 6:  # of the branch after the scout, whose end would say that volumes are out of reach
                raise KeyboardInterrupt

        return continue_branch(start, replace(options, progress=progress), **more)

    with monkeypatch.context() as patched:
        patched.setattr(studies_branch, "continue_branch", interrupted)
        with pytest.raises(KeyboardInterrupt):
            scan("branch", tmp_path / "a.sqlite", workers=1, **asked)
    assert len(points) == 6
    assert scan("branch", tmp_path / "a.sqlite", workers=1, **asked)["status"].tolist() == ["found", "found"]


@pytest.mark.parametrize("call", [1, 2])
def test_a_region_that_is_interrupted_says_so(capsys, monkeypatch, tmp_path, call):
    picture = tmp_path / "p.png"
    stopped_at(monkeypatch, region, "_rows", call)
    words = ["region", "--c0", "0.48", "--periods", "7.5,8", "--pearls", "2", "--starts", "0", "--processes", "1"]
    status, out, err = run(capsys, *words, "--plot", picture)
    assert (status, len(out.splitlines())) == (130, call)
    assert f"interrupted: {call - 1} rows are done and kept" in err
    assert (picture.exists(), "no picture, for no row is done" in err) == (call == 2, call == 1)


def test_only_interruptions_are_caught():
    stopped = Interruption()
    with pytest.raises(InputError), stopped:
        raise InputError("c0", "none")
    with pytest.raises(SystemError), stopped:
        raise SystemError("a defect") from ValueError("of ours")
    assert not stopped.happened
    with stopped:
        raise SystemError("returned a result with an exception set") from KeyboardInterrupt()
    assert stopped.happened
