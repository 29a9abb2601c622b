"""Where do periodic pearls give way to one localized pearl? Branch points for all lengths from one continuation.

Pearls of period ``l`` on a tube of ``N`` periods lose stability where a Bloch wave ``theta = 2 pi j / N`` becomes
neutral; ``j = 1`` is the branch point of the localized pearl (paper, eq. (ptt1)). The neutral angle ``theta`` is a function
along the branch that knows nothing of ``N``: it is resolved once, and each ``N`` is a root of a polynomial
(``docs/theory/stability.md``).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation import Path, PathOptions, Solution, follow
from pearlbvp.continuation.chebyshev import PathFunctions, Unresolved, resolve
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, finite, positive, whole
from pearlbvp.numbers import as_numbers
from pearlbvp.representation import brief
from pearlbvp.shapes.pearl import PearlProblem
from pearlbvp.shapes.pearling import pearling_onset
from pearlbvp.stability.floquet import alternating_determinants, multipliers
from pearlbvp.stability.spectrum import spectrum
from pearlbvp.studies.stability_loss import THINNEST_NECK, Ending, LocalizedPearl, Outcome, at_onset
from pearlbvp.theory.dispersion import stable_intervals
from pearlbvp.units import Sentence

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ["c0", "period", "L", "pearls", "status", "lambda1", "lambda2", "v", "E", "amplitude", "message"]

FUNCTIONS = ("lambda1", "lambda2", "v", "E", "amplitude_squared", "sum", "cosine")
V, SQUARE, SUM, COSINE = (FUNCTIONS.index(name) for name in ("v", "amplitude_squared", "sum", "cosine"))

PROFILES = 1e-8
"""Of the profiles, for remeshing; the functions' errors, of twice the order, are below 1e-12 then."""


def functions_of(problem: PearlProblem, u: Array) -> Array:
    """The smooth functions of a solution, in the order of ``FUNCTIONS``: even where pearls shift by half a period.

    The amplitude is half the belly's radius minus the neck's, which changes sign then: its square is even. The two
    alternating determinants change places: their sum and product are even, ``2 cos(theta) = 4 product - 2``.
    """
    observed = problem.observables(u)
    even, odd = alternating_determinants(*problem.discretization.transfer_pencil(u))
    squared = (problem.signed_amplitude(u) / 2) ** 2
    return np.array([*(observed[name] for name in FUNCTIONS[:4]), squared, even + odd, 4 * even * odd - 2])


def has_wave_around(point: Solution[PearlProblem]) -> bool:
    """Whether a point has a neutral Bloch wave of ``n = 1`` or 2 at all, whether or not it fits a tube."""
    once, twice = multipliers(point.problem.profile(point.u), [1, 2])
    others = once[np.argsort(np.abs(once - 1))][2:]  # without the translations across the axis
    return bool((np.abs(np.abs([*others, *twice]) - 1) < 1e-6).any())


