"""Branches and their solutions with the verbs of an ordinary analysis, which needs no other import then.

The rooms below do the work; nothing is computed here.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any, Literal, overload

from pearlbvp.continuation import branch as core
from pearlbvp.continuation import solution as solutions
from pearlbvp.errors import InputError
from pearlbvp.helfrich import whole
from pearlbvp.messages import counted
from pearlbvp.numbers import as_whole
from pearlbvp.units import RADII, Units

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from pearlbvp.explorer.page import Explorer
    from pearlbvp.held import Held
    from pearlbvp.mesh.periodic import PeriodicMesh

Until = Mapping[str, float]
"""Where to stop: columns and values, ``{"v": 1.1}``, or kinds of special points and their numbers, ``{"bp": 1}``."""


class Solution(solutions.Solution[Any]):
    """A point of a branch: ``observables``, ``spectrum``, ``slopes``, ``problem`` and ``u``, and the shape itself."""

    def profile(self, samples: int = 400) -> pd.DataFrame:
        """The curve that the shape is made of, in radii: ``x, r, psi, H`` of pearls, sections of rings and coils.

        Raises:
            InputError: the shape is made of no single curve.
        """
        from pearlbvp.studies.export import profile_table

        return profile_table(self, samples)

    def surface(self, nodes: int = 3000) -> PeriodicMesh:
        """The shape as triangles on one period of the tube, with about so many vertices."""
        from pearlbvp.studies.mesh import shape_mesh

        return shape_mesh(self, nodes)

    def export(self, path: str | os.PathLike[str], nodes: int = 3000, units: Units = RADII) -> None:
        """Write the surface for another program: ``.vtu`` (ParaView), ``.ply``, ``.obj`` (Blender), ``.fe`` (Surface Evolver).

        Args:
            path: whose ending names the format.
            nodes: vertices, about.
            units: of the vertices.

        Raises:
            InputError: another ending, or a place that cannot be written to.
        """
        from pearlbvp.mesh.files import writable_mesh, write_mesh

        writable_mesh("path", path)
        c0 = units.to_user("H", self.observables["c0"])
        write_mesh(units.surface(self.surface(nodes)), path, c0=c0, name="path")

    def plot(self) -> Figure:
        """A picture of the surface."""
        from pearlbvp.figures.surface import draw_surfaces

        return draw_surfaces([self], columns=1)


def _solution(found: solutions.Solution[Any]) -> Solution:
    """The same with a profile and a surface; growth rates that the branch has computed are not computed again."""
    carried = {field.name: getattr(found, field.name) for field in fields(found)}
    return Solution(**carried | {"known": vars(found).get("spectrum", found.known)})


def _is_kind(kind: str) -> bool:
    """Whether there are special points of a kind."""
    from pearlbvp.studies.branch import SPECIAL

    return kind in (*SPECIAL, "start", "end", "stop")


class Branch(core.Branch[Any]):
    """A branch: its table, its special points, and where to go on from it.

    ``branch[3]`` is a solution, ``branch["bp"]`` are those at all branch points, ``branch["bp:2"]`` is that at the second.
    """

    @classmethod
    def of(cls, found: core.Branch[Any]) -> Branch:
        """A branch of the rooms below."""
        return cls(**{field.name: getattr(found, field.name) for field in fields(found)})

    def __len__(self) -> int:
        return len(self.points)

    def __iter__(self) -> Iterator[Solution]:
        return map(_solution, self.points)

    @overload
    def __getitem__(self, which: int) -> Solution: ...

    @overload
    def __getitem__(self, which: slice) -> list[Solution]: ...

    @overload
    def __getitem__(self, which: str) -> Solution | list[Solution]: ...

    def __getitem__(self, which: int | slice | str) -> Solution | list[Solution]:
        """A point by its number, several by a slice, all special points of a kind, or one of them.

        Raises:
            InputError: there is no such special point.
            IndexError: there is no such point.
        """
        if isinstance(which, slice):
            return [_solution(point) for point in self.points[which]]
        if not isinstance(which, str):
            return _solution(self.points[which])
        kind, _, last = which.rpartition(":")
        number = as_whole(last)
        kind = which if number is None else kind
        if not _is_kind(kind):
            raise InputError(
                "point",
                f"{which!r} is no special point",
                "give one like 'bp', 'bp:2', 'fold:v', 'cmc' or 'end', or a number",
            )
        if number is None:
            return [_solution(self.at(special)) for special in self.find(which)]
        found = self.find(kind)
        if not 1 <= number <= len(found):
            there = counted(len(found), f"special point {kind}", f"special points {kind}")
            raise InputError("point", f"the branch has {there}, so there is no {which}", "follow it further")
        return _solution(self.at(found[number - 1]))

    def resume(self, until: Until | None = None, **how: Any) -> Branch:
        """Go on from the last point; this branch and what follows as one.

        Args:
            until: where to stop.
            how: ``max_points, step, max_step``, as ``pearlbvp.branch`` takes them.

        Raises:
            InputError: nothing can follow, or an argument cannot be used.
        """
        from pearlbvp.studies.onward import resumed

        return followed_by(lambda options: resumed(self, options), until, how)

    def switch(
        self,
        number: int,
        until: Until | None = None,
        *,
        centre: Literal["pearl", "neck"] | None = None,
        grow: bool = True,
        fix: str | Held | None = None,
        **how: Any,
    ) -> Branch:
        """The branch that crosses this one at its branch point ``number`` (the first is 1).

        Args:
            number: which of the branch points.
            until: where to stop.
            centre: of pearls: whether the new shapes are centred on a pearl or on a neck.
            grow: which half of a pitchfork is followed: that on which the tube grows at its centre, or the other.
            fix: what is held from there on while stability is judged, as ``pearlbvp.branch`` takes it; by default as here.
            how: ``max_points, step, max_step``, as ``pearlbvp.branch`` takes them.

        Raises:
            InputError: there is no such branch point, or its shapes cannot be followed, or an argument cannot be used.
        """
        from pearlbvp.studies.onward import switched

        return followed_by(
            lambda options: switched(self, number, options, centre=centre, grow=grow, fix=fix), until, how
        )

    def vary(
        self,
        name: str,
        until: Until | None = None,
        *,
        point: int = -1,
        keep: str = "v",
        down: bool | None = None,
        fix: str | Held | None = None,
        **how: Any,
    ) -> Branch:
        """The branch through a point of this one along which ``c0`` or ``L`` varies.

        Args:
            name: what varies.
            until: where to stop.
            point: from which point; by default the last.
            keep: what stays as it is there: ``v`` or ``lambda2``.
            down: whether to begin towards smaller values; by default towards where ``until`` wants it.
            fix: what is held from there on while stability is judged, as ``pearlbvp.branch`` takes it; by default as here.
            how: ``max_points, step, max_step``, as ``pearlbvp.branch`` takes them.

        Raises:
            InputError: an argument that cannot be used.
        """
        from pearlbvp.studies.onward import varied

        point = whole("point", point, -math.inf)
        if not -len(self) <= point < len(self):
            raise InputError("point", f"there is no point {point}", f"the branch has points 0 to {len(self) - 1}")
        upwards = None if down is None else not down
        return followed_by(
            lambda options: varied(self, point, name, options, keep=keep, upwards=upwards, fix=fix), until, how
        )

    def follow(
        self,
        kind: str,
        number: int,
        name: str,
        until: Until | None = None,
        *,
        down: bool | None = None,
        fix: str | Held | None = None,
        **how: Any,
    ) -> Branch:
        """The curve of one of this branch's folds or branch points while ``c0`` or ``L`` varies.

        Args:
            kind: ``bp``, or ``fold:NAME`` of a column.
            number: which of them (the first is 1).
            name: what varies.
            until: where to stop.
            down: whether to begin towards smaller values; by default towards where ``until`` wants it.
            fix: what is held from there on while stability is judged, as ``pearlbvp.branch`` takes it; by default as here.
            how: ``max_points, step, max_step``, as ``pearlbvp.branch`` takes them.

        Raises:
            InputError: there is no such special point, or an argument cannot be used.
        """
        from pearlbvp.studies.onward import followed

        upwards = None if down is None else not down
        return followed_by(
            lambda options: followed(self, kind, number, name, options, upwards=upwards, fix=fix), until, how
        )

    def save(self, path: str | os.PathLike[str], units: Units = RADII) -> None:
        """Save it as HDF5, whole or not at all; ``pearlbvp.load`` reads it.

        Args:
            path: where to.
            units: in which commands show it and go on from it; it is saved in radii (``Units.of_file`` reads them).

        Raises:
            InputError: the place cannot be written to.
        """
        from pearlbvp.studies.saved import save

        save(self, path, units=units)

    def plot(
        self,
        title: str = "",
        units: Units = RADII,
        *,
        reference: core.Branch[Any] | Literal["tube"] | None = None,
        shapes: bool = False,
    ) -> Figure:
        """Its diagrams and some of its shapes.

        Args:
            title: of the picture.
            units: of the axes.
            reference: draw energies as differences from that of the straight tube, or of a branch at the same volume.
            shapes: draw one diagram, with shapes at their places.

        Raises:
            InputError: the reference has none of the volumes.
        """
        from pearlbvp.figures.branch import along, draw_branch
        from pearlbvp.figures.diagram import draw_plane
        from pearlbvp.studies.energies import Reference

        energies = None if reference is None else Reference.of(reference)
        if shapes:
            return draw_plane({"": self}, along(self), title=title, units=units, reference=energies, shapes=True)
        return draw_branch(self, title, units, reference=energies)

    def explore(self, x: str = "", y: str = "E", units: Units = RADII) -> Explorer:
        """A page in which its diagram and shapes can be explored, in a notebook; ``.text`` is its HTML.

        Args:
            x: column drawn to the right at first, ``v`` by default.
            y: column drawn upwards at first.
            units: of the numbers.

        Raises:
            InputError: a column that the branch does not have.
        """
        from pearlbvp.explorer.page import explorer

        return explorer({self.points[-1].problem.family: self}, x, y, units=units)

    def table(self, units: Units = RADII) -> pd.DataFrame:
        """A row a point, with the columns that every family has: ``pearlbvp.studies.branch.COLUMNS``.

        Args:
            units: of the numbers; physical ones stand in the names of the columns: ``r_min[nm]``.
        """
        from pearlbvp.studies.branch import COLUMNS

        table = super().table()
        return units.table(table[[*COLUMNS, *(name for name in table if name not in COLUMNS)]])


def followed_by(follow: Any, until: Until | None, how: Mapping[str, Any]) -> Branch:
    """A branch, with signs of life on a terminal while it is followed."""
    from pearlbvp.continuation.following import kept
    from pearlbvp.progress import progress
    from pearlbvp.studies.branch import branch_options

    check_names(how, ("max_points", "step", "max_step"))
    with progress("point") as bar:

        def count(so_far: core.Branch[Any]) -> None:
            bar.set_postfix(v=f"{so_far.points[-1].observables.get('v', math.nan):.5f}", refresh=False)
            bar.update(len(so_far.points) - bar.n)

        return Branch.of(kept(follow, branch_options(until, progress=count, **how)))


def check_names(how: Mapping[str, Any], names: Iterable[str]) -> None:
    """Refuse arguments of other names.

    Raises:
        InputError: the first of them, and those that there are.
    """
    known = list(names)
    for name in how:
        if name not in known:
            raise InputError(name, "there is no such argument", f"there are {', '.join(known)}")
