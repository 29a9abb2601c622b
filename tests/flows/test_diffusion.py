"""The H^-1 flow of tubes and meshes: its rates on the straight tube, what it keeps, and the same flow of other surfaces."""

from functools import cache

import numpy as np
import pytest

from pearlbvp.flows.axisymmetric import GraphFlow
from pearlbvp.flows.driver import FlowOptions, flow
from pearlbvp.flows.mesh import MeshFlow
from pearlbvp.flows.tube import TubeFlow
from pearlbvp.helfrich import Tube, cylinder_lambda1
from pearlbvp.mesh.families import tube_mesh
from pearlbvp.mesh.start import straight
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.flow_start import solution_start
from pearlbvp.studies.mesh_flow import mesh_start
from pearlbvp.theory.dispersion import growth_rate
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.waves import Cell

L, C0, LAMBDA2 = 10.0, 0.3, 0.2
K = 2 * np.pi / L


def expected(count):
    """``(k^2 + n^2) mu`` of the straight tube's waves, each as often as it occurs."""
    rates = [
        ((m * K) ** 2 + n**2) * float(growth_rate(m * K, n, LAMBDA2, C0))
        for m in range(7) for n in range(5) if (m, n) not in ((0, 0), (0, 1))
        for _ in range((1 + (m > 0)) * (1 + (n > 0)))
    ]  # fmt: skip
    return np.sort(rates)[::-1][:count]


def test_rates_of_tubes_are_those_of_the_dispersion_relation():
    problem = TubeFlow(C0, L, (6, 4), "diffusion")
    q = problem.packed({Mode("sigma", 0): 1.0})
    rates, _ = problem.growth_rates(q, np.array([cylinder_lambda1(LAMBDA2, C0), LAMBDA2]), 12)
    np.testing.assert_allclose(rates, expected(12), atol=1e-10)


def test_rates_of_meshes_tend_to_those_of_the_dispersion_relation():
    errors = []
    for nodes in (300, 1200):
        reference, u = straight(tube_mesh(L, nodes), C0, LAMBDA2)
        rates, _ = MeshFlow(reference, "diffusion").growth_rates(u[: reference.mesh.count], u[-3:-1], 8)
        errors.append(np.abs(rates / expected(8) - 1).max())
    assert errors[1] < 1e-2
    assert errors[1] < errors[0] / 3  # linear elements: by the square of an edge


def test_the_stiffness_is_the_mean_square_of_the_normal_displacement_s_gradient():
    """Of a tube without any symmetry, by differentiating values on a finer grid."""
    problem, rng = TubeFlow(C0, L, (5, 4), "diffusion"), np.random.default_rng(1)
    falling = 1 / (1 + np.array([mode.p**2 + mode.b**2 for mode in problem.modes]))
    q = problem.packed({Mode("sigma", 0): 1.0}) + 0.03 * falling * rng.standard_normal(len(falling))
    rate, cell = falling**1.5 * rng.standard_normal(len(falling)), Cell(1, 1, (96, 96))
    a, b = problem.waves.state(cell, q)[:4].reshape(2, 2, *cell.points)
    moved = problem.waves.displacement(cell, rate).reshape(2, *cell.points)
    xx, xp, pp = 1 + (a * a).sum(0), (a * b).sum(0), (b * b).sum(0)
    element = np.sqrt(xx * pp - xp**2)
    normal = (b[1] * moved[0] - b[0] * moved[1]) / element
    numbers = np.fft.fftfreq(96, 1 / 96)
    by_x = np.fft.ifft(1j * K * numbers[:, None] * np.fft.fft(normal, axis=0), axis=0).real
    by_phi = np.fft.ifft(1j * numbers * np.fft.fft(normal, axis=1), axis=1).real
    by_hand = ((pp * by_x**2 - 2 * xp * by_x * by_phi + xx * by_phi**2) / element).mean()
    tube = problem._tube(q, np.zeros(2))
    assert rate @ tube.stiffness(problem.waves) @ rate == pytest.approx(by_hand, rel=1e-7)


