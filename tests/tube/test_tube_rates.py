"""The leading growth rates of a block: Lanczos' method and the reduction of the whole matrix, and that none is left out."""

import numpy as np
import pytest
from scipy.linalg import cholesky, eigh, solve_triangular

from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.tube import spectrum
from pearlbvp.tube.spectrum import KEPT, LARGE, _by_lanczos, _factored, _leading


def pencil(rates, seed=0):
    """Matrices of a block whose growth rates are known."""
    rng = np.random.default_rng(seed)
    basis = np.linalg.qr(rng.normal(size=(len(rates), len(rates))))[0] * rng.uniform(0.2, 1, len(rates))
    return -(basis * rates) @ basis.T, basis @ basis.T


def decaying(size, *first):
    """Rates like those of tubes: some given ones, then fourth powers."""
    return np.sort([*first, *(-0.3 - 1e-6 * np.arange(size - len(first)) ** 4.0)])[::-1]


def test_rates_of_a_large_block_are_the_largest():
    rates = decaying(LARGE + 50, 2.5, 0.1, -0.01, -0.02)
    second, mass = pencil(rates)
    factor, shift = _factored(second, mass)
    few = _by_lanczos(second, mass, factor, shift)
    np.testing.assert_allclose(few, rates[:KEPT], atol=1e-10)
    np.testing.assert_allclose(_leading(second, mass), rates[:KEPT], atol=1e-10)


def test_a_rate_that_lanczos_method_cannot_see_is_found_all_the_same():
    """Of two equal rates a Krylov space knows one."""
    rates = decaying(LARGE + 50, 0.1, 0.1, -0.01)
    second, mass = np.diag(-rates), np.eye(len(rates))
    factor, shift = _factored(second, mass)
    assert _by_lanczos(second, mass, factor, shift) is None
    np.testing.assert_allclose(_leading(second, mass), rates[:KEPT], atol=1e-10)


@pytest.mark.parametrize("size", [60, LARGE + 50])
def test_all_that_grow_are_found(size):
    rates = decaying(size, *np.linspace(0.5, 3, KEPT + 4))
    second, mass = pencil(rates)
    np.testing.assert_allclose(_leading(second, mass), rates[: KEPT + 5], atol=1e-10)


def test_rates_of_a_buckle_are_those_of_the_plain_reduction(monkeypatch):
    """Each block's rates, by Lanczos' method and by two triangular solves and a dense eigenvalue problem."""
    point = family_branch(Tube(0.0, 10), "buckle", (1, 1), branch_options({"v": 0.95})).points[-1]
    by_lanczos, blocks = [], []

    def kept(second, mass):
        blocks.append((second, mass))
        by_lanczos.append(_leading(second, mass))
        return by_lanczos[-1]

    monkeypatch.setattr(spectrum, "LARGE", 40)
    monkeypatch.setattr(spectrum, "_leading", kept)
    point.problem.spectrum(point.u)
    assert min(len(mass) for _, mass in blocks) > 40
    for rates, (second, mass) in zip(by_lanczos, blocks, strict=True):
        factor = cholesky(second + 16 * mass, lower=True)
        inverse = solve_triangular(factor, solve_triangular(factor, mass, lower=True).T, lower=True)
        np.testing.assert_allclose(
            rates, 16 - 1 / eigh(inverse, eigvals_only=True)[: -KEPT - 1 : -1], rtol=1e-12, atol=1e-12
        )
