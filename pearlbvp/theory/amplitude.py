"""Amplitude equations of the branches that leave the straight cylinder, in closed form, for every mode and every ``c0``.

Waves ``u = eps [A e^{i(kx + n phi)} + B e^{i(kx - n phi)} + c.c.] + O(eps^2)`` on the cylinder ``r = 1 + u``, at fixed area
and ``lambda2 = lambda2_c + beta2 eps^2``, obey (paper, eq. (ampsys); time in units of ``eps^-2``)

    dA/dt = A (a beta2 + b1 |A|^2 + b2 |B|^2),     dB/dt = B (a beta2 + b2 |A|^2 + b1 |B|^2).

Coils have one of the two, buckles both alike; pearls (``n = 0``) and wrinkles (``k = 0``) have one wave and ``b = b1``. One
set of polynomials serves them all. They are derived from the energy to fourth order by ``tests/derivations/amplitude.py``
(the paper's Appendix A is the case ``n = 1``, but for its last term, where ``A02`` stands for ``A20``; in its pearling ``b``,
§4.2, ``3/20 k^14`` stands for ``3/20 + k^14``). ``kappa`` is ``k^2``, ``lambda2`` its critical value.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, cast, get_args

from pearlbvp.errors import InputError
from pearlbvp.helfrich import (
    Tube,
    WaveNumbers,
    choice,
    cylinder_energy,
    cylinder_lambda1,
    known_tube,
    mode_numbers,
)
from pearlbvp.theory.dispersion import critical_lambda2, growth_rate, mode_type, onset_lambda2, stable_interval
from pearlbvp.units import Sentence

Family = Literal["pearl", "ring", "coil", "buckle"]
FAMILIES: dict[str, tuple[Family, ...]] = {
    "pearling": ("pearl",),
    "wrinkling": ("ring",),
    "coiling/buckling": ("coil", "buckle"),
}


def linear(kappa: Any, n: Any) -> Any:
    """``a``: derivative of the growth rate by ``lambda2``."""
    return kappa + n**2 - 1


def tension(kappa: Any, n: Any, lambda2: Any) -> Any:
    """``alpha2``: ``lambda1 = lambda1_c - beta2 eps^2 + alpha2 eps^2 (|A|^2 + |B|^2)`` keeps the area."""
    return -(kappa**2) / 2 + kappa * (2 * lambda2 + n**2) + 3 * (n**2 - 1) ** 2 / 2


def direct1(kappa: Any, n: Any, c0: Any, lambda2: Any) -> Any:
    """``b1`` without the work of slaved waves, the mean radius ``A00 = -(kappa + n^2)(|A|^2 + |B|^2)`` included."""
    return (
        7 * kappa**3 / 2
        + kappa**2 * (-4 * c0 - 9 * lambda2 / 2 + 13 * n**2 / 2 - 0.25)
        + kappa * (-4 * c0 * n**2 - 5 * lambda2 * n**2 + 5 * n**4 / 2 + n**2 / 2 - 2.5)
        + lambda2 * (2 * n**2 - n**4 / 2)
        - n**6 / 2
        - 41 * n**4 / 4
        + 23 * n**2 / 2
        - 3
    )


def direct2(kappa: Any, n: Any, c0: Any, lambda2: Any) -> Any:
    """``b2`` without the work of slaved waves."""
    return (
        6 * kappa**3
        - kappa**2 * (8 * c0 + 6 * lambda2 + 2 * n**2 + 1)
        - kappa * (8 * c0 * n**2 + 6 * n**4 - 6 * n**2 + 2)
        + lambda2 * (4 * n**2 - 2 * n**4)
        + 2 * n**6
        - 27 * n**4
        + 26 * n**2
        - 6
    )


def force22(kappa: Any, n: Any, lambda2: Any) -> Any:
    """What ``A^2`` does to the wave ``(2k, 2n)``."""
    return (
        -9 * kappa**2 / 4
        + kappa * (3 * lambda2 / 2 + 9 * n**2 / 2 - 0.75)
        - 3 * lambda2 * n**2 / 2
        + 27 * n**4 / 4
        - 21 * n**2 / 4
        + 0.75
    )


def force20(kappa: Any, n: Any, c0: Any, lambda2: Any) -> Any:
    """What ``A B`` does to the wave ``(2k, 0)``."""
    return (
        -9 * kappa**2 / 2
        + kappa * (8 * c0 * n**2 + 3 * lambda2 + n**2 - 1.5)
        - lambda2 * n**2
        + 3 * n**4 / 2
        - 7 * n**2 / 2
        + 1.5
    )


def force02(kappa: Any, n: Any, c0: Any, lambda2: Any) -> Any:
    """What ``A B*`` does to the wave ``(0, 2n)``."""
    return (
        -(kappa**2) / 2
        + kappa * (8 * c0 * n**2 + lambda2 + n**2 - 0.5)
        - 3 * lambda2 * n**2
        + 27 * n**4 / 2
        - 21 * n**2 / 2
        + 1.5
    )


RESONANT = 1e-9
"""A slaved wave whose growth rate is smaller than this, by its own size, is critical too."""


@dataclass(frozen=True)
class AmplitudeEquation:
    """The reduced equation of one mode of a straight tube.

    Attributes:
        tube: the straight tube.
        m: waves along it.
        n: waves around it.

    Raises:
        InputError: on construction: the mode is no bifurcation, or a wave that it excites is critical at the same
            ``lambda2`` (of pearls ``theory.resonance`` has the equations of both, of coils ``theory.meeting``).
    """

    tube: Tube
    m: int
    n: int

    def __post_init__(self) -> None:
        onset_lambda2(self.tube, self.m, self.n)  # refuses a mode that branches off nowhere
        for m, n in ((2 * self.m, 2 * self.n), *(((2 * self.m, 0), (0, 2 * self.n)) if self.m and self.n else ())):
            size = (self.tube.wave_number(m) ** 2 + n**2) ** 2
            if abs(self._rate(m, n)) < RESONANT * (1 + size):
                text = (
                    f"({self.m},{self.n}) meets ({m},{n}), which it excites, at lambda2 = {{lambda2:.6g}} on L = {{L:g}}, "
                    "where its equation alone does not hold"
                )
                what = Sentence(text, lambda2=self.lambda2, L=self.tube.length)
                raise InputError("mode", what, "change c0 or the length a little")

    @cached_property
    def k(self) -> float:
        """Wave number along the tube."""
        return self.tube.wave_number(self.m)

    @cached_property
    def kappa(self) -> float:
        """``k^2``."""
        return self.k**2

    @cached_property
    def lambda2(self) -> float:
        """Where the mode is neutral."""
        return float(critical_lambda2(self.k, self.n, self.tube.c0))

    @property
    def lambda1(self) -> float:
        """The straight tube's tension there."""
        return cylinder_lambda1(self.lambda2, self.tube.c0)

    def _rate(self, m: int, n: int) -> float:
        return float(growth_rate(self.tube.wave_number(m), n, self.lambda2, self.tube.c0))

    @property
    def kind(self) -> str:
        """``pearling``, ``wrinkling`` or ``coiling/buckling``."""
        return mode_type(self.m, self.n)

    @property
    def families(self) -> tuple[Family, ...]:
        """The branches that leave the cylinder there."""
        return FAMILIES[self.kind]

    @property
    def a(self) -> float:
        """Derivative of the growth rate by ``lambda2``."""
        return float(linear(self.kappa, self.n))

    @property
    def alpha2(self) -> float:
        """Coefficient of ``|A|^2 + |B|^2`` in the change of ``lambda1``."""
        return float(tension(self.kappa, self.n, self.lambda2))

    @cached_property
    def slaved(self) -> dict[str, float]:
        """Amplitudes of the slaved waves, by the product of ``A`` and ``B`` that excites each.

        ``A00`` by ``|A|^2 + |B|^2``, ``A22`` by ``A^2``, ``A20`` by ``A B``, ``A02`` by ``A B*``.
        """
        found = {"A00": -self.kappa - self.n**2}
        found["A22"] = -self._force22 / self._rate(2 * self.m, 2 * self.n)
        if self.m and self.n:
            found["A20"] = -self._force20 / self._rate(2 * self.m, 0)
            found["A02"] = -self._force02 / self._rate(0, 2 * self.n)
        return found

    @property
    def _force22(self) -> float:
        return float(force22(self.kappa, self.n, self.lambda2))

    @property
    def _force20(self) -> float:
        return float(force20(self.kappa, self.n, self.tube.c0, self.lambda2))

    @property
    def _force02(self) -> float:
        return float(force02(self.kappa, self.n, self.tube.c0, self.lambda2))

    @cached_property
    def b1(self) -> float:
        """Cubic coefficient of a wave with itself; ``b`` of pearling and wrinkling."""
        direct = direct1(self.kappa, self.n, self.tube.c0, self.lambda2)
        return float(direct + 2 * self._force22 * self.slaved["A22"])

    @cached_property
    def b2(self) -> float:
        """Cubic coefficient of a wave with its mirror image.

        Raises:
            InputError: pearls and wrinkles are their own mirror images.
        """
        if not (self.m and self.n):
            what = f"({self.m},{self.n}) is {self.kind}, which has one wave and no b2"
            raise InputError("mode", what, "b1 is its coefficient")
        direct = direct2(self.kappa, self.n, self.tube.c0, self.lambda2)
        return float(direct + self._force20 * self.slaved["A20"] + self._force02 * self.slaved["A02"])

    def cubic(self, family: Family) -> float:
        """``b`` of a family: ``dA/dt = A (a beta2 + b A^2)`` along it."""
        self._check(family)
        return self.b1 + self.b2 if family == "buckle" else self.b1

    def _check(self, family: str) -> None:
        if family not in self.families:
            raise InputError(
                "family",
                f"{family} does not branch off at mode ({self.m},{self.n}), but {' and '.join(self.families)}",
                "give that, or another mode",
            )

    def supercritical(self, family: Family) -> bool:
        """Whether the branch exists where the cylinder is unstable to the mode (at given ``lambda2``)."""
        return self.cubic(family) < 0

    @property
    def preferred(self) -> Family:
        """The family that no wave of the mode itself destabilizes at fixed area and volume: coils iff ``b2 < b1``."""
        if len(self.families) == 1:
            return self.families[0]
        return "coil" if self.b2 < self.b1 else "buckle"

    @property
    def role(self) -> str:
        """``lower`` or ``upper`` where the mode ends the straight tube's stable interval, else empty."""
        interval = stable_interval(self.tube)
        ends = {interval.upper_mode: "upper"} | ({interval.lower_mode: "lower"} if interval.lower_mode else {})
        return ends.get((self.m, self.n), "") if interval.exists else ""

    @property
    def stable(self) -> str:
        """The family that is stable at its onset, at fixed area and volume; empty where the cylinder is unstable before."""
        return self.preferred if self.role else ""

    def own_rate(self, family: Family) -> float:
        """Growth rate by ``A^2`` of the mode's own perturbations at fixed area and volume, to leading order.

        ``b2 - b1`` on coils (twice), ``2 (b1 - b2)`` on buckles (once); 0 on pearls and rings, where there is none.
        """
        self._check(family)
        if len(self.families) == 1:
            return 0.0
        return self.b2 - self.b1 if family == "coil" else 2 * (self.b1 - self.b2)

    def at(self, family: Family, A: float) -> dict[str, float]:
        """The solution of amplitude ``A`` to leading order: ``lambda1, lambda2, v, E, amplitude, r_min, r_max, M``.

        ``E`` follows from ``-2 dE/dv = lambda2`` and is right to second order in ``v - 1``, and ``M`` from the energy's
        derivative by ``c0``, that of ``lambda2`` at the branch point being ``-2 k^2/(k^2 + n^2 - 1)``; radii are measured from
        the centre of each section, and ``amplitude`` is half their spread.
        """
        waves = 2 if family == "buckle" else 1
        by_square = -self.cubic(family) / self.a
        lambda2 = self.lambda2 + by_square * A**2
        v = 1 - 2 * self.a * waves * A**2
        share = self.k**2 / (self.k**2 + self.n**2 - 1)
        thin, thick = self._radii(family, A)
        return {
            "lambda1": self.lambda1 + (waves * self.alpha2 - by_square) * A**2,
            "lambda2": lambda2,
            "v": v,
            "E": cylinder_energy(self.tube.c0) - (self.lambda2 + lambda2) / 4 * (v - 1),
            "amplitude": (thick - thin) / 2,
            "r_min": thin,
            "r_max": thick,
            "M": math.pi * self.tube.L * (1 - share * (v - 1)),
        }

    def amplitude_at(self, family: Family, v: float) -> float:
        """The amplitude ``A`` at a reduced volume, to leading order; not a number on the side where the branch is not."""
        waves = 2 if family == "buckle" else 1
        square = (1 - v) / (2 * self.a * waves)
        return math.sqrt(square) if square >= 0 else math.nan

    def _radii(self, family: Family, A: float) -> tuple[float, float]:
        """Smallest and largest radius to second order, about the centres of the sections.

        Where ``n = 1`` the first order only shifts sections: a circle shifted by ``d`` has ``u = d cos(phi) - (d/2)^2 +
        (d/2)^2 cos(2 phi)`` about the old centre, and what is left is of second order. That of a buckle is bilinear in
        ``cos 2kx`` and ``cos 2 phi``: its extremes are at corners.
        """
        s, mean, square = self.slaved, 1 + self.slaved["A00"] * A**2, A**2
        if family == "buckle":
            mean += s["A00"] * square
            if self.n > 1:
                mean += (2 * s["A20"] + 2 * s["A02"] + 4 * s["A22"]) * square
                return mean - 4 * abs(A), mean + 4 * abs(A)
            corners = [
                2 * c * (1 + s["A20"]) + d * (2 * s["A02"] - 2 + c * (4 * s["A22"] - 2))
                for c in (1, -1)
                for d in (1, -1)
            ]
            return mean + (2 + min(corners)) * square, mean + (2 + max(corners)) * square
        if self.n == 1:
            oval = abs(2 * s["A22"] - 1)
            return mean + (1 - oval) * square, mean + (1 + oval) * square
        mean += 2 * s["A22"] * square
        return mean - 2 * abs(A), mean + 2 * abs(A)


def amplitude_equation(tube: Tube, mode: WaveNumbers) -> AmplitudeEquation:
    """The reduced equation of a mode ``(m, n)``.

    Raises:
        InputError: see ``AmplitudeEquation``.

    Examples:
        >>> equation = amplitude_equation(Tube(0.48, 10), (1, 1))
        >>> equation.families, equation.preferred  # of which one is stable at onset
        (('coil', 'buckle'), 'buckle')
    """
    known_tube(tube)
    m, n = mode_numbers("mode", mode, -math.inf)
    return AmplitudeEquation(tube, abs(m), abs(n))


def family_named(name: str) -> Family:
    """A family by its name.

    Raises:
        InputError: there is none of that name.
    """
    return cast(Family, choice("family", name, get_args(Family)))
