"""The straight tube in an osmotic bath: its radius and its waves, by the equation itself and by the dispersion relation."""

import numpy as np
import pytest

from pearlbvp.theory.dispersion import growth_rate
from pearlbvp.theory.osmotic import onset_sizes, osmotic_work, straight_potential, straight_size, straight_unstable


@pytest.mark.parametrize(("solute", "osmolarity"), [(4.8, 0.54), (1.0, 0.7), (0.01, 3.0)])
def test_the_straight_tube_s_pressure_is_that_of_the_law(solute, osmolarity):
    size = straight_size(solute, osmolarity)
    # G = 0 with H = 1/(2s), K = 0 and lambda1 = 1/4 - c0^2, whatever c0 (docs/theory/model.md)
    h, lambda2 = 1 / (2 * size), osmolarity - solute / size**2
    assert 2 * h**3 - 2 * 0.25 * h - lambda2 == pytest.approx(0, abs=1e-12)


def test_the_straight_tube_is_where_its_potential_is_least():
    c0, solute, osmolarity = 0.4, 2.0, 0.8

    def potential(size):
        return 2 * np.pi * size * ((1 / (2 * size) - c0) ** 2 + 0.25 - c0**2) + osmotic_work(
            size**2, solute, osmolarity
        )

    found = straight_size(solute, osmolarity)
    sizes = np.linspace(0.5, 3, 20001)
    assert sizes[np.argmin([potential(size) for size in sizes])] == pytest.approx(found, abs=2e-4)
    assert straight_potential(c0, solute, osmolarity) == pytest.approx(potential(found), rel=1e-14)


@pytest.mark.parametrize(("c0", "period"), [(0.47, 11.6), (0.235, 20.0), (-0.3, 40.0)])
def test_pearls_grow_between_the_onsets(c0, period):
    first, last = onset_sizes(c0, period)
    for size, sign in ((first, 0), (last, 0), ((first + last) / 2, 1), (0.9 * first, -1), (1.1 * last, -1)):
        rate = float(growth_rate(2 * np.pi / period * size, 0, (1 - size**2) / 4, c0 * size))
        assert (np.sign(rate) if sign else rate) == pytest.approx(sign, abs=1e-12)


def test_short_pearls_never_grow():
    assert len(onset_sizes(0.47, 5.0)) == 0


def test_growing_waves_are_counted_with_both_phases():
    c0, size, length = 0.4, 1.5, 40.0
    growing = [
        m for m in range(1, 40) if growth_rate(2 * np.pi * m / length * size, 0, (1 - size**2) / 4, c0 * size) > 0
    ]
    assert straight_unstable(c0, size, length) == 2 * len(growing) > 2
    assert straight_unstable(c0, 1.0, length) == 0
