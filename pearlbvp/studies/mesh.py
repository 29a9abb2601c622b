"""Triangulated tubes: branches on meshes from the straight tube on, and meshes of shapes that were computed otherwise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, get_args

import numpy as np
import pandas as pd

from pearlbvp.collocation import PiecewisePolynomial
from pearlbvp.collocation.scheme import Array
from pearlbvp.continuation.branch import Branch, BranchOptions, BranchPoint, continue_branch, start_point
from pearlbvp.continuation.path import Point
from pearlbvp.continuation.switching import switch, tangent_along
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, choice, cylinder_energy, cylinder_lambda1, mode_numbers, whole
from pearlbvp.mesh.adaptation import AdaptOptions
from pearlbvp.mesh.families import Surface, carried, tube_mesh
from pearlbvp.mesh.functional import Functional, Kind
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.problem import MeshProblem
from pearlbvp.mesh.spectrum import Fixed
from pearlbvp.mesh.start import Form, equilibrium, onset
from pearlbvp.stability.profile import Profile
from pearlbvp.studies.branch import known_options, known_point, numbered
from pearlbvp.theory.dispersion import Mode, critical_lambda2

NODES = 3000
"""Vertices of a mesh by default: four digits of the branch points of the straight tube."""

SMALLEST_AMPLITUDE = 1e-6
"""Amplitude below which a shape is the straight tube."""

AROUND = 256
"""Points of a section from which those between them are interpolated."""


def mesh_branch(
    c0: float,
    length: float,
    family: Form,
    mode: Mode,
    nodes: int = NODES,
    options: BranchOptions | None = None,
    *,
    kind: Kind = "subdivision",
    adapt: AdaptOptions | None = None,
    fixed: Fixed = "area and volume",
) -> Branch[MeshProblem]:
    """The branch that leaves the straight tube at a mode, on a triangulated surface, with stability.

    Args:
        c0: spontaneous curvature.
        length: axial period of the tube, in radii.
        family: ``pearl`` (mode ``m,0``), ``ring`` (``0,n``), ``coil`` or ``buckle`` (``m,n``).
        mode: waves along and around the tube.
        nodes: vertices of the mesh at first.
        options: where to stop and how to step, from ``studies.branch.branch_options``.
        kind: the discretization.
        adapt: when and how the mesh is adapted on the way.
        fixed: what the perturbations keep that stability is judged by.

    Returns:
        The branch; its table has the columns of a branch of pearls.

    Raises:
        InputError: an argument that cannot be used.
    """
    tube, mode, nodes, options = (
        Tube(c0, length),
        mode_numbers("mode", mode),
        whole("nodes", nodes),
        known_options(options),
    )
    for name, value, words in (("family", family, Form), ("kind", kind, Kind), ("fixed", fixed, Fixed)):
        choice(name, value, get_args(words))
    problem, u, direction = onset(
        tube, family, *mode, tube_mesh(tube.length, nodes, coil=mode if family == "coil" else None), kind
    )
    problem = replace(problem, adapt=adapt or AdaptOptions(), fixed=fixed).symmetric(u, direction)
    start = start_point(problem, u, direction)
    exact = straight_values(tube, float(critical_lambda2(tube.wave_number(mode[0]), mode[1], tube.c0)))
    return continue_branch(start, options, at_bifurcation=True, exact=exact)


def straight_values(tube: Tube, lambda2: float) -> dict[str, float]:
    """The straight tube's own numbers, which a mesh of it has to its accuracy only."""
    return {
        "lambda1": cylinder_lambda1(lambda2, tube.c0), "lambda2": lambda2, "v": 1.0, "E": cylinder_energy(tube.c0),
        "amplitude": 0.0, "r_min": 1.0, "r_max": 1.0, "wave": 0.0,
    }  # fmt: skip


def meshed(
    point: BranchPoint[Any] | Point[Any], nodes: int | PeriodicMesh = NODES, *, kind: Kind = "subdivision"
) -> tuple[MeshProblem, Array]:
    """The equilibrium on a mesh at the reduced volume of a computed shape; of a shape on a mesh itself.

    Args:
        point: of a branch of any family.
        nodes: vertices of the mesh, or a mesh of the straight tube that is carried over to the shape. A shape on a mesh has
            its own.
        kind: the discretization; a shape on a mesh has its own.

    Returns:
        The problem and its unknown: ``problem.observables(u)``, ``problem.spectrum(u)``, ``problem.surface(u)``.

    Raises:
        InputError: the mesh is too coarse for the shape, or that is the straight tube.
    """
    point = known_point(point)
    choice("kind", kind, get_args(Kind))
    found = point.observables
    if found["amplitude"] < SMALLEST_AMPLITUDE:
        raise InputError(
            "point: it is the straight tube, which is an equilibrium at any pressure; choose another point"
        )
    if isinstance(point.problem, MeshProblem):
        return point.problem, point.u
    fixed = point.problem.fixed
    return equilibrium(
        shape_mesh(point, nodes), found["c0"], found["v"], found["lambda1"], found["lambda2"], kind, fixed=fixed
    )


