"""The command line as its users meet it."""

import io
import os
import subprocess
import sys
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

import click
import pandas as pd
import pytest
from support.commands import is_png, run

from pearlbvp.cli import cli
from pearlbvp.commands.output import PICTURES
from pearlbvp.errors import InputError

DATA = Path(__file__).parents[2] / "data"


def test_dispersion(capsys, tmp_path):
    status, out, err = run(capsys, "dispersion", "--c0", "0.48", "--length", "30", "--plot", str(tmp_path / "d.png"))
    assert (status, err) == (0, "")
    table = pd.read_csv(io.StringIO(out), keep_default_na=False)
    assert list(table.columns) == ["m", "n", "k", "type", "lambda2", "lambda1", "kernel", "role", "force"]
    assert table[table.role == "lower"].m.tolist() == [4]
    assert is_png(tmp_path / "d.png")


def test_localized_writes_the_contract_s_columns(capsys, tmp_path):
    csv, png = tmp_path / "t.csv", tmp_path / "t.png"
    status, out, err = run(capsys, "localized", "--c0", "0.48", "--period", "7.5", "--lengths", "15:60:15",
                           "--compare", str(DATA / "paper_localized.csv"), "--out", str(csv), "--plot", str(png))  # fmt: skip
    assert (status, out, err) == (0, "", "")
    table = pd.read_csv(csv)
    assert list(table.columns) == ["c0", "period", "L", "pearls", "status", "lambda1", "lambda2", "v", "E", "amplitude",
                                   "message", "v_paper", "v_corrected"]  # fmt: skip
    assert abs(table.v - table.v_corrected).max() < 5.01e-6
    assert "1.00811073653" in csv.read_text()  # twelve significant digits
    assert is_png(png)
    assert sorted(os.listdir(tmp_path)) == ["t.csv", "t.csv-metadata.json", "t.png"]


def test_period(capsys, tmp_path):
    status, out, err = run(
        capsys, "period", "--c0", "0.3,0.48", "--lengths", "15,16", "--plot", str(tmp_path / "p.png")
    )
    assert (status, err) == (0, "")
    table = pd.read_csv(io.StringIO(out))
    assert list(table.columns[:11]) == ["c0", "L", "pearls", "period", "k", "status", "lambda2_pearl", "lambda2_upper",
                                        "upper_mode", "v_localized", "localized_status"]  # fmt: skip
    assert table.c0.tolist() == [0.3, 0.3, 0.48, 0.48]
    assert is_png(tmp_path / "p.png")


def test_a_radius_scales_everything(capsys):
    _, unit, _ = run(capsys, "localized", "--c0", "0.48", "--period", "7.5", "--lengths", "15")
    _, large, _ = run(capsys, "localized", "--c0", "0.24", "--period", "15", "--lengths", "30", "--radius", "2")
    one, two = pd.read_csv(io.StringIO(unit)).iloc[0], pd.read_csv(io.StringIO(large)).iloc[0]
    for name, power in {"c0": -1, "L": 1, "lambda1": -2, "lambda2": -3, "v": 0, "E": -2, "amplitude": 1}.items():
        assert two[name] == pytest.approx(one[name] * 2.0**power, rel=1e-10)


@pytest.mark.parametrize(("ending", "begins"), [("pdf", b"%PDF"), ("svg", b"<?xml"), ("PNG", b"\x89PNG\r\n")])
def test_pictures_have_the_format_of_their_ending(capsys, tmp_path, ending, begins):
    path = tmp_path / f"d.{ending}"
    assert run(capsys, "dispersion", "--c0", "0", "--length", "10", "--plot", str(path))[0] == 0
    assert path.read_bytes().startswith(begins)


def test_endings_of_pictures_are_matplotlib_s():
    from matplotlib.figure import Figure

    known = {f".{ending}" for ending in Figure().canvas.get_supported_filetypes()}
    assert set(PICTURES) <= known
    assert ".foo" not in known


GOOD = {
    "branch": {"pearl": "--c0=0", "--length": "10"},
    "dispersion": {"--c0": "0.48", "--length": "30"},
    "localized": {"--c0": "0.48", "--period": "7.5", "--lengths": "15"},
    "period": {"--c0": "0.48", "--lengths": "15"},
    "region": {"--c0": "0.48", "--periods": "7.5"},
    "amplitude": {"--c0": "0", "--length": "10", "--mode": "1,0"},
}


