"""Flows at the public door: every start, what can be done with how it went, and what is said of mistakes."""

import doctest

import numpy as np
import pandas as pd
import pytest
from support.commands import run

import pearlbvp as pb
from pearlbvp import shape_flow

L = 10.0
TUBE = pb.Tube(c0=0.0, L=L)


@pytest.fixture(scope="module")
def pearls():
    return pb.branch(pb.Tube(c0=0.48, L=15), "pearl", (2, 0), until={"v": 1.015})


@pytest.fixture(scope="module")
def localizing(pearls):
    return pb.flow(pearls[-1], keep=True)


@pytest.fixture(scope="module")
def coil():
    return pb.branch(TUBE, "coil", until={"v": 0.97})[-1]


def radii(x, height=0.1):
    return 1 + height * np.cos(2 * np.pi * x / L)


def bulged(x, phi):
    return np.column_stack((x, radii(x) * np.cos(phi), radii(x) * np.sin(phi)))


def test_examples_are_true():
    failed, tried = doctest.testmod(shape_flow)
    assert failed == 0 < tried


def test_where_a_flow_ends_is_a_point_of_a_branch_that_was_followed_without_it(pearls, localizing):
    localized = pearls.switch(1, until={"v": 1.015})[-1]
    assert (localizing.status, localizing.described) == ("steady", "an axisymmetric tube")
    for name in ("E", "lambda2", "r_max"):
        assert localizing.end.observables[name] == pytest.approx(localized.observables[name], abs=1e-8)
    assert (localizing.end.spectrum.n_unstable, pearls[-1].spectrum.n_unstable) == (0, 1)
    onwards, back = localizing.branch({"v": 1.02}), localizing.branch({"v": 1.01})
    assert (onwards[-1].observables["v"], back[-1].observables["v"]) == pytest.approx((1.02, 1.01), abs=1e-10)
    assert localizing.branch({"bp": 1}, down=True)["bp:1"].observables["v"] == pytest.approx(
        pearls["bp:1"].observables["v"], abs=1e-6
    )


def test_a_saved_flow_goes_on(localizing, pearls, tmp_path):
    begun = pb.flow(pearls[-1], keep=True, until=1.0)
    begun.save(tmp_path / "f.h5")
    again = pb.load(tmp_path / "f.h5")
    assert (type(again), again.status, again.complete) == (pb.Flow, "saved", False)
    pd.testing.assert_frame_equal(again.table(), begun.table())
    with pytest.raises(pb.InputError, match=r"^flow: it ended as 'saved' and is no equilibrium; let it rest first$"):
        again.end  # noqa: B018
    rested = again.resume()
    assert rested.status == "steady"
    assert rested.end.observables["E"] == pytest.approx(localizing.end.observables["E"], abs=1e-9)
    assert len(rested.table()) > len(begun.table())


def test_shapes_on_the_way_keep_area_and_volume_as_triangles_and_as_radii(localizing):
    """Sums over the shapes themselves, not the flow's: V/(pi L) is the mean of r^2, A/(2 pi L) that of r sqrt(1 + r'^2)."""
    assert [shape.t for shape in localizing.shapes] == list(localizing.table()["t"])
    assert localizing.at(20.0).t == pytest.approx(20.0, abs=5.0)
    for shape in (localizing.shapes[0], localizing.at(20.0), localizing.shapes[-1]):
        profile = shape.profile(800)
        x, r = profile["x"].to_numpy()[:-1], profile["r"].to_numpy()[:-1]
        slope = (np.roll(r, -1) - np.roll(r, 1)) / (2 * (x[1] - x[0]))
        assert np.mean(r**2) == pytest.approx(1.015, abs=1e-9)
        assert np.mean(r * np.sqrt(1 + slope**2)) == pytest.approx(1, abs=1e-4)  # differences of second order
        fine, coarse = (shape.surface(nodes) for nodes in (4000, 1000))
        errors = [abs(mesh.volume / (np.pi * 15) - 1.015) for mesh in (coarse, fine)]
        assert errors[1] < 5e-3
        assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)  # flat triangles, of second order


def test_pictures_and_pages(pearls, localizing, tmp_path):
    from matplotlib.figure import Figure

    assert [axes.get_ylabel().partition(" ")[0] for axes in localizing.plot("a flow").axes[:2]] == ["energy", "tension"]
    figure = Figure()
    places = figure.subplots(2)
    for place, shape in zip(places, (localizing.shapes[0], localizing.at(20.0)), strict=True):
        assert shape.plot(place) is figure
    assert places[1].get_title() == f"t = {localizing.at(20.0).t:.4g}"
    assert localizing.shapes[-1].plot().axes[0].collections
    begun = pb.flow(pearls[-1], max_steps=3)
    begun.movie(tmp_path / "f.gif")
    assert (tmp_path / "f.gif").read_bytes().startswith(b"GIF89a")
    assert '"kind":"flow"' in begun.explore().text


