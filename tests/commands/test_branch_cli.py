"""``pearlbvp branch``: what is written, saved, resumed, switched and refused."""

import io
from pathlib import Path

import pandas as pd
import pytest
from support.commands import is_png, run

from pearlbvp.stability.profile import Profile

DATA = Path(__file__).parents[2] / "data"


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
    status, out, err = run(capsys, "resume", saved, "--until", "v=1.005", "--max-points", 2)
    assert err.startswith(
        "pearlbvp: v moves away from its wanted value where the branch ends, and comes to it only where it turns"
    )
    status, out, err = run(capsys, "resume", saved, "--until", "v=1.02", "--save", more)
    assert err == ""
    longer = pd.read_csv(io.StringIO(out), keep_default_na=False)
    assert longer.iloc[: len(table) - 1].equals(table.iloc[:-1])
    status, out, _ = run(capsys, "switch", more, "1", "--until", "v=1.05")
    assert (pd.read_csv(io.StringIO(out)).n_unstable == 0).all()
    status, out, _ = run(capsys, "vary", more, "c0", "--down", "--until", "c0=0.47")
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
    arguments = ["follow", saved, "fold:v:1", "c0", "--down"]
    status, out, err = run(
        capsys, *arguments, "--max-step", "0.2", "--until", "c0=0.7", "--plot", str(tmp_path / "f.png")
    )
    assert (status, err) == (0, "")
    table = pd.read_csv(io.StringIO(out), keep_default_na=False)
    assert table.c0.iloc[-1] == 0.7
    assert is_png(tmp_path / "f.png")
    for change in (
        [*arguments, "--save", saved],
        ["follow", saved, "fold:1", "c0"],
        ["follow", saved, "bp:9", "c0"],
        ["follow", saved, "bp:1", "v"],
        ["follow", str(tmp_path / "nothing.h5"), "bp:1", "c0"],
    ):
        status, _, err = run(capsys, *change)
        assert (status, err.count("\n")) == (2, 1)


def test_options_that_a_saved_branch_has_already(capsys, tmp_path):
    saved = str(tmp_path / "b.h5")
    run(capsys, "branch", "pearl", "--c0", "0", "--length", "10", "--max-points", "3", "--save", saved)
    for option in (["--pressure"], ["--tolerance", "1e-8"], ["--mode", "2,0"], ["--c0", "0"]):
        status, _, err = run(capsys, "resume", saved, *option)
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
        (["branch", "pearl", "--c0", "0", "--length", "10", "--until", "v=0.9"], "has the same shapes"),
        (["vary", "SAVED", "L", "--keep", "lambda2", "--until", "v=1.05"], "give --down"),
        (["vary", "SAVED", "c0", "--down", "--until", "c0=0.5"], "leave --down out"),
    ],
)
def test_a_branch_that_moves_away_from_its_goal_says_so(capsys, tmp_path, options, advice):
    """And names the other direction, which leads there."""
    saved = str(tmp_path / "b.h5")
    run(capsys, "branch", "pearl", "--c0", "0", "--length", "10", "--until", "v=1.1", "--save", saved)
    options = [saved if option == "SAVED" else option for option in options]
    status, _, err = run(capsys, *options, "--max-points", "5", "--max-step", "0.1")
    assert (status, err.count("\n")) == (1, 1)
    assert "--max-points = 5 reached; " in err
    assert "moved away from its wanted value from the start on" in err
    assert err.rstrip().endswith(advice)
    if "--down" in advice:
        other = [o for o in options if o != "--down"] if "leave" in advice else [*options, "--down"]
        status, out, _ = run(capsys, *other)
        assert status == 0
        assert out.rstrip().splitlines()[-1].split(",")[1] == "stop"


def test_a_branch_that_comes_nearer_is_not_said_to_move_away(capsys):
    _, _, err = run(capsys, "branch", "pearl", "--c0", "0", "--length", "10", "--until", "v=2", "--max-points", "5")
    assert "ask for more" in err
    assert "moved away" not in err


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
    status, out, err = run(capsys, "switch", saved, "1", "--until", "v=0.907", "--save", mixed)
    assert (status, err) == (0, "")
    table = pd.read_csv(io.StringIO(out))
    assert (table.n_unstable == 0).all()
    assert table.mu_error.max() < 1e-7
    status, out, _ = run(capsys, "resume", mixed, "--until", "v=0.9075")
    assert status == 0
    assert pd.read_csv(io.StringIO(out)).v.iloc[-1] == pytest.approx(0.9075, abs=1e-11)


