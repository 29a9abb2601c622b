"""Rings by collocation against the exact ones, their stability against other discretizations, their branches."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from pearlbvp.collocation import Discretization, gauss_scheme
from pearlbvp.continuation.branch import Status
from pearlbvp.continuation.path import correct
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.newton import NewtonOptions, newton
from pearlbvp.shapes.lobe import HALF_LOBE
from pearlbvp.shapes.ring import ring_onset
from pearlbvp.stability.planar import PlanarBlock, PlanarVariation, PlaneProfile, classes_of, planar_spectrum
from pearlbvp.studies.branch import COLUMNS, branch_options, family_branch
from pearlbvp.studies.onward import resumed
from pearlbvp.studies.ring_onsets import exact_profile, neutral_rings, ring_onsets
from pearlbvp.theory.amplitude import amplitude_equation
from pearlbvp.theory.dispersion import growth_rate
from pearlbvp.theory.elastica import ring_at, touching_ring


@cache
def branch(c0, n=2, **until):
    return family_branch(Tube(c0, 10), "ring", (0, n), branch_options(until))


@pytest.mark.parametrize("n", [2, 3])
def test_rings_are_the_exact_ones(n):
    for v in (0.85, touching_ring(n).v + 1e-3):
        last, exact = branch(-1.0, n, v=v).points[-1], ring_at(n, "v", v)
        found = [last.observables[name] for name in ("lambda1", "lambda2", "E", "gap")]
        expected = exact.lambda1(-1.0), exact.lambda2, exact.energy(-1.0), exact.gap
        np.testing.assert_allclose(found, expected, atol=1e-10)
        radii = np.abs(exact.position(np.array([0.0, math.pi / n])))
        assert (last.observables["r_max"], last.observables["r_min"]) == pytest.approx(tuple(radii), abs=1e-10)
        outline = last.problem.outline(last.u, 100)
        np.testing.assert_allclose(outline, exact.position(np.linspace(0, 2 * math.pi, 100)), atol=1e-9)
        y, z = last.problem.section(last.u, 3.0)
        assert np.trapezoid(y, z) == pytest.approx(math.pi * v, rel=2e-3)  # the area of a polygon of 180 sides
        d = last.problem.discretization
        _, kappa, slope = d.values(last.u)[:: d.scheme.m].T
        a, p = last.u[-3:-1]
        assert np.ptp(slope**2 + kappa**4 / 4 - a * kappa**2 - 2 * p * kappa) < 1e-9  # the first integral


@pytest.mark.parametrize("m", [2, 3])
def test_the_order_is_that_of_gauss_collocation(m):
    """Pressure and energy at the mesh converge with the order ``2 m``."""
    exact = ring_at(2, "v", 0.85)
    errors = []
    for intervals in (8, 16, 32):
        mesh = np.linspace(0, 1, intervals + 1)
        d = Discretization(HALF_LOBE, gauss_scheme(m), mesh, np.array([2, exact.a, exact.p, 0.85]), ("a", "p"))
        points = (mesh[:-1, None] + np.diff(mesh)[:, None] * d.scheme.points[None, :-1]).ravel()
        u = d.pack(exact.states(np.append(points, 1.0)), d.parameters)
        result = newton(d.residual, d.solve, u, NewtonOptions())
        assert result.converged
        errors.append(abs(result.u[-1] - exact.p))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(2 * m, abs=0.25)


@pytest.mark.parametrize("n", [2, 5])
def test_the_jacobian_is_the_residual_s(n):
    problem, u, tangent = ring_onset(Tube(0.3, 10), n)
    rng = np.random.default_rng(1)
    u = u + 0.3 * tangent + 0.01 * rng.standard_normal(u.size)
    row, step = rng.standard_normal((2, u.size))
    h = 1e-5
    change = (problem.residual(u + h * step) - problem.residual(u - h * step)) / (2 * h)
    found = problem.solve(u, np.append(change, problem.inner(row, step)), row)
    np.testing.assert_allclose(found, step, atol=1e-6)
    # By the number of lobes, too, which continuation leaves alone.
    d = replace(problem.discretization, free=("n", "a", "p", "v"))
    u = d.pack(problem.discretization.values(u), problem.discretization.all_parameters(u))
    rows, step = rng.standard_normal((2, u.size)), rng.standard_normal(u.size)
    change = (d.residual(u + h * step) - d.residual(u - h * step)) / (2 * h)
    found = d.solve(u, np.append(change, [d.inner(row, step) for row in rows]), rows)
    np.testing.assert_allclose(found, step, atol=1e-6)


@pytest.mark.parametrize(("c0", "n"), [(0.0, 2), (-1.0, 2), (0.48, 3)])
def test_minus_twice_the_slope_of_the_energy_is_the_pressure(c0, n):
    for v in (0.95, 0.85):
        point = branch(c0, n, v=v).points[-1]
        problem, u = point.problem, point.u
        ahead, behind = (
            problem.observables(correct(problem, u + h * point.tangent, point.tangent, u, h, NewtonOptions())[0].u)
            for h in (1e-4, -1e-4)
        )
        slope = (ahead["E"] - behind["E"]) / (ahead["v"] - behind["v"])
        assert -2 * slope == pytest.approx(point.observables["lambda2"], abs=1e-7)


@pytest.mark.parametrize("n", [2, 3])
def test_rings_branch_off_as_the_amplitude_equation_says(n):
    """``lambda1, lambda2, E`` at equal ``v``, and the radii, to the next order in the amplitude."""
    equation = amplitude_equation(Tube(-1.0, 10), (0, n))
    errors = []
    for v in (0.9996, 0.9999):
        A = equation.amplitude_at("ring", v)
        exact, predicted = ring_at(n, "v", v), equation.at("ring", A)
        tip = float(exact.position(0.0).real)
        errors.append(
            [exact.lambda1(-1.0) - predicted["lambda1"], exact.lambda2 - predicted["lambda2"], tip - predicted["r_max"]]
        )
    # Half the amplitude: a sixteenth of what is left at fourth order, an eighth at third.
    np.testing.assert_allclose(np.divide(*errors), [16, 16, 8], rtol=0.1)


def blocks_by_wave(spectrum, j):
    """Growth rates at ``j`` waves, each as often as it occurs, largest first."""
    rates = [np.repeat(found, block.multiplicity) for block, found in spectrum.rates.items() if block.j == j]
    return np.sort(np.concatenate(rates))[::-1]


@pytest.mark.parametrize(("c0", "n", "v"), [(0.0, 2, 0.85), (-1.0, 2, 0.85), (0.0, 3, 0.97)])
def test_growth_rates_are_those_of_reduced_modes(c0, n, v):
    """Another discretization, in two dimensions and by exact derivatives of the energy, of the same rings."""
    ours, theirs = (
        branch(c0, n, v=v).points[-1],
        family_branch(Tube(c0, 10), "ring", (0, n), branch_options({"v": v}), discretization="modes").points[-1],
    )
    for name in ("lambda1", "lambda2", "E", "r_min", "r_max"):
        assert ours.observables[name] == pytest.approx(theirs.observables[name], abs=1e-9)
    assert ours.spectrum.n_unstable == theirs.spectrum.n_unstable
    assert ours.spectrum.residual < 1e-8
    for j in range(4):
        found, expected = (blocks_by_wave(entry.spectrum, j)[:8] for entry in (ours, theirs))
        np.testing.assert_allclose(found, expected, atol=1e-7)


@pytest.mark.parametrize(("c0", "n"), [(0.2, 2), (-1.0, 3), (0.6, 4)])
def test_the_cylinder_s_growth_rates_are_the_dispersion_relation(c0, n):
    problem, u, _ = ring_onset(Tube(c0, 7), n)
    spectrum = problem.spectrum(u)
    for block, found in spectrum.rates.items():
        winding = [abs(block.c + n * i) for i in range(-9, 10)]
        if block.parity:
            winding = sorted({q for q in winding if q or block.parity == "even"})
        expected = growth_rate(2 * math.pi * block.j / 7, np.array(winding), (n**2 - 1) / 2, c0)
        expected = np.sort(expected)[::-1]
        if block == PlanarBlock(0, 0, n, "even"):
            expected = expected[np.abs(expected - growth_rate(0, 0, (n**2 - 1) / 2, c0)) > 1e-9]  # a change of radius
        if block.j == 0 and block.c == 1:
            expected = expected[np.abs(expected) > 1e-9]  # translations
        np.testing.assert_allclose(found[:4], expected[:4], atol=1e-7)


def energy(curve, normal, w, k, length, profile):
    """``F`` of the cylinder displaced by ``w(s) cos(kx)`` along the normal, by spectral differentiation on a grid."""
    along = 16
    x = length * np.arange(along) / along
    place = curve[None] + np.cos(k * x)[:, None] * (w * normal)[None]
    surface = np.array([np.repeat(x[:, None], len(curve), 1) * 0, place.real, place.imag])

    def derivative(f, axis, period):
        numbers = np.fft.fftfreq(f.shape[axis], 1 / f.shape[axis]) * 2 * np.pi / period
        shape = [1] * f.ndim
        shape[axis] = -1
        return np.fft.ifft(1j * numbers.reshape(shape) * np.fft.fft(f, axis=axis), axis=axis).real

    by_x, by_s = derivative(surface, 1, length), derivative(surface, 2, 2 * np.pi)
    second = derivative(by_x, 1, length), derivative(by_x, 2, 2 * np.pi), derivative(by_s, 2, 2 * np.pi)
    by_x[0] += 1
    cross = np.cross(by_x, by_s, axis=0)  # inner normal times sqrt(g): along x, then counterclockwise
    g = (cross**2).sum(axis=0)
    h = [(f * cross).sum(axis=0) / np.sqrt(g) for f in second]
    dots = [(p * q).sum(axis=0) for p, q in ((by_x, by_x), (by_x, by_s), (by_s, by_s))]
    mean = (dots[2] * h[0] - 2 * dots[1] * h[1] + dots[0] * h[2]) / (2 * g)
    cell = length / along * 2 * np.pi / len(curve)
    volume = (place.conj() * (by_s[1] + 1j * by_s[2])).imag.sum() / 2 * cell
    area = np.sqrt(g)
    return ((mean - profile.c0) ** 2 * area + profile.lambda1 * area).sum() * cell + profile.lambda2 * volume


@pytest.mark.parametrize(
    ("n", "c", "parity", "k"),
    [
        (2, 0, "even", 0.0),
        (2, 0, "odd", 0.7),
        (2, 1, "even", 0.7),
        (2, 1, "odd", 0.0),
        (3, 1, None, 0.9),
        (3, 0, "even", 0.9),
    ],
)
def test_the_second_variation_is_the_second_difference_of_the_energy(n, c, parity, k):
    ring, c0, count = ring_at(n, "v", 0.8), 0.35, 64
    profile = exact_profile(ring, c0)
    points = 2 * (np.arange(n * count) + 0.5) / count
    states, length = profile.at(points), 2 * math.pi / (k or 1.0)
    s = math.pi / n * points
    wave = {"even": np.cos, "odd": np.sin, None: lambda t: np.exp(1j * t)}[parity]
    w = wave((c + n) * s) + 0.4 * wave((c - n if parity is None else c or 2 * n) * s) + 0.2 * wave((c + 2 * n) * s)
    variation = PlanarVariation.of(profile, count)
    at_rest, by_square = variation.matrices(c, parity)
    coefficients = variation.waves(c, parity)[0].conj().T
    matrix = at_rest + k**2 * by_square - k**4 / 2 * np.eye(len(at_rest))
    part = coefficients @ w[: len(matrix)]
    form = (part.conj() @ matrix @ part).real * (1 if parity is None else 2) * 2 * math.pi / count
    if parity is None:
        w, form = w.real, form / 2
    form *= length / 2 if k else length
    curve, normal = ring.position(s), np.exp(1j * states[:, 0])
    h = 2e-4
    values = [energy(curve, normal, step * w, k, length, profile) for step in (-h, 0.0, h)]
    assert (values[0] - 2 * values[1] + values[2]) / h**2 == pytest.approx(-form, rel=1e-5)
    behind, ahead = (energy(curve, normal, step * w, k, length, profile) for step in (-1e-5, 1e-5))
    assert (ahead - behind) / 2e-5 == pytest.approx(0, abs=1e-6)  # it is an equilibrium


@pytest.mark.parametrize(("c0", "n"), [(-1.0, 2), (0.3, 3), (3.0, 2)])
def test_nothing_grows_beyond_the_waves_that_are_counted(c0, n):
    profile = exact_profile(ring_at(n, "v", 0.7), c0)
    counted = planar_spectrum(profile, 20.0)
    variation = PlanarVariation.of(profile, counted.points)
    most = max(block.j for block in counted.rates)
    for c, parity in classes_of(n):
        beyond = 2 * math.pi / 20 * np.arange(most, 4 * most)
        rates = variation.rates_at(c, parity, beyond)
        assert max(float(found[0]) for found in rates) < 0
    assert counted.complete
    assert counted.n_unstable > 0


def test_rigid_motions_show_where_too_few_points_resolve_the_ring():
    profile = exact_profile(ring_at(2, "v", 0.3), 0.0)
    residuals = [PlanarVariation.of(profile, points).residual() for points in (8, 16, 32, 64)]
    assert residuals[0] > 1e-2
    assert residuals[-1] < 1e-8
    assert (np.diff(residuals) < 0).all()


def test_stability_is_lost_to_one_wave_on_the_paper_s_tube():
    wrinkles = branch(-1.0, v=0.85)
    (lost,) = wrinkles.find("bp")
    assert wrinkles.at(lost).observables["lambda2"] == pytest.approx(1.613623, abs=1e-6)
    assert (lost.change, lost.block) == (2, PlanarBlock(1, 0, 2, "even"))
    table = wrinkles.table()
    assert (table.n_unstable[: lost.index + 1] == 0).all()
    assert (table.n_unstable[lost.index + 1 :] == 2).all()


def test_onsets_for_all_lengths_are_the_branches_branch_points():
    onsets = ring_onsets(-1.0, 2, [5, 10, 20])
    assert list(onsets.status) == ["none_in_range", "found", "found"]
    assert list(onsets.j[1:]) == [1, 1]
    for row in onsets[1:].itertuples():
        followed = family_branch(Tube(-1.0, row.L), "ring", (0, 2), branch_options({"v": row.v - 0.01}))
        first = followed.find("bp")[0]
        assert str(first.block) == row.block
        for name in ("lambda1", "lambda2", "v", "E", "amplitude"):
            assert getattr(row, name) == pytest.approx(followed.at(first).observables[name], abs=1e-9)
    assert (branch(-1.0, v=0.85).table().n_unstable.iloc[0], len(onsets)) == (0, 3)
    assert (family_branch(Tube(-1.0, 5.0), "ring", (0, 2)).table().n_unstable == 0).all()  # none in range


def test_rings_on_long_tubes_lose_stability_in_proportion_to_the_square_of_the_wave_number():
    """However soon after the onset: ``1 - v`` tends to a multiple of ``k^2``."""
    onsets = ring_onsets(-1.0, 2, [200, 400])
    assert (onsets.status == "found").all()
    one, other = (1 - onsets.v) / onsets.k**2
    assert one == pytest.approx(other, rel=2e-3)


def test_only_the_wave_number_counts():
    """Two waves on twice the length, and what a ring is unstable to on a given tube."""
    neutral = neutral_rings(0.0, 2, [2 * math.pi / 10])
    followed = branch(0.0, lambda2=2.6)
    found = [s for s in followed.find("bp") if s.block.j == 1]
    assert len(neutral) == len(found) == 3
    for row, special in zip(neutral.itertuples(), found, strict=True):
        assert row.lambda2 == pytest.approx(followed.at(special).observables["lambda2"], abs=1e-9)
        assert row.change == special.change
        assert str(special.block) == f"j=1 {row.block}"
    (row,) = ring_onsets(0.0, 2, 10).itertuples()
    assert row.status == "unstable_at_onset"
    (row,) = ring_onsets(0.0, 3, 1).itertuples()  # no wave along so short a tube, but rings of three lobes become oval
    assert (row.status, "j=0 c=1/3" in row.message) == ("unstable_at_onset", True)
    spectrum = planar_spectrum(exact_profile(ring_at(2, "v", 0.85), 0.0), 20.0)
    double, single = spectrum.rates[PlanarBlock(2, 0, 2, "even")], branch(0.0, v=0.85).points[-1].spectrum
    np.testing.assert_allclose(double[0], single.rates[PlanarBlock(1, 0, 2, "even")][0], atol=1e-8)


def test_a_branch_ends_exactly_at_contact_unless_told_to_stop_before():
    whole = branch(-1.0)
    assert (whole.status, whole.complete, whole.special[-1].kind) == (Status.CONTACT, False, "end")
    assert whole.points[-1].observables["gap"] == pytest.approx(0, abs=1e-12)
    assert whole.points[-1].observables["lambda2"] == pytest.approx(touching_ring(2).lambda2, abs=1e-10)
    assert set(COLUMNS) | {"gap"} == set(whole.table().columns)
    stopped = branch(-1.0, r_min=0.25, v=0.1)
    assert (stopped.complete, stopped.special[-1].kind) == (True, "stop")
    assert stopped.points[-1].observables["r_min"] == pytest.approx(0.25, abs=1e-12)
    near = resumed(branch(-1.0, r_min=0.0045), branch_options(max_step=1e-2))  # no neck is too thin for a ring
    assert near.status is Status.CONTACT
    assert (near.table().r_min < 4e-3).sum() > 3
    beyond = branch(-1.0, v=0.1)
    assert (beyond.status, beyond.complete) == (Status.CONTACT, False)
    with pytest.raises(InputError, match="^resume: "):
        resumed(whole, branch_options())


@pytest.mark.parametrize("n", [2, 3])
def test_the_radius_over_the_angle_is_that_of_the_curve(n):
    last = branch(-1.0, n, v=0.85).points[-1]
    coefficients = last.problem.radius_cosines(last.u, 48)
    points = ring_at(n, "v", 0.85).position(np.linspace(0, 2 * math.pi, 200))
    radius = np.cos(n * np.outer(np.angle(points), np.arange(48))) @ coefficients
    np.testing.assert_allclose(radius, np.abs(points), atol=1e-9)
    assert np.abs(coefficients[-4:]).max() < 1e-9
    folded = branch(-1.0, n, v=touching_ring(n).v + 1e-3).points[-1]
    with pytest.raises(ValueError, match="star-shaped"):
        folded.problem.radius_cosines(folded.u, 48)


def test_meshes_change_nothing():
    point = branch(-1.0, 3, v=0.2).points[-1]
    d = point.problem.discretization
    finer, (u,) = d.on_mesh(np.linspace(0, 1, 61), point.u)
    problem = replace(point.problem, discretization=finer)
    along_v = np.zeros(u.size)
    along_v[-1] = 1.0
    result, _ = correct(problem, u, along_v, u, 0.0, NewtonOptions())
    assert result.converged
    for name in ("lambda2", "E", "gap"):
        assert problem.observables(result.u)[name] == pytest.approx(point.observables[name], abs=1e-10)
    assert problem.transfer(point.problem, point.u) == pytest.approx(u, abs=1e-14)


def test_a_profile_goes_all_the_way_around():
    ring = ring_at(3, "v", 0.6)
    profile: PlaneProfile = exact_profile(ring, 0.1)
    sigma = np.linspace(0, 6, 50)
    expected = np.column_stack([f(math.pi / 3 * sigma) for f in (ring.angle, ring.curvature, ring.slope)])
    np.testing.assert_allclose(profile.at(sigma), expected, atol=1e-11)
    x, y, z = profile.surface(7.0)
    assert x.shape == y.shape == z.shape
    assert (x.min(), x.max()) == (0, 7)
    assert np.hypot(y, z).max() == pytest.approx(float(ring.position(0.0).real), abs=1e-12)


@pytest.mark.parametrize(
    ("arguments", "name"), [((0.0, 10, 1), "mode"), ((0.0, 10, 2.5), "mode"), ((0.0, -1, 2), "length")]
)
def test_what_is_no_ring_is_refused(arguments, name):
    c0, length, n = arguments
    with pytest.raises(InputError, match=f"^{name}: "):
        family_branch(Tube(c0, length), "ring", (0, n))


def test_unusable_tolerances_and_tubes_are_refused():
    with pytest.raises(InputError, match="^tolerance: "):
        family_branch(Tube(0.0, 10), "ring", (0, 2), tolerance=1.0)
    endless = family_branch(Tube(0.0, 1e6), "ring", (0, 2))
    assert len(endless.points) == 1
    assert "take a shorter tube" in endless.reason
    with pytest.raises(InputError, match="^lengths: "):
        ring_onsets(-1.0, 2, [1e6])
    with pytest.raises(InputError, match="^wave_numbers: "):
        neutral_rings(-1.0, 2, [0.0])


LONG = (-1.0, 60, 20)
"""A tube on which nine waves become neutral in the first step, and thousands grow."""


def test_every_special_point_of_a_long_ring_is_a_point_shown_when_it_is_located():
    shown, located = [], []
    options = branch_options(max_points=11, progress=lambda so_far: shown.append(len(so_far.points)),
                             locating=lambda done, of: located.append((done, of)))  # fmt: skip
    wrinkles = family_branch(Tube(*LONG[:2]), "ring", (0, LONG[2]), options)
    assert shown == list(range(1, 12))
    assert located == [(done, 9) for done in range(9)]
    for lost in wrinkles.find("bp"):  # each is neutral on the exact ring of its volume, with another number of points
        observed, block = wrinkles.at(lost).observables, lost.block
        variation = PlanarVariation.of(exact_profile(ring_at(20, "v", observed["v"]), -1.0), 24)
        rates = variation.rates_at(block.c, block.parity, np.array([2 * math.pi * block.j / 60]))[0]
        slope = 2e4  # of growth rates by the volume: they change by hundreds where it does by a hundredth
        assert np.abs(rates).min() < 1e-6 * slope
    # The circle's own unstable waves, by the closed form.
    k, n = np.meshgrid(2 * math.pi / 60 * np.arange(-400, 401), np.arange(-200, 201))
    growing = growth_rate(k, n, (20**2 - 1) / 2, -1.0) > 1e-6
    growing[(k == 0) & (np.abs(n) == 1)] = False
    assert wrinkles.points[0].spectrum.n_unstable == growing.sum() - (1 if growth_rate(0, 0, 199.5, -1.0) > 0 else 0)


def test_max_points_counts_special_points_and_what_is_resumed_goes_on_with_the_next():
    whole = family_branch(Tube(*LONG[:2]), "ring", (0, LONG[2]), branch_options(max_points=11))
    part = family_branch(Tube(*LONG[:2]), "ring", (0, LONG[2]), branch_options(max_points=4))
    assert [len(part.points), part.kinds(3)] == [4, ["bp", "end"]]
    while len(part.points) < 10:
        before = len(part.points)
        part = resumed(part, branch_options(max_points=4))
        assert len(part.points) == before + 3
    ends = [[(s.block, s.change) for s in found.find("bp")[:9]] for found in (whole, part)]
    assert ends[0] == ends[1]
    for one, two in zip(whole.find("bp"), part.find("bp"), strict=False):
        assert part.at(two).observables["v"] == pytest.approx(whole.at(one).observables["v"], abs=1e-11)


@pytest.mark.parametrize(("c0", "n", "length"), [(0.48, 40, 3.0), (-50.0, 20, 2.0), (12.0, 6, 8.0)])
def test_growth_rates_of_many_lobes_have_the_rounding_of_few_points(c0, n, length):
    """Where rings branch off they are those of the circle, in closed form."""
    lambda2 = (n**2 - 1) / 2

    def circle(sigma):
        return np.column_stack((math.pi / n * sigma, np.ones_like(sigma), np.zeros_like(sigma)))

    found = planar_spectrum(PlaneProfile(circle, n, c0, 0.25 - lambda2 - c0**2, lambda2), length)
    for block, rates in found.rates.items():
        if block.j == 0 or (block.parity == "odd" and block.c == 0):
            continue  # rigid motions and constraints, and waves of which the one that is constant around is none
        around = block.c + n * np.arange(-9, 10)
        largest = growth_rate(2 * math.pi * block.j / length, around, lambda2, c0).max()
        assert rates[0] == pytest.approx(largest, rel=1e-12, abs=1e-15 * (8 * n) ** 4)
    assert found.points == 16
