"""Triangulated tubes from the command line: ``pearlbvp branch --nodes`` and ``pearlbvp mesh``."""

import io

import numpy as np
import pandas as pd
import pytest

from pearlbvp.cli import main
from pearlbvp.continuation.path import Point
from pearlbvp.continuation.segment import Segment
from pearlbvp.mesh.families import fewest, tube_mesh
from pearlbvp.studies.branch import branch_options
from pearlbvp.studies.saved import load
from pearlbvp.studies.tube import tube_branch

COLUMNS = ["point", "special", "lambda1", "lambda2", "v", "E", "amplitude", "r_min", "r_max", "n_unstable", "mu_crit",
           "critical", "c0", "L", "mu_error"]  # fmt: skip


def run(capsys, *arguments):
    """Exit status, standard output and standard error of a call in this process."""
    with pytest.raises(SystemExit) as left:
        main([str(word) for word in arguments])
    captured = capsys.readouterr()
    said = [line for line in captured.err.splitlines(keepends=True) if not line.startswith("pearlbvp: compiling")]
    return left.value.code, captured.out, "".join(said)


def table_of(out):
    return pd.read_csv(io.StringIO(out), keep_default_na=False, na_values={"mu_error": [""]})


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("meshes")


@pytest.fixture(scope="module")
def coil():
    return tube_branch(0.0, 10.0, "coil", (1, 1), branch_options({"v": 0.95}))


@pytest.fixture(scope="module")
def saved(folder):
    """A coil on a mesh, followed at a radius of 2 by the command line; what it wrote."""
    path, table, picture = folder / "coil.h5", folder / "coil.csv", folder / "coil.png"
    with pytest.raises(SystemExit) as left:
        main(["branch", "coil", "--c0", "0", "--length", "20", "--radius", "2", "--nodes", "500", "--until", "v=0.97",
              "--save", str(path), "--out", str(table), "--plot", str(picture)])  # fmt: skip
    assert left.value.code == 0
    return path, table, picture


def test_a_branch_on_a_mesh_is_the_coil_of_reduced_modes(saved, coil):
    path, table, picture = saved
    written = pd.read_csv(table, keep_default_na=False)
    assert list(written.columns) == COLUMNS
    assert written.special.iloc[-1] == "stop"
    assert load(path).points[0].point.problem.mesh.count == pytest.approx(500, rel=0.1)
    exact = tube_branch(0.0, 10.0, "coil", (1, 1), branch_options({"v": 0.97})).points[-1].observables
    last = written.iloc[-1]
    for name, power in {"lambda1": -2, "lambda2": -3, "v": 0, "E": -2}.items():
        assert last[name] == pytest.approx(exact[name] * 2.0**power, rel=3e-3)
    assert last["r_min"] == pytest.approx(2 * exact["r_min"], rel=0.01)  # of a few vertices
    assert (written.n_unstable.astype(int) == 0).all()
    assert picture.read_bytes().startswith(b"\x89PNG\r\n")


def test_it_is_resumed_under_any_family_s_name(capsys, saved, coil):
    exact = coil.points[-1].observables
    status, out, _ = run(capsys, "branch", "pearl", "--resume", saved[0], "--until", "v=0.95")
    assert status == 0
    assert table_of(out).lambda2.iloc[-1] == pytest.approx(exact["lambda2"], rel=3e-3)


def test_branches_on_meshes_are_switched(capsys, folder):
    """Modulated rings at the first branch point of the rings, from a file as from memory (``test_mesh_branch``)."""
    path = folder / "ring.h5"
    options = ["--c0", 0, "--length", 10, "--nodes", 400, "--until", "v=0.953", "--pressure", "--save", path]
    status, _, _ = run(capsys, "branch", "ring", *options)
    assert status == 0
    assert load(path).points[-1].point.problem.fixed == "area"
    rings = load(path)
    assert [special.block.name for special in rings.find("bp")] == ["breaking"] * 2
    neutral = rings.at(rings.find("bp")[0])
    assert np.abs(neutral.spectrum.rates[rings.find("bp")[0].block]).min() < 1e-6
    status, out, err = run(capsys, "branch", "ring", "--resume", path, "--switch", 1, "--max-points", 3, "--step", 0.05)
    assert (status, err.count("\n")) == (0, 1)
    found = table_of(out)
    assert len(found) == 3
    assert found.r_min.iloc[-1] < 0.985 * found.r_min.iloc[0]


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (["--nodes", "5"], "--nodes"),
        (["--nodes", "1000000000"], "--nodes"),
        (["--nodes", "many"], "Invalid value for '--nodes'"),
        (["--nodes", "30", "--mode", "9,0"], "--mode"),
        (["--nodes", "100", "--length", "1000"], "--nodes"),
        (["--nodes", "500", "--shape", "0.1", "--volume", "1"], "--shape"),
        (["--nodes", "500", "--tolerance", "1e-8"], "--tolerance"),
        (["--nodes", "500", "--vary", "L"], "--vary"),
        (["--discretization", "cotangent"], "--discretization"),
    ],
)
def test_mistakes_with_nodes_are_one_line(capsys, arguments, name):
    status, out, err = run(capsys, "branch", "pearl", "--c0", 0, "--length", 10, *arguments)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert name in err.partition(": ")[2]
    assert "; " in err or "see --help" in err  # the remedy


@pytest.mark.parametrize(
    ("arguments", "name"),
    [(["--vary", "c0"], "--vary"), (["--nodes", "500"], "--nodes"), (["--switch", "1", "--centre", "neck"], "--centre"),
     (["--switch", "4"], "--switch")],
)  # fmt: skip
def test_what_a_saved_branch_on_a_mesh_does_not_have(capsys, saved, arguments, name):
    status, out, err = run(capsys, "branch", "pearl", "--resume", saved[0], *arguments)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert name in err


@pytest.mark.parametrize("length", [0.3, 2.0, 10.0, 300.0])
def test_the_number_of_nodes_that_is_advised_makes_a_good_mesh(length):
    """A remedy that helps: not far from equilateral triangles (3.46)."""
    assert tube_mesh(length, fewest(length)).quality.max() < 3.7


class Shifted:
    """A curve ``y = x`` whose height is read off with an error that depends on the mesh."""

    def __init__(self, error):
        self.error = error

    def residual(self, u):
        return np.array([u[1] - u[0]])

    def solve(self, u, rhs, row=None):
        return np.linalg.solve(np.array([[-1.0, 1.0], row]), rhs)

    def inner(self, u, v):
        return float(u @ v)

    def adopt(self, other, u):
        return u

    def observables(self, u):
        return {"height": float(u[1]) + self.error}


def test_a_value_that_another_mesh_puts_just_before_the_last_point_is_found_beyond_it():
    first, last = Shifted(0.0), Shifted(0.01)
    tangent = np.full(2, np.sqrt(0.5))
    ends = [Point(p, np.full(2, x), tangent, p.observables(np.full(2, x))) for p, x in ((first, 0.0), (last, 1.0))]
    assert ends[0].observables["height"] < 1.005 < ends[1].observables["height"]
    found = Segment(*ends).root(lambda point: point.observables["height"] - 1.005, -1.005)
    assert found.u[0] == pytest.approx(1.005, abs=1e-12)