@pytest.mark.parametrize(
    ("command", "options", "named"),
    [
        ("branch ring", ("--resume", "SAVED"), "--resume"),
        ("branch torus", ("--c0", "0", "--length", "10"), "choose one of pearl, ring, coil, buckle"),
        ("vary", ("SAVED", "L"), "studies.ring_onsets"),
        ("switch", ("SAVED", "1", "--centre", "neck"), "--centre"),
        ("switch", ("SAVED", "7"), "K: the branch has 0 branch points, so there is none of number 7"),
        ("branch coil", ("--c0", "0", "--length", "10", "--tolerance", "1e-8"), "--tolerance"),
        ("branch ring", ("--c0", "0", "--length", "10", "--mode", "1,2"), "--mode"),
        ("branch coil", ("--c0", "0", "--length", "10", "--mode", "1,0"), "--mode"),
        ("branch coil", ("--c0", "0", "--length", "0"), "--length"),
        ("branch buckle", ("--c0", "nan", "--length", "10"), "--c0"),
        ("branch coil", ("--c0", "0", "--length", "10", "--shape", "0.1", "--volume", "1"), "--shape"),
        ("branch pearl", ("--c0", "0", "--length", "10", "--cells", "2"), "--cells: it goes with --shape"),
    ],
)
def test_options_that_a_family_does_not_have(capsys, tmp_path, command, options, named):
    saved = str(tmp_path / "r.h5")
    run(capsys, "branch", "ring", "--c0=-1", "--length", "10", "--until", "v=0.99", "--save", saved)
    status, out, err = run(capsys, *command.split(), *(saved if option == "SAVED" else option for option in options))
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert named in err


@pytest.fixture
def bending(capsys, tmp_path, request):
    """Pearls up to where they bend, in a user's unit: the file, and the options that name the unit."""
    path, unit = tmp_path / "b.h5", [] if request.param == 1 else ["--radius", request.param]
    given = ["--c0", repr(0.9 / request.param), "--length", repr(12 * request.param), *unit]
    status, _, err = run(capsys, "branch", "pearl", *given, "--until", "bp=1", "--save", path)
    assert status == 0, err
    return path, unit, request.param


@pytest.mark.parametrize("bending", [1.0, 0.37], indirect=True)
def test_branches_that_break_the_symmetry_about_the_axis_leave_pearls(capsys, tmp_path, bending):
    """What is saved of them is read, goes on, and is the same in every unit."""
    path, unit, radius = bending
    status, out, err = run(capsys, "switch", path, 1, "--until", "v=1.02", "--save", path, *unit)
    assert status == 0, err
    table = pd.read_csv(io.StringIO(out))
    assert table["lambda2"].iloc[0] == pytest.approx(-0.19410923 / radius**3, rel=1e-6)
    assert table["lambda2"].iloc[-1] == pytest.approx(-0.22805 / radius**3, rel=1e-4)
    status, out, err = run(capsys, "resume", path, "--until", "v=1.015", *unit)
    assert status == 0, err
    assert pd.read_csv(io.StringIO(out))["v"].iloc[-1] == pytest.approx(1.015, abs=1e-12)


@pytest.mark.parametrize("bending", [1.0, 0.37], indirect=True)
def test_where_pearls_that_overhang_bend_the_command_is_said_that_follows_them_on_a_mesh(capsys, monkeypatch, bending):
    """As it stands it follows the same pearls, on a mesh, in the user's unit."""
    path, unit, radius = bending
    monkeypatch.setattr(Profile, "is_graph", False)
    status, _, err = run(capsys, "switch", path, 1, *unit)
    assert status == 2
    assert "at branch point 1 the pearls overhang" in err
    assert f"lambda2 = {-0.19410923 / radius**3:.4g}, v = 1.02842" in err
    command = err.split("pearlbvp ")[1].split(" --save")[0].split()
    status, out, err = run(capsys, *command[: command.index("--nodes")], "--nodes", 200, "--max-points", 2)
    assert status == 0, err
    table = pd.read_csv(io.StringIO(out))
    assert table["L"].iloc[0] == pytest.approx(12 * radius)
    assert table["lambda2"].iloc[0] == pytest.approx(-0.06075744678 / radius**3, rel=2e-3)
    assert table["n_unstable"].iloc[0] == 12


def test_a_mode_of_coils_that_is_refused_is_named_as_one_and_its_remedy_will_do(capsys):
    command = ["branch", "coil", "--c0", "0", "--mode", "3,1", "--radius", "50", "--max-points", "2", "--length"]
    status, out, err = run(capsys, *command, "0.37")
    assert (status, out) == (2, "")
    assert err.startswith("pearlbvp: --mode: waves (3,1) on L = 0.37 are 0.123 long")
    assert "pearls" not in err
    status, out, _ = run(capsys, *command, err.rsplit("like ", 1)[1].strip())
    assert (status, len(pd.read_csv(io.StringIO(out)))) == (0, 2)
