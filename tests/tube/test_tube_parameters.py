"""Tubes in reduced modes with other parameters free: derivatives, and branches of the tubes that they lead to."""

import io
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq
from support.commands import run

from pearlbvp.errors import InputError
from pearlbvp.held import Held
from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.onward import STRAIGHT_WAVE, followed, switched, varied
from pearlbvp.studies.saved import load, save
from pearlbvp.theory.codimension_two import exchange_lengths
from pearlbvp.tube.onset import onset
from pearlbvp.tube.problem import TubeProblem
from pearlbvp.tube.shapes import TubeParameters

NAMES = ("lambda1", "lambda2", "v", "E", "r_min", "r_max", "c0", "L")


@pytest.fixture(scope="module")
def coils():
    return family_branch(Tube(0.48, 10), "coil", (1, 1), branch_options({"v": 0.9}, max_step=0.3))


@pytest.fixture(scope="module")
def buckles():
    return family_branch(Tube(0.48, 10), "buckle", (1, 1), branch_options({"v": 0.97}, max_step=0.15))


def perturbed(family, m, n, *free, size=(4, 5)):
    problem, u, direction = onset(Tube(0.3, 10), family, m, n, size=size)
    rng = np.random.default_rng(1)
    u = u + 0.1 * direction + 0.04 / len(problem.modes) * rng.standard_normal(u.size)
    return (*problem.freeing(u, *free), rng)


@pytest.mark.parametrize(("family", "m", "n"), [("coil", 2, 1), ("buckle", 1, 1), ("buckle", 2, 2), ("pearl", 1, 0)])
def test_the_derivatives_by_c0_and_length_are_the_residual_s(family, m, n):
    """Differences of fourth order: by c0, in which the residual is quadratic, exact; by the length to O(h^4)."""
    problem, u, rng = perturbed(family, m, n, "lambda1", "lambda2", "v", "c0", "length")
    rows = rng.standard_normal((3, u.size))
    for name, h, accuracy in (("c0", 0.5, 1e-11), ("length", 0.02, 1e-9)):
        unit = np.zeros(u.size)
        unit[problem.place(name)] = 1.0
        near, far = ((problem.residual(u + d * unit) - problem.residual(u - d * unit)) / (2 * d) for d in (h, 2 * h))
        change = (4 * near - far) / 3
        assert np.abs(change).max() > 1e-3
        # What the solver holds for this derivative: its system maps the unit vector to it.
        known = np.append(change, [problem.inner(row, unit) for row in rows])
        found = problem.solve(u, known, rows)
        condition = np.abs(np.linalg.inv(_matrix(problem, u, rows))).sum(axis=1).max()
        np.testing.assert_allclose(found, unit, atol=accuracy * condition)


def _matrix(problem, u, rows):
    """The bordered Jacobian, from its solves."""
    return np.linalg.inv(problem.solve(u, np.eye(u.size), rows))


def test_a_residual_is_that_of_the_tube_of_its_parameters():
    """A problem with everything free, at parameters far from those it was made with, and a problem made for these."""
    problem, u, _ = perturbed("buckle", 1, 1, *TubeParameters._fields, size=(10, 10))
    u[-5:] = 0.2, -0.3, 0.93, -0.4, 14.0
    known = TubeProblem(problem.symmetry, -0.4, 14.0, problem.size)
    w = np.append(problem.coefficients(u), u[-5:-2])
    np.testing.assert_allclose(problem.residual(u), known.residual(w), atol=1e-12)
    assert problem.observables(u) == pytest.approx(known.observables(w), abs=1e-12)
    one, other = problem.spectrum(u), known.spectrum(w)
    assert one.rates.keys() == other.rates.keys()
    for block, rates in one.rates.items():
        np.testing.assert_allclose(rates, other.rates[block], atol=1e-8)
        np.testing.assert_allclose(problem.block_rates(u, block, one), rates, atol=1e-12)
    for mine, its in zip(problem.surface(u, around=12), known.surface(w, around=12), strict=True):
        np.testing.assert_allclose(mine, its, atol=1e-12)


