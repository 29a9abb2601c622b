"""Ends of flows as points of branches: recognized however they lie, and then the branches' own shapes and spectra."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.sums import Basis

from pearlbvp.errors import InputError
from pearlbvp.flows.axisymmetric import GraphFlow
from pearlbvp.flows.driver import FlowOptions
from pearlbvp.flows.record import Equilibrium
from pearlbvp.flows.steady import polished
from pearlbvp.flows.tube import TubeFlow
from pearlbvp.held import AREA_AND_VOLUME
from pearlbvp.helfrich import Tube
from pearlbvp.studies import flow_end
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.flow_end import _at_its_volume, continued, end_branch, recognized, solution_of, stability
from pearlbvp.studies.flow_start import pearl_start, pearl_tube_start, tube_start
from pearlbvp.studies.mesh_flow import mesh_start
from pearlbvp.studies.onward import resumed, switched
from pearlbvp.studies.saved import family_of, load, save
from pearlbvp.tube.isotropy import StandardPosition, standard_position
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.symmetry import TubeSymmetry, buckle_symmetry, coil_symmetry, pearl_symmetry, ring_symmetry
from pearlbvp.tube.torus import TorusFunction

SHIFT, TURN, ACROSS = 1.3, 0.7, (0.2, -0.1)
SAME = ("E", "lambda1", "lambda2", "v", "L")


@cache
def tubes(c0, family, mode, v):
    branch = family_branch(Tube(c0, 10.0), family, mode, branch_options({"v": v}), discretization="modes")
    assert branch.complete, branch.reason
    return branch.points[-1]


@cache
def mixed():
    """Between coils and buckles at c0 = 0.48, in the coils' turning frame."""
    coils = family_branch(Tube(0.48, 10.0), "coil", (1, 1), branch_options({"v": 0.905}))
    return switched(coils, 1, branch_options({"v": 0.9105})).points[-1]


@cache
def embedded():
    """Waves along a tube of two lobes."""
    rings = family_branch(Tube(0.0, 10), "ring", (0, 2), branch_options({"v": 0.95}))
    return switched(rings, 1, branch_options({"v": 0.95})).points[-1]


def surface_points(problem, q, x, phi):
    """Points ``y + i z`` of a tube, mode by mode."""
    basis = Basis.of(problem.modes, 2 * np.pi / problem.length, 0.0, x, phi)
    moved = basis.displacement() @ q
    return (moved[:, 0] + 1j * moved[:, 1]) * np.exp(1j * phi)


def laid(start, mirrored=False):
    """Coordinates of the same surface reflected, turned, shifted and moved across: fitted to its points, not rotated as waves."""
    problem = start.problem
    x, phi = (t.ravel() for t in np.meshgrid(
        np.arange(2 * problem.size[0] + 3) * problem.length / (2 * problem.size[0] + 3),
        np.arange(2 * problem.size[1] + 3) * 2 * np.pi / (2 * problem.size[1] + 3), indexing="ij",
    ))  # fmt: skip
    sign = -1 if mirrored else 1
    there = surface_points(problem, start.q, x - SHIFT, sign * (phi - TURN))
    there = np.exp(1j * TURN) * (there.conj() if mirrored else there) + complex(*ACROSS)
    basis = Basis.of(problem.modes, 2 * np.pi / problem.length, 0.0, x, phi)
    moved = there * np.exp(-1j * phi)
    rows = basis.displacement().transpose(1, 0, 2).reshape(2 * len(x), -1)
    q, *_ = np.linalg.lstsq(rows, np.concatenate((moved.real, moved.imag)), rcond=None)
    assert np.abs(rows @ q - np.concatenate((moved.real, moved.imag))).max() < 1e-11
    return q


def end_of(start, q=None):
    """A start taken for the end of a flow."""
    q = start.q if q is None else q
    return polished(start.problem, q, start.multipliers, start.problem.constraints(q))


