"""Times and errors of coils and buckles.

The peer of a Hessian is the same one summed point by point with dense matrices (``tests/support/sums.py``).
"""

import sys
from functools import cache
from pathlib import Path

import numpy as np
from rows import Row, least, of_call, paired, row, written

sys.path.insert(0, str(Path(__file__).parents[1]))
from support.sums import Basis, grid, second_variation

from pearlbvp.continuation.path import correct
from pearlbvp.helfrich import Tube
from pearlbvp.newton import NewtonOptions
from pearlbvp.studies.branch import branch_options, family_branch


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


def seconds(call, repeats=7):
    """Least CPU time of some calls."""
    return least(lambda: of_call(call), repeats)


@row("coil at v = 0.85: residual, solve and spectrum of all waves")
def coil():
    """A point of a branch; its error against twice the modes."""
    last = family_branch(Tube(0.0, 10), "coil", (1, 1), branch_options({"v": 0.85}, max_step=0.1)).points[-1]
    error = error_of_modes(last, (0, 2 * last.problem.size[1]))
    rhs = np.ones(last.u.size)
    spent = seconds(
        lambda: (
            last.problem.residual(last.u),
            last.problem.solve(last.u, rhs, last.tangent),
            last.problem.spectrum(last.u),
        )
    )
    return Row(f"{written(spent)}, error {abs(error):.0e}", limit=written(0.01))


@row("buckles from the straight tube to v = 0.85, with stability")
def buckles():
    """A branch; its error against 40 x 40 modes."""
    error = error_of_modes(buckle_branch().points[-1], (40, 40))
    return Row(f"{written(seconds(buckle_branch, 3))}, error {abs(error):.0e}", limit=written(1.0))


@cache
def buckle(size):
    """A buckle at v = 0.95 on a number of modes."""
    return on_modes(family_branch(Tube(0.0, 10), "buckle", (1, 1), branch_options({"v": 0.95})).points[-1], size)


@row("Newton step of a buckle, 48 x 48 modes")
def step():
    """Residual and one bordered solve."""
    problem, u = buckle((48, 48))
    return Row(written(seconds(lambda: newton_step(problem, u), 3)), limit=written(0.25))


@row("spectrum of a buckle in all blocks, 48 x 48 modes")
def spectrum():
    """All symmetry blocks."""
    problem, u = buckle((48, 48))
    return Row(written(seconds(lambda: problem.spectrum(u), 3)), limit=written(1.0))


@row("Hessian of a buckle, 12 x 12 modes")
def hessian():
    """By waves, and with the mass by sums over points."""
    problem, u = buckle((12, 12))
    x, phi = grid(problem.cell.points, problem.length)
    basis = Basis.of(problem.modes, problem.k, 0.0, x, phi)
    fields = basis.state(u[:-3])
    ours, peer, ratio = paired(
        lambda: of_call(lambda: problem.equilibrium(u).hessian(problem.waves)),
        lambda: of_call(lambda: second_variation(basis, fields, 0.0, u[-3], u[-2])),
    )
    return Row(written(ours), f"dense sums over points: {written(peer)}", ratio)
