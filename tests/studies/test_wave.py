"""The column ``wave``: 2A of a surface over the straight tube, in every family."""

import math

import numpy as np
import pandas as pd
import pytest

from pearlbvp.figures.surface import shown
from pearlbvp.helfrich import Tube
from pearlbvp.mesh.amplitudes import amplitudes, amplitudes_at, largest_wave
from pearlbvp.mesh.functional import Functional
from pearlbvp.projection import Projection
from pearlbvp.studies.amplitude import compared, predicted_branch
from pearlbvp.studies.branch import COLUMNS, branch_options, family_branch
from pearlbvp.studies.mesh import meshed, shape_mesh
from pearlbvp.studies.onward import switched
from pearlbvp.theory.amplitude import amplitude_equation
from pearlbvp.units import Units

CASES = {
    "pearl": (0.0, 10.0, (1, 0), 1.05),
    "ring": (-1.0, 10.0, (0, 3), 0.95),
    "coil": (0.0, 10.0, (1, 1), 0.96),
    "buckle": (0.0, 10.0, (1, 1), 0.96),
    "buckle 2:3": (0.0, 10.0, (2, 3), 0.99),
}


def followed(name):
    c0, length, mode, v = CASES[name]
    options = branch_options({"v": v}, step=0.02, max_step=0.1)
    if name == "pearl":
        return family_branch(Tube(c0, length), "pearl", (mode[0], 0), options)
    if name == "ring":
        return family_branch(Tube(c0, length), "ring", (0, mode[1]), options)
    return family_branch(Tube(c0, length), name.split()[0], mode, options, discretization="modes")


@pytest.mark.parametrize("name", CASES)
def test_the_wave_is_that_of_the_amplitude_equation_to_second_order(name):
    """At the same volume, 2A/wave - 1 falls as A^2: its ratio to A^2 settles."""
    c0, length, mode, _ = CASES[name]
    table = followed(name).table()
    result = compared(table, amplitude_equation(Tube(c0, length), mode), name.split()[0])
    assert result["wave_order"].iloc[1:3].to_numpy() == pytest.approx(2, abs=0.07)
    ratio = (result["wave_error"] / result["A"] ** 2).to_numpy()
    assert ratio[1] == pytest.approx(ratio[2], rel=0.1)
    assert (result["wave"].to_numpy() > 0).all()


@pytest.mark.parametrize("name", CASES)
def test_the_wave_is_that_of_the_surface_s_triangles(name):
    """Raw vertices on the surface, linear between them: errors of second order in their distance, by Richardson."""
    length, (m, n) = CASES[name][1], CASES[name][2]
    point = followed(name).points[-1]
    found = []
    for nodes in (1500, 6000):
        mesh = shape_mesh(point, nodes)
        found.append(2 * max(abs(amplitude) for amplitude in amplitudes(mesh, m, n)))
        assert largest_wave(Functional(mesh, "cotangent"), mesh.vertices) == pytest.approx(found[-1], rel=1e-12)
    wave = point.problem.largest_wave(point.u)
    assert found[1] == pytest.approx(wave, rel=3e-3)
    assert (4 * found[1] - found[0]) / 3 == pytest.approx(wave, rel=4e-4)
    assert length == point.observables["L"]


@pytest.mark.parametrize(("kind", "error"), [("subdivision", 3e-4), ("cotangent", 0.25)])
def test_equilibria_on_meshes_have_the_wave_of_those_in_reduced_modes(kind, error):
    """At the same volume; docs/meshes.md has the errors of amplitudes on such meshes."""
    point = followed("coil").points[-1]
    problem, u = meshed(point, 500, kind=kind)
    assert problem.largest_wave(u) == pytest.approx(point.problem.largest_wave(point.u), rel=error)
    assert problem.largest_wave(u) == pytest.approx(
        2 * max(map(abs, amplitudes_at(problem.functional, problem.vertices(u), 1, 1))), rel=1e-12
    )


def test_the_wave_of_a_graph_is_a_fourier_coefficient():
    branch = followed("buckle 2:3")
    point = branch.points[2]
    x, y, z = shown(point)
    # Points of a section lie at equal angles about a centre on the axis: n = 3 moves none.
    r = np.hypot(y, z)[:-1, :-1] - 1
    along, around = np.meshgrid(x[:-1, 0], 2 * np.pi * np.arange(r.shape[1]) / r.shape[1], indexing="ij")
    plus = (r * np.exp(-1j * (2 * math.pi * 2 / 10 * along + 3 * around))).mean()
    assert point.problem.largest_wave(point.u) == pytest.approx(2 * abs(plus), rel=1e-9)


def test_a_shifted_circle_has_the_wave_of_its_shift():
    """For a circle shifted by d, r = d cos(phi) + sqrt(1 - d^2 sin^2 phi): its first harmonic is d, whatever d < 1."""
    d, kappa = 0.7, 2 * math.pi / 10
    x, phi = np.meshgrid(10 * np.arange(48) / 48, 2 * np.pi * np.arange(96) / 96, indexing="ij")
    about = phi - kappa * x
    r = d * np.cos(about) + np.sqrt(1 - (d * np.sin(about)) ** 2)
    share = np.full(r.size, 1 / r.size)
    coil = Projection(x.ravel(), phi.ravel(), r.ravel(), share)
    assert coil.wave(kappa, (8, 8)) == pytest.approx(d, abs=1e-12)
    assert np.abs(coil.amplitudes(kappa, np.array([1]), np.array([1])))[:, 0, 0] == pytest.approx([0, d / 2], abs=1e-12)
    shifted = Projection(x.ravel(), phi.ravel(), (r[0] + 0 * r).ravel(), share)  # a shift of the tube is no wave
    assert shifted.wave(kappa, (8, 8)) < 0.6 * d


def test_the_wave_is_empty_where_the_axis_leaves_the_tube():
    table = family_branch(Tube(0.48, 10), "coil", (1, 1), branch_options({"v": 0.8})).table()
    assert math.isnan(table["wave"].iloc[-1])
    assert table["wave"].iloc[1] > 0


def test_a_localized_pearl_begins_with_the_wave_of_the_pearls_that_it_leaves():
    pearls = family_branch(Tube(0.48, 30), "pearl", (4, 0), branch_options({"bp": 1}))
    localized = switched(pearls, 1, branch_options({"v": 1.012}))
    waves = pearls.table()["wave"].iloc[-1], localized.table()["wave"].iloc[0]
    assert waves[1] == pytest.approx(waves[0], rel=1e-9)


def test_branches_stop_at_a_wave_and_predictions_have_it():
    branch = family_branch(Tube(0.0, 10), "coil", (1, 1), branch_options({"wave": 0.5}))
    table = branch.table()
    assert branch.complete
    assert table["wave"].iloc[-1] == pytest.approx(0.5, abs=1e-10)
    assert list(table[COLUMNS]) == COLUMNS
    predicted = predicted_branch(0.0, 10, (1, 1), "coil", 0.25).table()
    assert predicted["wave"].iloc[-1] == 0.5
    scaled = Units(0.05).columns(table)
    pd.testing.assert_series_equal(scaled["wave"], 0.05 * table["wave"])