FAMILIES = [
    (lambda: tubes(0.0, "coil", (1, 1), 0.9), (10, 10), "coil", coil_symmetry(1)),
    (lambda: tubes(0.0, "coil", (2, 1), 0.95), (8, 5), "coil", coil_symmetry(2)),
    (lambda: tubes(-1.0, "coil", (1, 2), 0.97), (7, 14), "coil", coil_symmetry(1, 2)),
    (lambda: tubes(-1.0, "coil", (2, 2), 0.97), (10, 10), "coil", coil_symmetry(2, 2)),
    (lambda: tubes(0.0, "ring", (0, 2), 0.9), (2, 14), "ring", ring_symmetry(2)),
    (lambda: tubes(0.0, "ring", (0, 3), 0.95), (1, 15), "ring", ring_symmetry(3)),
    (lambda: tubes(0.0, "buckle", (1, 1), 0.97), (9, 9), "buckle", buckle_symmetry(1, 1)),
    (lambda: tubes(0.0, "buckle", (1, 2), 0.98), (8, 10), "buckle", buckle_symmetry(1, 2)),
    (lambda: tubes(0.0, "pearl", (1, 0), 1.02), (16, 2), "pearl", pearl_symmetry(1)),
    (mixed, (11, 11), "mixed", TubeSymmetry(2, 1, 1, frozenset({0, 3, 4, 7, 8, 11, 12, 15}))),
    (embedded, (6, 16), "mixed", TubeSymmetry(1, 2, 0, frozenset({0, 4, 8, 12}))),
]


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(("entry", "size", "family", "symmetry"), FAMILIES)
def test_tubes_are_recognized_however_they_lie(entry, size, family, symmetry, mirrored):
    """A branch's shape, moved by known amounts, is the branch's shape again, and so is its spectrum."""
    there = entry()
    start = tube_start(there.problem, there.u, size=size)
    end = end_of(start, laid(start, mirrored))
    found = recognized(end)
    assert (found.family, found.symmetry) == (family, symmetry)
    assert found.handedness == (symmetry.turns > 0) * (-1 if mirrored else 1)
    np.testing.assert_allclose(found.across, ACROSS, atol=1e-8)
    problem, u = solution_of(end)
    observed = problem.observables(u)
    for name in SAME:
        assert observed[name] == pytest.approx(there.observables[name], abs=1e-10), name
    if not mirrored:
        spectrum = stability(end)
        assert spectrum.n_unstable == there.spectrum.n_unstable
        assert spectrum.mu_crit == pytest.approx(there.spectrum.mu_crit, abs=1e-8)


@pytest.mark.parametrize(
    ("entry", "size", "mirrored"), [(*FAMILIES[i][:2], m) for i, m in ((0, 0), (0, 1), (6, 0), (9, 1))]
)
def test_the_standard_position_and_the_motion_from_it_are_the_tube(entry, size, mirrored):
    """The documented motion, applied to points of the surface in the standard position."""
    there = entry()
    start = tube_start(there.problem, there.u, size=size)
    q, length = laid(start, mirrored), start.problem.length
    found = standard_position(start.problem.known(q), length)
    standard = start.problem.coordinates(
        found.known, np.array(list(found.known.values())), 2 * np.pi / length, 2 * np.pi / length * found.symmetry.turns
    )
    rng = np.random.default_rng(0)
    x, phi = rng.uniform(0, length, 40), rng.uniform(0, 2 * np.pi, 40)
    sign = -1 if found.mirrored else 1
    moved = surface_points(start.problem, standard, x - found.shift, sign * (phi - found.turn))
    moved = np.exp(1j * found.turn) * (moved.conj() if found.mirrored else moved) + complex(*found.across)
    np.testing.assert_allclose(surface_points(start.problem, q, x, phi), moved, atol=1e-9)


