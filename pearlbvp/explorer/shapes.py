"""Shapes as a page takes them: what a surface is made of, in radii; the page makes the surface of it (``surfaces.js``).

Long lists are base64 of 32-bit floats, little-endian: seven digits, which are more than a screen has. What several shapes share
(the numbers of their modes, the triangles of their meshes) stands in a list of its own, once.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.flows.axisymmetric import GraphFlow
from pearlbvp.flows.problem import FlowProblem
from pearlbvp.flows.tube import TubeFlow
from pearlbvp.membrane import Grid, MembraneProblem
from pearlbvp.mesh.operators import gaussian_curvature, mean_curvature
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.shapes import TubeShapes

FEWEST, MOST, DENSITY = 160, 1600, 16
"""Steps of a profile's period, or around a section: at least, at most, and by length."""

PARTS = {"sigma": 0, "y": 1, "z": 2}
"""Numbers of a mode's parts."""


def packed(values: Array) -> str:
    """Numbers as base64 of 32-bit floats, row by row."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode()


def steps(problem: MembraneProblem, u: Array) -> int:
    """Of a period of an axisymmetric shape, or around a section."""
    if problem.drawn == "section":
        return FEWEST
    return min(MOST, max(FEWEST, math.ceil(DENSITY * problem.observables(u)["L"] / max(1, problem.repeats[0]))))


@dataclass(frozen=True)
class Shared:
    """Lists that several shapes have in common, each kept once.

    Attributes:
        lists: in the order of their numbers.
    """

    lists: list[list[int]] = field(default_factory=list)
    _places: dict[tuple[int, ...], int] = field(default_factory=dict, repr=False)

    def number(self, values: list[int]) -> int:
        """The number of a list, which is added where it is new."""
        key = tuple(values)
        if key not in self._places:
            self._places[key] = len(self.lists)
            self.lists.append(values)
        return self._places[key]


def shape_of(problem: MembraneProblem, u: Array, shared: Shared) -> dict[str, Any]:
    """A solution's shape.

    Args:
        problem: of any family of tubes.
        u: its unknown.
        shared: where lists go that others have, too.
    """
    own = problem.own_mesh(u)
    if own is not None:
        return _of_mesh(own, shared)
    if isinstance(problem, TubeShapes):
        length = problem.parameters(u).length
        return _of_modes(problem.known(u), length, problem.turns, shared)
    if problem.drawn in ("outline", "section"):
        length, samples = float(problem.observables(u)["L"]), steps(problem, u)
        columns = problem.curve(u, samples)
        shape = {name: packed(values) for name, values in columns.items()}
        periods = (len(columns["H"]) - 1) // samples if problem.drawn == "outline" else 1
        return {"kind": problem.drawn, "length": length, "periods": periods, **shape}
    x, y, z = cast(Grid, problem.to_draw(u))
    return {
        "kind": "grid",
        "length": float(x[-1, 0] - x[0, 0]),
        "rows": len(x),
        "points": packed(np.stack((x, y, z), -1)),
    }


def frame_of(problem: FlowProblem, q: Array, shared: Shared) -> dict[str, Any]:
    """A shape on the way of a flow; axisymmetric graphs are sums of waves, too."""
    if isinstance(problem, GraphFlow):
        return _of_modes(_waves_of(problem, q), problem.length, 0, shared)
    if isinstance(problem, TubeFlow):
        return _of_modes(problem.known(q), problem.length, 0, shared)
    return _of_mesh(cast(PeriodicMesh, problem.surface(q)), shared)


MOST_WAVES = 96
"""Waves of a graph's radius that are shown."""


def _waves_of(graph: GraphFlow, q: Array) -> dict[Mode, float]:
    """The radius of a graph as a sum of waves about ``x = 0``."""
    count = max(4 * MOST_WAVES, graph.points)
    wave = np.fft.rfft(np.sqrt(2 * graph.interpolated(q, np.arange(count) * graph.length / count))) / count
    wave[1:] *= 2
    cosines = {Mode("sigma", p): float(wave[p].real) for p in range(MOST_WAVES)}
    return cosines | {Mode("sigma", p, "sin"): float(-wave[p].imag) for p in range(1, MOST_WAVES)}


def mode_numbers(modes: Iterable[Mode]) -> list[int]:
    """Five numbers for each mode: part, waves along, whether sines along, waves around, whether sines around."""
    return [
        number
        for mode in modes
        for number in (PARTS[mode.part], mode.p, int(mode.along == "sin"), mode.b, int(mode.around == "sin"))
    ]


def _of_modes(known: Mapping[Mode, float], length: float, turns: int, shared: Shared) -> dict[str, Any]:
    """A sum of modes (``tube.modes``)."""
    return {
        "kind": "modes", "length": length, "kappa": 2 * math.pi * turns / length, "modes": shared.number(mode_numbers(known)),
        "values": packed(np.array(list(known.values()))),
    }  # fmt: skip


def _of_mesh(surface: PeriodicMesh, shared: Shared) -> dict[str, Any]:
    """A triangulated surface, with its curvatures."""
    corners = np.stack((surface.triangles, surface.wraps), axis=-1).ravel()
    return {
        "kind": "mesh", "length": surface.length, "corners": shared.number([int(number) for number in corners]),
        "vertices": packed(surface.vertices), "H": packed(mean_curvature(surface)), "K": packed(gaussian_curvature(surface)),
    }  # fmt: skip
