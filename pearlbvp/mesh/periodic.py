"""Triangulated surfaces that are periodic along ``x``, without a seam: every corner of a triangle knows its period.

A corner is a vertex and a whole number of periods by which it is shifted; edge vectors come from both. So no vertex is
doubled, no boundary exists, and nothing depends on where ``x = 0`` lies (compare paper, Appendix B, which cuts the tube).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from pearlbvp.arrays import Array, Integers
from pearlbvp.compiled import compiled
from pearlbvp.errors import InputError
from pearlbvp.mesh.mesh_error import MeshError
from pearlbvp.representation import brief

WORST = 100.0
"""Quality (eq. (mq)) beyond which a triangle is a sliver. Equilateral triangles have ``2 sqrt(3) = 3.46``."""


@dataclass(frozen=True, eq=False)
class Connectivity:
    """Which triangles share which edges, wherever the vertices lie: meshes that differ in vertices only share it.

    Attributes:
        triangles, wraps: as ``PeriodicMesh`` has them.
        count: number of vertices.
    """

    __repr__ = brief

    triangles: Integers
    wraps: Integers
    count: int

    @cached_property
    def tail(self) -> Integers:
        """First vertex of each half-edge, shape (3T,): half-edge ``3 t + a`` leads from corner ``a`` of ``t`` to the next."""
        return self.triangles.ravel()

    @cached_property
    def head(self) -> Integers:
        """Last vertex of each half-edge, shape (3T,)."""
        return np.ascontiguousarray(np.roll(self.triangles, -1, axis=1)).ravel()

    @cached_property
    def shift(self) -> Integers:
        """Periods between the ends of each half-edge, shape (3T,)."""
        return (np.roll(self.wraps, -1, axis=1) - self.wraps).ravel()

    def keys(self, tail: Integers, head: Integers, shift: Integers) -> Integers:
        """One number for each directed edge."""
        most = int(np.abs(self.shift).max()) + 1
        return (tail * self.count + head) * (2 * most + 1) + shift + most

    @cached_property
    def twin(self) -> Integers:
        """The half-edge that runs the other way, shape (3T,); -1 where there is none."""
        keys = self.keys(self.tail, self.head, self.shift)
        order = np.argsort(keys)
        back = self.keys(self.head, self.tail, -self.shift)
        place = np.minimum(np.searchsorted(keys[order], back), len(keys) - 1)
        return np.where(keys[order[place]] == back, order[place], -1)

    @cached_property
    def edges(self) -> Integers:
        """One half-edge for each edge, shape (E,)."""
        return np.flatnonzero(np.arange(len(self.twin)) < self.twin)

    @cached_property
    def star(self) -> tuple[Integers, Integers]:
        """Half-edges that leave each vertex, counterclockwise: where each vertex's begin, shape (V + 1,), and all, (3T,)."""
        start = np.concatenate(([0], np.cumsum(np.bincount(self.tail, minlength=self.count))))
        first = np.empty(self.count, dtype=np.int64)
        first[self.tail] = np.arange(len(self.tail))
        return start, _walk(start, first, self.twin)


