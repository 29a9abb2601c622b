"""The flow of axisymmetric shapes: its equation, its rates, its ends, each against a second way."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.sparse import csc_matrix
from support.graphs import Graphs

from pearlbvp.errors import InputError
from pearlbvp.flows.axisymmetric import GraphFlow
from pearlbvp.flows.driver import FlowOptions, constrained, flow, resumed
from pearlbvp.flows.perturbation import displaced
from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.flow import load, save
from pearlbvp.studies.flow_end import continued, pearls_of, stability
from pearlbvp.studies.flow_start import pearl_start
from pearlbvp.studies.onward import switched
from pearlbvp.studies.point import chosen
from pearlbvp.studies.shape import shape_branch
from pearlbvp.theory.dispersion import growth_rate

LAWS = ("area and volume", "area", "diffusion")


def shape(problem, *sines):
    """A graph without symmetry."""
    k = 2 * np.pi * problem.x / problem.length
    r = 1 + 0.25 * np.cos(k) + 0.06 * np.cos(2 * k + 0.5) + 0.02 * np.sin(3 * k)
    return problem.coordinates(r + sum(a * np.sin((i + 1) * k) for i, a in enumerate(sines)))


def multipliers(problem):
    return np.array([0.4, 0.3])[: 2 if problem.law == "area and volume" else 1]


@cache
def pearls(c0, length, m, v):
    branch = family_branch(Tube(c0, length), "pearl", (m, 0), branch_options({"v": v}))
    assert branch.complete, branch.reason
    return branch


def start_at(branch, **options):
    point = branch.points[-1]
    return pearl_start(point.problem, point.u, **options)


def check(result, rise=1e-9, drift=1e-10):
    """What holds on every run: energy falls, area and volume stay."""
    table = result.table()
    assert result.largest_rise() <= rise
    assert table["area_error"].abs().max() <= drift
    assert table["volume_error"].abs().max() <= drift
    return table


def test_the_force_is_g_of_the_paper():
    """``Lap H + 2H(H^2 - K) + 2 c0 K - 2(c0^2 + lambda1) H - lambda2`` of the radius, by Fourier derivatives, is ``V_t``."""
    c0, (lambda1, lambda2) = 0.3, (0.4, 0.3)
    problem = GraphFlow(c0, 10.0, 128)
    q = shape(problem)
    r = np.sqrt(2 * q)
    d = problem.d1
    r1, r2 = d @ r, d @ (d @ r)
    s = np.sqrt(1 + r1**2)
    h, gauss = (1 / (r * s) - r2 / s**3) / 2, -r2 / (r * s**4)
    laplacian = (d @ (r / s * (d @ h))) / (r * s)
    force = laplacian + 2 * h * (h**2 - gauss) + 2 * c0 * gauss - 2 * (c0**2 + lambda1) * h - lambda2
    velocity = problem.velocity(q, problem.resistance(q, -problem.residual(q, 0 * q, np.array([lambda1, lambda2]))))
    np.testing.assert_allclose(velocity, force, atol=1e-6 * np.abs(force).max())


def test_energy_area_and_volume_are_those_of_graphs_in_the_radius():
    problem = GraphFlow(0.3, 10.0, 96)
    waves = [(0, 0, np.cos, np.cos), (1, 0, np.cos, np.cos), (2, 0, np.sin, np.cos)]
    graphs = Graphs.of(2 * np.pi / 10, 1, 0.3, waves, (96, 1))
    u = np.array([0.02, 0.3, 0.08])
    xi = np.arange(96) / 96 * 2 * np.pi
    q = problem.coordinates(1 + u @ [np.ones(96), np.cos(xi), np.sin(2 * xi)])
    found = problem.observables(q, multipliers(problem))
    (energy, *_), (area, *_), (volume, *_) = graphs.parts(u)
    assert found["E"] * found["area"] == pytest.approx(energy, rel=1e-11)
    assert (found["area"], found["volume"]) == pytest.approx((area, volume), rel=1e-11)


@pytest.mark.parametrize("law", LAWS)
def test_the_jacobian_is_the_residuals(law):
    problem = GraphFlow(0.3, 10.0, 24, law, 0.2)
    q, rate = shape(problem), 0.1 * np.cos(problem.x)
    lambdas, step = multipliers(problem), 1e-6
    numeric = np.array([
        problem.residual(q + step * e, rate + 0.7 * step * e, lambdas)
        - problem.residual(q - step * e, rate - 0.7 * step * e, lambdas)
        for e in np.eye(24)
    ]).T / (2 * step)  # fmt: skip
    exact = problem.jacobian(q, rate, lambdas, 0.7)
    np.testing.assert_allclose(exact, numeric, atol=1e-8 * np.abs(exact).max())
    for value, by in ((problem.constraints, problem.constraint_rows),):
        slope = np.array([value(q + step * e) - value(q - step * e) for e in np.eye(24)]).T / (2 * step)
        np.testing.assert_allclose(by(q), slope, atol=1e-9)


@pytest.mark.parametrize("law", LAWS)
def test_rates_on_the_cylinder_are_those_of_the_dispersion_relation(law):
    c0, lambda2 = 0.3, 0.2
    problem = GraphFlow(c0, 10.0, 32, law, lambda2)
    lambdas = np.array([0.25 - lambda2 - c0**2, lambda2])[: len(multipliers(problem))]
    rates, _ = problem.growth_rates(problem.coordinates(np.ones(32)), lambdas)
    k = 2 * np.pi / 10 * np.arange(1, 4)
    expected = growth_rate(k, 0, lambda2, c0) * (k**2 if law == "diffusion" else 1)
    np.testing.assert_allclose(rates, np.repeat(np.sort(expected)[::-1], 2), rtol=1e-9)


def test_rates_on_a_pearl_are_those_of_its_second_variation():
    branch = pearls(0.48, 15, 2, 1.02)
    start = start_at(branch)
    spectrum = branch.points[-1].spectrum
    expected = np.sort(np.concatenate([rates for block, rates in spectrum.rates.items() if block.n == 0]))[::-1]
    np.testing.assert_allclose(start.problem.growth_rates(start.q, start.multipliers)[0][:4], expected[:4], rtol=1e-7)


def test_a_bump_on_pearls_flows_to_the_pearls_of_its_area_and_volume():
    """Table ptab1, A2, without the bump's ``cos(phi)``."""
    point = chosen(family_branch(Tube(0, 10), "pearl", (1, 0), branch_options({"lambda2": -3.3})), "A2")
    assert point.observables["lambda2"] == pytest.approx(-3.165, abs=1e-10)
    start = pearl_start(point.problem, point.u)
    result = start.flow(start.perturbed("bump", -0.125))
    assert result.status == "steady"
    check(result)
    problem, u = pearls_of(result.equilibrium)
    end = problem.observables(u)
    there = family_branch(Tube(0, end["L"]), "pearl", (1, 0), branch_options({"v": end["v"]})).points[-1].observables
    for name in ("lambda1", "lambda2", "E", "r_min"):
        assert end[name] == pytest.approx(there[name], abs=1e-8)
    scale = result.equilibrium.observables["area"]
    assert result.equilibrium.observables["lambda2"] * scale**3 == pytest.approx(there["lambda2"], abs=1e-8)
    assert result.equilibrium.observables["M"] / scale == pytest.approx(there["M"], abs=1e-7)
    assert result.equilibrium.observables["force"] * scale == pytest.approx(there["force"], abs=1e-7)
    assert result.table()["force"].iloc[-1] == pytest.approx(result.equilibrium.observables["force"], abs=1e-3)
    assert result.equilibrium.growth_rates[0] == pytest.approx(
        max(r[0] for b, r in problem.spectrum(u).rates.items() if b.n == 0) / scale**4, rel=1e-6
    )


