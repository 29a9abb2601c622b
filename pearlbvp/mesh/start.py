"""Where branches of triangulated tubes start: the discrete branch points of the straight tube, or any surface near one."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from scipy.sparse.linalg import splu

from pearlbvp.arrays import Array
from pearlbvp.continuation.path import correct_at
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.switching import tangent_along
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, choice, cylinder_lambda1
from pearlbvp.mesh.functional import Functional, Kind
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.problem import MeshProblem, about, with_phases
from pearlbvp.newton import NewtonOptions
from pearlbvp.theory.amplitude import linear
from pearlbvp.theory.dispersion import onset_lambda2
from pearlbvp.units import Sentence

Form = Literal["pearl", "ring", "coil", "buckle"]

SECANTS = 12
"""Steps of the secant method at most; on good meshes it takes two."""

PRECISE = 1e-8
"""Step in ``lambda2`` that the secant method makes its last: the next would be rounding."""

NEWTON = NewtonOptions(max_iterations=20)


def solved(problem: MeshProblem, u: Array, keep: str = "v") -> Array:
    """The equilibrium near ``u`` that has the same ``v`` or ``lambda2``.

    Raises:
        InputError: Newton's method does not converge; the message says why.
    """
    result, _ = correct_at(problem, u, NEWTON, {"v": -1, "lambda2": -2}[keep])
    if not result.converged:
        raise InputError(
            "surface", f"no equilibrium near it ({result.message})", "start from a better one, or a finer mesh"
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
    problem, guess = about(functional.on(mesh), c0, np.array([lambda1, lambda2, v]), **others)
    return problem, solved(problem, guess)


def straight(mesh: PeriodicMesh, c0: float, lambda2: float, kind: Kind = "subdivision") -> tuple[MeshProblem, Array]:
    """The discrete straight tube of a given ``lambda2`` on a mesh with vertices on the unit cylinder."""
    problem, guess = _cylinder(mesh, c0, lambda2, kind)
    return problem, solved(problem, guess, "lambda2")


def _cylinder(mesh: PeriodicMesh, c0: float, lambda2: float, kind: Kind) -> tuple[MeshProblem, Array]:
    """The problem about a mesh of the unit cylinder, and the exact parameters of a ``lambda2`` as its guess.

    Its phase conditions are against translations across, whatever the mesh: shifted along or turned about itself the
    cylinder stays where it is, and the small normal part that these motions have on a mesh is no motion but its error.
    """
    functional = Functional(mesh, kind)
    mesh = mesh.moved(functional.vertices_near(mesh.vertices))
    problem = MeshProblem(functional.on(mesh), np.zeros((0, mesh.count)), c0)
    _, motions = problem.functional.normal_mass(mesh.vertices, problem.directions)
    across = motions[1:3] / math.sqrt(math.pi * mesh.length)  # unit ones
    parameters = [cylinder_lambda1(lambda2, c0), lambda2, 1.0]
    guess = np.concatenate((np.zeros(mesh.count + len(across)), parameters))
    return replace(problem, phases=across), guess


def waves(points: Array, length: float, m: int, n: int) -> Array:
    """All products of a sine or cosine along and one around the tube, shape (1, 2 or 4, V)."""
    x, phi = 2 * math.pi * m * points[:, 0] / length, n * np.arctan2(points[:, 2], points[:, 1])
    along = [np.cos(x), np.sin(x)] if m else [np.ones_like(x)]
    around = [np.cos(phi), np.sin(phi)] if n else [np.ones_like(x)]
    return np.array([a * b for a in along for b in around])


def branch_point(
    mesh: PeriodicMesh, c0: float, m: int, n: int, kind: Kind = "subdivision"
) -> tuple[MeshProblem, Array]:
    """The discrete straight tube on which a mode is neutral.

    A Lyapunov-Schmidt reduction: the displacement is kept orthogonal to the mode's waves. So the tube is regular at its
    branch point, and exists on meshes that break the symmetry, where the pitchfork is imperfect and no equilibrium is near.
    There the waves' rates differ as well; their mean vanishes at the point returned. It is all but linear in ``lambda2``,
    and the secant method ends at rounding.

    Args:
        mesh: vertices on the unit cylinder.
        c0: spontaneous curvature.
        m, n: waves along and around the tube.
        kind: the discretization.

    Returns:
        The problem, the mode's waves being the last of its phase conditions, and its solution. Their multipliers are the
        force by which the mesh breaks the symmetry: 0 where it has that of a lattice, as structured meshes have.

    Raises:
        InputError: there is no such branch point, or the mesh is too coarse for the mode.
    """
    near = onset_lambda2(Tube(c0, mesh.length), m, n)
    wave, edge = 2 * math.pi / math.hypot(2 * math.pi * m / mesh.length, n), float(mesh.edge_lengths.mean())
    if wave < 2 * edge:
        text = f"{m, n} has waves shorter than two edges of the mesh, {{edge:.2g}}"
        raise InputError("mode", Sentence(text, edge=2 * edge), "give more nodes")
    problem, u, count = _without_mode(*_cylinder(mesh, c0, near, kind), m, n)
    u = solved(problem, u, "lambda2")
    rate, slope = _mean_rate(problem, u, count), float(linear((2 * math.pi * m / mesh.length) ** 2, n))
    for _ in range(SECANTS):
        step = -rate / slope
        u = u.copy()
        u[-3:-1] += -step, step  # lambda1 + lambda2 is all but constant
        u = solved(problem, u, "lambda2")
        if abs(step) < PRECISE:
            return problem, u
        before, rate = rate, _mean_rate(problem, u, count)
        slope = (rate - before) / step
    text = f"{m, n} has no branch point on this mesh near lambda2 = {{lambda2:.4g}}"
    raise InputError("mode", Sentence(text, lambda2=near), "give more nodes")


def neutral_tube(mesh: PeriodicMesh, c0: float, m: int, n: int, kind: Kind = "subdivision") -> Solution[MeshProblem]:
    """``branch_point`` as a solution, whose branch is that of the straight tubes, towards larger ``lambda2``."""
    problem, u = branch_point(mesh, c0, m, n, kind)
    direction = np.zeros_like(u)
    direction[-2] = 1.0
    return Solution(problem, u, tangent_along(problem, u, direction))


def _without_mode(problem: MeshProblem, u: Array, m: int, n: int) -> tuple[MeshProblem, Array, int]:
    """The problem with phase conditions against a mode's waves, orthonormal ones, besides its own; and their number."""
    shapes = np.array([_control(problem.functional, wave) for wave in waves(problem.points(u), problem.length, m, n)])
    mass, _ = problem.functional.normal_mass(problem.vertices(u), problem.directions)
    rows = shapes @ mass
    rows = np.linalg.solve(np.linalg.cholesky(rows @ shapes.T), rows)
    found = replace(problem, phases=np.vstack((problem.phases, rows)))
    return found, np.concatenate((u[:-3], np.zeros(len(rows)), u[-3:])), len(rows)


def _mean_rate(problem: MeshProblem, u: Array, count: int) -> float:
    """Mean growth rate of the waves that are the last ``count`` phase conditions, at given area and ``lambda2``.

    ``(F, B; B^T, 0) (w; g) = (0; 1)`` has ``w^T F w = -g``: the second variation reduced to the waves. It is singular where
    that on all displacements is (W. J. F. Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria (SIAM 2000),
    ch. 3), and its eigenvalues are the growth rates where they vanish.
    """
    place = slice(u.size - 3 - count, u.size - 3)
    unit, keep = np.zeros((u.size, count)), np.zeros_like(u)
    unit[place], keep[-2] = np.eye(count), 1.0
    return float(np.trace(problem.solve(u, unit, keep)[place]) / count)


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
    choice("family", form, tuple(allowed))
    if not allowed[form]:
        raise InputError("mode", f"{(m, n)} is none of a {form}", "see the modes that dispersion lists")
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
    return np.asarray(splu(functional.point_matrix.tocsc()).solve(values))
