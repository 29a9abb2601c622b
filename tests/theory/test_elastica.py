"""Rings in closed form against their differential equation, quadrature of the curve, and known pressures."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pearlbvp.errors import InputError
from pearlbvp.theory.elastica import ElasticRing, ring_at, ring_at_angle, touching_ring


@pytest.fixture(params=[(2, "v", 0.85), (2, "lambda2", 2.6), (3, "v", 0.5), (4, "v", 0.2), (7, "v", 0.9)], ids=str)
def ring(request):
    return ring_at(*request.param)


def by_arclength(values, period):
    """Spectral derivative of a periodic function on equidistant points."""
    numbers = np.fft.fftfreq(len(values), 1 / len(values)) * 2 * np.pi / period
    return np.fft.ifft(1j * numbers * np.fft.fft(values)).real


@pytest.mark.parametrize("n", [2, 3, 5])
def test_rings_begin_at_the_circle_s_buckling_pressure(n):
    circle = ring_at_angle(n, math.asin(1 / n))
    assert (circle.k, circle.v) == (0.0, pytest.approx(1, abs=1e-14))
    assert circle.lambda2 == pytest.approx((n**2 - 1) / 2, rel=1e-14)
    assert circle.lambda1(0.3) == pytest.approx(1 / 4 - circle.lambda2 - 0.3**2, rel=1e-13)
    assert circle.energy(0.3) == pytest.approx((1 / 2 - 0.3) ** 2, rel=1e-13)


def test_the_curvature_solves_the_equation_and_has_its_roots(ring):
    period = 2 * math.pi / ring.n
    s = period * np.arange(128) / 128
    kappa, slope = ring.curvature(s), ring.slope(s)
    np.testing.assert_allclose(by_arclength(kappa, period), slope, atol=1e-10 * ring.n**2)
    second = by_arclength(slope, period)
    np.testing.assert_allclose(second + kappa**3 / 2 - ring.a * kappa, ring.p, atol=1e-9 * ring.n**3)
    first = slope**2 + kappa**4 / 4 - ring.a * kappa**2 - 2 * ring.p * kappa
    np.testing.assert_allclose(first, ring.constant, atol=1e-12 * ring.n**4)
    assert (kappa.max(), kappa.min()) == pytest.approx((ring.m + ring.d, ring.m - ring.d), abs=1e-12 * ring.n)
    for root in (ring.m + ring.d, ring.m - ring.d, -ring.m + 1j * ring.eta):
        assert abs(-(root**4) / 4 + ring.a * root**2 + 2 * ring.p * root + ring.constant) < 1e-12 * ring.n**4


def test_the_curve_is_the_quadrature_of_its_curvature(ring):
    """Angle, position and area by integrating ``kappa`` and the tangent, once around."""

    def rates(s, y):
        return np.array([float(ring.curvature(s)), -math.sin(y[0]), math.cos(y[0])])

    s = np.linspace(0, 2 * math.pi, 25)
    start = float(ring.position(0.0).real)
    found = solve_ivp(rates, (0, 2 * math.pi), [0.0, start, 0.0], t_eval=s, method="DOP853", rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(ring.angle(s), found.y[0], atol=1e-10)
    np.testing.assert_allclose(ring.position(s), found.y[1] + 1j * found.y[2], atol=1e-10)
    assert ring.angle(2 * math.pi) == pytest.approx(2 * math.pi, abs=1e-13)
    dense = 2 * math.pi * np.arange(2048) / 2048
    curve, tangent = ring.position(dense), 1j * np.exp(1j * ring.angle(dense))
    area = np.mean((curve.conj() * tangent).imag) * math.pi
    assert area == pytest.approx(math.pi * ring.v, abs=1e-12)
    assert np.mean((ring.curvature(dense) / 2 - 0.3) ** 2) == pytest.approx(ring.energy(0.3), rel=1e-12)
    # The centre is that of the lobes, and the distance from it a function of the curvature.
    assert abs(curve.mean()) < 1e-13
    square = (ring.constant + ring.a**2 + 2 * ring.p * ring.curvature(dense)) / ring.p**2
    np.testing.assert_allclose(np.abs(curve) ** 2, square, atol=1e-12)


@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize("c0", [0.0, -1.0])
def test_minus_twice_the_slope_of_the_energy_is_the_pressure(n, c0):
    touching = touching_ring(n)
    for theta in (0.9 * math.asin(1 / n) + 0.1 * touching.theta, touching.theta):
        ahead, behind = (ring_at_angle(n, theta + h) for h in (1e-4, -1e-4))
        slope = (ahead.energy(c0) - behind.energy(c0)) / (ahead.v - behind.v)
        assert -2 * slope == pytest.approx(ring_at_angle(n, theta).lambda2, rel=1e-6)


@pytest.mark.parametrize(("n", "pressure", "digits"), [(2, 5.247, 3), (3, 21.65, 2), (4, 51.84, 2)])
def test_contact_comes_at_the_known_pressures(n, pressure, digits):
    """Flaherty, Keller, Rubinow (1972), in units of ``E I / R^3`` with ``E I = 1/2``."""
    assert round(touching_ring(n).lambda2 / 0.5, digits) == pressure


def crossings(curve):
    """Number of pairs of sides of a closed polygon that cross."""
    ahead = np.roll(curve, -1)

    def left_of(z, first, second):
        return ((second - first).conj() * (z - first)).imag > 0

    first, second = curve[:, None], ahead[:, None]
    split = left_of(curve[None], first, second) != left_of(ahead[None], first, second)
    both = split & split.T
    index = np.arange(len(curve))
    apart = (index[:, None] - index[None]) % len(curve)
    return int((both & (apart > 1) & (apart < len(curve) - 1)).sum()) // 2


@pytest.mark.parametrize("n", [2, 3, 4, 6])
def test_rings_touch_themselves_first_where_the_gap_closes(n):
    """Just before, no two sides of a fine polygon cross; just beyond, each lobe (for n = 2: the waist) crosses itself twice."""
    touching = touching_ring(n)
    s = 2 * math.pi * (np.arange(1200) + 0.5) / 1200
    assert abs(touching.gap) < 1e-13
    before, beyond = (ring_at_angle(n, touching.theta + step) for step in (-2e-3, 2e-3))
    assert before.gap > 0 > beyond.gap
    assert crossings(before.position(s)) == 0
    assert crossings(beyond.position(s)) == (2 if n == 2 else 2 * n)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_pressure_and_volume_are_monotone_to_contact_and_find_the_ring(n):
    angles = np.linspace(math.asin(1 / n), touching_ring(n).theta, 40)
    rings = [ring_at_angle(n, theta) for theta in angles]
    assert (np.diff([ring.lambda2 for ring in rings]) > 0).all()
    assert (np.diff([ring.v for ring in rings]) < 0).all()
    assert (np.diff([ring.gap for ring in rings]) < 0).all()
    for name in ("v", "lambda2"):
        value = getattr(rings[20], name)
        assert ring_at(n, name, value).theta == pytest.approx(rings[20].theta, abs=1e-12)


def test_the_inflexion_is_where_the_curvature_vanishes():
    ring = ring_at(3, "v", 0.2)
    assert 0 < ring.inflexion < math.pi / 3
    assert float(ring.curvature(ring.inflexion)) == pytest.approx(0, abs=1e-13)
    assert ring_at(3, "v", 0.99).inflexion == math.pi / 3


def test_what_is_no_ring_is_refused():
    for n in (1, 2.5, -3):
        with pytest.raises(InputError, match="^mode: "):
            touching_ring(n)
    with pytest.raises(InputError, match="^theta: "):
        ring_at_angle(2, 0.1)
    with pytest.raises(InputError, match="^v: .*self-contact"):
        ring_at(2, "v", 0.2)
    with pytest.raises(InputError, match="^name: "):
        ring_at(2, "lambda1", 0.2)
    assert ring_at(2, "v", 1.0) == ElasticRing(2, math.asin(1 / 2), 0.0)
