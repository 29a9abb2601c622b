"""What digits show of how numbers were rounded, and profiles without it: against closed forms of the unrounded shape."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pearlbvp.errors import InputError
from pearlbvp.flows.driver import start
from pearlbvp.mesh import rounding
from pearlbvp.mesh.families import jittered, tube_mesh
from pearlbvp.mesh.files import read_smooth_tube, read_tube, write_mesh
from pearlbvp.rounding import steps
from pearlbvp.studies.flow_start import profile_start
from pearlbvp.studies.mesh_flow import surface_start
from pearlbvp.studies.profiles import without_rounding

L = 10 / 3
K = 2 * np.pi / L


def sine(x):
    return 1 + 0.1 * np.sin(K * x)


def two_waves(x):
    return 1 + 0.1 * np.sin(K * x) + 0.03 * np.cos(2 * K * x)


def exact(radius, count=512):
    """Both multipliers of a surface of revolution, ``c0 = 0``: from its Helfrich force by fourth derivatives in closed form.

    Outward displacements ``u`` change ``E`` by ``int (-lap H - 2H(H^2 - K)) u``, ``A`` by ``int 2H u`` and ``V`` by ``int u``;
    the multipliers are those with which the force changes neither ``A`` nor ``V``.
    """
    x = L * np.arange(count) / count
    waves = 2j * np.pi * np.fft.fftfreq(count, L / count)

    def d(values):
        return np.fft.ifft(waves * np.fft.fft(values)).real

    r = radius(x)
    q = np.sqrt(1 + d(r) ** 2)
    along = -d(d(r)) / q**3
    around = 1 / (r * q)
    h = (along + around) / 2
    force = -d(r / q * d(h)) / (r * q) - 2 * h * (h**2 - along * around)
    columns = np.column_stack((2 * h, np.ones(count)))
    area = (r * q)[:, None]
    return -np.linalg.solve(columns.T @ (area * columns), (area * columns).T @ force)


def found(x, r, length=L):
    first = start(*profile_start(0.0, length, x, r)).record.rows
    return np.array([first["lambda1"][0], first["lambda2"][0]])


def read(x, r, length=L):
    return without_rounding(x, r, length, steps(x), steps(r))


def rows(radius, count=40, closed=False, first=0.0):
    x = first + L * np.arange(count + closed) / count
    return x, radius(x)


def decimals(values, d):
    return np.array([float(f"{value:.{d}f}") for value in values])


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("d", [2, 3, 4, 5])
@pytest.mark.parametrize(("radius", "sharp"), [(sine, 1.0), (two_waves, 10.0)])
def test_few_decimals_give_the_multipliers_of_the_shape_to_what_they_tell_of_it(radius, sharp, d, closed):
    """The sine's amplitude is told to 0.3/sqrt(40) of a step, tension follows it as 2.5 a/0.1 and more; splines through exact rows leave 0.035.

    Rounded rows themselves have tensions of -120 (3 decimals) and -500 (2).
    """
    x, r = rows(radius, closed=closed)
    smooth = read(decimals(x, d), decimals(r, d))
    assert "too few digits for its curvature: smoothed by" in smooth.said
    assert np.abs(smooth.r - radius(smooth.x)).max() < 1.1 * 10.0**-d
    assert found(smooth.x, smooth.r) == pytest.approx(exact(radius), abs=0.04 + sharp * 5 * 10.0**-d)
    assert np.abs(found(decimals(x, d), decimals(r, d)) - exact(radius)).max() > (100 if d < 4 else 0.001)


@pytest.mark.parametrize("first", [0.0, -1.7, 123.4])
def test_rows_beginning_anywhere_of_significant_digits_are_smoothed_alike(first):
    x, r = rows(sine, first=first)
    written = [np.array([float(f"{v:.{n}g}") for v in values]) for values, n in ((x, 7), (r, 4))]
    smooth = read(*written)
    assert found(smooth.x, smooth.r) == pytest.approx(exact(sine), abs=0.03)


def test_unevenly_spaced_rows_have_errors_in_their_places_too():
    random = np.random.default_rng(4)
    x = np.sort(L * (np.arange(100) + random.uniform(-0.4, 0.4, 100)) / 100)
    smooth = read(decimals(x, 3), decimals(sine(x), 3))
    assert found(smooth.x, smooth.r) == pytest.approx(exact(sine), abs=0.03)


@pytest.mark.parametrize("digits", [10, 12, 15, 17])
def test_rows_of_enough_digits_are_taken_as_they_are(digits):
    x, r = (np.array([float(f"{v:.{digits}g}") for v in values]) for values in rows(two_waves, closed=True))
    same = read(x, r)
    assert same.said == ""
    assert (same.x == x).all()
    assert (same.r == r).all()


def test_rows_that_are_rough_by_more_than_their_rounding_are_left_so_which_is_said():
    x, r = rows(sine, 100)
    rough = decimals(r + np.random.default_rng(5).normal(0, 0.01, 100), 2)
    same = read(x, rough)
    assert (same.r == rough).all()
    assert "no smooth profile is as near to it: forces and multipliers at first are off" in same.said


def test_a_straight_tube_of_few_digits_is_straight():
    x = np.array([0, 0.8, 1.7, 2.5])
    same = read(x, np.ones(4))
    assert (same.said, same.r.tolist()) == ("", [1.0] * 4)


def test_rows_there_twice_are_said_and_refused_where_they_differ():
    x, r = rows(sine)
    twice = np.sort(np.append(np.arange(40), [3, 17]))
    assert read(x[twice], r[twice]).said == "left out 2 rows at places that are there already"
    differing = r[twice]
    differing[4] += 1e-4
    with pytest.raises(InputError, match="two rows have x = 0.25 but different r; leave one out"):
        read(x[twice], differing)
    rounded = decimals(differing, 3)  # by no more than the rounding allows
    assert read(x[twice], rounded).said.startswith("left out 2 rows at places")


def pearl(x, phi):
    return np.column_stack((x, sine(x) * np.cos(phi), sine(x) * np.sin(phi)))


def cut_at_the_period(mesh):
    """One period of a tube of period ``L``, as a file has it."""
    mesh = mesh.reduced()
    pairs, number = np.unique(
        np.column_stack((mesh.triangles.ravel(), mesh.wraps.ravel())), axis=0, return_inverse=True
    )
    points = mesh.vertices[pairs[:, 0]] + L * pairs[:, 1:] * [1, 0, 0]
    return points, number.reshape(-1, 3)


def first_multipliers(mesh, kind="subdivision"):
    rows = start(*surface_start(0.0, mesh, kind=kind)).record.rows
    return np.array([rows["lambda1"][0], rows["lambda2"][0]])


@pytest.mark.parametrize("axis", ["x", "z"])
@pytest.mark.parametrize(("d", "tolerance"), [(2, 0.15), (3, 0.03), (4, 0.02), (5, 0.02)])
def test_meshes_of_few_decimals_give_the_multipliers_of_the_surface(tmp_path, d, tolerance, axis):
    """Which have the wrong sign on the rounded mesh itself; those of the exact mesh are off by 0.01."""
    mesh = tube_mesh(L, 800, pearl)
    points, triangles = cut_at_the_period(mesh)
    points = points[:, [1, 2, 0] if axis == "z" else [0, 1, 2]]
    path = tmp_path / "t.obj"
    faces = "".join("f {} {} {}\n".format(*(face + 1)) for face in triangles)
    path.write_text("".join("v {:.{d}f} {:.{d}f} {:.{d}f}\n".format(*p, d=d) for p in points) + faces)
    smooth, said = read_smooth_tube(path, round(L, d))  # as its ends are apart
    assert f"coordinates are rounded to {10.0**-d:.1g}, too few digits for curvatures: smoothed" in said
    assert first_multipliers(smooth) == pytest.approx(exact(sine), abs=tolerance)
    rough, _ = read_tube(path, round(L, d))
    assert np.abs(smooth.vertices - rough.vertices).max() <= 10.0**-d
    if d < 4:
        assert first_multipliers(rough)[0] < 2 * exact(sine)[0]


def test_meshes_of_enough_digits_or_rough_by_themselves_stay_as_they_are(tmp_path):
    path = tmp_path / "t.ply"
    write_mesh(tube_mesh(L, 400, pearl), path)
    for mesh, step in ((tube_mesh(L, 400, pearl), 1e-9), (jittered(tube_mesh(L, 400), 0.1, surface=pearl), 1e-6)):
        same, moved = rounding.without_rounding(mesh, step)
        assert moved == 0
        assert same is mesh
    mesh, said = read_smooth_tube(path, L)
    assert said == ""
    assert (mesh.vertices == read_tube(path, L)[0].vertices).all()


@pytest.mark.parametrize("d", range(9))
def test_decimals_are_counted_though_zeros_at_the_end_are_not_written(d):
    values = np.random.default_rng(d).uniform(-9, 9, 200)
    assert steps(decimals(values, d)) == pytest.approx(np.full(200, 10.0**-d))


@pytest.mark.parametrize("digits", range(2, 12))
def test_significant_digits_are_counted_over_all_sizes(digits):
    values = 10 ** np.random.default_rng(digits).uniform(-5, 5, 300)
    written = np.array([float(f"{value:.{digits}g}") for value in values])
    expected = 10.0 ** (np.floor(np.log10(written)) + 1 - digits)
    assert steps(written) == pytest.approx(expected)
    assert (np.abs(written - values) <= 0.501 * steps(written) * np.where(written > values, 1, 10)).all()


def test_single_precision_is_known_by_its_values():
    values = np.random.default_rng(1).uniform(1, 2, 100).astype(np.float32)
    assert steps(values) == pytest.approx(np.full(100, 2.0**-23))
    assert steps(np.round(values, 3)) == pytest.approx(np.full(100, 1e-3))
    assert (steps(np.random.default_rng(1).uniform(1, 2, 100)) < 1e-14).all()


def test_one_long_number_among_many_is_no_precision():
    values = np.append(decimals(np.random.default_rng(2).uniform(0, 1, 99), 3), 0.1 + 0.2)
    assert steps(values)[:99] == pytest.approx(np.full(99, 1e-3))


def test_of_a_few_numbers_the_longest_tells_the_precision():
    assert steps(np.array([1, 1.1, 1, 0.9, 1])) == pytest.approx([0.1, 0.1, 0.1, 0.1, 0.1])


@given(st.integers(0, 10**6), st.integers(4, 30), st.integers(1, 3))
@settings(max_examples=40, deadline=None)
def test_smoothing_moves_no_row_by_more_than_its_rounding_may_have(seed, count, d):
    x = L * np.arange(count) / count
    draw = np.random.default_rng(seed)
    r = decimals(1 + draw.uniform(0.05, 0.4) * np.cos(2 * np.pi * x / L + draw.uniform(0, 6)), d)
    kept = read(x, r)
    slope = np.abs(np.gradient(r, x)).max()
    assert np.abs(kept.r - r).max() <= 10.0**-d + slope * steps(x).max()