@pytest.mark.parametrize(
    ("command", "change", "named"),
    [
        ("dispersion", {"--length": "0"}, "--length"),
        ("dispersion", {"--length": "-3"}, "--length"),
        ("dispersion", {"--length": "nan"}, "--length"),
        ("dispersion", {"--c0": "inf"}, "--c0"),
        ("dispersion", {"--c0": "high"}, "--c0"),
        ("dispersion", {"--max-m": "-1"}, "--max-m"),
        ("dispersion", {"--radius": "0"}, "--radius"),
        ("localized", {"--lengths": ""}, "--lengths"),
        ("localized", {"--lengths": "15,x"}, "--lengths"),
        ("localized", {"--lengths": "16"}, "--lengths"),
        ("localized", {"--lengths": "0"}, "--lengths"),
        ("localized", {"--period": "6.28"}, "--period"),
        ("localized", {"--period": "seven"}, "--period"),
        ("localized", {"--out": "no/such/folder/t.csv"}, "--out"),
        ("localized", {"--plot": "t.foo"}, "--plot"),
        ("branch", {"--plot": "t.foo"}, "--plot"),
        ("localized", {"--plot": "no/such/folder/t.png"}, "--plot"),
        ("localized", {"--compare": "nothing.csv"}, "--compare"),
        ("localized", {"--period": "0"}, "--period"),
        ("localized", {"--out": "same", "--plot": "same"}, "--plot"),
        ("dispersion", {"--length": "1e200"}, "--length"),
        ("branch", {"--mode": "1,1"}, "--mode"),
        ("branch", {"--mode": "one"}, "--mode"),
        ("branch", {"--mode": "0,0"}, "--mode"),
        ("branch", {"--until": "v"}, "--until"),
        ("branch", {"--until": "w=1"}, "--until"),
        ("branch", {"--until": "v=nan"}, "--until"),
        ("branch", {"--until": "c0=0.5"}, "--until"),
        ("branch", {"--length": "6.283185307179586"}, "--mode"),
        ("branch", {"--switch": "1"}, "--switch"),
        ("branch", {"--save": "no/such/b.h5"}, "--save"),
        ("branch", {"--step": "0"}, "--step"),
        ("branch", {"--max-step": "0"}, "--max-step"),
        ("branch", {"--step": "0.2", "--max-step": "0.1"}, "--max-step = 0.1"),
        ("region", {"--periods": "0"}, "--periods"),
        ("region", {"--pearls": "0"}, "--pearls"),
        ("region", {"--pearls": "2,some"}, "--pearls"),
        ("region", {"--c0": "high"}, "--c0"),
        ("period", {"--volume": "1"}, "--volume"),
        ("amplitude", {"--mode": "0,1"}, "--mode"),
        ("amplitude", {"--plot": "a.png", "--largest": "-1"}, "--largest"),
        ("branch", {"--cells": "2"}, "--cells"),
        ("branch", {"--keep": "v"}, "--keep"),
        ("branch", {"--centre": "neck"}, "--centre"),
        ("branch", {"--length": "1e6"}, "--length"),
        ("branch", {"--shape": "0.1"}, "--shape"),
        ("branch", {"--tolerance": "1"}, "--tolerance"),
        ("period", {"--lengths": "nan"}, "--lengths"),
        ("period", {"--lengths": "0"}, "--lengths"),
        ("period", {"--processes": "0"}, "--processes"),
    ],
)
def test_mistakes_are_one_line_that_names_the_argument(capsys, monkeypatch, tmp_path, command, change, named):
    monkeypatch.chdir(tmp_path)  # some name files
    options = GOOD[command] | change
    status, out, err = run(capsys, command, *(word for pair in options.items() for word in pair))
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    assert named in err


def test_missing_and_unknown_options(capsys):
    for arguments in (["dispersion"], ["dispersion", "--colour", "red"], ["nonsense"]):
        status, out, err = run(capsys, *arguments)
        assert (status, out, err.count("\n")) == (2, "", 1)


