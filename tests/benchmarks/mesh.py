"""Triangulated tubes: rows of a Newton step and of the leading rates; convergence on families of meshes.

The latter is printed by ``python tests/benchmarks/mesh.py``.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from importlib.util import find_spec

import numpy as np
from rows import Row, least, of_call, paired, row, written
from scipy import sparse

from pearlbvp import factorization
from pearlbvp.arrays import Array
from pearlbvp.continuation.path import correct, correct_at
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.mesh.adaptation import AdaptOptions, smoothed
from pearlbvp.mesh.families import edited, graded, jittered, straightened, tube_mesh
from pearlbvp.mesh.functional import Kind
from pearlbvp.mesh.operators import mean_curvature
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.problem import MeshProblem
from pearlbvp.mesh.start import branch_point, equilibrium, straight
from pearlbvp.mesh.subdivision import subdivided
from pearlbvp.newton import NewtonOptions
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.mesh import meshed
from pearlbvp.theory.dispersion import critical_lambda2

LENGTH = 10.0

SIZES = (1000, 3000)
"""Numbers of vertices for orders of convergence."""


def families(nodes: int) -> Iterator[tuple[str, PeriodicMesh]]:
    """Meshes of the straight tube."""
    mesh = tube_mesh(LENGTH, nodes)
    yield "structured", mesh
    yield "graded", graded(mesh)
    yield "graded and swept", graded(mesh, sweep=1.0)
    rough, irregular = jittered(mesh, 0.1), edited(graded(tube_mesh(LENGTH, int(nodes / 1.25)), 3.0))
    yield "jittered by 0.1", rough
    yield "by 0.1 h/h(1000)", jittered(mesh, 0.1 * np.sqrt(1000 / nodes))
    yield "by 0.1, smoothed", smoothed(rough)
    yield "smoothed, onto tube", straightened(smoothed(rough))
    yield "edited", irregular
    yield "edited, smoothed", straightened(smoothed(irregular))
    yield "edited once", edited_once(nodes)


def edited_once(nodes: int) -> PeriodicMesh:
    """A coarse edited mesh refined as a whole, so with as many vertices of other valences on all meshes."""
    mesh = edited(graded(tube_mesh(LENGTH, 150), 3.0))
    for _ in range(round(np.log(nodes / mesh.count) / np.log(4))):
        mesh = straightened(subdivided(mesh)[0])
    return mesh


def convergence(kind: Kind, sizes: tuple[int, ...] = SIZES) -> None:
    """Errors of the branch points of pearls, coils and wrinkles, and their orders in the mesh width."""
    print(f"\n{kind}: error in lambda2 of the branch points, order in the mesh width; largest error of H by cotangents")
    known: dict[tuple[str, int], tuple[int, float]] = {}
    for nodes in sizes:
        for name, mesh in families(nodes):
            cells = []
            for place, (m, n) in enumerate(((1, 0), (1, 1), (0, 2))):
                exact = float(critical_lambda2(2 * np.pi * m / LENGTH, n, 0.0))
                error = abs(float(branch_point(mesh, 0.0, m, n, kind)[1][-2]) - exact)
                before = known.get((name, place))
                order = (
                    "" if before is None else f"{2 * np.log(before[1] / error) / np.log(mesh.count / before[0]):.1f}"
                )
                known[name, place] = mesh.count, error
                cells.append(f"({m},{n}) {error:.1e} {order:4s}")
            others = (np.diff(mesh.star[0]) != 6).mean()
            curvature = f"H {np.abs(mean_curvature(mesh) - 0.5).max():.1e}" if kind == "cotangent" else ""
            print(
                f"  {name:20s} {mesh.count:6d} vertices, {others:3.0%} not of valence 6: ",
                *cells,
                curvature,
                flush=True,
            )


def phases(kind: Kind, sizes: tuple[int, ...] = SIZES[:2]) -> None:
    """Multipliers of the phase conditions on meshes of three shapes, errors of their multipliers and energy, and orders."""
    print(
        f"\n{kind}: largest multiplier of the phase conditions, largest error of lambda1, lambda2 and E; their orders"
    )
    until = branch_options({"v": 0.95})
    shapes = {
        "pearl A2": family_branch(Tube(0.0, LENGTH), "pearl", (1, 0), branch_options({"lambda2": -3.165})).points[-1],
        "coil": family_branch(Tube(0.0, LENGTH), "coil", (1, 1), until).points[-1],
        "buckle": family_branch(Tube(0.0, LENGTH), "buckle", (1, 1), until).points[-1],
    }
    known: dict[tuple[str, str], tuple[int, Array]] = {}
    for nodes in sizes:
        for name, mesh in families(nodes):
            cells = []
            for shape, point in shapes.items():
                try:
                    problem, u = meshed(point, mesh, kind=kind)
                except InputError as failure:
                    cells.append(f"{shape} {str(failure)[:30]}")
                    continue
                found, exact = problem.observables(u), point.observables
                error = max(abs(found[key] - exact[key]) for key in ("lambda1", "lambda2", "E"))
                figures = np.array([np.abs(problem.multipliers(u)).max(), error])
                count, before = known.get((name, shape), (0, figures))
                orders = 2 * np.log(before / figures) / np.log(mesh.count / count) if count else []
                known[name, shape] = mesh.count, figures
                cells.append(f"{shape} {figures[0]:.0e} {figures[1]:.0e} " + " ".join(f"{o:.1f}" for o in orders))
            print(f"  {name:20s} {mesh.count:6d} vertices: " + "   ".join(cells), flush=True)


@cache
def bulged(nodes: int, kind: Kind) -> tuple[MeshProblem, Array]:
    """A bulged tube."""
    k = 2 * np.pi / LENGTH

    def surface(x: Array, phi: Array) -> Array:
        r = 1 + 0.2 * np.cos(k * x)
        return np.column_stack((x, r * np.cos(phi), r * np.sin(phi)))

    return equilibrium(tube_mesh(LENGTH, nodes, surface), 0.0, 1.01, 1.25, -1.0, kind)


def by_superlu(function: Callable[[], object]) -> float:
    """CPU seconds of a call without the extra."""

    def missing(matrix: sparse.csc_matrix) -> object:
        raise ImportError

    known, factorization.by_pardiso = factorization.by_pardiso, missing  # type: ignore[assignment]
    try:
        return of_call(function)
    finally:
        factorization.by_pardiso = known


def measured(work: Callable[[MeshProblem, Array], object], nodes: int, limit: float, parts: int = 1) -> Row:
    """Times with the extra and without it; without it alone where it is not installed. Of work in parts, those of one."""
    problem, u = bulged(nodes, "subdivision")

    def call() -> object:
        return work(problem, u.copy())

    if find_spec("pymklpardiso") is None:
        return Row(f"{written(least(lambda: by_superlu(call) / parts, 3))} by SuperLU", limit=written(limit))
    ours, peer, ratio = paired(lambda: of_call(call) / parts, lambda: by_superlu(call) / parts, 3)
    return Row(f"{written(ours)} by PARDISO", f"SuperLU: {written(peer)}", ratio, written(limit))


@cache
def tangent(nodes: int) -> tuple[Array, Array]:
    """The bulged tube corrected, and the branch's direction there."""
    problem, u = bulged(nodes, "subdivision")
    found, direction = correct_at(problem, u, NewtonOptions())
    assert found.converged
    return found.u, direction / np.sqrt(problem.inner(direction, direction))


