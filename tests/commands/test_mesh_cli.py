"""Triangulated tubes from the command line: ``pearlbvp branch --nodes`` and ``pearlbvp mesh``."""

import io
import itertools

import numpy as np
import pandas as pd
import pytest
from support.commands import run

from pearlbvp.cli import main
from pearlbvp.continuation.problem import Problem
from pearlbvp.continuation.segment import Segment
from pearlbvp.continuation.solution import Solution
from pearlbvp.helfrich import Tube
from pearlbvp.mesh import functional
from pearlbvp.mesh.families import fewest, tube_mesh
from pearlbvp.mesh.files import read_mesh
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.onward import switched
from pearlbvp.studies.saved import load, save

COLUMNS = ["point", "special", "lambda1", "lambda2", "v", "E", "amplitude", "r_min", "r_max", "n_unstable", "mu_crit",
           "critical", "c0", "L", "mu_error", "wave", "M", "force"]  # fmt: skip


def test_a_shape_is_named_by_what_is_special_there(capsys, tmp_path):
    branch = family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"bp": 1}))
    save(branch, tmp_path / "b.h5")
    rows = [run(capsys, "mesh", "--from", tmp_path / "b.h5", "--point", name)[1] for name in ("bp", "-1", "start")]
    assert rows[0] == rows[1] != rows[2]


def table_of(out):
    return pd.read_csv(io.StringIO(out), keep_default_na=False, na_values={"mu_error": [""]})


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("meshes")


@pytest.fixture(scope="module")
def coil():
    return family_branch(Tube(0.0, 10.0), "coil", (1, 1), branch_options({"v": 0.95}))


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
    assert load(path).points[0].problem.mesh.count == pytest.approx(500, rel=0.1)
    exact = family_branch(Tube(0.0, 10.0), "coil", (1, 1), branch_options({"v": 0.97})).points[-1].observables
    last = written.iloc[-1]
    for name, power in {"lambda1": -2, "lambda2": -3, "v": 0, "E": -2}.items():
        assert last[name] == pytest.approx(exact[name] * 2.0**power, rel=3e-3)
    assert last["r_min"] == pytest.approx(2 * exact["r_min"], rel=2e-4)
    assert (written.n_unstable.astype(int) == 0).all()
    assert picture.read_bytes().startswith(b"\x89PNG\r\n")


def test_it_is_resumed_under_any_family_s_name(capsys, saved, coil):
    exact = coil.points[-1].observables
    status, out, _ = run(capsys, "resume", saved[0], "--until", "v=0.95")
    assert status == 0
    assert table_of(out).lambda2.iloc[-1] == pytest.approx(exact["lambda2"], rel=3e-3)


def test_pressure_is_kept_on_meshes_too(capsys, tmp_path):
    """``test_mesh_branch`` switches branches from files; here what the options say of stability arrives."""
    options = ["--c0", 0, "--length", 10, "--nodes", 100, "--max-points", 2, "--save", tmp_path / "b.h5"]
    for further, held in (([], "area,volume"), (["--pressure", "--discretization", "cotangent"], "area,pressure")):
        assert run(capsys, "branch", "ring", *options, *further)[0] == 0
        problem = load(tmp_path / "b.h5").points[-1].problem
        assert (str(problem.held), problem.kind) == (held, "cotangent" if further else "subdivision")


def interrupted_in_compiled_code(*_):
    """What numba makes of an interruption: a chain of errors, one for each C function on the way out."""
    try:
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt as error:
            raise SystemError("<function _numba_unpickle> returned a result with an exception set") from error
    except SystemError as error:
        raise SystemError("CPUDispatcher(<function limit_sums>) returned a result with an exception set") from error


@pytest.mark.parametrize(("sums", "files"), [(100, True), (0, False)])
def test_an_interruption_inside_compiled_code_keeps_what_was_computed(capsys, monkeypatch, tmp_path, sums, files):
    """After some points all is written; before the first there is nothing to write. Either way it is said in one line."""
    loop, calls = functional.limit_sums, []

    def interrupted(*arguments):
        calls.append(None)
        return interrupted_in_compiled_code() if len(calls) == sums + 1 else loop(*arguments)

    monkeypatch.setattr(functional, "limit_sums", interrupted)
    paths = [tmp_path / name for name in ("b.h5", "b.csv", "b.png")]
    written = itertools.chain(*zip(("--save", "--out", "--plot"), paths, strict=True))
    status, _, err = run(capsys, "branch", "coil", "--c0", 0, "--length", 10, "--nodes", 100, *written)
    monkeypatch.undo()
    assert status == 130
    assert err.splitlines()[-1].startswith("pearlbvp: ")
    assert err.rstrip().endswith("interrupted")
    assert [path.exists() for path in paths] == 3 * [files]
    if files:
        assert 1 < len(load(paths[0]).points) == len(pd.read_csv(paths[1]))