def test_failed_rows_are_written_and_said(capsys, monkeypatch):
    from pearlbvp.studies import period

    good = {"c0": 0.48, "L": 15.0, "status": "found", "localized_status": "failed", "message": "why"}
    monkeypatch.setattr(period, "scan", lambda curvatures, lengths, v, processes: iter([[good]]))
    status, out, err = run(capsys, "period", "--c0", "0.48", "--lengths", "15")
    assert status == 1
    assert "why" in out
    assert "1 of 1 rows failed" in err


@pytest.mark.parametrize("arguments", [[], ["--out"]])
def test_a_full_disk_is_one_line_and_no_file(arguments, tmp_path):
    """A file system with no room: standard output on /dev/full, or files limited to no bytes at all."""
    command = [sys.executable, "-m", "pearlbvp", "dispersion", "--c0", "0", "--length", "10"]
    if arguments:
        limited = f"ulimit -f 0; trap '' XFSZ; exec {' '.join(command)} --out {tmp_path / 't.csv'}"
        process = subprocess.run(["bash", "-c", limited], capture_output=True, text=True, check=False)
    else:
        with open("/dev/full", "w") as full:
            process = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert process.returncode == 2, process.stderr
    assert process.stderr.count("\n") == 1
    assert "space" in process.stderr
    assert os.listdir(tmp_path) == []


LIMITED = "ulimit -f {blocks}; trap '' XFSZ; exec {python} -m pearlbvp {words}"
"""No file may grow beyond so many kilobytes, as on a disk that is full; the limit is the shell's."""


def limited(blocks, *words):
    command = LIMITED.format(blocks=blocks, python=sys.executable, words=" ".join(map(str, words)))
    return subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)


def test_a_disk_that_fills_loses_only_what_does_not_fit(tmp_path):
    """Branch, flow, movie, picture and mesh are larger than 4 kB, their tables smaller: these are written, nothing is left."""
    branch = ["branch", "pearl", "--c0", 0, "--length", 10, "--until", "v=1.01"]
    files = ["--out", tmp_path / "t.csv", "--save", tmp_path / "b.h5", "--plot", tmp_path / "p.pdf"]
    done = limited(4, *branch, *files)
    assert done.returncode == 2, done.stderr
    said = [line for line in done.stderr.splitlines() if "compiling" not in line]
    assert len(said) == 1, done.stderr
    assert "--save: " in said[0]
    assert "--plot: " in said[0]
    assert "Traceback" not in done.stderr
    assert sorted(os.listdir(tmp_path)) == ["t.csv", "t.csv-metadata.json"]
    assert pd.read_csv(tmp_path / "t.csv").v.iloc[-1] == pytest.approx(1.01)
    for ending in ("vtu", "ply", "obj", "fe"):
        done = limited(4, "mesh", "--length", 10, "--nodes", 500, "--out", tmp_path / f"m.{ending}")
        assert (done.returncode, len(done.stdout.splitlines())) == (2, 2), done.stderr
        assert "pearlbvp: --out: " in done.stderr
        assert "Traceback" not in done.stderr
    assert sorted(os.listdir(tmp_path)) == ["t.csv", "t.csv-metadata.json"]


def test_the_table_of_a_run_whose_checkpoints_fail_is_written(tmp_path, capsys, monkeypatch):
    """Whenever they are written: here at every point of a branch and at every step of a flow."""
    from pearlbvp import hdf5
    from pearlbvp.commands import following
    from pearlbvp.flows import driver

    def full(name, path, write):
        tried.append(name)
        raise InputError(name, f"{path} could not be written (No space left on device)", "free space")

    tried = []
    monkeypatch.setattr(hdf5, "write_whole", full)
    monkeypatch.setattr(following._Checkpoint.__init__, "__defaults__", (-1.0,))
    save = ["--save", tmp_path / "b.h5"]
    status, out, err = run(capsys, "branch", "pearl", "--c0", 0, "--length", 10, "--until", "v=1.01", *save)
    assert (status, err.count("\n")) == (2, 1)
    assert err.startswith("pearlbvp: --save: ")
    assert len(out.splitlines()) > 3
    assert len(tried) > 2
    tried.clear()
    begin = driver.FlowOptions
    monkeypatch.setattr(driver, "FlowOptions", lambda **settings: begin(**{**settings, "every": 1e-9}))
    flow = ["flow", "--c0", 0, "--length", 10, "--point", "v=1.05", "--time", 0.1]
    status, out, err = run(capsys, *flow, "--save", tmp_path / "f.h5", "--save-end", tmp_path / "e.h5")
    assert (status, err.count("\n")) == (2, 1)
    assert err.startswith("pearlbvp: --save: ")
    assert len(out.splitlines()) > 3
    assert len(tried) > 3
    assert os.listdir(tmp_path) == []


