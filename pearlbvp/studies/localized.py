"""Where do periodic pearls give way to one localized pearl? Branch points for all lengths from one continuation.

Pearls of period ``l`` on a tube of ``N`` periods lose stability where a Bloch wave ``theta = 2 pi j / N`` becomes
neutral; ``j = 1`` is the branch point of the localized pearl (paper, eq. (ptt1)). The neutral angle ``theta`` is a function
along the branch that knows nothing of ``N``: it is resolved once, and each ``N`` is a root of a polynomial (design, §5).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from pearlbvp.collocation.scheme import Array
from pearlbvp.continuation import Path, PathOptions, Point, follow
from pearlbvp.continuation.chebyshev import PathFunctions, Unresolved, resolve
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, positive
from pearlbvp.shapes.pearl import PearlProblem, pearling_onset
from pearlbvp.stability.floquet import neutral_cosines
from pearlbvp.theory.dispersion import stable_interval

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ["c0", "period", "L", "pearls", "status", "lambda1", "lambda2", "v", "E", "amplitude", "message"]
THINNEST_NECK = 0.1
"""Radius of the neck at which the search along the pearls ends."""

_FUNCTIONS = ("lambda1", "lambda2", "v", "E", "amplitude_squared", "cosine")
_V, _COSINE = _FUNCTIONS.index("v"), _FUNCTIONS.index("cosine")


def _functions(problem: PearlProblem, u: Array) -> Array:
    """The smooth functions of a solution, in the order of ``_FUNCTIONS``.

    The amplitude is half the belly's radius minus the neck's, which changes sign at onset: its square is smooth.
    """
    observed = problem.observables(u)
    radii = problem.discretization.values(u)[[0, -1], 0]
    cosine = neutral_cosines(problem.profile(u), 0)[1].real
    return np.array([*(observed[name] for name in _FUNCTIONS[:4]), ((radii[0] - radii[1]) / 2) ** 2, cosine])


def _non_axisymmetric_wave(point: Point[PearlProblem]) -> int | None:
    """The smallest ``n`` of 1, 2 with a neutral Bloch wave at a point of the path, if any."""
    for n in (1, 2):
        cosines = neutral_cosines(point.problem.profile(point.u), n)
        others = cosines[1:] if n == 1 else cosines
        if (np.abs(others.imag) > 1e-9 * np.abs(others)).any() or (np.abs(others.real) <= 2).any():
            return n
    return None


@dataclass(frozen=True)
class PeriodicPearls:
    """The pearls of one period, from onset to where the search ended, with their functions resolved.

    Attributes:
        c0, period: the case.
        path: the computed points, half a pearl each.
        functions: ``lambda1, lambda2, v, E``, the squared amplitude and ``2 cos(theta)`` along the path.
        others: index of the first point with a neutral wave of ``n = 1`` or 2, and that ``n``; None if there is none.
    """

    c0: float
    period: float
    path: Path[PearlProblem]
    functions: PathFunctions
    others: tuple[int, int] | None

    @classmethod
    def trace(cls, c0: float, period: float, fewest: int = 2, *, intervals: int = 8, degree: int = 6) -> PeriodicPearls:
        """Follow the pearls of a period until those on ``fewest`` periods, and all longer tubes, have lost stability.

        Args:
            c0: spontaneous curvature.
            period: axial period of one pearl, above ``2 pi``.
            fewest: smallest number of periods, 2 or more, that an answer is wanted for.
            intervals: of the first mesh on half a pearl; it adapts.
            degree: Gauss points an interval.

        Raises:
            InputError: an argument that cannot be used.
            Unresolved: the functions along the path could not be resolved.
        """
        tube = Tube(c0, check_period(period))
        goal = 2 * math.cos(2 * math.pi / fewest)
        problem, u, tangent = pearling_onset(tube, intervals=intervals, degree=degree)

        def stop(point: Point[PearlProblem]) -> str | None:
            if neutral_cosines(point.problem.profile(point.u), 0)[1].real < goal:
                return "unstable"
            return "neck" if point.observables["r_min"] < THINNEST_NECK else None

        start = Point(problem, u, tangent, problem.observables(u))
        path = follow(start, PathOptions(step=0.1), stop)
        if len(path.points) == 1:
            raise Unresolved(f"the pearls could not be followed from their onset: {path.reason}")
        functions = resolve(path.points, _functions, pitchfork=True)
        waves = ((i, _non_axisymmetric_wave(point)) for i, point in enumerate(path.points))
        others = next(((i, n) for i, n in waves if n is not None), None)
        return cls(tube.c0, tube.length, path, functions, others)

    def neutral_angle(self, x: Array) -> Array:
        """Angle of the neutral Bloch wave at ``x``, from 0 to pi; 0 or pi where there is none."""
        return np.arccos(np.clip(self.functions(x)[:, _COSINE] / 2, -1, 1))

    @cached_property
    def _sampled_angle(self) -> tuple[Array, Array]:
        x = np.linspace(0, len(self.functions.coefficients), 1001)
        return x, self.neutral_angle(x)

    @cached_property
    def _folds(self) -> Array:
        return self.functions.crossings(_V, derivative=1)

    def loss_of_stability(self, pearls: int) -> tuple[float, int] | None:
        """Where pearls on ``pearls`` periods first meet a neutral wave that fits: coordinate ``x`` and its number ``j``."""
        x, angle = self._sampled_angle
        below = np.floor(angle * pearls / (2 * math.pi) + 1e-12).astype(int)
        changed = np.flatnonzero(below != below[0])
        if changed.size == 0:
            return None
        left, right = x[changed[0] - 1], x[changed[0]]
        j = max(below[changed[0] - 1], below[changed[0]])
        roots = self.functions.crossings(_COSINE, 2 * math.cos(2 * math.pi * j / pearls))
        inside = roots[(roots >= left - 1e-12) & (roots <= right + 1e-12)]
        return (float(inside[0]), int(j)) if inside.size else None

    def row(self, pearls: int) -> dict[str, object]:
        """``status``, ``message`` and the values at the localized pearl's branch point on ``pearls`` periods."""
        found = self.loss_of_stability(pearls)
        x = math.inf if found is None else found[0]
        if (self._folds < x).any():
            v = float(self.functions(self._folds[:1])[0, _V])
            return _no(f"the pearls lose stability at a fold in v = {v:.6g} before any localized pearl branches off")
        if self.others is not None and (found is None or self._before(x, self.others[0])):
            n = self.others[1]
            return _no(f"the pearls lose stability to a wave of n = {n} before any localized pearl branches off")
        if found is None:
            if not self.path.complete:
                return {
                    "status": "failed",
                    "message": f"the pearls could not be followed far enough: {self.path.reason}",
                }
            return _no(f"the pearls stay stable until their necks are thinner than {THINNEST_NECK}")
        if found[1] != 1:
            return _no(
                f"the pearls lose stability to a wave of {found[1]} periods on the tube, not to one localized pearl"
            )
        values = dict(zip(_FUNCTIONS, map(float, self.functions(np.array([x]))[0]), strict=True))
        values["amplitude"] = math.sqrt(values["amplitude_squared"])
        return {"status": "found", **{name: values[name] for name in COLUMNS[5:10]}, "message": ""}

    def _before(self, x: float, index: int) -> bool:
        """Whether the path's point ``index``, or the stretch that leads up to it, lies before ``x``."""
        reached = self.path.points[max(index - 1, 0)].observables["v"]
        return bool(float(self.functions(np.array([x]))[0, _V]) > reached)


