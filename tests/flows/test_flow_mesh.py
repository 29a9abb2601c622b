"""The flow of triangulated tubes: its equation, its rates, its ends, against graphs, spectra and branches."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from pearlbvp.errors import InputError
from pearlbvp.flows.driver import FlowOptions, constrained, flow, resumed
from pearlbvp.flows.mesh import mesh_flow
from pearlbvp.held import Held
from pearlbvp.helfrich import Tube
from pearlbvp.mesh.adaptation import AdaptOptions
from pearlbvp.mesh.families import tube_mesh
from pearlbvp.mesh.files import read_mesh, write_mesh
from pearlbvp.mesh.problem import with_phases
from pearlbvp.mesh.start import branch_point, solved
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.flow import load, save
from pearlbvp.studies.flow_end import continued, described, solution_of
from pearlbvp.studies.flow_start import profile_start
from pearlbvp.studies.mesh import meshed
from pearlbvp.studies.mesh_flow import mesh_start, surface_start
from pearlbvp.theory.dispersion import growth_rate

L = 10.0
KINDS = ("subdivision", "cotangent")
QUICK = FlowOptions(rtol=1e-5, atol=1e-7)


def bulged(x, phi):
    """A surface of revolution by ``x`` and ``phi``, which is no equilibrium."""
    r = 1 + 0.25 * np.cos(2 * np.pi * x / L)
    return np.column_stack((x, r * np.cos(phi), r * np.sin(phi)))


@cache
def pearls():
    """The point A2 of the paper."""
    branch = family_branch(Tube(0.0, L), "pearl", (1, 0), branch_options({"lambda2": -3.165}))
    assert branch.complete, branch.reason
    return branch.points[-1]


@cache
def settled():
    """The flow to rest of pearls on a mesh, perturbed by a bump at the same area and volume."""
    start = mesh_start(pearls(), 250)
    return flow(start.problem, start.perturbed("bump", -0.125, keep=True), QUICK)


def somewhere(problem, count, seed=0):
    """A smooth displacement and a rate."""
    x, phi = problem.places(np.zeros(count))
    k = 2 * np.pi * x / L
    return 0.1 * np.cos(k) * np.cos(phi) + 0.05 * np.sin(2 * k), 0.3 * np.sin(k + phi) + 0.2 * np.cos(2 * phi)


@pytest.mark.parametrize("law", ["area and volume", "area"])
@pytest.mark.parametrize("kind", KINDS)
def test_matrices_are_derivatives_of_what_they_stand_for(kind, law):
    problem = mesh_flow(tube_mesh(L, 150), 0.3, kind, law, pressure=0.4)
    q, way = somewhere(problem, problem.reference.mesh.count)
    lambdas = np.array([0.4, 0.3])[: len(problem.constraints(q))]
    zero, h = np.zeros_like(q), 1e-5
    forces = [problem.residual(q + s * h * way, zero, lambdas) for s in (1, -1)]
    np.testing.assert_allclose(
        (forces[0] - forces[1]) / (2 * h), problem.jacobian(q, zero, lambdas, 0.0) @ way, atol=1e-7
    )
    rows = [problem.constraints(q + s * h * way) for s in (1, -1)]
    np.testing.assert_allclose((rows[0] - rows[1]) / (2 * h), problem.constraint_rows(q) @ way, atol=1e-9)
    moving = problem.residual(q, way, lambdas) - problem.residual(q, zero, lambdas)
    np.testing.assert_allclose(moving, problem.metric(q) @ way, atol=1e-14)
    np.testing.assert_allclose(
        problem.jacobian(q, zero, lambdas, 2.0) @ way,
        problem.jacobian(q, zero, lambdas, 0.0) @ way + 2 * moving,
        atol=1e-12,
    )
    np.testing.assert_allclose(problem.resistance(q, moving), way, atol=1e-9)
    np.testing.assert_allclose(problem.velocity(q, problem.moved_by(q, way)), way, atol=1e-10)
    unit = np.zeros_like(lambdas)
    for k in range(len(unit)):
        unit[:] = 0.0
        unit[k] = 1.0
        by = problem.residual(q, zero, lambdas + unit) - problem.residual(q, zero, lambdas)
        np.testing.assert_allclose(by, problem.columns(q)[:, k], atol=1e-13)


@pytest.mark.parametrize(("kind", "order"), [("subdivision", 4), ("cotangent", 2)])
def test_waves_on_the_straight_tube_decay_as_the_dispersion_relation_has_it(kind, order):
    """The rate of a small wave on a discrete straight tube, from the flow's force, is ``theory``'s to the mesh's order."""
    c0, m, n, errors = 0.2, 1, 2, []
    for nodes in (300, 1200):
        found, u = branch_point(tube_mesh(L, nodes), c0, 1, 0, kind)  # a discrete straight tube
        problem = mesh_flow(found.mesh.moved(found.vertices(u)), c0, kind)
        x, phi = problem.places(np.zeros(found.mesh.count))
        wave = np.cos(2 * np.pi * m * x / L) * np.cos(n * phi)
        h, zero = 1e-4, np.zeros(len(wave))
        lifted = problem.moved_by(zero, wave)
        forces = [problem.residual(s * h * lifted, zero, u[-3:-1]) for s in (1, -1)]
        speed = problem.velocity(zero, -problem.resistance(zero, (forces[0] - forces[1]) / (2 * h)))
        errors.append((speed @ wave) / (wave @ wave) / growth_rate(2 * np.pi * m / L, n, float(u[-2]), c0) - 1)
    assert abs(errors[1]) < 0.02
    assert abs(errors[1]) < 1.3 * abs(errors[0]) / 2**order


