"""The model: Helfrich energy of a tube of fixed period, area and volume, and the straight cylinder.

``E = integral of (H - c0)^2 dS``, ``F = E + lambda1 (A - A0) + lambda2 (V - V0)``, steady states
``G = Lap H + 2H(H^2 - K) + 2 c0 K - 2(c0^2 + lambda1) H - lambda2 = 0`` (paper, eqs. (1) to (4)), with the inner
normal: ``H = +1/2`` on the unit cylinder. Lengths are measured in radii of the straight tube.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pearlbvp.errors import InputError

WaveNumbers = tuple[int, int]
"""Whole waves ``m`` along the tube and ``n`` around it."""

SHORT_WAVE = 4.0
"""Wave number beyond which amplitudes and multipliers of a branch are measured by powers of it, as they are of its size."""

SMALLEST_AMPLITUDE = 1e-6
"""Amplitude below which a shape is the straight tube."""

LARGEST_C0, SHORTEST, LONGEST = 1e4, 1e-4, 1e8
"""Beyond these a number is a mistake of units, and arithmetic loses its digits."""


def finite(name: str, value: float) -> float:
    """``value`` as a float.

    Raises:
        InputError: it is not a finite number; the message names the argument.
    """
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(name, f"{_told(value)} is not a number", "give one like 0.48") from None
    except OverflowError:  # a whole number of hundreds of digits
        number = math.inf
    if not math.isfinite(number):
        raise InputError(name, f"{_told(value)} is not finite", "give an ordinary number")
    return number


def _told(value: object) -> str:
    """What was given, on a part of a line."""
    text = " ".join(repr(value).split())
    return text if len(text) <= MOST_TOLD else f"{text[:MOST_TOLD]}..."


MOST_TOLD = 80
"""Characters of a wrong value that a message shows."""


def positive(name: str, value: float) -> float:
    """``value`` as a float.

    Raises:
        InputError: it is not a finite number above zero; the message names the argument.
    """
    number = finite(name, value)
    if number <= 0:
        raise InputError(name, f"{_told(value)} must be positive", "give a number above 0")
    return number


def whole(name: str, value: float, least: float = 1) -> int:
    """``value`` as an int.

    Raises:
        InputError: it is no whole number, or below the least that there may be; the message names the argument.
    """
    number = math.nan if isinstance(value, str) else finite(name, value)  # type: ignore[unreachable]
    if not (number == math.floor(number) if math.isfinite(number) else False) or number < least:
        bound = f", {least} or more" if math.isfinite(least) else ""
        raise InputError(name, f"{_told(value)} must be a whole number{bound}", f"give one like {max(least, 2)}")
    return int(number)


def mode_numbers(name: str, value: tuple[int, int], least: float = 0) -> tuple[int, int]:
    """``value`` as a pair: waves along the tube, and around it.

    Raises:
        InputError: it is no pair of whole numbers; the message names the argument.
    """
    try:
        m, n = value
        return whole(name, m, least), whole(name, n, least)
    except (TypeError, ValueError):  # an InputError is one of the latter
        raise InputError(
            name, f"{_told(value)} must be two whole numbers, waves along and around", "give a pair like (1, 1)"
        ) from None


def mode_list(modes: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
    """Several modes.

    Raises:
        InputError: they are none.
    """
    try:
        return [mode_numbers("mode", mode) for mode in modes]
    except TypeError:
        raise InputError("modes", f"{_told(modes)} must be a list of pairs", "give one like [(1, 0), (1, 1)]") from None


def choice(name: str, value: str, known: Sequence[str]) -> str:
    """``value``, which is one of several words.

    Raises:
        InputError: it is none of them; the message names the argument.
    """
    if value not in known:
        raise InputError(name, f"{value!r} is unknown", f"choose one of {', '.join(known)}")
    return value


@dataclass(frozen=True)
class Tube:
    """A straight tube of radius 1.

    Attributes:
        c0: spontaneous curvature.
        L: axial period.

    Raises:
        InputError: ``c0`` is not finite, or ``length`` is not a positive finite number.
    """

    c0: float
    L: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "c0", finite("c0", self.c0))
        object.__setattr__(self, "L", positive("length", self.L))
        if abs(self.c0) > LARGEST_C0:
            raise InputError(
                "c0", f"{self.c0:g} is beyond {LARGEST_C0:g} in units of 1/radius", "check its unit, or the radius"
            )
        if not SHORTEST <= self.length <= LONGEST:
            raise InputError(
                "length", f"{self.length:g} radii is not between {SHORTEST:g} and {LONGEST:g}", "check its unit"
            )

    @property
    def length(self) -> float:
        """Axial period ``L``."""
        return self.L

    def wave_number(self, m: int) -> float:
        """``k_m = 2 pi m / L``."""
        return 2 * math.pi * m / self.length


def known_tube(tube: Tube) -> Tube:
    """A tube.

    Raises:
        InputError: it is none.
    """
    if not isinstance(tube, Tube):
        raise InputError("tube", f"{type(tube).__name__} must be a tube", "give one like Tube(0.48, 15)")
    return tube


def cylinder_lambda1(lambda2: float, c0: float) -> float:
    """Surface tension of the straight cylinder, ``1/4 - lambda2 - c0^2`` (paper, eq. (socon) at r = 1)."""
    return 0.25 - lambda2 - c0**2


def cylinder_force(lambda2: float, c0: float) -> float:
    """Axial force on the straight cylinder, ``dE/dL = pi (1 - lambda2 - 2 c0)`` (``docs/theory/model.md``)."""
    return math.pi * (1 - lambda2 - 2 * c0)


def cylinder_energy(c0: float) -> float:
    """Normalised energy ``E/A`` of the straight cylinder, ``(1/2 - c0)^2``."""
    return (0.5 - c0) ** 2
