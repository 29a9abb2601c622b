"""The questions that can be scanned: for each its parameters, its columns, and the pure function that answers cases.

A question more is an entry here: the store, the engines, the command line and the exports know it then.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import TYPE_CHECKING

from pearlbvp.errors import InputError
from pearlbvp.scans.case import Case, Row, Value

if TYPE_CHECKING:
    import pandas as pd

    from pearlbvp.studies.first_pearls import FirstPearls

CRITICAL = "critical"
"""The period of the pearls that the straight tube of a length loses stability to, instead of a number."""

ANY = "any"
"""A tube on which waves of any length fit, instead of its length."""

MANY = 56
"""Periods of one ``c0`` that are answered together: fewer make no series (``studies.pearl_series.FEWEST``)."""


@dataclass(frozen=True)
class Question:
    """What can be asked of many tubes.

    Attributes:
        name: as the command line has it.
        parameters: of a case, in the order by which tables are sorted; ``c0, L, period, ...`` in radii.
        columns: of its table.
        rows: the rows of each of several cases that belong together; pure.
        from_series: the same from series that were kept, and the new ones that it took.
        series_of: the ``c0`` of the series that a case is answered from; None where it is from none.
        together: cases with equal answers are answered together.
        apart: of those the ones that are answered together where there are fewer than ``MANY`` of such parts.
        integers: columns of whole numbers.
        settings: tolerances that its numbers depend on: other ones are other cases.
        check: refuses a case that no tube has.
        drawn: the columns that pictures show.
        role: of the rows that they show; all, where it is empty.
        fluids: whether its rates are those of motions in fluids, so that a viscosity makes them rates in 1/s.
        says: what is asked, in a sentence.
        example: of its command line.
    """

    name: str
    parameters: tuple[str, ...]
    columns: tuple[str, ...]
    rows: Callable[[Sequence[Case]], list[Sequence[Row]]]
    together: Callable[[Case], tuple[Value, ...]] = lambda case: case.parameters
    apart: Callable[[Case], tuple[Value, ...]] | None = None
    from_series: Callable[[Sequence[Case], Sequence[bytes]], tuple[list[Sequence[Row]], list[bytes]]] | None = None
    series_of: Callable[[Case], float | None] = lambda case: None
    integers: tuple[str, ...] = ()
    settings: Mapping[str, Value] = field(default_factory=dict)
    check: Callable[[Case], object] = lambda case: None
    drawn: tuple[str, ...] = ("v",)
    role: str = ""
    fluids: bool = False
    says: str = ""
    example: str = ""

    def answered(self, cases: Sequence[Case], known: Sequence[bytes]) -> tuple[list[Sequence[Row]], list[bytes]]:
        """The rows of cases that belong together, and new series that are worth keeping."""
        if self.from_series is None or self.series_of(cases[0]) is None:
            return self.rows(cases), []
        return self.from_series(cases, known)


def _each(row: Callable[..., Row | Sequence[Row]]) -> Callable[[Sequence[Case]], list[Sequence[Row]]]:
    """Answers of a function of one case's parameters."""

    def rows(cases: Sequence[Case]) -> list[Sequence[Row]]:
        found = [row(*case.parameters) for case in cases]
        return [[one] if isinstance(one, Mapping) else one for one in found]

    return rows


def _records(table: pd.DataFrame) -> list[Row]:
    return [dict(zip(map(str, table.columns), row, strict=True)) for row in table.itertuples(index=False, name=None)]


def _dispersion(c0: float, length: float) -> list[Row]:
    from pearlbvp.studies.dispersion import branch_points

    return [{"c0": c0, "L": length, **row} for row in _records(branch_points(c0, length))]


def _growth(c0: float, tension: float, length: Value, viscosity_ratio: float, membrane_viscosity: float) -> list[Row]:
    from pearlbvp.studies.growth import growth

    table = growth(
        c0, tension, None if length == ANY else float(length), viscosity_ratio=viscosity_ratio,
        membrane_viscosity=membrane_viscosity,
    )  # fmt: skip
    return _records(table.assign(viscosity_ratio=viscosity_ratio, membrane_viscosity=membrane_viscosity))


