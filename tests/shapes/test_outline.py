"""Outlines of least energy: against AUTO-07p, spheres and catenoids in closed form, and differences."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pearlbvp.minimum import least, step_within
from pearlbvp.shapes.outline import Outline, pearl_of_outline

AUTO = pd.read_csv(Path(__file__).parents[1] / "data" / "auto07p_pearl_c0_0_L10_m1.csv")


def test_the_least_energy_is_that_of_auto():
    row = AUTO[AUTO["v"] == 1.005].iloc[0]
    outline = Outline(0.0, 5.0, 1.005, 24)
    found = least(outline, outline.random(np.random.default_rng(0)))
    assert not found.reason
    assert found.energy == pytest.approx(row["E"], abs=1e-9)
    assert found.multipliers[1:] == pytest.approx([row["lambda1"], row["lambda2"] / 2], abs=1e-7)
    problem, u, why = pearl_of_outline(outline, found.q, found.multipliers)
    assert not why
    assert problem.observables(u)["E"] == pytest.approx(found.energy, abs=1e-9)


def test_a_sphere_has_its_energy_area_and_volume():
    """``psi = pi/2 - s/R`` from pole to pole is no sum of sines from 0, but its belly is: a zone of a sphere by its mirrors."""
    outline, zone = Outline(0.3, 1.0, 1.0, 64), 1.1
    sigma = (np.arange(256) + 0.5) / 256
    k = np.pi * np.arange(1, 65)
    b = 2 * np.sin(np.outer(k, sigma)) @ (-zone * np.minimum(sigma, 1 - sigma)) / 256
    q = np.append(b, [1.0, zone])
    r = outline.states(q, np.array([0.25]))[0, 0]
    assert r == pytest.approx(np.cos(zone / 4), abs=1e-4)  # R = 1: r = cos(s)
    assert outline.states(q, np.array([0.25]))[0, 2] == pytest.approx(
        1.0, abs=2e-2
    )  # its mean curvature, but for the kinks


def test_derivatives_are_those_of_differences():
    outline, random = Outline(0.3, 5.0, 1.05, 6), np.random.default_rng(1)
    q = np.concatenate((0.2 * random.standard_normal(6), [1.1, 5.2]))
    multipliers = np.array([0.3, 0.2, 0.5])

    def slope(function):
        return np.array([(function(q + 1e-6 * e) - function(q - 1e-6 * e)) / 2e-6 for e in np.eye(8)])

    def lagrangian(at):
        return outline.gradient(at) + multipliers @ outline.constraint_rows(at)

    np.testing.assert_allclose(outline.gradient(q), slope(outline.energy), atol=1e-9)
    np.testing.assert_allclose(outline.constraint_rows(q), slope(outline.constraints).T, atol=1e-8)
    np.testing.assert_allclose(outline.hessian(q, multipliers), slope(lagrangian), atol=1e-8)


def test_states_obey_the_equations_of_the_arclength():
    """``r' = sin psi``, ``psi' = cos psi/r - 2h`` and ``h' = w`` along ``s = S sigma``, by differences."""
    outline, random, h = Outline(0.3, 5.0, 1.05, 6), np.random.default_rng(2), 1e-5
    smooth = 0.3 * random.standard_normal(6) / np.arange(1, 7) ** 3
    q, sigma = np.concatenate((smooth, [1.1, 5.2])), np.linspace(0.1, 0.9, 9)
    r, psi, bend, w = outline.states(q, sigma).T
    slopes = (outline.states(q, sigma + h) - outline.states(q, sigma - h)).T / (2 * h * 5.2)
    np.testing.assert_allclose(slopes[:3], [np.sin(psi), np.cos(psi) / r - 2 * bend, w], atol=1e-7)


def test_steps_leave_a_saddle_and_end_at_a_minimum():
    assert np.linalg.norm(step_within(np.array([-1.0, 2.0]), np.zeros(2), 0.5)) == pytest.approx(0.5)
    np.testing.assert_allclose(step_within(np.array([1.0, 4.0]), np.array([-1.0, 2.0]), 9.0), [1.0, -0.5])
    bends, slopes = np.array([-1.0, 3.0]), np.array([0.2, -0.3])
    found = step_within(bends, slopes, 1.0)
    angles = np.linspace(0, 2 * np.pi, 20001)
    circle = np.array([np.cos(angles), np.sin(angles)])
    energies = slopes @ circle + bends @ circle**2 / 2
    assert slopes @ found + bends @ found**2 / 2 == pytest.approx(energies.min(), abs=1e-7)


@pytest.mark.parametrize(("half", "v"), [(5.0, 1.3), (7.5, 1.2), (1.6, 0.92)])
def test_a_sphere_on_a_tether_has_its_area_and_volume(half, v):
    """Length and area exactly, the volume as the smoothed neck allows: better on more waves. Its belly is the sphere's."""
    errors = []
    for waves in (64, 512):
        outline = Outline(0.0, half, v, waves)
        q = outline.sphere_on_tether()
        length, area, volume = outline.constraints(q)
        assert max(abs(length), abs(area)) < 1e-12
        errors.append(abs(volume))
    assert errors[1] < errors[0] / 3 < 0.01
    r = outline.states(q, np.array([0.0, 1.0]))[:, 0]
    neck = r[1]
    rise = np.sqrt(r[0] ** 2 - neck**2)
    assert r[0] * rise + neck * (half - rise) == pytest.approx(half, rel=2e-2)  # by the formulas of a sphere's cap
    assert np.pi * r[0] ** 2 * rise - np.pi * rise**3 / 3 + np.pi * neck**2 * (half - rise) == pytest.approx(
        np.pi * half * v, rel=2e-2
    )
    with pytest.raises(ValueError, match="no sphere"):
        Outline(0.0, half, 2 / 3 * np.sqrt(half) * (1.01 if v > 1 else 0.99)).sphere_on_tether()


def test_a_graph_becomes_an_outline_with_its_length_area_volume_and_energy():
    half, c0, cosines = 4.0, 0.3, np.array([0.9, 0.3, -0.05, 0.02])
    x = (np.arange(400) + 0.5) * half / 400
    k = np.pi * np.arange(4) / half
    r, r1, r2 = (np.cos(np.outer(x, k) + d * np.pi / 2) @ (cosines * k**d) for d in range(3))
    stretch = np.sqrt(1 + r1**2)
    bend = (1 / (r * stretch) - r2 / stretch**3) / 2 - c0
    outline = Outline(c0, half, (r**2).mean(), 48)
    q = outline.of_radius(cosines[1:])
    assert outline.constraints(q) == pytest.approx([0.0, (r * stretch).mean() - 1, 0.0], abs=1e-7)
    assert outline.energy(q) == pytest.approx((r * stretch * bend**2).mean(), abs=1e-6)
    assert outline.radii(q)[0] == pytest.approx(cosines.sum(), abs=1e-2)
