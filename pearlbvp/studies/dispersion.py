"""When does the straight tube lose stability, and to which mode? All branch points of a tube, as a table."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, cylinder_force, cylinder_lambda1, finite, positive, whole
from pearlbvp.theory.dispersion import critical_lambda2, mode_type, stable_interval

COLUMNS = ["m", "n", "k", "type", "lambda2", "lambda1", "kernel", "role", "force"]

MOST_ROWS = 1_000_000


def branch_points(c0: float, length: float, max_m: int | None = None, max_n: int = 4) -> pd.DataFrame:
    """Every branch point of the straight tube with ``m <= max_m`` waves along it and ``n <= max_n`` around it.

    Args:
        c0: spontaneous curvature.
        length: axial period, in radii.
        max_m: by default all pearls with ``k < 1`` and two more; modes that end the stable interval are always there.
        max_n: largest azimuthal number.

    Returns:
        A row a branch point, by increasing ``lambda2``: ``m, n, k, type, lambda2, lambda1, kernel, role, force``. ``kernel`` is
        the dimension of the kernel without the two translations: 2 for ``(m, 0)`` and ``(0, n)``, 4 for ``(m, n)``,
        summed over modes that meet at the same ``lambda2``. ``role`` is ``lower`` or ``upper`` where the point ends the
        interval in which the tube is stable. ``force`` is the axial one, at coiling and buckling Euler's: ``-pi k^2/2``.

    Raises:
        InputError: an argument that cannot be used.
    """
    tube = Tube(c0, length)
    if max_m is None:
        max_m = math.ceil(tube.length / (2 * math.pi)) + 1
    max_m, max_n = whole("max_m", max_m, 0), whole("max_n", max_n, 0)
    if (max_m + 1) * (max_n + 1) > MOST_ROWS:
        raise InputError(
            "max_m", f"{(max_m + 1) * (max_n + 1)} branch points are too many to list", "give a smaller max_m"
        )
    interval = stable_interval(tube)
    roles = {interval.upper_mode: "upper"} | ({interval.lower_mode: "lower"} if interval.lower_mode else {})
    modes = {(m, n) for m in range(max_m + 1) for n in range(max_n + 1)} | set(roles)
    rows = []
    for m, n in sorted(modes - {(0, 0), (0, 1)}):
        k = tube.wave_number(m)
        lambda2 = float(critical_lambda2(k, n, tube.c0))
        if math.isfinite(lambda2):
            kernel = 4 if m and n else 2
            role = roles.get((m, n), "") if interval.exists else ""
            straight = cylinder_lambda1(lambda2, tube.c0), kernel, role, cylinder_force(lambda2, tube.c0)
            rows.append((m, n, k, mode_type(m, n), lambda2, *straight))
    table = pd.DataFrame(rows, columns=COLUMNS).sort_values(["lambda2", "m", "n"], ignore_index=True)
    # Modes that meet at one lambda2 share its kernel.
    apart = np.diff(table["lambda2"], prepend=-np.inf) > 1e-10 * (1 + table["lambda2"].abs())
    table["kernel"] = table.groupby(apart.cumsum())["kernel"].transform("sum")
    return table


def instability_curves(c0: float, k_max: float, max_n: int = 4, points: int = 800) -> pd.DataFrame:
    """Critical ``lambda2`` over the wave number, as if any ``k`` fitted the tube (the paper's Fig. neigs).

    Returns:
        Columns ``n, k, lambda2``, ``points`` rows for each ``n`` from 0 to ``max_n``.

    Raises:
        InputError: an argument that cannot be used.
    """
    c0, k_max, max_n, points = (
        finite("c0", c0),
        positive("k_max", k_max),
        whole("max_n", max_n, 0),
        whole("points", points, 2),
    )
    k = np.linspace(0.004, k_max, points)
    curves = [pd.DataFrame({"n": n, "k": k, "lambda2": critical_lambda2(k, n, c0)}) for n in range(max_n + 1)]
    return pd.concat(curves, ignore_index=True)