def test_a_flow_decays_at_its_growth_rate():
    problem = GraphFlow(0.0, 10.0, 64)
    result = flow(problem, shape(problem), FlowOptions(rtol=1e-8, atol=1e-11))
    slow, next_one = result.equilibrium.growth_rates[:2]
    table = result.table()
    late = table[(table["velocity"] < 1e-3)]
    # The two slowest modes, of rates close to each other: the velocity's logarithm has a slope between them.
    slope = np.polyfit(late["t"], np.log(late["velocity"]), 1)[0]
    assert next_one < slow < 0
    assert slope == pytest.approx(slow, rel=0.01)


def test_surface_diffusion_decays_at_its_own_rate_and_says_where_it_is_refined():
    """The rate at the end against the velocity in the table; a refinement is a second row at the same time."""
    start = start_at(pearls(0.0, 10, 1, 1.1), law="diffusion")
    result = start.flow(start.perturbed("bump", -0.02, centre=1.0), FlowOptions(rtol=1e-8, atol=1e-11))
    assert result.status == "steady"
    table = check(result)
    (refined,) = np.flatnonzero(np.diff(table["t"]) == 0)
    late = table[: refined + 1]
    late = late[late["velocity"] < 1e-5]
    slope = np.polyfit(late["t"], np.log(late["velocity"]), 1)[0]
    assert slope == pytest.approx(result.equilibrium.growth_rates[0], rel=0.01)
    assert f"rate is {result.equilibrium.growth_rates[0]:.3g}" in result.reason
    # The first shape on more points is the same one, with its finest waves in the velocity.
    assert table["E"][refined + 1] == pytest.approx(table["E"][refined], rel=1e-7)
    assert table["velocity"][refined + 1] > 1e3 * table["velocity"][refined]
    assert 0 < result.largest_jump() < 1e-7


