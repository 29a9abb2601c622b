"""Public names of one analysis each: their examples, what they agree with, and what is said of mistakes at their doors."""

import doctest
import importlib

import numpy as np
import pytest

import pearlbvp as pb
from pearlbvp.studies.branch import branch_options
from pearlbvp.studies.shape import shape_branch

FEW = {"max_points": 2}


@pytest.mark.parametrize("module", ["branches", "solutions", "front", "instabilities", "studies.localized"])
def test_examples_are_true(module):
    failed, tried = doctest.testmod(importlib.import_module(f"pearlbvp.{module}"))
    assert failed == 0 < tried


@pytest.fixture(scope="module")
def pearls():
    return pb.branch(pb.Tube(c0=0.48, L=15), "pearl", (2, 0), until={"v": 1.01})


@pytest.fixture(scope="module")
def coils():
    return pb.branch(pb.Tube(c0=0, L=10), "coil", until={"v": 0.97})


@pytest.fixture(scope="module")
def on_mesh(coils):
    return coils[-1].meshed(600)


def test_a_shape_on_a_mesh_knows_where_its_branch_leads(coils, on_mesh):
    """By slopes of the other discretization, to the error of 600 vertices, 1.4e-2 of lambda1 (a quarter of that of 300)."""
    by_v, exact = (
        {name: slope / point.slopes["v"] for name, slope in point.slopes.items()} for point in (on_mesh, coils[-1])
    )
    assert on_mesh.slopes["v"] > 0
    assert [by_v[name] for name in ("lambda1", "lambda2", "E")] == pytest.approx(
        [exact[name] for name in ("lambda1", "lambda2", "E")], rel=2e-2
    )
    assert on_mesh.meshed(1000).problem.mesh.count == on_mesh.problem.mesh.count  # it has its own


def test_the_branch_through_a_point_is_its_branch(pearls):
    through = pb.Branch.through(pearls[2], {"v": 1.01})
    assert through.complete
    assert through[-1].observables["lambda2"] == pytest.approx(pearls[-1].observables["lambda2"], abs=1e-9)
    assert [str(special.block) for special in through.find("bp")] == [
        str(special.block) for special in pearls.find("bp")
    ]
    assert pb.Branch.through(pearls[2], down=True, **FEW)[-1].observables["v"] < pearls[2].observables["v"]


def test_a_shape_on_a_mesh_is_drawn_with_its_triangles(on_mesh, coils):
    picture = on_mesh.plot()
    drawn = picture.axes[0].collections[0]
    assert len(drawn.get_paths()) == len(on_mesh.surface().triangles)
    assert picture.texts[0].get_text() == "v = 0.9700, stable"
    assert [text.get_text() for text in coils[-1].plot("a coil").texts] == ["a coil"]


def test_a_branch_from_a_shape_is_that_of_the_study():
    given = [-0.28, 0.47]
    found = pb.branch(pb.Tube(0.75, 10), "pearl", shape=given, volume=1.0, cells=2, until={"v": 1.001}, max_points=4)
    study = shape_branch(0.75, 10, 1.0, given, branch_options({"v": 1.001}, max_points=4), cells=2)
    assert found[0].observables["L"] == 20
    np.testing.assert_array_equal(found.table().v, study.table().v)


def test_growth_rates_of_single_waves_are_those_of_the_spectrum(pearls):
    """Where the wave fits the tube; the translation, which the spectrum leaves out, is among them."""
    point = pearls[-1]
    rates = {(block.n, block.j): found for block, found in point.spectrum.rates.items() if block.parity is None}
    for (n, j), found in rates.items():
        np.testing.assert_allclose(point.growth_rates(n, np.pi * j)[:3], found[:3], atol=1e-8)
    assert abs(point.growth_rates(1, 0.0)).min() < 1e-8


def test_two_modes_meet_where_the_closed_form_says():
    found = pb.amplitude_map("-0.2:0:0.1", [10, 20])
    exact = [pb.theory.meeting_c0((0, 2), (1, 1), length) for length in (10, 20)]
    assert found.meetings.c0.tolist()[:1] == pytest.approx(exact[:1], abs=1e-12)
    assert len(found.table) == 6
    assert [axes.get_xlabel() for axes in found.plot().axes] == ["spontaneous curvature c0 (1/radius)"] * 2