@pytest.mark.parametrize(("kind", "order"), [("subdivision", 4), ("cotangent", 2)])
def test_flows_as_the_graph_does_the_better_the_finer(kind, order):
    """Energy, volume and neck of an axisymmetric shape at two times, on two meshes, against the spectral flow of graphs."""
    x, times = np.linspace(0, L, 129), (0.02, 0.2)
    names = ["E", "r_min", "r_max"]
    graph, q = profile_start(0.0, L, x, np.hypot(*bulged(x, 0 * x)[:, 1:].T))
    exact = [flow(graph, q, FlowOptions(until=t)).table().iloc[-1] for t in times]
    exact = np.array([row[names].to_numpy(float) for row in exact])
    errors = []
    for nodes in (200, 400):
        problem, start = surface_start(0.0, tube_mesh(L, nodes, bulged), kind=kind)
        results = [flow(problem, start, replace(QUICK, until=t)) for t in times]
        for result in results:
            assert result.largest_rise() <= 1e-9
            assert result.table()[["area_error", "volume_error"]].abs().to_numpy().max() < 1e-10
        found = np.array([result.table().iloc[-1][names].to_numpy(float) for result in results])
        errors.append(np.abs(found / exact - 1).max())
    assert errors[1] < 1e-2
    assert errors[1] < 1.5 * errors[0] / 2 ** (order / 2)


def test_pearls_come_back_to_their_equilibrium():
    result = settled()
    assert result.status == "steady", result.reason
    table = result.table()
    assert result.largest_rise() <= 1e-9
    assert table[["area_error", "volume_error"]].abs().to_numpy().max() < 1e-10
    assert result.equilibrium.converged
    assert result.equilibrium.stable
    found, exact = result.equilibrium.observables, pearls().observables
    assert found["area"] == pytest.approx(1.0, abs=1e-12)
    assert table["E"].iloc[-1] == pytest.approx(found["E"], abs=1e-7)
    for name in (
        "E",
        "lambda1",
        "lambda2",
        "r_min",
        "r_max",
        "M",
        "force",
    ):  # the perturbed shape has the branch's area and volume
        assert found[name] == pytest.approx(exact[name], rel=1e-2), name