def test_other_errors_inside_compiled_code_are_no_interruption(monkeypatch):
    def broken(*_):
        raise SystemError("a defect") from ValueError("of ours")

    monkeypatch.setattr(functional, "limit_sums", broken)
    with pytest.raises(SystemError, match="a defect"):
        main(["branch", "coil", "--c0", "0", "--length", "10", "--nodes", "100"])


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (["--nodes", "5"], "--nodes"),
        (["--nodes", "1000000000"], "--nodes"),
        (["--nodes", "0"], "--nodes"),
        (["--nodes", "1e6"], "--nodes: '1e6' is not a number of vertices; give a whole one up to 200000"),
        (["--nodes", "100", "--length", "1e6"], "--length: 1e+06 radii are too long for a mesh"),
        (["--nodes", "30", "--mode", "9,0"], "--mode"),
        (["--nodes", "100", "--length", "1000"], "--nodes"),
        (["--nodes", "500", "--shape", "0.1", "--volume", "1"], "--shape"),
        (["--nodes", "500", "--tolerance", "1e-8"], "--tolerance"),
        (["--discretization", "cotangent"], "--discretization"),
    ],
)
def test_mistakes_with_nodes_are_one_line(capsys, arguments, name):
    length = [] if "--length" in arguments else ["--length", 10]
    status, out, err = run(capsys, "branch", "pearl", "--c0", 0, *length, *arguments)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert name in err.partition(": ")[2]
    assert "; " in err or "see --help" in err  # the remedy


@pytest.mark.parametrize(
    ("arguments", "name"),
    [(["vary", "SAVED", "c0"], "keeps its c0"), (["resume", "SAVED", "--nodes", "500"], "--nodes"),
     (["switch", "SAVED", "1", "--centre", "neck"], "--centre"), (["switch", "SAVED", "4"], "none of number 4")],
)  # fmt: skip
def test_what_a_saved_branch_on_a_mesh_does_not_have(capsys, saved, arguments, name):
    status, out, err = run(capsys, *(saved[0] if argument == "SAVED" else argument for argument in arguments))
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert name in err


@pytest.mark.parametrize("length", [0.3, 2.0, 10.0, 300.0])
def test_the_number_of_nodes_that_is_advised_makes_a_good_mesh(length):
    """A remedy that helps: not far from equilateral triangles (3.46)."""
    assert tube_mesh(length, fewest(length)).quality.max() < 3.7


class Shifted(Problem):
    """A curve ``y = x`` whose height is read off with an error that depends on the mesh."""

    def __init__(self, error):
        self.error = error

    def residual(self, u):
        return np.array([u[1] - u[0]])

    def solve(self, u, rhs, row=None):
        return np.linalg.solve(np.array([[-1.0, 1.0], row]), rhs)

    def inner(self, u, v):
        return float(u @ v)

    def transfer(self, other, u):
        return u

    def observables(self, u):
        return {"height": float(u[1]) + self.error}


def test_a_value_that_another_mesh_puts_just_before_the_last_point_is_found_beyond_it():
    first, last = Shifted(0.0), Shifted(0.01)
    tangent = np.full(2, np.sqrt(0.5))
    ends = [Solution(p, np.full(2, x), tangent) for p, x in ((first, 0.0), (last, 1.0))]
    assert ends[0].observables["height"] < 1.005 < ends[1].observables["height"]
    found = Segment(*ends).root(lambda point: point.observables["height"] - 1.005, -1.005)
    assert found.u[0] == pytest.approx(1.005, abs=1e-12)


SHAPE = ["nodes", "triangles", "quality_worst", "quality_mean", "area", "volume", "c0", "L", "E"]
EQUILIBRIUM = [
    "lambda1",
    "lambda2",
    "v",
    "amplitude",
    "r_min",
    "r_max",
    "n_unstable",
    "mu_crit",
    "critical",
    "mu_error",
    "M",
    "force",
]


