"""What do the amplitude equations predict? Tables of coefficients, predicted branches, comparisons, and maps over tubes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.branch import Branch, SpecialPoint, Status
from pearlbvp.continuation.problem import Problem
from pearlbvp.continuation.solution import Solution
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.errors import InputError
from pearlbvp.force import with_force
from pearlbvp.helfrich import Tube, WaveNumbers, mode_list, positive, whole
from pearlbvp.numbers import as_numbers
from pearlbvp.progress import progress as progress_bar
from pearlbvp.theory.amplitude import AmplitudeEquation, Family, amplitude_equation, exchange_lengths, meeting_c0
from pearlbvp.theory.dispersion import critical_lambda2, growth_rate, stable_interval
from pearlbvp.units import Sentence

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ["c0", "L", "m", "n", "type", "lambda2", "lambda1", "a", "b", "b1", "b2", "alpha2", "stable", "role",
           "criticality"]  # fmt: skip


def criticality(equation: AmplitudeEquation) -> str:
    """``supercritical`` or ``subcritical``; of coils and buckles both, by name."""
    words = {
        family: "supercritical" if equation.supercritical(family) else "subcritical" for family in equation.families
    }
    return next(iter(words.values())) if len(words) == 1 else ", ".join(f"{f} {word}" for f, word in words.items())


def coefficients(c0: float, length: float, modes: Iterable[WaveNumbers]) -> pd.DataFrame:
    """The coefficients of the amplitude equations of some modes of a tube.

    Args:
        c0: spontaneous curvature.
        length: axial period of the tube, in radii.
        modes: pairs ``(m, n)`` of waves along and around the tube.

    Returns:
        A row a mode with the columns ``COLUMNS``: ``b`` for pearling and wrinkling, ``b1, b2`` for coiling and buckling.
        ``stable`` is the family that is stable at its onset at fixed area and volume, empty where the cylinder has lost
        its stability before; a branch is ``supercritical`` where it exists on the cylinder's unstable side.

    Raises:
        InputError: an argument that cannot be used; see ``theory.amplitude.AmplitudeEquation``.
    """
    import pandas as pd

    tube = Tube(c0, length)
    rows = []
    for mode in mode_list(modes):
        e = amplitude_equation(tube, mode)
        double = len(e.families) == 2
        rows.append(
            (c0, length, e.m, e.n, e.kind, e.lambda2, e.lambda1, e.a, math.nan if double else e.b1,
             e.b1 if double else math.nan, e.b2 if double else math.nan, e.alpha2, e.stable, e.role, criticality(e))
        )  # fmt: skip
    return pd.DataFrame(rows, columns=COLUMNS)


@dataclass(frozen=True)
class Prediction(Problem):
    """A predicted branch as a problem of one unknown, the amplitude ``[A]``, and no equation: it holds for each."""

    equation: AmplitudeEquation
    kind: Family
    headline = ("c0", "L", "v")

    @property
    def family(self) -> str:
        """That of the predicted shapes."""
        return self.kind

    def residual(self, u: Array) -> Array:
        """Nothing."""
        return np.zeros(0)

    def solve(self, u: Array, rhs: Array, row: Array | None = None) -> Array:
        """With the border alone."""
        return rhs if row is None else rhs / row[0]

    def inner(self, u: Array, v: Array) -> float:
        """Product of the amplitudes."""
        return float(u @ v)

    def observables(self, u: Array) -> dict[str, float]:
        """The columns of a branch, to leading order in the amplitude."""
        tube = self.equation.tube
        known = self.equation.at(self.kind, float(u[0]))
        curvature = known.pop("M")
        return with_force({**known, "c0": tube.c0, "L": tube.length, "M": curvature})

    def further(self, u: Array) -> dict[str, float]:
        """``wave``: ``2 A``."""
        return {"wave": 2 * float(u[0])}


class Wave(NamedTuple):
    """A wave of the cylinder, or the branch's own, as a block of one growth rate."""

    name: str
    multiplicity: int

    def __str__(self) -> str:
        return self.name