@pytest.mark.parametrize(("length", "m"), [(15, 2), (30, 4)])
def test_periodic_pearls_flow_to_the_localized_pearl(length, m):
    """Fig. c05f2, and the flow at L = 30 that the paper calls very expensive."""
    branch = pearls(0.48, length, m, 1.02)
    start = start_at(branch)
    result = start.flow(start.perturbed("critical", 0.02, keep=True))
    assert result.status == "steady"
    check(result)
    problem, u = pearls_of(result.equilibrium)
    end = problem.observables(u)
    localized = switched(branch, 1, branch_options({"v": 1.02}))
    assert localized.complete, localized.reason
    assert stability(result.equilibrium).mu_crit == pytest.approx(localized.points[-1].spectrum.mu_crit, rel=1e-4)
    there = localized.points[-1].observables
    assert end["lambda2"] == pytest.approx(there["lambda2"], abs=1e-8)
    assert end["E"] == pytest.approx(there["E"], abs=1e-9)


def test_c0_075_flows_to_two_unequal_pearls():
    """Fig. c1f1 (c): from the branch A, above its fold, to the branch P; and the branch goes on from there."""
    branch = pearls(0.75, 10, 1, 1.03)
    start = start_at(branch)
    result = start.flow(start.perturbed("critical", 0.05, keep=True))
    assert result.status == "steady"
    check(result)
    end = result.equilibrium.observables
    there = shape_branch(0.75, 10, 1.0, [-0.28, 0.47], branch_options({"v": 1.03})).points[-1].observables
    assert end["v"] == pytest.approx(1.03, abs=1e-9)
    assert end["lambda2"] == pytest.approx(there["lambda2"], abs=1e-8)
    onwards = continued(result, branch_options({"v": 1.035}))
    assert onwards.complete
    assert onwards.points[-1].spectrum.n_unstable == 0


def test_three_flows_and_where_they_end():
    ends = {}
    for law in ("area and volume", "diffusion"):
        problem = GraphFlow(0.0, 10.0, 64, law)
        ends[law] = flow(problem, shape(problem))
        assert ends[law].status == "steady"
        check(ends[law])
    both = [ends[law].equilibrium.observables for law in ends]
    for name in ("lambda1", "lambda2", "E", "r_max"):
        assert both[0][name] == pytest.approx(both[1][name], abs=1e-9)
    problem = GraphFlow(0.0, 10.0, 64, "area", -0.5)
    result = flow(problem, shape(problem))
    table = result.table()
    # At given pressure the straight tube of this area is stable: E + lambda2 V falls, not E.
    volume = (1 + table["volume_error"]) * problem.observables(shape(problem), multipliers(problem))["volume"]
    area = problem.constraints(shape(problem))[0]
    falling = table["E"] * area + problem.pressure * volume
    assert np.diff(falling).max() < 1e-9
    radius = area
    assert result.status == "steady"
    assert result.equilibrium.observables["lambda1"] == pytest.approx(1 / (4 * radius**2) + 0.5 * radius, abs=1e-8)
    assert table["volume_error"].abs().max() > 1e-3


