"""What the flow's driver asks of a surface, however it is discretized.

The flow is ``V_t = G``: the normal velocity is minus the variation of ``F = E + lambda1 (A - A0) + lambda2 (V - V0)`` (paper,
eq. (hflow)). A discrete surface has finitely many coordinates ``q``, an energy that is an explicit function of them, and a
metric; its flow is ``M(q) q_t = -grad F(q)``, ``c(q) = c(q(0))``. Area, volume and energy are divided by the area ``2 pi L`` of
the straight tube, so that the multipliers are those of the branches and ``-G`` is the gradient without any factor: growth
rates of the flow near an equilibrium are those of ``pearlbvp.stability``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import Field
from typing import Any, ClassVar, Literal, NamedTuple, Protocol, get_args

from pearlbvp.arrays import Array
from pearlbvp.helfrich import choice

Law = Literal["area and volume", "area", "diffusion"]
"""What the flow keeps: area and volume; the area alone, at given pressure difference; or both in the ``H^-1`` flow
``V_t = -Lap G``, which keeps the volume by itself (paper, §6). Graphs do so exactly; of tubes and meshes a multiplier sees to
it, which is that of the equilibria."""


def check_law(law: str) -> None:
    """Refuse what is no law.

    Raises:
        InputError: which to choose.
    """
    choice("law", law, get_args(Law))


class Trouble(NamedTuple):
    """Why a surface can no longer be described.

    Attributes:
        kind: ``pinch`` or ``overhang``.
        place: where, a ``Sentence`` with its lengths.
        advice: what to do about it.
    """

    kind: Literal["pinch", "overhang"]
    place: str
    advice: str


class FlowProblem(Protocol):
    """A semi-discrete gradient flow, a frozen dataclass.

    Lengths are in radii, ``N`` is the number of coordinates, ``k`` of constraints.
    """

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    @property
    def law(self) -> Law:
        """What the flow keeps."""

    @property
    def c0(self) -> float:
        """Spontaneous curvature."""

    @property
    def length(self) -> float:
        """Axial period."""

    @property
    def space(self) -> str:
        """What shapes it can describe, for messages: stability is judged among them."""

    @property
    def creeps(self) -> bool:
        """Whether rigid motions are neutral only up to the discretization's error, so that shapes creep along them."""

    @property
    def wanted_resolution(self) -> float:
        """The ``resolution`` beyond which the surface is to be refined, unless a user says otherwise."""

    def residual(self, q: Array, rate: Array, multipliers: Array) -> Array:
        """The flow's equations, shape (N,): affine in ``rate`` and in the ``k`` multipliers, zero along the flow.

        Not finite where ``q`` describes no surface: the only way to have IDA reject a step.
        """

    def jacobian(self, q: Array, rate: Array, multipliers: Array, factor: float) -> Any:
        """The residual's derivative by ``q`` plus ``factor`` times that by ``rate``, shape (N, N), dense or sparse."""

    def metric(self, q: Array) -> Any:
        """The residual's derivative by ``rate``, shape (N, N), as ``jacobian`` has it."""

    def columns(self, q: Array) -> Array:
        """The residual's derivative by the multipliers, shape (N, k)."""

    def constraints(self, q: Array) -> Array:
        """What the flow keeps by multipliers (area, or area and volume), shape (k,); 1 and 1/2 on the straight tube."""

    def constraint_rows(self, q: Array) -> Array:
        """Their exact derivatives, shape (k, N)."""

    def moved_by(self, q: Array, speed: Array) -> Array:
        """The rate of the coordinates at which the surface moves along its outward normal at given speeds.

        ``speed`` has the shape that ``velocity`` returns: one value at each point of the surface that is sampled.
        """

    def velocity(self, q: Array, rate: Array) -> Array:
        """Outward normal velocity at sampled points, shape (points,)."""

    def places(self, q: Array) -> tuple[Array, Array | None]:
        """Axial positions of the sampled points, and polar angles about the tube's axis, None where all are the same."""

    def resistance(self, q: Array, force: Array) -> Array:
        """The rate that a force causes: solves ``d residual/d rate . x = force``, of shape (N,) or (N, s)."""

    def equilibrium(self, q: Array, multipliers: Array) -> tuple[Any, Array]:
        """The problem, and its multipliers, whose residual without a rate is ``-G`` itself: what Newton's method solves."""

    def kernels(self, q: Array, multipliers: Array) -> Array:
        """Rates of the rigid motions that this discretization has, shape (motions, N)."""

    def growth_rates(self, q: Array, multipliers: Array, count: int = 6) -> tuple[Array, Array]:
        """Largest growth rates at an equilibrium, rigid motions left out, and their vectors, shapes (count,), (N, count)."""

    def observables(self, q: Array, multipliers: Array) -> dict[str, float]:
        """``lambda1, lambda2, E, area, volume, v, amplitude, r_min, r_max, c0, L, M``.

        Area and volume are as ``constraints`` has them.
        """

    def trouble(self, q: Array) -> Trouble | None:
        """Why the surface can no longer be described, or None."""

    def resolution(self, q: Array) -> float:
        """Size of the finest details that are described: an estimate of the error in space."""

    def refined(self, q: Array) -> tuple[Any, Array] | None:
        """The same surface with more coordinates, or None where there are no more to be had."""

    def remeshed(self, q: Array) -> tuple[Any, Array] | None:
        """The surface in coordinates that fit it, where these no longer do; else None.

        Raises:
            InputError: there are none to be had; the message says why.
        """

    def surface(self, q: Array, along: int = 161, around: int = 49) -> Any:
        """What to draw: ``x, y, z``, each of shape (along, around), closed around, or a triangulated surface."""

    def to_tree(self) -> Mapping[str, Any]:
        """Everything as arrays, numbers and words, to be saved."""
