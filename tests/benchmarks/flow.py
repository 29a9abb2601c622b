"""Times of flows, and the same flow by implicit Euler with fixed steps (the paper's method) and by scipy's BDF.

Run as ``python tests/benchmarks/flow.py``. All integrate one semi-discrete problem, an axisymmetric graph of 128 points. Implicit
Euler solves for shape and multipliers with the analytic Jacobian; for BDF the multipliers are eliminated from the right-hand
side (``c_q q_t = 0``), as an integrator of ordinary differential equations needs it.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import time
from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

import numpy as np
from rows import Row, of_call, paired, row, written
from scipy.integrate import solve_ivp
from scipy.sparse import issparse

from pearlbvp.arrays import Array
from pearlbvp.flows.axisymmetric import GraphFlow
from pearlbvp.flows.driver import FlowOptions, first_rates, flow
from pearlbvp.helfrich import Tube
from pearlbvp.mesh.families import tube_mesh
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.flow_start import pearl_start, tube_start
from pearlbvp.studies.mesh_flow import mesh_start, surface_start
from pearlbvp.studies.point import chosen

END = 1.0
"""Time at which the integrators are compared; the slowest mode has decayed by a factor of ten by then."""


def timed(function: Callable[[], Any], repeats: int = 3) -> tuple[float, Any]:
    """Shortest time of some calls in seconds, and the last result."""
    times = []
    for _ in range(repeats):
        begun = time.perf_counter()
        result = function()
        times.append(time.perf_counter() - begun)
    return min(times), result


def start_shape(problem: GraphFlow) -> Array:
    """A graph without symmetry, of amplitude 0.3."""
    k = 2 * np.pi * problem.x / problem.length
    return problem.coordinates(1 + 0.3 * np.cos(k) + 0.06 * np.cos(2 * k + 0.5) + 0.02 * np.sin(3 * k))


def implicit_euler(problem: Any, q: Array, steps: int, end: float = END) -> Array:
    """Fixed steps to a time, each by Newton's method to 1e-10."""
    kept, h = problem.constraints(q), end / steps
    multipliers = first_rates(problem, q)[1]
    size, k = len(q), len(kept)
    for _ in range(steps):
        old = q
        for _ in range(20):
            rate = (q - old) / h
            residual = np.concatenate((problem.residual(q, rate, multipliers), problem.constraints(q) - kept))
            matrix = np.zeros((size + k, size + k))
            inner = problem.jacobian(q, rate, multipliers, 1 / h)
            matrix[:size, :size] = inner.toarray() if issparse(inner) else inner
            matrix[:size, size:], matrix[size:, :size] = problem.columns(q), problem.constraint_rows(q)
            step = np.linalg.solve(matrix, residual)
            q, multipliers = q - step[:size], multipliers - step[size:]
            if np.abs(step[:size]).max() < 1e-10:
                break
    return q


def eliminated_bdf(problem: GraphFlow, q: Array, rtol: float) -> Any:
    """scipy's BDF to ``END``."""
    return solve_ivp(
        lambda t, y: first_rates(problem, y)[0], (0, END), q, method="BDF", rtol=rtol, atol=rtol / 100
    )  # fmt: skip


def compare() -> None:
    """Errors at ``END`` against time."""
    problem = GraphFlow(0.0, 10.0, 128)
    q = start_shape(problem)
    kept = problem.constraints(q)
    exact = flow(problem, q, FlowOptions(until=END, rtol=1e-10, atol=1e-13, max_steps=10**6)).state.q

    def line(name: str, seconds: float, found: Array, steps: int) -> None:
        drift = np.abs(problem.constraints(found) / kept - 1).max()
        error = np.abs(problem.radii(found) - problem.radii(exact)).max()
        print(f"  {name:34s} {seconds:8.3f} s {steps:6d} steps   error of r {error:8.1e}   drift {drift:8.1e}")

    print(f"one flow to t = {END:g}, 128 points")
    for rtol in (1e-5, 1e-6, 1e-7):
        options = FlowOptions(until=END, rtol=rtol, atol=rtol / 100)
        seconds, result = timed(lambda o=options: flow(problem, q, o))  # type: ignore[misc]
        line(f"IDA, rtol {rtol:.0e}", seconds, result.state.q, len(result.table()) - 1)
    for steps in (100, 1000, 10000):
        seconds, found = timed(lambda n=steps: implicit_euler(problem, q, n), 1)  # type: ignore[misc]
        line(f"implicit Euler, h = {END / steps:.0e}", seconds, found, steps)
    for rtol in (1e-5, 1e-7):
        seconds, solution = timed(lambda r=rtol: eliminated_bdf(problem, q, r), 1)  # type: ignore[misc]
        line(f"scipy BDF, eliminated, rtol {rtol:.0e}", seconds, solution.y[:, -1], solution.t.size - 1)


