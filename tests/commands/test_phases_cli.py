"""``pearlbvp phases``: its tables and its picture are those of the study; mistakes are said in one line."""

import io
import re

import pandas as pd
import pytest
from support.commands import is_png, run

import pearlbvp as pb
from pearlbvp.studies.phases import COLUMNS
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
