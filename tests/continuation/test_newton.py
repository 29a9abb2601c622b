"""Newton's method: quadratic convergence, damping, and failures with a reason."""

import numpy as np
import pytest

from pearlbvp.newton import NewtonOptions, newton


def solve(f, df, x, **options):
    return newton(lambda u: f(u), lambda u, r: r / df(u), np.array([float(x)]), NewtonOptions(**options))


def test_square_root():
    result = solve(lambda u: u**2 - 2, lambda u: 2 * u, 1.0)
    assert result.converged
    assert result.u[0] == pytest.approx(np.sqrt(2), abs=1e-15)
    assert result.iterations <= 6


def test_damping_saves_the_arctangent():
    f, df = np.arctan, lambda u: 1 / (1 + u**2)
    assert not solve(f, df, 3.0).converged
    assert solve(f, df, 3.0, damping=10).converged


@pytest.mark.parametrize(
    ("f", "df", "message"),
    [
        (lambda u: u**2 + 1, lambda u: 2 * u, "diverge|no convergence"),
        (np.log, lambda u: 1 / u, "not finite"),
    ],
)
def test_failures_have_a_reason(f, df, message):
    import re

    result = solve(f, df, 5.0 if f is np.log else 0.3)
    assert not result.converged
    assert re.search(message, result.message)


def test_a_singular_jacobian_is_a_result():
    def correct(u, f):
        raise np.linalg.LinAlgError("singular")

    result = newton(lambda u: u, correct, np.ones(1))
    assert not result.converged
    assert "singular" in result.message