def _check_growth(case: Case) -> None:
    from pearlbvp.studies.growth import known_tension
    from pearlbvp.theory.stokes import Fluids

    c0, tension, _, *fluids = case.parameters
    known_tension(float(c0), float(tension))
    Fluids(*map(float, fluids))


def _localized(cases: Sequence[Case], known: Sequence[bytes] = ()) -> tuple[list[Sequence[Row]], list[bytes]]:
    """Tables of localized pearls: all lengths of one period, or of the first pearls, or of all periods of a ``c0``."""
    if cases[0].parameters[1] == CRITICAL:
        return _critical(cases, known)
    return _of_periods(_c0(cases[0]), [(float(case.parameters[2]), float(case.parameters[1])) for case in cases], known)


def _of_periods(
    c0: float, tubes: Sequence[tuple[float, float]], known: Sequence[bytes]
) -> tuple[list[Sequence[Row]], list[bytes]]:
    """Rows of tubes by their lengths and periods, and new series."""
    from pearlbvp.studies.first_pearls import pearls_of_periods
    from pearlbvp.studies.pearl_series import PearlSeries

    found, new = pearls_of_periods(c0, tubes, [PearlSeries.from_bytes(one) for one in known])
    return [[row] for row in found], [one.to_bytes() for one in new]


def _check_localized(case: Case) -> None:
    from pearlbvp.studies.localized import check_period, pearls_on

    _, period, length = case.parameters
    if period != CRITICAL:
        pearls_on(float(length), check_period(float(period)))


def _critical(cases: Sequence[Case], known: Sequence[bytes]) -> tuple[list[Sequence[Row]], list[bytes]]:
    """Localized pearls among the first pearls: all lengths of a ``c0`` from the same series."""
    found, new = _first_pearls(cases, known)
    return [[one.row()] for one in found], new


def _period(cases: Sequence[Case], known: Sequence[bytes] = ()) -> tuple[list[Sequence[Row]], list[bytes]]:
    """Rows of the first pearls, likewise."""
    found, new = _first_pearls(cases, known)
    return [[one.period_row()] for one in found], new


def _first_pearls(cases: Sequence[Case], known: Sequence[bytes]) -> tuple[list[FirstPearls], list[bytes]]:
    from pearlbvp.studies.first_pearls import first_pearls
    from pearlbvp.studies.pearl_series import PearlSeries

    at = QUESTIONS[cases[0].question].parameters.index("L")
    lengths = [float(case.parameters[at]) for case in cases]
    found, new = first_pearls(float(cases[0].parameters[0]), lengths, [PearlSeries.from_bytes(one) for one in known])
    return found, [one.to_bytes() for one in new]


def _c0(case: Case) -> float:
    return float(case.parameters[0])


def _region(cases: Sequence[Case], known: Sequence[bytes] = ()) -> tuple[list[Sequence[Row]], list[bytes]]:
    cells = [(float(case.parameters[1]), int(case.parameters[2])) for case in cases]
    return _of_periods(_c0(cases[0]), [(pearls * period, period) for period, pearls in cells], known)


def _amplitude_map(c0: float, length: float) -> Row:
    from pearlbvp.studies.amplitude import instability_map

    return _records(instability_map(c0, length, progress=False))[0]


def _waves(mode: str) -> tuple[int, int]:
    """Waves along and around, from a case's ``m:n``."""
    from pearlbvp.numbers import as_whole

    along, around = (as_whole(part) for part in mode.partition(":")[::2])
    if along is None or around is None:
        raise InputError("mode", f"{mode.replace(':', ',')!r} is no mode", "give waves along and around, like 1,1")
    return along, around


def _check_branch(case: Case) -> None:
    _check_mode(str(case.parameters[2]), str(case.parameters[3]))


@cache
def _check_mode(name: str, mode: str) -> None:
    """Refuse a mode that a family has on no tube, by one on which such waves are of middle length."""
    from pearlbvp.held import AREA_AND_VOLUME
    from pearlbvp.helfrich import Tube
    from pearlbvp.studies.families import family

    found, waves = family(name), _waves(mode)
    try:
        found.start(Tube(0.0, 10.0 * max(waves[0], 1)), waves, AREA_AND_VOLUME, None)
    except InputError as error:
        if error.argument == "mode":
            raise