def shape_mesh(point: BranchPoint[Any] | Point[Any], nodes: int | PeriodicMesh = NODES) -> PeriodicMesh:
    """A mesh with its vertices on a computed shape; of a shape on a mesh its own triangles.

    Args:
        point: of a branch of any family.
        nodes: vertices of the mesh, or a mesh of the straight tube that is carried over to the shape.

    Raises:
        InputError: so few nodes make no good triangles.
    """
    point, nodes = known_point(point), nodes if isinstance(nodes, PeriodicMesh) else whole("nodes", nodes)
    if isinstance(point.problem, MeshProblem):
        return point.problem.surface(point.u)
    length = point.observables["L"]
    surface = surface_points(point.problem, point.u)
    if isinstance(nodes, PeriodicMesh):
        return carried(nodes, surface)
    turns = point.problem.symmetry.turns if point.problem.stored_as == "tube" else 0
    return tube_mesh(length, nodes, surface, (turns, 1) if turns else None)


def mesh_table(mesh: PeriodicMesh, c0: float, kind: Kind = "subdivision") -> pd.DataFrame:
    """What there is to know of a mesh before anything is solved on it.

    Args:
        mesh: its vertices on the surface.
        c0: spontaneous curvature.
        kind: the discretization whose energy is given.

    Returns:
        One row: ``nodes, triangles, quality_worst, quality_mean`` (paper, eq. (mq); 3.46 is best), ``area, volume`` of the
        flat triangles, ``c0, L``, and ``E``, the discretization's energy by area of a surface through the vertices.
    """
    functional = Functional(mesh, kind)
    vertices = functional.vertices_near(mesh.vertices)
    energy, area, _ = functional.sums(vertices, np.zeros_like(vertices), c0).values
    return _rows(mesh, {"c0": c0, "L": mesh.length, "E": float(energy / area)})


def equilibrium_table(problem: MeshProblem, u: Array) -> pd.DataFrame:
    """The same of an equilibrium, and of the columns of a branch those from ``lambda1`` to ``r_max`` and of its stability."""
    found, spectrum = problem.observables(u), problem.spectrum(u)
    order = ("c0", "L", "E", "lambda1", "lambda2", "v", "amplitude", "r_min", "r_max")
    stability = {
        "n_unstable": spectrum.n_unstable if spectrum.complete else None,
        "mu_crit": spectrum.mu_crit,
        "critical": str(spectrum.critical),
        "mu_error": spectrum.residual,
    }
    return _rows(problem.surface(u), {name: found[name] for name in order} | stability)


def _rows(mesh: PeriodicMesh, values: dict[str, Any]) -> pd.DataFrame:
    quality = mesh.quality
    shape = {
        "nodes": mesh.count, "triangles": len(mesh.triangles), "quality_worst": quality.max(),
        "quality_mean": quality.mean(), "area": mesh.area, "volume": mesh.volume,
    }  # fmt: skip
    return pd.DataFrame([shape | values])


def branch_from(
    problem: MeshProblem, u: Array, options: BranchOptions, *, upwards: bool = False
) -> Branch[MeshProblem]:
    """The branch through an equilibrium, towards larger or smaller ``v`` at first."""
    direction = np.zeros_like(u)
    direction[-1] = 1.0 if upwards else -1.0
    problem = problem.symmetric(u)
    start = start_point(problem, u, tangent_along(problem, u, direction))
    return continue_branch(start, known_options(options))


def mesh_switched(
    branch: Branch[MeshProblem], number: int, options: BranchOptions, *, grow: bool = True
) -> Branch[MeshProblem]:
    """The branch that crosses ``branch`` at its branch point ``number`` (the first is 1).

    Args:
        branch: a branch on meshes.
        number: which of its branch points; those that shift or turn into each other come in twos, and lead to one branch.
        options: where to stop and how to step.
        grow: follow the half on which the tube grows in the middle of the period.

    Raises:
        InputError: there is no such branch point, or it was not located.
    """
    return switch(branch, numbered(branch, number), known_options(options), grow=grow)


def surface_points(problem: Any, u: Array) -> Surface:
    """Points of a computed shape by two parameters: ``x``, from 0 to the length, and ``phi``."""
    if problem.stored_as == "pearl":
        return _of_profile(problem.profile(u))
    if problem.stored_as == "tube":
        problem, u = problem.released(u, "lambda1", "lambda2", "v")  # whatever varies, at the shape's own length
    return _of_sections(lambda x: problem.section(u, x, AROUND + 1))


def _of_profile(profile: Profile) -> Surface:
    """An axisymmetric shape; the parameter ``x`` is the arclength, scaled to the length."""
    whole = profile.mirrored()
    states = whole.states
    cosines = PiecewisePolynomial(states.mesh, np.cos(states.values[:, 1:2]))
    along = PiecewisePolynomial(states.mesh, whole.arclength * cosines.integral())

    def points(x: Array, phi: Array) -> Array:
        period = np.floor(x / profile.period)
        sigma = x / profile.period - period
        r = states(sigma)[:, 0]
        return np.column_stack((along(sigma)[:, 0] + profile.period * period, r * np.cos(phi), r * np.sin(phi)))

    return points


def _of_sections(section: Callable[[float], tuple[Array, Array]]) -> Surface:
    """A shape with plane sections, each a closed curve by ``phi`` at equal distances."""

    def points(x: Array, phi: Array) -> Array:
        found = np.empty((len(x), 3))
        for place in np.unique(x):
            here = x == place
            y, z = section(float(place))
            wave = np.fft.fft(y[:-1] + 1j * z[:-1]) / (len(y) - 1)
            numbers = np.fft.fftfreq(len(wave), 1 / len(wave))
            curve = np.exp(1j * np.outer(phi[here], numbers)) @ wave
            found[here] = np.column_stack((np.full(here.sum(), place), curve.real, curve.imag))
        return found

    return points
