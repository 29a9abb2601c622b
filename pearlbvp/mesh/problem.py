"""Equilibria of triangulated tubes, as ``continuation`` takes them (``docs/theory/meshes.md``; paper, Appendix B).

Vertices move from a reference mesh along its normals, ``X_i = X0_i + u_i N_i``. The unknown holds ``u``, multipliers of
the phase conditions, then ``lambda1, lambda2, v``. Equations: the energy's gradient with all constraints' multipliers, the
phase conditions (the displacement contains no rigid motion), the area, the volume. Gradients and Hessians are exact
derivatives of one sum, so the Jacobian is symmetric; constraints stay outside the sparse factorization.

A displacement along normals cannot follow large motions with a good mesh: where the reference no longer fits, ``remesh``
takes the surface itself as the next reference, with triangles split, collapsed and flipped where they need it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from scipy import sparse

from pearlbvp.arrays import Array, Integers
from pearlbvp.bordered import Kept
from pearlbvp.continuation.path import PathEnd, correct_at
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.errors import SpectrumError
from pearlbvp.held import AREA_AND_VOLUME, Held, known_held
from pearlbvp.last import Last
from pearlbvp.membrane import MembraneProblem
from pearlbvp.mesh.adaptation import (
    AdaptOptions,
    adapted,
    is_stretched,
    measured,
    needs_adaptation,
    satisfied,
    spread_out,
)
from pearlbvp.mesh.amplitudes import largest_wave
from pearlbvp.mesh.crossing import crossing_triangles
from pearlbvp.mesh.functional import Functional, Kind, Sums
from pearlbvp.mesh.mesh_error import MeshError
from pearlbvp.mesh.operators import barycentric_mass, vertex_normals
from pearlbvp.mesh.periodic import PeriodicMesh
from pearlbvp.mesh.samples import Samples
from pearlbvp.mesh.sections import radii
from pearlbvp.mesh.spectrum import NEUTRAL, MeshBlock, Modes, independent, perturbations, smoothing
from pearlbvp.mesh.subdivision import subdivided
from pearlbvp.mesh.symmetry import mean, orbits
from pearlbvp.newton import NewtonOptions
from pearlbvp.representation import brief

RATES = 6
"""Growth rates of each block computed besides the positive ones."""

NEUTRAL_TOGETHER = 1e-4
"""Growth rates at a branch point that vanish together, up to how well it was located and its symmetry is kept."""

STRAIGHT = 1e-3
"""Differences of radii below which a surface is a straight tube, where equilibria of the same ``v`` are not isolated."""


@dataclass(frozen=True)
class MeshProblem(MembraneProblem):
    """Equilibria near a reference mesh: ``residual(u) = 0`` is a curve.

    Attributes:
        functional: energy, area and volume on the reference mesh.
        phases: rows that the displacement must be orthogonal to, shape (P, V).
        c0: spontaneous curvature.
        held: what is held while stability is judged.
        adapt: when and how the mesh is adapted.
        orbits: number of each vertex's orbit under the symmetry that the surface keeps, shape (V,); None without one.
    """

    __repr__ = brief

    stored_as: ClassVar[str] = "mesh"
    family = "mesh"
    block: ClassVar[Any] = MeshBlock
    why_fixed: ClassVar[str] = "a branch on a mesh keeps its {name}; follow one from the straight tube at another value"

    functional: Functional
    phases: Array
    c0: float
    held: Held = AREA_AND_VOLUME
    adapt: AdaptOptions = field(default_factory=AdaptOptions)
    orbits: Integers | None = None

    @property
    def length(self) -> float:
        """The period."""
        return self.mesh.length

    @property
    def mesh(self) -> PeriodicMesh:
        """The reference."""
        return self.functional.mesh

    @property
    def kind(self) -> Kind:
        """The discretization."""
        return self.functional.kind

    @property
    def directions(self) -> Array:
        """In which the vertices move, shape (V, 3)."""
        return self.functional.directions

    @property
    def pins(self) -> Integers:
        """Vertices held while a matrix is factorized."""
        return self.functional.pins

    def vertices(self, u: Array) -> Array:
        """The vertices displaced, shape (V, 3)."""
        return np.asarray(self.mesh.vertices + u[: self.mesh.count, None] * self.directions)

    def points(self, u: Array) -> Array:
        """Where the vertices lie on the surface, shape (V, 3)."""
        return self.functional.points(self.vertices(u))

    def surface(self, u: Array) -> PeriodicMesh:
        """The mesh on the surface, to draw and to write."""
        return self.mesh.moved(self.points(u))

    def multipliers(self, u: Array) -> Array:
        """Those of the phase conditions, shape (P,): 0 but for the discretization's error."""
        return u[self.mesh.count : -3]

    def residual(self, u: Array) -> Array:
        """The equations at ``u``, shape (V + P + 2,)."""
        (_, area, volume), (by_energy, by_area, by_volume), _ = self._sums(u)
        force = by_energy + u[-3] * by_area + u[-2] * by_volume + self.multipliers(u) @ self.phases
        misses = [area - 2 * math.pi * self.length, volume - math.pi * self.length * u[-1]]
        return np.concatenate((force, self.phases @ u[: self.mesh.count], misses))

    @cached_property
    def _sums(self) -> Last[Sums]:
        return Last(self._summed)

    def _summed(self, u: Array) -> Sums:
        return self.functional.sums(self.vertices(u), self.directions, self.c0)

    def hessian(self, u: Array) -> sparse.csc_matrix:
        """Second derivative of the energy and the multipliers' terms by the displacements, shape (V, V)."""
        return self.functional.hessian(self.vertices(u), self.directions, self.c0, u[-3], u[-2])

    def solve(self, u: Array, rhs: Array, row: Array | None = None) -> Array:
        """Bordered solve of the residual's Jacobian at ``u``; see ``Problem.solve``."""
        extra = np.zeros((0, u.size)) if row is None else np.atleast_2d(row) * self.weights
        count, phases = self.mesh.count, len(self.phases)
        _, by_area, by_volume = self._sums(u).gradients
        columns = np.vstack((self.phases, by_area, by_volume, np.zeros(count))).T
        rows = np.vstack((self.phases, by_area, by_volume, extra[:, :count]))
        corner = np.zeros((len(rows), phases + 3))
        corner[phases + 1, -1] = -math.pi * self.length
        corner[phases + 2 :] = extra[:, count:]
        load = rhs.reshape(u.size, -1)
        found = self._kept.solve(self.hessian(u), self.pins, (columns, rows, corner), load[:count], load[count:])
        if self.orbits is not None:  # rounding breaks the symmetry, and grows where a branch that breaks it is near
            found[:count] = mean(self.orbits, found[:count])
        return found.reshape(rhs.shape)

    @cached_property
    def _kept(self) -> Kept:
        return Kept()

    @cached_property
    def weights(self) -> Array:
        """Of the entries of ``u`` in the inner product: shares of the area, 1 for the parameters."""
        mass = barycentric_mass(self.mesh)
        return np.concatenate((mass / mass.sum(), np.ones(len(self.phases) + 3)))

    def inner(self, u: Array, v: Array) -> float:
        """Inner product: mean of the displacements' product and that of the parameters."""
        return float((u * self.weights) @ v)

    def observables(self, u: Array) -> dict[str, float]:
        """``lambda1, lambda2, v, E, amplitude, r_min, r_max, c0, L, M, force``; radii are from the sections' centres."""
        (energy, area, _), _, curvature = self._sums(u)
        thin, thick = radii(self.functional, self.vertices(u))
        observed = {
            "lambda1": float(u[-3]), "lambda2": float(u[-2]), "v": float(u[-1]), "E": float(energy / area),
            "amplitude": (thick - thin) / 2, "r_min": thin, "r_max": thick, "c0": self.c0, "L": self.length,
            "M": curvature,
        }  # fmt: skip
        return self.completed(observed)

    def largest_wave(self, u: Array) -> float:
        """``2 A`` of the largest wave (``projection``)."""
        return largest_wave(self.functional, self.vertices(u))

    @property
    def trivial_block(self) -> MeshBlock:
        """The block of the perturbations that keep the surface's symmetry."""
        return MeshBlock("all" if self.orbits is None else "symmetric")

    def limit(self, observed: Mapping[str, float], spectrum: Spectrum) -> str | None:
        """Perturbations that grow were missed."""
        if not spectrum.complete:
            raise SpectrumError("not all unstable perturbations were found; take a finer mesh")
        return None

    def clearance(self, u: Array) -> float:
        """Whether two triangles pass through each other."""
        return math.inf if crossing_triangles(self.surface(u)) is None else -math.inf

    def own_mesh(self, u: Array) -> PeriodicMesh:
        """The mesh on the surface."""
        return self.surface(u)

    to_draw = own_mesh

    def block_modes(self, u: Array, counts: Mapping[MeshBlock, int]) -> Modes:
        """Leading growth rates and their displacements, by symmetry blocks, and the number of positive rates.

        Args:
            u: the solution.
            counts: rates wanted of some blocks besides as many as are positive.
        """
        parameters = u[-3], u[-2], self.c0
        return perturbations(self.functional, self.vertices(u), parameters, self.held, counts, self.orbits)

    def modes(self, u: Array, count: int = RATES) -> tuple[Array, Array, int]:
        """Leading growth rates, their displacements as columns, shape (V, count), and the number of positive rates."""
        found = self.block_modes(u, dict.fromkeys(self._blocks, count))
        return (*found.together(), found.unstable)

    @property
    def _blocks(self) -> list[MeshBlock]:
        return [self.trivial_block] if self.orbits is None else [self.trivial_block, MeshBlock("breaking")]

    def spectrum(self, u: Array) -> Spectrum:
        """The leading growth rates, and whether all positive ones are among them."""
        modes = self.block_modes(u, dict.fromkeys(self._blocks, RATES))
        return Spectrum(
            modes.rates, modes.residual, NEUTRAL, modes.complete
        )  # the mesh moves neutral rates by far more

    def block_rates(self, u: Array, block: MeshBlock, like: Spectrum) -> Array:
        """The leading growth rates of a block, largest first."""
        return self.block_modes(u, {block: len(like.rates[block])}).rates[block]

    def remesh(self, u: Array, *others: Array) -> tuple[MeshProblem, list[Array]] | None:
        """The problem about the surface itself on an adapted mesh, where the reference no longer fits; else None."""
        count = self.mesh.count
        try:
            found = self.renewed(u, [vector[:count, None] * self.directions for vector in others])
        except MeshError as error:
            raise PathEnd(f"the triangles no longer describe the surface: {error.what}; take more of them") from None
        if found is None:
            return None
        mesh, fields, options = found
        problem, moved = about(self.functional.on(mesh), self.c0, u[-3:], held=self.held, adapt=options)
        rest = np.zeros(len(problem.phases))
        along = [np.einsum("ix,ix->i", moves, problem.directions) for moves in fields]
        vectors = [moved, *(np.concatenate((a, rest, b[-3:])) for a, b in zip(along, others, strict=True))]
        if self.orbits is not None:
            problem = problem.symmetric(*vectors)
        if not self._is_straight(u):  # there v does not tell one solution from the next: all straight tubes have v = 1
            settled, _ = correct_at(problem, moved, NewtonOptions(max_iterations=20, damping=4))
            # Along the branch, the new mesh's error would move the point; so it does only where v turns.
            if settled.converged:
                vectors[0] = settled.u
        return problem, vectors

    def _is_straight(self, u: Array) -> bool:
        """Whether the surface is a straight tube, to the mesh's error."""
        y, z = self.points(u)[:, 1:].T
        return float(np.ptp(np.hypot(y - y.mean(), z - z.mean()))) < STRAIGHT

    def renewed(self, u: Array, fields: Sequence[Array]) -> tuple[PeriodicMesh, list[Array], AdaptOptions] | None:
        """The surface at ``u`` as the next reference, on an adapted mesh where this one no longer fits; else None.

        Args:
            u: the surface.
            fields: displacements of the vertices, each of shape (V, 3).

        Returns:
            The mesh, the fields on it, and options that it satisfies.
        """
        surface, options = self.surface(u), measured(self.adapt, self.mesh)
        vertices = self.vertices(u)
        stretched, poor = is_stretched(surface, options), needs_adaptation(surface, options)
        tilt = np.einsum("ix,ix->i", vertex_normals(self.mesh.moved(vertices)), self.directions).min()
        if not stretched and not poor and tilt > options.steepest:
            return None
        moved = list(fields)
        if not stretched and not poor:  # the same surface on the same triangles: only the directions change
            mesh = self.mesh.moved(vertices)
        elif self.kind == "subdivision" and surface.areas.max() > options.largest * options.area:
            mesh, matrix = subdivided(self.mesh.moved(vertices))
            moved = [matrix @ field for field in fields]
        else:
            samples = self._samples(u)
            surface = spread_out(surface, samples, options.spreading)
            if self.kind == "cotangent" and needs_adaptation(surface, options):
                surface = adapted(surface, samples, options)
            mesh = surface.moved(self.functional.on(surface).vertices_near(surface.vertices))
            moved = [samples.field(surface.vertices, field) for field in fields]
        return mesh, moved, satisfied(options, mesh)

    def _samples(self, u: Array) -> Samples:
        """The surface at ``u``, to project onto."""
        mesh = self.mesh.moved(self.vertices(u))
        if self.kind == "cotangent":  # the smooth surface near the polyhedron
            mesh = mesh.moved(Functional(mesh).vertices_near(mesh.vertices))
        return Samples.of(mesh)

    def transfer(self, other: MeshProblem, u: Array) -> Array:
        """An unknown on another mesh, moved onto this one: displacements to its surface along this one's directions."""
        if other is self:
            return u
        points, vertices = self.functional.points(self.mesh.vertices), other.vertices(u)
        guess = np.zeros(self.mesh.count)
        if len(vertices) == self.mesh.count:  # much the same mesh: a good guess where the surface is far away
            guess = np.einsum("ix,ix->i", vertices - self.mesh.vertices, self.directions)
        along = other._samples(u).distance_along(points, self.directions, guess)
        if self.orbits is not None:
            along = mean(self.orbits, along)
        return np.concatenate((along, np.zeros(len(self.phases)), u[-3:]))

    def lift(self, block: MeshBlock, centre: str, *vectors: Array) -> tuple[MeshProblem, list[Array]]:
        """The problem with phase conditions that leave one neutral displacement of several.

        Where a symmetry breaks that shifts or turns the surface along itself, neutral displacements come in twos or fours,
        shifted and turned. The one that is largest in the middle of the period is left, the others become phase conditions,
        and the symmetry that it keeps is that of the problem.

        Args:
            block: of the neutral displacement; where it keeps the symmetry, there is nothing to do.
            centre: not used; the middle of the period is the centre.
            vectors: the solution at a branch point first, then others.
        """
        if block.name == "symmetric":
            return self, list(vectors)
        u, size = vectors[0], self.mesh.count + len(self.phases)
        modes = self.block_modes(u, {block: RATES})
        neutral = modes.vectors[block][:, np.abs(modes.rates[block]) < NEUTRAL_TOGETHER]
        at_centre = neutral[self._middle]
        if not at_centre.any():
            return replace(self, orbits=None), list(vectors)
        mass, _ = self.functional.normal_mass(self.vertices(u), self.directions)
        others = np.linalg.svd(at_centre[None])[2][1:]  # combinations that vanish there
        phases = np.vstack((self.phases, others @ (mass @ neutral).T))
        found = replace(self, phases=phases).symmetric(u, neutral @ at_centre)
        return found, [np.concatenate((v[:size], np.zeros(len(others)), v[-3:])) for v in vectors]

    def symmetric(self, u: Array, *others: Array) -> MeshProblem:
        """The problem in the space of all displacements with the symmetry of ``u`` and others on this mesh."""
        labels = orbits(self.mesh, np.array([vector[: self.mesh.count] for vector in (u, *others)]))
        return replace(self, orbits=labels if labels.max() + 1 < self.mesh.count else None)

    @property
    def _middle(self) -> int:
        """The vertex nearest to the middle of the period, at ``phi = 0``."""
        x, y = self.mesh.vertices[:, 0], self.mesh.vertices[:, 1]
        return int(np.argmin((x % self.length - self.length / 2) ** 2 + (y - y.max()) ** 2))

    def is_upper_half(self, direction: Array) -> bool:
        """Whether the tube grows at the vertex nearest to the middle of the period."""
        return bool(direction[self._middle] > 0)

    def to_tree(self) -> dict[str, Any]:
        """Everything as arrays, numbers and words, to be saved."""
        return self.mesh.to_tree() | self.adapt.to_tree() | {
            "phases": self.phases, "c0": self.c0, "kind": self.kind, "held": str(self.held)
        } | ({} if self.orbits is None else {"orbits": self.orbits})  # fmt: skip

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> MeshProblem:
        """The inverse of ``to_tree``."""
        mesh = PeriodicMesh(tree["vertices"], tree["triangles"], tree["wraps"], float(tree["length"]))
        phases, adapt = np.asarray(tree["phases"], dtype=float), AdaptOptions.from_tree(tree)
        labels = np.asarray(tree["orbits"], dtype=np.int64) if "orbits" in tree else None
        return cls(Functional(mesh, tree["kind"]), phases, float(tree["c0"]), known_held(tree["held"]), adapt, labels)


def about(functional: Functional, c0: float, parameters: Array, **others: Any) -> tuple[MeshProblem, Array]:
    """The problem about a mesh, with phase conditions against the rigid motions that move it, and its unknown there.

    Args:
        functional: on the reference.
        c0: spontaneous curvature.
        parameters: ``lambda1, lambda2, v``.
        others: further attributes of the problem.
    """
    problem = MeshProblem(functional, np.zeros((0, functional.mesh.count)), c0, **others)
    return with_phases(problem, np.concatenate((np.zeros(functional.mesh.count), parameters)))


def with_phases(problem: MeshProblem, u: Array, shape: Array | None = None) -> tuple[MeshProblem, Array]:
    """The problem with phase conditions against the rigid motions of the surface at ``shape`` (``u``), and ``u`` there."""
    at = u if shape is None else shape
    mass, motions = problem.functional.normal_mass(problem.vertices(at), problem.directions)
    rows, _ = independent(motions, smoothing(problem.hessian(at), mass, problem.pins), mass)
    found = replace(problem, phases=rows)
    return found, np.concatenate((u[: problem.mesh.count], np.zeros(len(rows)), u[-3:]))
