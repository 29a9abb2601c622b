"""Flow of triangulated tubes: vertices move along the normals of a reference mesh, which is renewed on the way.

``X_i = X0_i + q_i N_i``. The energy is that of ``mesh.functional``, the metric the mean square of normal displacements on
the same surface: ``M(q) q_t = -grad F(q)``. Where the directions no longer fit, or triangles are stretched, the surface itself
becomes the next reference (``remeshed``); the flow restarts there. The same triangles with new directions, or each in four,
leave the surface as it is; vertices spread out anew are another discrete surface, whose energy differs by the error of the
discretization, up or down.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError
from pearlbvp.factorization import factorized
from pearlbvp.flows.problem import Law, Trouble, check_law
from pearlbvp.flows.spectrum import growth_rates
from pearlbvp.held import Held
from pearlbvp.last import Last
from pearlbvp.mesh.functional import Functional, Kind, Sums
from pearlbvp.mesh.operators import barycentric_mass, stiffness, vertex_normals
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.problem import MeshProblem
from pearlbvp.mesh.sections import distances, radii
from pearlbvp.mesh.spectrum import independent, smoothing
from pearlbvp.representation import brief
from pearlbvp.units import Sentence

UNRESOLVED = 0.45
"""Radius of a neck by the length of its longest edges at which a flow ends; at 0.4 a limit surface's control mesh closes."""

MOST_NODES = 4000
"""Vertices of an ``H^-1`` flow, whose matrices are dense."""


def mesh_flow(
    mesh: PeriodicMesh,
    c0: float,
    kind: Kind = "subdivision",
    law: Law = "area and volume",
    pressure: float = 0.0,
    functional: Functional | None = None,
    **others: Any,
) -> MeshFlow:
    """The flow from a mesh on, which is its reference; its vertices are those of the discretization (``vertices_near``).

    Args:
        mesh: the reference.
        c0: spontaneous curvature.
        kind: the discretization.
        law, pressure: what the flow keeps, and the pressure difference where that is the area alone.
        functional: that on the mesh, where there is one already.
        others: further attributes of the ``MeshProblem``.
    """
    on_mesh = Functional(mesh, kind) if functional is None else functional.on(mesh)
    reference = MeshProblem(on_mesh, np.zeros((0, mesh.count)), c0, Held(volume=law != "area"), **others)
    return MeshFlow(reference, law, pressure)


@dataclass(frozen=True, eq=False)
class _Shape:
    """What is computed of a shape when it is first asked for."""

    reference: MeshProblem
    q: Array

    @cached_property
    def sums(self) -> Sums:
        """Energy, area and volume with their gradients, and the mean curvature."""
        r = self.reference
        return r.functional.sums(r.vertices(self.q), r.directions, r.c0)

    @cached_property
    def mass(self) -> sparse.csc_matrix:
        """Mean products of normal displacements."""
        r = self.reference
        return r.functional.normal_mass(r.vertices(self.q), r.directions)[0]

    @cached_property
    def surface(self) -> PeriodicMesh:
        """The mesh with its vertices on the surface."""
        return self.reference.surface(self.q)

    @cached_property
    def normals(self) -> Array:
        """Of the surface at its vertices, shape (V, 3)."""
        return vertex_normals(self.surface)

    @cached_property
    def lifting(self) -> sparse.csc_matrix:
        """Normal displacements of the surface at its vertices, by displacements of the vertices, shape (V, V)."""
        matrix, directions = self.reference.functional.point_matrix, self.reference.directions
        parts = (sparse.diags(self.normals[:, x]) @ matrix @ sparse.diags(directions[:, x]) for x in range(3))
        return sum(parts).tocsc()

    @cached_property
    def _shares(self) -> Array:
        """Areas of the surface at its vertices."""
        return barycentric_mass(self.surface)

    @cached_property
    def _laplacian(self) -> Any:
        """The stiffness bordered by the mean, factorized."""
        a = self._shares[:, None]
        return splu(sparse.bmat([[stiffness(self.surface), a], [a.T, None]]).tocsc())

    def spread(self, rate: Array) -> Array:
        """The ``H^-1`` metric on rates, shape (V,) or (V, s): means of the potential ``g`` with ``-Lap g = V_t``.

        Linear finite elements on the surface, areas lumped. ``g`` has the mean of ``V_t``, which is 0 at fixed volume.
        """
        speeds = (self._shares * (self.lifting @ rate).T).T
        found = self._laplacian.solve(np.concatenate((speeds, np.zeros_like(speeds[:1]))))
        return np.asarray(self.lifting.T @ (self._shares * (found[:-1] + found[-1]).T).T)

    @cached_property
    def diffusion(self) -> Array:
        """That metric, shape (V, V)."""
        metric = self.spread(np.eye(len(self.q)))
        return (metric + metric.T) / 2


def check_nodes(law: Law, count: int) -> None:
    """Refuse meshes whose matrices would be too large.

    Raises:
        InputError: their vertices are too many for the law.
    """
    if law == "diffusion" and count > MOST_NODES:
        raise InputError(
            "nodes", f"the H^-1 flow of {count} vertices takes too large matrices", f"stay below {MOST_NODES}"
        )


