"""Symmetries of a mesh: the vertices that isometries of the tube carry into each other.

``x -> ±x + a, phi -> ±phi + b`` map a tube onto itself. Those that also map a mesh and displacements of it onto themselves
form a finite group. Displacements that keep the symmetry are constant on its orbits, so their mean over the orbits is all
that is needed of the group: the fixed-point space of ``docs/theory/symmetry_and_blocks.md``, on meshes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from pearlbvp.arrays import Array, Complex, Integers
from pearlbvp.mesh.periodic import PeriodicMesh

SAME = 1e-6
"""Distances, in mean edges, and differences, by the largest value, that are none."""

PROBES = 8
"""Vertices on which an isometry is tried before all others."""


def mean(orbits: Integers, values: Array) -> Array:
    """Mean of ``values``, shape (V, ...), over each orbit, at each of its vertices."""
    size = len(orbits)
    members = coo_matrix((np.ones(size), (orbits, np.arange(size)))).tocsr()
    sizes = np.bincount(orbits).reshape(-1, *([1] * (values.ndim - 1)))
    return np.asarray(((members @ values) / sizes)[orbits])


def orbits(mesh: PeriodicMesh, fields: Array) -> Integers:
    """Number of the orbit of each vertex, shape (V,), under all isometries that keep a mesh and displacements.

    One vertex, of which few are alike, is carried to itself and to all that are like it, in every way. What is found
    generates the group: a vertex in the orbit of the first need not be tried again.

    Args:
        mesh: any; without a symmetry every vertex is an orbit of its own.
        fields: displacements along the normals, shape (f, V).
    """
    group = _Candidates(mesh, fields / np.maximum(np.abs(fields).max(axis=1, keepdims=True), 1e-300))
    everything, probes = np.arange(mesh.count), np.linspace(0, mesh.count - 1, PROBES).astype(np.int64)
    first, alike = group.rarest()
    found, labels = [everything], everything
    for vertex in (first, *alike):
        if vertex != first and labels[vertex] == labels[first]:
            continue
        for signs in product((1, -1), (1, -1)):
            isometry = group.isometry(first, vertex, *signs)
            if (group.images(isometry, probes) >= 0).all():
                images = group.images(isometry, everything)
                if group.keeps(images):
                    found.append(images)
        labels = _connected(found)
    return labels


class _Isometry(NamedTuple):
    """``x -> along x + shift, y + i z -> turn (y + i around z)``."""

    along: int
    around: int
    shift: float
    turn: complex


@dataclass(frozen=True)
class _Candidates:
    """Isometries of the tube, and whether they keep a mesh and fields of largest value 1."""

    mesh: PeriodicMesh
    fields: Array

    @property
    def _axis(self) -> Array:
        return self.mesh.vertices[:, 0]

    @cached_property
    def _across(self) -> Complex:
        return self.mesh.vertices[:, 1] + 1j * self.mesh.vertices[:, 2]

    @cached_property
    def _near(self) -> float:
        return SAME * float(self.mesh.edge_lengths.mean())

    @cached_property
    def _tree(self) -> tuple[Any, Integers]:
        """Tree of the vertices of one period and of those just beyond its ends, and their numbers."""
        length = self.mesh.length
        places = self.mesh.vertices.copy()
        places[:, 0] %= length
        low, high = np.flatnonzero(places[:, 0] < 0.01 * length), np.flatnonzero(places[:, 0] > 0.99 * length)
        step = np.array([length, 0, 0])
        tree = cKDTree(np.concatenate((places, places[low] + step, places[high] - step)))
        return tree, np.concatenate((np.arange(self.mesh.count), low, high))

    @cached_property
    def _triangles(self) -> Integers:
        return _sorted(self.mesh.triangles)

    def rarest(self) -> tuple[int, Integers]:
        """A vertex off the axis of which the fewest others have its radius and values, and those."""
        radii = np.abs(self._across)
        marks = np.vstack((radii / self._near, self.fields / SAME)) / 10
        _, kind, number = np.unique(np.round(marks), axis=1, return_inverse=True, return_counts=True)
        first = int(np.argmin(np.where(radii > 0.1 * radii.max(), number[kind.ravel()], self.mesh.count)))
        close = np.abs(marks - marks[:, first : first + 1]).max(axis=0) < 1
        return first, np.flatnonzero(close & (np.arange(self.mesh.count) != first))

    def isometry(self, start: int, end: int, along: int, around: int) -> _Isometry:
        """That which carries one vertex to another, with given signs."""
        turn = self._across[end] / (self._across[start] if around == 1 else self._across[start].conj())
        return _Isometry(along, around, float(self._axis[end] - along * self._axis[start]), complex(turn / abs(turn)))

    def images(self, isometry: _Isometry, chosen: Integers) -> Integers:
        """The vertices that some are carried to; -1 where there is none."""
        along, around, shift, turn = isometry
        axis, across = along * self._axis[chosen] + shift, self._across[chosen]
        across = turn * (across if around == 1 else across.conj())
        tree, numbers = self._tree
        distance, found = tree.query(np.column_stack((axis % self.mesh.length, across.real, across.imag)))
        return np.where(distance < self._near, numbers[found], -1)

    def keeps(self, images: Integers) -> bool:
        """Whether an assignment of vertices is a symmetry of the triangles and of the fields."""
        if (images < 0).any() or np.abs(self.fields[:, images] - self.fields).max(initial=0) > SAME:
            return False
        return np.array_equal(_sorted(images[self.mesh.triangles]), self._triangles)


def _sorted(triangles: Integers) -> Integers:
    """Triangles in an order that depends on neither their own nor their corners'."""
    return np.unique(np.sort(triangles, axis=1), axis=0)


def _connected(links: list[Integers]) -> Integers:
    """Components of the graph in which every vertex is linked to its images."""
    count = len(links[0])
    tails, heads = np.tile(np.arange(count), len(links)), np.concatenate(links)
    graph = coo_matrix((np.ones(len(heads)), (tails, heads)), shape=(count, count))
    return connected_components(graph, directed=False)[1].astype(np.int64)