def test_a_flow_onto_the_straight_tube_ends_there():
    """Area and volume of the straight tube: the constraints are parallel where the flow ends."""
    problem = GraphFlow(0.0, 10.0, 64)
    k = 2 * np.pi * problem.x / 10
    q = constrained(problem, 0.5 + 0.1 * np.cos(k) + 0.098 * np.cos(2 * k + 0.3), np.array([1.0, 0.5]))
    result = flow(problem, q)
    table = check(result)
    assert result.status == "steady"
    assert table["amplitude"].iloc[-1] < 1e-5
    end = table.iloc[-1]
    assert end["lambda1"] == pytest.approx(0.25 - end["lambda2"], abs=1e-4)  # the cylinder's relation, c0 = 0
    assert end["E"] == pytest.approx(0.25, abs=1e-9)


def test_the_exact_cylinder_is_refused():
    problem = GraphFlow(0.0, 10.0, 64)
    with pytest.raises(InputError, match="^q: .*perturb"):
        flow(problem, problem.coordinates(np.ones(64)))


def test_a_flow_from_near_constant_mean_curvature():
    """An unduloid's gradients of area and volume are parallel: multipliers of 10^3 and beyond, and the flow goes on."""
    problem = GraphFlow(0.3, 6.082634831, 64)
    k = 2 * np.pi * problem.x / problem.length
    q, area = 0.5 + 0.2 * np.cos(k), 0.0
    for _ in range(30):  # stationary area at fixed volume and amplitude of the wave, by Gauss-Newton
        variation = problem._variations(q)[1][1]
        matrix = problem._second(q, 1.0) - problem._second(q, 0.0)
        rows = np.vstack((np.cos(k) * 2 / 64, np.sin(k), np.ones(64)))
        residual = np.concatenate((variation - area, rows @ q - [0.2, 0.0, 32.0]))
        big = np.block([[matrix, -np.ones((64, 1))], [rows, np.zeros((3, 1))]])
        step = np.linalg.lstsq(big, residual, rcond=1e-14)[0]
        q, area = q - step[:64], area - step[64]
    assert np.abs(problem._variations(q)[1][1] - area).max() < 1e-7
    result = flow(problem, q + 1e-6 * np.cos(2 * k + 0.4))
    table = check(result)
    assert table["lambda1"].abs().max() > 1e3
    assert result.status == "steady"


def test_pinch_overhang_time_and_caps_are_said():
    problem = GraphFlow(2.0, 12.0, 96, thinnest=0.4)
    k = 2 * np.pi * problem.x / 12
    q = problem.coordinates(1 + 0.4 * np.cos(k) + 0.1 * np.cos(2 * k))
    pinch = flow(problem, q)
    assert pinch.status == "pinch"
    check(pinch)
    assert "neck at x" in pinch.reason
    assert pinch.advice
    assert pinch.table()["r_min"].iloc[-1] < 0.4 < pinch.table()["r_min"].iloc[-2]
    overhang = flow(replace(problem, thinnest=0.01, steepest=1.0), q)
    assert overhang.status == "overhang"
    timed = flow(problem, q, FlowOptions(until=1e-3))
    assert (timed.status, timed.state.t) == ("time", 1e-3)
    assert flow(problem, q, FlowOptions(max_steps=5)).status == "steps"
    assert flow(problem, q, FlowOptions(max_seconds=1e-6)).status == "seconds"
    with pytest.raises(InputError, match="^q: .*neck"):
        flow(replace(problem, thinnest=0.9), q)


class Sparse(GraphFlow):
    """Hands its Jacobian over as a sparse matrix, as a triangulated surface does."""

    def jacobian(self, q, rate, lambdas, factor):
        return csc_matrix(super().jacobian(q, rate, lambdas, factor))

    def metric(self, q):
        return csc_matrix(super().metric(q))


def test_sparse_jacobians_flow_the_same_way():
    ends = []
    for kind in (GraphFlow, Sparse):
        problem = kind(0.0, 10.0, 48)
        result = flow(problem, shape(problem), FlowOptions(until=0.5, rtol=1e-8, atol=1e-10))
        assert result.status == "time"
        check(result)
        ends.append(result.table())
    for name, error in (("E", 1e-8), ("lambda1", 1e-5), ("lambda2", 1e-5)):  # multipliers are left to Newton's method
        assert ends[0][name].iloc[-1] == pytest.approx(ends[1][name].iloc[-1], rel=error), name
    assert len(ends[1]) < 1.3 * len(ends[0])
    problem = Sparse(0.0, 10.0, 48)
    result = flow(problem, shape(problem))
    assert result.status == "steady"
    assert result.equilibrium.converged


