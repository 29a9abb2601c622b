"""Flows and the shapes on their way with the verbs of an ordinary analysis, which needs no other import then.

The rooms below do the work; nothing is computed here.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.branches import Branch, Until, check_names, followed_by
from pearlbvp.continuation import solution as solutions
from pearlbvp.errors import InputError
from pearlbvp.files import check_ending, named, writable, write_whole
from pearlbvp.flows.driver import FlowOptions, resumed
from pearlbvp.flows.driver import start as beginning
from pearlbvp.flows.record import FlowResult, FlowState, Frame
from pearlbvp.helfrich import Tube, finite, positive, whole
from pearlbvp.messages import say
from pearlbvp.progress import SECONDS, progress
from pearlbvp.solutions import Solution
from pearlbvp.studies.flow_start import Perturbation, end_start, known_points, refuse_idle, solution_start
from pearlbvp.units import RADII, Units

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pearlbvp.explorer.page import Explorer
    from pearlbvp.flows.problem import FlowProblem, Law
    from pearlbvp.mesh.functional import Kind
    from pearlbvp.mesh.periodic import PeriodicMesh
    from pearlbvp.studies.flow_shape import Given


class FlowShape(Frame):
    """A shape on the way of a flow, at the time ``t``."""

    def profile(self, samples: int = 400) -> pd.DataFrame:
        """Places ``x`` along the tube and radii ``r`` there, of an axisymmetric shape, in radii.

        Raises:
            InputError: it flows among shapes that need not be axisymmetric.
        """
        from pearlbvp.studies.flow_shape import profile_table

        return profile_table(self, samples)

    def surface(self, nodes: int = 3000) -> PeriodicMesh:
        """The shape as triangles on one period of the tube, with about so many vertices; of a mesh its own."""
        from pearlbvp.studies.flow_shape import frame_mesh

        return frame_mesh(self, nodes)

    def plot(self, axes: Axes | None = None, units: Units = RADII) -> Figure:
        """A picture of the surface, with its time as the title.

        Args:
            axes: where to draw, by default in a figure of its own.
            units: of the time.
        """
        from pearlbvp.figures.flow import draw_shape

        return draw_shape(self, axes, units)


class Flow(FlowResult):
    """How a flow went: its table, the shapes on its way, and where it ended.

    Attributes:
        status: ``steady`` (at rest on a stable shape), ``saddle`` (on an unstable one), ``time``, ``pinch``, ``overhang``,
            ``unresolved``, ``stalled``, ``steps``, ``seconds``, ``interrupted``, or ``saved`` of one that was loaded.
        reason: what happened, when and where.
        advice: what to try, or empty.
        equilibrium: what it rests on, in its own coordinates: ``observables``, ``growth_rates``.
        state: the last shape, and the record of all that came before.

    Examples:
        >>> import pearlbvp as pb
        >>> pearls = pb.branch(pb.Tube(c0=0.48, L=15), "pearl", (2, 0), until={"v": 1.015})
        >>> localizing = pb.flow(pearls[-1], keep=True)
        >>> localizing.status, localizing.described, localizing.end.spectrum.n_unstable
        ('steady', 'an axisymmetric tube', 0)
        >>> onwards = localizing.branch(until={"v": 1.02})
    """

    @classmethod
    def of(cls, found: FlowResult) -> Flow:
        """A flow of the rooms below."""
        return cls(**{field.name: getattr(found, field.name) for field in fields(found)})

    @property
    def shapes(self) -> list[FlowShape]:
        """Shapes on the way, the first and the last among them; of long flows some four hundred."""
        return [FlowShape(frame.t, frame.problem, frame.q) for frame in self.state.record.frames]

    def at(self, t: float) -> FlowShape:
        """The shape on the way that is next to a time.

        Raises:
            InputError: the flow does not get there.
        """
        t, shapes = finite("t", t), self.shapes
        if not 0 <= t <= self.state.t:
            raise InputError("t", f"{t:g} is not between 0 and {self.state.t:.6g}", "give a time of the flow")
        return shapes[int(np.abs(np.array([shape.t for shape in shapes]) - t).argmin())]

    @property
    def described(self) -> str:
        """What it rests on, in a few words: ``a right-handed coil``.

        Raises:
            InputError: it did not come to rest.
        """
        from pearlbvp.studies.flow_end import described, known_end

        return described(known_end(self))

    @cached_property
    def end(self) -> Solution:
        """What it rests on as a point of a branch, with its stability to all perturbations of the tube.

        Branches have area ``2 pi L``: it is the similar shape of that area, on a tube of another ``c0`` and ``L`` where the
        perturbation changed the area.

        Raises:
            InputError: it did not come to rest, or its end is no point of a branch, as that of the straight tube.
        """
        from pearlbvp.studies.flow_end import end_branch

        return Branch.of(end_branch(self))[0]

    def branch(self, until: Until | None = None, *, down: bool | None = None, **how: Any) -> Branch:
        """The branch through its ``end``, along which volume changes.

        Args:
            until: where to stop.
            down: whether to begin towards smaller volume; by default towards where ``until`` wants it, else larger.
            how: ``max_points, step, max_step``, as ``pearlbvp.branch`` takes them.

        Raises:
            InputError: as ``end``, or an argument cannot be used.
        """
        from pearlbvp.studies import onward
        from pearlbvp.studies.flow_end import continued, end_branch

        if down is None:
            return followed_by(lambda options: onward.resumed(end_branch(self), options), until, how)
        return followed_by(lambda options: continued(self, options, upwards=not down), until, how)

    def resume(self, **how: Any) -> Flow:
        """Go on from its last shape; this flow and what follows as one.

        Args:
            how: when it ends and how it is stepped, as ``pearlbvp.flow`` takes it.

        Raises:
            InputError: an argument that cannot be used.
        """
        return _run(lambda: self.state, how)

    def save(self, path: str | os.PathLike[str], units: Units = RADII) -> None:
        """Save its record and its last shape as HDF5, whole or not at all; ``pearlbvp.load`` reads it.

        Args:
            path: where to.
            units: in which commands show it and go on from it; it is saved in radii.

        Raises:
            InputError: the place cannot be written to.
        """
        from pearlbvp.studies import flow as study

        study.save(self.state, path, units=units)

    def plot(self, title: str = "", units: Units = RADII) -> Figure:
        """Energy, multipliers and velocity over time, and the first and the last shape.

        Args:
            title: of the picture.
            units: of the axes.
        """
        from pearlbvp.figures.flow import draw_flow

        return draw_flow(self.state, self.state.columns(units), title, units)

    def movie(self, path: str | os.PathLike[str], units: Units = RADII) -> None:
        """Write a movie of the shapes on the way.

        Args:
            path: ending in ``.gif``.
            units: of the times that stand in it.

        Raises:
            InputError: another ending, or a place that cannot be written to.
        """
        from pearlbvp.figures.movie import write_movie

        check_ending("path", named("path", path), (".gif",))
        write_whole("path", writable("path", path), lambda whole: write_movie(self.state, whole, units=units))

    def explore(self, x: str = "t", y: str = "E", units: Units = RADII) -> Explorer:
        """A page that plays its shapes beside its table's columns, in a notebook; ``.text`` is its HTML.

        Args:
            x: column drawn to the right at first.
            y: column drawn upwards at first.
            units: of the numbers.

        Raises:
            InputError: a column that flows do not have.
        """
        from pearlbvp.explorer.page import explorer

        return explorer({"flow": self.state}, x, y, units=units)


def flow(
    start: solutions.Solution[Any] | FlowResult,
    *,
    perturb: Perturbation = "critical",
    delta: float | None = None,
    xi: float | None = None,
    centre: float | None = None,
    keep: bool = False,
    law: Law | None = None,
    points: int | None = None,
    symmetric: bool = True,
    size: tuple[int, int] | None = None,
    nodes: int | None = None,
    discretization: Kind | None = None,
    **how: Any,
) -> Flow:
    """Let a perturbed equilibrium flow at fixed area and volume until it rests.

    Args:
        start: a point of a branch, or a flow that came to rest: that shape, in that flow's coordinates. (``Flow.resume`` goes
            on from a last shape without perturbing it.)
        perturb: ``critical`` (along the most unstable perturbation), ``bump`` or ``none``.
        delta: size of the perturbation, in radii, 0.02 by default; a negative bump moves the surface outwards.
        xi: how narrow a bump ``1/(1 + xi x^2)`` is, 1 by default.
        centre: axial position of its middle, 0 by default.
        keep: move the perturbed shape back to the area and volume it had.
        law: what the flow keeps: ``area and volume`` (the default), ``area`` at the point's pressure, or ``diffusion`` for
            area and volume in the ``H^-1`` flow; that of a flow is its own.
        points: of an axisymmetric shape, 128 by default.
        symmetric: whether pearls stay axisymmetric; else they flow among all tubes.
        size: largest wave numbers along and around, of tubes in modes: 12 and 12 by default, 24 and 6 of pearls.
        nodes: on a triangulated tube of about so many vertices.
        discretization: of that, ``subdivision`` (the default) or ``cotangent``.
        how: when it ends and how it is stepped: ``until`` (a time), ``velocity``, ``rtol``, ``atol``, ``max_steps``,
            ``max_seconds`` and the other fields of ``FlowOptions``.

    Raises:
        InputError: an argument that cannot be used, or says nothing beside the others.

    Examples:
        >>> import pearlbvp as pb
        >>> pearls = pb.branch(pb.Tube(c0=0.48, L=15), "pearl", (2, 0), until={"v": 1.015})
        >>> pushed = pb.flow(pearls[-1], perturb="bump", delta=-0.01, xi=4, until=0.1)
        >>> pushed.status, bool(pushed.table().E.is_monotonic_decreasing)
        ('time', True)
    """
    coordinates = {"points": points, "size": size, "nodes": nodes, "discretization": discretization}

    def begun() -> FlowState:
        if isinstance(start, FlowResult):
            own = coordinates | {"law": law, "symmetric": None if symmetric else False}
            refuse_idle(*((value is not None, name, "the flow has its own") for name, value in own.items()))
            found = end_start(start)
        else:
            how_described: dict[str, Any] = coordinates
            found = solution_start(start, law=law or "area and volume", symmetric=symmetric, **how_described)
        q = found.perturbed(perturb, delta, xi=xi, centre=centre, keep=keep)
        return _beginning(found.problem, q, "start")

    return _run(begun, how)


def flow_shape(
    shape: Given,
    tube: Tube,
    *,
    law: Law = "area and volume",
    pressure: float | None = None,
    points: int | None = None,
    discretization: Kind | None = None,
    units: Units = RADII,
    **how: Any,
) -> Flow:
    """Let any shape flow as it is, which need be no equilibrium: radii, or a triangulated tube.

    Args:
        shape: one period: places and radii ``(x, r)``, a table with these columns, a triangulated tube, or the name of a
            file that has one of these (a table, VTU, VTP, VTK, PLY, OBJ, STL, OFF or MSH).
        tube: the tube whose spontaneous curvature and length it has, in radii.
        law: what the flow keeps, as ``flow`` takes it.
        pressure: ``lambda2``, with the law ``area``; 0 by default.
        points: of the flow of radii, 128 by default.
        discretization: of that of a triangulated tube, ``subdivision`` (the default) or ``cotangent``.
        units: of the shape.
        how: when it ends and how it is stepped, as ``flow`` takes it.

    Raises:
        InputError: an argument that cannot be used, or says nothing beside the others.

    Examples:
        >>> import numpy as np
        >>> import pearlbvp as pb
        >>> x = np.linspace(0, 10, 65)
        >>> pearling = pb.flow_shape((x, 1 + 0.1 * np.cos(0.2 * np.pi * x)), pb.Tube(c0=0.0, L=10))
        >>> pearling.status
        'steady'
    """
    from pearlbvp.studies.flow_shape import known_shape, shape_start

    def begun() -> FlowState:
        try:
            found, said = known_shape(shape, tube, units, known_points(points))
            problem, q = shape_start(
                found, tube, law=law, pressure=pressure, points=points, discretization=discretization
            )
        except InputError as error:
            if error.argument == "radius":
                raise InputError("shape", error.what, "give its units, like units=pb.Units.of('50nm')") from None
            raise (error.named("shape") if error.argument == "profile" else error) from None
        if said:
            say(said)
        return _beginning(problem, q, "shape")

    return _run(begun, how)


_NUMBERS = ("until", "velocity", "rtol", "atol", "max_seconds", "resolution", "every")
"""Fields of ``FlowOptions`` that are numbers above 0."""


def _run(begin: Callable[[], FlowState], how: Mapping[str, Any]) -> Flow:
    """A flow, with signs of life on a terminal while it goes on; how it is stepped is looked at before it begins.

    Raises:
        InputError: an argument that cannot be used.
    """
    check_names(how, [field.name for field in fields(FlowOptions)])
    checked = {name: positive(name, how[name]) for name in _NUMBERS if how.get(name, math.inf) != math.inf}
    checked |= {name: whole(name, how[name]) for name in ("max_steps", "max_order") if name in how}
    with progress("step") as bar:

        def count(state: FlowState) -> None:
            bar.set_postfix(t=f"{state.t:.5g}", refresh=False)
            bar.update(len(state.record.rows["t"]) - bar.n)

        shown: dict[str, Any] = {"checkpoint": count, "every": SECONDS}
        options = FlowOptions(**shown | dict(how) | checked)
        return Flow.of(resumed(begin(), options))


def _beginning(problem: FlowProblem, q: Array, name: str) -> FlowState:
    """The state of a flow at time 0; what is wrong with its shape is said of the argument that it came from."""
    try:
        return beginning(problem, q)
    except InputError as error:
        raise (error.named(name) if error.argument == "q" else error) from None
