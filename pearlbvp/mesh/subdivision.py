"""Loop's subdivision surface of a periodic mesh, as matrices: where its quadrature points lie, and its derivatives there.

The limit surface is twice differentiable but at vertices of valence other than 6, where its curvature is square integrable:
the energy is finite on it and converges under minimisation (F. Cirak, M. Ortiz, P. Schröder, Int. J. Numer. Meth. Engng 47
(2000) 2039; for membranes F. Feng, W. S. Klug, J. Comput. Phys. 220 (2006) 394), which piecewise linear surfaces do not
promise. Where all valences are 6 it is the quartic box spline, with eigenvalues of fourth order in the mesh width.

A patch with corners of other valences is evaluated by subdividing it (C. Loop, Smooth subdivision surfaces based on
triangles, thesis, Utah 1987) until the point lies in a triangle whose corners have valence 6. The three points of the
degree-2 rule do so after two subdivisions, each in the middle of a triangle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from pearlbvp.arrays import Array, Integers
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.representation import brief

DERIVATIVES = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
"""Orders by ``v`` and ``w`` of the six fields: the point, both tangents, the three second derivatives."""

POINTS = 3
"""Quadrature points of a triangle."""


@dataclass(frozen=True)
class Patches:
    """Quadrature points of the limit surface as sums over control vertices.

    ``field_k = sum over j of weights[k, j] (X_j)`` plus ``offsets[k]`` along ``x``, over ``j`` from ``start[q]``.

    Attributes:
        start: where each point's terms begin, shape (Q + 1,).
        index: control vertices of the terms, shape (N,).
        weights: of the terms in each field, shape (6, N).
        offsets: along ``x``, from terms in other periods, shape (6, Q).
        weight: area in the parameter plane that each point stands for.
    """

    __repr__ = brief

    start: Integers
    index: Integers
    weights: Array
    offsets: Array
    weight: float

    @cached_property
    def most(self) -> int:
        """Terms of the point that has most of them."""
        return int(np.diff(self.start).max())

    @cached_property
    def _matrices(self) -> list[sparse.csr_matrix]:
        """Point and tangents by the control vertices."""
        shape = len(self.start) - 1, int(self.index.max()) + 1
        return [sparse.csr_matrix((weights, self.index, self.start), shape) for weights in self.weights[:3]]

    def tangents(self, vertices: Array) -> list[Array]:
        """The points and both tangents there, each of shape (Q, 3)."""
        fields = [np.asarray(matrix @ vertices) for matrix in self._matrices]
        for field, offsets in zip(fields, self.offsets, strict=False):
            field[:, 0] += offsets
        return fields


@dataclass(frozen=True)
class Topology:
    """What subdivision needs of a mesh; attributes as those of ``PeriodicMesh``."""

    __repr__ = brief

    count: int
    triangles: Integers
    wraps: Integers
    twin: Integers
    shift: Integers


def topology(mesh: PeriodicMesh) -> Topology:
    """That of a mesh."""
    return Topology(mesh.count, mesh.triangles, mesh.wraps, mesh.twin, mesh.shift)


def refined(old: Topology) -> tuple[Topology, sparse.csr_matrix, Array]:
    """One subdivision: topology, matrix of the new vertices by the old, and their shifts along ``x`` in periods.

    Triangle ``t`` becomes ``4 t + a`` at corner ``a`` and ``4 t + 3`` in the middle.
    """
    tail, head = old.triangles.ravel(), np.roll(old.triangles, -1, axis=1).ravel()
    half_edges = np.arange(len(tail))
    chosen = np.flatnonzero(half_edges < old.twin)  # one half-edge an edge
    edge = np.empty(len(tail), dtype=np.int64)
    edge[chosen] = np.arange(len(chosen))
    edge[old.twin[chosen]] = edge[chosen]
    # vertices: (1 - n beta) X_i + beta sum of the ring
    valence = np.bincount(tail, minlength=old.count)
    beta = _ring_weights(valence)
    # edges: 3/8 of the ends, 1/8 of the two vertices across, seen from the chosen half-edge's first vertex
    new = old.count + np.arange(len(chosen))
    after = lambda h: np.where(h % 3 == 2, h - 2, h + 1)  # noqa: E731
    left, right = after(after(chosen)), after(after(old.twin[chosen]))  # half-edges that start at the vertices across
    left_shift, right_shift = -old.shift[left], old.shift[after(old.twin[chosen])]
    rows = np.concatenate((np.arange(old.count), tail, new, new, new, new))
    columns = np.concatenate((np.arange(old.count), head, tail[chosen], head[chosen], tail[left], tail[right]))
    eighths = np.ones(len(chosen)) / 8
    values = np.concatenate((1 - valence * beta, beta[tail], 3 * eighths, 3 * eighths, eighths, eighths))
    zero = np.zeros(len(chosen))
    shifts = np.concatenate((np.zeros(old.count), old.shift, zero, old.shift[chosen], left_shift, right_shift))
    count = old.count + len(chosen)
    matrix = sparse.csr_matrix((values, (rows, columns)), shape=(count, old.count))
    offsets = np.bincount(rows, values * shifts, minlength=count)
    # triangles
    m = old.count + edge.reshape(-1, 3)  # middle of the edge from corner a to the next
    first = half_edges < old.twin
    m_wrap = np.where(first.reshape(-1, 3), old.wraps, np.roll(old.wraps, -1, axis=1))
    c, w = old.triangles, old.wraps
    fours = [[c[:, a], m[:, a], m[:, a - 1]] for a in range(3)] + [[m[:, 0], m[:, 1], m[:, 2]]]
    wraps = [[w[:, a], m_wrap[:, a], m_wrap[:, a - 1]] for a in range(3)] + [[m_wrap[:, 0], m_wrap[:, 1], m_wrap[:, 2]]]
    new_triangles = np.moveaxis(np.array(fours), (0, 1, 2), (1, 2, 0)).reshape(-1, 3)
    new_wraps = np.moveaxis(np.array(wraps), (0, 1, 2), (1, 2, 0)).reshape(-1, 3)
    new_shift = (np.roll(new_wraps, -1, axis=1) - new_wraps).ravel()
    fine = Topology(count, new_triangles, new_wraps, _twins(count, new_triangles, new_shift), new_shift)
    return fine, matrix, offsets.astype(np.float64)


def _twins(count: int, triangles: Integers, shift: Integers) -> Integers:
    tail, head = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    most = int(np.abs(shift).max()) + 1
    keys = (tail * count + head) * (2 * most + 1) + shift + most
    back = (head * count + tail) * (2 * most + 1) - shift + most
    order = np.argsort(keys)
    return np.asarray(order[np.searchsorted(keys[order], back)])


def _ring_weights(valence: Integers) -> Array:
    """Loop's ``beta``: the weight of each neighbour of a vertex in one subdivision, 1/16 at valence 6."""
    return np.asarray((0.625 - (0.375 + np.cos(2 * math.pi / valence) / 4) ** 2) / valence)


