"""What every family of membrane tubes is to the rooms above: a problem whose solutions are surfaces of fixed area.

A family implements ``MembraneProblem`` and gets branches, stability, switching, files, tables and pictures.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, Literal, Self

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.problem import Problem
from pearlbvp.errors import InputError
from pearlbvp.force import with_force
from pearlbvp.held import Held
from pearlbvp.helfrich import Tube, WaveNumbers, finite

if TYPE_CHECKING:
    from pearlbvp.mesh.periodic import PeriodicMesh


Grid = tuple[Array, Array, Array]
"""``x, y, z`` of points along (rows) and around (columns) a tube, closed around."""

Surface = Callable[[Array, Array], Array]
"""Points of a surface, shape (K, 3), by two parameters: ``x``, from 0 to the length, and ``phi``, each of shape (K,)."""


class MembraneProblem(Problem):
    """Equilibria of tubes of one family: of fixed area, along which the volume varies, or a parameter of the model."""

    headline = ("c0", "L", "v")

    drawn: ClassVar[Literal["outline", "section", "surface"]] = "surface"
    """What of a shape tells most in a picture: its outline along the axis, its section across, or the whole of it."""

    may_vary: ClassVar[Mapping[str, str]] = {}
    """Columns that may vary along a branch, and what the unknowns call them."""

    why_fixed: ClassVar[str] = "{name} does not vary on this branch; follow another, from another tube"
    """Why one, ``{name}``, does not vary, and what to do instead."""

    rejoins: ClassVar[bool] = False
    """Whether the more symmetric branch that a branch meets at a pitchfork can be followed in its space, too."""

    centred: ClassVar[bool] = False
    """Whether shapes that branch off may be centred on a pearl or on a neck."""

    @property
    @abstractmethod
    def held(self) -> Held:
        """What is held while stability is judged."""

    def holding(self, held: Held) -> Self:
        """The same equilibria, judged by what else is held."""
        return self if held == self.held else replace(self, held=held)  # type: ignore[type-var]  # families are dataclasses

    def check_spectrum(self, u: Array) -> None:  # most families' growth rates are never refused beforehand
        """Refuse growth rates that would take too long, before anything is computed.

        Raises:
            SpectrumError: they would take too many modes.
        """

    @abstractmethod
    def largest_wave(self, u: Array) -> float:
        """``2 A`` of the largest wave over the straight tube (``projection``)."""

    @abstractmethod
    def to_draw(self, u: Array) -> Grid | PeriodicMesh:
        """The surface on the whole tube, to draw or to export."""

    def parametrized(self, u: Array) -> Surface:
        """Points of the surface by ``x`` and ``phi``.

        Raises:
            InputError: it has points of its own only.
        """
        raise InputError("point", "a shape on a mesh has points of its own only", "take those (own_mesh)")

    def own_mesh(self, u: Array) -> PeriodicMesh | None:
        """The surface's own triangles, where it has any."""
        return None

    @property
    def repeats(self) -> tuple[int, int]:
        """Equal periods along the tube, and folds around it: 0 where nothing varies that way."""
        return 1, 1

    @property
    def turns(self) -> int:
        """Of the frame in which sections repeat, along the tube: triangles that turn likewise fit the shape."""
        return 0

    def curve(self, u: Array, samples: int) -> dict[str, Array]:
        """Columns of the curve that a shape is made of.

        Args:
            u: a solution.
            samples: steps of a period, or around a section.

        Raises:
            InputError: it is made of no single curve.
        """
        raise InputError(
            "profile", f"a {self.family} is made of no single curve", "write its surface (surface=FILE.vtu, or .csv)"
        )

    def signed_amplitude(self, u: Array) -> float:
        """A number that changes its sign where the shapes become the straight tube; 1 of shapes that never do."""
        return 1.0

    def further(self, u: Array) -> dict[str, float]:
        """``wave``: ``2 A`` of the largest wave, not a number where the axis is not inside the surface."""
        return {"wave": self.largest_wave(u)}

    @property
    def varying(self) -> tuple[str, ...]:
        """Of what perturbations may keep (``v``, ``lambda2``, ``c0``, ``L``), what varies on the branch."""
        return ("lambda1", "lambda2", "v")

    @property
    def constant(self) -> Mapping[str, str]:
        """Of ``lambda1, lambda2, v, c0, L`` those that do not vary along the branch, and how they would."""
        instead = {
            "v": "keep lambda2 where it branches off (keep=lambda2), or stop at something else",
            "lambda2": "keep v where it branches off (keep=v), or stop at something else",
        }
        names = ("lambda1", "lambda2", "v", "c0", "L")
        otherwise = "vary it from a point of a saved branch"
        return {name: instead.get(name, otherwise) for name in names if name not in self.varying}

    @property
    def conserved(self) -> str:
        """The one thing that varies here of those that are set (``Held.controls``); empty where several do."""
        varying = {*self.varying, "osmolarity", "M0"}  # what laws are set to varies with all else
        found = [name for name in self.held.controls if name in varying]
        return found[0] if len(found) == 1 else ""

    @property
    def walls(self) -> Mapping[str, tuple[float, str]]:
        """No branch goes on where nothing holds it."""
        return self.held.walls

    def completed(self, observed: dict[str, float]) -> dict[str, float]:
        """Observables with the axial force, and with what reservoirs with laws are set to."""
        observed = with_force(observed)
        return observed | self.held.observed(observed)