def _other_modes(equation: AmplitudeEquation) -> list[tuple[WaveNumbers, int, float]]:
    """The cylinder's modes at the branch point but the critical one, each with its multiplicity and growth rate.

    Those that grow, and the one nearest to it: ``mu > 0`` needs ``k^2 + n^2 < 3 + 2 |lambda2| + 2 |1 - 2 c0|``.
    """
    tube, lambda2 = equation.tube, equation.lambda2
    largest = math.sqrt(3 + 2 * abs(lambda2) + 2 * abs(1 - 2 * tube.c0))
    most = math.floor(largest / tube.wave_number(1)) + 1
    m, n = np.meshgrid(np.arange(most + 1), np.arange(math.floor(largest) + 2), indexing="ij")
    rates = growth_rate(tube.wave_number(1) * m, n, lambda2, tube.c0)
    excluded = ((m == 0) & (n <= 1)) | ((m == equation.m) & (n == equation.n))
    rates[excluded] = -np.inf
    chosen = np.argwhere((rates > 0) | (rates == rates.max()))
    return [
        ((int(i), int(j)), (2 if i and j else 1) * 2, float(rates[i, j])) for i, j in chosen if np.isfinite(rates[i, j])
    ]


def predicted_branch(
    c0: float,
    length: float,
    mode: WaveNumbers,
    family: Family | None = None,
    largest: float | None = None,
    points: int = 41,
) -> Branch[Any]:
    """The branch that the amplitude equation predicts, as a ``Branch``: every table and plot takes it.

    Args:
        c0: spontaneous curvature.
        length: axial period of the tube.
        mode: the mode ``(m, n)``.
        family: ``pearl``, ``ring``, ``coil`` or ``buckle``; by default the mode's, or that of the two that is stable.
        largest: amplitude ``A`` at which it ends, in radii; by default 0.2, or less where slaved waves would outgrow it.
        points: how many, from the cylinder on, evenly spaced in ``A``.

    Returns:
        The branch, all of it to leading order: ``n_unstable`` counts the cylinder's other unstable modes at the branch
        point and the mode's own perturbations.

    Raises:
        InputError: an argument that cannot be used.
    """
    equation = amplitude_equation(Tube(c0, length), mode)
    family = family or equation.preferred
    if largest is None:
        largest = min(0.2, 0.5 / max(map(abs, equation.slaved.values())))
    positive("largest", largest)
    points = whole("points", points, 2)
    end = equation.at(family, largest)
    if end["v"] <= 0 or end["r_min"] <= 0:
        text = f"at A = {{A:g}} the predicted {family} has no volume or no radius"
        raise InputError("largest", Sentence(text, A=largest), "go less far")
    problem, own = Prediction(equation, family), equation.own_rate(family)
    others = {Wave(f"m={m} n={n}", count): np.array([rate]) for (m, n), count, rate in _other_modes(equation)}
    itself = Wave("own", 2 if family == "coil" else 1)
    found = []
    for A in np.linspace(0, largest, points):
        rates = others | ({itself: np.array([own * A**2])} if own else {})
        spectrum = Spectrum(rates, math.nan, neutral=0.0)  # a prediction does not know its error
        u = np.array([A])
        found.append(Solution(problem, u, np.ones(1), known=spectrum))
    special: list[SpecialPoint] = [SpecialPoint("start", 0), SpecialPoint("end", points - 1)]
    return Branch(found, special, Status.GIVEN, Sentence("the amplitude is {A:g}", A=largest))


COMPARED = ("lambda1", "lambda2", "E")
"""Columns that a computed branch must have to be compared."""

WAVE = "wave"
"""Column that is compared where the computed branch has it: ``2 A``."""