def test_standard_output_has_a_name(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    plain = run(capsys, "dispersion", "--c0", "0", "--length", "10")
    assert run(capsys, "dispersion", "--c0", "0", "--length", "10", "--out", "-") == plain
    for option in ("--plot", "--save"):
        status, _, err = run(capsys, "branch", "pearl", "--c0", "0", "--length", "10", option, "-")
        assert (status, err.count("\n")) == (2, 1)
    assert os.listdir(tmp_path) == []


def test_the_end_of_a_file_is_no_interruption(monkeypatch):
    """click takes every EOFError for the user's: here it is a defect, and must be seen as one."""
    from pearlbvp import cli as room

    def broken(*arguments, **how):
        raise EOFError

    monkeypatch.setattr(room.dispersion, "invoke", broken)
    with pytest.raises(click.Abort):
        room.main(["dispersion", "--c0", "0", "--length", "10"])


def test_rows_of_a_worker_that_is_killed_are_computed_all_the_same(capsys, monkeypatch):
    import joblib

    class Killed:
        def __init__(self, **how):
            pass

        def __call__(self, tasks):
            for count, (function, arguments, _) in enumerate(tasks):
                if count == 1:
                    raise BrokenProcessPool
                yield function(*arguments)

    expected = run(capsys, "period", "--c0", "0.3,0.4,0.48", "--lengths", "15,16", "--processes", "1")
    monkeypatch.setattr(joblib, "Parallel", Killed)
    status, out, err = run(capsys, "period", "--c0", "0.3,0.4,0.48", "--lengths", "15,16", "--processes", "2")
    assert (status, out) == expected[:2]
    assert err == "pearlbvp: a worker process was killed; the other 2 are done in one\n"


def test_help_has_examples():
    for name, command in cli.commands.items():
        assert f"pearlbvp {name} " in command.epilog


def test_a_reader_that_has_had_enough_is_no_error():
    shell = f"{sys.executable} -m pearlbvp dispersion --c0 0 --length 600 --max-m 3000 | head -1"
    process = subprocess.run(["bash", "-c", shell], capture_output=True, text=True, check=False)
    assert process.stdout.startswith("m,n,k")
    assert process.stderr == ""


def test_no_output_overwrites_another_or_the_branch_it_starts_from(capsys, tmp_path):
    saved = tmp_path / "b.h5"
    assert (
        run(
            capsys, *map(str, ("branch", "pearl", "--c0", "0", "--length", "10", "--until", "v=1.01", "--save", saved))
        )[0]
        == 0
    )
    before = saved.read_bytes()
    for options, name in (
        (["--out", saved], "--out"),
        (["--save", tmp_path / "x", "--out", tmp_path / "x"], "--save"),
        (["--save", tmp_path / "y.png", "--plot", tmp_path / "y.png"], "--save"),
    ):
        status, _, err = run(capsys, "resume", saved, *map(str, options))
        assert status == 2
        assert err.startswith(f"pearlbvp: {name}: ")
    assert saved.read_bytes() == before
    assert run(capsys, *map(str, ("resume", saved, "--save", saved, "--until", "v=1.02")))[0] == 0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (
            ["branch", "pearl", "--c0", "0", "--length", "10", "--save", "{}/"],
            "--save: {}/ is a folder's name; give a file's",
        ),
        (["resume", "{}/"], "FILE: {}/ is a folder's name; give a file's name"),
        (
            ["dispersion", "--c0", "0", "--length", "10", "--out", "{}/"],
            "--out: {}/ is a folder's name; give a file's name",
        ),
        (["show", "{}/"], "FILE: {}/ is a folder's name; give a file's name"),
        (
            ["dispersion", "--c0", "0", "--length", "10", "--plot", "{}"],
            "--plot: new has no ending that names its format; give",
        ),
        (
            ["flow", "--resume", "f.h5", "--movie", "{}"],
            "--movie: new has no ending that names its format; give one of .gif",
        ),
        (
            ["show", "f.h5", "--surface", "{}"],
            "has no ending that names its format; give one of .csv, .obj, .ply, .vtu, .fe",
        ),
        (["show", "f.h5", "--profile", "{}"], "has no ending that names its format; give one of .csv"),
        (
            ["mesh", "--length", "10", "--out", "{}"],
            "has none of the endings .vtu, .ply, .obj, .fe; choose one of these formats",
        ),
    ],
)
def test_names_of_folders_and_names_without_the_ending_that_decides_are_refused(capsys, tmp_path, arguments, said):
    status, out, err = run(capsys, *(word.format(tmp_path / "new") for word in arguments))
    assert (status, out) == (2, "")
    assert said.format(tmp_path / "new") in err
    assert list(tmp_path.iterdir()) == []