class Wall(GraphFlow):
    """Cannot be evaluated where the tube is thicker than 1.33."""

    def residual(self, q, rate, lambdas):
        return super().residual(q, rate, lambdas) * (np.nan if q.max() > 1.33**2 / 2 else 1.0)


def test_a_wall_of_nan_stalls_and_is_said(capfd):
    start = start_at(pearls(0.48, 15, 2, 1.02))
    problem = Wall(0.48, 15.0, start.problem.points)
    result = flow(problem, start.perturbed("critical", 0.02, keep=True), FlowOptions(max_seconds=20))
    assert result.status == "stalled"
    assert "solver gave up" in result.reason
    assert result.advice
    assert result.table()["r_max"].iloc[-1] == pytest.approx(1.33, abs=0.01)
    check(result)
    assert "IDA" not in capfd.readouterr().err


class Interrupted(GraphFlow):
    """The user has enough as soon as little moves."""

    def residual(self, q, rate, lambdas):
        if 0 < np.abs(rate).max() < 1e-3:
            raise KeyboardInterrupt
        return super().residual(q, rate, lambdas)


def test_an_interrupted_flow_keeps_its_record():
    problem = Interrupted(0.0, 10.0, 64)
    result = flow(problem, shape(problem))
    assert result.status == "interrupted"
    check(result)
    assert 5e-4 < result.table()["velocity"].iloc[-1] < 2e-3  # rates of r^2/2 are r times it


def test_a_symmetric_start_rests_on_a_saddle():
    branch = pearls(0.48, 15, 2, 1.02)
    start = start_at(branch)
    k = 4 * np.pi * start.problem.x / 15
    result = start.flow(displaced(start.problem, start.q, lambda _: 0.01 * np.cos(k)))
    assert result.status == "saddle"
    assert result.equilibrium.growth_rates[0] > 0.1
    check(result)
    onwards = flow(result.equilibrium.problem, displaced(
        start.problem, result.equilibrium.q, lambda _: 1e-3 * np.cos(k / 2)
    ))  # fmt: skip
    assert onwards.status == "steady"


def test_a_killed_run_resumes(tmp_path):
    problem = GraphFlow(0.0, 10.0, 64)
    whole = flow(problem, shape(problem))
    half = flow(problem, shape(problem), FlowOptions(max_steps=60))
    save(half.state, tmp_path / "flow.h5")
    state = load(tmp_path / "flow.h5")
    rest = resumed(state)
    assert rest.status == "steady"
    assert rest.table()["t"].is_monotonic_increasing
    assert len(rest.table()) > len(half.table())
    for name in ("lambda1", "lambda2", "E"):
        assert rest.equilibrium.observables[name] == pytest.approx(whole.equilibrium.observables[name], abs=1e-10)
    check(rest)
    (tmp_path / "none.h5").write_bytes(b"nothing")
    with pytest.raises(InputError, match="path: .*no HDF5"):
        load(tmp_path / "none.h5")


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda: GraphFlow(0.0, 10.0, 63), "points"),
        (lambda: GraphFlow(0.0, 10.0, 64, "mass"), "law"),
        (lambda: chosen(pearls(0.48, 15, 2, 1.02), "A2"), "point"),
        (lambda: chosen(pearls(0.48, 15, 2, 1.02), "v=1.5"), "point"),
        (lambda: chosen(pearls(0.48, 15, 2, 1.02), "999"), "point"),
        (lambda: FlowOptions(rtol=0), "rtol"),
        (lambda: FlowOptions(max_order=6), "max_order"),
        (lambda: start_at(pearls(0.48, 15, 2, 1.02)).perturbed("kick", 0.1), "perturb"),
        (lambda: start_at(pearls(0.48, 15, 2, 1.02)).perturbed("bump", 2.0), "delta"),
    ],
)
def test_mistakes(call, name):
    with pytest.raises(InputError, match=f"^{name}: "):
        call()