@pytest.mark.parametrize(
    "generators", [(), (1,), (2,), (3,), (9,), (6,), (14,), (12,), (11, 4), (10, 5), (1, 8), (9, 6)]
)
@pytest.mark.parametrize(("period", "fold", "turns"), [(1, 1, 0), (2, 1, 1)])
def test_no_symmetry_is_overlooked(generators, period, fold, turns):
    """Sums of random modes of any group, moved anyhow: never more modes than they were made of."""
    group = {0}
    for element in (*generators, *((3,) if turns else ())):
        group |= {element ^ other for other in group}
    symmetry = TubeSymmetry(period, fold, turns, frozenset(group))
    rng = np.random.default_rng(sum(generators))
    known = {
        mode: 0.3 * rng.normal() * np.exp(-np.hypot(mode.p / period, mode.harmonic)) for mode in symmetry.modes((3, 3))
    }
    tube = TorusFunction.of(known | {Mode("sigma", 0): 1.0}).in_frame(-turns).moved(*rng.uniform(0, 6, 2))
    found = standard_position((tube.mirrored() if generators else tube).modes(), 7.0)
    # Modes of a finer lattice have more parities: what counts is how many of all modes there are.
    share = len(found.symmetry.group) / (found.symmetry.period * found.symmetry.fold)
    assert share <= len(group) / (period * fold)
    inside = set(found.symmetry.modes((20, 20)))
    assert max(abs(value) for mode, value in found.known.items() if mode not in inside) < 1e-9


def test_turning_frames_are_shears_of_the_torus():
    """Modes of a turning frame that depend on x, by the formula of the frame, and as modes at rest."""
    flow, turns = TubeFlow(0.0, 9.0, (9, 4)), 2
    k = 2 * np.pi / 9
    modes = [Mode("sigma", 0), Mode("sigma", 1, "sin", 2, "cos"), Mode("sigma", 1, "cos", 3, "sin"), Mode("y", 3, "sin"),
             Mode("z", 1, "cos"), Mode("y", 0)]  # fmt: skip
    values = np.array([1.0, 0.1, -0.07, 0.3, 0.2, 0.4])
    rng = np.random.default_rng(0)
    x, phi = rng.uniform(0, 9, 50), rng.uniform(0, 2 * np.pi, 50)
    turned = Basis.of(modes, k, turns * k, x, phi - turns * k * x).displacement() @ values
    expected = (turned[:, 0] + 1j * turned[:, 1]) * np.exp(1j * phi)
    q = flow.coordinates(modes, values, k, turns * k)
    np.testing.assert_allclose(surface_points(flow, q, x, phi), expected, atol=1e-13)
    known = dict(zip(modes, values, strict=True))
    again = TorusFunction.of(flow.known(q)).in_frame(turns).modes()
    for mode, value in again.items():
        assert value == pytest.approx(known.get(mode, 0.0), abs=1e-15)
    with pytest.raises(InputError, match="^kappa: "):
        flow.coordinates(modes, values, k, 1.5 * k)


def test_a_mixed_coil_starts_a_flow():
    """The branch's multipliers, energy and largest growth rate, in modes of a frame at rest and without symmetry."""
    there = mixed()
    assert there.problem.symmetry.turns == 1
    assert there.problem.symmetry.period == 2
    start = tube_start(there.problem, there.u, size=(13, 13))
    found = start.problem.observables(start.q, start.multipliers)
    assert found["E"] == pytest.approx(there.observables["E"], abs=1e-11)
    for name in ("lambda1", "lambda2"):
        assert found[name] == pytest.approx(there.observables[name], abs=1e-8)
    rates = start.problem.growth_rates(start.q, start.multipliers)[0]
    assert rates[0] == pytest.approx(there.spectrum.mu_crit, abs=1e-7)


def test_in_the_general_space_phase_conditions_hold_the_shape():
    """A buckle whose symmetry is not made use of: all modes, two phase conditions, the branch's spectrum."""
    there = tubes(0.0, "buckle", (1, 1), 0.97)
    start = tube_start(there.problem, there.u, size=(9, 9))
    end = end_of(start, laid(start))
    known = {mode: value for mode, value in start.problem.known(end.q).items() if (mode.p, mode.harmonic) != (0, 1)}
    position = StandardPosition(TubeSymmetry(1, 1, 0, frozenset(range(16))), known, 0.0, 0.0, (0.0, 0.0), False)
    assert position.family == "mixed"
    problem, u = flow_end._tubes(end, position, AREA_AND_VOLUME)
    assert problem.pinned.shape[0] == 2
    for name in SAME:
        assert problem.observables(u)[name] == pytest.approx(there.observables[name], abs=1e-10)
    spectrum = problem.spectrum(u)
    assert spectrum.n_unstable == there.spectrum.n_unstable
    assert spectrum.mu_crit == pytest.approx(there.spectrum.mu_crit, abs=1e-8)


