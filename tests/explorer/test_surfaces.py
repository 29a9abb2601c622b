"""Surfaces that the page makes have the area, the volume and the curvatures of the solutions that they show."""

import json
import math
from importlib.resources import files

import numpy as np
import pytest
from scipy.spatial import cKDTree
from support.browser import browser_page

import pearlbvp as pb
from pearlbvp.explorer.perturbations import critical
from pearlbvp.explorer.series import branch_series
from pearlbvp.explorer.shapes import Shared
from pearlbvp.studies.flow_start import solution_start
from pearlbvp.units import RADII

CASES = {
    "pearl": ((2, 0), {"v": 1.03}, {"length": 16.0}),
    "coil": ((1, 1), {"v": 0.93}, {}),
    "buckle": ((1, 1), {"v": 0.96}, {}),
    "ring": ((0, 2), {"v": 0.9}, {}),
    "mesh": ((1, 0), {"v": 1.01}, {"nodes": 400}),
}


@pytest.fixture(scope="module")
def shown():
    """Of each family the branch, and its last point as the page has it: places, normals, curvatures, perturbation."""
    shared, found = Shared(), {}
    for name, (mode, until, options) in CASES.items():
        how = dict(options)
        family = "pearl" if name == "mesh" else name
        found[name] = pb.branch(pb.Tube(0.0, how.pop("length", 10.0)), family, mode, until=until, **how)
    series = [branch_series(name, branch, shared, RADII) for name, branch in found.items()]
    scripts = [(files("pearlbvp.explorer") / name).read_text() for name in ("numbers.js", "surfaces.js")]
    data = json.dumps({"series": series, "shared": shared.lists})
    with browser_page() as page:
        page.set_content(f'<script type="application/json" id="data">{data}</script>')
        text = page.evaluate(
            f"(() => {{{''.join(scripts)} return JSON.stringify(series.map((s) => surface(s.points.at(-1))),"
            " (_, value) => ArrayBuffer.isView(value) ? [...value] : value); })()"
        )  # as one text, which is passed on at once
        assert page.wrong == []
    return {
        name: (branch, {key: np.array(value) for key, value in each.items()})
        for (name, branch), each in zip(found.items(), json.loads(text), strict=True)
    }


def integrals(drawn):
    """Area and volume of the triangles, and integrals over them: of H, of K, and of u, H u, |u|."""
    at, corners = drawn["at"].reshape(-1, 3), drawn["index"].reshape(-1, 3)
    p, q, r = (at[corners[:, i]] for i in range(3))
    vectors = np.cross(q - p, r - p) / 2
    areas = np.linalg.norm(vectors, axis=1)
    volume = (vectors[:, 1:] * (p + q + r)[:, 1:]).sum() / 6  # by the part across the axis: half of its flux
    u = drawn["u"]
    means = [areas @ values[corners].mean(axis=1) for values in (drawn["H"], drawn["K"], u, drawn["H"] * u, np.abs(u))]
    return areas.sum(), volume, *means


@pytest.mark.parametrize("name", CASES)
def test_surfaces_are_the_solutions(shown, name):
    branch, drawn = shown[name]
    area, volume, h, k, *_ = integrals(drawn)
    observed = branch[-1].observables
    inscribed = (
        2e-2 if name == "mesh" else 4e-3
    )  # the square of the triangles' angle, 2 pi/64 on others than meshes, a sixth of it
    assert area == pytest.approx(2 * math.pi * observed["L"], rel=inscribed)
    assert volume == pytest.approx(math.pi * observed["L"] * observed["v"], rel=2 * inscribed)
    assert h == pytest.approx(branch.table()["M"].iloc[-1], rel=inscribed)
    assert k == pytest.approx(0, abs=20 * inscribed)
    outwards = np.einsum("ij,ij->i", drawn["normal"].reshape(-1, 3)[:, 1:], drawn["at"].reshape(-1, 3)[:, 1:])
    assert outwards.mean() > 0.5


@pytest.mark.parametrize("name", CASES)
def test_critical_perturbations_grow_as_the_spectrum_says_and_keep_area_and_volume(shown, name):
    branch, drawn = shown[name]
    point = branch[-1]
    wave = critical(point.problem.shapes, point.u, point.spectrum, Shared())
    assert wave.rate == pytest.approx(point.spectrum.mu_crit, rel=1e-6, abs=1e-9)
    *_, volume, area, size = integrals(drawn)
    assert np.abs(drawn["u"]).max() == pytest.approx(1, abs=1e-6)
    assert abs(volume) < 1e-2 * size
    assert abs(area) < 1e-2 * size


def test_a_wave_along_two_pearls_is_that_of_the_symmetry_that_is_broken(shown):
    """The most unstable perturbation of two pearls makes one grow while the other shrinks: it changes sign after one."""
    branch, drawn = shown["pearl"]
    assert branch[-1].spectrum.critical[:3] == (0, 1, 2)
    u = drawn["u"].reshape(-1, 65)
    half = (len(u) - 1) // 2
    np.testing.assert_allclose(u[half:], -u[: half + 1], atol=1e-5)
    np.testing.assert_allclose(u, np.broadcast_to(u[:, :1], u.shape), atol=1e-6)


def test_the_critical_perturbation_is_that_of_a_flow_s_discretization(shown):
    """The same normal displacement from all modes without symmetry: at the points next to each of the page's rows."""
    branch, drawn = shown["buckle"]
    start = solution_start(branch[-1])
    rates, vectors = start.problem.growth_rates(start.q, start.multipliers, 2)
    assert rates[0] == pytest.approx(branch[-1].spectrum.mu_crit, abs=1e-6)
    assert rates[1] < rates[0] - 1e-3  # one alone
    u = start.problem.velocity(start.q, vectors[:, 0])
    x, y, z = (part[:-1, :-1].ravel() for part in start.problem.surface(start.q, 57, 57))
    along, around = start.problem.cell.points
    assert (along, around) == (56, 56)
    u = np.roll(u.reshape(56, 56), 28, axis=0).ravel()  # a cell begins at x = 0, the surface at -L/2
    at = drawn["at"].reshape(-1, 3)
    tree = cKDTree(at - [10.0, 0, 0] * (at[:, :1] > 5))
    found = drawn["u"][tree.query(np.column_stack((x, y, z)))[1]]
    assert abs(np.corrcoef(u, found)[0, 1]) > 0.999
