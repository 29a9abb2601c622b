"""Branches and flows that were saved in nanometres speak nanometres."""

import io

import pandas as pd
import pytest
from support.commands import run

from pearlbvp.hdf5 import group_of


def table_of(out):
    return pd.read_csv(io.StringIO(out))


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    from pearlbvp.studies.branch import branch_options, family_branch
    from pearlbvp.studies.saved import save
    from pearlbvp.units import Units

    path, units = tmp_path_factory.mktemp("units") / "b.h5", Units.of("50nm", "20kT")
    tube = units.tube("1/(52nm)", "0.75um")
    save(family_branch(tube, "pearl", (2, 0), branch_options({"v": 1.01})), path, units=units)
    return path


def test_a_branch_is_saved_with_its_units_and_goes_on_in_them(capsys, saved, tmp_path):
    status, out, err = run(capsys, "show", saved)
    assert (status, err.splitlines()[0].split(", ", 2)[2]) == (0, "C0 = 0.019230769/nm, L = 750 nm, v = 1 to 1.01")
    shown = table_of(out)
    assert shown["L[nm]"].to_numpy() == pytest.approx(750)
    status, out, err = run(capsys, "switch", saved, 1, "--until", "r_min=35nm", "--save", tmp_path / "l.h5")
    assert status == 0, err
    assert table_of(out)["r_min[nm]"].iloc[-1] == pytest.approx(35, rel=1e-9)
    assert group_of("FILE", tmp_path / "l.h5", "units") == group_of("FILE", saved, "units")
    assert group_of("FILE", saved, "units")["unit"] == "nm"
    status, out, err = run(capsys, "vary", tmp_path / "l.h5", "c0", "--until", "C0=1/(51nm)")
    assert status == 0, err
    assert table_of(out)["C0[1/nm]"].iloc[-1] == pytest.approx(1 / 51, rel=1e-9)
    status, out, err = run(capsys, "diagram", saved, tmp_path / "l.h5")
    assert (status, "lambda1[mN/m]" in table_of(out)) == (0, True), err


def test_options_change_the_units_of_a_saved_branch(capsys, saved):
    """The same tube in micrometres, with another rigidity, in the other convention, and in radii."""
    nm, um, softer, theirs, number = (
        table_of(run(capsys, "show", saved, *options)[1])
        for options in (
            [], ["--radius", "0.05um"], ["--kappa", "10kT"], ["--convention", "mem3dg", "--kappa", "40kT"], ["--radius", 1]
        )
    )  # fmt: skip
    assert um["L[um]"].to_numpy() == pytest.approx(0.75)
    assert um["lambda1[mN/m]"].to_numpy() == pytest.approx(nm["lambda1[mN/m]"].to_numpy())
    assert softer["lambda2[Pa]"].to_numpy() == pytest.approx(nm["lambda2[Pa]"].to_numpy() / 2)
    assert theirs["lambda2[Pa]"].to_numpy() == pytest.approx(nm["lambda2[Pa]"].to_numpy())
    assert theirs["c0[1/nm]"].to_numpy() == pytest.approx(nm["C0[1/nm]"].to_numpy() / 2)
    assert number["L"].to_numpy() == pytest.approx(15)


def test_a_point_that_is_not_there_is_said_in_nanometres(capsys, saved, tmp_path):
    status, _, err = run(capsys, "show", saved, "--point", "r_min=45nm", "--profile", tmp_path / "p.csv")
    nearest = pd.read_csv(tmp_path / "p.csv")["r[nm]"].min()
    assert status == 0
    assert err.startswith("pearlbvp: r_min = 45 nm lies between two points; the nearest, point ")
    assert f"has {nearest:.6g}"[:-1] in err
    assert "(pearlbvp branch --until r_min=45nm computes the shape itself)" in err
    for place, words in (
        ("r_min=2um", "--point: r_min = 2000 nm is not reached on this branch, where it goes from "),
        (
            "C0=1/nm",
            "--point: C0 = 1/nm is not reached on this branch, where it goes from 0.0192308/nm to 0.0192308/nm; give",
        ),
    ):
        status, _, err = run(capsys, "show", saved, "--point", place, "--profile", tmp_path / "p.csv")
        assert (status, err.count("\n")) == (2, 1)
        assert words in err


def test_tubes_apart_have_units(capsys, saved, tmp_path):
    run(capsys, "vary", saved, "c0", "--until", "C0=1/(51nm)", "--save", tmp_path / "c.h5", "--out", tmp_path / "c.csv")
    status, _, err = run(capsys, "diagram", saved, tmp_path / "c.h5")
    assert (status, err) == (0, "pearlbvp: the branches are of different tubes: b: C0 = 0.0192308/nm; c: C0 varies\n")


def test_flows_keep_the_units_of_the_branch_that_they_start_from(capsys, saved, tmp_path):
    start = ["flow", "--from", saved, "--delta", "1nm", "--save", tmp_path / "f.h5"]
    status, out, err = run(capsys, *start, "--time", "0.01nm/Pa")
    assert status == 0, err
    assert table_of(out)["t[nm/Pa]"].iloc[-1] == pytest.approx(0.01, rel=1e-9)
    assert "at t = 0.01 nm/Pa the time asked for is reached" in err
    status, shown, err = run(capsys, "show", tmp_path / "f.h5")
    assert shown == out
    assert "saved at t = 0.01 nm/Pa" in err
    status, out, err = run(capsys, "flow", "--resume", tmp_path / "f.h5", "--time", "0.012nm/Pa")
    assert (status, table_of(out)["t[nm/Pa]"].iloc[-1]) == (0, pytest.approx(0.012, rel=1e-9)), err
    status, _, err = run(capsys, "flow", "--resume", tmp_path / "f.h5", "--time", "1s")
    assert (status, err) == (2, "pearlbvp: --time: 1s is a time; give one in nm/Pa\n")


def test_branches_of_different_tubes_take_one_radius(capsys, saved, tmp_path):
    from pearlbvp.studies import saved as store
    from pearlbvp.units import Units

    store.save(store.load(saved), tmp_path / "o.h5", units=Units.of("60nm", "20kT"))
    status, _, err = run(capsys, "diagram", saved, tmp_path / "o.h5")
    assert (status, err.count("\n")) == (2, 1)
    assert "is saved in other units than the one before; give --radius for all" in err
    status, _, err = run(capsys, "diagram", saved, tmp_path / "o.h5", "--radius", "50nm")
    assert status == 0, err


def test_without_units_nothing_is_saved_of_them(capsys, tmp_path):
    arguments = ["branch", "pearl", "--c0", 0, "--length", 10, "--max-points", 2, "--save", tmp_path / "b.h5"]
    run(capsys, *arguments)
    assert group_of("FILE", tmp_path / "b.h5", "units") == {}
    status, out, _ = run(capsys, "show", tmp_path / "b.h5")
    assert (status, out.splitlines()[0].split(",")[:4]) == (0, ["point", "special", "lambda1", "lambda2"])


@pytest.mark.parametrize(("convention", "name", "own"), [("physicists", "c0", "C0"), ("mem3dg", "C0", "c0")])
def test_the_other_convention_s_curvature_is_not_taken_for_one_s_own(capsys, saved, tmp_path, convention, name, own):
    units = ["--radius", "50nm", "--kappa", "20kT", "--convention", convention]
    status, out, err = run(capsys, "vary", saved, "c0", "--until", f"{name}=1/(51nm)", *units)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert f"--until: the spontaneous curvature is {own} here" in err