def compared(table: pd.DataFrame, equation: AmplitudeEquation, family: Family) -> pd.DataFrame:
    """A computed branch beside its prediction, at the same volume.

    Args:
        table: of a branch from the cylinder on (``branch.table()`` or its CSV): ``v, lambda1, lambda2, E``.
        equation: the amplitude equation of its mode.
        family: which of the mode's branches it is.

    Returns:
        A row a computed point off the cylinder, on the side where the branch is predicted: ``A``, ``v``, of ``lambda1,
        lambda2, E`` the computed and the predicted value, the difference relative to the change since the onset
        (``..._error``), and the order in ``A`` at which that error falls between this row and the one before (``..._order``):
        2 for the multipliers, 4 for the energy, whose predictions are right to the square and to the fourth power. Where the
        table has the column ``wave``, the same of that and ``2 A``, at last: 2.

    Raises:
        InputError: a column is missing, the table is of another tube or mode, or no point can be compared.
    """
    import pandas as pd

    missing = [name for name in ("v", *COMPARED) if name not in table]
    if missing:
        raise InputError("compare", f"the table has no column {', '.join(missing)}", "give that of a branch")
    for name, value in (("c0", equation.tube.c0), ("L", equation.tube.length)):
        if name in table and (np.abs(table[name] - value) > 1e-6 * (1 + abs(value))).any():
            found = Sentence(f"the table is of {name} = {{{name}:g}}", **{name: table[name].iloc[0]})
            wanted = Sentence(f", not {{{name}:g}}", **{name: value})
            raise InputError("compare", found + wanted, "give that of this tube")
    start = table[(table["v"] - 1).abs() < 1e-9]
    if len(start) and abs(start["lambda2"].iloc[0] - equation.lambda2) > 1e-6 * (1 + abs(equation.lambda2)):
        found = Sentence(
            "the table's branch leaves the cylinder at lambda2 = {lambda2:.6g}",
            lambda2=start["lambda2"].iloc[0],
        )
        wanted = Sentence(f", mode ({equation.m},{equation.n}) at {{lambda2:.6g}}", lambda2=equation.lambda2)
        raise InputError("compare", found + wanted, "give that of this mode")
    cylinder = equation.at(family, 0.0)
    A = np.array([equation.amplitude_at(family, v) for v in table["v"]])
    chosen = A > 1e-6
    if not chosen.any():
        side = "above" if equation.a < 0 else "below"
        what = f"the table has no point with v {side} 1, where the {family} branch is"
        raise InputError("compare", what, "give the table of that branch")
    A, rows = A[chosen], table[chosen]
    predicted = pd.DataFrame([equation.at(family, float(a)) | {WAVE: 2 * float(a)} for a in A])
    cylinder[WAVE] = 0.0
    result = pd.DataFrame({"A": A, "v": rows["v"].to_numpy(float)})
    for name in (*COMPARED, *([WAVE] if WAVE in rows else [])):
        computed = rows[name].to_numpy(float)
        error = np.abs(predicted[name].to_numpy() - computed) / np.abs(computed - cylinder[name])
        result[name], result[f"{name}_predicted"], result[f"{name}_error"] = computed, predicted[name], error
        with np.errstate(divide="ignore", invalid="ignore"):
            order = np.diff(np.log(error)) / np.diff(np.log(A))
        result[f"{name}_order"] = np.concatenate(([math.nan], order))
    return result


MAP_COLUMNS = ["c0", "L", "lower_mode", "lower_lambda2", "lower_criticality", "upper_mode", "upper_lambda2",
               "upper_type", "upper_criticality", "stable", "message"]  # fmt: skip


def instability_map(
    c0: str | float | Iterable[float], lengths: str | float | Iterable[float], *, progress: bool | None = None
) -> pd.DataFrame:
    """Which mode destabilizes each tube at either end of its stable interval, and what branches off there.

    Args:
        c0: spontaneous curvatures: a number, several, or a text like ``-1:0.48:0.02``.
        lengths: axial periods, likewise.
        progress: show a bar on standard error (``None``: if that is a terminal).

    Returns:
        A row a tube: of the lower end (pearling) and the upper end the mode ``m:n``, its ``lambda2``, whether its branch is
        super- or subcritical; ``stable`` is what is stable at the upper end: ``coil``, ``buckle``, ``ring`` or ``pearl``.
        Empty with a ``message`` where the tube is stable nowhere, or where an amplitude equation does not hold.

    Raises:
        InputError: an argument that cannot be used.
    """
    import pandas as pd

    tubes = [Tube(value, length) for value in as_numbers("c0", c0) for length in as_numbers("lengths", lengths)]
    rows = []
    with progress_bar("tube", len(tubes), shown=progress) as bar:
        for tube in tubes:
            rows.append(_instabilities(tube))
            bar.update()
    return pd.DataFrame(rows, columns=MAP_COLUMNS)


