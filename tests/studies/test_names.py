"""Branches are called what people call them, whatever way they were found."""

import pytest

import pearlbvp as pb
from pearlbvp.studies.names import name_of, names
from pearlbvp.studies.saved import load, save


@pytest.mark.parametrize(
    ("tube", "family", "mode", "name", "kind"),
    [
        ((0.48, 30), "pearl", (4, 0), "pearls m = 4", "pearl"),
        ((0.0, 10), "coil", (1, 1), "coils (1,1)", "coil"),
        ((0.0, 10), "coil", (1, 2), "coils (1,2)", "coil"),
        ((0.0, 20), "coil", (2, 1), "coils (2,1)", "coil"),
        ((0.0, 20), "buckle", (2, 1), "buckles (2,1)", "buckle"),
        ((-1.0, 10), "ring", (0, 3), "wrinkles n = 3", "ring"),
    ],
)
def test_what_leaves_the_straight_tube_is_called_by_its_mode(tube, family, mode, name, kind, tmp_path):
    found = pb.branch(pb.Tube(*tube), family, mode, max_points=3)
    assert (name_of(found).text, name_of(found).kind) == (name, kind)
    save(found, tmp_path / "b.h5")
    assert name_of(load(tmp_path / "b.h5")).text == name


@pytest.mark.parametrize("family", ["coil", "buckle"])
def test_a_triangulated_tube_by_its_largest_wave(family):
    found = pb.branch(pb.Tube(0.0, 10), family, nodes=200, max_points=2)
    assert name_of(found).text == f"{family}s (1,1)"


def test_what_branches_off_is_called_by_what_becomes_of_it():
    four = pb.branch(pb.Tube(0.48, 30), "pearl", (4, 0), until={"bp": 2})
    localized, pair = four.switch(1, max_points=6), four.switch(2, max_points=6)
    assert name_of(localized).text == "localized pearl"
    assert name_of(pair).text == "2 localized pearls"
    assert name_of(localized).kind == name_of(pair).kind == "unequal"
    varied = pb.branch(pb.Tube(0.48, 15), "pearl", (2, 0), until={"v": 1.01}).vary("c0", max_points=3)
    assert name_of(varied).text == "pearls m = 2"


def test_what_branches_off_from_wrinkles_and_coils():
    wrinkles = pb.branch(pb.Tube(-1.0, 10), "ring", until={"bp": 1})
    assert name_of(wrinkles.switch(1, max_points=2)).text == "oblates in wrinkles"
    coils = pb.branch(pb.Tube(0.48, 10), "coil", until={"bp": 1})
    found = name_of(coils.switch(1, max_points=2))
    assert (found.text, found.kind) == ("from coils (1,1)", "mixed")


def test_of_two_with_one_name_each_has_its_own_behind_it():
    two = pb.branch(pb.Tube(0.48, 15), "pearl", (2, 0), max_points=3)
    coil = pb.branch(pb.Tube(0.0, 10), "coil", max_points=2)
    found = names({"a": two, "b": two, "c": coil})
    assert [name.text for name in found.values()] == ["pearls m = 2, a", "pearls m = 2, b", "coils (1,1)"]
