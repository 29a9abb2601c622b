"""Times and errors of rings, coils and buckles: ``OMP_NUM_THREADS=1 python tests/benchmarks/tubes.py``.

The peer of a Newton step is the same Hessian summed point by point with dense matrices (``tests/support/sums.py``).
"""

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from support.sums import Basis, grid, second_variation

from pearlbvp.continuation.path import correct
from pearlbvp.helfrich import Tube
from pearlbvp.newton import NewtonOptions
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.diagram import diagram
from pearlbvp.theory.elastica import ring_at


def milliseconds(call, repeats=10):
    """Least processor time of some calls."""
    times = []
    for _ in range(repeats):
        began = time.process_time()
        call()
        times.append(time.process_time() - began)
    return 1e3 * min(times)


def error_of_modes(point, size):
    """Change of lambda2 with more modes, at the same volume."""
    problem, u = on_modes(point, size)
    along_v = np.zeros(u.size)
    along_v[-1] = 1.0
    result, _ = correct(problem, u, along_v, u, 0.0, NewtonOptions())
    assert result.converged, result.message
    return result.u[-2] - point.u[-2]


def buckle_branch():
    """A branch that ``branch buckle --until v=0.85`` makes: with stability, and stopped exactly there."""
    return family_branch(Tube(0.0, 10), "buckle", (1, 1), branch_options({"v": 0.85}))


def on_modes(point, size):
    """A solution's problem on another number of modes, and its unknown there."""
    problem = point.problem.resized(size)
    return problem, problem.transfer(point.problem, point.u)


def newton_step(problem, u):
    """Residual and one bordered solve."""
    return problem.solve(u, np.append(problem.residual(u), 0.0), np.ones(u.size))


def main():
    ring = family_branch(Tube(0.0, 10), "ring", (0, 2), branch_options({"v": 0.85})).points[-1]
    exact = ring_at(2, "v", 0.85).lambda2
    print(
        f"ring  v = 0.85: error of lambda2 {ring.observables['lambda2'] - exact:.1e} against elliptic functions (1e-10)"
    )
    coils = family_branch(Tube(0.0, 10), "coil", (1, 1), branch_options({"v": 0.85}, max_step=0.1))
    last = coils.points[-1]
    error = error_of_modes(last, (0, 2 * last.problem.size[1]))
    print(f"coil  v = 0.85: error of lambda2 {error:.1e} against twice the modes (1e-10)")
    rhs = np.ones(last.u.size)
    residual, solve, spectrum = (
        milliseconds(call)
        for call in (
            lambda: last.problem.residual(last.u),
            lambda: last.problem.solve(last.u, rhs, last.tangent),
            lambda: last.problem.spectrum(last.u),
        )
    )
    print(
        f"coil  residual {residual:.2f} ms, solve {solve:.2f} ms, spectrum of all waves {spectrum:.1f} ms (a point: 10 ms)"
    )

    buckle = buckle_branch().points[-1]
    print(
        f"buckle v = 0.85: error of lambda2 {error_of_modes(buckle, (40, 40)):.1e} (1e-8), "
        f"rigid motions {buckle.spectrum.residual:.0e} (1e-7), modes {buckle.problem.size}"
    )
    print(f"buckle v = 0.85: the branch from the straight tube on {milliseconds(buckle_branch, 3):.0f} ms (1000 ms)")
    problem, u = on_modes(buckle, (48, 48))
    step, spectrum = (milliseconds(call, 3) for call in (lambda: newton_step(problem, u), lambda: problem.spectrum(u)))
    print(f"buckle 48 x 48: Newton step {step:.0f} ms (250 ms), spectrum in all blocks {spectrum:.0f} ms (1000 ms)")
    point = family_branch(Tube(0.0, 10), "buckle", (1, 1), branch_options({"v": 0.95})).points[-1]
    problem, u = on_modes(point, (12, 12))
    solve = milliseconds(lambda: newton_step(problem, u))
    spectrum = milliseconds(lambda: problem.spectrum(u), 4)
    print(f"buckle 12 x 12: solve {solve:.1f} ms (100 ms), spectrum in all blocks {spectrum:.0f} ms (1000 ms)")
    x, phi = grid(problem.cell.points, problem.length)
    basis = Basis.of(problem.modes, problem.k, 0.0, x, phi)
    fields = basis.state(u[:-3])
    peer = milliseconds(lambda: second_variation(basis, fields, 0.0, u[-3], u[-2]), 4)
    ours = milliseconds(lambda: problem.equilibrium(u).hessian(problem.waves))
    print(f"buckle 12 x 12: Hessian {ours:.1f} ms by waves, {peer:.1f} ms (with the mass) by sums over points")

    began = time.perf_counter()
    found = diagram(0.0, 10, 0, modes=[(1, 0), (1, 1), (0, 2)], processes=2)
    print(
        f"c0 = 0, L = 10: {len(found.branches)} branches with stability in {time.perf_counter() - began:.1f} s (60 s)"
    )


if __name__ == "__main__":
    main()