def _instabilities(tube: Tube) -> dict[str, Any]:
    """One row of the map."""
    row: dict[str, Any] = dict.fromkeys(MAP_COLUMNS, "") | {
        "c0": tube.c0, "L": tube.length, "lower_lambda2": math.nan, "upper_lambda2": math.nan,
    }  # fmt: skip
    interval = stable_interval(tube)
    if not interval.exists:
        return row | {"message": "the straight tube is stable nowhere"}
    for end, mode in (("lower", interval.lower_mode), ("upper", interval.upper_mode)):
        if mode is None:
            continue
        row[f"{end}_mode"] = f"{mode[0]}:{mode[1]}"
        row[f"{end}_lambda2"] = interval.lower if end == "lower" else interval.upper
        try:
            equation = amplitude_equation(tube, mode)
        except InputError as error:
            row["message"] = str(error)
            continue
        row[f"{end}_criticality"] = criticality(equation)
        if end == "upper":
            row["upper_type"], row["stable"] = equation.kind, equation.preferred
    return row


def exchange_curve(c0: str | float | Iterable[float], mode: WaveNumbers = (1, 1)) -> pd.DataFrame:
    """Lengths ``L(c0)`` at which coils and buckles of a mode exchange stability (``b1 = b2``): columns ``c0, L, lambda2``."""
    import pandas as pd

    m, n = mode
    rows = [
        (value, length, float(critical_lambda2(2 * math.pi * m / length, n, value)))
        for value in as_numbers("c0", c0)
        for length in exchange_lengths(value, m, n)
    ]
    return pd.DataFrame(rows, columns=["c0", "L", "lambda2"])


def meeting_points(
    c0: str | Iterable[float], lengths: str | float | Iterable[float], *, progress: bool | None = None
) -> pd.DataFrame:
    """Tubes on which two modes become critical at once at an end of the stable interval: points of codimension two.

    Args:
        c0: curvatures between which they are looked for, increasing and dense enough to separate them.
        lengths: axial periods.
        progress: show a bar on standard error (``None``: if that is a terminal).

    Returns:
        A row a meeting: ``L, c0, end, lambda2, mode, other``; at ``c0`` itself both modes are neutral at ``lambda2``.
    """
    import pandas as pd

    values, tubes = sorted(as_numbers("c0", c0)), as_numbers("lengths", lengths)
    rows: list[tuple[Any, ...]] = []
    with progress_bar("length", len(tubes), shown=progress, doing="meetings") as bar:
        for length in tubes:
            rows += _meetings(values, length)
            bar.update()
    return pd.DataFrame(rows, columns=["L", "c0", "end", "lambda2", "mode", "other"])


def _meetings(values: Sequence[float], length: float) -> Iterator[tuple[Any, ...]]:
    """The rows of one length."""
    intervals = [stable_interval(Tube(value, length)) for value in values]
    for low, high, left, right in zip(values, values[1:], intervals, intervals[1:], strict=False):
        for end in ("lower", "upper"):
            one, other = getattr(left, f"{end}_mode"), getattr(right, f"{end}_mode")
            if one is None or other is None or one == other or not (left.exists and right.exists):
                continue
            place = meeting_c0(one, other, length)
            if low <= place <= high:
                lambda2 = float(critical_lambda2(2 * math.pi * one[0] / length, one[1], place))
                yield length, place, end, lambda2, f"{one[0]}:{one[1]}", f"{other[0]}:{other[1]}"