def test_the_end_is_that_of_newton_s_method_on_the_same_mesh():
    """The flow's end and what the branches' Newton method finds at that ``v``, from another guess, agree to 1e-8."""
    start = mesh_start(pearls(), 250)
    still = replace(start.problem.reference, adapt=AdaptOptions(stretched=50, worst=50))  # one mesh for all
    start = replace(start, problem=replace(start.problem, reference=still))
    x, _ = start.problem.places(start.q)
    wave = 0.02 * np.cos(4 * np.pi * x / L)  # even along the tube, so that nothing drifts
    q = constrained(start.problem, start.q + start.problem.moved_by(start.q, wave), start.problem.constraints(start.q))
    result = flow(start.problem, q, replace(QUICK, velocity=1e-5))
    assert result.equilibrium.problem is start.problem
    found = result.equilibrium.observables
    assert found["E"] < result.table()["E"].iloc[0] - 1e-4
    guess = [np.zeros(len(q)), [found["lambda1"] + 1e-3, found["lambda2"] - 1e-3, found["v"]]]
    tube, u = with_phases(start.problem.reference, np.concatenate(guess))
    u = solved(tube, u)
    again = tube.observables(u)
    for name in ("E", "lambda1", "lambda2", "r_min"):
        assert again[name] == pytest.approx(found[name], rel=1e-8), name
    assert tube.spectrum(u).mu_crit == pytest.approx(result.equilibrium.growth_rates[0], rel=1e-6)


def test_the_velocity_decays_at_the_leading_growth_rate():
    """Perturbed along an eigenvector that no rigid motion mixes with, the flow's decay is that eigenvector's."""
    start = mesh_start(pearls(), 400)
    rates, vectors = start.problem.growth_rates(start.q, start.multipliers)
    q = start.q + 0.01 * vectors[:, 0] / np.abs(vectors[:, 0]).max()
    table = flow(start.problem, q, FlowOptions(until=1.0)).table()
    late = table[(table["t"] > 0.1) & (table["t"] < 0.8)]
    slope = np.polyfit(late["t"], np.log(late["velocity"]), 1)[0]
    assert slope == pytest.approx(rates[0], rel=1e-2)


def test_remeshing_keeps_area_and_volume_and_moves_the_energy_by_the_mesh_s_error_only():
    problem, q = surface_start(0.0, tube_mesh(L, 200, bulged))
    eager = replace(problem.reference.adapt, steepest=1 - 1e-6)  # the same triangles, new directions
    mesh = problem.reference.mesh
    result = flow(mesh_flow(mesh, 1.0, adapt=eager), q, FlowOptions(until=0.1))
    assert (result.table()["t"].diff() == 0).sum() >= 1
    assert result.largest_jump() < 1e-14 > result.largest_rise()
    jumps = []
    for nodes in (200, 400):
        problem, q = surface_start(0.0, tube_mesh(L, nodes, bulged))
        spread = replace(AdaptOptions(), stretched=0.99 * float(problem.mesh(q).quality.max()))
        result = flow(mesh_flow(problem.reference.mesh, 0.0, adapt=spread), q, FlowOptions(until=0.02))
        table = result.table()
        again = table["t"].diff() == 0
        assert again.sum() >= 1
        assert table["area_error"].abs().max() < 1e-10 > table["volume_error"].abs().max()
        assert result.largest_rise() <= 1e-9
        jumps.append(result.largest_jump())
    assert jumps[1] < jumps[0] / 2
    assert jumps[0] < 1e-3


def test_a_killed_run_goes_on_from_its_checkpoint(tmp_path):
    problem, q = surface_start(0.2, tube_mesh(L, 200, bulged), law="area", pressure=-3.0)
    whole = flow(problem, q, FlowOptions(until=0.2))
    half = flow(problem, q, FlowOptions(until=0.1))
    save(half.state, tmp_path / "f.h5")
    state = load(tmp_path / "f.h5")
    np.testing.assert_array_equal(state.q, half.state.q)
    assert (state.problem.law, state.problem.pressure, state.problem.reference.c0) == ("area", -3.0, 0.2)
    assert len(state.record.frames) == len(half.state.record.frames)
    on = resumed(state, FlowOptions(until=0.2))
    x = np.linspace(0, L, 129)
    graph = profile_start(0.2, L, x, np.hypot(*bulged(x, 0 * x)[:, 1:].T), law="area", pressure=-3.0)
    exact = flow(*graph, FlowOptions(until=0.2)).table().iloc[-1]
    # An extreme radius lies beside another sample where two are nearly as extreme: it jumps by the error of radii.
    for name, error in {"E": 1e-6, "v": 1e-6, "r_min": 2e-4}.items():
        assert on.table()[name].iloc[-1] == pytest.approx(whole.table()[name].iloc[-1], rel=error), name
        assert on.table()[name].iloc[-1] == pytest.approx(exact[name], rel=5e-3), name
    wrong = flow(replace(graph[0], pressure=3.0), graph[1], FlowOptions(until=0.2)).table().iloc[-1]
    assert abs(wrong["E"] / exact["E"] - 1) > 5e-2  # the comparison sees the pressure


