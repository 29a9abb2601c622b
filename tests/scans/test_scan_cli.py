"""``pearlbvp scan``: tables, pictures, how far it is, and mistakes."""

from io import StringIO

import pandas as pd
import pytest
from support.commands import is_png, run

ONE = ["--workers", "1"]


@pytest.fixture
def store(capsys, tmp_path):
    path = tmp_path / "s.sqlite"
    status, out, err = run(
        capsys, "scan", "region", "--c0", "0.48", "--period", "7.5,8", "--pearls", "2,3", "--store", path, *ONE
    )
    assert (status, err, len(out.splitlines())) == (0, "", 5)
    return path


def test_a_store_tells_how_far_it_is_and_writes_what_there_is(capsys, tmp_path, store):
    assert run(capsys, "scan", "--store", store)[:2] == (0, "region: 4 done\n")
    table, picture = tmp_path / "t.csv", tmp_path / "t.png"
    assert run(capsys, "scan", "--store", store, "--export", table, "--plot", picture) == (0, "", "")
    assert pd.read_csv(table)["pearls"].tolist() == [2, 3, 2, 3]
    assert is_png(picture)


def test_lengths_are_in_the_user_s_unit(capsys, tmp_path, store):
    found = []
    for radius in ("1", "50"):
        name = tmp_path / f"{radius}.csv"
        assert run(capsys, "scan", "--store", store, "--radius", radius, "--export", name)[0] == 0
        found.append(pd.read_csv(name))
    assert found[1]["period"].tolist() == pytest.approx(50 * found[0]["period"])
    assert found[1]["lambda2"].tolist() == pytest.approx(found[0]["lambda2"] / 50**3)
    assert found[1]["v"].tolist() == found[0]["v"].tolist()


def test_a_tube_in_other_units_is_the_same_case(capsys, tmp_path):
    """Also where units leave other last digits: 1/(52 nm) of 50 nm, 19.230769 1/um, mem3dg's half of it."""
    store = tmp_path / "s.sqlite"
    for words in (
        ["--radius", "50nm", "--c0", "1/(52nm)", "--lengths", "0.75um"],
        ["--radius", "0.05um", "--c0", f"{1e3 / 52!r}/um", "--lengths", "750nm"],
        ["--radius", "50nm", "--convention", "mem3dg", "--c0", f"{1 / 104!r}/nm", "--lengths", "750"],
    ):
        assert run(capsys, "scan", "dispersion", *words, "--store", store, *ONE)[0] == 0
    assert run(capsys, "scan", "--store", store)[1] == "dispersion: 1 done\n"


def test_growth_is_in_seconds_by_a_viscosity_and_as_the_plain_command_has_it(capsys, tmp_path):
    """Also where a store is looked at, and a tube in other units is the same case."""
    store, units = tmp_path / "s.sqlite", ["--radius", "0.7um", "--kappa", "20kT", "--viscosity", "1mPa.s"]
    tube = ["--c0", "0", "--tension", "1e-3mN/m", "--membrane-viscosity", "1e-9Pa.s.m"]
    plain = run(capsys, "growth", *units, *tube, "--out", "-")[1]
    shared = ",".join(name.partition("[")[0] for name in plain.splitlines()[0].split(",")).replace("C0", "c0")
    asked = run(capsys, "scan", "growth", *units, *tube, "--store", store, "--columns", shared, *ONE)
    assert run(capsys, "scan", "--store", store, *units, "--columns", shared, "--export", "-") == asked
    found, expected = (pd.read_csv(StringIO(text)) for text in (asked[1], plain))
    pd.testing.assert_frame_equal(found, expected, rtol=1e-6)  # the fastest wave is known to eight digits
    assert "rate[1/s]" in found
    other = [
        "--radius",
        "700nm",
        "--kappa",
        "20kT",
        "--c0",
        "0",
        "--tension",
        "1e-6N/m",
        "--membrane-viscosity",
        "1um",
    ]
    assert run(capsys, "scan", "growth", *other, "--store", store, *ONE)[0] == 0
    assert run(capsys, "scan", "--store", store)[1] == "growth: 1 done\n"


