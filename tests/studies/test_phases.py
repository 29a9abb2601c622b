"""Which shape a tube takes: against AUTO-07p, elastic rings in closed form, and Maxwell's rule of equal areas."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import pearlbvp as pb
from pearlbvp.errors import InputError
from pearlbvp.figures.phases import draw_phases
from pearlbvp.helfrich import Tube
from pearlbvp.studies.localized import localized_pearls
from pearlbvp.studies.phases import default_modes, phases
from pearlbvp.studies.ring_onsets import neutral_rings
from pearlbvp.studies.stable_shapes import COLUMNS, largest_volume
from pearlbvp.studies.stretches import pieces
from pearlbvp.studies.transitions import COLUMNS as EVENTS
from pearlbvp.studies.transitions import STRAIGHT
from pearlbvp.theory.elastica import ring_at
from pearlbvp.tube import perturbations

AUTO = pd.read_csv(Path(__file__).parents[1] / "data" / "auto07p_pearl_c0_0_L10_m1.csv")


@pytest.fixture(scope="module")
def three():
    """Three equal pearls, which jump to one large and two smaller ones."""
    return phases(Tube(0.48, 22), [1.0, 1.005, 1.00615, 1.01], modes=[(3, 0)], flows=True)


def integrated(piece, ends, turn=None):
    """Integral of ``lambda2`` by ``v`` from one volume to another; at a fold ``v - turn`` is the square of a smooth number."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    if turn is None:
        (low, high), scale = ends, np.ones(8)
        places = (low + high) / 2 + (high - low) / 2 * nodes
    else:
        low, high = (math.sqrt(v - turn) for v in ends)
        roots = (low + high) / 2 + (high - low) / 2 * nodes
        places, scale = turn + roots**2, 2 * roots
    pressures = [piece.at(v).observables["lambda2"] for v in places]
    return (high - low) / 2 * float(np.sum(weights * scale * pressures))


def test_at_the_maxwell_point_areas_are_equal(three):
    """From the one shape along both branches to the other, ``-2 dE = lambda2 dv`` adds up to nothing; no energy is asked."""
    (event,) = three.transitions[three.transitions["event"] == "maxwell"].itertuples()
    assert (event.branch, event.other) == ("3", "3/1")
    assert pytest.approx(event.E_other, abs=1e-12) == event.E
    own, other = pieces("3", three.branches["3"]), pieces("3/1", three.branches["3/1"])
    bp, turn = own[0].high, other[0].low
    path = integrated(own[0], (event.v, bp))
    path += integrated(other[0], (bp, turn), turn) + integrated(other[1], (turn, event.v), turn)
    assert abs(path) < 1e-8 * abs(event.lambda2 - event.lambda2_other)  # so that the volume is right to 1e-8


def test_stability_changes_where_they_are_computed_otherwise(three):
    table = three.transitions.set_index(["event", "branch"])
    assert list(three.transitions) == EVENTS
    assert table.loc[("unstable", "3"), "v"] == pytest.approx(localized_pearls(0.48, 22 / 3, 22).v.iloc[0], abs=1e-9)
    assert table.loc[("unstable", "3"), "other"].split()[0] == "3/1"
    assert table.loc[("stable", "3/1"), "special"].startswith("fold:v")
    assert table.loc[("unstable", "3"), "falls_to"] == "3/1"  # by the flow
    assert table.loc[("stable", "3/1"), "falls_to"] == "3"  # as the volume falls
    order = [table.loc[key, "v"] for key in (("stable", "3/1"), ("maxwell", "3"), ("unstable", "3"))]
    assert order == sorted(order)
    assert list(three.ranges["branch"]) == ["3", "3/1"]
    assert list(three.branches) == ["3", "3/1", "3/1 shrink"]  # the two halves of a transcritical crossing
    assert three.skipped == {"3/1 neck": "it is the branch 3/1"}
    assert set(three.table.loc[three.table["branch"] == "3/1", "multiplicity"]) == {
        2
    }  # a pearl or a neck at its centre
    assert set(three.table.loc[three.table["branch"] == "3", "multiplicity"]) == {1}


