"""``pearlbvp phases``: its tables and its picture are those of the study; mistakes are said in one line."""

import io
import itertools
import re

import pandas as pd
import pytest
from support.commands import is_png, run

import pearlbvp as pb
from pearlbvp.studies import transitions
from pearlbvp.studies.stable_shapes import COLUMNS
from pearlbvp.studies.transitions import COLUMNS as EVENTS

TUBE = ["--c0", "0.48", "--length", "15", "--mode", "2,0", "--starts", "4", "--processes", "1"]


def test_tables_and_picture(capsys, tmp_path):
    files = {"--transitions": tmp_path / "t.csv", "--plot": tmp_path / "p.png"}
    words = [word for pair in files.items() for word in pair]
    status, out, err = run(capsys, "phases", *TUBE, "--volumes", "1:1.02:0.01", *words)
    assert status == 0, err
    table, events = pd.read_csv(io.StringIO(out)), pd.read_csv(files["--transitions"])
    assert (list(table), list(events)) == (COLUMNS, EVENTS)
    assert is_png(files["--plot"])
    assert "the least of 2 branches to depth 1" in err
    study = pb.phases(pb.Tube(0.48, 15), "1:1.02:0.01", modes=[(2, 0)], processes=1)
    pd.testing.assert_frame_equal(table[["v", "E", "lambda2"]], study.table[["v", "E", "lambda2"]], rtol=1e-11)
    assert list(table["branch"]) == ["straight", "2/1", "2/1"]
    assert list(events["event"]) == ["continuous", "stable", "unstable"]


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--volumes", "1.3:0.6:0.1"], "--volumes"),
        (["--volumes", "1:2:0.5"], "--volumes: no tube of that area"),
        (["--volumes", "1.01", "--plot", "p.png"], "--plot: one volume"),
        (["--volumes", "1.01", "--transitions", "t.csv", "--out", "t.csv"], "--transitions: .* is the file of --out"),
        (["--volumes", "1.01", "--depth", "-1"], ".*--depth"),
    ],
)
def test_mistakes(capsys, tmp_path, monkeypatch, options, named):
    monkeypatch.chdir(tmp_path)
    status, out, err = run(capsys, "phases", *TUBE, *options)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert re.match(f"pearlbvp: {named}", err)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("name", "drawn"), [("_of_stability", True), ("equal_energies", False)])
def test_what_was_computed_before_an_interruption_is_written(capsys, tmp_path, monkeypatch, name, drawn):
    """In the middle of the transitions, and of where the least shape changes, without which there is no picture."""

    def interrupted(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(transitions, name, interrupted)
    files = {"--out": tmp_path / "p.csv", "--transitions": tmp_path / "t.csv", "--plot": tmp_path / "p.png"}
    tube = ["--c0", "0.48", "--length", "15", "--mode", "2,0", "--starts", "0", "--processes", "1"]
    status, out, err = run(capsys, "phases", *tube, "--volumes", "1:1.02:0.01", *itertools.chain(*files.items()))
    assert (status, out) == (130, "")
    assert re.search("interrupted: (not all transitions|where the least shape changes)", err.splitlines()[-1])
    assert list(pd.read_csv(files["--out"])["branch"]) == ["straight", "2/1", "2/1"]
    assert files["--transitions"].exists()
    assert (files["--plot"].exists(), "there is no picture" in err) == (drawn, not drawn)
