"""Where branches of triangulated tubes start: the discrete branch points of the straight tube, or any surface near one."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
from scipy.sparse.linalg import splu

from pearlbvp.continuation.path import correct
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, cylinder_lambda1
from pearlbvp.mesh.functional import Functional, Kind
from pearlbvp.mesh.periodic import Array, PeriodicMesh
from pearlbvp.mesh.problem import MeshProblem, about, with_phases
from pearlbvp.mesh.subdivision import limit_matrix
from pearlbvp.newton import NewtonOptions
from pearlbvp.theory.dispersion import critical_lambda2

Form = Literal["pearl", "ring", "coil", "buckle"]

APART = 0.2
"""Distance in ``lambda2`` on both sides of a branch point at which the straight tube is solved for: it is singular there."""

NEWTON = NewtonOptions(max_iterations=20)


def solved(problem: MeshProblem, u: Array, keep: str = "v") -> Array:
    """The equilibrium near ``u`` that has the same ``v`` or ``lambda2``.

    Raises:
        InputError: Newton's method does not converge; the message says why.
    """
    direction = np.zeros_like(u)
    direction[{"v": -1, "lambda2": -2}[keep]] = 1.0
    result, _ = correct(problem, u, direction, u, 0.0, NEWTON)
    if not result.converged:
        raise InputError(
            f"surface: no equilibrium near it ({result.message}); start from a better one, or a finer mesh"
        )
    return result.u


def equilibrium(
    mesh: PeriodicMesh, c0: float, v: float, lambda1: float, lambda2: float, kind: Kind = "subdivision", **others: Any
) -> tuple[MeshProblem, Array]:
    """The equilibrium of a reduced volume near a surface.

    Args:
        mesh: its vertices lie on the surface.
        c0, v: of the equilibrium.
        lambda1, lambda2: guesses.
        kind: the discretization.
        others: further attributes of the problem.

    Raises:
        InputError: none is found.
    """
    functional = Functional(mesh, kind)
    mesh = mesh.moved(functional.vertices_near(mesh.vertices))
    problem, guess = about(mesh, c0, np.array([lambda1, lambda2, v]), kind, functional.on(mesh), **others)
    return problem, solved(problem, guess)


def straight(
    mesh: PeriodicMesh, c0: float, lambda2: float, kind: Kind = "subdivision", functional: Functional | None = None
) -> tuple[MeshProblem, Array]:
    """The discrete straight tube of a given ``lambda2`` on a mesh with vertices on the unit cylinder."""
    functional = functional or Functional(mesh, kind)
    mesh = mesh.moved(functional.vertices_near(mesh.vertices))
    parameters = np.array([cylinder_lambda1(lambda2, c0), lambda2, 1.0])
    problem, guess = about(mesh, c0, parameters, kind, functional.on(mesh))
    return problem, solved(problem, guess, "lambda2")


def waves(points: Array, length: float, m: int, n: int) -> Array:
    """All products of a sine or cosine along and one around the tube, shape (1, 2 or 4, V)."""
    x, phi = 2 * math.pi * m * points[:, 0] / length, n * np.arctan2(points[:, 2], points[:, 1])
    along = [np.cos(x), np.sin(x)] if m else [np.ones_like(x)]
    around = [np.cos(phi), np.sin(phi)] if n else [np.ones_like(x)]
    return np.array([a * b for a in along for b in around])


def mode_rate(problem: MeshProblem, u: Array, m: int, n: int) -> float:
    """Growth rate of a mode on the discrete straight tube: mean of the eigenvalues that belong to it.

    Raises:
        InputError: the mesh is too coarse for the mode.
    """
    shapes = waves(problem.points(u), problem.length, m, n)
    rates, vectors, _ = problem.modes(u, 16)
    mass, _ = problem.functional.normal_mass(problem.vertices(u), problem.directions)
    overlap = ((shapes @ (mass @ vectors)) ** 2).sum(axis=0) / np.einsum("iv,iv->i", vectors.T, (mass @ vectors).T)
    chosen = np.argsort(overlap)[-len(shapes) :]
    if overlap[chosen].sum() < 0.8 * sum(shape @ (mass @ shape) for shape in shapes):
        raise InputError(f"mode: {m, n} is none of the leading modes of this mesh; give more nodes")
    return float(rates[chosen].mean())


def branch_point(
    mesh: PeriodicMesh, c0: float, m: int, n: int, kind: Kind = "subdivision"
) -> tuple[MeshProblem, Array]:
    """The discrete straight tube on which a mode is neutral.

    Its rate is all but linear in ``lambda2``; on each side, where the tube is regular, it is computed once.
    """
    near = float(critical_lambda2(2 * math.pi * m / mesh.length, n, c0))
    if not math.isfinite(near):
        raise InputError(f"mode: {m, n} branches off nowhere; give another mode")
    functional = Functional(mesh, kind)
    sides = [straight(mesh, c0, near + side, kind, functional) for side in (-APART, APART)]
    low, high = (mode_rate(problem, u, m, n) for problem, u in sides)
    share = low / (low - high)
    problem = sides[0][0]
    return problem, (1 - share) * sides[0][1] + share * sides[1][1]


def onset(
    tube: Tube, form: Form, m: int, n: int, mesh: PeriodicMesh, kind: Kind = "subdivision"
) -> tuple[MeshProblem, Array, Array]:
    """The discrete straight tube where a form branches off, and the direction in which it does.

    Args:
        tube: the straight tube.
        form: ``pearl`` (mode ``m, 0``), ``ring`` (``0, n``), ``coil`` or ``buckle`` (``m, n``).
        m, n: waves along and around the tube.
        mesh: of the straight tube.
        kind: the discretization.

    Raises:
        InputError: the form has no such mode, or the mesh is too coarse for it.
    """
    allowed = {"pearl": m > 0 and n == 0, "ring": m == 0 and n > 1, "coil": m > 0 and n > 0, "buckle": m > 0 and n > 0}
    if form not in allowed:
        raise InputError(f"family: {form!r} is none of {', '.join(allowed)}")
    if not allowed[form]:
        raise InputError(f"mode: {m, n} is none of a {form}; see the modes that dispersion lists")
    problem, u = branch_point(mesh, tube.c0, m, n, kind)
    points = problem.points(u)
    x, phi = 2 * math.pi * m * points[:, 0] / tube.length, n * np.arctan2(points[:, 2], points[:, 1])
    wave = np.cos(x - phi) if form == "coil" else np.cos(x) * np.cos(phi)
    wave = _control(problem.functional, wave)
    shape = u.copy()
    shape[: mesh.count] += 0.1 * wave
    problem, u = with_phases(problem, u, shape)
    return problem, u, np.concatenate((wave, np.zeros(len(problem.phases) + 3)))


def _control(functional: Functional, values: Array) -> Array:
    """Displacements of the vertices that displace the surface by ``values`` there."""
    if functional.kind == "cotangent":
        return values
    return np.asarray(splu(limit_matrix(functional.mesh)[1].tocsc()).solve(values))