def _branch(cases: Sequence[Case]) -> list[Sequence[Row]]:
    """Rows of a branch at given volumes: one continuation from the cylinder outwards for each side of v = 1."""
    from pearlbvp.continuation.branch import Status
    from pearlbvp.helfrich import Tube
    from pearlbvp.studies.branch import branch_options, family_branch
    from pearlbvp.studies.onward import resumed

    c0, length, family, mode, _ = cases[0].parameters
    tube = Tube(float(c0), float(length))
    rows: dict[float, Row] = {}
    branch = None
    volumes = sorted({float(case.parameters[4]) for case in cases}, key=lambda v: abs(v - 1))
    # Where shapes lead is known without their growth rates, which take most of the time: volumes that are out of reach cost
    # no more than that.
    options = replace(branch_options({"v": volumes[-1]}), folds=(), stability=False)
    scout = family_branch(tube, str(family), _waves(str(mode)), options)
    side = math.copysign(1, volumes[-1] - 1)
    reach = max(side * (point.observables["v"] - 1) for point in scout.points)
    ends = scout.status in (Status.POINTS, Status.LIMIT)
    for v in volumes:
        options = branch_options({"v": v})
        here = {"c0": c0, "L": length, "family": family, "mode": mode, "v": v}
        if ends and side * (v - 1) > reach:
            rows[v] = {**here, "status": "none_in_range", "message": f"the branch does not reach it: {scout.reason}"}
            continue
        if branch is None:
            branch = family_branch(tube, str(family), _waves(str(mode)), options)
        elif branch.complete:
            branch = resumed(branch, options)
        if abs(branch.points[-1].observables["v"] - v) < 1e-9:
            values = _records(branch.table().tail(1))[0]
            rows[v] = {**values, **here, "status": "found", "message": ""}
        else:
            rows[v] = {**here, "status": "none_in_range", "message": f"the branch does not reach it: {branch.reason}"}
    return [[rows[float(case.parameters[4])]] for case in cases]


PHASES_DEPTH, PHASES_STARTS = 1, 12
"""To which the branches of phases are followed, and how many random shapes are relaxed besides."""


def _phases(cases: Sequence[Case]) -> list[Sequence[Row]]:
    """The stable shapes of a tube at some volumes, all on one side of 1: branches are followed once."""
    from pearlbvp.helfrich import Tube
    from pearlbvp.studies.phases import phases

    c0, length, _ = cases[0].parameters
    wanted = [float(case.parameters[2]) for case in cases]
    found = phases(Tube(float(c0), float(length)), wanted, depth=PHASES_DEPTH, starts=PHASES_STARTS)
    if not found.complete:
        raise KeyboardInterrupt
    status = {True: "none_in_range", False: "found"}
    rows = [{**row, "status": status[row["branch"] == ""]} for row in _records(found.table)]
    return [[row for row in rows if row["v"] == v] for v in wanted]


def _check_phases(case: Case) -> None:
    from pearlbvp.helfrich import Tube
    from pearlbvp.studies.phases import known_volumes

    c0, length, v = case.parameters
    known_volumes(Tube(float(c0), float(length)), float(v))


def _side(case: Case) -> tuple[Value, ...]:
    return (*case.parameters[:4], float(case.parameters[4]) > 1)


LOCALIZED = ("c0", "period", "L", "pearls", "status", "lambda1", "lambda2", "v", "E", "amplitude", "message")