@dataclass(frozen=True, eq=False)
class MeshFlow:
    """Triangulated tubes near a reference; ``q`` holds the displacements of its ``V`` vertices.

    Attributes:
        reference: its mesh, discretization, and how it is adapted.
        law: what the flow keeps: area and volume, in ``L^2`` or in ``H^-1``, or the area.
        pressure: the given ``lambda2`` where the law keeps the area alone.

    Raises:
        InputError: an argument that cannot be used.
    """

    __repr__ = brief

    reference: MeshProblem
    law: Law = "area and volume"
    pressure: float = 0.0

    def __post_init__(self) -> None:
        check_law(self.law)
        check_nodes(self.law, self.reference.mesh.count)

    @property
    def c0(self) -> float:
        """Spontaneous curvature."""
        return self.reference.c0

    @property
    def length(self) -> float:
        """The period."""
        return self.reference.length

    @property
    def unit(self) -> float:
        """Area of the straight tube, by which energy, area and volume are divided."""
        return 2 * math.pi * self.length

    @property
    def space(self) -> str:
        """What it describes."""
        return "triangulated tubes"

    def vertices(self, q: Array) -> Array:
        """The vertices displaced, shape (V, 3)."""
        return self.reference.vertices(q)

    def mesh(self, q: Array) -> PeriodicMesh:
        """The surface as a mesh with its vertices on it, to draw, to write, to go on from."""
        return self._at(q).surface

    @cached_property
    def _at(self) -> Last[_Shape]:
        return Last(partial(_Shape, self.reference))

    def _sums(self, q: Array) -> Sums:
        return self._at(q).sums

    def _unknown(self, q: Array, multipliers: Array) -> Array:
        """As ``MeshProblem`` has it; the volume is not used."""
        return np.concatenate((q, [multipliers[0], self._lambda2(multipliers), 0.0]))

    def _lambda2(self, multipliers: Array) -> float:
        return float(multipliers[1]) if self.law != "area" else self.pressure

    def residual(self, q: Array, rate: Array, multipliers: Array) -> Array:
        """``M q_t + grad F``."""
        try:
            self.reference.mesh.moved(self.vertices(q))
        except InputError:  # triangles that are none any more
            return np.full_like(q, np.nan)
        by_energy, by_area, by_volume = self._sums(q).gradients
        force = by_energy + multipliers[0] * by_area + self._lambda2(multipliers) * by_volume
        if self.law == "diffusion":
            return (force + self._at(q).spread(rate)) / self.unit
        return (
            force + self.reference.functional.mass_times(self.vertices(q), self.reference.directions, rate)
        ) / self.unit

    def _mass(self, q: Array) -> Any:
        return self._at(q).diffusion if self.law == "diffusion" else self._at(q).mass

    def metric(self, q: Array) -> Any:
        """``M``: mean products of normal displacements; dense in the ``H^-1`` flow, of their potentials' gradients."""
        return self._mass(q) / self.unit

    def jacobian(self, q: Array, rate: Array, multipliers: Array, factor: float) -> Any:
        """Second variation and ``factor`` times the metric, whose own change with the shape is left out.

        That change is of the size of the rate, beside a factor that is the inverse of the time step: it costs Newton's
        method a part of its order, not of its result.
        """
        second = self._second(q, multipliers)
        if self.law == "diffusion":
            return (second.toarray() + factor * self._mass(q)) / self.unit
        return ((second + factor * self._mass(q)) / self.unit).tocsc()

    def _second(self, q: Array, multipliers: Array) -> sparse.csc_matrix:
        """Second variation of ``F``."""
        r, lambda1, lambda2 = self.reference, float(multipliers[0]), self._lambda2(multipliers)
        return r.functional.hessian(self.vertices(q), r.directions, r.c0, lambda1, lambda2)

    def columns(self, q: Array) -> Array:
        """Gradients of what the flow keeps, as columns."""
        return np.ascontiguousarray(self.constraint_rows(q).T)

    def constraints(self, q: Array) -> Array:
        """Area, or area and volume, by the straight tube's area."""
        _, area, volume = self._sums(q).values / self.unit
        return np.array([area, volume] if self.law != "area" else [area])

    def constraint_rows(self, q: Array) -> Array:
        """Their derivatives."""
        return np.asarray(self._sums(q).gradients[1 : 2 if self.law == "area" else 3] / self.unit)

    def moved_by(self, q: Array, speed: Array) -> Array:
        """The rate at which the surface has given normal speeds at its vertices."""
        return np.asarray(splu(self._at(q).lifting).solve(speed))

    def velocity(self, q: Array, rate: Array) -> Array:
        """Outward normal velocity of the surface at its vertices."""
        moves = self.reference.functional.point_matrix @ (rate[:, None] * self.reference.directions)
        return np.einsum("ix,ix->i", self._at(q).normals, moves)

    def places(self, q: Array) -> tuple[Array, Array]:
        """``x`` of the vertices, and their polar angles about the axis."""
        points = self.reference.points(q)
        return points[:, 0], np.arctan2(points[:, 2], points[:, 1])

    def resistance(self, q: Array, force: Array) -> Array:
        """The metric's inverse on a force."""
        metric = self.metric(q)
        return np.asarray(
            np.linalg.solve(metric, force) if self.law == "diffusion" else factorized(metric).solve(force)
        )

    def equilibrium(self, q: Array, multipliers: Array) -> tuple[MeshFlow, Array]:
        """This problem, or instead of the ``H^-1`` flow the one in ``L^2``, whose matrices are sparse."""
        return (replace(self, law="area and volume") if self.law == "diffusion" else self), multipliers

    def kernels(self, q: Array, multipliers: Array) -> Array:
        """Rates of the rigid motions that move the surface along its normals.

        On a mesh a motion along the surface itself is all but none; the smooth part of what it moves tells.
        """
        r, vertices = self.reference, self.vertices(q)
        second = self._second(q, multipliers)
        mass, motions = r.functional.normal_mass(vertices, r.directions)
        return np.ascontiguousarray(independent(motions, smoothing(second, mass, r.pins), mass)[1].T)

    def growth_rates(self, q: Array, multipliers: Array, count: int = 6) -> tuple[Array, Array]:
        """Largest growth rates of all displacements of the vertices; see ``MeshProblem.modes``."""
        if self.law == "diffusion":
            second, motions = self._second(q, multipliers).toarray(), self.kernels(q, multipliers)
            return growth_rates(second / self.unit, self.metric(q), self.constraint_rows(q), motions, count)
        rates, vectors, _ = self.reference.modes(self._unknown(q, multipliers), count)
        return rates[:count], vectors[:, :count]

    def observables(self, q: Array, multipliers: Array) -> dict[str, float]:
        """Energy by area, multipliers, reduced volume; radii are measured from the sections' centres."""
        sums = self._sums(q)
        energy, area, volume = sums.values
        functional, vertices = self.reference.functional, self.vertices(q)
        thin, thick = radii(functional, vertices)
        return {
            "lambda1": float(multipliers[0]), "lambda2": self._lambda2(multipliers), "E": float(energy / area),
            "area": float(area / self.unit), "volume": float(volume / self.unit),
            "v": float(volume / (math.pi * self.length)), "amplitude": (thick - thin) / 2, "r_min": thin, "r_max": thick,
            "c0": self.reference.c0, "L": self.length, "M": sums.curvature,
        }  # fmt: skip

    def trouble(self, q: Array) -> Trouble | None:
        """A neck as thin as its triangles are long."""
        surface = self.mesh(q)
        radius = distances(surface)
        thin = int(radius.argmin())
        longest = float(np.linalg.norm(surface.edge_vectors[surface.tail == thin], axis=1).max())
        if radius[thin] < UNRESOLVED * longest:
            place = Sentence(
                "the neck at x = {x:.4g} (vertex {vertex}) has a radius of {r:.2g}, its edges are {edge:.2g} long",
                x=surface.vertices[thin, 0] % self.length, vertex=thin, r=radius[thin], edge=longest,
            )  # fmt: skip
            return Trouble("pinch", place, "stop before, change the volume, or give more nodes to follow it further")
        return None

    @property
    def creeps(self) -> bool:
        """A mesh has no continuous symmetry."""
        return True

    @property
    def wanted_resolution(self) -> float:
        """Meshes are renewed by ``remeshed`` alone."""
        return 1.0

    def resolution(self, q: Array) -> float:
        """Not estimated: triangles that are too large are split by ``remeshed``."""
        return 0.0

    def refined(self, q: Array) -> None:
        """See ``remeshed``."""

    def remeshed(self, q: Array) -> tuple[MeshFlow, Array] | None:
        """The flow about the surface itself, on an adapted mesh, where the reference no longer fits; else None.

        Raises:
            InputError: no mesh of the surface is to be had.
        """
        found = self.reference.renewed(self._unknown(q, np.zeros(2)), [])
        if found is None:
            return None
        mesh, _, options = found
        r = self.reference
        return mesh_flow(mesh, r.c0, r.kind, self.law, self.pressure, r.functional, adapt=options), np.zeros(mesh.count)

    def surface(self, q: Array, along: int = 161, around: int = 49) -> PeriodicMesh:
        """The mesh itself; it has the points that it has."""
        return self.mesh(q)

    def to_tree(self) -> dict[str, Any]:
        """Everything as arrays, numbers and words."""
        tree = self.reference.to_tree()
        return tree | {"kind": "mesh", "discretization": tree["kind"], "law": self.law, "pressure": self.pressure}

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> MeshFlow:
        """The inverse of ``to_tree``."""
        reference = MeshProblem.from_tree({**tree, "kind": str(tree["discretization"])})
        return cls(reference, str(tree["law"]), float(tree["pressure"]))  # type: ignore[arg-type]