@dataclass(frozen=True)
class PeriodicPearls:
    """The pearls of one period, from onset to where the search ended, with their functions resolved.

    Attributes:
        c0, period: the case.
        fewest: smallest number of periods for which the search went far enough.
        path: the computed points, half a pearl each.
        functions: ``lambda1, lambda2, v, E``, the squared amplitude, the sum of ``alternating_determinants`` and
            ``2 cos(theta)`` along the path.
    """

    __repr__ = brief

    c0: float
    period: float
    fewest: int
    path: Path[PearlProblem]
    functions: PathFunctions

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

        Examples:
            >>> pearls = PeriodicPearls.trace(c0=0.48, period=7.5)
            >>> round(pearls.row(4)["v"], 6)  # on four periods they lose stability there
            1.006228
        """
        tube = Tube(c0, check_period(period))
        check_pearls(fewest, 2)
        goal = 2 * math.cos(2 * math.pi / fewest)
        problem, u, tangent = pearling_onset(tube, intervals=intervals, degree=degree, tolerance=PROFILES)
        values = [functions_of(problem, u)]

        def left(found: Array) -> Array:
            """Negative beyond where pearls on ``fewest`` periods lose stability."""
            return np.minimum(found[..., COSINE] - goal, found[..., SUM] * math.copysign(1.0, values[0][SUM]))

        def stop(point: Solution[PearlProblem]) -> str | None:
            values.append(functions_of(point.problem, point.u))
            if left(values[-1]) < 0:
                return "unstable"
            return "neck" if point.observables["r_min"] < THINNEST_NECK else None

        path = follow(Solution(problem, u, tangent), PathOptions(step=0.05), stop)
        if len(path.points) == 1:
            raise Unresolved(
                f"the pearls could not be followed from their onset ({path.reason}); take a period further from 2 pi"
            )
        functions = resolve(path.points, functions_of, values=values, pitchfork=True, until=left)
        return cls(tube.c0, tube.length, fewest, path, functions)

    def neutral_angle(self, x: Array) -> Array:
        """Angle of the neutral Bloch wave at ``x``, from 0 to pi; 0 or pi where there is none."""
        return np.arccos(np.clip(self.functions(x)[:, COSINE] / 2, -1, 1))

    def table(self, samples: int = 400) -> pd.DataFrame:
        """The pearls from onset to where the search ended: ``lambda1, lambda2, v, E, amplitude, theta``.

        Args:
            samples: rows, at equal distances of the functions' coordinate.

        Returns:
            ``theta`` is the angle of the neutral Bloch wave, from 0 to pi; waves of a smaller one grow.

        Raises:
            InputError: no whole number of samples.

        Examples:
            >>> curve = PeriodicPearls.trace(c0=0.48, period=7.5).table(50)
            >>> bool(curve.theta.is_monotonic_increasing), len(curve)
            (True, 50)
        """
        import pandas as pd

        x = np.linspace(0, len(self.functions.coefficients), whole("samples", samples, 2))
        table = pd.DataFrame(self.functions(x)[:, :SQUARE], columns=list(FUNCTIONS[:SQUARE]))
        amplitude = np.sqrt(np.maximum(self.functions(x)[:, SQUARE], 0))
        return table.assign(amplitude=amplitude, theta=self.neutral_angle(x))

    @cached_property
    def _folds(self) -> Array:
        return self.functions.crossings(V, derivative=1)

    def _waves_around(self, v_end: float) -> list[Solution[PearlProblem]]:
        """The path's points before a volume with a neutral wave of ``n = 1`` or 2; onset is none."""
        before = (point for point in self.path.points[1:] if point.observables["v"] < v_end)
        return [point for point in before if has_wave_around(point)]

    def losses_of_stability(self, pearls: Sequence[int]) -> Array:
        """Coordinates ``x``, shape (K,), at which pearls on so many periods lose stability to one localized pearl.

        Waves with an angle from 0 to ``theta`` grow. Pearls that are stable at onset have ``theta <= 2 pi / N`` there,
        so the first wave to grow is that with ``j = 1``, where ``theta`` reaches it for the first time. Not a number where
        it never does.
        """
        levels = 2 * np.cos(2 * np.pi / np.array(pearls))
        found = self.functions.first_crossings(COSINE, levels)
        found[self.functions(np.zeros(1))[0, COSINE] <= levels + 1e-12] = 0.0  # to its accuracy
        if 2 in pearls:
            # Where theta passes pi the cosine may do no more than touch -2. The sum of its two factors has a simple
            # zero there, at which their product is negative: the first zero of the product lies before.
            touched = [self._first_alternating(float(x)) for x in self.functions.crossings(SUM)]
            two = np.array(pearls) == 2
            found[two] = np.fmin(found[two], min(touched, default=math.nan))
        return found

    def _first_alternating(self, x: float) -> float:
        """The zero of ``2 cos(theta) + 2`` before a zero ``x`` of the sum of its factors, by bisection."""
        low, high = 0.0, x
        for _ in range(52):
            middle = (low + high) / 2
            if self.functions(np.array([middle]))[0, COSINE] > -2:
                low = middle
            else:
                high = middle
        return high

    def row(self, pearls: int) -> dict[str, object]:
        """``status``, ``message`` and the values at the localized pearl's branch point on ``pearls`` periods.

        Raises:
            InputError: the path was not followed far enough for so few periods.
        """
        return self.rows([pearls])[0]

    def rows(self, pearls: Sequence[int]) -> list[dict[str, object]]:
        """The same on several numbers of periods."""
        return [outcome.row() for outcome in self.outcomes(pearls)]

    def outcomes(self, pearls: Sequence[int]) -> list[Outcome]:
        """How the pearls on several numbers of periods lose stability.

        Raises:
            InputError: the path was not followed far enough for so few periods.
        """
        for count in pearls:
            check_pearls(count, self.fewest)
        x = self.losses_of_stability(pearls)
        reached = ~np.isnan(x)
        values = np.where(reached[:, None], self.functions(np.where(reached, x, 0.0)), np.nan)
        waves = self._waves_around(float(values[:, V].max(initial=1.0)) if reached.all() else math.inf)
        return [self._outcome(*case, waves) for case in zip(pearls, x.tolist(), values, strict=True)]

    def _outcome(self, pearls: int, x: float, values: Array, waves: list[Solution[PearlProblem]]) -> Outcome:
        """From where the pearls lose stability (not a number: nowhere), the functions there, and ``_waves_around``."""
        nowhere = math.isnan(x)
        if (self._folds < (math.inf if nowhere else x)).any():
            return Outcome(Ending.FOLD, float(self.functions(self._folds[:1])[0, V]))
        n = _wave_around_before(waves, math.inf if nowhere else float(values[V]), pearls)
        if n is not None:
            return Outcome(Ending.AROUND, n)
        if nowhere:
            return Outcome(Ending.STABLE) if self.path.complete else Outcome(Ending.CUT, self.path.reason)
        return branch_point(values)