@pytest.fixture(scope="module")
def shapes(folder, coil):
    """Saved branches of every family, each to a shape far from the straight tube."""
    options = branch_options({"v": 0.96})
    save(family_branch(Tube(0.48, 15.0), "pearl", (2, 0), branch_options({"v": 1.015})), folder / "pearl.h5")
    save(family_branch(Tube(0.0, 4.0), "ring", (0, 2), options), folder / "ring0.h5")
    save(coil, folder / "coil0.h5")
    save(family_branch(Tube(0.0, 10.0), "buckle", (1, 1), options), folder / "buckle.h5")
    coils = family_branch(Tube(0.48, 10.0), "coil", (1, 1), branch_options({"v": 0.905}))
    save(switched(coils, 1, branch_options({"v": 0.907})), folder / "mixed.h5")
    return {name: folder / f"{name}.h5" for name in ("pearl", "ring0", "coil0", "buckle", "mixed")}


def test_the_straight_tube_needs_a_length_only(capsys, tmp_path):
    """Area and volume in the file are those of inscribed polyhedra: below the tube's, by the square of the mesh width."""
    errors = []
    for nodes in (500, 2000):
        path = tmp_path / "tube.vtu"
        status, out, err = run(capsys, "mesh", "--length", 20, "--radius", 2, "--nodes", nodes, "--out", path)
        assert (status, err) == (0, "")
        table = table_of(out)
        assert list(table.columns) == SHAPE
        row, read = table.iloc[0], read_mesh(path, 20.0)
        assert (row.nodes, row.triangles) == (read.count, len(read.triangles))
        assert row.nodes == pytest.approx(nodes, rel=0.1)
        assert (row.area, row.volume) == pytest.approx((read.area, read.volume), rel=1e-6)
        assert row.quality_mean <= row.quality_worst < 3.6
        assert row["E"] == pytest.approx(0.25 / 4, rel=1e-4)  # (1/2)^2 at radius 1
        errors.append((1 - row.area / (2 * np.pi * 2 * 20), 1 - row.volume / (np.pi * 4 * 20)))
    (area, volume), (finer_area, finer_volume) = errors
    assert area / finer_area == pytest.approx(4, rel=0.2)
    assert volume / finer_volume == pytest.approx(4, rel=0.2)
    assert finer_volume > 0


@pytest.mark.parametrize("name", ["pearl", "ring0", "coil0", "buckle", "mixed"])
def test_a_shape_of_a_branch_of_any_family_becomes_an_equilibrium(capsys, shapes, tmp_path, name):
    """Vertices on the shape, then the discrete equilibrium: its own multipliers, energy and growth rate are the branch's."""
    end = load(shapes[name]).points[-1]
    exact = end.observables
    status, out, _ = run(capsys, "mesh", "--from", shapes[name], "--nodes", 700, "--plot", tmp_path / "m.png")
    assert status == 0
    given = table_of(out).iloc[0]
    assert given["E"] == pytest.approx(exact["E"], rel=2e-3, abs=1e-5)
    assert given.volume == pytest.approx(np.pi * exact["L"] * exact["v"], rel=0.02)
    assert (tmp_path / "m.png").read_bytes().startswith(b"\x89PNG\r\n")
    status, out, _ = run(capsys, "mesh", "--from", shapes[name], "--nodes", 700, "--solve", "--out", tmp_path / "m.ply")
    assert status == 0
    table = table_of(out)
    assert list(table.columns) == SHAPE + EQUILIBRIUM
    row = table.iloc[0]
    assert row.v == pytest.approx(exact["v"], abs=1e-11)
    for column in ("lambda1", "lambda2"):
        assert row[column] == pytest.approx(exact[column], rel=2e-3)
    assert row["M"] == pytest.approx(exact["M"], rel=1e-3)
    assert row.force == pytest.approx(exact["force"], rel=5e-3)
    assert row["E"] == pytest.approx(exact["E"], rel=1e-3, abs=1e-5)
    assert row.n_unstable == end.spectrum.n_unstable
    assert row.mu_crit == pytest.approx(end.spectrum.mu_crit, rel=0.05, abs=2e-3)
    read = read_mesh(tmp_path / "m.ply", exact["L"])
    assert (read.area, read.volume) == pytest.approx((row.area, row.volume), rel=1e-6)


