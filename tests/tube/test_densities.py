"""Densities of energy, area and volume, and the forms of modes, against sums over points."""

import math

import numpy as np
import pytest
from support.sums import Basis, grid

from pearlbvp.tube.density import areas, gradients, hessians
from pearlbvp.tube.symmetry import product_modes
from pearlbvp.tube.waves import (
    IMAGINARY_DRAGS,
    IMAGINARY_JETS,
    Cell,
    Families,
    ModeWaves,
    fields_of_jets,
    matrix_transform,
)


def test_the_densities_derivatives():
    """Central differences of the densities, and of their gradients."""
    rng = np.random.default_rng(0)
    z = rng.standard_normal((10, 4)) + np.array([0, 0, 0, 2, 0, 0, 0, 0, -2, 0])[:, None]
    (_, slopes), (_, area_slopes) = gradients(z, 0.3), areas(z)
    second = hessians(z, 0.3, 0.7)
    h = 1e-6
    for j in range(10):
        ahead, behind = z.copy(), z.copy()
        ahead[j] += h
        behind[j] -= h
        change, by_area = (
            [(after - before) / (2 * h) for after, before in zip(there, here, strict=True)]
            for there, here in ((gradients(ahead, 0.3), gradients(behind, 0.3)), (areas(ahead), areas(behind)))
        )
        np.testing.assert_allclose(change[0], slopes[j], atol=1e-8)
        np.testing.assert_allclose(by_area[0], area_slopes[j] if j < 4 else 0.0, atol=1e-8)
        change[1][:4] += 0.7 * by_area[1]
        np.testing.assert_allclose(change[1].T, second[:, j], atol=1e-7)


@pytest.mark.parametrize("turns", [0, 2])
def test_sums_and_means_of_waves_are_those_over_points(turns):
    """Fields of modes, and means of weights times them, summed point by point."""
    length, cell = 7.0, Cell(1, 1, (22, 20))
    modes = tuple(product_modes([(p, b) for p in range(4) for b in range(4)], turns))
    (waves,) = ModeWaves.of(2 * math.pi / length, 2 * math.pi * turns / length, modes)
    x, phi = grid(cell.points, length)
    basis = Basis.of(modes, waves.waves.k, waves.waves.kappa, x, phi)
    rng = np.random.default_rng(3)
    coefficients, linear = rng.standard_normal(len(modes)), rng.standard_normal((10, len(x)))
    np.testing.assert_allclose(waves.state(cell, coefficients), basis.state(coefficients), atol=1e-11)
    found = waves.linear(cell, cell.transform(linear))
    np.testing.assert_allclose(found, np.einsum("jk,kjn->n", linear, basis.fields) / len(x), atol=1e-12)
    displaced = basis.displacement()
    np.testing.assert_allclose(waves.displacement(cell, coefficients), (displaced @ coefficients).T, atol=1e-12)
    found = waves.pushed(cell, cell.transform(linear[:2]))
    np.testing.assert_allclose(found, np.einsum("jk,kjn->n", linear[:2], displaced) / len(x), atol=1e-12)


@pytest.mark.parametrize("even", [False, True])
@pytest.mark.parametrize(
    ("turns", "cell"), [(0, Cell(1, 1, (22, 21))), (2, Cell(1, 1, (21, 22))), (0, Cell(2, 3, (10, 6))), (1, Cell(0, 1, (1, 20)))]
)  # fmt: skip
def test_forms_of_modes_are_sums_over_points(turns, cell, even):
    """Second variations of families that share their waves, with weights on a cell of the tube, summed on all of it."""
    rng = np.random.default_rng(3)
    repeats = max(cell.period, 1), max(cell.fold, 1)
    along = cell.points[0] * repeats[0] if cell.period else 22
    x, phi = grid((along, cell.points[1] * repeats[1]), 7.0)

    def weights(signs):
        """Any on the cell, or those of a surface that is even along and around; and on all points."""
        found = rng.standard_normal((*cell.points, len(signs), len(signs)))
        found += found.transpose(0, 1, 3, 2)
        if even:
            found += np.roll(found[::-1, ::-1], (1, 1), (0, 1)) * np.multiply.outer(signs, signs)
        everywhere = np.tile(found, (along // cell.points[0], repeats[1], 1, 1))
        return found.reshape(-1, len(signs), len(signs)), everywhere.reshape(-1, len(signs), len(signs))

    def compare(form, left, matrices, right, parts):
        assert parts == (1 if even else 2)
        for modes, found in zip(families, form, strict=True):
            columns = [all_modes.index(mode) for mode in modes.modes]
            expected = np.einsum("kin,kij,kjm->nm", left[..., columns], matrices, right[..., columns], optimize=True)
            np.testing.assert_allclose(found, expected / len(x), atol=1e-12 * np.abs(expected / len(x)).max())

    all_modes = tuple(product_modes([(p, b) for p in range(4) for b in range(4)], turns))
    families = ModeWaves.of(2 * math.pi / 7, 2 * math.pi * turns / 7, all_modes[::2], all_modes[1::3], all_modes)
    waves = families[0].waves
    basis = Basis.of(all_modes, waves.k, waves.kappa, x, phi)
    fields, displaced = basis.fields, basis.displacement()
    on_cell, everywhere = weights([-1, 1, -1, 1, 1, -1, 1, -1, 1, -1])
    bent = matrix_transform(cell, on_cell, IMAGINARY_JETS, fields_of_jets(waves.kappa))
    compare(waves.bending(cell, bent, Families.of(*families)), fields, everywhere, fields, len(bent.coefficients))
    on_cell, everywhere = weights([1, -1])
    moved = matrix_transform(cell, on_cell, (1,))
    compare(
        waves.moving(cell, moved, Families.of(*families)), displaced, everywhere, displaced, len(moved.coefficients)
    )
    on_cell, everywhere = weights([1, -1, -1, 1, -1, 1])
    drag = matrix_transform(cell, on_cell, IMAGINARY_DRAGS)
    changed = np.concatenate((displaced, fields[:, :4]), axis=1)
    compare(
        waves.dragging(cell, drag, Families.of(*families)),
        displaced,
        everywhere[:, :2],
        changed,
        len(drag.coefficients),
    )


@pytest.mark.parametrize("points", [(6, 6), (5, 4), (4, 3), (1, 1)])
def test_waves_too_short_for_a_grid_have_their_values_there(points):
    """Sums and means are of the grid's points, whatever its transform takes the waves for."""
    modes = tuple(product_modes([(p, b) for p in range(4) for b in range(4)], 0))
    (waves,) = ModeWaves.of(1.0, 0.0, modes)
    basis = Basis.of(modes, 1.0, 0.0, *grid(points, 2 * math.pi))
    rng = np.random.default_rng(4)
    coefficients, linear = rng.standard_normal(len(modes)), rng.standard_normal((10, points[0] * points[1]))
    cell = Cell(1, 1, points)
    np.testing.assert_allclose(waves.state(cell, coefficients), basis.state(coefficients), atol=1e-11)
    found = waves.linear(cell, cell.transform(linear))
    np.testing.assert_allclose(found, np.einsum("jk,kjn->n", linear, basis.fields) / linear.shape[1], atol=1e-12)
