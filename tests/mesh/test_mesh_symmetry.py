"""Meshes that keep the screws of coils, and spectra where modes are neutral: against theory and reduced modes."""

import numpy as np
import pytest

from pearlbvp.helfrich import Tube
from pearlbvp.mesh.families import ENOUGH_SCREWS, divisions, screws, tube_mesh
from pearlbvp.mesh.start import onset
from pearlbvp.mesh.symmetry import orbits
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.mesh import meshed
from pearlbvp.theory.dispersion import growth_rate


@pytest.mark.parametrize(("length", "mode"), [(10.0, (1, 1)), (15.0, (1, 1)), (23.7, (2, 1)), (12.0, (1, 2))])
def test_meshes_of_coils_keep_screws(length, mode):
    """Counted by arithmetic, and found as isometries of mesh and wave."""
    mesh = tube_mesh(length, 500, coil=mode)
    rows, around = divisions(length, 500, mode)
    assert mesh.count == rows * around
    assert abs(mesh.count / 500 - 1) < 0.1
    assert mesh.quality.max() < 4.5
    number = screws(rows, around, *mode)
    assert number >= ENOUGH_SCREWS
    phi = np.arctan2(mesh.vertices[:, 2], mesh.vertices[:, 1])
    wave = np.cos(2 * np.pi * mode[0] * mesh.vertices[:, 0] / length - mode[1] * phi)
    found = orbits(mesh, wave[None])
    sizes = np.bincount(found)
    assert sizes.max() % number == 0  # turns by the wave's own fold and half turns of the axis may add to the screws
    for orbit in (0, len(sizes) // 2):
        np.testing.assert_allclose(wave[found == orbit], wave[found == orbit][0], atol=1e-9)


def test_a_coil_s_branch_on_few_nodes_passes_the_one_that_crosses_it():
    """The neutral modes break its screws, so the coil stays one: the branch point and stability of reduced modes."""
    options = branch_options({"v": 0.88})
    branch = family_branch(Tube(0.48, 10.0), "coil", (1, 1), options, nodes=500)
    exact = family_branch(Tube(0.48, 10.0), "coil", (1, 1), options)
    assert branch.complete, branch.reason
    crossings = [b.find("bp") for b in (branch, exact)]
    places = [b.points[found[0].index].observables for b, found in zip((branch, exact), crossings, strict=True)]
    assert places[0]["v"] == pytest.approx(places[1]["v"], abs=2e-3)
    assert branch.points[-1].spectrum.n_unstable == exact.points[-1].spectrum.n_unstable == 0
    assert branch.points[-1].observables["lambda2"] == pytest.approx(exact.points[-1].observables["lambda2"], rel=2e-2)


def test_meshed_coils_keep_their_screws():
    coil = family_branch(Tube(0.0, 10.0), "coil", (1, 1), branch_options({"v": 0.95})).points[-1]
    problem, u = meshed(coil, 500)
    assert problem.symmetric(u).orbits.max() + 1 < problem.mesh.count / ENOUGH_SCREWS


@pytest.mark.parametrize("nodes", [800, 2000])
def test_a_neutral_mode_drowns_no_other(nodes):
    """Rates of the straight tube where the ring branches off: two modes are neutral, the next is the dispersion relation's."""
    problem, u, direction = onset(Tube(-1.0, 10.0), "ring", 0, 2, tube_mesh(10.0, nodes))
    problem = problem.symmetric(u, direction)
    spectrum = problem.spectrum(u)
    assert spectrum.n_unstable == 0
    rates = np.sort(np.concatenate(list(spectrum.rates.values())))[::-1]
    assert np.abs(rates[:2]).max() < 1e-9
    exact = [growth_rate(2 * np.pi * m / 10, n, float(u[-2]), -1.0) for m, n in ((1, 1), (1, 2))]
    np.testing.assert_allclose(rates[2:6], exact[0], rtol=1e-3)  # sines and cosines both ways
    assert max(exact[1], rates[6]) < rates[5]


@pytest.mark.parametrize("family", ["coil", "buckle"])
def test_branches_from_the_straight_tube_are_of_fourth_order(family):
    """Vertices that moved along normals lie less well than those of a mesh made for the shape; the order is the same."""
    options = branch_options({"v": 0.95})
    exact = family_branch(Tube(0.0, 10.0), family, (1, 1), options, discretization="modes").points[-1].observables
    errors, counts = [], []
    for nodes in (500, 1000):
        point = family_branch(Tube(0.0, 10.0), family, (1, 1), options, nodes=nodes).points[-1]
        errors.append([abs(point.observables[name] / exact[name] - 1) for name in ("lambda1", "lambda2", "E")])
        counts.append(point.problem.mesh.count)
    orders = 2 * np.log(np.divide(*errors)) / np.log(counts[1] / counts[0])
    assert (orders > 3.3).all(), orders
    assert np.max(errors[1]) < 6e-4
