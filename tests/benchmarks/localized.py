"""Time of the localized-pearl table and of a continuation point, beside scipy's ``solve_bvp`` and AUTO-07p.

Run as ``python tests/benchmarks/localized.py``. AUTO-07p is timed where its library is installed (Debian: ``auto-07p``,
with ``gfortran``), in the same run on the same machine.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import itertools
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.integrate import solve_bvp

from pearlbvp.continuation import PathOptions, Solution, follow
from pearlbvp.continuation.segment import Segment
from pearlbvp.helfrich import Tube
from pearlbvp.shapes import axisymmetric
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.shapes.pearling import pearling_onset
from pearlbvp.studies.localized import localized_pearls

AUTO = Path("/usr/lib/auto-07p")


def best(function: Callable[[], object], repeats: int = 15) -> float:
    """Shortest time of several calls, in seconds, after one that is not counted."""
    function()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return min(times)


def our_points(
    degree: int = 6, intervals: int = 8, count: int = 40, step: float = 0.02
) -> list[Solution[PearlProblem]]:
    """Follow the pearls of period 7.5 for some short steps without remeshing."""
    problem, u, tangent = pearling_onset(Tube(0.48, 7.5), degree=degree, intervals=intervals, tolerance=1.0)
    start = Solution(problem, u, tangent)
    options = PathOptions(step=step, max_step=step, max_points=count)
    return follow(start, options, lambda point: None).points


def our_point(degree: int, intervals: int) -> tuple[float, float]:
    """Seconds a continuation point, between the 40th and the 120th, and the error in ``lambda2`` of the 20th."""
    short, long = (best(lambda n=count: our_points(degree, intervals, n)) for count in (40, 120))  # type: ignore[misc]
    middle = our_points(degree, intervals)[20].observables
    return (long - short) / 80, abs(middle["lambda2"] - exact_lambda2(middle["v"]))


def exact_lambda2(v: float) -> float:
    """``lambda2`` of the pearl of period 7.5 at a volume, on 40 intervals of degree 7."""
    problem, u, tangent = pearling_onset(Tube(0.48, 7.5), degree=7, intervals=40, tolerance=1.0)
    start = Solution(problem, u, tangent)
    path = follow(start, PathOptions(), lambda point: "past" if point.observables["v"] > v else None)
    before, after = path.points[-2:]
    return (
        Segment(before, after)
        .root(lambda point: point.observables["v"] - v, before.observables["v"] - v)
        .observables["lambda2"]
    )


def scipy_point() -> None:
    """One pearl by ``solve_bvp``: the integrals as three more states, ``lambda1, arclength`` and ``v`` unknown."""
    k, a = np.pi / 3.75, 0.05
    lambda2 = -0.2502

    def parameters(p: np.ndarray) -> np.ndarray:
        return np.array([p[1], p[0], lambda2, 0.48, 3.75, p[2]])

    def rhs(t: np.ndarray, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        states = np.ascontiguousarray(y[:4].T)
        f = axisymmetric.rhs(t, states, parameters(p))
        return np.vstack((f.T, axisymmetric.constraints(t, states, parameters(p)).T))

    def ends(ya: np.ndarray, yb: np.ndarray, p: np.ndarray) -> np.ndarray:
        return np.array([ya[1], ya[3], yb[1], yb[3], *ya[4:], *yb[4:]])

    t = np.linspace(0, 1, 11)
    x, bend = 3.75 * t, (k**2 - 1) / 2
    wave = [
        1 + a * np.cos(k * x),
        -a * k * np.sin(k * x),
        0.5 + a * bend * np.cos(k * x),
        -a * bend * k * np.sin(k * x),
    ]
    guess = np.vstack((wave, np.zeros((3, len(t)))))
    solved = solve_bvp(rhs, ends, t, guess, p=[0.27, 3.75, 1.0], tol=1e-8, max_nodes=20000)
    if not solved.success:
        raise SystemExit(f"solve_bvp failed: {solved.message}")


def auto_seconds(folder: Path, points: int, degree: int, intervals: int, threads: int) -> float:
    """Wall time of AUTO-07p's executable for a number of points."""
    constants = (folder / "c.pearl").read_text().replace("NMX = 40", f"NMX = {points}")
    constants = constants.replace("NTST = 10", f"NTST = {intervals}").replace("NCOL = 4", f"NCOL = {degree}")
    (folder / "fort.2").write_text(constants)
    start = time.perf_counter()
    threaded = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    done = subprocess.run([folder / "pearl.exe"], cwd=folder, capture_output=True, text=True, check=False, env=threaded)
    if done.returncode or "MX" in done.stdout or "NaN" in done.stdout:
        raise SystemExit(f"AUTO-07p failed: {done.stdout}{done.stderr}")
    return time.perf_counter() - start


