"""Meshes adapted to a surface: triangles split by area, collapsed by quality, edges flipped, vertices spread out.

Source of the criteria: paper, Appendix B ("Mesh handling"): refinement where a triangle is larger than a multiple of those
of the straight tube, coarsening where its quality (eq. (mq)) is bad, small acute triangles along their shortest edge,
obtuse ones by a flip. There is no seam here, so nothing needs to be done twice at it. All points stay on the surface.

That is for the ``cotangent`` discretization, which converges on such meshes. Subdivision surfaces lose their order where many
valences are not 6, and even converge to something else where their share does not fall with the mesh width; but they
stand stretched triangles well. So they are refined as a whole, each triangle into four, which changes no valence and
nothing of the surface either.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

import numpy as np
from scipy import sparse

from pearlbvp.errors import InputError
from pearlbvp.factorization import factorized
from pearlbvp.helfrich import whole
from pearlbvp.mesh.edits import apart, collapsed, flipped, may_collapse, split
from pearlbvp.mesh.functional import Functional
from pearlbvp.mesh.operators import cotangents, vertex_normals
from pearlbvp.mesh.periodic import PeriodicMesh, known_mesh
from pearlbvp.mesh.samples import Samples


@dataclass(frozen=True)
class AdaptOptions:
    """When a mesh is adapted and how.

    Attributes:
        area: mean area of the straight tube's triangles; 0 takes that of the first mesh.
        largest: triangles larger than this many times ``area`` are split (the paper takes 1.3).
        stretched: quality beyond which vertices spread out along the surface, on the same triangles.
        worst: quality beyond which triangles are collapsed or flipped (the paper takes 8).
        smallest: triangles are collapsed only below this share of the largest one's area.
        rounds: of splits, collapses and flips at most.
        spreading: steps in which vertices spread out along the surface after all changes.
        most: vertices beyond which nothing is refined.
        steepest: cosine of the angle between directions and normals below which the surface becomes the reference.
    """

    area: float = 0.0
    largest: float = 2.5
    stretched: float = 4.0
    worst: float = 12.0
    smallest: float = 1 / 3
    rounds: int = 8
    spreading: int = 3
    most: int = 20000
    steepest: float = 0.95

    def to_tree(self) -> dict[str, Any]:
        """Everything as numbers, to be saved."""
        return {f"adapt_{name}": value for name, value in asdict(self).items()}

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> AdaptOptions:
        """The inverse of ``to_tree``."""
        found: dict[str, Any] = {f.name: tree[f"adapt_{f.name}"] for f in fields(cls)}
        return cls(**found)


def needs_adaptation(surface: PeriodicMesh, options: AdaptOptions) -> bool:
    """Whether triangles are too large or too bad."""
    return bool(surface.areas.max() > options.largest * options.area or surface.quality.max() > options.worst)


def is_stretched(surface: PeriodicMesh, options: AdaptOptions) -> bool:
    """Whether triangles are so stretched that vertices should spread out."""
    return bool(surface.quality.max() > options.stretched)


def adapted(surface: PeriodicMesh, samples: Samples, options: AdaptOptions) -> PeriodicMesh:
    """An adapted mesh of a surface; its vertices lie on the surface.

    Args:
        surface: a mesh with its vertices on the surface.
        samples: of the surface.
        options: how.
    """
    mesh = surface
    for _ in range(options.rounds):
        changed = _attempt(mesh, samples, _split_large, options)
        changed = _attempt(changed, samples, _collapse_small, options)
        changed = _attempt(changed, samples, _flip_obtuse, options)
        if changed is mesh:
            break
        mesh = changed
    return spread_out(mesh, samples, options.spreading)


def _attempt(mesh: PeriodicMesh, samples: Samples, edit: Any, options: AdaptOptions) -> PeriodicMesh:
    """The mesh edited, its vertices on the surface; as it was where that would leave no valid mesh."""
    try:
        edited = edit(mesh, options)
        if edited is mesh:
            return mesh
        edited = edited.moved(samples.project(edited.vertices))
        return spread_out(edited, samples, 1)
    except InputError:
        return mesh


def _split_large(mesh: PeriodicMesh, options: AdaptOptions) -> PeriodicMesh:
    large = np.flatnonzero(mesh.areas > options.largest * options.area)
    large = large[: max(0, options.most - mesh.count)]
    large = large[np.argsort(-mesh.areas[large])]
    half_edges = 3 * large + np.argmax(mesh.edge_lengths[large], axis=1)
    chosen = apart(mesh, half_edges, rings=False)
    return split(mesh, chosen) if len(chosen) else mesh


def _collapse_small(mesh: PeriodicMesh, options: AdaptOptions) -> PeriodicMesh:
    small = mesh.areas < options.smallest * mesh.areas.max()
    acute = (cotangents(mesh) >= 0).all(axis=1)
    bad = np.flatnonzero((mesh.quality > options.worst) & small & acute)
    bad = bad[np.argsort(-mesh.quality[bad])]
    half_edges = [h for h in 3 * bad + np.argmin(mesh.edge_lengths[bad], axis=1) if may_collapse(mesh, int(h))]
    chosen = apart(mesh, np.array(half_edges, dtype=np.int64), rings=True)
    return collapsed(mesh, chosen) if len(chosen) else mesh


def _flip_obtuse(mesh: PeriodicMesh, options: AdaptOptions) -> PeriodicMesh:
    """Edges flipped whose opposite angles exceed two right ones, by Delaunay's criterion; valences stay within 5 to 8."""
    edges = mesh.edges
    opposite = cotangents(mesh)[:, [2, 0, 1]].ravel()
    excess = opposite[edges] + opposite[mesh.twin[edges]]
    chosen = edges[excess < -0.05]
    chosen = chosen[np.argsort(excess[excess < -0.05])]
    valence = np.diff(mesh.star[0])
    across = [mesh.triangles.ravel()[_after_next(h)] for h in (chosen, mesh.twin[chosen])]
    good = (np.minimum(valence[mesh.tail[chosen]], valence[mesh.head[chosen]]) > 5) & (
        np.maximum(valence[across[0]], valence[across[1]]) < 8
    )
    chosen = apart(mesh, chosen[good], rings=True)
    return flipped(mesh, chosen) if len(chosen) else mesh