def test_points_are_chosen_in_the_user_s_unit_of_length(capsys, shapes):
    """lambda2 = -0.48 at radius 1 is -0.06 at radius 2; what is written scales by its powers of length."""
    common = ["mesh", "--from", shapes["pearl"], "--nodes", 300, "--solve"]
    one = table_of(run(capsys, *common, "--point", "lambda2=-0.48")[1]).iloc[0]
    two = table_of(run(capsys, *common, "--point", "lambda2=-0.06", "--radius", 2)[1]).iloc[0]
    powers = {"area": 2, "volume": 3, "c0": -1, "L": 1, "E": -2, "lambda1": -2, "lambda2": -3, "v": 0, "amplitude": 1,
              "r_min": 1, "r_max": 1, "mu_crit": -4, "quality_worst": 0}  # fmt: skip
    for name, power in powers.items():
        assert two[name] == pytest.approx(one[name] * 2.0**power, rel=1e-7), name


def test_a_point_of_a_branch_on_a_mesh_has_its_own_triangles(capsys, saved, tmp_path):
    """The saved coil of 500 nodes: the mesh is the branch's, and so is the equilibrium."""
    last = load(saved[0]).points[-1]
    status, out, _ = run(capsys, "mesh", "--from", saved[0], "--solve", "--out", tmp_path / "c.obj")
    assert status == 0
    row = table_of(out).iloc[0]
    assert row.nodes == last.problem.mesh.count
    assert row.lambda2 == pytest.approx(last.observables["lambda2"], rel=1e-10)
    assert row.mu_crit == pytest.approx(last.spectrum.mu_crit, rel=1e-6)
    assert read_mesh(tmp_path / "c.obj", 10.0).count == row.nodes


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ([], "--length, --from"),
        (["--length", "0"], "--length"),
        (["--length", "10", "--nodes", "4"], "--nodes"),
        (["--length", "10", "--nodes", "0"], "--nodes"),
        (["--length", "10", "--nodes", "-3"], "--nodes"),
        (["--length", "10", "--nodes", "1e6"], "--nodes"),
        (["--length", "10", "--nodes", "1000000"], "--nodes"),
        (["--length", "1e6", "--nodes", "3000"], "--length"),
        (["--length", "1e6"], "--length"),
        (["--length", "10", "--radius", "-1"], "--radius"),
        (["--length", "10", "--solve"], "--solve"),
        (["--length", "10", "--point", "A2"], "--point"),
        (["--length", "10", "--out", "tube.stl"], "--out"),
        (["--length", "10", "--out", "no/such/folder/tube.vtu"], "--out"),
        (["--from", "none.h5"], "--from"),
        (["--from", "{buckle}", "--c0", "1"], "--c0"),
        (["--from", "{buckle}", "--point", "A2"], "--point"),
        (["--from", "{buckle}", "--point", "99"], "--point"),
        (["--from", "{buckle}", "--point", "v=0.2"], "--point"),
        (["--from", "{buckle}", "--point", "0", "--solve"], "--point"),
        (["--from", "{mesh}", "--nodes", "500"], "--nodes"),
        (["--from", "{mesh}", "--discretization", "cotangent"], "--discretization"),
        (["--from", "{mesh}", "--plot", "{mesh}"], "--plot"),
    ],
)
def test_mistakes_of_mesh_are_one_line(capsys, monkeypatch, tmp_path, shapes, saved, arguments, name):
    monkeypatch.chdir(tmp_path)
    paths = {key: str(path) for key, path in shapes.items()} | {"mesh": str(saved[0])}
    status, out, err = run(capsys, "mesh", *(word.format(**paths) for word in arguments))
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert err.startswith(f"pearlbvp: {name}: ")
    assert "; " in err


def test_a_stability_that_the_mesh_does_not_resolve_is_said(capsys, tmp_path):
    """The buckle has one unstable direction: 60 nodes lose it and say so, 1000 have it."""
    path = tmp_path / "k.h5"
    save(family_branch(Tube(0.0, 10.0), "buckle", (1, 1), branch_options({"v": 0.85})), path)
    said = {}
    for nodes in (60, 1000):
        status, out, err = run(capsys, "mesh", "--from", path, "--solve", "--nodes", nodes)
        assert status == 0
        said[nodes] = (table_of(out)["n_unstable"][0], "n_unstable is not certain" in err)
    assert said == {60: (0, True), 1000: (1, False)}
