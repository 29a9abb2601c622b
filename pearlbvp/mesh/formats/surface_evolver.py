"""Surface Evolver's datafile: a periodic tube with its Helfrich energy, of fixed area and volume. It is written, not read.

Syntax and methods are those of K. A. Brakke, *Surface Evolver Manual*, version 2.70 (2013): "Datafile format", "Torus domain",
"Named quantities and methods".
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from pearlbvp.mesh.periodic import PeriodicMesh

WRAPS = {-1: "-", 0: "*", 1: "+"}
"""How an edge says the periods that it crosses along an axis: no more than one, as ``PeriodicMesh`` refuses longer ones."""

HEAD = """\
// A membrane tube, one period along x, as pearlbvp wrote it: {vertices} vertices, {facets} facets.
// Energy: the integral of (H - c0)^2, H half the sum of the principal curvatures, +1/2 on the unit cylinder.
// Area and volume are held; their multipliers are tube_area.pressure and tube_volume.pressure.

torus
periods
{length!r} 0 0
0 {width!r} 0
0 0 {width!r}

parameter h_zero = {c0!r}

quantity bending energy method star_perp_sq_mean_curvature global
quantity tube_area fixed = {area!r} method facet_area global
// The divergence of (0, y/2, z/2) is 1, and it is the same in every period.
quantity tube_volume fixed = {volume!r} method facet_vector_integral global
  vector_integrand:
  q1: 0
  q2: y/2
  q3: z/2
"""


def evolver_text(mesh: PeriodicMesh, c0: float) -> str:
    """A datafile; the surface itself has no tension, so that ``bending`` is all of the energy.

    Args:
        mesh: one period, in any unit of length.
        c0: spontaneous curvature of ``(H - c0)^2``, by the same unit.
    """
    mesh = mesh.reduced()
    edges = mesh.edges
    numbers = np.zeros(
        len(mesh.tail), dtype=np.int64
    )  # of half-edges: their edge's, negative where that runs the other way
    numbers[edges] = np.arange(1, len(edges) + 1)
    numbers[mesh.twin[edges]] = -numbers[edges]
    width = 4 * float(np.abs(mesh.vertices[:, 1:]).max())  # no period across the tube is ever crossed
    head = HEAD.format(
        vertices=mesh.count, facets=len(mesh.triangles), length=float(mesh.length), width=width, c0=float(c0),
        area=float(mesh.area), volume=float(mesh.volume),
    )  # fmt: skip
    ends = zip(mesh.tail[edges] + 1, mesh.head[edges] + 1, mesh.shift[edges], strict=True)
    sections = (
        _section("vertices", (f"{x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist())),
        _section("edges", (f"{tail} {head} {WRAPS[shift]} * *" for tail, head, shift in ends)),
        _section("faces", (f"{a} {b} {c} tension 0" for a, b, c in numbers.reshape(-1, 3).tolist())),
    )
    return "\n".join((head, *sections))


def _section(name: str, lines: Iterable[str]) -> str:
    """Elements, counted from 1."""
    return "\n".join((name, *(f"{number} {line}" for number, line in enumerate(lines, start=1)), ""))
