"""What is held: second variations against differences of the multipliers of neighbouring equilibria, and what follows."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.linalg import block_diag, eigh
from support.graphs import Graphs
from support.other_tubes import derivative, on_tube
from support.shapes import SHAPES, shape

import pearlbvp as pb
from pearlbvp.constrained import restricted
from pearlbvp.errors import InputError
from pearlbvp.held import Held, coefficients, known_held
from pearlbvp.mesh.spectrum import MeshBlock
from pearlbvp.stability.bloch import SecondVariation
from pearlbvp.stability.planar import PlanarVariation
from pearlbvp.studies.mesh import meshed

FREE = Held(area=False, volume=False, length=False)


@cache
def given(name):
    return SHAPES[name]()


def own_block(problem, u):
    """The second variation of a shape among perturbations of its own symmetry, and its quantities."""
    if problem.family == "pearl":
        variation = SecondVariation.of(problem.profile(u), problem.spectrum(u).points)
        matrix = variation.matrix(0, 0.0, "even")
        return -matrix, variation.quantities(len(matrix), problem.cells)
    if problem.family == "ring":
        variation = PlanarVariation.of(problem.profile(u), 64)
        return -variation.matrices(0, "even")[0], variation.quantities(problem.length)
    reach = problem._reach(u)
    equilibrium, modes = problem._perturbed(u, reach), problem._blocks(reach, u)[problem.trivial_block]
    return equilibrium.hessian(modes), equilibrium.quantities(modes, problem.length)


def multipliers(problem, u, c0, area, volume, length):
    """``-lambda1, -lambda2, force`` and ``M`` of the equilibrium with given area, volume and length: the slopes of its energy.

    It is similar to one of the area of a straight tube of radius 1.
    """
    r = area / (2 * math.pi * length)
    found = on_tube(problem, u, c0 * r, length / r, volume / (math.pi * length * r**2))
    return np.array([-found["lambda1"] / r**2, -found["lambda2"] / r**3, found["force"] / r, found["M"] * r])


@cache
def stiffness(name):
    """Second derivatives of an equilibrium's energy by area, volume and length, and what ``c0`` adds, shape (4, 4)."""
    problem, u = given(name)
    known = problem.observables(u)
    here = np.array([known["c0"], 2 * math.pi * known["L"], math.pi * known["v"] * known["L"], known["L"]])
    scale = np.array([1.0, here[1], here[2], here[3]])

    def along(place):
        def at(step):
            return multipliers(problem, u, *(here + step * scale * (np.arange(4) == place)))

        return derivative(at, 0.0, 4e-4) / scale[place]

    return np.array([along(place) for place in range(4)])


@pytest.mark.parametrize("name", SHAPES)
def test_the_second_variation_is_that_of_the_equilibria_s_energy(name):
    """Those of the energy at given area, volume and length are the multipliers of these rows."""
    problem, u = given(name)
    second, quantities = own_block(problem, u)
    area_row, volume_row = Held(length=False).constrained(second, quantities)[0]
    unit, length = quantities.unit, problem.observables(u)["L"]
    length_row = np.zeros_like(area_row)
    length_row[-1] = length / math.sqrt(quantities.values[0])
    rows = np.array([unit * area_row, unit * volume_row, length_row])
    free = unit * FREE.constrained(second, quantities)[1]
    saddle = np.block([[free, rows.T], [rows, np.zeros((3, 3))]])
    found = -np.linalg.solve(saddle, np.eye(len(saddle))[:, -3:])[-3:]
    expected = stiffness(name)[1:, :3]
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6 * np.abs(expected).max())


def own_unstable(problem, u, fix, like):
    """Growing perturbations of a shape's own symmetry."""
    return int((replace(problem, held=known_held(fix)).block_rates(u, problem.trivial_block, like) > 0).sum())


FREED = {"tension": 0, "pressure": 1, "osmotic": 1, "force": 2}
"""Places of what is no longer held among area, volume and length."""


