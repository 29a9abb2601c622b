"""Triangulated tubes: CPU time of a Newton step and of the leading rates, memory, convergence on families of meshes.

Run as ``python tests/benchmarks/mesh.py``.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import resource
import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from scipy import sparse

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError
from pearlbvp.factorization import factorized
from pearlbvp.helfrich import Tube
from pearlbvp.mesh.adaptation import AdaptOptions, smoothed
from pearlbvp.mesh.families import edited, graded, jittered, straightened, tube_mesh
from pearlbvp.mesh.functional import Kind
from pearlbvp.mesh.operators import mean_curvature
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.start import branch_point, equilibrium, straight
from pearlbvp.mesh.subdivision import subdivided
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.mesh import meshed
from pearlbvp.theory.dispersion import critical_lambda2

LENGTH = 10.0

SIZES = (1000, 3000)
"""Numbers of vertices for orders of convergence."""


def best(function: Callable[[], object], repeats: int = 3) -> float:
    """Shortest CPU time of several calls, in seconds, after one that is not counted."""
    function()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        function()
        times.append(time.process_time() - start)
    return min(times)


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


def pearl(nodes: int, kind: Kind) -> tuple[float, float]:
    """Seconds of a Newton step and of the six leading rates on a bulged tube."""
    k = 2 * np.pi / LENGTH

    def surface(x: Array, phi: Array) -> Array:
        r = 1 + 0.2 * np.cos(k * x)
        return np.column_stack((x, r * np.cos(phi), r * np.sin(phi)))

    problem, u = equilibrium(tube_mesh(LENGTH, nodes, surface), 0.0, 1.01, 1.25, -1.0, kind)
    rhs = np.ones((u.size, 2))
    row = np.ones(u.size)
    return best(lambda: (problem.residual(u), problem.solve(u, rhs, row))), best(lambda: problem.modes(u))


def main() -> None:
    """Print everything; with ``pearlbvp[fast]`` installed or without."""
    print("factorized by", type(factorized(sparse.eye(2, format="csc"))).__name__, "(LDL is PARDISO, LU is SuperLU)")
    for kind in ("subdivision", "cotangent"):
        for nodes in (1000, 4000, 12000, 40000):
            step, rates = pearl(nodes, kind)
            memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
            print(f"{kind:12s} {nodes:6d} vertices: Newton step {step:.2f} s, six leading rates {rates:.2f} s; "
                  f"at most {memory:.2f} GiB so far", flush=True)  # fmt: skip
    problem, u = straight(tube_mesh(LENGTH, 4000), 0.0, 0.3)
    print(f"refinement as a whole from 4,000 vertices: {best(lambda: _refined(problem, u), 1):.2f} s")
    for kind in ("subdivision", "cotangent"):
        convergence(kind)
        phases(kind)


def _refined(problem: object, u: Array) -> None:
    assert hasattr(problem, "remesh")
    assert replace(problem, adapt=AdaptOptions(area=1.0, largest=1e-4)).remesh(u) is not None  # type: ignore[type-var]


if __name__ == "__main__":
    main()
