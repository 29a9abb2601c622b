"""Branches: special points and stability against independent computations, switching, exact stops."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from support import pearls

from pearlbvp.continuation.following import continue_branch, kept
from pearlbvp.continuation.path import correct
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.switching import crossing_direction
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.newton import NewtonOptions
from pearlbvp.shapes.outline import Outline, downhill
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.stability.profile import Profile
from pearlbvp.studies.branch import COLUMNS, branch_options, family_branch
from pearlbvp.studies.localized import localized_pearls
from pearlbvp.studies.onward import followed, switched, varied
from pearlbvp.studies.shape import shape_branch


@pytest.fixture(scope="module")
def four():
    """Four pearls of period 7.5 on L = 30, past both their branch points."""
    return family_branch(Tube(0.48, 30), "pearl", (4, 0), branch_options({"v": 1.02}))


@pytest.fixture(scope="module")
def localized(four):
    return switched(four, 1, branch_options({"v": 1.2}))


def test_branch_points_are_those_of_the_localized_table(four):
    table = four.table()
    assert set(table.columns) == set(COLUMNS)
    found = table[table.special == "bp"]
    # Waves j = 1 and j = 2 of four cells are the branch points of L = 30 and L = 15.
    expected = localized_pearls(0.48, 7.5, [30, 15])
    np.testing.assert_allclose(found.lambda2, expected.lambda2, atol=1e-10)
    np.testing.assert_allclose(found.v, expected.v, atol=1e-10)
    assert [special.change for special in four.find("bp")] == [2, 1]
    assert [str(special.block) for special in four.find("bp")] == ["n=0 j=1/4", "n=0 j=2/4 even"]
    first, second = found.index
    assert (table.n_unstable[: first + 1] == 0).all()
    assert (table.n_unstable[first + 1 : second + 1] == 2).all()
    assert (table.n_unstable[second + 1 :] == 3).all()


def test_a_branch_stops_exactly_where_it_is_told(four):
    last = four.table().iloc[-1]
    assert (last.special, last.v) == ("stop", pytest.approx(1.02, abs=1e-13))
    for name, value in (("lambda2", -0.3), ("amplitude", 0.1), ("mu_crit", 0.03)):
        stopped = family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({name: value, "v": 1.1}))
        assert stopped.complete
        assert stopped.table().iloc[-1][name] == pytest.approx(value, abs=1e-9)
    both = family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.01, "lambda2": -0.3}))
    assert both.table().iloc[-1].lambda2 == pytest.approx(-0.3, abs=1e-12)  # it comes first


def test_the_localized_pearl_is_stable_with_a_fold_in_lambda2(localized):
    table = localized.table()
    assert (table.n_unstable == 0).all()
    fold = table[table.special == "fold:lambda2"].iloc[0]
    neighbours = table.lambda2.iloc[[fold.name - 1, fold.name + 1]]
    assert (neighbours < fold.lambda2).all()
    # Half of the tube from a pearl's belly: that pearl is the largest, and its tube is L = 30 long.
    profile = localized.points[-1].problem.profile(localized.points[-1].u)
    x, r = profile.outline()
    assert x[-1] == pytest.approx(30, abs=1e-9)
    assert r[0] == pytest.approx(table.r_max.iloc[-1], abs=1e-12)
    # Area 2 pi L and the volume of the table, from the outline alone.
    dense = np.linspace(0, 1, 20001)
    y = profile.mirrored().at(dense)
    ds = profile.mirrored().arclength
    assert np.trapezoid(2 * np.pi * y[:, 0], dense) * ds == pytest.approx(60 * np.pi, rel=1e-7)
    volume = np.trapezoid(np.pi * y[:, 0] ** 2 * np.cos(y[:, 1]), dense) * ds
    assert volume / (30 * np.pi) == pytest.approx(1.2, rel=1e-7)


def test_energy_and_pressure_along_the_localized_branch(localized):
    """``-2 d(E/A)/dv = lambda2``: the energy gained over a stretch is the integral of the pressure."""
    points = [entry for entry in localized.points[-4:]]
    for one, two in itertools.pairwise(points):
        dv = two.observables["v"] - one.observables["v"]
        gained = two.observables["E"] - one.observables["E"]
        mean = (one.observables["lambda2"] + two.observables["lambda2"]) / 2
        assert -2 * gained / dv == pytest.approx(mean, rel=2e-2)
    # Exactly, at one point, along its own tangent.
    point = points[1]
    eps = 1e-4
    sides = [point.problem.observables(point.u + sign * eps * point.tangent) for sign in (1, -1)]
    slope = (sides[0]["E"] - sides[1]["E"]) / (sides[0]["v"] - sides[1]["v"])
    assert -2 * slope == pytest.approx(point.observables["lambda2"], abs=1e-7)


def test_pearl_and_neck_centred_branches_differ_in_stability(four, localized):
    neck = switched(four, 1, branch_options({"v": 1.05}), centre="neck")
    assert (neck.table().n_unstable.iloc[1:] >= 1).all()
    assert localized.points[0].observables["lambda2"] == pytest.approx(neck.points[0].observables["lambda2"], abs=1e-10)
    # At equal volume the stable one has less energy.
    other = switched(four, 1, branch_options({"v": 1.05}))
    assert other.table().E.iloc[-1] < neck.table().E.iloc[-1]


def test_two_cells_from_one():
    """On L = 15 the localized pearl is found by unrolling by hand, too: the same solution on another mesh."""
    two = family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.02}))
    by_switch = switched(two, 1, branch_options({"v": 1.1})).table().iloc[-1]
    point = two.at(two.find("bp")[0])
    problem, (u, tangent) = point.problem.repeated(2, "neck", point.u, point.tangent)
    assert np.abs(problem.residual(u)).max() < 1e-9
    # From neck to neck the wave even about bellies is odd: there is no null vector besides the tangent.
    tangent /= math.sqrt(problem.inner(tangent, tangent))
    ratio = np.linalg.norm(problem.solve(u, np.append(np.zeros(u.size - 1), 1.0), tangent))
    assert ratio < 100
    problem, (u, tangent) = point.problem.repeated(2, "pearl", point.u, point.tangent)
    tangent /= math.sqrt(problem.inner(tangent, tangent))
    direction = crossing_direction(problem, u, tangent)
    backwards = continue_branch(Solution.along(problem, u, -direction), branch_options({"v": 1.1}), at_bifurcation=True)
    for name in ("lambda1", "lambda2", "E"):
        assert backwards.table().iloc[-1][name] == pytest.approx(by_switch[name], abs=1e-9)


def test_c0_0_is_stable_far_beyond_the_paper():
    table = family_branch(Tube(0.0, 10), "pearl", (1, 0), branch_options({"v": 1.34})).table()
    assert (table.n_unstable == 0).all()
    assert table.v.iloc[-1] == pytest.approx(1.34, abs=1e-12)
    # AUTO-07p, between its rows lambda2 = -10 and -15
    assert -15 < table.lambda2.iloc[-1] < -10


def test_m_1_on_l_15_is_unstable_throughout():
    table = family_branch(Tube(0.48, 15), "pearl", (1, 0), branch_options({"v": 1.1})).table()
    assert table.lambda2.iloc[0] == pytest.approx(-0.4208, abs=5e-5)
    assert (table.n_unstable.iloc[1:] > 0).all()


def test_an_interrupted_branch_keeps_its_points():
    def interrupt(branch):
        if len(branch.points) > 4:
            raise KeyboardInterrupt

    def follow(options):
        return family_branch(Tube(0.48, 15), "pearl", (2, 0), options)

    options = branch_options({"v": 0.9}, progress=interrupt)  # it moves away from that
    with pytest.raises(KeyboardInterrupt):  # for whoever builds on it
        follow(options)
    branch = kept(follow, options)
    assert (branch.reason, branch.complete) == ("interrupted", False)
    assert len(branch.points) > 4
    assert branch.kinds(len(branch.points) - 1) == ["end"]


def test_an_end_has_a_reason():
    branch = family_branch(Tube(0.0, 10), "pearl", (1, 0), branch_options(max_points=5))
    assert not branch.complete
    assert "max_points" in branch.reason


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda: family_branch(Tube(0.48, 15), "pearl", (0, 0)), "mode"),
        (lambda: family_branch(Tube(0.48, 2 * math.pi), "pearl", (1, 0)), "mode: .*k = 1"),
        (lambda: family_branch(Tube(0.48, -1), "pearl", (1, 0)), "length"),
        (lambda: family_branch(Tube(0.48, 15), "pearl", (2, 0), tolerance=1.0), "tolerance"),
        (lambda: branch_options({"w": 1.0}), "until"),
        (lambda: branch_options({"v": math.nan}), "until v"),
        (lambda: branch_options(max_points=1), "max_points"),
        (lambda: branch_options(step=0.7), "step"),
    ],
)
def test_mistakes(call, name):
    with pytest.raises(InputError, match=f"^{name}"):
        call()


def test_switches_that_cannot_be(four, monkeypatch):
    with pytest.raises(InputError, match="^number: the branch has 2"):
        switched(four, 3, branch_options())
    branch = family_branch(Tube(0.75, 10), "pearl", (1, 0), branch_options({"bp": 1}))
    monkeypatch.setattr(Profile, "is_graph", False)
    with pytest.raises(InputError, match="^number: .*overhang.*a mesh may follow them"):
        switched(branch, 1, branch_options())
    assert pearls.path(0.48, 7.5, 1.03).points[0].problem.cells == 1
    with pytest.raises(ValueError, match="^cells: "):
        replace(four.points[0].problem, cells=3).repeated(2, "pearl")


def test_pearls_continued_in_c0_and_length_are_the_pearls_of_that_tube():
    """From c0 = 0, L = 10 at v = 1.1 to c0 = 0.2, then to L = 11: where the branches of those tubes pass v = 1.1."""
    here = family_branch(Tube(0.0, 10), "pearl", (1, 0), branch_options({"v": 1.1}))
    moved = varied(here, -1, "c0", branch_options({"c0": 0.2}))
    longer = varied(moved, -1, "L", branch_options({"L": 11.0}))
    for found, c0, length in ((moved, 0.2, 10.0), (longer, 0.2, 11.0)):
        direct = family_branch(Tube(c0, length), "pearl", (1, 0), branch_options({"v": 1.1})).table().iloc[-1]
        last = found.table().iloc[-1]
        assert (last.c0, last.L, last.v) == pytest.approx((c0, length, 1.1), abs=1e-12)
        for name in ("lambda1", "lambda2", "E", "mu_crit"):
            assert last[name] == pytest.approx(direct[name], abs=1e-8)
    with pytest.raises(InputError, match="^vary: "):
        varied(here, -1, "v", branch_options())
    with pytest.raises(InputError, match="^point: "):
        varied(here, 99, "c0", branch_options())


@pytest.fixture(scope="module")
def unequal():
    """The paper's branch P: two unequal pearls at c0 = 0.75, L = 10."""
    return shape_branch(0.75, 10, 1.0, [-0.28, 0.47], branch_options({"v": 1.1}, max_points=40))