def _no(message: str) -> dict[str, object]:
    return {"status": "none_in_range", "message": message}


def check_period(period: float) -> float:
    """A pearl period as a float.

    Raises:
        InputError: it is at or below ``2 pi``, where the straight tube has no lower pearling boundary.
    """
    period = positive("period", period)
    if period <= 2 * math.pi:
        raise InputError(
            f"period: {period:g} is not above 2 pi = 6.283 radii (k >= 1), and such pearls end no stable interval "
            "from below; take a longer period"
        )
    return period


def onset_status(tube: Tube, pearls: int) -> dict[str, object] | None:
    """What keeps ``pearls`` pearls from being stable at their onset on a tube: status and message, or None."""
    interval = stable_interval(tube)
    if not interval.exists:
        message = "the straight tube of this length is stable for no lambda2"
        return {"status": "no_stable_cylinder", "message": message}
    if interval.lower_mode != (pearls, 0):
        first = "none" if interval.lower_mode is None else f"{interval.lower_mode[0]} pearls"
        return {
            "status": "unstable_at_onset",
            "message": f"the straight tube is unstable there already (first: {first})",
        }
    return None


def localized_pearls(c0: float, period: float, lengths: Iterable[float]) -> pd.DataFrame:
    """Branch points of the localized pearl from the pearls of a period, on tubes of several lengths.

    One continuation serves all lengths, so 200 lengths cost what 4 cost, and a long tube what a short one costs.

    Args:
        c0: spontaneous curvature.
        period: axial period of the pearls, in radii of the straight tube.
        lengths: tube lengths, multiples of the period.

    Returns:
        A row a length, in the order given: ``c0, period, L, pearls, status, lambda1, lambda2, v, E, amplitude,
        message``. ``status`` is ``found``, ``unstable_at_onset``, ``none_in_range``, ``no_stable_cylinder`` or
        ``failed``; ``E`` is the energy by area, ``amplitude`` half the belly's radius minus the neck's.

    Raises:
        InputError: an argument that cannot be used; a length that is no multiple of the period.
    """
    import pandas as pd  # a quarter of a second, in which the command line lets another process find the rows

    return pd.DataFrame(localized_rows(c0, period, list(lengths)), columns=COLUMNS)


def localized_rows(c0: float, period: float, lengths: list[float]) -> list[dict[str, object]]:
    """The rows of ``localized_pearls``."""
    period = check_period(period)
    cases = []
    for length in lengths:
        tube = Tube(c0, length)
        pearls = round(tube.length / period)
        if pearls < 1 or abs(tube.length - pearls * period) > 1e-9 * tube.length:
            near = max(pearls, 1) * period
            raise InputError(f"lengths: {length:g} is no multiple of the period {period:g}; the nearest is {near:.12g}")
        cases.append((tube, pearls, onset_status(tube, pearls)))
    if not cases:
        raise InputError("lengths: the list is empty; give at least one length")
    wanted = [pearls for _, pearls, status in cases if status is None and pearls > 1]
    failure, curve = "", None
    if wanted:
        try:
            curve = PeriodicPearls.trace(c0, period, min(wanted))
        except (Unresolved, np.linalg.LinAlgError) as error:
            failure = str(error)
    rows = []
    for tube, pearls, status in cases:
        if status is None and pearls == 1:
            status = _no("one pearl fills the tube: there are no others for it to stand out from")
        elif status is None:
            status = curve.row(pearls) if curve is not None else {"status": "failed", "message": failure}
        row = {"c0": tube.c0, "period": period, "L": tube.length, "pearls": pearls, **status}
        rows.append({name: row.get(name, math.nan) for name in COLUMNS})
    return rows
