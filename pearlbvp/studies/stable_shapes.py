"""The stable shapes of a tube at given volumes, as a table and as solutions."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.path import PathEnd
from pearlbvp.continuation.solution import Solution
from pearlbvp.errors import Interruption
from pearlbvp.helfrich import SMALLEST_AMPLITUDE, Tube, cylinder_energy
from pearlbvp.studies.diagram import MESH
from pearlbvp.studies.parallel import in_processes
from pearlbvp.studies.stretches import SAME_VOLUME, Piece, is_same
from pearlbvp.studies.transitions import STRAIGHT
from pearlbvp.theory.dispersion import stable_interval

COLUMNS = ["v", "branch", "family", "symmetry", "rank", "E", "excess", "lambda1", "lambda2", "force", "n_unstable", "mu_crit",
           "critical", "amplitude", "r_min", "r_max", "c0", "L", "branches", "depth", "message", "starts", "rest_here",
           "origin", "multiplicity"]  # fmt: skip
OBSERVED = ("E", "lambda1", "lambda2", "force", "amplitude", "r_min", "r_max")

NONE = "no stable shape was found; follow to a larger depth, or where more directions are unstable"

MOST_UNSTABLE = 2
"""Unstable directions on a branch up to which what crosses it there is followed."""


def interrupted(lacking: Sequence[str]) -> str:
    """What an interruption left out, in a sentence."""
    return f"interrupted: {', '.join(lacking)}"


def largest_volume(tube: Tube) -> float:
    """Reduced volume that no tube of that area exceeds: of the straight tube, or of one sphere where that is larger.

    Of given area these two hold most in a space that is periodic along one axis (Pedrosa and Ritore, Indiana Univ. Math. J. 48
    (1999) 1357).
    """
    return max(1.0, math.sqrt(2 * tube.length) / 3)


@dataclass(frozen=True)
class _OnMesh:
    """What is known of a branch on triangles from the end of the branch that it follows.

    Attributes:
        repeats: equal periods along the tube, and folds around it.
        says: by how much its energies are the mesh's.
    """

    repeats: tuple[int, int]
    says: str


def _on_meshes(branches: Mapping[str, Branch[Any]]) -> dict[str, _OnMesh]:
    """Of those that are on triangles, by their names."""
    found = {}
    for name in branches:
        before = name.removesuffix(f" {MESH}")
        if before == name or before not in branches:
            continue
        last, first = branches[before].points[-1], branches[name].points[0]
        nodes, gap = first.problem.mesh.count, first.value("E") - last.value("E")
        says = f"{name} has {nodes} vertices: where it begins its E is {gap:+.1e} beside that of {before}"
        found[name] = _OnMesh(last.problem.repeats, says)
    return found


def at_volumes(
    tube: Tube, volumes: Sequence[float], stretches: Sequence[Piece], branches: Mapping[str, Branch[Any]],
    unfinished: Mapping[str, Branch[Any]], lacking: list[str], processes: int = 1,
) -> tuple[pd.DataFrame, dict[tuple[float, str], Solution[Any]]]:  # fmt: skip
    """A row for each stable shape at each volume, or one that says that none was found, and the shapes.

    Args:
        tube: the straight tube.
        volumes: reduced volumes.
        stretches: the stable pieces of all branches.
        branches: all of them, by name.
        unfinished: those that end within the range.
        lacking: what an interruption left out so far, which each row says; to that is added what of the table is lacking.
        processes: how many to work in; 0 for one a core.
    """
    meshes = _on_meshes(branches)
    tables: list[list[dict[str, Any]]] = []
    solutions: dict[tuple[float, str], Solution[Any]] = {}
    before, stopped = [interrupted(lacking)] * bool(lacking), Interruption()
    cases = [(v, [piece for piece in stretches if _is_within(v, piece)]) for v in volumes]
    with stopped:
        computed = in_processes(_stable_at, cases, processes or None, FEWEST, batch=2)
        for v, (found, failed) in zip(volumes, computed, strict=True):
            said = [
                f"{name} was not followed to here" for name, branch in unfinished.items() if _misses(tube, branch, v)
            ]
            here = [_row(name, shape, meshes.get(name)) for name, shape in found.items()]
            said += [meshes[name].says for name in found if name in meshes]
            if abs(v - 1) <= SAME_VOLUME and stable_interval(tube).exists:
                here.append(_straight_row(tube))
            here.sort(key=lambda row: float(row["E"]))
            message = "; ".join([*[NONE] * (not here), *before, *said, *failed])
            ranks = [{"rank": i, "excess": row["E"] - here[0]["E"]} for i, row in enumerate(here, start=1)]
            rows = [row | rank for row, rank in zip(here, ranks, strict=True)] or [{"branch": ""}]
            solutions |= {(v, name): shape for name, shape in found.items()}
            tables.append([{"v": v, **row, "message": message} for row in rows])
    lacking += [f"{len(tables)} of {len(volumes)} volumes are in the table"] * stopped.happened
    return pd.DataFrame([row for rows in tables for row in rows], columns=COLUMNS), solutions


FEWEST = 8
"""Volumes from which on several processes are of use."""


def _is_within(v: float, piece: Piece) -> bool:
    return piece.low - SAME_VOLUME <= v <= piece.high + SAME_VOLUME


def _stable_at(case: tuple[float, Sequence[Piece]]) -> tuple[dict[str, Solution[Any]], list[str]]:
    """The stable shapes of a volume on some pieces by name, each once, and what could not be computed.

    The straight tube is none of them.
    """
    v, stretches = case
    found: dict[str, Solution[Any]] = {}
    failed = []
    for piece in stretches:
        try:
            shape = piece.at(v)
        except PathEnd as error:
            failed.append(f"{piece.name}: {error.args[0]}")
            continue
        if shape.value("amplitude") < SMALLEST_AMPLITUDE:  # the straight tube, which is a shape of its own
            continue
        if shape.spectrum.n_unstable == 0 and not any(is_same(shape, other) for other in found.values()):
            found[f"{piece.name} again" if piece.name in found else piece.name] = shape
    return found, failed


def _straight_row(tube: Tube) -> dict[str, Any]:
    """The straight tube, whose multipliers are no numbers: at each of an interval of them it is stable."""
    return {"branch": STRAIGHT, "family": "cylinder", "symmetry": symmetry(0, 0), "E": cylinder_energy(tube.c0),
            "n_unstable": 0, "amplitude": 0.0, "r_min": 1.0, "r_max": 1.0}  # fmt: skip


def _row(name: str, shape: Solution[Any], on_mesh: _OnMesh | None) -> dict[str, Any]:
    spectrum = shape.spectrum
    repeats = shape.problem.repeats if on_mesh is None else on_mesh.repeats
    return {
        "branch": name, "family": shape.problem.family, "symmetry": symmetry(*repeats),
        **{column: shape.observables[column] for column in OBSERVED},
        "n_unstable": spectrum.n_unstable, "mu_crit": spectrum.mu_crit, "critical": str(spectrum.critical),
    }  # fmt: skip


def symmetry(periods: int, folds: int) -> str:
    """Equal periods along and folds around a tube in words: ``2 periods, axisymmetric``, or ``1 period`` with one fold."""
    along = f"{periods} period{'s' * (periods > 1)}" if periods else "uniform along x"
    return along + {0: ", axisymmetric", 1: ""}.get(folds, f", {folds}-fold")


def _misses(tube: Tube, branch: Branch[Any], v: float) -> bool:
    """Whether a volume that its shapes could have lies beyond the end of a branch, where they may be stable."""
    last = branch.points[-1]
    end, before = (branch.points[i].value("v") for i in (-1, max(len(branch.points) - 2, 0)))
    most = largest_volume(Tube(tube.c0, tube.length / max(last.problem.repeats[0], 1)))
    return (v - end) * (end - before) > 0 and v < most and last.spectrum.n_unstable <= MOST_UNSTABLE