def test_the_metric_of_meshes_is_the_mean_square_of_the_potential_s_gradient():
    """The potential by a dense pseudo-inverse, its gradient on each triangle by the products of two of its sides."""
    reference, _ = straight(tube_mesh(L, 200), C0, LAMBDA2)
    mesh, rng = reference.mesh, np.random.default_rng(3)
    shape = MeshFlow(reference, "diffusion")._at(0.05 * rng.standard_normal(mesh.count))
    corners, triangles = shape.surface.corners, mesh.triangles
    sides = corners[:, 1:] - corners[:, :1]
    products = sides @ sides.transpose(0, 2, 1)
    sizes = np.sqrt(np.linalg.det(products)) / 2
    shares, stiffness = np.zeros(mesh.count), np.zeros((mesh.count, mesh.count))
    steps = np.array([[-1.0, 1, 0], [-1, 0, 1]])  # of a function along the two sides, by its values
    for corner in triangles.T:
        np.add.at(shares, corner, sizes / 3)
    local = sizes[:, None, None] * (steps.T @ np.linalg.inv(products) @ steps)
    np.add.at(stiffness, (triangles[:, :, None], triangles[:, None, :]), local)
    rate = rng.standard_normal(mesh.count)
    rate -= (shares @ shape.lifting @ rate) / (shares @ shape.lifting @ np.ones(mesh.count))  # which keeps the volume
    sources = shares * (shape.lifting @ rate)
    assert rate @ shape.spread(rate) == pytest.approx(sources @ np.linalg.pinv(stiffness) @ sources, rel=1e-9)


def test_axisymmetric_tubes_flow_as_graphs_do():
    """Two discretizations that share no line: the graph keeps its volume without a multiplier."""
    graph, tube = GraphFlow(0.0, L, 48, "diffusion"), TubeFlow(0.0, L, (12, 2), "diffusion")
    x = np.arange(128) * L / 128 - L / 2
    ends = [
        flow(graph, graph.coordinates(1 + 0.2 * np.cos(K * graph.x)), FlowOptions(until=2.0)),
        flow(tube, tube.of_radii(x, 1 + 0.2 * np.cos(K * x)), FlowOptions(until=2.0)),
    ]
    one, two = (end.table().iloc[-1] for end in ends)
    first = ends[0].table().iloc[0]
    assert first.E - one.E > 5e-6
    for name, error in (("E", 1e-9), ("lambda1", 2e-5), ("r_min", 2e-5), ("v", 1e-12)):
        assert one[name] == pytest.approx(two[name], abs=error), name


@cache
def buckle():
    return family_branch(Tube(0.0, L), "buckle", (1, 1), branch_options({"v": 0.95})).points[-1]


def flowed(start, delta, until):
    """The table of the flow of a perturbed buckle, which has kept its area and volume."""
    rows = start.flow(start.perturbed("critical", delta, keep=True), FlowOptions(until=until)).table()
    assert np.abs(rows[["area_error", "volume_error"]].to_numpy()).max() < 1e-12
    return rows


def test_a_buckle_loses_energy_at_the_linear_rate_and_neither_area_nor_volume():
    """Along the most unstable vector the flow is as much faster as it is farther from the buckle."""
    start = solution_start(buckle(), law="diffusion", size=(8, 8))
    rate = start.problem.growth_rates(start.q, start.multipliers)[0][0]
    rows = flowed(start, 1e-3, 60.0)
    assert (np.diff(rows["E"]) < 1e-13).all()
    late = rows[rows["t"] > 10]
    slope = np.polyfit(late["t"], np.log(late["velocity"]), 1)[0]
    assert slope == pytest.approx(rate, rel=2e-3)


def test_meshes_flow_as_tubes_do():
    """Down from a buckle, along the most unstable vector that each finds for itself."""
    starts = (
        solution_start(buckle(), law="diffusion", size=(8, 8)), mesh_start(buckle(), 250, law="diffusion"),
    )  # fmt: skip
    one, two = (flowed(start, 0.1, 15.0)[["t", "velocity"]].to_numpy().T for start in starts)
    times = np.linspace(5, 15, 5)
    np.testing.assert_allclose(np.interp(times, *one), np.interp(times, *two), rtol=0.15)


def test_too_many_vertices_are_refused():
    reference, _ = straight(tube_mesh(L, 4200), C0, LAMBDA2)
    with pytest.raises(ValueError, match="^nodes: .* stay below"):
        MeshFlow(reference, "diffusion")