def test_amplitude_writes_coefficients_predictions_and_comparisons(capsys, tmp_path):
    tube = ["--c0", "0", "--length", "10"]
    computed, beside = tmp_path / "b.csv", tmp_path / "c.csv"
    assert (
        run(
            capsys,
            *map(
                str,
                (
                    "branch",
                    "pearl",
                    *tube,
                    "--until",
                    "v=1.01",
                    "--step",
                    "0.02",
                    "--max-step",
                    "0.02",
                    "--out",
                    computed,
                ),
            ),
        )[0]
        == 0
    )
    options = [
        "--mode",
        "1,0",
        "--mode",
        "1,1",
        "--compare",
        computed,
        "--branch",
        beside,
        "--plot",
        tmp_path / "a.png",
    ]
    status, out, _ = run(capsys, "amplitude", *map(str, (*tube, *options)))
    assert status == 0
    rows = out.splitlines()
    assert rows[0].startswith("c0,L,m,n,type,lambda2,lambda1,a,b,b1,b2,alpha2,stable")
    assert "-2.955045540" in rows[1]
    assert "-0.817084382" in rows[2]
    table = pd.read_csv(beside)
    assert (table.lambda2_error < 0.1).all()
    assert table.E_order.iloc[-1] == pytest.approx(4, abs=0.1)
    assert is_png(tmp_path / "a.png")
    assert (
        run(capsys, *map(str, ("amplitude", *tube, "--mode", "1,1", "--family", "buckle", "--branch", beside)))[0] == 0
    )
    assert pd.read_csv(beside).n_unstable.iloc[-1] == 1  # coils are stable there, buckles are not
    before = computed.read_bytes()
    same = ["--mode", "1,0", "--compare", str(computed), "--branch", str(computed)]
    for wrong in (
        same,
        ["--mode", "1,0", "--compare", str(computed)],
        ["--mode", "0,1"],
        ["--mode", "1,1", "--family", "pearl"],
        ["--mode", "1,1", "--largest", "9"],
    ):
        status, _, err = run(capsys, "amplitude", *tube, *wrong)
        assert (status, err.count("\n")) == (2, 1)
    assert computed.read_bytes() == before


def test_amplitude_map_writes_a_row_a_tube(capsys, tmp_path):
    meetings = tmp_path / "m.csv"
    options = ["--c0=-0.4:0.4:0.1", "--lengths", "8,20", "--meetings", meetings, "--plot", tmp_path / "m.png"]
    status, out, _ = run(capsys, "amplitude-map", *map(str, options))
    assert (status, len(out.splitlines())) == (0, 1 + 9 * 2)
    assert is_png(tmp_path / "m.png")
    assert {"0:2"} <= set(pd.read_csv(meetings)["mode"])


def test_an_option_of_one_value_is_refused_where_it_is_there_twice(capsys):
    status, out, err = run(capsys, "dispersion", "--c0", "0", "--length", "10", "--c0", "1")
    assert (status, out, err) == (2, "", "pearlbvp: --c0: it is given twice; give it once\n")
