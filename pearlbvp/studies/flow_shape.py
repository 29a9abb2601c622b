"""Shapes of flows as radii and triangles: those from elsewhere that flows start from, and those on their way."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError
from pearlbvp.files import named
from pearlbvp.flows.axisymmetric import GraphFlow
from pearlbvp.flows.problem import FlowProblem, Law
from pearlbvp.flows.record import Frame
from pearlbvp.flows.tube import TubeFlow
from pearlbvp.helfrich import Tube, finite, known_tube, whole
from pearlbvp.membrane import AROUND, of_sections
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.studies.flow_start import POINTS, known_points, profile_start, refuse_idle
from pearlbvp.studies.profiles import Rows, read_profile
from pearlbvp.tube.modes import sections
from pearlbvp.units import RADII, Units

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import ArrayLike

    from pearlbvp.mesh.functional import Kind

    Given = str | os.PathLike[str] | PeriodicMesh | pd.DataFrame | Mapping[str, ArrayLike] | tuple[ArrayLike, ArrayLike]

SAME = 1e-9
"""Relative difference of two periods that are one."""


def shape_start(
    shape: Rows | PeriodicMesh,
    tube: Tube,
    *,
    law: Law = "area and volume",
    pressure: float | None = None,
    points: int | None = None,
    discretization: Kind | None = None,
) -> tuple[FlowProblem, Array]:
    """A shape as a flow and its coordinates.

    Args:
        shape: rows of a profile, or a triangulated tube, in radii.
        tube: whose spontaneous curvature and period it has.
        law: what the flow keeps.
        pressure: ``lambda2``, where the law is ``area``; 0 by default.
        points: of the flow of a profile, 128 by default.
        discretization: of that of a triangulated tube, ``subdivision`` by default.

    Raises:
        InputError: an argument that cannot be used or says nothing.
    """
    profile = isinstance(shape, Rows)
    refuse_idle(
        (pressure is not None and law != "area", "pressure", "it goes with the law area"),
        (profile and discretization is not None, "discretization", "it is for triangulated tubes"),
        (not profile and points is not None, "points", "it says nothing of a triangulated tube"),
    )
    pressure = 0.0 if pressure is None else finite("pressure", pressure)
    if isinstance(shape, Rows):
        count = known_points(points)
        return profile_start(tube.c0, tube.length, shape.x, shape.r, points=count, law=law, pressure=pressure)
    from pearlbvp.studies.mesh_flow import surface_start  # the room of meshes is large, and only meshes need it

    return surface_start(tube.c0, shape, kind=discretization or "subdivision", law=law, pressure=pressure)


def known_shape(
    shape: Given, tube: Tube, units: Units = RADII, points: int = POINTS
) -> tuple[Rows | PeriodicMesh, str]:
    """A profile or a triangulated tube in radii, from whatever holds it, and what was done to it in words.

    Args:
        shape: ``(x, r)``, a table with these columns, a triangulated tube, or the name of a file that has one of these.
        tube: whose period it has.
        units: of the shape.
        points: at which a profile is going to be used.

    Raises:
        InputError: it is none, or has another period, or its radius is not about that of the tube.
    """
    known_tube(tube)
    if isinstance(shape, (str, os.PathLike)):
        from pearlbvp.mesh.files import READERS, read_surface

        if named("shape", shape).suffix.lower() in READERS:
            return read_surface(shape, tube.length, units, "shape")
        rows = read_profile("shape", shape, tube.length, points, units)
        return rows, f"{Path(shape).name}: {units.said(rows.said)}" if rows.said else ""
    if isinstance(shape, PeriodicMesh):
        return _of_mesh(shape, tube, units), ""
    return _rows(shape, units), ""


def _of_mesh(mesh: PeriodicMesh, tube: Tube, units: Units) -> PeriodicMesh:
    from pearlbvp.mesh.files import check_radius

    surface = units.surface_from_user(mesh)
    check_radius(surface)
    if abs(surface.length - tube.length) > SAME * tube.length:
        what = f"the mesh has a period of {surface.length:.10g} radii, and the tube one of {tube.length:.10g}"
        raise InputError("tube", what, "give the tube of the mesh's period")
    return replace(surface, length=tube.length)


def _rows(shape: Any, units: Units) -> Rows:
    """Places and radii as they are: they have all digits.

    Raises:
        InputError: they are none.
    """
    how = "give (x, r), a table with columns x and r, a triangulated tube, or a file's name"
    try:
        x, r = (shape["x"], shape["r"]) if hasattr(shape, "keys") else shape
        x, r = (np.asarray(values, dtype=float) for values in (x, r))
    except (KeyError, TypeError, ValueError):
        raise InputError("shape", f"{type(shape).__name__} holds no places x and radii r", how) from None
    return Rows(np.asarray(units.from_user("x", x)), np.asarray(units.from_user("r", r)))


def profile_table(frame: Frame, samples: int) -> pd.DataFrame:
    """Places and radii of an axisymmetric shape of a flow at equal steps along the axis; both ends are one place.

    Args:
        frame: the shape.
        samples: steps.

    Raises:
        InputError: it flows among shapes that need not be axisymmetric.
    """
    import pandas as pd

    problem = frame.problem
    if not isinstance(problem, GraphFlow):
        raise InputError("profile", f"the shape flows among {problem.space}", "take its surface")
    x = np.linspace(-problem.length / 2, problem.length / 2, whole("samples", samples, 3) + 1)
    return pd.DataFrame({"x": x, "r": _radii(problem, frame.q, x)})


def frame_mesh(frame: Frame, nodes: int) -> PeriodicMesh:
    """A shape of a flow as triangles on one period; a mesh is taken as it is.

    Args:
        frame: the shape.
        nodes: vertices, about.

    Raises:
        InputError: so few nodes make no good triangles.
    """
    from pearlbvp.mesh.families import tube_mesh

    problem, q = frame.problem, frame.q
    if not isinstance(problem, (GraphFlow, TubeFlow)):
        own: PeriodicMesh = problem.surface(q)
        return own
    phi = np.linspace(0, 2 * np.pi, AROUND + 1)

    def section(x: float) -> tuple[Array, Array]:
        if isinstance(problem, GraphFlow):
            curve = _radii(problem, q, np.array([x])) * np.exp(1j * phi)
        else:
            curve = sections(problem.known(q), 2 * np.pi / problem.length, 0.0, np.array([x]), phi)[0]
        return curve.real, curve.imag

    return tube_mesh(problem.length, whole("nodes", nodes), of_sections(section))


def _radii(graph: GraphFlow, q: Array, x: Array) -> Array:
    return np.sqrt(2 * graph.interpolated(q, x))