def test_all_stable_shapes_of_a_volume_stand_by_their_energy(three):
    assert list(three.table) == COLUMNS
    between = three.table[three.table["v"] == 1.00615]
    assert list(between["branch"]) == ["3/1", "3"]  # beyond the Maxwell point, before three pearls lose stability
    assert list(between["rank"]) == [1, 2]
    assert (between["n_unstable"] == 0).all()
    assert between["excess"].iloc[0] == 0 < between["excess"].iloc[1]
    shapes = three.shapes(1.00615)
    assert [shape.observables["v"] for shape in shapes.values()] == pytest.approx([1.00615, 1.00615], abs=1e-12)
    (straight,) = three.table[three.table["v"] == 1].itertuples()
    assert (straight.branch, straight.E) == (STRAIGHT, pytest.approx(0.02**2))
    assert math.isnan(straight.lambda2)


def test_one_volume_alone_has_its_shapes_and_no_picture():
    found = phases(Tube(0.48, 15), 1.0, depth=0, modes=[(2, 0)])
    assert list(found.table["branch"]) == [STRAIGHT]
    assert found.transitions.empty
    with pytest.raises(InputError, match="^plot: "):
        draw_phases(found)


def test_one_cell_and_three_are_one_shape(three):
    cell = phases(Tube(0.48, 22 / 3), [1.005], modes=[(1, 0)], depth=0).table.iloc[0]
    tube = three.table[three.table["v"] == 1.005].iloc[0]
    for name in ("E", "lambda1", "lambda2", "force", "r_min", "r_max"):
        assert tube[name] == pytest.approx(cell[name], abs=1e-10)
    assert (cell["symmetry"], tube["symmetry"]) == ("1 period, axisymmetric", "3 periods, axisymmetric")


def test_pearls_are_those_of_auto():
    rows = AUTO[AUTO["v"].isin([1.001, 1.005])]
    assert len(rows) == 2
    found = phases(Tube(0.0, 10), rows["v"], modes=[(1, 0)], depth=0)
    for name in ("lambda1", "lambda2", "E"):
        np.testing.assert_allclose(found.table[name], rows[name], atol=2e-9)
    assert found.transitions.empty
    assert "1" in repr(found)


def test_rings_are_elastic_rings_and_end_where_waves_grow():
    found = phases(Tube(-1.0, 10), [0.87, 0.9, 0.95], modes=[(0, 2)], depth=0)
    rows = found.table.set_index("v")
    for v in (0.9, 0.95):
        exact = ring_at(2, "v", v)
        assert rows.loc[v, "E"] == pytest.approx(exact.energy(-1.0), abs=1e-10)
        assert rows.loc[v, "lambda2"] == pytest.approx(exact.lambda2, abs=1e-9)
    assert rows.loc[0.87, "branch"] == ""
    assert "no stable shape" in rows.loc[0.87, "message"]
    limit = found.transitions[found.transitions["event"] == "stable"].iloc[0]
    assert limit["v"] == pytest.approx(neutral_rings(-1.0, 2, [2 * math.pi / 10]).iloc[0].v, abs=1e-8)
    assert list(found.ranges["branch"]) == ["", "ring 0:2"]


def test_pearls_that_lose_their_axis_flow_to_bent_ones():
    found = phases(Tube(0.4, 4.5), [0.959, 0.961], modes=[(1, 0)], flows=True)
    below = found.transitions.set_index(["event", "branch"]).loc[("stable", "1")]
    assert (below.falls_to, below.critical, below.other) == ("1/1", "n=1 j=0/1 even", "1/1")
    shapes = found.shapes(0.959)
    assert [shape.problem.family for shape in shapes.values()] == ["buckle"]


def test_pearls_that_are_stable_in_a_narrow_range_only():
    """Pearls of period 4.5 at ``c0 = 0.6`` are stable near ``v = 0.9453``: bent below, unequal above."""
    found = phases(Tube(0.6, 9), [0.94, 0.95], modes=[(2, 0)], depth=1, unstable=0)
    assert list(found.shapes(0.94)) == ["2/7"]  # the bent ones
    assert found.shapes(0.94)["2/7"].spectrum.n_unstable == 0
    table = found.transitions.set_index(["event", "branch"])
    limits = [table.loc[(event, "2"), "v"] for event in ("stable", "unstable")]
    assert limits[0] < 0.94531 < limits[1] < 0.94535
    assert (table.loc[("stable", "2"), "other"], table.loc[("unstable", "2"), "other"]) == ("2/7", "2/6")