QUESTIONS: Mapping[str, Question] = {
    question.name: question
    for question in (
        Question(
            "dispersion", ("c0", "L"),
            ("c0", "L", "m", "n", "k", "type", "lambda2", "lambda1", "kernel", "role", "force", "status", "message"),
            _each(_dispersion), integers=("m", "n", "kernel"), drawn=("lambda2",),
            says="The branch points of the straight tube.",
            example="dispersion --c0 0.3,0.48 --lengths 10:40:0.5 --store d.sqlite",
        ),
        Question(
            "growth", ("c0", "lambda1", "L", "viscosity_ratio", "membrane_viscosity"),
            ("c0", "lambda1", "L", "viscosity_ratio", "membrane_viscosity", "m", "n", "k", "type", "wavelength", "rate", "mu",
             "mu_diffusion", "role", "lambda2", "lambda1_lower", "lambda1_pearl", "force", "status", "message"),
            _each(_growth), integers=("m", "n"), check=_check_growth, drawn=("rate",), role="fastest", fluids=True,
            says="How fast waves of the straight tube grow in water, which is the fastest, and when pearls do.",
            example="growth --c0 0 --tension 0.8:2:0.05 --viscosity-ratio 1,10 --store g.sqlite",
        ),
        Question(
            "localized", ("c0", "period", "L"), LOCALIZED, lambda cases: _localized(cases)[0],
            lambda case: (case.parameters[0], case.parameters[1] == CRITICAL), lambda case: case.parameters[:2],
            _localized, _c0, integers=("pearls",), check=_check_localized,
            says="Where pearls of a period give way to one localized pearl.",
            example="localized --c0 0.26:0.49:0.01 --period critical --lengths 15:300:7.5 --store l.sqlite",
        ),
        Question(
            "period", ("c0", "L"),
            ("c0", "L", "pearls", "period", "k", "status", "lambda2_pearl", "lambda2_upper", "upper_mode", "v_localized",
             "localized_status", "message"),
            lambda cases: _period(cases)[0], lambda case: case.parameters[:1], None, _period, _c0,
            integers=("pearls",), drawn=("period",),
            says="The pearl period that appears on a tube, its stable range, and where a localized pearl takes over.",
            example="period --c0 0.3,0.48 --lengths 7.5:120:0.5 --store p.sqlite",
        ),
        Question(
            "region", ("c0", "period", "pearls"), LOCALIZED, lambda cases: _region(cases)[0],
            lambda case: case.parameters[:1], lambda case: case.parameters[:2], _region, _c0, integers=("pearls",),
            says="Up to which volume pearls that leave the straight tube are stable, in the plane of period and volume.",
            example="region --c0 0.3:0.48:0.02 --period 6.6:10:0.1 --store r.sqlite",
        ),
        Question(
            "amplitude-map", ("c0", "L"),
            ("c0", "L", "lower_mode", "lower_lambda2", "lower_criticality", "upper_mode", "upper_lambda2", "upper_type",
             "upper_criticality", "stable", "status", "message"),
            _each(_amplitude_map), drawn=("lower_lambda2", "upper_lambda2"),
            says="Which mode destabilizes the straight tube at either end of its stable interval.",
            example="amplitude-map --c0=-1:0.48:0.02 --lengths 6:40:1 --store a.sqlite",
        ),
        Question(
            "branch", ("c0", "L", "family", "mode", "v"),
            ("c0", "L", "family", "mode", "v", "status", "lambda1", "lambda2", "E", "amplitude", "r_min", "r_max",
             "n_unstable", "mu_crit", "message", "critical", "mu_error", "wave", "M", "force", "torque"),
            _branch, _side, integers=("n_unstable",), check=_check_branch, drawn=("lambda2",),
            says="A branch from the straight tube, at given volumes.",
            example="branch coil --mode 1,1 --c0 0:0.48:0.04 --lengths 8:16:1 --volumes 0.9,0.95 --store b.sqlite",
        ),
        Question(
            "phases", ("c0", "L", "v"),
            ("c0", "L", "v", "status", "branch", "family", "symmetry", "rank", "E", "excess", "lambda1", "lambda2", "force",
             "n_unstable", "mu_crit", "critical", "amplitude", "r_min", "r_max", "branches", "depth", "message",
             "starts", "rest_here", "origin", "multiplicity"),
            _phases, lambda case: (*case.parameters[:2], float(case.parameters[2]) > 1),
            integers=("rank", "n_unstable", "branches", "depth", "starts", "rest_here", "multiplicity"),
            settings={"depth": PHASES_DEPTH, "starts": PHASES_STARTS}, check=_check_phases,
            drawn=("E",), says="Which shapes are stable on a tube at given volumes, by their energy.",
            example="phases --c0 0.3:0.48:0.02 --lengths 10:20:1 --volumes 1.005,1.01,1.05 --store h.sqlite",
        ),
    )
}  # fmt: skip
"""By name."""


def question_named(name: str) -> Question:
    """The question of a name.

    Raises:
        InputError: there is none.
    """
    if name not in QUESTIONS:
        raise InputError("question", f"{name!r} cannot be scanned", f"choose one of {', '.join(QUESTIONS)}")
    return QUESTIONS[name]