MISTAKES = {
    "volume: it goes with shape": lambda p, c: pb.branch(pb.Tube(0, 10), "pearl", volume=1.0),
    "cells: it goes with shape": lambda p, c: pb.branch(pb.Tube(0, 10), "pearl", cells=2),
    "shape: it is for pearls only; leave it out with coil": lambda p, c: pb.branch(
        pb.Tube(0, 10), "coil", shape=[0.1], volume=1
    ),
    "volume: a shape of least energy is one": lambda p, c: pb.branch(pb.Tube(0, 10), "pearl", shape=[0.1]),
    "mode: it does not go with shape": lambda p, c: pb.branch(pb.Tube(0, 10), "pearl", (1, 0), shape=[0.1], volume=1),
    "nodes: it does not go with shape": lambda p, c: pb.branch(
        pb.Tube(0, 10), "pearl", nodes=99, shape=[0.1], volume=1
    ),
    "shape: 0.1 must be a list": lambda p, c: pb.branch(pb.Tube(0, 10), "pearl", shape=0.1, volume=1),
    "tube: float must be a tube": lambda p, c: pb.branch(0.75, "pearl", shape=[0.1], volume=1),
    "mode: the table's branch leaves the cylinder at lambda2 = ": lambda p, c: p.compared((1, 0)),
    "family: .1,1. is a mode of coil and buckle; say which": lambda p, c: p.compared((1, 1)),
    "family: pearl does not branch off at mode": lambda p, c: c.compared((1, 1), "pearl"),
    "tube: float must be a tube; give": lambda p, c: pb.predicted_branch(0.48, (1, 0)),
    "family: coil does not branch off": lambda p, c: pb.predicted_branch(pb.Tube(0, 10), (1, 0), "coil"),
    "largest: at A = 5 the predicted pearl": lambda p, c: pb.predicted_branch(pb.Tube(0, 10), (1, 0), largest=5),
    "points: list has no points of branches in it": lambda p, c: pb.plot_shapes([]),
    "points: int has no points": lambda p, c: pb.plot_shapes(3),
    "point: str must be a point of a branch": lambda p, c: pb.plot_shapes(["a"]),
    "titles: there are 2 for 1 points": lambda p, c: pb.plot_shapes([p[0]], ["a", "b"]),
    "columns: 0 must be a whole number": lambda p, c: pb.plot_shapes([p[0]], columns=0),
    "c0: 'x' is not a finite number": lambda p, c: pb.amplitude_map("x", 10),
    "length: -1.0 must be positive": lambda p, c: pb.amplitude_map(0, -1),
    "mode: rings have a whole number of lobes": lambda p, c: pb.ring_onsets(0, 1, 5),
    "period: 5 is not above 2 pi": lambda p, c: pb.PeriodicPearls.trace(0.48, 5),
    "pearls: 'x' is not a number": lambda p, c: pb.PeriodicPearls.trace(0.48, 7.5, "x"),
    "samples: 0 must be a whole number": lambda p, c: pb.PeriodicPearls.trace(0.48, 7.5).table(0),
    "point: a coil is not made of equal periods": lambda p, c: c[-1].growth_rates(),
    "n: 'a' must be a whole number": lambda p, c: p[-1].growth_rates("a"),
    "theta: 'x' is not a number": lambda p, c: p[-1].growth_rates(0, "x"),
    "point: it is the straight tube": lambda p, c: c[0].meshed(),
    "nodes: 'a' must be a whole number": lambda p, c: c[-1].meshed("a"),
    "discretization: 'modes' is unknown": lambda p, c: c[-1].meshed(300, "modes"),
    "fix: 'x' is nothing that can be held": lambda p, c: c[-1].meshed(300, fix="x"),
    "point: v does not vary on its branch": lambda p, c: pb.Branch.through(p.vary("c0", **FEW)[-1]),
    "point: Branch must be a point of a branch": lambda p, c: pb.Branch.through(p),
    "foo: there is no such argument": lambda p, c: pb.Branch.through(p[-1], foo=1),
}


@pytest.mark.parametrize("said", MISTAKES)
def test_mistakes_are_one_line(pearls, coils, said):
    with pytest.raises(pb.InputError, match=f"^{said}") as refused:
        MISTAKES[said](pearls, coils)
    assert "\n" not in str(refused.value)