@cache
def coiled(delta):
    """Where a buckle flows to, moved along its most unstable vector."""
    there = tubes(0.0, "buckle", (1, 1), 0.95)
    start = tube_start(there.problem, there.u, size=(8, 8))
    return start.flow(start.perturbed("critical", delta, keep=True), FlowOptions(resolution=1e-3, max_seconds=60))


def test_a_buckle_flows_to_coils_of_either_handedness():
    """Mirror images on either side of the buckle, which are the coils of the branch at the buckle's volume."""
    coil, hands = tubes(0.0, "coil", (1, 1), 0.95), []
    for delta in (0.3, -0.3):
        result = coiled(delta)
        assert result.status == "steady"
        end = result.equilibrium
        position = recognized(end)
        assert position.family == "coil"
        # The sign of the area that the centre goes round, seen along the axis.
        centre = end.problem.known(end.q)
        area = centre[Mode("y", 1)] * centre[Mode("z", 1, "sin")] - centre[Mode("y", 1, "sin")] * centre[Mode("z", 1)]
        assert position.handedness == np.sign(area)
        hands.append(position.handedness)
        problem, u = solution_of(end)
        for name in ("E", "lambda1", "lambda2"):
            assert end.observables[name] == pytest.approx(coil.observables[name], abs=1e-8)
            assert problem.observables(u)[name] == pytest.approx(coil.observables[name], abs=1e-10)
        assert stability(end).mu_crit == pytest.approx(coil.spectrum.mu_crit, abs=1e-8)
        assert stability(end).n_unstable == 0
    assert sorted(hands) == [-1, 1]


def test_an_unstable_coil_flows_to_the_stable_tubes_between_coils_and_buckles():
    there, coil = mixed(), tubes(0.48, "coil", (1, 1), 0.9105)
    assert (there.spectrum.n_unstable, coil.spectrum.n_unstable) == (0, 2)
    start = tube_start(coil.problem, coil.u, size=(9, 9))
    result = start.flow(start.perturbed("critical", 0.1, keep=True), FlowOptions(resolution=1e-3, max_seconds=60))
    assert result.status == "steady"
    assert recognized(result.equilibrium).family == "mixed"
    problem, u = solution_of(result.equilibrium)
    for name in SAME:
        assert problem.observables(u)[name] == pytest.approx(there.observables[name], abs=1e-10)
    spectrum = problem.spectrum(u)
    assert spectrum.mu_crit == pytest.approx(there.spectrum.mu_crit, abs=1e-8)
    assert spectrum.n_unstable == 0


def test_the_branch_goes_on_from_the_end_of_a_flow_and_from_its_file(tmp_path):
    """Both ways, to where the branch from the cylinder passes."""
    result = coiled(0.3)
    save(end_branch(result), tmp_path / "end.h5")
    one = load(tmp_path / "end.h5")
    assert (len(one.points), family_of(one)) == (1, "coil")
    for v in (0.93, 0.96):
        expected = tubes(0.0, "coil", (1, 1), v)
        onwards = continued(result, branch_options({"v": v}), upwards=v > 0.95)
        further = resumed(one, branch_options({"v": v}))
        assert further.kinds(0) == ["start"]
        for branch in (onwards, further):
            assert branch.complete
            for name in SAME:
                assert branch.points[-1].observables[name] == pytest.approx(expected.observables[name], abs=1e-10)


def scaled(start, factor):
    """The equilibrium ``factor`` times as large: of another area, on a longer tube."""
    problem = replace(start.problem, c0=start.problem.c0 / factor, length=start.problem.length * factor)
    multipliers = start.multipliers * [factor**-2, factor**-3]
    return replace(start, problem=problem, q=start.q * factor, multipliers=multipliers)


