"""All branches that are reached from the cylinder, up to a depth: an automatic bifurcation diagram."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from pearlbvp.continuation.branch import Branch, SpecialPoint, Status
from pearlbvp.continuation.following import BranchOptions, kept
from pearlbvp.errors import InputError, Interruption
from pearlbvp.held import Held, known_held
from pearlbvp.helfrich import Tube, WaveNumbers, choice, finite, mode_list, whole
from pearlbvp.studies.branch import branch_options, curve, family_branch, known_options, shown
from pearlbvp.studies.dispersion import branch_points
from pearlbvp.studies.onward import Centre, switched
from pearlbvp.studies.parallel import in_processes
from pearlbvp.tube.problem import TubeProblem
from pearlbvp.units import RADII, Units

if TYPE_CHECKING:
    import pandas as pd


MIXED = "mixed"
"""What branches off from rings, coils and buckles, and from that again."""

ENDS = {"pearl": 1.1, "ring": 0.85, "coil": 0.85, "buckle": 0.85, MIXED: 0.9}
"""Reduced volume at which branches of a family end unless asked otherwise. Mixed ones need modes both ways, and many."""

Options = BranchOptions | Mapping[str, BranchOptions] | None

Refused = Callable[[Branch[Any], SpecialPoint], str]

MOST_NAMED = 14
"""Branches that a session shows by name."""

MOST_BRANCHES = 200
"""Largest number of branches from the cylinder."""


@dataclass(frozen=True)
class Diagram:
    """Branches by name.

    Attributes:
        branches: ``3`` is the branch of three equal pearls, ``3/1`` the one that crosses it at its first branch point,
            ``3/1 neck`` that centred on a neck, ``3/1 shrink`` its other half where that has other shapes; ``ring 0:2``,
            ``coil 1:1``, ``buckle 1:1`` are those of other families with their mode, ``ring 0:2/1`` what branches off there,
            ``ring 0:2/1 mesh`` what follows it on triangles.
        skipped: branch points that were not followed, by name, and why.
        twins: of those the ones that lead to a branch again, shifted or mirrored: the name of that.
        complete: whether it was not interrupted; else these are the branches that were followed before.
    """

    branches: dict[str, Branch[Any]]
    skipped: dict[str, str]
    twins: dict[str, str] = field(default_factory=dict)
    complete: bool = True

    def __repr__(self) -> str:
        rows = [f"  {name}: {len(branch.points)} points, {branch.reason}" for name, branch in self.branches.items()]
        more = [f"  and {len(rows) - MOST_NAMED} more"] if len(rows) > MOST_NAMED else []
        head = f"diagram of {len(rows)} branches, {len(self.skipped)} branch points skipped"
        return "\n".join([head, *rows[:MOST_NAMED], *more])

    def table(self) -> pd.DataFrame:
        """All tables under one another, with the branch's name in the first column."""
        return together(self.branches)


def together(branches: Mapping[str, Branch[Any]]) -> pd.DataFrame:
    """Tables of several branches under one another: ``branch``, the branch's name, then those of ``studies.branch.shown``."""
    return _together({name: branch.table() for name, branch in branches.items()})


def curves(branches: Mapping[str, Branch[Any]]) -> pd.DataFrame:
    """As ``together``, with rows between the points, to draw (``studies.branch.curve``)."""
    return _together({name: curve(branch) for name, branch in branches.items()})


