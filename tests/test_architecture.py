"""Rooms import from below only: what stands above in this list may import what stands below it."""

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "pearlbvp"
ROOMS = [
    "cli",
    "commands",
    "figures",
    "paper",
    "atlas",
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
    allowed |= {"arrays", "constrained", "representation", "units", "quantities", "force"}
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
    assert asking == {"conversion.py", "units.py"}


def modules():
    """Every file of the package with the files that it imports where it is itself imported, type checking included."""
    names = {
        path: ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
        for path in PACKAGE.rglob("*.py")
    }
    known = set(names.values())
    graph = {}
    for path, name in names.items():
        graph[name] = set()
        tree = ast.parse(path.read_text())
        functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
        inside = {id(node) for function in functions for node in ast.walk(function)}
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and id(node) not in inside:
                whole = {f"{node.module}.{alias.name}" for alias in node.names} | {str(node.module)}
                graph[name] |= {found for found in whole if found in known}
    return graph


def test_no_file_imports_itself_by_way_of_others():
    """Packages' own files are left out: they hand on what is in them."""
    graph = {
        name: {other for other in others if other in graph} for graph in [modules()] for name, others in graph.items()
    }
    packages = {".".join(path.parent.relative_to(PACKAGE.parent).parts) for path in PACKAGE.rglob("__init__.py")}
    done, path = set(), []

    def visit(name):
        assert name not in path, " > ".join([*path[path.index(name) :], name])
        if name not in done and name not in packages:
            path.append(name)
            for other in graph[name]:
                visit(other)
            path.pop()
            done.add(name)

    for name in graph:
        visit(name)


def test_no_object_is_written_into_behind_its_back():
    writing = [
        path.name
        for path in PACKAGE.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Attribute) and node.attr == "__dict__"
    ]
    assert writing == []


def test_files_fit_a_reader_s_head():
    lengths = {str(path.relative_to(PACKAGE)): len(path.read_text().splitlines()) for path in PACKAGE.rglob("*.py")}
    too_long = {name: length for name, length in lengths.items() if length > 400}
    assert too_long == {}
