"""``pearlbvp show`` and ``pearlbvp diagram``: saved branches as tables, pictures, profiles and surfaces, without computing."""

import io

import numpy as np
import pandas as pd
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from support.commands import is_png, run

import pearlbvp.continuation.segment
import pearlbvp.newton
from pearlbvp.errors import InputError
from pearlbvp.figures import canvas
from pearlbvp.flows.driver import start
from pearlbvp.helfrich import Tube
from pearlbvp.mesh.files import read_mesh
from pearlbvp.mesh.problem import MeshProblem
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.shapes.ring import RingProblem
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.diagram import diagram
from pearlbvp.studies.flow import load as load_flow
from pearlbvp.studies.flow import save as save_flow
from pearlbvp.studies.flow_start import profile_start
from pearlbvp.studies.onward import switched
from pearlbvp.studies.saved import load, save
from pearlbvp.tube.problem import TubeProblem


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A saved branch of every family."""
    folder = tmp_path_factory.mktemp("branches")
    pearls = family_branch(Tube(0.48, 30), "pearl", (4, 0), branch_options({"v": 1.02}))
    branches = {
        "pearl": pearls,
        "localized": switched(pearls, 1, branch_options({"v": 1.05})),
        "overhang": family_branch(Tube(0.0, 10), "pearl", (1, 0), branch_options({"v": 1.36}, max_step=1.0)),
        "ring": family_branch(Tube(-1.0, 10), "ring", (0, 2), branch_options({"v": 0.7})),
        "coil": family_branch(Tube(0.48, 10), "coil", (1, 1), branch_options({"v": 0.88})),
        "buckle": family_branch(Tube(0.0, 10), "buckle", (1, 1), branch_options({"v": 0.93})),
        "mesh": family_branch(Tube(0.0, 10), "pearl", (1, 0), branch_options({"v": 1.01}), nodes=200),
    }
    for name, branch in branches.items():
        save(branch, folder / f"{name}.h5")
    return {name: (folder / f"{name}.h5", branch) for name, branch in branches.items()}


@pytest.fixture
def reading_only(monkeypatch):
    """Nothing is solved, and no spectrum computed."""

    def refused(*_, **__):
        raise AssertionError("something is computed")

    for kind in (PearlProblem, RingProblem, TubeProblem, MeshProblem):
        for name in ("spectrum", "solve", "block_rates"):
            monkeypatch.setattr(kind, name, refused)
    monkeypatch.setattr(pearlbvp.newton, "newton", refused)
    monkeypatch.setattr(pearlbvp.continuation.segment, "correct", refused)


FAMILIES = ["pearl", "localized", "overhang", "ring", "coil", "buckle", "mesh"]


@pytest.mark.parametrize("name", FAMILIES)
def test_a_saved_branch_is_shown_as_it_was_computed(capsys, files, tmp_path, reading_only, name):
    path, branch = files[name]
    status, out, err = run(capsys, "show", path, "--plot", tmp_path / "b.png")
    table = pd.read_csv(io.StringIO(out), keep_default_na=False)
    assert status == 0
    assert is_png(tmp_path / "b.png")
    np.testing.assert_allclose(table[["lambda2", "v", "E"]], branch.table()[["lambda2", "v", "E"]], rtol=1e-11)
    assert list(table.special) == list(branch.table().special)
    assert branch.reason in err
    assert f"{len(branch.points)} points" in err
    for special in branch.find("bp"):
        assert f"point {special.index}: bp, v = {branch.at(special).observables['v']:.8g}" in err


@pytest.mark.parametrize("name", ["pearl", "localized", "overhang"])
@pytest.mark.parametrize("radius", [1.0, 0.05])
def test_the_integrals_of_a_profile_are_the_area_and_the_volume(capsys, files, tmp_path, reading_only, name, radius):
    """Cones between the rows: areas and volumes are exact, of second order in the step."""
    path, branch = files[name]
    found = branch.points[-1].observables
    length = found["L"] * radius
    errors = []
    for samples in (200, 400):
        status, _, _ = run(
            capsys, "show", path, "--profile", tmp_path / "p.csv", "--samples", samples, "--radius", radius,
            "--out", tmp_path / "t.csv",
        )  # fmt: skip
        assert status == 0
        profile = pd.read_csv(tmp_path / "p.csv")
        x, r = profile.x.to_numpy(), profile.r.to_numpy()
        assert (x[0], x[-1]) == (0, pytest.approx(length, rel=1e-11))
        slant = np.hypot(np.diff(x), np.diff(r))
        area = np.pi * (slant * (r[1:] + r[:-1])).sum() / (2 * np.pi * length * radius)
        volume = np.pi / 3 * (np.diff(x) * (r[1:] ** 2 + r[1:] * r[:-1] + r[:-1] ** 2)).sum()
        errors.append([area - 1, volume / (np.pi * length * radius**2) - found["v"]])
    assert np.abs(errors[1]).max() < 1e-3
    np.testing.assert_allclose(np.array(errors[0]) / errors[1], 4, rtol=0.05)
    # psi is the angle of the tangent, 2H = cos(psi)/r - psi': by differences.
    middle = slice(1, -1)
    step = slant[0]
    np.testing.assert_allclose(np.sin(profile.psi[middle]), (r[2:] - r[:-2]) / (2 * step), atol=5e-3)
    turn = (profile.psi[2:].to_numpy() - profile.psi[:-2].to_numpy()) / (2 * step)
    np.testing.assert_allclose(2 * profile.H[middle], np.cos(profile.psi[middle]) / r[middle] - turn, rtol=0.02,
                               atol=0.02 / radius)  # fmt: skip
    energy = (np.pi * slant * (r[1:] + r[:-1]) * (profile.H.rolling(2).mean()[1:] - found["c0"] / radius) ** 2).sum()
    assert energy / (2 * np.pi * length * radius) * radius**2 == pytest.approx(found["E"], rel=2e-3, abs=1e-4)


def test_the_section_of_a_ring_encloses_its_volume(capsys, files, tmp_path, reading_only):
    path, branch = files["ring"]
    run(capsys, "show", path, "--profile", tmp_path / "p.csv", "--samples", 2000, "--out", tmp_path / "t.csv")
    section = pd.read_csv(tmp_path / "p.csv")
    y, z = section.y.to_numpy(), section.z.to_numpy()
    assert (y[1:] * z[:-1] - z[1:] * y[:-1]).sum() / -2 / np.pi == pytest.approx(0.7, rel=1e-5)
    step = np.hypot(np.diff(y), np.diff(z))
    assert step.sum() == pytest.approx(2 * np.pi, rel=1e-5)
    assert (step * (section.H[1:] + 1.0) ** 2).sum() / (2 * np.pi) == pytest.approx(
        branch.points[-1].observables["E"], rel=1e-5
    )


@pytest.mark.parametrize("name", ["pearl", "overhang", "ring", "coil", "buckle"])
def test_surfaces_of_triangles_and_grids_converge_to_area_and_volume(capsys, files, tmp_path, reading_only, name):
    path, branch = files[name]
    found = branch.points[-1].observables
    length = found["L"] * 2
    errors = []
    for nodes in (1500, 6000):
        for ending in ("ply", "csv"):
            status, _, err = run(
                capsys, "show", path, "--surface", tmp_path / f"s.{ending}", "--nodes", nodes, "--radius", 2,
                "--out", tmp_path / "t.csv",
            )  # fmt: skip
            assert status == 0, err
        mesh = read_mesh(tmp_path / "s.ply", length)
        errors.append([mesh.area / (4 * np.pi * length) - 1, mesh.volume / (4 * np.pi * length) - found["v"]])
        errors[-1] += _grid_errors(pd.read_csv(tmp_path / "s.csv"), length, found["v"])
    assert np.abs(errors[1]).max() < 1.2e-2
    assert np.all(np.abs(errors[1]) < 0.4 * np.abs(errors[0]))


def _grid_errors(grid, length, v):
    """Of area and volume, of the grid's cells as two triangles each."""
    p = grid[["x", "y", "z"]].to_numpy().reshape(grid.i.max() + 1, grid.j.max() + 1, 3)
    np.testing.assert_allclose(p[:, -1], p[:, 0], atol=1e-9)
    np.testing.assert_allclose(p[-1] - p[0], [[length, 0, 0]] * p.shape[1], atol=1e-9)
    a, b, c, d = p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]
    triangles = np.concatenate([np.stack(corners, axis=2).reshape(-1, 3, 3) for corners in ((a, d, c), (a, c, b))])
    vectors = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) / 2
    area = np.linalg.norm(vectors, axis=1).sum()
    volume = abs((triangles.mean(axis=1)[:, 1:] * vectors[:, 1:]).sum()) / 2
    return [area / (4 * np.pi * length) - 1, volume / (4 * np.pi * length) - v]