def test_a_store_of_several_questions_tells_of_all(capsys, store):
    run(capsys, "scan", "dispersion", "--c0", "0", "--lengths", "10", "--store", store, *ONE)
    assert run(capsys, "scan", "--store", store, "--status")[1] == "dispersion: 1 done\nregion: 4 done\n"
    assert "--question: the store holds dispersion, region" in run(capsys, "scan", "--store", store, "--export", "-")[2]
    words = ["--question", "region", "--columns", "v,period", "--export", "-"]
    assert run(capsys, "scan", "--store", store, *words)[1].startswith("v,period\n")
    said = run(capsys, "scan", "--store", store, "--question", "region", "--columns", "v,w", "--export", "-")
    assert (said[0], "--columns: region has no column 'w'" in said[2]) == (2, True)
    said = run(capsys, "scan", "--store", store, "--question", "region", "--viscosity", "1mPa.s", "--export", "-")
    assert (said[0], "--viscosity: region has no rates" in said[2]) == (2, True)


def test_cases_that_fail_are_said_and_done_again(capsys, tmp_path):
    """A millisecond is too short for a continuation; without the limit it is found."""
    store = tmp_path / "s.sqlite"
    question = ["localized", "--c0", "0.48", "--period", "7.5", "--lengths", "15", "--store", store, *ONE]
    status, out, err = run(capsys, "scan", *question, "--seconds", "0.001")
    assert (status, "longer than 0.001 s" in out, err.count("\n")) == (1, True, 1)
    assert "failed: c0 = 0.48, period = 7.5, L = 15: it took longer" in run(capsys, "scan", "--store", store)[1]
    assert run(capsys, "scan", *question)[0] == 1  # what failed is finished until it is asked for again
    assert run(capsys, "scan", "--store", store, "--retry", "failed", *ONE)[0] == 0
    assert ",found," in run(capsys, "scan", *question)[1]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "--store: give the file of a scan"),
        (["--store", "none.sqlite"], "--store: there is no file none.sqlite"),
        (["dispersion", "--c0", "0", "--lengths", "10"], "--store"),
        (["dispersion", "--c0", "0", "--lengths", "10", "--store", "s", "--workers", "many"], "--workers: 'many' is no number"),
        (["dispersion", "--c0", "0", "--lengths", "-1", "--store", "s"], "--lengths: "),
        (["localized", "--c0", "0", "--period", "8", "--lengths", "30", "--store", "s"], "--lengths: 30 radii is no multiple"),
        (["dispersion", "--c0", "0", "--lengths", "10", "--store", "s", "--export", "x.txt"], "--export: x.txt has the ending"),
        (["dispersion", "--c0", "0", "--lengths", "10", "--store", "/dev/null"], "--store: /dev/null is no ordinary file"),
        (["growth", "--c0", "0", "--tension", "1", "--viscosity", "1mPa.s", "--store", "s"], "--viscosity: 1mPa.s needs the radius"),
        (["growth", "--c0", "0", "--tension", "-1e6", "--store", "s"], "--tension: at -1e+06"),
        (["period", "--c0", "1e9", "--lengths", "15", "--store", "s"], "--c0: 1e+09 is beyond 10000"),
        (["period", "--c0", "0.48", "--lengths", "1e9", "--store", "s"], "--lengths: 1e+09 radii is not between"),
        (["region", "--c0", "0.48", "--period", "1e-9", "--pearls", "2", "--store", "s"], "--period: 1e-09 radii is not between"),
        (["dispersion", "--c0", "1e400", "--lengths", "15", "--store", "s"], "--c0: '1e400' is not a finite number"),
        (["dispersion", "--c0", "0", "--lengths", "10", "--store", "s", "--workers", "100000"], "--workers: 100000 are too many"),
        (["growth", "--c0", "0", "--tension", "1", "--lengths", "0", "--store", "s"], "--lengths: "),
        (["dispersion", "--c0", "0", "--lengths", "10", "--store", "no/s"], "/no does not exist; make it first"),
        (["dispersion", "--c0", "0", "--lengths", "10", "--store", "s", "--workers", "2", "--scheduler", "tcp://x:1"], "--workers: "),
        (["branch", "blob", "--mode", "1,1", "--c0", "0", "--lengths", "10", "--volumes", "0.9", "--store", "s"], "FAMILY: "),
        (["--radius", "50nm", "dispersion", "--c0", "0", "--lengths", "10", "--store", "s"], "--radius: it stands before dispersion"),
        (["branch", "pearl", "--mode", "1,1", "--c0", "0", "--lengths", "10", "--volumes", "1.1", "--store", "s"], "--mode: pearls"),
        (["branch", "coil", "--mode", "x", "--c0", "0", "--lengths", "10", "--volumes", "0.9", "--store", "s"], "--mode: "),
    ],
)  # fmt: skip
def test_mistakes_are_one_line(capsys, tmp_path, monkeypatch, words, said):
    monkeypatch.chdir(tmp_path)
    status, out, err = run(capsys, "scan", *words)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert said in err
    assert not list(tmp_path.glob("*.csv"))