def test_two_unequal_pearls_are_stable_and_begin_at_a_pitchfork(unequal):
    table = unequal.table()
    stable = table[table.v > table.v.min() + 1e-6]
    assert (stable.n_unstable == 0).all()
    start = table[table.v.sub(1.0).abs() < 1e-12].iloc[0]
    assert start.r_max == pytest.approx(1.532363, abs=1e-6)
    # Where it begins, the two pearls are equal, and the branch ends there: beyond, it would repeat itself mirrored.
    beginning = table[table.special.str.contains("bp")].iloc[0]
    assert beginning.v == pytest.approx(0.9747043, abs=1e-7)
    profile = unequal.at(unequal.find("bp")[0])
    values = profile.problem.discretization.values(profile.u)
    assert values[0, 0] == pytest.approx(values[-1, 0], abs=1e-4)


def test_the_unequal_pearls_branch_from_pearls_of_half_the_period(unequal):
    """Two equal pearls of period 5 lose stability to a wave of two cells just there, on a branch that is stable before."""
    beginning = unequal.at(unequal.find("bp")[0]).observables
    equal = shape_branch(0.75, 5, 0.9741, [0.51, -0.11, 0.03], branch_options({"v": 0.976}, max_points=12), cells=2)
    table = equal.table()
    alternating = [equal.at(s).observables for s in equal.find("bp") if str(s.block) == "n=0 j=1/2 even"]
    found = min(alternating, key=lambda observables: abs(observables["v"] - beginning["v"]))
    for name in ("lambda1", "lambda2", "v", "E"):
        assert found[name] == pytest.approx(beginning[name], abs=2e-8)
    assert table[(table.v > 0.9734) & (table.v < found["v"] - 1e-8)].n_unstable.eq(0).all()
    assert table[table.v > found["v"] + 1e-8].n_unstable.eq(1).all()


