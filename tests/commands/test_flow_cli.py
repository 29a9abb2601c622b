"""``pearlbvp flow`` as its users meet it."""

import io
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from support.commands import run

from pearlbvp.helfrich import Tube
from pearlbvp.mesh.families import tube_mesh
from pearlbvp.mesh.files import write_mesh
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.onward import switched
from pearlbvp.studies.saved import save

COLUMNS = ["t", "E", "lambda1", "lambda2", "area_error", "volume_error", "velocity"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a saved branch of two pearls of period 7.5."""
    path = tmp_path_factory.mktemp("flows")
    save(family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.02})), path / "b.h5")
    return path


def test_a_flow_from_a_saved_branch_writes_everything(capsys, folder):
    files = [folder / name for name in ("f.csv", "f.png", "f.gif", "f.h5")]
    status, out, err = run(
        capsys, "flow", "--from", str(folder / "b.h5"), "--point", "v=1.015", "--perturb", "critical", "--delta", "0.02",
        "--keep", "--out", str(files[0]), "--plot", str(files[1]), "--movie", str(files[2]), "--save", str(files[3]),
    )  # fmt: skip
    assert (status, out) == (0, "")
    assert "steady: at t = " in err
    assert "n_unstable = 0" in err
    table = pd.read_csv(files[0])
    assert list(table.columns[:7]) == COLUMNS
    localized = switched(
        family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.015})), 1, branch_options({"v": 1.015})
    )
    assert table["E"].iloc[-1] == pytest.approx(localized.points[-1].observables["E"], abs=1e-9)
    assert files[1].read_bytes().startswith(b"\x89PNG\r\n")
    assert files[2].read_bytes().startswith(b"GIF89a")
    # Resumed, it rests at once.
    status, out, err = run(capsys, "flow", "--resume", str(files[3]))
    assert status == 0
    assert len(pd.read_csv(io.StringIO(out))) <= len(table) + 10


def test_a_tube_of_a_computed_branch(capsys, folder):
    status, out, err = run(
        capsys, "flow", "--family", "coil", "--c0", "0", "--length", "10", "--point", "B", "--perturb", "critical",
        "--delta", "0.05", "--size", "6,4", "--time", "2.5", "--plot", str(folder / "coil.png"),
    )  # fmt: skip
    assert status == 0
    assert "the time asked for" in err
    table = pd.read_csv(io.StringIO(out))
    assert table["t"].iloc[-1] == 2.5
    assert table["E"].is_monotonic_decreasing


def test_other_laws(capsys, folder):
    ends = []
    for law in ("diffusion", "area and volume"):
        status, out, _ = run(
            capsys,
            "flow",
            "--from",
            str(folder / "b.h5"),
            "--law",
            law,
            "--perturb",
            "bump",
            "--delta",
            "-0.02",
            "--centre",
            "1",
        )
        assert status == 0
        ends.append(pd.read_csv(io.StringIO(out)).iloc[-1])
    assert ends[0]["E"] == pytest.approx(ends[1]["E"], abs=1e-9)
    assert ends[0]["lambda2"] == pytest.approx(ends[1]["lambda2"], abs=1e-4)


def test_a_profile_from_a_table(capsys, folder):
    x = np.linspace(-5, 5, 41)
    pd.DataFrame({"x": x, "r": 1 + 0.3 * np.cos(0.2 * np.pi * x)}).to_csv(folder / "p.csv", index=False)
    status, out, _err = run(capsys, "flow", "--profile", str(folder / "p.csv"), "--c0", "0", "--length", "10")
    assert status == 0
    end = pd.read_csv(io.StringIO(out)).iloc[-1]
    assert end["v"] == pytest.approx(1 + 0.3**2 / 2, abs=1e-5)  # of the spline through 41 points
    scale = (1 + 0.3 * np.cos(0.2 * np.pi * x[:-1])) * np.hypot(1, 0.06 * np.pi * np.sin(0.2 * np.pi * x[:-1]))
    area = scale.mean()
    assert end["area"] == pytest.approx(area, abs=1e-5)
    # The branch of the similar tube at the reduced volume that the table has.
    scale = end["area"]
    pearls = (
        family_branch(Tube(0, 10 / scale), "pearl", (1, 0), branch_options({"v": end["v_reduced"]}))
        .points[-1]
        .observables
    )
    for name, power in (("E", 2), ("lambda1", 2), ("lambda2", 3), ("r_min", -1)):
        assert end[name] * scale**power == pytest.approx(pearls[name], abs=1e-6)


def test_a_profile_in_another_unit_is_not_taken_for_one_in_radii(capsys):
    """A tube of radius 50 nm: without --radius refused with the radius to give, with it as the same profile in radii."""
    path = Path(__file__).parents[1] / "data" / "profile_in_nm.csv"
    status, out, err = run(capsys, "flow", "--profile", str(path), "--c0", "0", "--length", "500")
    assert (status, out) == (2, "")
    assert err == "pearlbvp: --radius: the tube's radius is about 50, not 1; give --radius 50\n"
    table, _ = rows_of(capsys, "--profile", path, "--c0", 0, "--length", 500, "--radius", 50, "--time", 50**4)
    assert table["r_max"].iloc[0] == pytest.approx(52.5, abs=1e-3)
    k = 2 * np.pi / 10
    assert table["area"].iloc[0] == pytest.approx(1 + (0.05 * k) ** 2 / 4, abs=1e-6)


@pytest.mark.parametrize(("unit", "decimals"), [(1, 3), (50, 1)])
def test_a_profile_of_few_decimals_is_smoothed_which_is_said_in_the_user_s_unit(capsys, tmp_path, unit, decimals):
    """By its rows as they are written it has a tension of about -100."""
    length, path = unit * 10 / 3, tmp_path / "p.csv"
    x = np.linspace(0, length, 41)
    r = unit * (1 + 0.1 * np.sin(2 * np.pi * x / length))
    path.write_text(" X , R\n" + "".join(f"{a:.{decimals}f},{b:.{decimals}f}\n" for a, b in zip(x, r, strict=True)))
    table, err = rows_of(
        capsys, "--profile", path, "--c0", 0, "--length", length, "--radius", unit, "--time", 1e-9 * unit**4
    )
    assert table["lambda1"].iloc[0] * unit**2 == pytest.approx(-2.394236, abs=0.03)  # test_rounding has the closed form
    rounded = f"{10.0**-decimals:.2g}"
    assert (
        f"pearlbvp: p.csv: r is rounded to {rounded}, too few digits for its curvature: smoothed by 1 wave, which"
        in err
    )


def test_what_is_wrong_with_a_mesh_is_said_of_the_file_that_was_typed(capsys, tmp_path):
    path = tmp_path / "t.obj"
    write_mesh(tube_mesh(10.0, 100), path)
    whole = path.read_text().replace("v ", "v nan ", 1).split("\n")
    for lines, said in (
        (whole, ""),
        ([line for line in path.read_text().split("\n") if line != "f 1 2 3"][:-5], "the edge from vertex"),
    ):
        path.write_text("\n".join(lines))
        status, out, err = run(capsys, "flow", "--mesh", path, "--c0", 0, "--length", 10)
        assert (status, out) == (2, "")
        assert err.startswith(f"pearlbvp: --mesh: {path}")
        assert said in err
        write_mesh(tube_mesh(10.0, 100), path)


def test_a_flow_onto_the_straight_tube_says_so(capsys, folder, tmp_path):
    """At given pressure, where the straight tube is stable."""
    x = np.linspace(-5, 5, 41)
    pd.DataFrame({"x": x, "r": 1 + 0.02 * np.cos(0.2 * np.pi * x)}).to_csv(tmp_path / "p.csv", index=False)
    start = ["--profile", tmp_path / "p.csv", "--c0", 0, "--length", 10, "--law", "area", "--pressure", -0.5]
    table, err = rows_of(capsys, *start)
    assert table["amplitude"].iloc[-1] < 1e-5
    assert "its end is the straight tube" in err
    assert "pearlbvp dispersion has its stability" in err


def test_a_killed_flow_writes_what_it_has(folder, tmp_path):
    """SIGTERM as Ctrl-C: the table so far, one line, status 130."""
    words = [
        "flow",
        "--from",
        folder / "b.h5",
        "--nodes",
        "800",
        "--out",
        tmp_path / "f.csv",
        "--save",
        tmp_path / "f.h5",
    ]
    process = subprocess.Popen([sys.executable, "-m", "pearlbvp", *map(str, words)], stderr=subprocess.PIPE, text=True)
    for _ in range(600):  # it saves every two seconds
        if (tmp_path / "f.h5").exists() or process.poll() is not None:
            break
        time.sleep(0.1)
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=60)
    err = [line for line in err.splitlines() if "compiling" not in line]
    assert process.returncode == 130, err
    assert len(err) == 1
    assert err[0].startswith("pearlbvp: interrupted: at t = ")
    table = pd.read_csv(tmp_path / "f.csv")
    assert len(table) > 1
    assert table["E"].iloc[-1] < table["E"].iloc[0]


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (["--from", "none.h5"], "--from"),
        (["--from", "{b}", "--c0", "0"], "--c0"),
        (["--from", "{b}", "--point", "A2"], "--point"),
        (["--from", "{b}", "--point", "0"], "--point"),  # the straight tube
        (["--from", "{b}", "--delta", "3"], "--delta"),
        (["--from", "{b}", "--out", "{b}"], "--out"),
        (["--from", "{b}", "--save", "{b}"], "--save"),
        (["--from", "{b}", "--velocity", "0"], "--velocity"),
        (["--from", "{b}", "--time", "0"], "--time"),
        (["--from", "{b}", "--movie", "f.mp4"], "--movie"),
        (["--from", "{b}", "--plot", "f.foo"], "--plot"),
        (["--from", "{b}", "--max-seconds", "-1"], "--max-seconds"),
        (["--c0", "0", "--length", "10", "--point", "w=1"], "--point"),
        (["--c0", "0", "--length", "10", "--point", "v=much"], "--point"),
        (["--resume", "{b}"], "--resume"),
        (["--c0", "0"], "--c0, --length"),
        (["--resume", "{b}", "--delta", "0.1"], "--delta"),
        (["--from", "{b}", "--size", "4,4"], "--size"),
        (["--from", "{b}", "--tube", "--points", "64"], "--points"),
        (["--from", "{b}", "--pressure", "1"], "--pressure"),
        (["--from", "{b}", "--perturb", "critical", "--xi", "2"], "--xi"),
        (["--from", "{b}", "--perturb", "none", "--keep"], "--keep"),
        (["--from", "{b}", "--resume", "{b}"], "--from"),
        (["--profile", "{b}"], "--profile"),
        (["--profile", "{b}", "--c0", "0", "--length", "10"], "--profile"),
        (["--profile", "{bad}", "--c0", "0", "--length", "10"], "--profile"),
        (["--c0", "0", "--length", "10"], "--point"),
        (["--family", "buckle", "--c0", "0", "--length", "10", "--point", "v=0.97", "--size", "2,2"], "--size"),
        (["--from", "{b}", "--xi", "-1"], "--xi"),
        (["--from", "{b}", "--tube", "--xi", "-1"], "--xi"),
        (["--from", "{b}", "--nodes", "300", "--xi", "-1"], "--xi"),
        (["--from", "{b}", "--delta", "-50"], "--delta"),
        (["--from", "{b}", "--nodes", "300", "--delta", "-50"], "--delta"),
        (["--from", "{b}", "--tube", "--size", "1,1"], "--size"),
        (["--from", "{b}", "--tube", "--size", "60,60"], "--size"),
        (["--from", "{b}", "--tube", "--point", "0"], "--point"),
        (["--from", "{b}", "--nodes", "300", "--point", "0"], "--point"),
        (["--c0", "0", "--length", "10", "--point", "v=1"], "--point"),
        (["--c0", "0", "--length", "10", "--point", "B"], "--point"),
        (["--c0", "0", "--length", "10", "--point=A7"], "--point"),
    ],
)
def test_mistakes_are_one_line(capsys, folder, arguments, name):
    pd.DataFrame({"x": [0.0, 1.0, 2.0, 3.0], "r": [1.0, 1.0, -1.0, 1.0]}).to_csv(folder / "bad.csv", index=False)
    arguments = [a.replace("{bad}", str(folder / "bad.csv")) for a in arguments]
    perturb = ["--perturb", "none"] if arguments[-2:] == ["--point", "0"] else []
    status, out, err = run(capsys, "flow", *(a.replace("{b}", str(folder / "b.h5")) for a in arguments), *perturb)
    assert (status, out) == (2, "")
    assert err.startswith(f"pearlbvp: {name}: ")
    assert err.count("\n") == 1
    if "=A7" in arguments[-1] or arguments[-1] == "B":
        assert "A2 (pearl, c0 = 0, L = 10 radii), B (coil, c0 = 0, L = 10 radii)" in err
    if arguments[-1] == "v=1" or perturb:
        assert "straight tube" in err


@pytest.mark.parametrize("other", [[], ["--nodes", "200"]])
def test_coils_flow_by_diffusion(capsys, other):
    """Perturbed, back towards the coil: energy falls, neither area nor volume changes, in modes and on a mesh."""
    coil = ["--family", "coil", "--c0", "0", "--length", "10", "--point", "v=0.97", "--law", "diffusion", *other]
    status, out, err = run(capsys, "flow", *coil, "--perturb", "bump", "--delta", "0.02", "--keep", "--time", "0.5")
    assert status == 0, err
    rows = pd.read_csv(io.StringIO(out))
    assert rows["t"].iloc[-1] == 0.5
    falls = rows["E"].diff()[rows["t"].diff() > 0]  # two rows at one time are two meshes of one surface
    assert falls.max() < 1e-10
    assert falls.sum() < -1e-6
    assert rows[["area_error", "volume_error"]].abs().to_numpy().max() < 1e-12


def test_a_saved_coil_flows_back(capsys, tmp_path):
    """From a file of tubes, perturbed out of its symmetry: a stable coil is where the flow comes to rest again."""
    branch = family_branch(Tube(0.0, 10.0), "coil", (1, 1), branch_options({"v": 0.95}))
    save(branch, tmp_path / "c.h5")
    options = ["--point", "v=0.95", "--delta", "-0.05", "--size", "8,8", "--keep", "--time", "5"]
    status, out, err = run(capsys, "flow", "--from", str(tmp_path / "c.h5"), *options)
    assert status == 0, err
    table = pd.read_csv(io.StringIO(out))
    assert table.t.iloc[-1] == pytest.approx(5.0)
    assert (table.E.diff().dropna() <= 1e-12).all()
    assert table.E.iloc[-1] == pytest.approx(branch.points[-1].observables["E"], rel=1e-4)


def rows_of(capsys, *arguments, table=True):
    """The table and what is said, or only that."""
    status, out, err = run(capsys, "flow", *map(str, arguments))
    assert status == 0, err
    return (pd.read_csv(io.StringIO(out)), err) if table else err


POWERS = {
    "lambda1": -2, "lambda2": -3, "E": -2, "v": 0, "area_error": 0, "amplitude": 1, "r_min": 1, "r_max": 1, "area": 0,
    "v_reduced": 0,
}  # fmt: skip


def test_a_radius_scales_a_flow(capsys, folder):
    """Everything that is given in the user's unit, at radius 2, against the flow at radius 1, step by step."""
    start = ["--from", folder / "b.h5", "--law", "area and volume"]
    one, _ = rows_of(capsys, *start, "--point", "lambda2=-0.5", "--delta", 0.03, "--xi", 2, "--centre", 1, "--time", 40,
                     "--velocity", 1e-5)  # fmt: skip
    two, _ = rows_of(capsys, *start, "--point", f"lambda2={-0.5 / 8}", "--delta", 0.06, "--xi", 0.5, "--centre", 2,
                     "--time", 640, "--velocity", 1e-5 / 8, "--radius", 2)  # fmt: skip
    assert len(one) == len(two) > 20
    for name, power in (POWERS | {"t": 4, "velocity": -3}).items():
        np.testing.assert_allclose(two[name], one[name] * 2.0**power, rtol=1e-9, atol=1e-12)


def numbers(words):
    return np.array([float(number) for number in re.findall(r"(?<== )-?[\d.]+(?:e-?\d+)?|(?<= is )-?[\d.]+", words)])


@pytest.mark.parametrize(("law", "time"), [("area and volume", 4), ("diffusion", 6)])
def test_the_last_words_are_in_the_user_s_unit(capsys, folder, law, time):
    """Times and rates at radius 1 and 2; by the L2 flow mu_crit is given, too."""
    start = ["--from", folder / "b.h5", "--law", law, "--perturb", "critical", "--keep"]
    one, two = (
        rows_of(capsys, *start, "--radius", radius, "--delta", 0.02 * radius, "--out", folder / "f.csv", table=False)
        for radius in (1, 2)
    )
    powers = [time, -time, 0, *([-4] if law == "area and volume" else [])]  # t, rate, n_unstable, mu_crit
    np.testing.assert_allclose(numbers(two), numbers(one) * 2.0 ** np.array(powers), rtol=6e-3)
    assert ("mu_crit" in one) == (law == "area and volume")
    path = folder / "thin.csv"
    pd.DataFrame({"x": [-5, -4, 0, 4, 5], "r": [2, 2, 0.015, 2, 2]}).to_csv(path, index=False)
    _, _, err = run(capsys, "flow", "--profile", path, "--c0", 0, "--length", 20, "--radius", 2)
    assert f"--profile: {path}: the neck at x = 0 has a radius of 1.5e-02" in err


@pytest.mark.parametrize(("law", "time"), [("area and volume", 4), ("diffusion", 6)])
def test_powers_of_length_are_those_of_a_flow_on_a_tube_twice_as_thick(capsys, tmp_path, law, time):
    """A profile of radius 2 flows by itself, all numbers about 2 and 20; with --radius 2 it is one of radius 1 inside.

    The two runs share no scaling. They agree to the tolerance of their steps, at a time and at its rates.
    """
    x = np.linspace(-10, 10, 161)
    path = tmp_path / "p.csv"
    pd.DataFrame({"x": x, "r": 2 + 0.4 * np.cos(0.1 * np.pi * x) + 0.05 * np.cos(0.3 * np.pi * x)}).to_csv(
        path, index=False
    )
    common = ["--profile", path, "--c0", 0.1, "--length", 20, "--law", law, "--time", 2.0**time]
    plain, _ = rows_of(capsys, *common)
    inside, _ = rows_of(capsys, *common, "--radius", 2)
    assert inside["t"].iloc[-1] == plain["t"].iloc[-1] == 2.0**time
    assert plain["E"].iloc[-1] < 0.99 * plain["E"].iloc[0]
    assert plain["velocity"].iloc[-1] < 0.01 * plain["velocity"].iloc[0]
    for row, tolerance in ((0, 1e-9), (-1, 3e-3)):
        for name in ("E", "lambda1", "lambda2", "velocity", "amplitude", "r_min", "r_max"):
            assert inside[name].iloc[row] == pytest.approx(plain[name].iloc[row], rel=tolerance), (name, row)
        assert inside["v"].iloc[row] == pytest.approx(plain["v"].iloc[row] / 4, rel=tolerance)  # by its own radius


def test_a_saved_flow_is_resumed_at_a_radius(capsys, folder, tmp_path):
    """Times count from where it was, in the user's unit; an earlier one is refused, and said in that unit."""
    path = tmp_path / "f.h5"
    start = ["--from", folder / "b.h5", "--perturb", "critical", "--delta", 0.02, "--radius", 2, "--time", 16]
    first, err = rows_of(capsys, *start, "--save", path, "--movie", tmp_path / "f.gif", "--plot", tmp_path / "f.png")
    assert first["t"].iloc[-1] == 16
    assert "at t = 16 the time asked for" in err
    second, _ = rows_of(capsys, "--resume", path, "--radius", 2, "--time", 32)
    assert second["t"].iloc[-1] == 32
    pd.testing.assert_frame_equal(second.iloc[: len(first)], first)
    for until in ("8", "16", "16.00000000000001", "16.0000000000004"):  # the last is a step that IDA cannot make
        status, _, err = run(capsys, "flow", "--resume", str(path), "--radius", "2", "--time", until)
        assert status == 2
        assert "t = 16 already" in err
    for until in (16.00000000001, 16.0000001):
        assert rows_of(capsys, "--resume", path, "--radius", 2, "--time", until)[0]["t"].iloc[-1] == pytest.approx(
            until
        )


def test_flows_on_triangulated_tubes(capsys, folder, tmp_path):
    """From a point of a branch, from that on a mesh, and from the mesh in a file: energies of one shape, falling."""
    short = ["--time", "2e-4", "--perturb", "bump", "--delta", "-0.02"]
    table, _ = rows_of(capsys, "--from", folder / "b.h5", "--nodes", 300, *short, "--plot", tmp_path / "f.png",
                       "--movie", tmp_path / "f.gif", "--save", tmp_path / "f.h5")  # fmt: skip
    assert table[["area_error", "volume_error"]].abs().to_numpy().max() < 1e-10
    assert table["E"].is_monotonic_decreasing
    on, _ = rows_of(capsys, "--resume", tmp_path / "f.h5", "--time", 4e-4)
    assert on["E"].iloc[-1] < table["E"].iloc[-1]
    save(family_branch(Tube(0.0, 10.0), "coil", (1, 1), branch_options({"v": 0.99}), nodes=200), tmp_path / "m.h5")
    rested, err = rows_of(capsys, "--from", tmp_path / "m.h5", "--perturb", "none", "--save-end", tmp_path / "e.h5")
    assert "a triangulated tube of" in err
    assert "n_unstable = 0" in err
    status, _, _ = run(
        capsys, "mesh", "--from", str(tmp_path / "e.h5"), "--point", "0", "--out", str(tmp_path / "c.ply")
    )
    assert status == 0
    common = ["--c0", 0, "--length", 10, "--time", 1e-4]
    read, _ = rows_of(capsys, "--mesh", tmp_path / "c.ply", *common)
    assert read["E"].iloc[0] == pytest.approx(rested["E"].iloc[-1], rel=1e-3)
    assert read["v"].iloc[0] == pytest.approx(0.99, rel=1e-3)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (["--from", "{b}", "--discretization", "cotangent"], "--discretization"),
        (["--from", "{b}", "--nodes", "300", "--points", "64"], "--points"),
        (["--from", "{b}", "--nodes", "3"], "--nodes"),
        (["--from", "{b}", "--nodes", "5000", "--law", "diffusion"], "--nodes"),
        (["--mesh", "{b}", "--c0", "0", "--length", "10"], "--mesh"),
        (["--mesh", "none.ply", "--c0", "0", "--length", "10"], "--mesh"),
        (["--mesh", "none.ply", "--c0", "0"], "--mesh"),
        (["--mesh", "none.ply", "--c0", "0", "--length", "10", "--delta", "0.1"], "--delta"),
    ],
)
def test_mistakes_with_meshes_are_one_line(capsys, folder, arguments, name):
    status, out, err = run(capsys, "flow", *(a.replace("{b}", str(folder / "b.h5")) for a in arguments))
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert err.startswith(f"pearlbvp: {name}: ")


