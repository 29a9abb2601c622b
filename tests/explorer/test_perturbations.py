"""Critical perturbations that pages draw: the Lagrangian of the displaced surface falls at their growth rate.

A second way to every drawn value: energy, area and volume of surfaces on a grid, by Fourier series in both directions, with
no linearization and none of the coordinates in which growth rates are computed.
"""

import base64
import math

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import pearlbvp as pb
from pearlbvp.explorer.perturbations import critical
from pearlbvp.explorer.shapes import Shared
from pearlbvp.studies.mesh import meshed


def unpacked(text):
    return np.frombuffer(base64.b64decode(text), dtype="<f4").astype(float)


def derivative(values, axis):
    count = values.shape[axis]
    shape = [1] * values.ndim
    shape[axis] = count
    waves = (2j * np.pi * np.fft.fftfreq(count, 1 / count)).reshape(shape)
    return np.fft.ifft(waves * np.fft.fft(values, axis=axis), axis=axis).real


def lagrangian(points, length, tube, lambda1, lambda2):
    """``E + lambda1 A + lambda2 V`` of a surface on a grid along and around it, shape (K, M, 3), of one axial period."""
    straight = np.zeros_like(points)
    straight[..., 0] = (length * np.arange(len(points)) / len(points))[:, None]
    axis = np.array([length, 0, 0])
    along = derivative(points - straight, 0) + axis
    around = derivative(points, 1)
    normal = np.cross(around, along)
    size = np.linalg.norm(normal, axis=-1)
    seconds = (derivative(along - axis, 0), derivative(along, 1), derivative(around, 1))
    h11, h12, h22 = ((second * normal).sum(axis=-1) / size for second in seconds)
    g11, g12, g22 = ((a * b).sum(axis=-1) for a, b in ((along, along), (along, around), (around, around)))
    h = -(g22 * h11 - 2 * g12 * h12 + g11 * h22) / (2 * size**2)
    volume = (points[..., 1:] * normal[..., 1:]).sum(axis=-1).mean() / 2
    return ((h - tube.c0) ** 2 * size).mean() + lambda1 * size.mean() + lambda2 * volume, size


def pearls(point, tube):
    """Grid and normals of pearls, one after the other, and the drawn wave on it."""
    problem = point.problem.shapes
    wave, profile = critical(problem, point.u, point.spectrum, Shared()), problem.profile(point.u)
    values = unpacked(wave.drawn["re"]) + 1j * unpacked(wave.drawn["im"])
    cells, phi = round(tube.L / profile.period), 2 * math.pi * np.arange(32) / 32
    sigma = np.arange(len(values)) / len(values)
    r, psi = profile.at(sigma * (2 if profile.half else 1)).T[:2]
    run = np.fft.fft(profile.arclength * (2 if profile.half else 1) * np.cos(psi))
    numbers = np.fft.fftfreq(len(r), 1 / len(r))
    x = np.fft.ifft(np.where(numbers == 0, 0, run / (2j * np.pi * np.where(numbers == 0, 1, numbers)))).real
    x = np.concatenate([x + (sigma + cell) * profile.period for cell in range(cells)])
    r, psi = np.tile(r, cells), np.tile(psi, cells)
    w = np.concatenate([(values * np.exp(1j * wave.drawn["theta"] * cell)).real for cell in range(cells)])
    ring = np.stack((np.ones(32), np.cos(phi), np.sin(phi)), axis=-1)
    points = ring * np.stack((x, r, r), axis=-1)[:, None]
    normals = ring * np.stack((-np.sin(psi), np.cos(psi), np.cos(psi)), axis=-1)[:, None]
    return wave, points, normals, np.outer(w, np.cos(wave.drawn["n"] * phi))


def rings(point, tube):
    """The same of a section along the tube."""
    problem = point.problem
    wave, profile = critical(problem, point.u, point.spectrum, Shared()), problem.profile(point.u)
    values = unpacked(wave.drawn["re"])[:-1]
    count = len(values)
    sigma = 2 * profile.n * np.arange(count) / count
    psi = profile.at(sigma)[:, 0]
    tangents = np.exp(1j * psi)
    run, numbers = np.fft.fft(tangents), np.fft.fftfreq(count, 1 / count)
    z = np.fft.ifft(np.where(numbers == 0, 0, run / (1j * np.where(numbers == 0, 1, numbers))))  # of circumference 2 pi
    x = tube.L * np.arange(32) / 32
    outwards = -1j * tangents
    points = np.stack(np.broadcast_arrays(x[:, None], z.real, z.imag), axis=-1)
    normals = np.stack(np.broadcast_arrays(0 * x[:, None], outwards.real, outwards.imag), axis=-1)
    return wave, points, normals, np.outer(np.cos(wave.drawn["k"] * x), values)


@pytest.mark.parametrize(
    ("tube", "family", "mode", "v", "of"),
    [
        (pb.Tube(0.48, 22.5), "pearl", (3, 0), 1.02, pearls),  # theta = 2 pi/3
        (pb.Tube(0.48, 15.0), "pearl", (2, 0), 1.03, pearls),
        (pb.Tube(0.0, 10.0), "ring", (0, 2), 0.9, rings),
    ],
)
def test_the_lagrangian_falls_along_the_wave_as_its_growth_rate_says(tube, family, mode, v, of):
    point = pb.branch(tube, family, mode, until={"v": v})[-1]
    wave, points, normals, w = of(point, tube)
    multipliers = point.observables["lambda1"], point.observables["lambda2"]

    def at(step):
        return lagrangian(points + step * w[..., None] * normals, tube.L, tube, *multipliers)

    step = 1e-3 / np.abs(w).max()
    (above, _), (here, size), (below, _) = (at(s * step) for s in (1, 0, -1))
    assert size.mean() == pytest.approx(2 * math.pi * tube.L, rel=1e-6)
    second = (above - 2 * here + below) / step**2
    assert -second / (w**2 * size).mean() == pytest.approx(wave.rate, rel=1e-4)
    assert wave.rate == pytest.approx(point.spectrum.mu_crit, rel=1e-6)


def test_on_meshes_it_is_that_of_the_same_pearls_by_bloch_waves():
    """At every point of the surface, to the order of the mesh; both are drawn by their largest value."""
    tube = pb.Tube(0.48, 15.0)
    point = pb.branch(tube, "pearl", (2, 0), until={"v": 1.03})[-1]
    wave, points, _, w = pearls(point, tube)
    x = np.append(points[:, 0, 0], points[0, 0, 0] + tube.L)
    exact = CubicSpline(x, np.append(w[:, 0], w[0, 0]), bc_type="periodic")
    errors = []
    for nodes in (200, 400):
        problem, u = meshed(point, nodes)
        drawn = critical(problem, u, problem.spectrum(u), Shared())
        values, expected = unpacked(drawn.drawn["values"]), exact(problem.points(u)[:, 0])
        errors.append(np.abs(values * (expected @ values) / (values @ values) - expected).max() / np.abs(w).max())
        assert drawn.rate == pytest.approx(wave.rate, rel=1.5e-2 * (200 / nodes) ** 2)
    assert errors[0] < 3e-3
    assert errors[1] < errors[0] / 4  # edges are shorter by the root of 2