def test_points_are_named_by_number_value_or_what_is_special_there(capsys, files, tmp_path, reading_only):
    path, branch = files["pearl"]
    volumes = [entry.observables["v"] for entry in branch.points]
    second = branch.find("bp")[1].index
    named = {"-1": len(volumes) - 1, "2": 2, "bp:2": second, "stop": len(volumes) - 1, "v=1.02": len(volumes) - 1}
    between = f"v={0.9 * volumes[1] + 0.1 * volumes[2]}"
    for name, index in (named | {between: 1}).items():
        status, _, err = run(
            capsys, "show", path, "--point", name, "--profile", tmp_path / "p.csv", "--out", tmp_path / "t.csv"
        )
        assert status == 0, err
        assert pd.read_csv(tmp_path / "p.csv").r.max() == pytest.approx(
            branch.points[index].observables["r_max"], rel=1e-9
        )
        assert ("lies between two points" in err) == (name == between)


@pytest.mark.parametrize(
    ("name", "words", "named"),
    [
        ("pearl", ["--point", "v=3", "--profile", "p.csv"], "--point: v = 3 is not reached"),
        ("pearl", ["--point", "fold:v", "--profile", "p.csv"], "special points (start, bp, stop"),
        ("pearl", ["--point", "99", "--surface", "p.obj"], "--point: there is no point 99"),
        ("pearl", ["--point", "1"], "--point: it goes with --profile or --surface"),
        ("pearl", ["--surface", "p.stl"], "--surface: p.stl has the ending .stl"),
        ("buckle", ["--profile", "p.csv"], "--profile: a buckle is made of no single curve; write its surface"),
        ("mesh", ["--profile", "p.csv"], "--profile: a mesh is made of no single curve; write its surface"),
    ],
)
def test_what_cannot_be_shown_is_said_in_one_line(capsys, files, tmp_path, monkeypatch, name, words, named):
    monkeypatch.chdir(tmp_path)
    status, _, err = run(capsys, "show", files[name][0], *words)
    assert (status, err.count("\n")) == (2, 1)
    assert named in err
    assert list(tmp_path.iterdir()) == []