def test_a_shape_that_leads_nowhere_is_said():
    with pytest.raises(InputError, match="^shape: "):
        shape_branch(0.0, 10, 5.0, [0.1])
    with pytest.raises(InputError, match="^volume: "):
        shape_branch(0.0, 10, -1.0, [0.1])
    for cosines in ([-0.3, 0.5], [0.1], [0.0, 0.2]):  # at v = 1 and c0 = 0 all roads lead to the straight tube
        with pytest.raises(InputError, match="^shape: .*lies the straight tube"):
            shape_branch(0.0, 10, 1.0, cosines)


def test_the_least_energy_shape_lies_on_the_continued_branch():
    """Going downhill from a graph at v = 1.1 finds the point of the pearl branch at v = 1.1 (c0 = 0, L = 10)."""
    direct = family_branch(Tube(0.0, 10), "pearl", (1, 0), branch_options({"v": 1.1})).table().iloc[-1]
    outline = Outline.on(Tube(0.0, 10), 1.1)
    problem, u = downhill(outline, outline.of_radius(np.array([0.4])))
    for name in ("lambda1", "lambda2", "E", "r_min"):
        assert problem.observables(u)[name] == pytest.approx(direct[name], abs=1e-9)


def test_a_spectrum_that_fails_ends_the_branch_and_keeps_its_points(monkeypatch):
    calls = 0
    spectrum = PearlProblem.spectrum

    def failing(self, u):
        nonlocal calls
        calls += 1
        if calls > 5:
            raise np.linalg.LinAlgError("Eigenvalues did not converge")
        return spectrum(self, u)

    monkeypatch.setattr(PearlProblem, "spectrum", failing)
    branch = family_branch(Tube(0.0, 10), "pearl", (1, 0), branch_options({"v": 1.2}))
    assert not branch.complete
    assert "spectrum" in branch.reason
    assert 3 <= len(branch.points) <= 5
    assert branch.kinds(len(branch.points) - 1) == ["end"]


