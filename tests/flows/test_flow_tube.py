"""The flow of tubes without symmetry: its matrices against another assembly, its ends against branches of symmetric tubes."""

from functools import cache

import numpy as np
import pytest
from support.sums import Basis, grid, second_variation

from pearlbvp.errors import InputError
from pearlbvp.flows.axisymmetric import GraphFlow
from pearlbvp.flows.driver import FlowOptions, flow, resumed
from pearlbvp.flows.tube import TubeFlow
from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.flow import load, save
from pearlbvp.studies.flow_start import pearl_tube_start, tube_start
from pearlbvp.theory.dispersion import growth_rate
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.torus import TorusFunction

MULTIPLIERS = np.array([0.4, 0.3])
COARSE = FlowOptions(resolution=1e-3, max_seconds=60)


def modes_of(size):
    """All modes up to some wave numbers, in an order of their own."""
    around = range(2, size[1] + 1)
    sections = [("sigma", b, "cos") for b in (0, *around)] + [("sigma", b, "sin") for b in around]
    sections += [("y", 0, "cos"), ("z", 0, "cos")]
    along = [(p, "cos") for p in range(size[0] + 1)] + [(p, "sin") for p in range(1, size[0] + 1)]
    return [Mode(part, p, f, b, g) for p, f in along for part, b, g in sections]


def random_tube(size, scale=0.03, seed=1):
    problem = TubeFlow(0.3, 9.0, size)
    values = np.random.default_rng(seed).normal(size=len(modes_of(size))) * scale
    values[0] = 1.0
    return problem, problem.coordinates(modes_of(size), values, 2 * np.pi / 9), values


@cache
def tubes(c0, family, name, value):
    branch = family_branch(
        Tube(c0, 10.0),
        family,
        (0, 2) if family == "ring" else (1, 1),
        branch_options({name: value}),
        discretization="modes",
    )
    assert branch.complete, branch.reason
    return branch.points[-1]


def settled(point, size):
    return tube_start(point.problem, point.u, size=size)


def check(result):
    table = result.table()
    assert result.largest_rise() <= 1e-9
    assert table["area_error"].abs().max() <= 1e-10
    assert table["volume_error"].abs().max() <= 1e-10
    return table


def test_fields_and_matrices_are_those_of_the_modes_one_by_one():
    problem, q, values = random_tube((3, 4))
    assert problem.known(q) == dict(zip(modes_of((3, 4)), values, strict=True))
    basis = Basis.of(problem.modes, 2 * np.pi / 9, 0.0, *grid(problem.cell.points, 9.0))
    fields = basis.state(q)
    np.testing.assert_allclose(problem.waves.state(problem.cell, q), fields, atol=1e-13)
    second, mass, constraints = second_variation(basis, fields, 0.3, *MULTIPLIERS)
    np.testing.assert_allclose(problem.jacobian(q, 0 * q, MULTIPLIERS, 0.0), second, atol=1e-11)
    np.testing.assert_allclose(problem.jacobian(q, 0 * q, MULTIPLIERS, 2.0), second + 2 * mass, atol=1e-11)
    np.testing.assert_allclose(problem.constraint_rows(q), constraints, atol=1e-13)


def test_the_jacobian_is_the_residuals():
    problem, q, _ = random_tube((2, 3))
    rate, step = np.random.default_rng(2).normal(size=q.size) * 0.1, 1e-6
    numeric = np.array([
        problem.residual(q + step * e, rate + 0.7 * step * e, MULTIPLIERS)
        - problem.residual(q - step * e, rate - 0.7 * step * e, MULTIPLIERS)
        for e in np.eye(q.size)
    ]).T / (2 * step)  # fmt: skip
    exact = problem.jacobian(q, rate, MULTIPLIERS, 0.7)
    np.testing.assert_allclose(exact, numeric, atol=1e-8 * np.abs(exact).max())


