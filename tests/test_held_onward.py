"""What is held from a point of a branch on, and in physical units."""

import io
import math

import numpy as np
import pandas as pd
import pytest
from scipy.constants import R, k
from support.commands import run

import pearlbvp as pb
from pearlbvp.errors import InputError
from pearlbvp.held import known_held
from pearlbvp.studies.branch import branch_options
from pearlbvp.studies.diagram import diagram
from pearlbvp.studies.mesh import equilibrium_table, meshed
from pearlbvp.theory.dispersion import critical_lambda2

TUBE = pb.Tube(0.48, 15)


def to_the_branch_point(fix):
    return pb.branch(TUBE, "pearl", (2, 0), fix=fix, until={"bp": 1})


def own_rates(point):
    """Growth rates of the perturbations of the shape's own symmetry."""
    return point.spectrum.rates[point.problem.trivial_block]


def assert_judged_alike(one, other, unlike):
    assert len(one) == len(other) > 1
    for first, second, third in zip(one, other, unlike, strict=True):
        assert first.problem.shapes.held == second.problem.shapes.held
        assert first.observables["v"] == pytest.approx(second.observables["v"], abs=1e-9)
        assert first.spectrum.n_unstable == second.spectrum.n_unstable
        np.testing.assert_allclose(own_rates(first), own_rates(second), rtol=1e-7, atol=1e-9)
        count = min(len(own_rates(first)), len(own_rates(third)))  # without the rows of constraints there are more
        assert abs(own_rates(first)[:count] - own_rates(third)[:count]).max() > 1e-3


@pytest.mark.parametrize("fix", ["tension,volume", "tension,pressure", "tension,osmotic=20,force"])
def test_what_goes_on_is_judged_as_if_all_of_it_had_been(fix):
    """By area and volume up to a point and by something else from there on, and by that from the straight tube on."""
    usual, own = to_the_branch_point("area,volume"), to_the_branch_point(fix)
    for on in (
        lambda branch, **fix: branch.switch(1, {"v": 1.02}, **fix),
        lambda branch, **fix: branch.vary("c0", {"c0": 0.47}, **fix),
        lambda branch, **fix: branch.follow("bp", 1, "c0", {"c0": 0.47}, **fix),
    ):
        assert_judged_alike(on(usual, fix=fix), on(own), on(usual))
    assert str(usual[-1].problem.held) == "area,volume"


@pytest.mark.parametrize("fix", ["tension,pressure", "tension,osmotic=60", "tension,volume"])
@pytest.mark.parametrize(("c0", "m"), [(-0.8, 1), (0.48, 1)])
def test_the_straight_tube_widens_where_its_energy_by_the_radius_is_concave(c0, m, fix):
    """``F = pi L/(2 r) + 2 pi L r (c0^2 + lambda1) + pi L r^2 lambda2`` with tension and pressure given, ``4 N`` with solute."""
    length = 12.0
    lambda2 = float(critical_lambda2(2 * math.pi * m / length, 0, c0))
    stiffness = math.pi * length * (1 + 2 * lambda2) + 4 * float(fix.partition("=")[2] or 0)
    widens = int(stiffness < 0 and "volume" not in fix)
    rates = []
    for held in ("area,volume", fix):
        found = diagram(c0, length, 0, branch_options(max_points=2), modes=[(m, 0)], fix=held)
        start = found.branches[str(m)].points[0]
        rates.append(sum(block.multiplicity * int((r > 1e-6).sum()) for block, r in start.spectrum.rates.items()))
    assert rates[1] == rates[0] + widens


@pytest.mark.parametrize("fix", ["tension,force", "tension,pressure"])
def test_a_mesh_of_a_shape_is_judged_by_what_is_asked(fix):
    """Against the same shape on a branch that is judged by it all along."""
    usual, own = (pb.branch(pb.Tube(0.3, 10), "coil", fix=what, until={"v": 0.95})[-1] for what in ("area,volume", fix))
    table = equilibrium_table(*meshed(usual, 300, fix=fix))
    assert table["n_unstable"][0] == own.spectrum.n_unstable
    assert own.spectrum.n_unstable > usual.spectrum.n_unstable
    assert table["mu_crit"][0] == pytest.approx(own.spectrum.mu_crit, abs=5e-3)


@pytest.mark.parametrize("radius", ["50nm", "0.05um"])
@pytest.mark.parametrize(("kappa", "convention"), [("20kT", "physicists"), ("40kT", "mem3dg")])
def test_solute_by_its_concentration_and_area_differences_by_their_modulus(radius, kappa, convention):
    """300 mol/m^3 of the straight tube's volume, by the gas constant, and pi kbar/(2 A D^2) (2 D)^2 by 2 kappa."""
    units, length = pb.Units.of(radius, kappa, "300K", convention), 12.5
    rigidity = 20 * k * 300
    held = known_held(units.fix("tension,osmotic=300mM,force", length))
    assert str(held).startswith("tension,osmotic=")
    assert held.solute == pytest.approx(300 * R * 300 * math.pi * 50e-9**3 * length / (2 * rigidity), rel=1e-9)
    assert round(held.solute / (math.pi * length)) == 565
    # (pi alpha/A)(M - M0)^2 counts in 2 kappa, and Delta A = 2 D M.
    for kbar, text in ((60.0, "60kT"), (0.5, f"{0.5 * k * 300!r}J")):
        alpha = known_held(units.fix(f"ade={text}", length)).ade
        assert math.pi * alpha * 2 * rigidity == pytest.approx(math.pi * kbar * k * 300 / 2 * 2**2, rel=1e-9)
    assert units.fix("tension,osmotic=5", length) == "tension,osmotic=5"