def test_at_given_pressure_spectra_are_those_of_pearls():
    """Growth rates at fixed area alone, on a mesh and by Bloch waves on the profile."""
    at = pearls()
    start = mesh_start(at, 500, law="area")
    exact = replace(at.problem, held=Held(volume=False)).spectrum(at.u)
    assert start.problem.growth_rates(start.q, start.multipliers)[0][0] == pytest.approx(exact.mu_crit, rel=1e-2)
    assert start.problem.pressure == pytest.approx(at.observables["lambda2"], rel=2e-3)


def test_starts_from_files_and_from_branches_on_meshes(tmp_path):
    problem, u = meshed(pearls(), 300)
    write_mesh(problem.surface(u), tmp_path / "a2.vtu")
    found, q = surface_start(0.0, read_mesh(tmp_path / "a2.vtu", L))
    exact = problem.observables(u)
    seen = found.observables(q, np.zeros(2))
    for name in ("E", "v", "r_max"):
        assert seen[name] == pytest.approx(exact[name], rel=2e-3), name
    with pytest.raises(InputError, match="^law: 'drag' is unknown; choose one of area and volume"):
        surface_start(0.0, problem.surface(u), law="drag")


def test_bad_starts_and_necks_are_named():
    straight, q = surface_start(0.0, tube_mesh(L, 200))
    with pytest.raises(InputError, match="straight tube"):
        flow(straight, q)

    def necked(x, phi):
        r = 1 + 0.87 * np.cos(2 * np.pi * x / L)
        return np.column_stack((x, r * np.cos(phi), r * np.sin(phi)))

    problem, q = surface_start(0.0, tube_mesh(L, 200, necked))
    with pytest.raises(InputError, match=r"neck at x = .*vertex .* radius of 0.13"):
        flow(problem, q)
    problem, q = surface_start(1.5, tube_mesh(L, 200, lambda x, phi: bulged(x, phi) * (1, 0.8, 0.8)))
    result = flow(problem, q, QUICK)
    assert result.status == "pinch"
    assert "neck at x" in result.reason
    assert "more nodes" in result.advice
    assert len(result.table()) > 10


def test_the_end_becomes_a_branch():
    """From the flow's last shape on, at its own area, to another volume; saved and resumed; against the pearls of collocation."""
    result = settled()
    assert described(result.equilibrium) == f"a triangulated tube of {len(result.state.q)} nodes"
    branch = continued(result, branch_options({"v": 1.16}), upwards=False)
    assert branch.complete, branch.reason
    exact = family_branch(Tube(0.0, L), "pearl", (1, 0), branch_options({"v": 1.16})).points[-1]
    for name, error in (("E", 2e-3), ("lambda1", 1e-2), ("lambda2", 1e-2), ("r_min", 1e-2)):
        assert branch.points[-1].observables[name] == pytest.approx(exact.observables[name], rel=error), name
    assert branch.points[-1].spectrum.n_unstable == exact.spectrum.n_unstable == 0


def test_an_end_of_another_area_is_similar_to_a_point_of_a_branch():
    """A shape twice as large rests as the small one does: all numbers scale by powers of two."""
    end = settled().equilibrium
    flow_, mesh = end.problem, end.problem.reference.mesh
    twice = replace(mesh, vertices=2 * flow_.vertices(end.q), length=2 * L)
    lambdas = end.multipliers / (4, 8)
    large = replace(end, problem=mesh_flow(twice, 0.0), q=np.zeros(mesh.count), multipliers=lambdas)
    one, two = (problem.observables(u) for problem, u in map(solution_of, (end, large)))
    assert two["L"] == pytest.approx(L, rel=1e-12)
    for name in ("v", "E", "lambda1", "lambda2", "r_min"):
        assert two[name] == pytest.approx(one[name], rel=1e-6), name