def _after_next(h: Any) -> Any:
    return np.where(h % 3 == 0, h + 2, h - 1)


def spread_out(mesh: PeriodicMesh, samples: Samples, steps: int) -> PeriodicMesh:
    """Vertices moved along the surface to where equal springs along all edges are at rest: smooth, all but equilateral.

    Each step solves for displacements in the tangent planes, two a vertex; the surface's curvature is left to the next.
    """
    edges = mesh.edges
    i, j = mesh.tail[edges], mesh.head[edges]
    ones = np.ones(len(edges))
    graph = sparse.coo_matrix(
        (np.concatenate((ones, ones, -ones, -ones)), (np.concatenate((i, j, i, j)), np.concatenate((i, j, j, i))))
    ).tocsr()
    size = 2 * mesh.count
    for _ in range(steps):
        normals = vertex_normals(mesh)
        across = np.cross(normals, np.eye(3)[np.argmin(np.abs(normals), axis=1)])
        across /= np.linalg.norm(across, axis=1)[:, None]
        bases = np.stack((across, np.cross(normals, across)))  # (2, V, 3)
        tangents = sparse.hstack(
            [sparse.vstack([sparse.diags(bases[a, :, x]) for x in range(3)]) for a in range(2)], format="csr"
        )
        springs = tangents.T @ sparse.block_diag([graph] * 3) @ tangents + SLIDING * sparse.eye(size)
        pulls = np.column_stack(
            [np.bincount(mesh.tail, mesh.edge_vectors[:, x], minlength=mesh.count) for x in range(3)]
        )
        moves = factorized(springs.tocsc()).solve(tangents.T @ pulls.T.ravel())
        try:
            mesh = mesh.moved(samples.project(mesh.vertices + (tangents @ moves).reshape(3, -1).T))
        except InputError:
            return mesh
    return mesh


def smoothed(mesh: PeriodicMesh, steps: int = 3) -> PeriodicMesh:
    """A rough mesh, read from a file say, with its vertices spread out along the surface: as subdivision surfaces need it.

    The surface is smooth and passes near the vertices, not the limit surface of the mesh, which lies inside.

    Args:
        mesh: its vertices on the surface.
        steps: in which vertices spread out, each by the surface's curvature better than the last.

    Raises:
        InputError: an argument that cannot be used.

    Examples:
        >>> from pearlbvp.mesh.families import jittered, tube_mesh
        >>> rough = jittered(tube_mesh(10, 500), 0.1)
        >>> bool(smoothed(rough).quality.max() < 4 < rough.quality.max())
        True
    """
    known_mesh(mesh)
    steps = whole("steps", steps, 0)
    return spread_out(mesh, Samples.of(mesh.moved(Functional(mesh).vertices_near(mesh.vertices))), steps)


SLIDING = 1e-3
"""Stiffness against the mesh sliding along the tube or turning about it as a whole, which no spring resists."""


def measured(options: AdaptOptions, mesh: PeriodicMesh) -> AdaptOptions:
    """The options with the mean area of a mesh, where they have none."""
    return options if options.area else replace(options, area=float(mesh.areas.mean()))


def satisfied(options: AdaptOptions, surface: PeriodicMesh) -> AdaptOptions:
    """Options that an adapted mesh satisfies, if need be by asking for less: else it would be adapted at every point."""
    quality = 1.2 * float(surface.quality.max())
    return replace(
        options,
        largest=max(options.largest, 1.1 * float(surface.areas.max()) / options.area),
        stretched=max(options.stretched, quality),
        worst=max(options.worst, quality),
    )