def table_of(out):
    return pd.read_csv(io.StringIO(out))


def test_the_options_of_commands_are_those_of_python(tmp_path, capsys):
    pearls = to_the_branch_point("area,volume")
    pearls.save(tmp_path / "b.h5")
    for command, expected in (
        (["switch", tmp_path / "b.h5", 1, "--until", "v=1.02"], lambda fix: pearls.switch(1, {"v": 1.02}, fix=fix)),
        (
            ["vary", tmp_path / "b.h5", "c0", "--until", "C0=0.0188/nm", "--down"],
            lambda fix: pearls.vary("c0", {"c0": 0.47}, fix=fix),
        ),
        (
            ["follow", tmp_path / "b.h5", "bp:1", "c0", "--until", "C0=0.0188/nm", "--down"],
            lambda fix: pearls.follow("bp", 1, "c0", {"c0": 0.47}, fix=fix),
        ),
    ):
        for text, fix in (("tension,force", "tension,force"), ("osmotic=300mM,tension", f"tension,osmotic={SOLUTE}")):
            status, out, _ = run(capsys, *command, "--fix", text, "--radius", "50nm", "--kappa", "20kT")
            found, table = table_of(out), expected(fix).table(pb.Units.of("50nm", "20kT"))
            assert status == 0
            assert list(found["n_unstable"]) == list(table["n_unstable"])
            np.testing.assert_allclose(found["mu_crit[Pa/nm]"], table["mu_crit[Pa/nm]"], rtol=1e-4, atol=1e-6)
            if "osmotic" in text:
                np.testing.assert_allclose(found["osmolarity[Pa]"], table["osmolarity[Pa]"], rtol=1e-8)
    status, out, _ = run(
        capsys,
        "diagram",
        "--c0",
        0.48,
        "--length",
        15,
        "--mode",
        "2,0",
        "--until",
        "v=1.02",
        "--fix",
        "tension,pressure",
    )
    expected = pb.branch(TUBE, "pearl", (2, 0), fix="tension,pressure", until={"v": 1.02})
    found = table_of(out)
    assert status == 0
    assert list(found[found["branch"] == "2"]["n_unstable"]) == list(expected.table()["n_unstable"])
    localized = expected.switch(1, {"v": 1.02}).table()
    assert list(found[found["branch"] == "2/1"]["n_unstable"]) == list(localized["n_unstable"])


SOLUTE = 300 * R * 310 * math.pi * 50e-9**3 * 15 / (40 * k * 310)


def test_mistakes_are_told_in_a_line(tmp_path, capsys):
    pearls = to_the_branch_point("area,volume")
    pearls.save(tmp_path / "b.h5")
    longer = pearls.vary("L", {"L": 15.2})
    longer.save(tmp_path / "l.h5")
    units = ["--radius", "50nm", "--kappa", "20kT"]
    for arguments, says in (
        (["switch", "b.h5", 1, "--fix", "osmotic=300mM"], "--fix: osmotic=300mM takes the tube's radius and rigidity; give --radius 50nm or the like, and give --kappa 20kT"),
        (["switch", "b.h5", 1, "--fix", "ade=60kT", "--radius", "50nm"], "--fix: ade=60kT takes the tube's radius and rigidity"),
        (["switch", "b.h5", 1, "--fix", "osmotic=300nm", *units], "--fix: osmotic=300nm is no concentration; give one like 300mM"),
        (["switch", "b.h5", 1, "--fix", "ade=60nm", *units], "--fix: ade=60nm is no energy; give one like 60kT"),
        (["switch", "b.h5", 1, "--fix", "osmotic=0mM", *units], "--fix: osmotic=0 is no solute"),
        (["switch", "b.h5", 1, "--fix", "osmotic=1"], "--fix: osmotic=1 has no equilibrium here"),
        (["vary", "b.h5", "c0", "--fix", "osmotic=1"], "--fix: osmotic=1 has no equilibrium here"),
        (["follow", "b.h5", "bp:1", "c0", "--fix", "osmotic=1"], "--fix: osmotic=1 has no equilibrium here"),
        (["vary", "l.h5", "c0", "--fix", "osmotic=300mM", *units], "--fix: L varies along the branch"),
        (["resume", "b.h5", "--fix", "tension"], "--fix: a branch is judged by one thing throughout"),
        (["diagram", "b.h5", "--fix", "tension"], "--fix: it does not go with FILE.h5"),
        (["mesh", "--from", "b.h5", "--fix", "tension"], "--fix: it goes with --solve"),
        (["mesh", "--from", "b.h5", "--solve", "--fix", "osmotic=1"], "--fix: osmotic=1 has no equilibrium here"),
    ):  # fmt: skip
        words = [tmp_path / word if str(word).endswith(".h5") else word for word in arguments]
        status, out, said = run(capsys, *words)
        assert (status, out) == (2, ""), arguments
        assert says in said
        assert said.count("\n") == 1
    curve = pearls.follow("bp", 1, "c0", {"c0": 0.47})
    with pytest.raises(InputError, match="^fix: a curve of special points keeps what is held"):
        curve.vary("c0", fix="tension")
    with pytest.raises(InputError, match=r"^fix: osmotic=300mM has a unit; convert it.*\.fix\(text, L\)"):
        pearls.switch(1, fix="osmotic=300mM")
