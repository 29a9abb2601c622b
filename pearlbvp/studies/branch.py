"""Which shapes branch off the straight tube, how do they continue, which are stable? Branches of every family."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from pearlbvp.continuation import curve as curves
from pearlbvp.continuation.branch import Branch
from pearlbvp.continuation.following import BranchOptions, continue_branch
from pearlbvp.continuation.path import PathOptions
from pearlbvp.continuation.solution import Solution
from pearlbvp.errors import InputError
from pearlbvp.held import Held, known_held
from pearlbvp.helfrich import (
    Tube,
    WaveNumbers,
    cylinder_energy,
    cylinder_force,
    cylinder_lambda1,
    finite,
    known_tube,
    mode_numbers,
    whole,
)
from pearlbvp.membrane import Start
from pearlbvp.studies import families
from pearlbvp.theory.dispersion import critical_lambda2
from pearlbvp.units import Sentence

if TYPE_CHECKING:
    import pandas as pd

    from pearlbvp.mesh.adaptation import AdaptOptions

Discretization = Literal["modes", "subdivision", "cotangent"]

COLUMNS = ["point", "special", "lambda1", "lambda2", "v", "E", "amplitude", "r_min", "r_max", "n_unstable", "mu_crit",
           "critical", "c0", "L", "mu_error", "wave", "M", "force"]  # fmt: skip
FURTHER = ["torque", "osmolarity", "M0"]
"""Columns behind those, where a family has them."""

TURNS = (
    "lambda1",
    "lambda2",
    "v",
    "E",
    "amplitude",
    "r_min",
    "r_max",
    "c0",
    "L",
    "M",
    "force",
    "torque",
    "osmolarity",
    "M0",
)
"""Columns whose turning points can be located."""


def shown(table: pd.DataFrame) -> pd.DataFrame:
    """The columns of a branch's table that the command line writes: ``COLUMNS``, and those of ``FURTHER`` that it has."""
    return table[[*COLUMNS, *(name for name in FURTHER if name in table)]]


def curve(branch: Branch[Any]) -> pd.DataFrame:
    """The columns of ``shown`` with rows between the points, whose number ``point`` is a fraction: smooth, to draw."""
    return shown(curves.curve(branch))


STOPS = (*TURNS, "mu_crit", "wave")
"""Columns at a value of which a branch can stop."""

SPECIAL = ("bp", "cmc", "fold", *(f"fold:{name}" for name in TURNS))
"""Kinds of special points at which a branch can stop."""


def branch_options(
    until: Mapping[str, float] | None = None,
    *,
    max_points: int = 200,
    step: float | None = None,
    max_step: float = 0.5,
    progress: Callable[[Branch[Any]], None] = lambda branch: None,
    locating: Callable[[int, int], None] = lambda done, of: None,
) -> BranchOptions:
    """Options of a branch of any family.

    Args:
        until: column and value at which to stop exactly, or kind and number of a special point: ``{"v": 1.1}``,
            ``{"bp": 1}`` for the first branch point, ``{"fold:v": 2}``, ``{"cmc": 1}``, ``{"fold": 1}`` for the first fold of
            any. Special points are counted from the branch's start (``shape_branch``: from the shape, either way), also where a
            saved branch goes on. Several may be given, the first reached counts.
        max_points: end after so many, start and special points among them.
        step, max_step: first (by default 0.1 or ``max_step``) and largest step, in the norm of shape and parameters.
        progress: called with the branch so far after each point.
        locating: called while special points are located, with how many are and how many there are in the step.

    Raises:
        InputError: an argument that cannot be used.
    """
    if not isinstance(until, Mapping | None):
        raise InputError("until", f"{until!r} must be a mapping", "give one like {'v': 1.1} or {'bp': 1}")
    wanted = {name: finite(f"until {name}", value) for name, value in (until or {}).items()}
    special = {kind: _number(kind, wanted.pop(kind)) for kind in list(wanted) if kind in SPECIAL}
    for name in wanted:
        if name not in STOPS:
            raise InputError(
                "until",
                f"a branch cannot stop at a value of {name!r}",
                f"choose one of {', '.join(STOPS)}, or one of the special points bp, cmc, fold:NAME",
            )
    max_points, max_step = whole("max_points", max_points, 2), finite("max_step", max_step)
    if not max_step > 1e-6:
        raise InputError("max_step", f"{max_step:g} must be above 1e-6", "give one like 0.5")
    if step is None:
        step = min(0.1, max_step)
    step = finite("step", step)
    if not 1e-6 < step <= max_step:
        raise InputError(
            "step", f"{step:g} must be above 1e-6 and not above max_step = {max_step:g}", "give one between"
        )

    path = PathOptions(step=step, max_step=max_step, max_points=max_points)
    return BranchOptions(path=path, until=wanted, until_special=special, progress=progress, locating=locating)