def branch_point(values: Array) -> Outcome:
    """The localized pearl's branch point where the pearls' functions have some values."""
    lambda1, lambda2, v, energy, squared = values[: SQUARE + 1].tolist()
    return Outcome(Ending.FOUND, values=LocalizedPearl(lambda1, lambda2, v, energy, math.sqrt(max(squared, 0.0))))


def _wave_around_before(waves: list[Solution[PearlProblem]], v_end: float, pearls: int) -> int | None:
    """The ``n`` of a growing non-axisymmetric wave that fits ``pearls`` periods, at one of some points before a volume."""
    for point in waves:
        if point.observables["v"] < v_end:
            found = spectrum(point.problem.profile(point.u), pearls)
            unstable = [block.n for block, rates in found.rates.items() if block.n > 0 and rates[0] > found.neutral]
            if unstable:
                return min(unstable)
    return None


def check_pearls(pearls: int, fewest: int) -> None:
    """Raise InputError unless ``pearls`` is a whole number from ``fewest`` on."""
    if finite("pearls", pearls) != int(pearls) or pearls < fewest:
        raise InputError(
            "pearls", f"{pearls} must be a whole number from {fewest} on", "trace(fewest=...) goes further"
        )


def check_period(period: float) -> float:
    """A pearl period as a float.

    Raises:
        InputError: it is at or below ``2 pi``, where the straight tube has no lower pearling boundary.
    """
    period = positive("period", period)
    if period <= 2 * math.pi:
        text = (
            "{period:g} is not above 2 pi = 6.283 radii (a wave number of 1/radius or more), and such pearls end no stable "
            "interval from below"
        )
        raise InputError("period", Sentence(text, period=period), "take a longer period")
    return period


def pearls_on(length: float, period: float) -> int:
    """How many pearls of a period fill a tube.

    Raises:
        InputError: no whole number does.
    """
    pearls = round(length / period)
    if pearls < 1 or abs(length - pearls * period) > 1e-9 * length:
        what = Sentence("{L:g} {L_unit} is no multiple of the period {period:g}", L=length, period=period)
        raise InputError("lengths", what, Sentence("the nearest is {length:.12g}", length=max(pearls, 1) * period))
    return pearls


def losses_at(c0: float, period: float, pearls: Sequence[int]) -> list[Outcome]:
    """How pearls of a period lose stability on several numbers of periods, 2 or more, by one continuation."""
    try:
        return PeriodicPearls.trace(c0, period, min(pearls)).outcomes(pearls)
    except (Unresolved, np.linalg.LinAlgError) as error:
        return [Outcome(Ending.FAILED, str(error)) for _ in pearls]


def localized_pearls(c0: float, period: float, lengths: float | str | Iterable[float]) -> pd.DataFrame:
    """Branch points of the localized pearl from the pearls of a period, on tubes of several lengths.

    One continuation serves all lengths, so that a thousand cost no more than twice what four cost, and a long tube what a
    short one costs.

    Args:
        c0: spontaneous curvature.
        period: axial period of the pearls, in radii of the straight tube.
        lengths: tube lengths, multiples of the period; a number, several, or a text like ``15:600:15``.

    Returns:
        A row a length, in the order given: ``c0, period, L, pearls, status, lambda1, lambda2, v, E, amplitude,
        message``. ``status`` is ``found``, ``unstable_at_onset``, ``none_in_range``, ``no_stable_cylinder`` or
        ``failed``; ``E`` is the energy by area, ``amplitude`` half the belly's radius minus the neck's.

    Raises:
        InputError: an argument that cannot be used; a length that is no multiple of the period.
    """
    import pandas as pd  # a quarter of a second, in which the command line lets another process find the rows

    rows = localized_rows(c0, period, as_numbers("lengths", lengths))
    return pd.DataFrame({name: [row[name] for row in rows] for name in COLUMNS})


def localized_rows(c0: float, period: float, lengths: list[float]) -> list[dict[str, object]]:
    """The rows of ``localized_pearls``."""
    period = check_period(period)
    tubes = [Tube(c0, positive("lengths", length)) for length in lengths]
    counts = [pearls_on(length, period) for length in lengths]
    intervals = stable_intervals(float(c0), np.array([tube.length for tube in tubes]))
    known = [at_onset(*case) for case in zip(intervals, counts, strict=True)]
    wanted = [count for count, outcome in zip(counts, known, strict=True) if outcome is None]
    found = iter(losses_at(c0, period, wanted) if wanted else ())
    return [
        localized_row(tube, period, count, outcome or next(found))
        for tube, count, outcome in zip(tubes, counts, known, strict=True)
    ]


def localized_row(tube: Tube, period: float, pearls: int, outcome: Outcome) -> dict[str, object]:
    """A row of ``localized_pearls``."""
    return (
        dict.fromkeys(COLUMNS, math.nan)
        | {"c0": tube.c0, "period": period, "L": tube.length, "pearls": pearls}
        | outcome.row()
    )