@pytest.mark.parametrize(
    ("kind", "number", "vary", "name"),
    [("bp", 9, "c0", "number"), ("fold:v", 1, "c0", "number"), ("bp", 1, "v", "vary")],
)
def test_nothing_to_follow(four, kind, number, vary, name):
    with pytest.raises(InputError, match=f"^{name}: "):
        followed(four, kind, number, vary, branch_options())


@pytest.mark.parametrize("max_step", [0.05, 0.1, 0.3, 0.5])
@pytest.mark.parametrize("step", [0.01, 0.05])
def test_no_step_jumps_to_another_branch(step, max_step):
    """At c0 = 0.592 the branches of equal and of unequal pearls pass each other at a distance of 1e-2."""
    branch = family_branch(Tube(0.592, 10), "pearl", (1, 0), branch_options({"v": 0.99}, step=step, max_step=max_step))
    assert branch.complete
    (fold,) = branch.find("fold:v")
    assert branch.at(fold).observables["v"] == pytest.approx(1.0034530, abs=1e-7)


def test_a_branch_without_planes_of_reflection():
    """Where a wave that is odd about the belly becomes neutral, shapes without reflection symmetry branch off: the full cell."""
    symmetric = family_branch(Tube(0.5905, 10), "pearl", (1, 0), branch_options({"v": 1.005}))
    (special,) = symmetric.find("bp")
    assert str(special.block) == "n=0 j=0/1 odd"
    skew = switched(symmetric, 1, branch_options(max_points=12))
    problem, u = skew.points[4].problem, skew.points[4].u
    assert not problem.half
    parameters = dict(
        zip(problem.discretization.problem.parameters, problem.discretization.all_parameters(u), strict=True)
    )
    assert abs(parameters["drag"]) < 1e-10
    assert problem.axial_force_spread(u) < 1e-9
    # No reflection: the profile read backwards is another one, wherever it starts.
    x, r = problem.profile(u).outline()
    even = np.interp(np.linspace(0, 10, 400, endpoint=False), x, r)
    shifts = [np.abs(np.roll(even[::-1], k) - even).max() for k in range(400)]
    assert min(shifts) > 1e-3
    # -2 d(E/A)/dv = lambda2 holds for it, too.
    one, two = skew.points[3].observables, skew.points[5].observables
    mean = (one["lambda2"] + two["lambda2"]) / 2
    assert -2 * (two["E"] - one["E"]) / (two["v"] - one["v"]) == pytest.approx(mean, rel=1e-4)


