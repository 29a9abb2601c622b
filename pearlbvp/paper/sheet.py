"""What a figure of the paper is made of: panels with data, which pictures draw and tables hold, and the numbers behind them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from pearlbvp.continuation.solution import Solution
from pearlbvp.flows.record import FlowResult

Tables = Mapping[str, pd.DataFrame]
Samples = Mapping[str, Solution[Any]]
Values = Mapping[tuple[str, str], float]
"""Computed numbers by label and quantity, those of ``printed.csv``."""


@dataclass(frozen=True)
class Curves:
    """Two columns of several branches, with the paper's samples as points, and predictions as thin lines.

    Attributes:
        letter: of the panel.
        x, y: columns.
        branches: computed curves, by name; rows whose number ``point`` is no whole one lie between computed points.
        samples: points on them, by the paper's name.
        predicted: tables of amplitude equations, by name.
    """

    letter: str
    x: str
    y: str
    branches: Tables
    samples: Samples = field(default_factory=dict)
    predicted: Tables = field(default_factory=dict)

    def table(self) -> pd.DataFrame:
        """``curve``, ``x``, ``y`` and ``n_unstable``, a row a point."""
        tables = self.branches | {f"{name}, predicted": table for name, table in self.predicted.items()}  # type: ignore[operator]
        tables = {name: t[t["point"] % 1 == 0] if "point" in t else t for name, t in tables.items()}
        rows = [t[[self.x, self.y, "n_unstable"]].assign(curve=name) for name, t in tables.items()]
        return pd.concat(rows, ignore_index=True)[["curve", self.x, self.y, "n_unstable"]]


@dataclass(frozen=True)
class Shapes:
    """Samples as surfaces, coloured by the normal displacement along their branches."""

    letter: str
    samples: Samples

    def table(self) -> pd.DataFrame:
        """A row a sample."""
        return sample_table(self.samples)


@dataclass(frozen=True)
class Regions:
    """Where the straight tube is unstable to waves: critical ``lambda2`` over ``k``; ``curves`` has ``n, k, lambda2``."""

    letter: str
    c0: float
    curves: pd.DataFrame

    def table(self) -> pd.DataFrame:
        """The curves."""
        return self.curves


@dataclass(frozen=True)
class Rates:
    """Growth rates of waves over ``k``; ``rates`` has ``case, n, k, mu``."""

    letter: str
    rates: pd.DataFrame

    def table(self) -> pd.DataFrame:
        """The rates."""
        return self.rates


@dataclass(frozen=True)
class Sectors:
    """Stable families over the cubic coefficients ``b1, b2``; ``sectors`` has a row a sector of the plane."""

    letter: str
    sectors: pd.DataFrame

    def table(self) -> pd.DataFrame:
        """The sectors."""
        return self.sectors


@dataclass(frozen=True)
class Course:
    """A flow: its first and last shape, energy, multipliers and conservation over time."""

    letter: str
    result: FlowResult

    def table(self) -> pd.DataFrame:
        """A row a time step."""
        return self.result.table()


Panel = Curves | Shapes | Regions | Rates | Sectors | Course


@dataclass(frozen=True)
class Sheet:
    """A figure or a table of the paper, computed.

    Attributes:
        panels: in the paper's order; none of a table of numbers.
        values: what is compared with ``printed.csv``.
        samples: points that the figure names.
    """

    panels: tuple[Panel, ...]
    values: Values
    samples: Samples = field(default_factory=dict)


def sample_table(samples: Samples) -> pd.DataFrame:
    """Observables and stability of samples, a row each."""
    rows = [{"sample": name, **measured(at), "critical": str(at.spectrum.critical)} for name, at in samples.items()]
    return pd.DataFrame(rows)


def measured(at: Solution[Any]) -> dict[str, float]:
    """What the paper may print of a sample: observables, ``n_unstable``, ``mu_crit`` and ``stable`` (1 or 0)."""
    found = dict(at.observables)
    n = at.spectrum.n_unstable
    return found | {"n_unstable": n, "mu_crit": at.spectrum.mu_crit, "stable": float(n == 0)}


def values_of(samples: Samples) -> dict[tuple[str, str], float]:
    """The numbers of samples, by name and quantity."""
    return {(name, quantity): value for name, at in samples.items() for quantity, value in measured(at).items()}
