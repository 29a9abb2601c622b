"""What is held while stability is judged: area or tension, volume or pressure, length or axial force, area differences.

Equilibria are the same whatever is held. A reservoir acts on a shape by one number, so that only perturbations that change such
a number to first order notice: those of the shape's own symmetry, the same in all periods (``docs/theory/model.md``).

``F = E_0 + p . q`` with ``q = (A, V, M)`` and ``p = (c0^2 + lambda1, lambda2, -2 c0)``, ``E_0`` being the integral
of ``H^2``. What is fixed makes a row ``dq = 0``. A reservoir whose force depends on ``q`` adds its stiffness ``W dq^2``, of
rank one:

- an osmotic law, ``lambda2 = C - n/V``: ``W = n/V^2`` for the volume;
- area-difference elasticity, ``(pi alpha/A)(M - M0)^2``: ``W = 2 pi alpha/A`` for the integrated mean curvature.

A free length adds one perturbation. Each stretch is a similarity and a perturbation that keeps the length; under lengths times
``1 + e`` the ``q`` are multiplied by powers of it, ``d = (2, 3, 1)``, and ``E_0`` stays. So the second variation between ``e``
and other perturbations is ``sum of p d dq``, that of ``e`` alone ``sum of p d (d - 1) q``, and ``dq`` has ``d q e`` besides.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError
from pearlbvp.helfrich import finite
from pearlbvp.quantities import has_unit

DEGREES = np.array([2.0, 3.0, 1.0])
"""Powers of length of area, volume and integrated mean curvature."""


class Quantities(NamedTuple):
    """Area, volume and integrated mean curvature of a shape, as perturbations change them, all divided by ``unit``.

    Attributes:
        values: of the three, shape (3,).
        gradients: by the coordinates of perturbations, shape (3, N).
        coefficients: of the three in the Lagrangian, ``p``, shape (3,).
        unit: the second variation is divided by it, too.
    """

    values: Array
    gradients: Array
    coefficients: Array
    unit: float

    def stretched(self) -> tuple[Array, float, Quantities]:
        """With one coordinate more, ``e`` times the root of the area, for lengths times ``1 + e``.

        Returns:
            The second variation between that and the others, shape (N,), that of itself alone, and the quantities.
        """
        values, gradients, p, _ = self
        by_e = DEGREES / math.sqrt(values[0])
        alone = float(p * by_e * (DEGREES - 1) @ values) / math.sqrt(values[0])
        return p * by_e @ gradients, alone, self._replace(gradients=np.column_stack((gradients, by_e * values)))


def coefficients(lambda1: float, lambda2: float, c0: float) -> Array:
    """Of area, volume and integrated mean curvature in the Lagrangian, shape (3,)."""
    return np.array([c0**2 + lambda1, lambda2, -2 * c0])


class Stiffness(NamedTuple):
    """What a reservoir adds to the second variation: ``factor`` times the outer product of ``row``."""

    row: Array
    factor: float


@dataclass(frozen=True)
class Held:
    """What is held.

    Attributes:
        area: the area, else the tension is given.
        volume: the volume, else the pressure, or its law.
        length: the axial length, else the axial force is given.
        solute: of an osmotic law ``lambda2 = C - solute/V``, ``n RT/Vr`` by the energy ``2 kappa``; None without one.
        ade: modulus ``alpha`` of area-difference elasticity; None without any.

    Raises:
        InputError: a combination that there is not.
    """

    area: bool = True
    volume: bool = True
    length: bool = True
    solute: float | None = None
    ade: float | None = None

    def __post_init__(self) -> None:
        if self.solute is not None and not finite("osmotic", self.solute) > 0:
            raise InputError("fix", f"osmotic={self.solute:g} is no solute", "give an amount above 0")
        if self.ade is not None and not finite("ade", self.ade) > 0:
            raise InputError("fix", f"ade={self.ade:g} is no modulus", "give one above 0, or leave it out")
        if self.solute is not None and self.volume:
            raise InputError("fix", "volume and osmotic are both held", "give one of the two")
        if self.ade is not None and not self.area:
            raise InputError("fix", "ade goes by the area, which tension does not hold", "give area, or leave ade out")

    def __str__(self) -> str:
        words = ["area" if self.area else "tension"]
        words += ["volume" if self.volume else "pressure" if self.solute is None else f"osmotic={float(self.solute)!r}"]
        words += [] if self.length else ["force"]
        words += [] if self.ade is None else [f"ade={float(self.ade)!r}"]
        return ",".join(words)

    def rows(self, gradients: Array) -> list[Array]:
        """Of the gradients of area, volume and integrated mean curvature those whose changes are 0."""
        return [gradients[0]] * self.area + [gradients[1]] * self.volume

    def stiffnesses(self, quantities: Quantities) -> list[Stiffness]:
        """Of the reservoirs whose forces depend on what they exchange."""
        (area, volume, _), (_, by_volume, by_curvature), _, unit = quantities
        found = []
        if self.solute is not None:
            found.append(Stiffness(by_volume, self.solute / unit / volume**2))
        if self.ade is not None:
            found.append(Stiffness(by_curvature, 2 * math.pi * self.ade / area))
        return found

    def constrained(
        self, second: NDArray[np.inexact[Any]], quantities: Quantities
    ) -> tuple[list[Array], NDArray[np.inexact[Any]]]:
        """The second variation among perturbations of the shape's own symmetry, and the rows that they are orthogonal to.

        Where the length is free, there is one coordinate more, the last: ``e`` times the root of the area. How fast a tube
        changes its length is a matter of how mobile its ends are, which nothing here knows: all of its surface counts as moved
        by ``e``, with the mean square of a normal displacement of that size. No sign depends on that.

        Args:
            second: second variation of the Lagrangian, shape (N, N).
            quantities: of the shape.

        Returns:
            The rows, each of shape (N,), and the second variation, shape (N, N); N + 1 where the length is free.
        """
        if not self.length:
            both, alone, quantities = quantities.stretched()
            second = np.block([[second, both[:, None]], [both[None, :], alone]])
        for row, factor in self.stiffnesses(quantities):
            second = second + factor * np.outer(row, row)
        return self.rows(quantities.gradients), second

    @property
    def controls(self) -> tuple[str, ...]:
        """The columns that say what is set, at the area of the straight tube; empty where area or length are not.

        A growth rate among perturbations of the shape's own symmetry changes its sign where the one of these that varies
        along a branch turns, and nowhere else (J. H. Maddocks, Arch. Ration. Mech. Anal. 99 (1987) 301).
        """
        if not (self.area and self.length):
            return ()
        volume = "v" if self.volume else "lambda2" if self.solute is None else "osmolarity"
        return volume, "c0" if self.ade is None else "M0", "L"

    def observed(self, known: Mapping[str, float]) -> dict[str, float]:
        """What reservoirs with laws are set to at a shape.

        ``osmolarity``: ``C`` of the osmotic law, the osmotic pressure outside. ``M0``: of the area differences, where the
        membrane has no spontaneous curvature of its own, so that ``c0 = (pi alpha/A)(M0 - M)``.
        """
        found = {}
        if self.solute is not None:
            found["osmolarity"] = known["lambda2"] + self.solute / (math.pi * known["v"] * known["L"])
        if self.ade is not None:
            found["M0"] = known["M"] + 2 * known["L"] * known["c0"] / self.ade
        return found

    @property
    def walls(self) -> Mapping[str, tuple[float, str]]:
        """Where no outer solution is thin enough for the osmotic law."""
        if self.solute is None:
            return {}
        return {
            "osmolarity": (0.0, "beyond, the pressure inside is more than that of all the solute against pure water")
        }

    def check(self, known: Mapping[str, float]) -> None:
        """Refuse a shape that no reservoir holds.

        Raises:
            InputError: the pressure inside is more than that of all the solute.
        """
        if self.observed(known).get("osmolarity", 0.0) < 0:
            least = -known["lambda2"] * math.pi * known["v"] * known["L"]
            raise InputError(
                "fix",
                f"osmotic={self.solute:g} has no equilibrium here: against pure water the pressure "
                "would be below that of the tube",
                f"give more than {least:.4g}",
            )


AREA_AND_VOLUME = Held()

WORDS = {
    "area": "area", "tension": "area", "volume": "volume", "pressure": "volume", "osmotic": "volume", "length": "length",
    "force": "length", "ade": "ade",
}  # fmt: skip
"""What may be held, and what each is held of: one of each."""

WITH_NUMBER = {"osmotic": "solute", "ade": "ade"}

CHOICES = "area or tension, volume, pressure or osmotic=N, length or force, ade=ALPHA"


STIFFEST = 1e12
"""Largest number of ``osmotic`` and ``ade``: what is stiffer drowns the membrane's own stiffness in its rounding."""