def three_steps(nodes: int) -> Row:
    """Newton's method from 0.05 along the tangent of the branch, from no factors: the mean of its steps."""

    def work(problem: MeshProblem, u: Array) -> None:
        at, direction = tangent(nodes)
        guess = at + 0.05 * direction
        found, _ = correct(replace(problem), guess, direction, guess, 0.0, NewtonOptions())
        assert (found.converged, found.iterations) == (True, 3)

    tangent(nodes)
    return measured(work, nodes, {12000: 0.5, 40000: 2.5}[nodes], parts=3)


STEP, RATES = (
    "Newton step on a mesh of {:,} vertices, mean of three",
    "six leading growth rates on a mesh of {:,} vertices",
)

row(STEP.format(12000))(lambda: three_steps(12000))
row(STEP.format(40000))(lambda: three_steps(40000))
row(RATES.format(12000))(lambda: measured(lambda problem, u: problem.modes(u), 12000, 1.5))


def main() -> None:
    """Print everything; with ``pearlbvp[fast]`` installed or without."""
    problem, u = straight(tube_mesh(LENGTH, 4000), 0.0, 0.3)
    print(f"refinement as a whole from 4,000 vertices: {of_call(lambda: _refined(problem, u)):.2f} s")
    for kind in ("subdivision", "cotangent"):
        convergence(kind)
        phases(kind)


def _refined(problem: object, u: Array) -> None:
    assert hasattr(problem, "remesh")
    assert replace(problem, adapt=AdaptOptions(area=1.0, largest=1e-4)).remesh(u) is not None  # type: ignore[type-var]


if __name__ == "__main__":
    main()