def subdivided(mesh: PeriodicMesh) -> tuple[PeriodicMesh, sparse.csr_matrix]:
    """Four triangles for one, of the same limit surface, and the new vertices' matrix by the old, shape (V', V)."""
    fine, matrix, offsets = refined(topology(mesh))
    vertices = matrix @ mesh.vertices
    vertices[:, 0] += mesh.length * offsets
    return PeriodicMesh(vertices, fine.triangles, fine.wraps, mesh.length), matrix


def _limit(mesh: Topology) -> tuple[sparse.csr_matrix, Array]:
    """Where subdivision takes each vertex: matrix by the vertices, shape (V, V), and shifts along ``x`` in periods."""
    tail, head = mesh.triangles.ravel(), np.roll(mesh.triangles, -1, axis=1).ravel()
    valence = np.bincount(tail, minlength=mesh.count)
    omega = 1 / (3 / (8 * _ring_weights(valence)) + valence)
    own = np.arange(mesh.count)
    rows, columns = np.concatenate((own, tail)), np.concatenate((own, head))
    values = np.concatenate((1 - valence * omega, omega[tail]))
    matrix = sparse.csr_matrix((values, (rows, columns)), shape=(mesh.count, mesh.count))
    return matrix, np.bincount(tail, omega[tail] * mesh.shift, minlength=mesh.count).astype(np.float64)


def limit_matrix(mesh: PeriodicMesh, levels: int = 0) -> tuple[Topology, sparse.csr_matrix, Array]:
    """Points of the limit surface at the vertices of a mesh subdivided some times.

    Returns:
        The subdivided mesh's topology, the points' matrix by the vertices, shape (M, V), and their shifts along ``x``.
    """
    fine, matrix, offsets = topology(mesh), sparse.eye(mesh.count, format="csr"), np.zeros(mesh.count)
    for _ in range(levels):
        fine, step, shifts = refined(fine)
        matrix, offsets = step @ matrix, shifts + step @ offsets
    last, shifts = _limit(fine)
    return fine, (last @ matrix).tocsr(), mesh.length * (shifts + last @ offsets)


Polynomial = dict[tuple[int, int, int], float]
"""In barycentric coordinates ``u, v, w``: coefficients by exponents."""

_CORNER: Polynomial = {
    (4, 0, 0): 6, (3, 0, 1): 24, (2, 0, 2): 24, (1, 0, 3): 8, (0, 0, 4): 1, (3, 1, 0): 24, (2, 1, 1): 60, (1, 1, 2): 36,
    (0, 1, 3): 6, (2, 2, 0): 24, (1, 2, 1): 36, (0, 2, 2): 12, (1, 3, 0): 8, (0, 3, 1): 6, (0, 4, 0): 1,
}  # fmt: skip
_ACROSS: Polynomial = {  # across the edge uv
    (4, 0, 0): 1, (3, 0, 1): 2, (3, 1, 0): 6, (2, 1, 1): 6, (2, 2, 0): 12, (1, 2, 1): 6, (1, 3, 0): 6, (0, 3, 1): 2,
    (0, 4, 0): 1,
}  # fmt: skip
_FAR: Polynomial = {(4, 0, 0): 1, (3, 1, 0): 2}  # beyond u, on the side of v