def _together(tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    import pandas as pd

    whole = pd.concat([table.assign(branch=name) for name, table in tables.items()], ignore_index=True)
    return pd.concat((whole["branch"], shown(whole)), axis=1)


def tubes_apart(table: pd.DataFrame, units: Units = RADII) -> dict[str, str]:
    """What tubes the branches of a table are of, by name, in the table's unit; nothing where all are of one.

    Args:
        table: with the columns ``branch``, ``c0`` and ``L``.
        units: of the table.
    """
    apart = [name for name in ("c0", "L") if _spread(table[name]) > ONE_TUBE]
    groups = table.groupby("branch", sort=False)
    if not apart or groups.ngroups == 1:
        return {}
    return {
        str(branch): ", ".join(
            f"{units.symbol(name)} varies"
            if _spread(rows[name]) > ONE_TUBE
            else f"{units.symbol(name)} = {units.named(name, rows[name].iloc[0]):.6g}"
            for name in apart
        )
        for branch, rows in groups
    }


ONE_TUBE = 1e-9
"""Relative difference of ``c0`` or ``L`` that is rounding."""


def _spread(values: pd.Series[float]) -> float:
    """Range of a column, by its size."""
    return float((values.max() - values.min()) / max(values.abs().max(), 1e-300))


def diagram(
    c0: float,
    length: float,
    depth: int = 1,
    options: Options = None,
    progress: Callable[[str], None] = lambda name: None,
    *,
    lambda2: tuple[float, float] | None = None,
    modes: Iterable[WaveNumbers] | None = None,
    processes: int = 1,
    fix: str | Held = "area,volume",
    refused: Refused = lambda branch, special: "",
    nodes: int = 0,
) -> Diagram:
    """Follow branches from the cylinder, and from their branch points on, to a depth.

    Args:
        c0: spontaneous curvature.
        length: axial period of the tube.
        depth: 0 for branches from the cylinder only, 1 for those that cross them, and so on.
        options: where branches stop and how they step, from ``branch_options``: for all, or by family (``pearl, ring, coil,
            buckle``, and ``mixed`` for what branches off the last three). By default pearls go to ``v = 1.1``,
            rings, coils and buckles down to 0.85, mixed ones to 0.9.
        progress: called with the name of each branch before it is followed.
        lambda2: follow every family that leaves the cylinder between these two values.
        modes: follow every family of these modes ``(m, n)``, wherever they begin. With neither, all pearls of ``k < 1``.
        processes: how many to work in; 0 for one a core.
        fix: what is held while stability is judged, as ``family_branch`` takes it, on all branches.
        refused: of a branch and a branch point on it, why what crosses there is not to be followed; empty where it is. Asked
            of the end of a branch, too, before triangles take it over.
        nodes: where reduced modes describe a branch no further, follow it on triangles with about so many vertices; 0 for
            branches that end there.

    Returns:
        The branches. A branch point that was not located is skipped, and so is a branch that has been found before (it joins
        the same two solutions). Where it is interrupted, those that there are.

    Raises:
        InputError: an argument that cannot be used.
    """
    tube = Tube(c0, length)
    depth, processes, nodes = whole("depth", depth, 0), whole("processes", processes, 0), whole("nodes", nodes, 0)
    if lambda2 is not None and modes is not None:
        raise InputError("modes", "modes and a range of lambda2 exclude each other", "give one of the two")
    wanted, held = _by_family(options), known_held(fix)
    primary = {_name(family, *mode): (family, mode) for family, mode in _primaries(tube, lambda2, modes)}
    if len(primary) > MOST_BRANCHES:
        raise InputError("lambda2", f"{len(primary)} branches leave the cylinder there", "take a shorter range or tube")
    tasks: dict[str, _Task] = {
        name: (_primary, (tube, family, mode, wanted[family], held)) for name, (family, mode) in primary.items()
    }
    branches: dict[str, Branch[Any]] = {}
    complete, skipped = True, dict[str, str]()
    twins: dict[str, str] = {}
    for _ in range(depth + 1):
        for name in tasks:
            progress(name)
        found = dict(zip(tasks, _done(list(tasks.values()), processes), strict=False))
        halves = {
            f"{name} {SHRINK}": (_secondary, (*tasks[name][1], False))
            for name, branch in found.items()
            if tasks[name][0] is _secondary and not isinstance(branch, str) and _has_two_sides(name, branch)
        }
        for name in halves:
            progress(name)
        found |= dict(zip(halves, _done(list(halves.values()), processes), strict=False))
        meshes: dict[str, _Task] = {
            f"{name} {MESH}": (_on_mesh, (branch, wanted[primary[name][0] if name in primary else MIXED], nodes))
            for name, branch in found.items()
            if nodes and _needs_a_mesh(branch, refused)
        }
        for name in meshes:
            progress(name)
        found |= dict(zip(meshes, _done(list(meshes.values()), processes), strict=False))
        complete = not any(map(_interrupted, found.values())) and found.keys() == {*tasks, *halves, *meshes}
        tasks = {}
        for name, branch in found.items():
            if isinstance(branch, str):
                skipped[name] = branch
                continue
            twin = next((other for other, known in branches.items() if join_the_same(known, branch)), None)
            if twin is not None:
                skipped[name], twins[name] = f"it is the branch {twin}", twin
                continue
            branches[name] = branch
            axisymmetric = branch.points[-1].problem.family == "pearl"
            for child, number, special, centre in _children(name, branch):
                kept = wanted["pearl" if axisymmetric and special.block.n == 0 else MIXED]
                if why := refused(branch, special):
                    skipped[child] = why
                else:
                    tasks[child] = _secondary, (branch, number, centre, kept)
        if not (complete and tasks):
            break
    order = list(primary)

    def place(name: str) -> tuple[Any, ...]:
        first, *further = name.replace(f" {MESH}", "").split("/")
        return (order.index(first), *((int(part.split()[0]), part) for part in further)), name

    return Diagram({name: branches[name] for name in sorted(branches, key=place)}, skipped, twins, complete)


def _by_family(options: Options) -> dict[str, BranchOptions]:
    """Options of every family."""
    known = tuple(ENDS)
    if isinstance(options, BranchOptions):
        return dict.fromkeys(known, options)
    if not isinstance(options, Mapping | None):
        raise InputError(
            "options", "they must be options of a branch, or a mapping of them by family", "see branch_options(...)"
        )
    by_default = {name: branch_options({"v": volume}) for name, volume in ENDS.items()}
    for name in options or {}:
        choice("options", name, known)
    return by_default | {name: known_options(of_family) for name, of_family in (options or {}).items()}


def _primaries(
    tube: Tube, lambda2: tuple[float, float] | None, modes: Iterable[WaveNumbers] | None
) -> Iterable[tuple[str, WaveNumbers]]:
    """Families and modes that are wanted, by increasing ``lambda2`` where they are found by it."""
    if lambda2 is not None:
        low, high = (finite("lambda2", value) for value in lambda2)
        # No wave is neutral beyond k^2 = 3 + 2 |lambda2| + 2 |1 - 2 c0|, nor beyond n^2 of that size.
        most = math.sqrt(3 + 2 * max(abs(low), abs(high)) + 2 * abs(1 - 2 * tube.c0))
        table = branch_points(tube.c0, tube.length, math.ceil(most * tube.length / (2 * math.pi)), math.ceil(most) + 1)
        inside = table[table["lambda2"].between(low, high)]
        modes = [(int(m), int(n)) for m, n in zip(inside["m"], inside["n"], strict=True)]
    elif modes is None:
        most_pearls = range(1, math.ceil(tube.length / (2 * math.pi)))
        modes = [(m, 0) for m in most_pearls if tube.wave_number(m) < 1]
    for m, n in mode_list(modes):
        families = ("pearl",) if n == 0 else ("ring",) if m == 0 else ("coil", "buckle")
        yield from ((family, (m, n)) for family in families)


def _name(family: str, m: int, n: int) -> str:
    return str(m) if family == "pearl" else f"{family} {m}:{n}"


_Task = tuple[Callable[..., "Branch[Any] | str"], tuple[Any, ...]]
"""A function and what it is called with."""


def _done(tasks: Sequence[_Task], processes: int) -> Sequence[Branch[Any] | str]:
    """Branches, or why there are none; the first of them only where it is interrupted."""
    done: list[Branch[Any] | str] = []
    with Interruption():
        for found in in_processes(_follow, tasks, processes or None, fewest=2, batch=1):
            done.append(found)
            if _interrupted(found):
                break
    return done


def _follow(task: _Task) -> Branch[Any] | str:
    function, arguments = task
    return function(*arguments)


def _interrupted(found: Branch[Any] | str) -> bool:
    return isinstance(found, Branch) and found.status is Status.INTERRUPTED


def _primary(tube: Tube, family: str, mode: WaveNumbers, options: BranchOptions, held: Held) -> Branch[Any] | str:
    """The branch of a family that leaves the cylinder at a mode."""
    try:
        return kept(lambda watched: family_branch(tube, family, mode, watched, fix=held), options)
    except InputError as error:
        return error.why


def _secondary(
    branch: Branch[Any], number: int, centre: Centre | None, options: BranchOptions, grow: bool = True
) -> Branch[Any] | str:
    """The branch that crosses another at its branch point ``number``."""
    try:
        return kept(lambda watched: switched(branch, number, watched, centre=centre, grow=grow), options)
    except InputError as error:
        return error.why


SHRINK = "shrink"
"""Name of the half of a branch on which the tube shrinks at its centre."""

MESH = "mesh"
"""Name of what follows a branch on triangles, where reduced modes describe its shapes no further."""


def _needs_a_mesh(branch: Branch[Any] | str, refused: Refused) -> bool:
    if isinstance(branch, str) or branch.status not in (Status.FAILED, Status.LIMIT):
        return False
    return isinstance(branch.points[-1].problem, TubeProblem) and not refused(branch, branch.special[-1])


def _on_mesh(branch: Branch[Any], options: BranchOptions, nodes: int) -> Branch[Any] | str:
    """What follows a branch, on triangles."""
    from pearlbvp.studies.mesh import taken_over  # the room of meshes is large, and few branches need it

    try:
        return kept(lambda watched: taken_over(branch, watched, nodes), options)
    except InputError as error:
        return error.why


ONE_SIDED, ONE_SIDED_ON_MESH = 1e-6, 1e-2
"""Slope of the volume at a pitchfork, to the accuracy of differences and of triangles."""


def _has_two_sides(name: str, branch: Branch[Any]) -> bool:
    """Whether a branch leaves another at no pitchfork: its two halves are no images of each other, and volume goes through."""
    first = branch.points[0]
    level = ONE_SIDED if first.problem.own_mesh(first.u) is None else ONE_SIDED_ON_MESH
    return not name.endswith(" neck") and abs(first.slopes.get("v", 0.0)) > level


def _children(name: str, branch: Branch[Any]) -> Iterable[tuple[str, int, SpecialPoint, Centre | None]]:
    """Names, numbers, places and centres of what branches off a branch; no centre where there is no choice, or by default."""
    for number, special in enumerate(branch.find("bp"), start=1):
        yield f"{name}/{number}", number, special, None
        if branch.points[-1].problem.centred and special.block.parity is None:
            yield f"{name}/{number} neck", number, special, "neck"


def join_the_same(one: Branch[Any], two: Branch[Any]) -> bool:
    """Whether two branches join the same two solutions, in either direction, as far as their observables tell."""
    first, last = (one.points[place].observables for place in (0, -1))
    return any(
        all(abs(p[name] - q[name]) < 1e-6 for p, q in zip((first, last), ends, strict=True) for name in COMPARED)
        for ends in ([two.points[place].observables for place in places] for places in ((0, -1), (-1, 0)))
    )


COMPARED = ("lambda1", "v", "E", "r_max")
"""Observables by which solutions are told apart."""
