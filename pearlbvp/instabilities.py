"""Which mode destabilizes which tube, with the verbs of an ordinary analysis: nothing is computed here."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from pearlbvp.numbers import as_numbers
from pearlbvp.studies.amplitude import exchange_curve, instability_map, meeting_points
from pearlbvp.units import RADII, Units

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class AmplitudeMap:
    """Which mode destabilizes the straight tube at either end of its stable interval, over ``c0`` and ``L``.

    Attributes:
        c0: spontaneous curvatures.
        lengths: axial periods.
        table: a row a tube; see ``amplitude_map``.
    """

    c0: list[float]
    lengths: list[float]
    table: pd.DataFrame = field(repr=False)

    @cached_property
    def exchange(self) -> pd.DataFrame:
        """Where coils and buckles of mode (1, 1) exchange stability: ``c0, L, lambda2``."""
        return exchange_curve(self.c0)

    @cached_property
    def meetings(self) -> pd.DataFrame:
        """Where two modes become critical at once, on these lengths: ``L, c0, end, lambda2, mode, other``."""
        return meeting_points(self.c0, self.lengths)

    def plot(self, units: Units = RADII) -> Figure:
        """Two maps, of the lower and of the upper end of the stable interval.

        Args:
            units: of the axes.
        """
        from pearlbvp.figures.amplitude import draw_map

        return draw_map(units.columns(self.table), units.columns(self.exchange), units)


def amplitude_map(c0: float | str | Iterable[float], lengths: float | str | Iterable[float]) -> AmplitudeMap:
    """Which mode destabilizes each tube at either end of its stable interval, and what branches off there.

    Args:
        c0: spontaneous curvatures: a number, several, or a text like ``-1:0.48:0.02``.
        lengths: axial periods, likewise.

    Returns:
        A table (``table``) with a row a tube: of the lower end (pearling) and the upper end the mode ``m:n``, its ``lambda2``,
        whether its branch is super- or subcritical; ``stable`` is what is stable at the upper end: ``coil``, ``buckle``,
        ``ring`` or ``pearl``. Also ``meetings`` of two modes, the ``exchange`` of coils and buckles, a picture (``plot()``).

    Raises:
        InputError: an argument that cannot be used.

    Examples:
        >>> import pearlbvp as pb
        >>> found = pb.amplitude_map("-1:0.4:0.2", 10)
        >>> found.table[["c0", "upper_mode", "stable"]].iloc[[0, -1]].values.tolist()
        [[-1.0, '0:2', 'ring'], [0.4, '1:1', 'buckle']]
        >>> found.meetings[["c0", "mode", "other"]].round(6).values.tolist()
        [[-0.151304, '0:2', '1:1']]
    """
    curvatures, periods = as_numbers("c0", c0), as_numbers("lengths", lengths)
    return AmplitudeMap(curvatures, periods, instability_map(curvatures, periods))
