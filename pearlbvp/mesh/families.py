"""Families of meshes: structured tubes near the best quality, graded, jittered and edited ones, and meshes of given surfaces.

Order in the mesh width at which branch points of the straight tube converge (``c0 = 0``, ``L = 10``; pearls, coils and wrinkles
alike; ``tests/benchmarks/mesh.py`` has the errors from 1,000 to 12,000 vertices):

======================================================  ===========  =========
vertices                                                subdivision  cotangent
======================================================  ===========  =========
``tube_mesh``                                           4            2
``graded``, swept or not                                4            2
``jittered`` by a fixed share of an edge                none         2
``jittered`` by a share that falls as the edge          2            2
the same smoothed, vertices on the surface again        4            2
``edited``, a fixed share of valences other than 6      none         2
``edited`` once, then refined as a whole                2            2
======================================================  ===========  =========

Where there is none, the error stays: it is that of the surface's parametrization, the square of the jitter's share (7e-2 in
the pearl's ``lambda2`` at 0.1 of an edge, 4e-3 at 0.025, from 1,000 to 12,000 vertices), or of the share of valences other
than 6 (6e-3 to 6e-2 at a third). Smoothing (``adaptation.smoothed``) mends a jitter, provided that the vertices are put on the
smooth surface afterwards (``straightened``): on the rough mesh's own limit surface they move along rough normals, and 4e-4
stays. It does not mend valences.

Multipliers of the phase conditions (pearl A2, coil and buckle at ``v = 0.95``) are rounding on structured meshes, below 1e-13
at 3,000 vertices. On graded ones those of a subdivision surface are of fourth order, at 3,000 vertices 8e-6 on the coil and
8e-7 on the buckle, about as large as the error of ``lambda2``; those of cotangents are of second order, 1e-3. On meshes
jittered by a fixed share, or edited, those of a subdivision surface stay at about 1e-2.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from pearlbvp.arrays import Array, numeric
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube, finite, positive, whole
from pearlbvp.membrane import Surface
from pearlbvp.mesh.adaptation import AdaptOptions, adapted, measured
from pearlbvp.mesh.periodic import PeriodicMesh, known_mesh
from pearlbvp.mesh.samples import Samples
from pearlbvp.units import Sentence

MOST_NODES = 200_000
"""Vertices of a mesh beyond which memory runs out before an equilibrium is found."""

POOREST = 8.0
"""Quality of triangles that no mesh is made of: an equilateral one has 3.5, and the paper mends those worse than 8."""


def divisions(length: float, nodes: int, coil: tuple[int, int] | None = None) -> tuple[int, int]:
    """Rows along the tube (even, every other one shifted by half a node) and nodes in each, best in quality.

    The best triangles are equilateral: rows at ``sqrt(3)/2`` of the nodes' distance. Among pairs with a number of
    nodes within a tenth of the wanted one, that of the smallest ``e_M (e_1 + e_2 + e_3)/(2 |T|)`` (paper, eq. (mq)). For
    coils it is one that keeps some of their screws, where there is one.
    """
    best, chosen = (True, math.inf), (4, 4)
    for around in range(5, max(6, nodes // 4) + 1):
        for rows in {2 * round(nodes / around / 2 + step) for step in (-1, 0, 1)}:
            if rows < 4 or abs(rows * around / nodes - 1) > 0.1:
                continue
            # chords of the polygon; the slanted edge goes to the middle of the next row's gap
            base = 2 * math.sin(math.pi / around)
            slanted = math.sqrt((length / rows) ** 2 + (2 * math.sin(math.pi / around / 2)) ** 2)
            half = (base + 2 * slanted) / 2
            area = math.sqrt(half * (half - base) * (half - slanted) ** 2)
            quality = max(base, slanted) * 2 * half / (2 * area)
            if quality > POOREST:
                continue
            without = coil is not None and screws(rows, around, *coil) < ENOUGH_SCREWS
            score = without, quality + abs(rows * around / nodes - 1)  # of equally good ones the nearest in number
            if score < best:
                best, chosen = score, (rows, around)
    if best[1] == math.inf:
        text = f"{nodes} are too few for good triangles on a tube of length {{L:g}}"
        raise InputError("nodes", Sentence(text, L=length), f"give {fewest(length)} or more")
    return chosen


ENOUGH_SCREWS = 4
"""Screws in a mesh's symmetry that tell a coil from what has one or two waves along it."""