def test_the_end_of_a_flow_becomes_a_branch(capsys, folder):
    end = folder / "end.h5"
    status, _, err = run(
        capsys, "flow", "--family", "coil", "--c0", "0", "--length", "10", "--point", "v=0.92", "--perturb", "none",
        "--size", "8,8", "--out", str(folder / "e.csv"), "--save-end", str(end),
    )  # fmt: skip
    assert status == 0
    assert "a right-handed coil; to all perturbations of this tube: n_unstable = 0" in err
    status, out, err = run(capsys, "resume", str(end), "--until", "v=0.9")
    assert (status, err) == (0, "")
    there = family_branch(Tube(0.0, 10.0), "coil", (1, 1), branch_options({"v": 0.9})).points[-1]
    last = pd.read_csv(io.StringIO(out)).iloc[-1]
    for name in ("v", "E", "lambda1", "lambda2"):
        assert last[name] == pytest.approx(there.observables[name], abs=1e-10)
    assert last["n_unstable"] == there.spectrum.n_unstable


def test_a_flow_that_does_not_rest_has_no_end_to_save(capsys, folder):
    end = folder / "none.h5"
    status, out, err = run(
        capsys, "flow", "--from", str(folder / "b.h5"), "--point", "v=1.015", "--time", "0.01", "--save-end", str(end)
    )
    assert status == 1
    assert out.startswith("t,E")
    assert "--save-end: it ended as 'time'" in err
    assert not end.exists()
    status, out, err = run(
        capsys, "flow", "--from", str(folder / "b.h5"), "--save-end", str(folder / "b.h5"), "--point", "v=1.015"
    )
    assert (status, out) == (2, "")
    assert "--save-end" in err
