"""The command line as its users meet it."""

import io
import os
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

from pearlbvp.cli import cli, main
from pearlbvp.commands.output import PICTURES

DATA = Path(__file__).parents[1] / "data"


def run(capsys, *arguments):
    """Exit status, standard output and standard error of a call in this process."""
    with pytest.raises(SystemExit) as left:
        main(list(arguments))
    captured = capsys.readouterr()
    return left.value.code, captured.out, captured.err


def is_png(path):
    return path.read_bytes().startswith(b"\x89PNG\r\n")


def test_dispersion(capsys, tmp_path):
    status, out, err = run(capsys, "dispersion", "--c0", "0.48", "--length", "30", "--plot", str(tmp_path / "d.png"))
    assert (status, err) == (0, "")
    table = pd.read_csv(io.StringIO(out), keep_default_na=False)
    assert list(table.columns) == ["m", "n", "k", "type", "lambda2", "lambda1", "kernel", "role"]
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
    assert sorted(os.listdir(tmp_path)) == ["t.csv", "t.png"]


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


def test_a_radius_scales_a_branch(capsys):
    """Growth rates with the fourth power of 1/radius, ``--until mu_crit`` in the user's unit."""
    _, unit, _ = run(capsys, "branch", "coil", "--c0", "0", "--length", "10", "--until", "mu_crit=-0.008")
    scaled = ["--c0", "0", "--length", "20", "--radius", "2", "--until", "mu_crit=-0.0005"]
    status, large, err = run(capsys, "branch", "coil", *scaled)
    assert (status, err) == (0, "")
    one, two = pd.read_csv(io.StringIO(unit)), pd.read_csv(io.StringIO(large))
    powers = {"lambda1": -2, "lambda2": -3, "v": 0, "E": -2, "amplitude": 1, "r_min": 1, "r_max": 1, "n_unstable": 0,
              "mu_crit": -4, "c0": -1, "L": 1}  # fmt: skip
    assert len(one) == len(two) > 2
    for name, power in powers.items():
        assert (two[name] - one[name] * 2.0**power).abs().max() < 1e-9, name
    assert two.mu_crit.iloc[-1] == pytest.approx(-0.0005, rel=1e-9)


def test_branch_is_saved_resumed_switched_and_varied(capsys, tmp_path):
    saved, more = str(tmp_path / "b.h5"), str(tmp_path / "c.h5")
    start = ["branch", "pearl", "--c0", "0.48", "--length", "15", "--mode", "2,0", "--until", "v=1.01", "--save", saved]
    status, out, err = run(capsys, *start, "--plot", str(tmp_path / "b.png"))
    assert (status, err) == (0, "")
    table = pd.read_csv(io.StringIO(out), keep_default_na=False)
    assert list(table.columns[:11]) == ["point", "special", "lambda1", "lambda2", "v", "E", "amplitude", "r_min", "r_max",
                                        "n_unstable", "mu_crit"]  # fmt: skip
    assert table.special.iloc[[0, -1]].tolist() == ["start", "stop"]
    assert table.v.iloc[-1] == 1.01
    assert table[table.special == "bp"].lambda2.iloc[0] == pytest.approx(-0.376218681462, abs=1e-10)
    assert is_png(tmp_path / "b.png")
    status, out, _ = run(capsys, "branch", "pearl", "--resume", saved, "--until", "v=1.02", "--save", more)
    longer = pd.read_csv(io.StringIO(out), keep_default_na=False)
    assert longer.iloc[: len(table) - 1].equals(table.iloc[:-1])
    status, out, _ = run(capsys, "branch", "pearl", "--resume", more, "--switch", "1", "--until", "v=1.05")
    assert (pd.read_csv(io.StringIO(out)).n_unstable == 0).all()
    status, out, _ = run(capsys, "branch", "pearl", "--resume", more, "--vary", "c0", "--down", "--until", "c0=0.47")
    assert status == 0
    assert pd.read_csv(io.StringIO(out)).c0.iloc[-1] == 0.47