def known_options(options: BranchOptions | None) -> BranchOptions:
    """Options of a branch, those of ``branch_options()`` where none are given.

    Raises:
        InputError: they are none.
    """
    if options is None:
        return branch_options()
    if not isinstance(options, BranchOptions):
        raise InputError(
            "options", f"{type(options).__name__} must be options of a branch", "make them by branch_options(...)"
        )
    return options


def known_branch(branch: Branch[Any]) -> Branch[Any]:
    """A branch.

    Raises:
        InputError: it is none, but the name of a file, say.
    """
    if not isinstance(branch, Branch):
        raise InputError(
            "branch", f"{type(branch).__name__} must be a branch", "follow one, or load it by studies.saved.load(...)"
        )
    return branch


def known_point(point: Solution[Any]) -> Solution[Any]:
    """A point of a branch.

    Raises:
        InputError: it is none, but its number, say.
    """
    if not isinstance(point, Solution):
        raise InputError(
            "point", f"{type(point).__name__} must be a point of a branch", "give one like branch.points[-1]"
        )
    return point


def known_points(points: Iterable[Solution[Any]]) -> list[Solution[Any]]:
    """Points of branches, one or more.

    Raises:
        InputError: they are none.
    """
    listed = list(points) if isinstance(points, Iterable) else []
    if not listed:
        what = f"{type(points).__name__} has no points of branches in it"
        raise InputError("points", what, "give some, like branch[2:4]")
    return [known_point(point) for point in listed]


def _number(kind: str, value: float) -> int:
    """The number of a special point.

    Raises:
        InputError: it is no whole number from 1 on.
    """
    if value != int(value) or value < 1:
        raise InputError("until", f"{value:g} is no number of a {kind}", "count them from 1")
    return int(value)


def family_branch(
    tube: Tube,
    family: str,
    mode: WaveNumbers | None = None,
    options: BranchOptions | None = None,
    *,
    nodes: int | None = None,
    discretization: Discretization | None = None,
    fix: str | Held = "area,volume",
    tolerance: float | None = None,
    adapt: AdaptOptions | None = None,
) -> Branch[Any]:
    """The branch of a family that leaves the straight tube at a mode, with stability on the whole tube.

    Args:
        tube: the straight tube.
        family: ``pearl`` (mode ``m,0``), ``ring`` (``0,n``), ``coil`` (``m,1``), ``buckle`` (``m,n``), or an added one.
        mode: waves along and around the tube; by default the family's first.
        options: where to stop and how to step, from ``branch_options``.
        nodes: on a triangulated tube of about so many vertices.
        discretization: on a triangulated tube ``subdivision`` (the default) or ``cotangent``; else ``modes`` for pearls and
            rings in reduced modes, which are better followed as what they are: through overhangs, to thin necks.
        fix: what is held while stability is judged: ``area,volume``, or ``tension`` for ``area``; ``pressure`` or ``osmotic=N``
            for ``volume``; ``force`` for ``length``; ``ade=ALPHA`` besides (``held.known_held``).
        tolerance: estimated error of the profile at which its mesh is refined, of pearls and rings.
        adapt: when and how a triangulation is adapted on the way.

    Returns:
        The branch; ``branch.table()`` has the columns ``COLUMNS``.

    Raises:
        InputError: an argument that cannot be used.

    Examples:
        >>> from pearlbvp.helfrich import Tube
        >>> pearls = family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.01}))
        >>> pearls.complete, pearls.find("bp")[0].block.n
        (True, 0)
    """
    known_tube(tube)
    options = known_options(options)
    held = known_held(fix)
    mode = families.family(family).mode if mode is None else mode_numbers("mode", mode)
    nodes = None if nodes is None else whole("nodes", nodes)
    if nodes is not None:
        if tolerance is not None:
            raise InputError("tolerance", "meshes have none", "leave it or nodes out")
        problem, u, direction = _on_a_mesh(tube, family, mode, nodes, discretization or "subdivision", held, adapt)
    elif discretization == "modes":
        problem, u, direction = _in_modes(family)(tube, mode, held, tolerance)
    elif discretization is None:
        problem, u, direction = families.family(family).start(tube, mode, held, tolerance)
    else:
        raise InputError("discretization", f"{discretization} goes with a mesh", "give its number of nodes, too")
    exact = straight_values(tube, float(critical_lambda2(tube.wave_number(mode[0]), mode[1], tube.c0)))
    held.check(exact | {"c0": tube.c0, "L": tube.length})
    start = Solution.along(problem, u, direction)
    branch = continue_branch(start, options, at_bifurcation=True, exact=exact)
    pearls = family == "pearl" and nodes is None and discretization is None
    if not pearls or "cmc" not in options.until_special or branch.find("cmc"):
        return branch
    from pearlbvp.studies.unduloids import why_none  # with the room of unduloids, which few branches need

    return replace(branch, reason=Sentence.joined(branch.reason, why_none(tube, mode[0])))