def test_rates_on_the_cylinder_are_those_of_the_dispersion_relation():
    c0, lambda2, length = 0.3, 0.2, 10.0
    problem = TubeFlow(c0, length, (4, 4))
    q = problem.coordinates([Mode("sigma", 0)], np.ones(1), 1.0)
    rates, _ = problem.growth_rates(q, np.array([0.25 - lambda2 - c0**2, lambda2]), 30)
    k = 2 * np.pi / length * np.arange(5)
    expected = []
    for n in range(5):
        for m in range(5):
            if (m, n) not in ((0, 0), (0, 1)):  # fixed volume; shifts
                expected += [float(growth_rate(k[m], n, lambda2, c0))] * ((1 if m == 0 else 2) * (1 if n == 0 else 2))
    np.testing.assert_allclose(rates, np.sort(expected)[::-1][:30], rtol=1e-8)


def test_rigid_motions_change_nothing():
    problem, q, _ = random_tube((14, 14), scale=0.0)
    few = [
        Mode("sigma", 1),
        Mode("sigma", 1, "sin", 2),
        Mode("sigma", 0, "cos", 3, "sin"),
        Mode("y", 1),
        Mode("z", 1, "sin"),
    ]
    q = q + problem.coordinates(few, np.array([0.1, 0.05, 0.03, 0.2, -0.15]), 2 * np.pi / 9)
    motions = problem.kernels(q, np.zeros(2))
    motions /= np.linalg.norm(motions, axis=1)[:, None]
    gradients = np.array([problem.residual(q, 0 * q, np.array(m)) for m in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))])
    assert np.abs(gradients).max() > 1e-2
    assert np.abs(gradients @ motions.T).max() < 1e-9


def test_axisymmetric_shapes_flow_as_they_do_as_graphs():
    """Two discretizations that share nothing but the driver, at the same times."""
    graph = GraphFlow(0.0, 10.0, 96)
    k = 2 * np.pi * graph.x / 10
    r = 1 + 0.25 * np.cos(k) + 0.05 * np.sin(2 * k)
    tube = TubeFlow(0.0, 10.0, (16, 2))
    ends = []
    for problem, q in ((graph, graph.coordinates(r)), (tube, tube.of_radii(graph.x, r))):
        result = flow(problem, q, FlowOptions(until=0.3, rtol=1e-8, atol=1e-10, resolution=1e-5))
        assert result.status == "time"
        ends.append(result.table().iloc[-1])
    for name in ("E", "lambda1", "lambda2", "velocity"):
        assert ends[0][name] == pytest.approx(ends[1][name], rel=1e-4, abs=1e-6), name
    assert ends[0]["E"] == pytest.approx(ends[1]["E"], rel=1e-8)


def test_a_coil_flows_back_to_the_coil_of_its_area_and_volume():
    """Table ptab1, B, at a larger amplitude."""
    start = settled(tubes(0.0, "coil", "v", 0.9), (10, 10))
    assert start.problem.growth_rates(start.q, start.multipliers)[0][0] == pytest.approx(
        tubes(0.0, "coil", "v", 0.9).spectrum.mu_crit, rel=1e-5
    )
    result = start.flow(start.perturbed("bump", -0.1), COARSE)
    assert result.status == "steady"
    check(result)
    end = result.equilibrium.observables
    scale = end["area"]
    branch = family_branch(Tube(0.0, 10.0 / scale), "coil", (1, 1), branch_options({"v": end["v"] / scale**2}))
    there = branch.points[-1].observables
    assert end["lambda1"] * scale**2 == pytest.approx(there["lambda1"], abs=1e-8)
    assert end["lambda2"] * scale**3 == pytest.approx(there["lambda2"], abs=1e-8)
    assert end["E"] * scale**2 == pytest.approx(there["E"], abs=1e-8)
    assert end["M"] / scale == pytest.approx(there["M"], abs=1e-7)
    assert end["force"] * scale == pytest.approx(there["force"], abs=1e-7)


def test_an_unstable_buckle_flows_to_the_coil():
    """Table ptab1, C*: along the most unstable vector, at the buckle's own area and volume."""
    point = tubes(0.0, "buckle", "v", 0.96)
    start = settled(point, (8, 8))
    result = start.flow(start.perturbed("critical", 0.3, keep=True), COARSE)
    assert result.status == "steady"
    table = check(result)
    assert table["E"].iloc[-1] < point.observables["E"]
    coil = tubes(0.0, "coil", "v", 0.96).observables
    for name in ("lambda1", "lambda2", "E"):
        assert result.equilibrium.observables[name] == pytest.approx(coil[name], abs=1e-8)