def test_a_coil_varied_in_c0_and_length_is_that_of_the_other_tube(coils, tmp_path):
    moved = varied(coils, -1, "c0", branch_options({"c0": 0.3}), upwards=False)
    longer = varied(moved, -1, "L", branch_options({"L": 11.0}))
    assert moved.complete
    assert longer.complete
    expected = family_branch(Tube(0.3, 11), "coil", (1, 1), branch_options({"v": 0.9})).points[-1]
    found = longer.points[-1]
    for name in NAMES:
        assert found.observables[name] == pytest.approx(expected.observables[name], abs=1e-8)
    assert found.spectrum.n_unstable == expected.spectrum.n_unstable
    assert found.spectrum.mu_crit == pytest.approx(expected.spectrum.mu_crit, abs=1e-7)
    # Saved and loaded it is the same problem.
    save(longer, tmp_path / "l.h5")
    again = load(tmp_path / "l.h5").points[-1]
    assert again.problem.free == ("lambda1", "lambda2", "length")
    np.testing.assert_array_equal(again.problem.residual(again.u), found.problem.residual(found.u))
    tree = coils.points[-1].problem.to_tree()
    with pytest.raises(ValueError, match="^free: "):
        TubeProblem.from_tree(tree | {"free": "v,lambda1,lambda2"})


def test_a_coil_varied_at_fixed_pressure_keeps_it(coils):
    moved = varied(coils, -1, "c0", branch_options({"c0": 0.46}), keep="lambda2", upwards=False)
    lambda2 = coils.points[-1].observables["lambda2"]
    np.testing.assert_array_equal(moved.table().lambda2, lambda2)
    there = family_branch(Tube(0.46, 10), "coil", (1, 1), branch_options({"lambda2": lambda2})).points[-1].observables
    for name in NAMES:
        assert moved.points[-1].observables[name] == pytest.approx(there[name], abs=1e-8)


def test_the_coils_branch_point_followed_in_c0_is_that_of_the_other_branch(coils):
    assert coils.at(coils.find("bp")[0]).observables["v"] == pytest.approx(0.906194, abs=1e-6)
    options = branch_options({"c0": 0.43}, step=0.05, max_step=0.2)
    curve = followed(coils, "bp", 1, "c0", options, upwards=False)
    assert curve.complete
    there = family_branch(Tube(0.43, 10), "coil", (1, 1), branch_options({"v": 0.92}))
    expected = there.at(there.find("bp")[0]).observables
    for name in NAMES:
        assert curve.points[-1].observables[name] == pytest.approx(expected[name], abs=1e-7)
    # Stability along it, without the rate that is zero: the coil's own there.
    assert curve.points[-1].spectrum.n_unstable == there.at(there.find("bp")[0]).spectrum.n_unstable


@pytest.mark.parametrize(("vary", "upwards"), [("L", True), ("c0", False)])
def test_coils_and_buckles_exchange_stability_where_theory_says(coils, vary, upwards):
    """The branch point followed to the straight tube: the amplitude equations' ``b1 = b2``, 13.0252 at c0 = 0.48."""
    options = branch_options(step=0.05, max_step=0.2)
    curve = followed(coils, "bp", 1, vary, options, upwards=upwards)
    assert "straight tube" in curve.reason
    if vary == "L":
        expected = exchange_lengths(0.48)[1]
        assert expected == pytest.approx(13.025, abs=5e-4)
    else:
        expected = brentq(lambda c0: exchange_lengths(c0)[1] - 10, 0.34, 0.4)
    squares = [entry.problem.base.signed_amplitude(entry.u) ** 2 for entry in curve.points[-2:]]
    values = [entry.observables[vary] for entry in curve.points[-2:]]
    assert squares[1] < 1.5 * STRAIGHT_WAVE**2
    found = values[1] - squares[1] * (values[1] - values[0]) / (squares[1] - squares[0])
    # Even in the wave, and linear in its square up to squares[0] * squares[1], 2e-6 and 1e-6 here.
    assert found == pytest.approx(expected, abs=5e-6)