def test_modes_that_matter_are_those_of_least_energy_beside_the_straight_tube():
    assert default_modes(Tube(0.0, 10), below=False, above=True) == [(1, 0)]
    below = default_modes(Tube(0.0, 10), below=True, above=False)
    assert below[:2] == [(1, 1), (0, 2)]
    assert (3, 0) not in below
    assert (2, 0) in default_modes(Tube(0.6, 9), below=False, above=True)  # of k > 1


def test_no_tube_holds_more_than_a_sphere_or_a_cylinder():
    """Of one area: the sphere's radius is ``sqrt(L/2)``."""
    radius = math.sqrt(10 / 2)
    assert largest_volume(Tube(0.0, 10)) == pytest.approx(4 / 3 * math.pi * radius**3 / (math.pi * 10))
    assert largest_volume(Tube(0.0, 3)) == 1


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("x", [1.1]), "tube"),
        ((Tube(0.0, 10), [1.6]), "volumes: no tube of that area"),
        ((Tube(0.0, 10), [0.0]), "volumes: 0 must be above 0"),
        ((Tube(0.0, 10), []), "volumes: the list is empty"),
        ((Tube(0.0, 10), "1.3:0.6:0.1"), "volumes: .* never reaches"),
    ],
)
def test_mistakes(arguments, named):
    with pytest.raises(InputError, match=f"^{named}"):
        phases(*arguments)


@pytest.fixture
def costly(monkeypatch):
    """Spectra may cost so little that the wrinkled ring has none below ``v = 0.864``; called, as much as usual again."""
    perturbations.blocks_up_to.cache_clear()
    monkeypatch.setattr(perturbations, "MOST_WORK", 4e8)

    def usual():
        monkeypatch.undo()
        perturbations.blocks_up_to.cache_clear()

    yield usual
    usual()


def test_triangles_take_a_branch_over_where_modes_end(costly):
    found = phases(Tube(-1, 10), [0.7, 0.84, 0.87], modes=[(0, 2)], nodes=500)
    costly()
    exact = pb.branch(Tube(-1, 10), "ring", (0, 2), until={"v": 0.87}).switch(1, until={"v": 0.84})[-1]
    assert exact.observables["v"] == pytest.approx(0.84, abs=1e-12)
    row = found.table.iloc[1]
    assert (row["branch"], row["family"], row["symmetry"]) == ("ring 0:2/1 mesh", "mesh", "1 period, 2-fold")
    joint = found.branches["ring 0:2/1"].points[-1], found.branches["ring 0:2/1 mesh"].points[0]
    assert joint[0].value("v") == pytest.approx(joint[1].value("v"), abs=1e-12)
    gap = joint[1].value("E") - joint[0].value("E")
    assert f"where it begins its E is {gap:+.1e} beside that of ring 0:2/1" in row["message"]
    # The mesh's error, of either place.
    assert 0 < gap < 2e-3
    assert gap / 3 < row["E"] - exact.observables["E"] < 3 * gap
    assert row["lambda2"] == pytest.approx(exact.observables["lambda2"], abs=5e-2)
    # One branch in two parts: nothing happens where they meet. On 3,000 and 4,000 vertices it ends at 0.71519 and 0.71516.
    assert list(found.ranges["branch"]) == ["", "ring 0:2/1 mesh", "ring 0:2/1"]
    assert list(found.transitions["event"]) == ["jump", "stable"]
    assert found.transitions["v"].to_numpy() == pytest.approx(0.7152, abs=8e-3)
    assert not found.unfinished


def test_without_triangles_a_branch_ends_where_its_modes_do(costly):
    found = phases(Tube(-1, 10), [0.84, 0.87], modes=[(0, 2)], nodes=0)
    assert list(found.table["branch"]) == ["", "ring 0:2/1"]
    assert "ring 0:2/1 was not followed to here" in found.table["message"].iloc[0]