def test_a_coil_that_was_perturbed_flows_back_in_every_discretization(coil):
    """Among modes and on a mesh the same energy falls away, to each one's own error."""
    how = {"perturb": "bump", "delta": 0.05, "keep": True, "until": 0.05}
    modes, mesh = pb.flow(coil, size=(7, 5), **how), pb.flow(coil, nodes=300, discretization="subdivision", **how)
    falls = [flow.table()["E"].iloc[0] - flow.table()["E"].iloc[-1] for flow in (modes, mesh)]
    assert falls[0] > 1e-5
    assert falls[1] == pytest.approx(falls[0], rel=0.05)  # of edges of half a radius, in fourth order
    assert modes.shapes[0].surface(300).area == pytest.approx(
        mesh.shapes[0].surface().area, rel=5e-3
    )  # of flat triangles both
    with pytest.raises(
        pb.InputError, match="^profile: the shape flows among tubes of all symmetries; take its surface"
    ):
        modes.shapes[0].profile()


def test_a_shape_is_one_however_it_is_given(tmp_path):
    x = np.linspace(0, L, 65)
    how = {"tube": TUBE, "until": 1e-3}
    pd.DataFrame({"x": x, "r": radii(x)}).to_csv(tmp_path / "p.csv", index=False)
    nm = pb.Units.of("50nm")
    flows = [
        pb.flow_shape((x, radii(x)), **how),
        pb.flow_shape(pd.DataFrame({"x": x, "r": radii(x)}), **how),
        pb.flow_shape({"x": list(x), "r": list(radii(x))}, **how),
        pb.flow_shape(tmp_path / "p.csv", **how),
        pb.flow_shape((50 * x, 50 * radii(x)), units=nm, **how),
    ]
    k = 2 * np.pi / L
    slope = 0.1 * k * np.sin(k * x[:-1])
    area = np.mean(radii(x[:-1]) * np.sqrt(1 + slope**2))
    for flow in flows:
        assert flow.table()["area"].iloc[0] == pytest.approx(area, rel=1e-7)
        assert flow.table()["E"].iloc[-1] == pytest.approx(flows[0].table()["E"].iloc[-1], rel=1e-9)
    surface = flows[0].shapes[0].surface(500)
    for kind, error in (("subdivision", 1e-3), ("cotangent", 2e-2)):  # of fourth order in the edges, and of second
        energy = pb.flow_shape(surface, discretization=kind, **how).table()["E"].iloc[0]
        assert energy == pytest.approx(flows[0].table()["E"].iloc[0], rel=error)


def test_a_mesh_in_a_file_flows_as_by_the_command(capsys, tmp_path):
    from pearlbvp.mesh.families import tube_mesh
    from pearlbvp.mesh.files import write_mesh

    write_mesh(tube_mesh(L, 200, bulged), tmp_path / "t.ply")
    _, out, _ = run(capsys, "flow", "--mesh", tmp_path / "t.ply", "--c0", 0, "--length", L, "--law", "area", "--pressure", -1,
                    "--time", 1e-3)  # fmt: skip
    (tmp_path / "t.csv").write_text(out)
    flow = pb.flow_shape(tmp_path / "t.ply", TUBE, law="area", pressure=-1, until=1e-3)
    pd.testing.assert_frame_equal(
        flow.table(), pd.read_csv(tmp_path / "t.csv"), check_dtype=False, rtol=1e-6, atol=1e-9
    )


def test_a_flow_that_rests_on_a_saddle_is_perturbed_again():
    """Four waves at a fixed area: they hold all by symmetry, and leave by the shape's most unstable vector."""
    x = np.linspace(0, 2 * L, 129)
    tube = pb.Tube(c0=0.0, L=2 * L)
    resting = pb.flow_shape((x, radii(x, 0.3)), tube)
    assert (resting.status, resting.end.spectrum.n_unstable > 0) == ("saddle", True)
    left = pb.flow(resting, delta=0.05, keep=True)
    assert left.status == "steady"
    assert left.table()["E"].iloc[-1] < resting.table()["E"].iloc[-1]
    assert left.table()[["area", "v"]].iloc[-1].to_numpy() == pytest.approx(
        resting.table()[["area", "v"]].iloc[-1].to_numpy(), abs=1e-10
    )