@dataclass(frozen=True)
class PeriodicMesh:
    """A closed triangulated tube of one period.

    Attributes:
        vertices: shape (V, 3), axis along ``x``; any representative of a vertex modulo the period will do.
        triangles: vertices of the corners, shape (T, 3), counterclockwise seen from outside.
        wraps: periods by which each corner is shifted along ``x``, shape (T, 3).
        length: the period.
        known: how the triangles hang together, where a mesh that differs in vertices only has told it.

    Raises:
        InputError: it is no oriented manifold tube, or has slivers; the message names the first offending element.
    """

    __repr__ = brief

    vertices: Array
    triangles: Integers
    wraps: Integers
    length: float
    known: Connectivity | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        for name, kind in (("vertices", np.float64), ("triangles", np.int64), ("wraps", np.int64)):
            object.__setattr__(self, name, np.ascontiguousarray(getattr(self, name), dtype=kind))
        object.__setattr__(self, "length", float(self.length))
        known = self.known
        if known is None or known.triangles is not self.triangles or known.wraps is not self.wraps:
            object.__setattr__(self, "known", None)
            _check_arrays(self)
            _check_topology(self)
        _check_shape(self)

    @property
    def count(self) -> int:
        """Number of vertices."""
        return len(self.vertices)

    @cached_property
    def corners(self) -> Array:
        """Positions of the triangles' corners, shape (T, 3, 3)."""
        corners = self.vertices[self.triangles]
        corners[..., 0] += self.length * self.wraps
        return corners

    @cached_property
    def connected(self) -> Connectivity:
        """How the triangles hang together."""
        return self.known or Connectivity(self.triangles, self.wraps, self.count)

    @property
    def tail(self) -> Integers:
        """First vertex of each half-edge, shape (3T,): half-edge ``3 t + a`` leads from corner ``a`` of ``t`` to the next."""
        return self.connected.tail

    @property
    def head(self) -> Integers:
        """Last vertex of each half-edge, shape (3T,)."""
        return self.connected.head

    @property
    def shift(self) -> Integers:
        """Periods between the ends of each half-edge, shape (3T,)."""
        return self.connected.shift

    @property
    def twin(self) -> Integers:
        """The half-edge that runs the other way, shape (3T,); -1 where there is none."""
        return self.connected.twin

    @property
    def edges(self) -> Integers:
        """One half-edge for each edge, shape (E,)."""
        return self.connected.edges

    @property
    def star(self) -> tuple[Integers, Integers]:
        """Half-edges that leave each vertex, counterclockwise: where each vertex's begin, shape (V + 1,), and all, (3T,)."""
        return self.connected.star

    @cached_property
    def edge_vectors(self) -> Array:
        """Vector of each half-edge, shape (3T, 3)."""
        vectors = self.vertices[self.head] - self.vertices[self.tail]
        vectors[:, 0] += self.length * self.shift
        return vectors

    @cached_property
    def edge_lengths(self) -> Array:
        """Lengths of the edges from corner 0 to 1, 1 to 2 and 2 to 0 of each triangle, shape (T, 3)."""
        return np.sqrt(np.einsum("ix,ix->i", self.edge_vectors, self.edge_vectors)).reshape(-1, 3)

    @cached_property
    def area_vectors(self) -> Array:
        """Outward normal of each triangle times its area, shape (T, 3)."""
        edges = self.edge_vectors.reshape(-1, 3, 3)
        return 0.5 * np.cross(edges[:, 0], -edges[:, 2])

    @cached_property
    def areas(self) -> Array:
        """Areas of the triangles, shape (T,)."""
        return np.sqrt(np.einsum("ix,ix->i", self.area_vectors, self.area_vectors))

    @cached_property
    def quality(self) -> Array:
        """``e_M (e_1 + e_2 + e_3)/(2 |T|)`` of each triangle (paper, eq. (mq)), shape (T,); the best is ``2 sqrt(3)``."""
        one, two, three = self.edge_lengths.T  # by columns: sums along short rows take ten times as long
        with np.errstate(divide="ignore"):
            longest = np.maximum(np.maximum(one, two), three)
            return np.asarray(longest * (one + two + three) / (2 * self.areas))

    @property
    def area(self) -> float:
        """Area of the polyhedral surface, one period."""
        return float(self.areas.sum())

    @property
    def volume(self) -> float:
        """Volume inside one period: the flux of ``(0, y, z)/2``, which no end disc sees. Exact for the polyhedron."""
        return float(np.einsum("tax,tx->", self.corners[..., 1:], self.area_vectors[:, 1:]) / 6)

    def moved(self, vertices: Array) -> PeriodicMesh:
        """The same triangles on other vertices, checked for slivers and orientation only."""
        return PeriodicMesh(vertices, self.triangles, self.wraps, self.length, self.connected)

    def reduced(self) -> PeriodicMesh:
        """The same surface with every vertex in ``[0, L)``, and every triangle where its centroid lies there.

        So its ends are as smooth as the mesh allows: a row of vertices on both sides of ``x = 0`` is not torn apart.
        """
        periods = np.floor(self.vertices[:, 0] / self.length).astype(np.int64)
        centroids = np.floor(self.corners[..., 0].mean(axis=1) / self.length).astype(np.int64)
        vertices = self.vertices - np.outer(periods, [self.length, 0, 0])
        return replace(self, vertices=vertices, wraps=self.wraps + periods[self.triangles] - centroids[:, None])

    def to_tree(self) -> dict[str, Any]:
        """Everything as arrays and numbers, to be saved."""
        return {name: getattr(self, name) for name in ("vertices", "triangles", "wraps", "length")}


def _walk(start: Integers, first: Integers, twin: Integers) -> Integers:
    """Half-edges out of each vertex in order; -1 where a vertex's triangles are no single fan. All vertices at once."""
    order = np.full(len(twin), -1, dtype=np.int64)
    vertex = np.flatnonzero(np.diff(start))
    place, half_edge = start[vertex], first[vertex]
    while len(vertex):
        order[place] = half_edge
        half_edge = twin[np.where(half_edge % 3, half_edge - 1, half_edge + 2)]
        place = place + 1
        on = (place < start[vertex + 1]) & (half_edge != first[vertex])
        place, half_edge, vertex = place[on], half_edge[on], vertex[on]
    return order


@compiled
def _reach(start, order, head, shift, reached, periods, queue):  # type: ignore[no-untyped-def]
    """Fill in whether each vertex is reached from the first one, and how many periods a tree of edges leads to it."""
    reached[0], queue[0], last = True, 0, 1
    for place in range(queue.size):
        if place == last:
            break
        i = queue[place]
        for out in range(start[i], start[i + 1]):
            h = order[out]
            j = head[h]
            if not reached[j]:
                reached[j], periods[j], queue[last] = True, periods[i] + shift[h], j
                last += 1


def _ends(half_edge: int) -> tuple[int, int]:
    """A half-edge's ends as corners of its triangle."""
    return half_edge, half_edge + 1 if half_edge % 3 < 2 else half_edge - 2


def _first(wrong: Any) -> int | None:
    """Index of the first element that is wrong."""
    return int(np.argmax(wrong)) if wrong.any() else None