def test_an_end_of_another_area_is_similar_to_a_branch_s_shape():
    there = embedded()
    start = scaled(tube_start(there.problem, there.u, size=(10, 14)), 1.2)
    end = end_of(start)
    assert end.observables["area"] == pytest.approx(1.2)
    problem, u = solution_of(end)
    observed = problem.observables(u)
    for name in (*SAME, "c0"):
        assert observed[name] == pytest.approx(there.observables[name], abs=1e-9), name
    assert problem.spectrum(u).mu_crit == pytest.approx(end.growth_rates[0] * 1.2**4, rel=1e-3)


@pytest.mark.parametrize("kind", ["graph", "tube", "mesh"])
def test_the_end_of_a_flow_that_keeps_its_area_is_on_the_tube_that_was_given(kind):
    """Not on one that rounding made longer: in every digit."""
    point = family_branch(Tube(0.75, 20.0), "pearl", (2, 0), branch_options({"v": 1.02})).points[-1]
    start = {
        "graph": lambda: pearl_start(point.problem, point.u),
        "tube": lambda: pearl_tube_start(point.problem, point.u, size=(24, 2)),
        "mesh": lambda: mesh_start(point, 700),
    }[kind]()
    kept = start.problem.constraints(start.perturbed("critical", 0.02, keep=True))
    np.testing.assert_allclose(kept, [1.0, 1.02 / 2], rtol=0, atol=1e-13)
    problem, u = solution_of(polished(start.problem, start.q, start.multipliers, kept))
    found = problem.observables(u)
    assert (found["c0"], found["L"]) == (0.75, 20.0)


def test_newton_s_method_that_does_not_converge_is_said_to_fail():
    """At a volume that no shape has, of pearls in arclength and of tubes in reduced modes."""
    pearls = family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.02})).points[-1]
    tube = tubes(0.0, "coil", (1, 1), 0.9)
    for point in (pearls, tube):
        u = point.u.copy()
        u[-1] = 3.0
        with pytest.raises(InputError, match=r"^flow: its end led to no equilibrium .*\(.+\); let it flow"):
            _at_its_volume(point.problem, u)
        np.testing.assert_allclose(_at_its_volume(point.problem, point.u), point.u, atol=1e-8)


def test_equal_pearls_are_pearls_of_a_period():
    """Two pearls, as a graph and among all tubes: the branch's cells, its count and its rates."""
    there = family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.02})).points[-1]
    problem, u = there.problem, there.u
    for start in (pearl_start(problem, u), pearl_tube_start(problem, u, size=(24, 2))):
        end = end_of(start)
        found, w = solution_of(end)
        assert found.cells == 2
        for name in SAME:
            assert found.observables(w)[name] == pytest.approx(there.observables[name], abs=1e-10)
        assert stability(end).n_unstable == there.spectrum.n_unstable
        assert str(stability(end).critical) == str(there.spectrum.critical)


def test_at_given_pressure_volume_is_free():
    there = tubes(0.0, "coil", (1, 1), 0.9)
    start = tube_start(there.problem, there.u, size=(10, 10), law="area")
    branch = family_branch(Tube(0.0, 10.0), "coil", (1, 1), branch_options({"v": 0.9}), fix="area,pressure")
    spectrum = stability(end_of(start))
    assert spectrum.n_unstable == branch.points[-1].spectrum.n_unstable
    assert spectrum.mu_crit == pytest.approx(branch.points[-1].spectrum.mu_crit, abs=1e-8)


def _straight():
    flow = TubeFlow(0.0, 10.0, (2, 2))
    return Equilibrium(flow, flow.packed({Mode("sigma", 0): 1.0}), np.array([0.2, 0.05]), True, np.array([-1.0]))


def _straight_graph():
    graph = GraphFlow(0.0, 10.0, 32)
    return Equilibrium(graph, graph.coordinates(np.ones(32)), np.array([0.2, 0.05]), True, np.array([-1.0]))


@pytest.mark.parametrize(
    ("end", "says"),
    [
        (_straight, "straight tube"),
        (_straight_graph, "straight tube"),
        (lambda: replace(_straight(), converged=False), "no equilibrium"),
    ],
)
def test_ends_that_are_no_points_of_branches(end, says):
    with pytest.raises(InputError, match=f"^flow: .*{says}"):
        stability(end())