@pytest.mark.parametrize("name", SHAPES)
def test_what_is_no_longer_held_grows_where_the_energy_of_equilibria_is_no_minimum(name):
    """Of the perturbations that change area, volume or length so many grow as the energy has directions downwards."""
    problem, u = given(name)
    like = problem.spectrum(u)
    held = own_unstable(problem, u, "area,volume", like)
    energy, found = stiffness(name)[1:, :3], set()
    energy = (energy + energy.T) / 2
    volume = math.pi * problem.observables(u)["v"] * problem.observables(u)["L"]
    for fix in ("tension", "pressure", "osmotic=500", "force", "tension,pressure", "tension,osmotic=5", "tension,force",
                "osmotic=50,force", "pressure,force"):  # fmt: skip
        words = [word.partition("=") for word in fix.split(",")]
        places = [FREED[word] for word, _, _ in words]
        springs = [float(number) / volume**2 if number else 0.0 for _, _, number in words]
        downwards = int((np.linalg.eigvalsh(energy[np.ix_(places, places)] + np.diag(springs)) < 0).sum())
        found.add(downwards)
        assert own_unstable(problem, u, fix, like) == held + downwards, fix
    assert len(found) > 1


@pytest.mark.parametrize("name", SHAPES)
def test_reservoirs_with_laws_are_as_stiff_as_their_laws(name):
    """One spring, of stiffness ``W`` by what it pulls at, multiplies the determinant by ``1 + W`` times the compliance."""
    problem, u = given(name)
    known, slopes = problem.observables(u), stiffness(name)
    area, volume = 2 * math.pi * known["L"], math.pi * known["v"] * known["L"]
    by_volume = slopes[2, 1] - slopes[2, 0] * slopes[1, 1] / slopes[1, 0]  # of the pressure, at given tension
    at_force = slopes[0, 3] - slopes[0, 2] * slopes[3, 3] / slopes[3, 2]  # of M by c0
    for fix, without, spring in (
        ("osmotic=30", "pressure", 30 / volume**2 / slopes[2, 1]),
        ("tension,osmotic=30", "tension,pressure", 30 / volume**2 / by_volume),
        ("ade=1.5", "area", 2 * math.pi * 1.5 / area * slopes[0, 3] / 2),
        ("ade=1.5,force", "force", 2 * math.pi * 1.5 / area * at_force / 2),
    ):
        second, quantities = own_block(problem, u)
        stiff, soft = (restricted(*known_held(what).constrained(second, quantities))[0] for what in (fix, without))
        (sign, size), (sign_of_soft, size_of_soft) = np.linalg.slogdet(stiff), np.linalg.slogdet(soft)
        assert sign * sign_of_soft * math.exp(size - size_of_soft) == pytest.approx(1 + spring, rel=1e-5, abs=1e-6), fix


@pytest.mark.parametrize(
    "fix",
    [
        "tension",
        "pressure",
        "tension,osmotic=5",
        "osmotic=500",
        "ade=2",
        "force",
        "tension,force",
        "pressure,force,ade=2",
    ],
)
def test_a_mesh_grows_like_the_smooth_shape(fix):
    """By Lanczos' method and inertia: against reduced modes, and dense algebra of the same mesh."""
    point = shape("coil", 0.3, 10, 0.93)
    exact = replace(point.problem, held=known_held(fix)).spectrum(point.u)
    problem, u = meshed_coil()
    mesh = replace(problem, held=known_held(fix))
    found = mesh.spectrum(u)
    assert found.complete
    assert found.n_unstable == exact.n_unstable
    if exact.n_unstable:
        assert found.mu_crit == pytest.approx(exact.mu_crit, abs=2e-3)
    without = replace(mesh, orbits=None).spectrum(u)
    assert without.n_unstable == found.n_unstable
    assert without.mu_crit == pytest.approx(found.mu_crit, abs=1e-7)
    f, vertices, directions = mesh.functional, mesh.vertices(u), mesh.directions
    second, sums = mesh.hessian(u), f.sums(vertices, directions, mesh.c0)
    mass, motions = f.normal_mass(vertices, directions)
    quantities = f.quantities(vertices, directions, sums, coefficients(u[-3], u[-2], mesh.c0))
    rows, stiffened = mesh.held.constrained(second.toarray(), quantities)
    more = len(stiffened) - len(u[: mesh.mesh.count])
    motions, mass = np.pad(motions, ((0, 0), (0, more))), block_diag(mass.toarray(), np.eye(more))
    rates = -eigh(*restricted([*rows, *motions], stiffened, mass), eigvals_only=True)
    np.testing.assert_allclose(without.rates[MeshBlock()][:4], rates[:4], rtol=1e-6, atol=1e-6)