def _check_arrays(mesh: PeriodicMesh) -> None:
    vertices, triangles = mesh.vertices, mesh.triangles
    if vertices.ndim != 2 or vertices.shape[1] != 3 or len(vertices) == 0:
        raise InputError("vertices", f"shape {vertices.shape} is not (V, 3)", "give x, y, z of each vertex")
    if triangles.ndim != 2 or triangles.shape[1] != 3 or len(triangles) == 0 or mesh.wraps.shape != triangles.shape:
        what = f"shapes {triangles.shape} and {mesh.wraps.shape} of triangles and wraps are not both (T, 3)"
        raise InputError("triangles", what, "give three vertices and three wraps of each")
    if not (np.isfinite(mesh.length) and mesh.length > 0):
        raise InputError("length", f"the period {mesh.length:g} is not a positive number", "give the tube's period")
    if (i := _first(~np.isfinite(vertices).all(axis=1))) is not None:
        raise InputError("vertices", f"vertex {i} at {vertices[i]} is not finite", "give ordinary numbers")
    if (t := _first(((triangles < 0) | (triangles >= len(vertices))).any(axis=1))) is not None:
        raise InputError(
            "triangles",
            f"triangle {t} has corners {triangles[t]}, but there are {len(vertices)} vertices",
            "count them from 0",
        )
    used = np.bincount(triangles.ravel(), minlength=len(vertices))
    if (i := _first(used == 0)) is not None:
        raise InputError("vertices", f"vertex {i} belongs to no triangle", "leave it out")


def _check_topology(mesh: PeriodicMesh) -> None:
    triangles = mesh.triangles
    keys = mesh.connected.keys(mesh.tail, mesh.head, mesh.shift)
    _, place, number = np.unique(keys, return_index=True, return_counts=True)
    if (number > 1).any():
        doubled = int(place[number > 1].min())
        raise MeshError.at(
            (
                "triangles",
                "the edge from vertex {0} to {1} (triangle {triangle}) runs the same way in two triangles",
                "orient all triangles alike, with two at every edge",
            ),
            triangles,
            *_ends(doubled),
        )
    if (h := _first(mesh.twin < 0)) is not None:
        raise MeshError.at(
            (
                "triangles",
                "the edge from vertex {0} to {1} (triangle {triangle}) has no second triangle",
                "close the surface, and check that its ends match at the period",
            ),
            triangles,
            *_ends(h),
        )
    start, order = mesh.star
    if (gap := _first(order < 0)) is not None:
        i = int(np.searchsorted(start, gap, side="right")) - 1
        corner = int(np.argmax(mesh.tail == i))
        raise MeshError.at(
            ("triangles", "the triangles about vertex {0} are no single fan", "split the vertex"), triangles, corner
        )
    reached, (periods, queue) = np.zeros(mesh.count, dtype=bool), np.zeros((2, mesh.count), dtype=np.int64)
    _reach(start, order, mesh.head, mesh.shift, reached, periods, queue)
    if (away := _first(~reached[mesh.tail])) is not None:
        raise MeshError.at(
            ("vertices", "vertex {0} cannot be reached from vertex {1}", "give one tube"),
            triangles,
            away,
            int(np.argmax(reached[mesh.tail])),
        )
    # Periods by which loops of edges close: each is a sum of those that one edge makes with the tree.
    closing = int(np.gcd.reduce(mesh.shift - periods[mesh.head] + periods[mesh.tail]))
    if closing == 0:
        raise InputError(
            "wraps",
            f"no loop of the {len(mesh.edges)} edges leads into the next period, so the surface is closed",
            "give a tube",
        )
    if closing > 1:
        raise InputError(
            "length",
            f"the surface closes only after {closing} periods of {mesh.length:g}",
            f"give {closing * mesh.length:g}",
        )
    if (euler := mesh.count - len(mesh.edges) + len(triangles)) != 0:
        raise InputError(
            "triangles", f"the Euler characteristic is {euler}, that of a periodic tube is 0", "mesh one tube"
        )


def _check_shape(mesh: PeriodicMesh) -> None:
    spans = np.abs(mesh.edge_vectors[:, 0])
    if (h := _first(spans > 0.4 * mesh.length)) is not None:
        raise MeshError.at(
            (
                "length",
                f"the edge from vertex {{0}} to {{1}} spans {spans[h]:.3g} along x, too much of the period {mesh.length:g}",
                "give the period that the mesh was made for, or more vertices",
            ),
            mesh.triangles,
            *_ends(h),
        )
    if (t := _first(np.logical_not(mesh.quality < WORST))) is not None:
        raise MeshError.at(
            (
                "vertices",
                f"triangle {{triangle}} with corners {{0}}, {{1}}, {{2}} is a sliver of quality {mesh.quality[t]:.3g} (at most "
                f"{WORST:g}, 3.46 is best)",
                "improve the mesh there",
            ),
            mesh.triangles,
            *range(3 * t, 3 * t + 3),
        )
    if not mesh.volume > 0:
        raise InputError(
            "triangles", "triangle 0 and all others are seen clockwise from outside", "reverse their corners"
        )