def test_the_vertices_of_a_mesh_are_its_own(capsys, files, tmp_path, reading_only):
    path, branch = files["mesh"]
    status, _, _ = run(capsys, "show", path, "--surface", tmp_path / "m.vtu", "--out", tmp_path / "t.csv")
    point = branch.points[-1]
    assert status == 0
    assert read_mesh(tmp_path / "m.vtu", 10).area == pytest.approx(point.problem.surface(point.u).area, rel=1e-9)


def test_ends_of_flows_and_saved_flows_are_shown(capsys, tmp_path):
    run(
        capsys, "flow", "--c0", 0.48, "--length", 7.5, "--point", "v=1.01", "--delta", 0.01, "--keep", "--points", 24,
        "--save", tmp_path / "f.h5", "--save-end", tmp_path / "e.h5", "--out", tmp_path / "f.csv",
    )  # fmt: skip
    status, out, err = run(capsys, "show", tmp_path / "f.h5", "--plot", tmp_path / "f.png")
    assert status == 0
    assert out == (tmp_path / "f.csv").read_text()
    assert "a flow, saved at t = " in err
    assert "pearlbvp flow --resume" in err
    assert is_png(tmp_path / "f.png")
    status, _, err = run(capsys, "show", tmp_path / "f.h5", "--profile", tmp_path / "p.csv")
    assert (status, "--save-end" in err) == (2, True)
    status, _, err = run(
        capsys, "show", tmp_path / "e.h5", "--profile", tmp_path / "p.csv", "--out", tmp_path / "t.csv"
    )
    assert status == 0
    assert "it is the end of a flow" in err
    profile = pd.read_csv(tmp_path / "p.csv")
    assert np.trapezoid(np.pi * profile.r**2, profile.x) / (np.pi * 7.5) == pytest.approx(1.01, abs=1e-4)


def test_saved_branches_share_a_table_and_a_picture(capsys, files, tmp_path, reading_only):
    paths = [files[name][0] for name in ("pearl", "localized", "coil", "mesh")]
    status, out, _ = run(capsys, "diagram", *paths, "--x", "v", "--y", "wave", "--plot", tmp_path / "d.png")
    table = pd.read_csv(io.StringIO(out))
    assert status == 0
    assert is_png(tmp_path / "d.png")
    assert list(dict.fromkeys(table.branch)) == ["pearl", "localized", "coil", "mesh"]
    for name in ("pearl", "coil"):
        np.testing.assert_allclose(
            table[table.branch == name].lambda2, files[name][1].table().lambda2, rtol=1e-11, atol=1e-14
        )