def asked_branch(
    tube: Tube,
    family: str,
    mode: WaveNumbers | None = None,
    options: BranchOptions | None = None,
    *,
    shape: Sequence[float] | None = None,
    volume: float | None = None,
    cells: int | None = None,
    **how: Any,
) -> Branch[Any]:
    """The branch that leaves the straight tube, or, of pearls, that through the shape of least energy near a guess.

    Args:
        tube, family, mode, options, how: as ``family_branch`` takes them; a shape has no mode.
        shape, volume, cells: as ``studies.shape.shape_branch`` takes them.

    Raises:
        InputError: an argument that cannot be used, or not beside another.
    """
    if shape is None:
        for name, value in (("volume", volume), ("cells", cells)):
            if value is not None:
                raise InputError(name, "it goes with shape", "give that, too, or leave it out")
        return family_branch(tube, family, mode, options, **how)
    if family != "pearl":
        raise InputError("shape", "it is for pearls only", f"leave it out with {family}")
    if volume is None:
        raise InputError("volume", "a shape of least energy is one of its volume", "give that, like volume=1.0")
    for name, value in (("mode", mode), *((name, how.pop(name, None)) for name in ("nodes", "discretization"))):
        if value is not None:
            raise InputError(name, "it does not go with shape", "leave one of them out")
    from pearlbvp.studies.shape import shape_branch  # which few branches start from

    tube = known_tube(tube)
    return shape_branch(tube.c0, tube.length, volume, shape, options, cells=1 if cells is None else cells, **how)


def _in_modes(family: str) -> Callable[[Tube, WaveNumbers, Held, float | None], Start]:
    """Where a family leaves the straight tube in reduced modes.

    Raises:
        InputError: it is none in reduced modes.
    """
    from pearlbvp.tube.onset import IN_MODES

    if family not in IN_MODES:
        raise InputError("discretization", f"{family} has no reduced modes", "leave it out")
    return IN_MODES[family]


def _on_a_mesh(
    tube: Tube, family: Any, mode: WaveNumbers, nodes: int, kind: Any, held: Held, adapt: AdaptOptions | None
) -> Start:
    """Where a family leaves the straight tube on a mesh, in the space of its symmetry."""
    from pearlbvp.mesh.adaptation import AdaptOptions
    from pearlbvp.mesh.families import tube_mesh
    from pearlbvp.mesh.start import onset

    mesh = tube_mesh(tube.length, nodes, coil=mode if family == "coil" else None)
    problem, u, direction = onset(tube, family, *mode, mesh, kind)
    return replace(problem, adapt=adapt or AdaptOptions(), held=held).symmetric(u, direction), u, direction


def straight_values(tube: Tube, lambda2: float) -> dict[str, float]:
    """The straight tube's own numbers, which a discretization of it has to its accuracy only."""
    return {
        "lambda1": cylinder_lambda1(lambda2, tube.c0), "lambda2": lambda2, "v": 1.0, "E": cylinder_energy(tube.c0),
        "amplitude": 0.0, "r_min": 1.0, "r_max": 1.0, "wave": 0.0, "M": math.pi * tube.length,
        "force": cylinder_force(lambda2, tube.c0), "torque": 0.0,
    }  # fmt: skip