def test_an_unstable_coil_flows_to_wrinkles():
    """Fig. cmf2 (b): ``c0 = -1``."""
    start = settled(tubes(-1.0, "coil", "v", 0.95), (6, 16))
    result = start.flow(start.perturbed("bump", -0.25), COARSE)
    assert result.status == "steady"
    check(result)
    end = result.equilibrium.observables
    scale = end["area"]
    options = branch_options({"v": end["v"] / scale**2})
    ring = (
        family_branch(Tube(-scale, 10.0 / scale), "ring", (0, 2), options, discretization="modes")
        .points[-1]
        .observables
    )
    assert end["E"] * scale**2 == pytest.approx(ring["E"], abs=1e-8)
    assert end["lambda2"] * scale**3 == pytest.approx(ring["lambda2"], abs=1e-8)


def test_pearls_among_tubes_have_the_rates_of_all_their_blocks():
    branch = family_branch(Tube(0, 10), "pearl", (1, 0), branch_options({"lambda2": -1.6}))
    point = branch.points[-1]
    start = pearl_tube_start(point.problem, point.u, size=(16, 3))
    blocks = [
        rate for block, rates in point.spectrum.rates.items() for rate in np.repeat(rates, block.multiplicity)
    ]  # fmt: skip
    rates, _ = start.problem.growth_rates(start.q, start.multipliers)
    np.testing.assert_allclose(rates, np.sort(blocks)[::-1][:6], rtol=1e-5)


def test_radii_are_those_of_the_function_and_not_of_a_grid():
    """Against collocation's extremes, on a grid whose points miss the neck."""
    point = family_branch(Tube(0, 10), "pearl", (1, 0), branch_options({"v": 1.1})).points[-1]
    start = pearl_tube_start(point.problem, point.u, size=(17, 3))
    problem = start.problem
    q = problem.packed(TorusFunction.of(problem.known(start.q)).moved(0.7, 0.0).modes())
    found = problem.observables(q, start.multipliers)
    for name in ("r_min", "r_max", "amplitude"):
        assert found[name] == pytest.approx(point.observables[name], abs=1e-9)
    assert problem.waves.state(problem.cell, q, range(3, 4)).min() > found["r_min"] + 1e-5


def test_waves_are_added_saved_and_drawn(tmp_path):
    start = settled(tubes(0.0, "coil", "v", 0.9), (5, 5))
    smallest = TubeFlow(0.0, 10.0, (1, 2))
    assert smallest.resolution(smallest.packed({Mode("sigma", 0): 1.0, Mode("y", 1): 0.1})) == 0.1
    finer, q = start.problem.refined(start.q)
    assert finer.size[0] > 5
    for name, value in start.problem.observables(start.q, MULTIPLIERS).items():
        assert finer.observables(q, MULTIPLIERS)[name] == pytest.approx(value, abs=2e-3 if name[0] in "ar" else 1e-6)
    _, y, z = start.problem.surface(start.q, along=161, around=97)
    # A coil's sections turn with it: a quarter of a period on, all is turned by a quarter.
    np.testing.assert_allclose((y + 1j * z)[40, 24], 1j * (y + 1j * z)[0, 0], rtol=1e-6)
    half = start.flow(start.perturbed("bump", -0.05), FlowOptions(max_steps=8, resolution=1e-2))
    save(half.state, tmp_path / "f.h5")
    state = load(tmp_path / "f.h5")
    assert resumed(state, FlowOptions(until=2 * state.t, resolution=1e-2)).status == "time"


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda: TubeFlow(0.0, 10.0, (4, 1)), "size"),
        (lambda: TubeFlow(0.0, 10.0, (4, 4), "drag"), "law"),
        (lambda: flow(TubeFlow(0.0, 10.0, (4, 4)), np.eye(1, 81)[0]), "q"),
        (lambda: settled(tubes(0.0, "coil", "v", 0.9), (1, 2)), "size"),
    ],
)
def test_mistakes(call, name):
    with pytest.raises(InputError, match=f"^{name}: "):
        call()