def test_branches_of_different_tubes_say_so_in_one_line_and_in_the_picture(capsys, files, tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr(canvas, "save_figure", lambda figure, path: (figures.append(figure), path.write_bytes(b"")))
    paths = [files[name][0] for name in ("pearl", "coil", "ring")]
    plot = ["--plot", tmp_path / "d.png"]
    _, _, err = run(capsys, "diagram", *paths, "--radius", 0.5, *plot)
    tubes = {"pearl": "c0 = 0.96, L = 15", "coil": "c0 = 0.96, L = 5", "ring": "c0 = -2, L = 5"}
    said = "; ".join(f"{name}: {tube}" for name, tube in tubes.items())
    assert err == f"pearlbvp: the branches are of different tubes: {said}\n"
    labels = [text.get_text() for text in figures[0].axes[0].get_legend().get_texts()]
    names = ("pearls m = 4", "coils (1,1)", "wrinkles n = 2")
    assert labels == [f"{name} ({tube})" for name, tube in zip(names, tubes.values(), strict=True)]
    _, _, err = run(capsys, "diagram", paths[0], files["localized"][0], *plot)
    assert err == ""
    assert [text.get_text() for text in figures[1].axes[0].get_legend().get_texts()] == [
        "pearls m = 4",
        "localized pearl",
    ]
    run(capsys, "vary", paths[1], "L", "--max-points", 3, "--save", tmp_path / "l.h5")
    _, _, err = run(capsys, "diagram", tmp_path / "l.h5", paths[1], *plot)
    assert err == "pearlbvp: the branches are of different tubes: l: L varies; coil: L = 10\n"


@pytest.mark.parametrize("name", FAMILIES)
def test_a_note_of_the_unit_keeps_away_from_the_edge_and_from_the_axes(capsys, files, tmp_path, monkeypatch, name):
    figures = []
    monkeypatch.setattr(canvas, "save_figure", lambda figure, path: (figures.append(figure), path.write_bytes(b"")))
    run(capsys, "show", files[name][0], "--radius", 0.05, "--plot", tmp_path / "b.png")
    figure = figures[0]
    FigureCanvasAgg(figure).draw()
    note = next(text for text in figure.texts if "radius of the straight tube" in text.get_text()).get_window_extent()
    assert figure.get_figwidth() * figure.dpi - note.x1 > 0.05 * figure.dpi
    assert (
        note.x0 - max(axes.get_window_extent().x1 for axes in figure.axes if note.y0 < axes.get_window_extent().y1) > 0
    )
    if name == "ring":
        ticks = figure.axes[3].get_yticks()
        assert (len(ticks) > 2, 0 in ticks, max(abs(ticks)) < 0.07) == (True, True, True)
        assert figure.axes[3].get_ylabel() == "z (units)"


def test_the_diagram_of_a_tube_is_that_of_its_study(capsys, tmp_path):
    status, out, _ = run(
        capsys, "diagram", "--c0", 24, "--length", 0.3, "--radius", 0.02, "--until", "v=1.05", "--depth", 1,
        "--processes", 1, "--plot", tmp_path / "d.png",
    )  # fmt: skip
    table, expected = pd.read_csv(io.StringIO(out)), diagram(0.48, 15, 1, branch_options({"v": 1.05})).table()
    assert status == 0
    assert list(table.branch) == list(expected.branch)
    np.testing.assert_allclose(table.lambda2 * 0.02**3, expected.lambda2, rtol=1e-10)
    np.testing.assert_allclose(table.wave / 0.02, expected.wave, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    ("words", "named"),
    [
        ([], "FILE, --c0, --length: "),
        (["--c0", "0"], "FILE, --c0, --length: "),
        (["pearl", "--depth", "1"], "--depth: it does not go with FILE.h5; leave one of the two out"),
        (["pearl", "--x", "critical"], "--x: 'critical' is no column with numbers"),
        (["pearl", "--x", "osmolarity"], "--x: no branch here has osmolarity"),
        (["pearl", "pearl"], "is given twice"),
        (["--c0", "0", "--length", "10", "--y", "e"], "--y: 'e' is no column with numbers"),
    ],
)
def test_a_diagram_s_mistakes_are_said_in_one_line(capsys, files, words, named):
    status, _, err = run(capsys, "diagram", *(files[word][0] if word in files else word for word in words))
    assert (status, err.count("\n")) == (2, 1)
    assert named in err


def test_a_damaged_flow_is_named_as_the_file_that_was_typed(capsys, tmp_path):
    x = np.linspace(-5, 5, 40, endpoint=False)
    path = tmp_path / "f.h5"
    save_flow(start(*profile_start(0.0, 10.0, x, 1 + 0.1 * np.cos(0.2 * np.pi * x))), path)
    whole = path.read_bytes()
    for place, said in (
        (700, "cut off, damaged or changed since; give an intact copy, or compute it anew"),
        (10, "; give"),
    ):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 0x80]) + whole[place + 1 :])
        status, out, err = run(capsys, "show", path)
        assert (status, out) == (2, "")
        assert err.startswith(f"pearlbvp: FILE: {path} is ")
        assert said in err
        assert err.isascii()
        status, _, err = run(capsys, "flow", "--resume", path)
        assert err.startswith(f"pearlbvp: --resume: {path} is ")
    with pytest.raises(InputError, match=r"^path: there is no file nope\.h5"):
        load_flow("nope.h5")
    with pytest.raises(InputError, match=r"^path: there is no file nope\.h5"):
        load("nope.h5")