@cache
def meshed_coil():
    point = shape("coil", 0.3, 10, 0.93)
    return meshed(point, 250)


@pytest.mark.parametrize(
    "fix", ["area,volume", "tension,pressure", "force", "tension,force", "tension,osmotic=8,force"]
)
def test_pearls_grow_like_graphs_whose_energy_is_summed_and_differentiated(fix):
    """Two equal pearls as a graph of the axis, stretched along it alone: another way to change the length."""
    problem, u = given("pearl")
    problem = replace(problem, cells=2, held=known_held(fix))
    known, most = problem.observables(u), 24
    waves = [(a, 0, f, np.cos) for a in range(most + 1) for f in (np.cos, np.sin) if a or f is np.cos]
    x, r = problem.profile(u).outline()
    places = np.arange(4 * most) / (4 * most) * known["L"]

    def graphs(length):
        return Graphs.of(2 * math.pi / length, 1, known["c0"], waves, (4 * most, 1))

    here = graphs(known["L"])
    w = np.linalg.lstsq(here.fields[:, 0].T, np.interp(places % (known["L"] / 2), x, r) - 1, rcond=None)[0]
    multipliers = np.array([1.0, known["lambda1"], known["lambda2"]])
    even = np.array([f is np.cos and a % 2 == 0 for a, _, f, _ in waves])
    for _ in range(6):
        gradient, hessian = (
            sum(m * part[i] for m, part in zip(multipliers, here.parts(w), strict=True)) for i in (1, 2)
        )
        w[even] -= np.linalg.solve(hessian[np.ix_(even, even)], gradient[even])

    def at(length):
        """Energy, area, volume of the whole tube and their gradients."""
        parts = graphs(length).parts(w)
        return 2 * math.pi * length * np.array([np.append(value, slope) for value, slope, _ in parts])

    def total(length):
        return multipliers @ at(length)

    step = 1e-3
    slopes = derivative(at, known["L"], step)
    assert multipliers @ slopes[:, 0] == pytest.approx(known["force"], abs=1e-5)
    curvature = derivative(lambda length: derivative(total, length, step)[0], known["L"], step)
    second = 2 * math.pi * known["L"] * sum(m * part[2] for m, part in zip(multipliers, here.parts(w), strict=True))
    mixed = multipliers @ slopes
    second = np.block([[second, mixed[1:, None]], [mixed[None, 1:], curvature]])
    gradients = np.column_stack((at(known["L"])[1:, 1:], slopes[1:, 0]))
    held = problem.held
    kept = np.ones(len(second), dtype=bool)
    kept[-1] = not held.length
    if held.solute is not None:
        volume = math.pi * known["v"] * known["L"]
        second += held.solute / volume**2 * np.outer(gradients[1], gradients[1])
    rows = [row[kept] for row, is_held in zip(gradients, (held.area, held.volume), strict=True) if is_held]
    (allowed,) = restricted(rows, second[np.ix_(kept, kept)])
    values = np.linalg.eigvalsh(allowed)
    rates = {block: rates for block, rates in problem.spectrum(u).rates.items() if block.n == 0}
    unstable = sum(block.multiplicity * int((found > 1e-7).sum()) for block, found in rates.items())
    assert (values < -1e-5).sum() == unstable
    assert (abs(values) < 1e-5).sum() == 1  # the shift along the axis


@pytest.mark.parametrize(("c0", "length", "m"), [(0.48, 15, 2), (0.4, 24, 3), (0.0, 20, 2)])
def test_localized_pearls_leave_equal_ones_at_the_same_place_whatever_is_held(c0, length, m):
    found = []
    for fix in ("area,volume", "tension,pressure", "tension,osmotic=300,force", "ade=1,osmotic=500"):
        branch = pb.branch(pb.Tube(c0, length), "pearl", (m, 0), fix=fix, until={"v": 1.06})
        blocks = [
            (special, branch.at(special)) for special in branch.find("bp") if special.block.j and special.block.n == 0
        ]
        found.append([(str(special.block), special.change, point.observables["v"]) for special, point in blocks])
    assert found[0]
    for others in found[1:]:
        assert [entry[:2] for entry in others] == [entry[:2] for entry in found[0]]
        np.testing.assert_allclose([v for *_, v in others], [v for *_, v in found[0]], rtol=1e-10)