def to_rest() -> None:
    """Flows until the largest normal velocity is below 1e-6 on a stable shape."""
    print("flows to rest, |u_t| < 1e-6")

    def line(name: str, run: Callable[[], Any], repeats: int = 3) -> None:
        seconds, result = timed(run, repeats)
        table = result.table()
        drift = max(table["area_error"].abs().max(), table["volume_error"].abs().max())
        print(
            f"  {name:50s} {seconds:7.2f} s {len(table) - 1:5d} steps   t = {result.state.t:8.2f}   {result.status}"
            f"   drift {drift:.1e}   largest rise of E {result.largest_rise():.1e}"
        )

    problem = GraphFlow(0.0, 10.0, 128)
    line("axisymmetric, 128 points", lambda: flow(problem, start_shape(problem)), 5)
    a2 = chosen(family_branch(Tube(0, 10), "pearl", (1, 0), branch_options({"lambda2": -3.2})), "A2")
    start = pearl_start(a2.problem, a2.u)
    line("A2 with a bump of -0.125", lambda: start.flow(start.perturbed("bump", -0.125)))
    for length, m in ((15.0, 2), (30.0, 4)):
        point = family_branch(Tube(0.48, length), "pearl", (m, 0), branch_options({"v": 1.02})).points[-1]
        pearls = pearl_start(point.problem, point.u)
        q = pearls.perturbed("critical", 0.02, keep=True)
        line(f"c0 = 0.48, L = {length:g}, to the localized pearl", lambda s=pearls, q=q: s.flow(q))  # type: ignore[misc]
    point = family_branch(Tube(0.75, 10.0), "pearl", (1, 0), branch_options({"v": 1.03})).points[-1]
    pearls = pearl_start(point.problem, point.u)
    line("c0 = 0.75, to two unequal pearls", lambda: pearls.flow(pearls.perturbed("critical", 0.05, keep=True)))
    options = FlowOptions(resolution=1e-2)
    for c0, family, stop, kind, delta in (
        (0.0, "coil", {"lambda2": 1.387}, "bump", -0.25),
        (0.0, "buckle", {"lambda2": 1.29}, "critical", 0.3),
        (-1.0, "coil", {"v": 0.95}, "bump", -0.25),
        (-1.0, "buckle", {"v": 0.975}, "bump", -0.25),
    ):
        point = family_branch(Tube(c0, 10.0), family, (1, 1), branch_options(stop), discretization="modes").points[-1]  # type: ignore[arg-type]
        tube = tube_start(point.problem, point.u)
        q = tube.perturbed(kind, delta)  # type: ignore[arg-type]
        line(f"c0 = {c0:g}, {family}, {kind}, 12 x 12 modes", lambda s=tube, q=q: s.flow(q, options), 1)  # type: ignore[misc]