def _turned(polynomial: Polynomial, *order: int) -> Polynomial:
    """The polynomial with its coordinates in another order: entry ``a`` of ``order`` takes the place of ``a``."""
    turned = {}
    for exponents, value in polynomial.items():
        moved = [0, 0, 0]
        for a in range(3):
            moved[order[a]] = exponents[a]
        turned[moved[0], moved[1], moved[2]] = value
    return turned


def box_spline() -> list[Polynomial]:
    """The twelve quartics of a regular patch, times 12 (J. Stam, SIGGRAPH 1998), in the order of ``_patches``."""
    return [
        _CORNER, _turned(_CORNER, 1, 0, 2), _turned(_CORNER, 2, 1, 0),
        _turned(_ACROSS, 0, 2, 1), _turned(_FAR, 0, 2, 1), _FAR, _ACROSS,
        _turned(_FAR, 1, 0, 2), _turned(_FAR, 1, 2, 0), _turned(_ACROSS, 1, 2, 0),
        _turned(_FAR, 2, 1, 0), _turned(_FAR, 2, 0, 1),
    ]  # fmt: skip


def _derivative(polynomial: Polynomial, place: int) -> Polynomial:
    """By ``v`` (1) or ``w`` (2) at ``u = 1 - v - w``."""
    found: Polynomial = {}
    for exponents, value in polynomial.items():
        for which, sign in ((place, 1), (0, -1)):
            if exponents[which]:
                lower = list(exponents)
                lower[which] -= 1
                key = (lower[0], lower[1], lower[2])
                found[key] = found.get(key, 0) + sign * value * exponents[which]
    return found


def spline_values(point: tuple[float, float, float]) -> Array:
    """The twelve functions and their derivatives at a point, shape (6, 12)."""
    values = np.empty((len(DERIVATIVES), 12))
    for row, (by_v, by_w) in enumerate(DERIVATIVES):
        for column, polynomial in enumerate(box_spline()):
            for place in [1] * by_v + [2] * by_w:
                polynomial = _derivative(polynomial, place)
            powers = [
                value * math.prod(x**e for x, e in zip(point, es, strict=True)) for es, value in polynomial.items()
            ]
            values[row, column] = sum(powers) / 12
    return values


def _patches(mesh: Topology, chosen: Integers) -> tuple[Integers, Integers]:
    """The twelve vertices of regular triangles and their shifts in periods from the first corner, shape (K, 12)."""
    around = lambda h: mesh.twin[np.where(h % 3 == 0, h + 2, h - 1)]  # noqa: E731  the next half-edge counterclockwise
    head = np.roll(mesh.triangles, -1, axis=1).ravel()
    vertices, shifts = [], []
    base = np.zeros(len(chosen), dtype=np.int64)
    corners = [mesh.triangles[chosen, a] for a in range(3)]
    corner_shifts = [mesh.wraps[chosen, a] - mesh.wraps[chosen, 0] for a in range(3)]
    vertices += corners
    shifts += corner_shifts
    for a, kept in enumerate(((2, 3, 4, 5), (3, 4, 5), (3, 4))):
        half_edge = 3 * chosen + a
        for place in range(6):
            if place in kept:
                vertices.append(head[half_edge])
                shifts.append(base + corner_shifts[a] + mesh.shift[half_edge])
            half_edge = around(half_edge)
    return np.column_stack(vertices), np.column_stack(shifts)


def patches(mesh: PeriodicMesh) -> Patches:
    """Three quadrature points in each triangle of the limit surface (exact for quadratic integrands)."""
    first, coarse, coarse_offsets = refined(topology(mesh))
    fine, matrix, offsets = refined(first)
    offsets = offsets + matrix @ coarse_offsets
    matrix = (matrix @ coarse).tocsr()
    # the middle of the level-1 triangle at corner a is the middle of its own middle triangle
    triangles = np.arange(len(mesh.triangles))
    chosen = (4 * (4 * triangles[:, None] + np.arange(3)) + 3).ravel()
    vertices, shifts = _patches(fine, chosen)
    values = spline_values((1 / 3, 1 / 3, 1 / 3))
    start = np.arange(0, vertices.size + 1, 12)
    shape = (len(chosen), fine.count)
    weights, moved = [], []
    for row in values:
        # Products drop what happens to be 0; the imaginary part, positive everywhere, keeps one pattern for all fields.
        local = sparse.csr_matrix((np.tile(row + 1j, len(chosen)), vertices.ravel(), start), shape=shape)
        whole = (local @ matrix).tocsr()
        whole.sort_indices()
        weights.append(whole.data.real)
        moved.append(mesh.length * ((offsets[vertices] + shifts) @ row))
    return Patches(
        whole.indptr.astype(np.int64), whole.indices.astype(np.int64), np.array(weights), np.array(moved), 8 / POINTS
    )