SHOWN = 1.5e-10
"""Error in ``lambda2`` below which the eleven digits of ``fort.8`` show none."""


def auto_point() -> dict[tuple[int, int], tuple[float, float, float]] | None:
    """Seconds a point of AUTO-07p on one thread and on two (start-up taken off), and its error in ``lambda2``.

    By degree and number of intervals; None where AUTO-07p is not installed. The error is that of the 20th point, from the
    eleven digits of ``fort.8``: ``fort.7`` has too few of ``v``.
    """
    if shutil.which("gfortran") is None or not AUTO.is_dir():
        return None
    here = Path(__file__).parent / "auto07p"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file in ("pearl.f90", "c.pearl"):
            shutil.copy(here / file, folder)
        objects = sorted(str(path) for path in (AUTO / "lib").glob("*.o"))
        compiler = [
            "gfortran",
            "-O3",
            "-fopenmp",
            "-fallow-argument-mismatch",
            "pearl.f90",
            *objects,
            "-o",
            "pearl.exe",
        ]
        subprocess.run(compiler, cwd=folder, check=True)
        result = {}
        for degree, intervals in itertools.product((4, 5, 6, 7), (5, 10, 20, 40)):
            seconds = []
            for threads in (1, 2):
                # Both runs of a pair in turn: what the machine does meanwhile is taken off with the start-up.
                pairs = [
                    [auto_seconds(folder, points, degree, intervals, threads) for points in (40, 440)] for _ in range(5)
                ]
                seconds.append(float(np.median([(long - short) / 400 for short, long in pairs])))
            auto_seconds(folder, 20, degree, intervals, 1)
            parameters = np.array(" ".join((folder / "fort.8").read_text().splitlines()[-6:]).split(), dtype=float)
            result[degree, intervals] = (*seconds, abs(parameters[0] - exact_lambda2(parameters[3])))
        return result


def main() -> None:
    """Print the table of times."""
    print(
        f"paper's table, warm process          {1e3 * best(lambda: localized_pearls(0.48, 7.5, [15, 30, 45, 60])):8.1f} ms"
    )
    many = [7.5 * n for n in range(2, 202)]
    print(f"the same for 200 lengths             {1e3 * best(lambda: localized_pearls(0.48, 7.5, many)):8.1f} ms")
    print(f"L = 600, period 600/81               {1e3 * best(lambda: localized_pearls(0.48, 600 / 81, [600])):8.1f} ms")
    print(f"scipy.solve_bvp, one point           {1e3 * best(scipy_point, 5):8.1f} ms")
    print("continuation point                            ms   error in lambda2   AUTO-07p's time / ours at that error")
    auto = auto_point()
    for degree, intervals in ((4, 6), (5, 4), (5, 6), (6, 3), (6, 4), (6, 6), (7, 4)):
        seconds, error = our_point(degree, intervals)
        ratio = "AUTO-07p is not installed here"
        if auto is not None:
            as_good = [times for *times, other in auto.values() if other <= max(error, SHOWN)]
            ratio = "no setting of AUTO-07p has shown so small an error"
            if as_good:  # the fastest setting that is at least as accurate, as far as its digits tell
                one, two = np.min(as_good, axis=0)
                ratio = f"{one / seconds:.2f} on one thread, {two / seconds:.2f} on two"
                ratio += " (for what its digits show)" if error < SHOWN else ""
        print(
            f"{intervals} intervals of degree {degree}            {1e3 * seconds:11.3f}            {error:.0e}   {ratio}"
        )
    for (degree, intervals), (one, two, error) in (auto or {}).items():
        shown = f"{error:.0e}" if error > SHOWN else f"below {SHOWN:.0e}"
        print(
            f"AUTO-07p, NCOL = {degree}, NTST = {intervals:<3d} {1e3 * one:8.3f} (two threads {1e3 * two:.3f})   {shown}"
        )
    command = [
        sys.executable,
        "-m",
        "pearlbvp",
        "localized",
        "--c0",
        "0.48",
        "--period",
        "7.5",
        "--lengths",
        "15,30,45,60",
    ]
    with tempfile.TemporaryDirectory() as name:
        command += ["--out", f"{name}/t.csv", "--plot", f"{name}/t.png"]
        print(f"whole command with CSV and PNG       {best(lambda: subprocess.run(command, check=True), 7):8.2f} s")


if __name__ == "__main__":
    main()