def test_cells_of_a_shape_are_those_of_the_tube(capsys):
    arguments = [
        "--c0",
        "0.75",
        "--length",
        "10",
        "--shape=-0.28,0.47",
        "--volume",
        "1",
        "--cells",
        "2",
        "--max-points",
        "3",
    ]
    _, out, _ = run(capsys, "branch", "pearl", *arguments)
    table = pd.read_csv(io.StringIO(out), keep_default_na=False)
    assert (table.L == 20).all()
    assert table.critical.str.contains("/2").all()


def test_a_fold_is_followed(capsys, tmp_path):
    saved = str(tmp_path / "b.h5")
    run(capsys, "branch", "pearl", "--c0", "0.75", "--length", "10", "--until", "v=0.99", "--save", saved)
    arguments = ["branch", "pearl", "--resume", saved, "--follow", "fold:v:1", "--vary", "c0", "--down"]
    status, out, err = run(
        capsys, *arguments, "--max-step", "0.2", "--until", "c0=0.7", "--plot", str(tmp_path / "f.png")
    )
    assert (status, err) == (0, "")
    table = pd.read_csv(io.StringIO(out), keep_default_na=False)
    assert table.c0.iloc[-1] == 0.7
    assert is_png(tmp_path / "f.png")
    for change in (["--save", saved], ["--follow", "fold:1"], ["--follow", "bp:9"]):
        status, _, err = run(capsys, *arguments, *change)
        assert (status, err.count("\n")) == (2, 1)


def test_options_that_a_saved_branch_has_already(capsys, tmp_path):
    saved = str(tmp_path / "b.h5")
    run(capsys, "branch", "pearl", "--c0", "0", "--length", "10", "--max-points", "3", "--save", saved)
    for option in (["--pressure"], ["--tolerance", "1e-8"], ["--mode", "2,0"], ["--c0", "0"]):
        status, _, err = run(capsys, "branch", "pearl", "--resume", saved, *option)
        assert (status, err.count("\n")) == (2, 1)


def test_a_branch_that_does_not_get_there_says_so(capsys):
    status, out, err = run(
        capsys, "branch", "pearl", "--c0", "0", "--length", "10", "--max-points", "4", "--until", "v=2"
    )
    assert status == 1
    assert "--max-points" in err
    assert "max_points" not in err
    assert out.count("\n") == 5


@pytest.mark.parametrize(
    ("options", "advice"),
    [
        (["--c0", "0", "--length", "10", "--until", "v=0.9"], "has the same shapes"),
        (["--resume", "SAVED", "--vary", "c0", "--until", "c0=-0.2"], "give --down"),
        (["--resume", "SAVED", "--vary", "c0", "--down", "--until", "c0=0.5"], "leave --down out"),
    ],
)
def test_a_branch_that_moves_away_from_its_goal_says_so(capsys, tmp_path, options, advice):
    """And names the other direction, which leads there."""
    saved = str(tmp_path / "b.h5")
    run(capsys, "branch", "pearl", "--c0", "0", "--length", "10", "--until", "v=1.1", "--save", saved)
    options = [saved if option == "SAVED" else option for option in options]
    status, _, err = run(capsys, "branch", "pearl", *options, "--max-points", "5", "--max-step", "0.1")
    assert (status, err.count("\n")) == (1, 1)
    assert "--max-points = 5 reached; " in err
    assert "moved away from its wanted value from the start on" in err
    assert err.rstrip().endswith(advice)
    if "--down" in advice:
        other = [o for o in options if o != "--down"] if "leave" in advice else [*options, "--down"]
        status, out, _ = run(capsys, "branch", "pearl", *other)
        assert status == 0
        assert out.rstrip().splitlines()[-1].split(",")[1] == "stop"


