"""Tubes as graphs ``r(x)``, a cosine series over one period: the way in for shapes on no known branch.

A local minimum of the energy at fixed area and volume is a stable shape (to perturbations of its own symmetry) wherever it
lies, so minimising from a guess reaches isolated branches too. What is found is handed to Newton's method on the
arclength problem, which shares nothing with it but the model.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.collocation import Discretization, gauss_scheme
from pearlbvp.collocation.polynomial import all_points
from pearlbvp.helfrich import Tube
from pearlbvp.newton import NewtonOptions, newton
from pearlbvp.shapes.cells import HALF_CELL
from pearlbvp.shapes.pearl import PearlProblem


def _series(amplitudes: Array, length: float, x: Array, derivative: int) -> Array:
    """``r``, ``r'``, ... of ``sum of a_k cos(2 pi k x / L)`` at ``x``."""
    k = 2 * np.pi * np.arange(len(amplitudes)) / length
    phase = np.outer(x, k) + derivative * np.pi / 2
    series: Array = np.cos(phase) @ (amplitudes * k**derivative)
    return series


def relaxed(tube: Tube, v: float, amplitudes: Array, modes: int = 24) -> tuple[Array, str]:
    """The graph of least bending energy at area ``2 pi L`` and reduced volume ``v`` that lies downhill from a guess.

    Sequential quadratic programming (scipy's SLSQP) with exact gradients.

    Args:
        tube: spontaneous curvature and period.
        v: reduced volume.
        amplitudes: the guess ``a_1, a_2, ...``: ``r = 1 + sum of a_k cos(2 pi k x / L)``.
        modes: terms of the series.

    Returns:
        ``a_0, a_1, ...`` and an empty text, or the last iterate and why it is no minimum.
    """
    from scipy.optimize import minimize  # a fifth of a second to import, and only this needs it

    points = 8 * modes
    x = (np.arange(points) + 0.5) * tube.length / points
    k = 2 * np.pi * np.arange(modes) / tube.length
    scale = 1 / (1 + k**2)  # bending energy grows like k^4: in these variables all modes are alike
    basis = [np.cos(np.outer(x, k) + d * np.pi / 2) * k**d * scale for d in range(3)]

    def measures(a: Array) -> tuple[Array, Array]:
        """``E/A``, area and volume (each 1 on the cylinder) and their gradients."""
        r, r1, r2 = (matrix @ a for matrix in basis)
        q = np.sqrt(1 + r1**2)
        bend = (1 / (r * q) - r2 / q**3) / 2 - tube.c0
        by_r = -bend / r + bend**2 * q
        by_r1 = bend * (-r1 / q**2 + 3 * r * r2 * r1 / q**4) + bend**2 * r * r1 / q
        by_r2 = -bend * r / q**2
        energy = by_r @ basis[0] + by_r1 @ basis[1] + by_r2 @ basis[2]
        area = q @ basis[0] + (r * r1 / q) @ basis[1]
        values = np.array([(bend**2 * r * q).mean(), (r * q).mean(), (r**2).mean()])
        return values, np.vstack((energy, area, 2 * r @ basis[0])) / points

    guess = np.zeros(modes)
    guess[0] = 1.0
    guess[1 : 1 + len(amplitudes)] = amplitudes[: modes - 1]
    guess /= scale
    constraint = {
        "type": "eq",
        "fun": lambda a: measures(a)[0][1:] - [1.0, v],
        "jac": lambda a: measures(a)[1][1:],
    }
    with np.errstate(all="ignore"):
        found = minimize(
            lambda a: measures(a)[0][0], guess, jac=lambda a: measures(a)[1][0], method="SLSQP", constraints=constraint,
            options={"maxiter": 1000, "ftol": 1e-14},
        )  # fmt: skip
        radius = basis[0] @ found.x
    if not found.success or not np.isfinite(radius).all() or radius.min() <= 0:
        return (
            scale * found.x,
            "no shape of least energy was reached; try other cosines or another volume",
        )
    return scale * found.x, ""


def pearl_of_graph(
    tube: Tube, v: float, amplitudes: Array, *, intervals: int = 24, degree: int = 6, tolerance: float = 1e-9
) -> tuple[PearlProblem, Array, str]:
    """The equilibrium near a graph, by Newton's method on the half cell at fixed volume.

    Args:
        tube: spontaneous curvature and period.
        v: reduced volume.
        amplitudes: ``a_0, a_1, ...`` of the graph.
        intervals, degree: of the mesh.
        tolerance: of the profile, for remeshing.

    Returns:
        Problem, unknown, and an empty text or why there is no equilibrium.
    """  # fmt: skip
    scheme, half = gauss_scheme(degree), tube.length / 2
    x = np.linspace(0, half, 40 * intervals + 1)
    stretch = np.sqrt(1 + _series(amplitudes, tube.length, x, 1) ** 2)
    s = np.concatenate(([0.0], np.cumsum((stretch[1:] + stretch[:-1]) / 2 * np.diff(x))))
    mesh = np.linspace(0, 1, intervals + 1)
    at = np.interp(all_points(mesh, scheme), s / s[-1], x)
    r, r1, r2, r3 = (_series(amplitudes, tube.length, at, d) for d in range(4))
    q = np.sqrt(1 + r1**2)
    h = (1 / (r * q) - r2 / q**3) / 2
    w = (-r1 / (r**2 * q) - r1 * r2 / (r * q**3) - r3 / q**3 + 3 * r1 * r2**2 / q**5) / 2 / q
    # The multipliers that fit best: G = 0 is linear in them (least squares over Lap H and the rest, from w' by x).
    gauss = -r2 / (r * q**4)
    laplacian = np.gradient(w, at, edge_order=2) / q + r1 / (r * q) * w
    rest = laplacian + 2 * h * (h**2 - gauss) + 2 * tube.c0 * gauss - 2 * tube.c0**2 * h
    lambda1, lambda2 = np.linalg.lstsq(np.column_stack((2 * h, np.ones_like(h))), rest, rcond=None)[0]
    parameters = np.array([s[-1], lambda1, lambda2, tube.c0, half, v])
    fixed = Discretization(HALF_CELL, scheme, mesh, parameters, ("arclength", "lambda1", "lambda2"))
    states = np.column_stack((r, np.arctan(r1), h, w))
    states[[0, -1], 1] = states[[0, -1], 3] = 0.0
    guess = fixed.pack(states, parameters)
    found = newton(fixed.residual, fixed.solve, guess, NewtonOptions(max_iterations=40, damping=12))
    free = replace(fixed, parameters=fixed.all_parameters(found.u), free=("arclength", "lambda1", "lambda2", "v"))
    problem = PearlProblem(free, None, tolerance)
    return problem, free.pack(fixed.values(found.u), free.parameters), found.message