X = np.linspace(0, L, 33)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda point: pb.flow(point, size=(8, 8)), r"^size: it is for tubes, and axisymmetric shapes have \(points\)"),
        (lambda point: pb.flow(point, symmetric=False, points=64), "^points: it is for axisymmetric shapes"),
        (lambda point: pb.flow(point, nodes=300, symmetric=False), "^symmetric: it says nothing of a triangulated tube"),
        (lambda point: pb.flow(point, nodes="many"), "^nodes: 'many' must be a whole number"),
        (lambda point: pb.flow(point, discretization="cotangent"), "^discretization: it is for triangulated tubes"),
        (lambda point: pb.flow(point, nodes=300, discretization="squares"), "^discretization: 'squares' is unknown; choose one"),
        (lambda point: pb.flow(point, nodes=0), "^nodes: 0 must be a whole number, 1 or more"),
        (lambda point: pb.flow(point, symmetric=False, size="8,8"), "^size: '8,8' must be two whole numbers, waves along"),
        (lambda point: pb.flow(point, xi=2), "^xi: it is for bumps; leave it out$"),
        (lambda point: pb.flow(point, perturb="none", delta=0.1), "^delta: nothing is perturbed; leave it out$"),
        (lambda point: pb.flow(point, perturb="kick"), "^perturb: 'kick' is unknown; choose one of none, bump, critical$"),
        (lambda point: pb.flow(point, law="drag"), "^law: 'drag' is unknown"),
        (lambda point: pb.flow(point, points=9), "^points: 9 is no even number from 8 to"),
        (lambda point: pb.flow(point, points="9"), "^points: '9' must be a whole number"),
        (lambda point: pb.flow(point, until="soon"), "^until: 'soon' is not a number"),
        (lambda point: pb.flow(point, until=-1), "^until: -1 must be positive"),
        (lambda point: pb.flow(point, max_steps=0.5), "^max_steps: 0.5 must be a whole number"),
        (lambda point: pb.flow(point, delta=9), "^delta: the perturbed surface closes, crosses itself or is too steep"),
        (lambda point: pb.flow(pb.flow(point, until=1e-3)), "^flow: it ended as 'time' and is no equilibrium; let it rest"),
        (lambda point: pb.flow(pb.flow(point, until=1e-3), points=64), "^points: the flow has its own; leave it out$"),
        (lambda point: pb.flow(point, until=1e-3).at(7), "^t: 7 is not between 0 and 0.001; give a time of the flow$"),
        (lambda point: pb.flow(point, until=1e-3).movie("f.mp4"), "^path: f.mp4 has the ending .mp4; give one of .gif$"),
        (lambda point: pb.flow(point, until=1e-3).described, "^flow: it ended as 'time'"),
        (lambda point: pb.flow(point, until=1e-3).shapes[0].surface(2), "^nodes: 2 make no tube; give 20 or more$"),
        (lambda point: pb.flow(point, until=1e-3).explore(y="w"), "^y: no branch here has a column 'w'"),
        (lambda _: pb.flow_shape((X, radii(X)), 10), "^tube: int must be a tube"),
        (lambda _: pb.flow_shape(7, TUBE), r"^shape: int holds no places x and radii r; give \(x, r\), a table"),
        (lambda _: pb.flow_shape({"x": X}, TUBE), "^shape: dict holds no places x and radii r"),
        (lambda _: pb.flow_shape((X, radii(X)[1:]), TUBE), "^shape: give four or more places x and as many radii r"),
        (lambda _: pb.flow_shape((X, radii(X)), pb.Tube(0.0, 20)), "^shape: x runs over 10 of the period 20 only"),
        (lambda _: pb.flow_shape((50 * X, 50 * radii(X)), TUBE), "^shape: the tube's radius is about 50.2, not 1; give its"),
        (lambda _: pb.flow_shape((X, radii(X)), TUBE, pressure=-1), "^pressure: it goes with the law area; leave it out$"),
        (lambda _: pb.flow_shape((X, radii(X)), TUBE, discretization="cotangent"), "^discretization: it is for triang"),
        (lambda _: pb.flow_shape((X, 0 * X + 1), TUBE), "^shape: the shape is the straight tube, where"),
        (lambda _: pb.flow_shape("none.csv", TUBE), "^shape: there is no file none.csv"),
        (lambda _: pb.flow_shape("none.ply", TUBE), "^shape: there is no file none.ply"),
        (lambda _: pb.flow_shape((X, radii(X)), TUBE, time=1), "^time: there is no such argument; there are until, "),
        (lambda _: pb.load("none.h5"), "^path: there is no file none.h5"),
    ],
)  # fmt: skip
def test_mistakes_are_one_line(pearls, call, said):
    with pytest.raises(pb.InputError, match=said) as error:
        call(pearls[-1])
    assert "\n" not in str(error.value)


def test_a_mesh_of_another_tube_is_refused():
    from pearlbvp.mesh.families import tube_mesh

    mesh = tube_mesh(L, 100, bulged)
    for call, said in (
        (
            lambda: pb.flow_shape(mesh, pb.Tube(0.0, 9.0)),
            "^tube: the mesh has a period of 10 radii, and the tube one of 9;",
        ),
        (
            lambda: pb.flow_shape(mesh, TUBE, points=64),
            "^points: it says nothing of a triangulated tube; leave it out$",
        ),
        (lambda: pb.flow_shape(mesh, TUBE, law="drag"), "^law: 'drag' is unknown"),
        (
            lambda: pb.flow_shape(mesh, TUBE, discretization="squares"),
            "^discretization: 'squares' is unknown; choose one",
        ),
    ):
        with pytest.raises(pb.InputError, match=said):
            call()