@row("flow of a graph of 128 points to t = 1, error below 1e-7")
def graph() -> Row:
    """IDA against scipy's BDF on the same equations, both at rtol 1e-7."""
    problem = GraphFlow(0.0, 10.0, 128)
    q = start_shape(problem)
    exact = flow(problem, q, FlowOptions(until=END, rtol=1e-10, atol=1e-13, max_steps=10**6)).state.q

    def ida() -> Array:
        return flow(problem, q, FlowOptions(until=END, rtol=1e-7, atol=1e-9)).state.q

    def bdf() -> Array:
        return eliminated_bdf(problem, q, 1e-7).y[:, -1]  # type: ignore[no-any-return]

    errors = [np.abs(problem.radii(found()) - problem.radii(exact)).max() for found in (ida, bdf)]
    ours, peer, ratio = paired(lambda: of_call(ida), lambda: of_call(bdf))
    return Row(
        f"{written(ours)}, error {errors[0]:.0e}",
        f"scipy's BDF: {written(peer)}, error {errors[1]:.0e}",
        ratio,
        written(0.15),
    )


@row("flow of A2 with a bump to rest, 4,042 vertices")
def a2_on_a_mesh() -> Row:
    """One run."""
    a2 = chosen(family_branch(Tube(0, 10), "pearl", (1, 0), branch_options({"lambda2": -3.2})), "A2")
    start = mesh_start(a2, 4000)
    seconds = of_call(lambda: start.flow(start.perturbed("bump", -0.125)))
    return Row(
        f"{written(seconds)} by {'SuperLU' if find_spec('pymklpardiso') is None else 'PARDISO'}", limit=written(30)
    )


def bulged(x: Array, phi: Array) -> Array:
    """A surface of revolution of amplitude 0.3."""
    r = 1 + 0.3 * np.cos(2 * np.pi * x / 10)
    return np.column_stack((x, r * np.cos(phi), r * np.sin(phi)))


def meshes() -> None:
    """Triangulated tubes: against implicit Euler on one mesh, and A2 with a bump to rest on 4,000 nodes."""
    problem, q = surface_start(0.0, tube_mesh(10.0, 300, bulged))
    end = 0.2
    exact = flow(problem, q, FlowOptions(until=end, rtol=1e-9, atol=1e-11)).state.q
    print(f"one flow to t = {end:g}, triangulated tube of {len(q)} nodes")
    for rtol in (1e-5, 1e-6):
        options = FlowOptions(until=end, rtol=rtol, atol=rtol / 100)
        seconds, result = timed(lambda o=options: flow(problem, q, o), 1)  # type: ignore[misc]
        error, steps = np.abs(result.state.q - exact).max(), len(result.table()) - 1
        print(f"  {f'IDA, rtol {rtol:.0e}':34s} {seconds:8.3f} s {steps:6d} steps   error {error:8.1e}")
    for steps in (20, 200):
        seconds, found = timed(lambda n=steps: implicit_euler(problem, q, n, end), 1)  # type: ignore[misc]
        error = np.abs(found - exact).max()
        print(
            f"  {f'implicit Euler, h = {end / steps:.0e}':34s} {seconds:8.3f} s {steps:6d} steps   error {error:8.1e}"
        )
    print("A2 with a bump of -0.125 on triangulated tubes, to rest")
    a2 = chosen(family_branch(Tube(0, 10), "pearl", (1, 0), branch_options({"lambda2": -3.2})), "A2")
    for kind in ("subdivision", "cotangent"):
        start = mesh_start(a2, 4000, kind=kind)  # type: ignore[arg-type]
        seconds, result = timed(lambda s=start: s.flow(s.perturbed("bump", -0.125)), 1)  # type: ignore[misc]
        table = result.table()
        late = table[(table["velocity"] < 2e-2) & (table["velocity"] > 3e-3)]  # before creeping is seen
        decay = np.polyfit(late["t"], np.log(late["velocity"]), 1)[0]
        drift = table[["area_error", "volume_error"]].abs().to_numpy().max()
        print(
            f"  {kind:12s} {len(result.state.q)} nodes {seconds / len(table):6.3f} s a step {len(table) - 1:5d} steps   "
            f"{result.status} at t = {result.state.t:.2f}   drift {drift:.1e}   rise of E {result.largest_rise():.1e}   "
            f"jump {result.largest_jump():.1e}   decay {decay:.4f}, growth rate {result.equilibrium.growth_rates[0]:.4f}"
        )


if __name__ == "__main__":
    compare()
    to_rest()
    meshes()
