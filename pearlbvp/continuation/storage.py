"""Branches in HDF5 files: whole, readable by any HDF5 library, with no pickle in them.

Layout: attributes ``format, version, kind, reason, complete``; groups ``problems/0 ...`` (each mesh once), ``points/0 ...``
with ``u, tangent``, their observables as attributes, the number of their problem and a group ``spectrum``; group
``special`` with columns. Problems and spectra describe themselves as trees of arrays, numbers and words (``to_tree``).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from pearlbvp.continuation.branch import Branch, BranchPoint, SpecialPoint
from pearlbvp.continuation.path import Point
from pearlbvp.errors import InputError

FORMAT, VERSION = "pearlbvp branch", 1


def write_branch(branch: Branch[Any], path: Path) -> None:
    """Write a branch into a new file."""
    with h5py.File(path, "w") as file:
        file.attrs.update({"format": FORMAT, "version": VERSION, "reason": branch.reason, "complete": branch.complete})
        problem: Any = branch.points[0].point.problem
        file.attrs["kind"] = problem.stored_as
        numbers: dict[int, int] = {}
        problems, points = file.create_group("problems"), file.create_group("points")
        for index, entry in enumerate(branch.points):
            point = entry.point
            if id(point.problem) not in numbers:
                numbers[id(point.problem)] = len(numbers)
                problem = point.problem
                write_tree(problems.create_group(str(len(numbers) - 1)), problem.to_tree())
            group = points.create_group(str(index))
            group["u"], group["tangent"] = point.u, point.tangent
            group.attrs.update(
                {"problem": numbers[id(point.problem)], "iterations": point.iterations, "step": point.step}
            )
            group.create_group("observables").attrs.update(point.observables)
            write_tree(group.create_group("spectrum"), entry.spectrum.to_tree())
        special = file.create_group("special")
        for i, found in enumerate(branch.special):
            group = special.create_group(str(i))
            group.attrs.update(
                {
                    "kind": found.kind,
                    "index": found.index,
                    "change": found.change,
                    "converged": found.converged,
                    "interval": found.interval,
                }
            )
            if found.block is not None:
                group.attrs["block"] = list(branch.points[found.index].spectrum.rates).index(found.block)


def format_of(path: Path) -> str:
    """What an HDF5 file says that it is; empty where it says nothing, or cannot be read."""
    try:
        with h5py.File(path, "r") as file:
            return str(file.attrs.get("format", ""))
    except (OSError, RuntimeError):
        return ""


Reader = Callable[[Mapping[str, Any]], Any]


def read_branch(path: Path, kinds: Mapping[str, tuple[Reader, Reader]], name: str = "resume") -> Branch[Any]:
    """Read a branch.

    Args:
        path: a file that ``write_branch`` wrote.
        kinds: for each kind of problem the inverses of its and its spectra's ``to_tree``.
        name: the argument's name, for the message.

    Raises:
        InputError: the file cannot be opened, is no saved branch, or is not whole.
    """
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != FORMAT or int(file.attrs.get("version", 0)) != VERSION:
                raise InputError(f"{name}: {path} is no branch saved by this version; save one with --save")
            problem_from, spectrum_from = kinds[str(file.attrs.get("kind", "pearl"))]
            problems = [problem_from(read_tree(file["problems"][str(i)])) for i in range(len(file["problems"]))]
            points = [_read_point(file["points"][str(i)], problems, spectrum_from) for i in range(len(file["points"]))]
            special = [_read_special(file["special"][str(i)].attrs, points) for i in range(len(file["special"]))]
            return Branch(points, special, str(file.attrs["reason"]), bool(file.attrs["complete"]))
    except (OSError, RuntimeError, KeyError, IndexError, ValueError, TypeError, AttributeError) as error:
        if isinstance(error, InputError):
            raise
        reason = (
            "it is no HDF5 file, or cut off"
            if isinstance(error, OSError)
            else "something is missing or misplaced in it"
        )
        raise InputError(f"{name}: {path} cannot be read as a saved branch: {reason}; save it again") from None


def _read_point(group: Any, problems: list[Any], spectrum_from: Callable[[Mapping[str, Any]], Any]) -> BranchPoint[Any]:
    problem = problems[int(group.attrs["problem"])]
    u, tangent = group["u"][()], group["tangent"][()]
    if u.shape != tangent.shape or not (np.isfinite(u).all() and np.isfinite(tangent).all()):
        raise ValueError("a point's unknown and tangent do not fit")
    observables = {name: float(value) for name, value in group["observables"].attrs.items()}
    order = problem.observables(u)  # HDF5 sorts attributes by name; this also fails where u does not fit its mesh
    observables = {name: observables[name] for name in order}
    point = Point(problem, u, tangent, observables, int(group.attrs["iterations"]), float(group.attrs["step"]))
    return BranchPoint(point, spectrum_from(read_tree(group["spectrum"])))


def _read_special(attributes: Any, points: list[BranchPoint[Any]]) -> SpecialPoint[Any]:
    index = int(attributes["index"])
    blocks = list(points[index].spectrum.rates)
    block = blocks[int(attributes["block"])] if "block" in attributes else None
    low, high = attributes["interval"]
    change, converged = int(attributes["change"]), bool(attributes["converged"])
    return SpecialPoint(str(attributes["kind"]), index, block, change, converged, (float(low), float(high)))


def write_tree(group: Any, tree: Mapping[str, Any]) -> None:
    """Arrays as datasets, numbers and words as attributes."""
    for name, value in tree.items():
        if isinstance(value, np.ndarray):
            group[name] = value
        else:
            group.attrs[name] = value


def read_tree(group: Any) -> dict[str, Any]:
    """The inverse of ``write_tree``."""
    return {name: group[name][()] for name in group} | {name: _plain(value) for name, value in group.attrs.items()}


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value