def test_a_branch_that_comes_nearer_is_not_said_to_move_away(capsys):
    _, _, err = run(capsys, "branch", "pearl", "--c0", "0", "--length", "10", "--until", "v=2", "--max-points", "5")
    assert "ask for more" in err
    assert "moved away" not in err


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
        ("branch", {"--resume": "nothing.h5"}, "--resume"),
        ("branch", {"--save": "no/such/b.h5"}, "--save"),
        ("branch", {"--step": "0"}, "--step"),
        ("branch", {"--max-step": "0"}, "--max-step"),
        ("branch", {"--step": "0.2", "--max-step": "0.1"}, "--max-step = 0.1"),
        ("region", {"--periods": "0"}, "--periods"),
        ("region", {"--pearls": "1"}, "--pearls"),
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
    monkeypatch.setattr(period, "scan", lambda cases, processes: iter([good]))
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
        (["--resume", saved, "--out", saved], "--out"),
        (["--resume", saved, "--save", tmp_path / "x", "--out", tmp_path / "x"], "--save"),
        (["--resume", saved, "--save", tmp_path / "y", "--plot", tmp_path / "y"], "--save"),
    ):
        status, _, err = run(capsys, "branch", "pearl", *map(str, options))
        assert status == 2
        assert err.startswith(f"pearlbvp: {name}: ")
    assert saved.read_bytes() == before
    assert run(capsys, *map(str, ("branch", "pearl", "--resume", saved, "--save", saved, "--until", "v=1.02")))[0] == 0


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


@pytest.mark.parametrize(("family", "mode"), [("ring", "0,3"), ("coil", "1,1"), ("buckle", "1,1")])
def test_other_families_have_the_columns_of_pearls(capsys, tmp_path, family, mode):
    picture = tmp_path / "b.png"
    options = ["--c0", "0", "--length", "10", "--mode", mode, "--until", "v=0.99", "--plot", str(picture)]
    status, out, _ = run(capsys, "branch", family, *options)
    assert status == 0
    table = pd.read_csv(io.StringIO(out))
    assert list(table.columns)[:5] == ["point", "special", "lambda1", "lambda2", "v"]
    assert table.special.iloc[-1] == "stop"
    assert table.v.iloc[-1] == pytest.approx(0.99, abs=1e-11)
    assert is_png(picture)


def test_tubes_are_saved_resumed_and_switched(capsys, tmp_path):
    """c0 = 0.48: the stable branch between coils and buckles, from the command line."""
    saved, mixed = str(tmp_path / "c.h5"), str(tmp_path / "m.h5")
    coils = ["branch", "coil", "--c0", "0.48", "--length", "10", "--until", "v=0.905", "--save", saved]
    assert run(capsys, *coils)[0] == 0
    status, out, err = run(
        capsys, "branch", "coil", "--resume", saved, "--switch", "1", "--until", "v=0.907", "--save", mixed
    )
    assert (status, err) == (0, "")
    table = pd.read_csv(io.StringIO(out))
    assert (table.n_unstable == 0).all()
    assert table.mu_error.max() < 1e-7
    status, out, _ = run(capsys, "branch", "coil", "--resume", mixed, "--until", "v=0.9075")
    assert status == 0
    assert pd.read_csv(io.StringIO(out)).v.iloc[-1] == pytest.approx(0.9075, abs=1e-11)


@pytest.mark.parametrize(
    ("family", "options", "named"),
    [
        ("pearl", ("--resume", "SAVED"), "--resume"),
        ("ring", ("--resume", "SAVED", "--vary", "L"), "studies.ring_onsets"),
        ("ring", ("--resume", "SAVED", "--switch", "1", "--centre", "neck"), "--centre"),
        ("ring", ("--resume", "SAVED", "--switch", "7"), "--switch"),
        ("coil", ("--c0", "0", "--length", "10", "--tolerance", "1e-8"), "--tolerance"),
        ("ring", ("--c0", "0", "--length", "10", "--mode", "1,2"), "--mode"),
        ("coil", ("--c0", "0", "--length", "10", "--mode", "1,0"), "--mode"),
        ("coil", ("--c0", "0", "--length", "0"), "--length"),
        ("buckle", ("--c0", "nan", "--length", "10"), "--c0"),
    ],
)
def test_options_that_a_family_does_not_have(capsys, tmp_path, family, options, named):
    saved = str(tmp_path / "r.h5")
    run(capsys, "branch", "ring", "--c0=-1", "--length", "10", "--until", "v=0.99", "--save", saved)
    status, out, err = run(capsys, "branch", family, *(saved if option == "SAVED" else option for option in options))
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert named in err