def test_the_pitchfork_leads_back_to_the_equal_pearls(unequal):
    """Switching where the unequal pearls begin gives the branch of equal pearls, with the volume on it smooth."""
    equal = switched(unequal, 1, branch_options(max_points=4, step=0.01, max_step=0.02))
    profile = equal.points[-1]
    values = profile.problem.discretization.values(profile.u)
    assert values[0, 0] == pytest.approx(values[-1, 0], abs=1e-6)
    assert abs(equal.points[-1].observables["v"] - equal.points[0].observables["v"]) > 1e-6


def test_radii_are_those_of_the_function_and_not_of_the_mesh(unequal):
    for entry in unequal.points[1:]:
        states = entry.problem.profile(entry.u).states
        dense = states(np.linspace(0, 1, 20001))[:, 0]
        assert entry.observables["r_min"] == pytest.approx(dense.min(), abs=1e-7)
        assert entry.observables["r_max"] == pytest.approx(dense.max(), abs=1e-7)


@pytest.mark.parametrize("which", ["localized", "unequal"])
def test_doubling_the_mesh_changes_no_branch_value(which, request):
    point = request.getfixturevalue(which).points[-1]
    d = point.problem.discretization
    fine, (moved,) = d.on_mesh(np.sort(np.append(d.mesh, (d.mesh[1:] + d.mesh[:-1]) / 2)), point.u)
    finer = replace(point.problem, discretization=fine)
    direction = np.zeros_like(moved)
    direction[-1] = 1.0  # at the same volume
    result, _ = correct(finer, moved, direction, moved, 0.0, NewtonOptions())
    assert result.converged
    after = finer.observables(result.u)
    for name in ("lambda1", "lambda2", "E", "r_min", "r_max"):
        assert after[name] == pytest.approx(point.observables[name], abs=1e-8)
    assert finer.spectrum(result.u).mu_crit == pytest.approx(point.problem.spectrum(point.u).mu_crit, abs=1e-7)


def test_surface_has_the_area_and_the_volume(localized):
    x, y, z = localized.points[-1].problem.profile(localized.points[-1].u).surface(400)
    corners = np.stack((x, y, z), axis=-1)
    one, two = corners[1:, :-1] - corners[:-1, :-1], corners[:-1, 1:] - corners[:-1, :-1]
    three, four = corners[1:, :-1] - corners[1:, 1:], corners[:-1, 1:] - corners[1:, 1:]
    area = (np.linalg.norm(np.cross(one, two), axis=-1) + np.linalg.norm(np.cross(three, four), axis=-1)).sum() / 2
    assert area == pytest.approx(60 * np.pi, rel=1e-3)


def test_special_points_say_where_they_were_looked_for(four):
    for special in four.find("bp"):
        low, high = special.interval
        assert low == 0 < high < 1
        assert special.converged