def screws(rows: int, around: int, m: int, n: int) -> int:
    """Number of the screws of a coil ``cos(m k x - n phi)``, ``k = 2 pi/L``, by some rows that map its mesh onto itself.

    ``p`` rows go with a turn by ``2 pi m p/(n rows)``: a whole number of nodes' distances, or for odd ``p`` half of one more.
    """
    p = np.arange(rows)
    halves, rest = np.divmod(2 * m * p * around, n * rows)
    return int(((rest == 0) & ((halves - p) % 2 == 0)).sum())


def fewest(length: float) -> int:
    """Nodes of a tube with the fewest rows (4) or nodes in each (5) and equilateral triangles, rounded upwards."""
    width = 2 * math.sin(math.pi / 5)
    rows = length / (math.sqrt(3) / 2 * width)
    around = 2 * math.pi / (length / 4 * 2 / math.sqrt(3))
    return math.ceil(1.2 * max(4, rows) * max(5, around))


def tube_mesh(
    length: float, nodes: int, surface: Surface | None = None, coil: tuple[int, int] | None = None
) -> PeriodicMesh:
    """A structured mesh of a tube with about ``nodes`` vertices: by default the straight tube of radius 1.

    Rows at ``x = const``, every other one turned by half a node: it has planes of reflection both ways.

    Args:
        length: the period.
        nodes: vertices wanted; the number taken is within a tenth of it.
        surface: points of other tubes by ``x`` and ``phi``.
        coil: waves along and around of a coil whose screws the mesh is to keep.

    Raises:
        InputError: too few nodes, a surface that gives no good mesh, or an argument that cannot be used.

    Examples:
        >>> mesh = tube_mesh(10, 500)
        >>> mesh.count, len(mesh.triangles), bool(mesh.quality.max() < 3.5)  # of equilateral ones 3.46
        (480, 960, True)
    """
    length, nodes = Tube(0.0, length).length, whole("nodes", nodes)
    if nodes < 20:
        raise InputError("nodes", f"{nodes} make no tube", "give 20 or more")
    if nodes > MOST_NODES:
        raise InputError("nodes", f"{nodes} are more than the {MOST_NODES} that fit in memory", "give fewer")
    rows, around = divisions(length, nodes, coil)
    j, i = np.divmod(np.arange(rows * around), around)
    x, phi = length * j / rows, 2 * np.pi * (i + 0.5 * (j % 2)) / around
    odd = j % 2
    right, up, up_left = j * around + (i + 1) % around, (j + 1) % rows * around, (i - 1 + odd) % around
    above, before = up + (i + odd) % around, up + up_left
    wrap = (j + 1 == rows).astype(np.int64)
    zero = np.zeros_like(wrap)
    here = np.arange(rows * around)
    # x to the right, phi upwards is clockwise seen from outside where phi runs from y to z: take phi first.
    triangles = np.concatenate((np.column_stack((here, above, right)), np.column_stack((here, before, above))))
    wraps = np.concatenate((np.column_stack((zero, wrap, zero)), np.column_stack((zero, wrap, wrap))))
    return PeriodicMesh(_on(surface or cylinder, x, phi), triangles[:, ::-1], wraps[:, ::-1], length)


def _on(surface: Surface, x: Array, phi: Array) -> Array:
    """Points of a surface that a user may have given, shape (K, 3).

    Raises:
        InputError: it is no function that returns such.
    """
    remedy = "give a function of x and phi, each of shape (K,), that returns x, y, z, of shape (K, 3)"
    if not callable(surface):
        raise InputError("surface", f"{type(surface).__name__} must be a function", remedy)
    points = numeric("surface", surface(x, phi))
    if points.shape != (len(x), 3):
        raise InputError("surface", f"it returns an array of shape {points.shape} for {len(x)} points", remedy)
    return points


def _parameters(mesh: PeriodicMesh) -> tuple[Array, Array]:
    """``x`` and ``phi`` of the vertices, shape (V,)."""
    vertices = known_mesh(mesh).vertices
    return vertices[:, 0], np.arctan2(vertices[:, 2], vertices[:, 1])


def cylinder(x: Array, phi: Array) -> Array:
    """Points of the straight tube, shape (K, 3)."""
    return np.column_stack((x, np.cos(phi), np.sin(phi)))