def checked_tolerance(tolerance: float | None, usual: float) -> float:
    """An accuracy that was asked for, or the usual one.

    Raises:
        InputError: it is too fine for the arithmetic, or too coarse.
    """
    if tolerance is not None and not 1e-13 <= finite("tolerance", tolerance) <= 1e-3:
        raise InputError("tolerance", f"{tolerance:g} is not between 1e-13 and 1e-3", f"give one like {usual:g}")
    return usual if tolerance is None else tolerance


def repeated(surface: Grid, period: float, count: int) -> Grid:
    """A period of a tube, its end the image of its beginning, ``count`` times along the axis."""
    x, y, z = surface
    along = np.concatenate([x[: -1 if i + 1 < count else None] + i * period for i in range(count)])
    across = [np.concatenate([part[: -1 if i + 1 < count else None] for i in range(count)]) for part in (y, z)]
    return along, across[0], across[1]


AROUND = 256
"""Points of a section from which those between them are interpolated."""


def of_sections(section: Callable[[float], tuple[Array, Array]]) -> Surface:
    """A surface with plane sections, each a closed curve ``y, z`` of ``AROUND + 1`` points at equal distances in ``phi``."""

    def points(x: Array, phi: Array) -> Array:
        found = np.empty((len(x), 3))
        for place in np.unique(x):
            here = x == place
            y, z = section(float(place))
            wave = np.fft.fft(y[:-1] + 1j * z[:-1]) / (len(y) - 1)
            numbers = np.fft.fftfreq(len(wave), 1 / len(wave))
            curve = np.exp(1j * np.outer(phi[here], numbers)) @ wave
            found[here] = np.column_stack((np.full(here.sum(), place), curve.real, curve.imag))
        return found

    return points


Start = tuple[MembraneProblem, Array, Array]
"""A problem, its unknown at the straight tube, and the direction in which its shapes leave that."""


@dataclass(frozen=True)
class Family:
    """Shapes of one kind that leave the straight tube.

    Attributes:
        name: in a word, as users write it.
        mode: waves along and around the tube unless others are given.
        modes: which there are, for messages: ``m,0``.
        start: makes of the tube, the mode, what is held and an accuracy (None for the family's own) where its
            shapes leave the straight tube; raises ``InputError`` where they do not.
        problem: the class of its problems, to read them from files.
        accurate: whether it takes an accuracy.
    """

    name: str
    mode: WaveNumbers
    modes: str
    start: Callable[[Tube, WaveNumbers, Held, float | None], Start]
    problem: type[MembraneProblem]
    accurate: bool = False