def test_the_buckles_fold_followed_in_length_is_that_of_the_other_branch(buckles):
    fold = buckles.at(buckles.find("fold:lambda2")[0]).observables
    assert fold["v"] == pytest.approx(0.979822, abs=1e-5)
    curve = followed(buckles, "fold:lambda2", 1, "L", branch_options({"L": 11.0}, step=0.1, max_step=0.4))
    assert curve.complete
    there = family_branch(Tube(0.48, 11), "buckle", (1, 1), branch_options({"v": 0.987}, max_step=0.1))
    expected = there.at(there.find("fold:lambda2")[0]).observables
    found = curve.points[-1].observables
    for name in ("lambda1", "lambda2", "E", "v"):  # lambda2 is stationary there, v is where differences of it vanish
        assert found[name] == pytest.approx(expected[name], abs=1e-6 if name == "v" else 1e-7)


def test_a_mixed_tube_varies(coils):
    """What joins coils and buckles, moved to c0 = 0.479: a point of what branches off the coils there."""
    between = switched(coils, 1, branch_options({"v": 0.907}))
    moved = varied(between, -1, "c0", branch_options({"c0": 0.479}), upwards=False)
    assert moved.complete
    here = family_branch(Tube(0.479, 10), "coil", (1, 1), branch_options({"v": 0.9}, max_step=0.3))
    expected = switched(here, 1, branch_options({"v": 0.907})).points[-1].observables
    for name in NAMES:
        assert moved.points[-1].observables[name] == pytest.approx(expected[name], abs=1e-8)


def test_what_perturbations_keep_and_the_branch_does_not(coils):
    point = coils.points[-1]
    for free, expected in (
        (("lambda1", "lambda2", "v"), "v"),
        (("lambda1", "lambda2", "c0"), "c0"),
        (("lambda1", "length", "lambda2"), "L"),
        (("lambda1", "v", "c0"), ""),
    ):
        problem, _ = point.problem.freeing(point.u, *free)
        assert problem.conserved == expected
        assert (
            replace(problem, held=Held(volume=False)).conserved
            == {"v": "lambda2", "c0": "", "L": "", "": "c0"}[expected]
        )
    with pytest.raises(ValueError, match="^free: "):
        point.problem.freeing(point.u, "volume")
    with pytest.raises(ValueError, match="^second: "):
        point.problem.with_one_more_free("lambda2", point.u, point.tangent)


def test_rings_are_refused():
    ring = family_branch(Tube(-1.0, 10), "ring", (0, 2), branch_options({"v": 0.99}))
    for study in (
        lambda: varied(ring, -1, "c0", branch_options()),
        lambda: followed(ring, "bp", 1, "L", branch_options()),
    ):
        with pytest.raises(InputError, match=r"^vary: the shape of rings .*studies\.ring_onsets"):
            study()


def rows_of(capsys, *arguments):
    """Table of ``pearlbvp branch coil``, which has to succeed."""
    status, out, err = run(capsys, *arguments)
    assert status == 0, err
    return pd.read_csv(io.StringIO(out), keep_default_na=False)


def test_tubes_are_varied_and_followed_from_the_command_line(coils, capsys, tmp_path):
    saved, moved = tmp_path / "c.h5", tmp_path / "m.h5"
    save(coils, saved)
    arguments = ["vary", str(saved), "c0", "--down"]
    place = coils.find("bp")[0].index
    table = rows_of(capsys, *arguments, "--point", str(place), "--until", "c0=0.47", "--save", str(moved))
    assert table.special.iloc[-1] == "stop"  # what the branch starts at is not met once more
    assert table.c0.iloc[-1] == 0.47
    assert table.v.iloc[-1] == pytest.approx(0.906194, abs=1e-6)
    table = rows_of(capsys, "vary", str(moved), "L", "--keep", "lambda2", "--until", "L=10.2")
    assert np.ptp(table.lambda2) == 0
    assert table.L.iloc[-1] == 10.2
    plot = tmp_path / "f.png"
    table = rows_of(capsys, "follow", str(saved), "bp:1", "c0", "--down", "--until", "c0=0.47", "--plot", str(plot))
    assert table.c0.iloc[-1] == pytest.approx(0.47, abs=1e-10)
    assert plot.read_bytes()[:4] == b"\x89PNG"