def test_in_an_osmotic_bath_stability_changes_where_the_osmolarity_turns():
    branch = pb.branch(pb.Tube(-0.8, 25), "pearl", (3, 0), fix="osmotic=300")
    (fold,) = branch.find("fold:osmolarity")
    point = branch.at(fold)
    assert abs(point.problem.block_rates(point.u, point.problem.trivial_block, point.spectrum)).min() < 1e-6
    before, after = (branch.points[fold.index + i].spectrum.rates[point.problem.trivial_block] for i in (-1, 1))
    assert abs(int((after > 0).sum()) - int((before > 0).sum())) == 1
    # The branch ends against pure water, where nothing more comes in.
    assert branch.reason.startswith("beyond")
    known = branch[-1].observables
    assert known["osmolarity"] == pytest.approx(0.0, abs=1e-9)
    assert known["lambda2"] == pytest.approx(-300 / (math.pi * known["v"] * 25), rel=1e-9)


def test_a_pitchfork_is_met_from_its_side_whatever_is_held():
    """Localized pearls, varied in c0, become equal ones; several things vary here that tension and force hold."""
    pearls = pb.branch(pb.Tube(0.48, 15), "pearl", (2, 0), fix="tension,force", until={"bp": 1})
    moved = pearls.switch(1, until={"v": 1.02}).vary("c0", until={"c0": 0.7})
    assert "pitchfork" in moved.reason
    assert moved[-1].observables["c0"] == pytest.approx(0.53740935, abs=1e-6)


def test_what_area_differences_are_set_to():
    """``(pi alpha/A)(M - M0)^2`` pulls at ``M`` like the spontaneous curvature ``c0``: by ``-2 c0``."""
    alpha = 1.5
    known = pb.branch(pb.Tube(0.3, 10), "pearl", fix=f"ade={alpha}", max_points=3)[-1].observables
    area = 2 * math.pi * known["L"]
    pull = derivative(lambda m: math.pi * alpha / area * (m - known["M0"]) ** 2, known["M"], 1e-2)
    assert pull == pytest.approx(-2 * known["c0"], rel=1e-9)


@pytest.mark.parametrize(
    ("fix", "says"),
    [
        ("area,tension", "area and tension are both held; give one of the two"),
        ("osmotic=3,volume", "osmotic and volume are both held"),
        ("length,length", "length is given twice"),
        ("temperature", "'temperature' is nothing that can be held; choose of area or tension"),
        ("", "'' is nothing that can be held"),
        ("osmotic", "osmotic needs a number; give one like osmotic=1"),
        ("osmotic=-1", "osmotic=-1 is no solute; give an amount above 0"),
        ("osmotic=many", "osmotic: 'many' is not a number"),
        ("ade=0", "ade=0 is no modulus"),
        ("osmotic=1e20", "osmotic=1e20 is beyond 1e.12, where rounding would decide; the volume stays"),
        ("ade=1e30", "ade=1e30 is beyond 1e.12"),
        ("tension,ade=1", "ade goes by the area, which tension does not hold"),
        ("tension=0.3", r"stop there \(until lambda1=0.3\)"),
        ("force=2", r"stop there \(until force=2\)"),
        ("osmotic=1", "osmotic=1 has no equilibrium here.*give more than"),
        (None, "None must be a text"),
    ],
)
def test_mistakes_are_told_in_a_line(fix, says):
    with pytest.raises(InputError, match=f"^fix.*{says}"):
        pb.branch(pb.Tube(0.48, 15), "pearl", fix=fix, max_points=2)


def test_a_saved_branch_knows_what_was_held(tmp_path):
    for family in ("pearl", "ring", "coil"):
        branch = pb.branch(pb.Tube(-0.5, 10), family, fix="tension,osmotic=200.25,force", max_points=2)
        branch.save(tmp_path / "b.h5")
        there = pb.load(tmp_path / "b.h5")
        assert there[-1].problem.held == known_held("force,tension,osmotic=200.25")
        assert str(there[-1].problem.held) == "tension,osmotic=200.25,force"
