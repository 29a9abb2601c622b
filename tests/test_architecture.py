"""Rooms import from below only: what stands above in this list may import what stands below it."""

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "pearlbvp"
ROOMS = [
    "cli",
    "commands",
    "figures",
    "studies",
    "flows",
    "shapes",
    "tube",
    "mesh",
    "stability",
    "theory",
    "bvp",
    "continuation",
    "collocation",
]
NOTHING_OF = {
    "bvp": {"theory", "helfrich"},
    "continuation": {"collocation", "theory", "helfrich"},
    "collocation": {"theory", "helfrich"},
    "figures": {"theory"},
}


def imported(path):
    """Rooms (first names below the package) that a file imports, anywhere in it."""
    rooms = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("pearlbvp."):
            rooms.add(node.module.split(".")[1])
    return rooms


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_imports_only_from_below(room):
    files = list((PACKAGE / room).glob("*.py")) or [PACKAGE / f"{room}.py"]
    above = set(ROOMS[: ROOMS.index(room)])
    for path in files:
        assert not imported(path) & (above | NOTHING_OF.get(room, set())), path.name


def test_the_flow_s_driver_knows_no_discretization():
    allowed = {"bordered", "driver", "integrator", "problem", "record", "steady", "spectrum", "errors", "newton"}
    allowed |= {"arrays", "constrained", "representation", "units"}
    for name in ("driver", "integrator", "steady", "record", "perturbation"):
        tree = ast.parse((PACKAGE / "flows" / f"{name}.py").read_text())
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("pearlbvp."):
                assert node.module.split(".")[-1] in allowed, name


def test_lengths_are_converted_in_one_place():
    """Whoever else asks a tube's radius in the user's unit, or raises it to a power, converts by hand."""
    asking = {
        path.name
        for path in PACKAGE.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if (isinstance(node, ast.Attribute) and node.attr == "radius")
        or (isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow) and "radius" in ast.unparse(node.left))
    }
    assert asking == {"units.py"}