def jittered(mesh: PeriodicMesh, amount: float = 0.2, seed: int = 0, surface: Surface | None = None) -> PeriodicMesh:
    """The same triangles with vertices moved along the straight tube at random.

    Args:
        mesh: of the straight tube.
        amount: standard deviation in units of the mean edge; beyond about 0.25 triangles may fold over.
        seed: of the random numbers.
        surface: points of another tube, by the moved parameters.

    Raises:
        InputError: an argument that cannot be used, or triangles that fold over.

    Examples:
        >>> rough = jittered(tube_mesh(10, 500), 0.1)
        >>> bool(rough.quality.max() > 4), bool(abs(rough.length - 10) < 1e-12)
        (True, True)
    """
    x, phi = _parameters(mesh)
    rng = np.random.default_rng(whole("seed", seed, 0))
    size = finite("amount", amount) * mesh.edge_lengths.mean() * rng.standard_normal((mesh.count, 2)).clip(-2, 2)
    return replace(mesh, vertices=_on(surface or cylinder, x + size[:, 0], phi + size[:, 1]))


def graded(mesh: PeriodicMesh, ratio: float = 2.0, sweep: float = 0.0) -> PeriodicMesh:
    """The same triangles with vertices moved along the straight tube smoothly: crowded at ``x = L/2``, sparse at ``x = 0``.

    A smooth map of ``(x, phi)`` that does not depend on the mesh: as the mesh is refined, its triangles become those of a
    lattice, stretched. So do those that come from refining a tube's mesh as a whole.

    Args:
        mesh: of the straight tube.
        ratio: of the largest spacing along the tube to the smallest.
        sweep: largest angle by which sections are turned against each other, in radians; triangles become oblique.

    Raises:
        InputError: an argument that cannot be used, or triangles that become slivers.

    Examples:
        >>> mesh = graded(tube_mesh(10, 500), 3.0)
        >>> round(float(mesh.areas.max() / mesh.areas.min()), 1)
        3.0
    """
    x, phi = _parameters(mesh)
    ratio, sweep = positive("ratio", ratio), finite("sweep", sweep)
    k, most = 2 * math.pi / mesh.length, (ratio - 1) / (ratio + 1)
    return replace(mesh, vertices=cylinder(x + most * np.sin(k * x) / k, phi + sweep * np.sin(k * x)))


def edited(mesh: PeriodicMesh, options: AdaptOptions | None = None) -> PeriodicMesh:
    """The straight tube's mesh with triangles split, collapsed and flipped as on a branch: valences other than 6.

    Args:
        mesh: of the straight tube.
        options: when a triangle is changed; by default the paper's (Appendix B), by the mesh's mean area.

    Raises:
        InputError: an argument that cannot be used.

    Examples:
        >>> mesh = edited(graded(tube_mesh(10, 500), 3.0))
        >>> round(float((np.diff(mesh.star[0]) != 6).mean()), 1)  # the share of valences other than 6
        0.4
    """
    known_mesh(mesh)
    if not isinstance(options, AdaptOptions | None):
        raise InputError("options", f"{type(options).__name__} must be AdaptOptions", "leave them out for the paper's")
    options = measured(options or AdaptOptions(largest=1.3, worst=8.0), mesh)
    return straightened(adapted(mesh, Samples.of(mesh), options))


def straightened(mesh: PeriodicMesh) -> PeriodicMesh:
    """The same triangles with vertices moved radially onto the straight tube.

    Raises:
        InputError: it is no triangulated tube.

    Examples:
        >>> mesh = straightened(tube_mesh(10, 500, lambda x, phi: 1.1 * cylinder(x, phi)))
        >>> round(float(np.hypot(mesh.vertices[:, 1], mesh.vertices[:, 2]).max()), 12)
        1.0
    """
    return replace(mesh, vertices=cylinder(*_parameters(mesh)))


def mapped(mesh: PeriodicMesh, surface: Surface) -> PeriodicMesh:
    """The straight tube's triangles on another tube, vertices at the same parameters ``x`` and ``phi``.

    Raises:
        InputError: an argument that cannot be used, or a surface that gives no good mesh.

    Examples:
        >>> def bent(x, phi):
        ...     points = cylinder(x, phi)
        ...     points[:, 2] += 0.2 * np.cos(2 * np.pi * x / 10)
        ...     return points
        >>> mapped(graded(tube_mesh(10, 500)), bent).count
        480
    """
    return replace(mesh, vertices=_on(surface, *_parameters(mesh)))