def known_held(what: str | Held) -> Held:
    """What is held, as a text says: ``area,volume``, ``tension,osmotic=2.5``. What is not named stays: area, volume, length.

    Raises:
        InputError: it says something else, or two of a kind.
    """
    if isinstance(what, Held):
        return what
    if not isinstance(what, str):
        raise InputError("fix", f"{what!r} must be a text", "give one like 'area,volume'")
    named: dict[str, str] = {}
    values: dict[str, float] = {}
    for part in what.split(","):
        name, equals, number = (piece.strip() for piece in part.partition("="))
        kind = WORDS.get(name)
        if kind is None:
            raise InputError("fix", f"{name or part!r} is nothing that can be held", f"choose of {CHOICES}")
        if kind in named:
            if named[kind] == name:
                raise InputError("fix", f"{name} is given twice", "give it once")
            raise InputError("fix", f"{named[kind]} and {name} are both held", "give one of the two")
        named[kind] = name
        if name in WITH_NUMBER:
            if not equals:
                raise InputError("fix", f"{name} needs a number", f"give one like {name}=1")
            if has_unit(number):
                raise InputError(
                    "fix",
                    f"{name}={number} has a unit",
                    "convert it by the tube's, Units.of(radius, kappa).fix(text, L)",
                )
            values[WITH_NUMBER[name]] = finite(f"fix {name}", number)  # type: ignore[arg-type]
            if abs(values[WITH_NUMBER[name]]) > STIFFEST:
                stays = (
                    "the volume stays as it is, which is the default: leave it out"
                    if name == "osmotic"
                    else "give less"
                )
                raise InputError(
                    "fix", f"{name}={number.strip()} is beyond {STIFFEST:g}, where rounding would decide", stays
                )
        elif equals:
            column = {"tension": "lambda1", "pressure": "lambda2", "volume": "v", "length": "L"}.get(name, name)
            raise InputError(
                "fix",
                f"{name} takes no number, as every shape of a branch has its own",
                f"for the shape that has a given one stop there (until {column}={number})",
            )
    kept = {kind: named.get(kind, kind) == kind for kind in ("area", "volume", "length")}
    return Held(**kept, **values)  # type: ignore[arg-type]
