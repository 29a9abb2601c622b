"""Rings, the wrinkled tubes, as ``continuation`` takes them: plane elasticae under pressure by collocation.

A ring of ``n`` lobes is its half lobe (``shapes.lobe``; ``theory.elastica`` has its exact solution). Neither ``c0`` nor the
tube's length is in its equation: shapes do not depend on them, energy, tension and stability do.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from pearlbvp.arrays import Array
from pearlbvp.collocation import Collocated, Discretization, equidistribute, error_estimate, gauss_scheme, intervals_for
from pearlbvp.collocation.polynomial import all_points
from pearlbvp.continuation.problem import LiftError
from pearlbvp.continuation.spectrum import Spectrum
from pearlbvp.errors import InputError, SpectrumError
from pearlbvp.held import AREA_AND_VOLUME, Held, known_held
from pearlbvp.helfrich import Tube, WaveNumbers
from pearlbvp.membrane import AROUND, Family, Grid, MembraneProblem, Start, Surface, checked_tolerance, of_sections
from pearlbvp.projection import of_section
from pearlbvp.representation import brief
from pearlbvp.roots import root
from pearlbvp.shapes.lobe import HALF_LOBE
from pearlbvp.stability.planar import PlanarBlock, PlaneProfile, planar_rates, planar_spectrum
from pearlbvp.theory.elastica import lobes
from pearlbvp.tube.conversion import in_modes
from pearlbvp.tube.modes import Mode
from pearlbvp.tube.problem import TubeProblem
from pearlbvp.tube.symmetry import ODD_PHI, ring_symmetry
from pearlbvp.units import Sentence

FREE = ("a", "p", "v")

RESOLVED = 1e-4
"""Error of growth rates beyond which a branch ends rather than count wrongly."""


@dataclass(frozen=True)
class RingProblem(Collocated, MembraneProblem):
    """Rings of ``n`` lobes on a mesh, as ``continuation`` takes them: ``residual(u) = 0`` is a curve.

    Attributes:
        discretization: collocation of the half lobe.
        n: number of lobes.
        c0, length: the tube's.
        tolerance: estimated error of the profile at which ``remesh`` acts.
        held: what is held while stability is judged.
    """

    __repr__ = brief

    stored_as: ClassVar[str] = "ring"
    family = "ring"
    block: ClassVar[Any] = PlanarBlock
    why_fixed: ClassVar[str] = (
        "the shape of rings does not depend on {name}; for where it exchanges stability, see "
        "pearlbvp.studies.ring_onsets in Python"
    )
    drawn = "section"

    discretization: Discretization
    n: int
    c0: float
    length: float
    tolerance: float
    held: Held = AREA_AND_VOLUME

    @property
    def wavelength(self) -> float:
        """Length after which sections repeat: any."""
        return self.length

    @property
    def repeats(self) -> tuple[int, int]:
        """No periods, and the lobes."""
        return 0, self.n

    def profile(self, u: Array) -> PlaneProfile:
        """The section, for ``stability`` and pictures."""
        polynomial, scale = self.discretization.polynomial(u), self._scale
        return PlaneProfile(lambda sigma: polynomial(sigma) * scale, self.n, self.c0, *self._multipliers(u))

    @property
    def _scale(self) -> Array:
        """Factors that bring the states to the unit of the tube's radius."""
        return np.array([1.0, self.n / 2, (self.n / 2) ** 2])

    def _multipliers(self, u: Array) -> tuple[float, float]:
        """``lambda1, lambda2``."""
        return float(u[-3]) * self.n**2 / 8 - self.c0**2, float(u[-2]) * self.n**3 / 16

    def observables(self, u: Array) -> dict[str, float]:
        """``lambda1, lambda2, v, E, amplitude, r_min, r_max, c0, L, M, force, gap``; ``E`` is by area.

        ``M`` is ``pi L``, as ``2H`` turns the tangent of the section once. Radii are measured from the section's centre.
        ``gap`` is the width of the narrowest place between the two sides of a lobe: 0 where the ring touches itself.
        """
        d = self.discretization
        kappa = d.at_gauss_points(u)[:, 1] * self.n / 2
        tip, waist = self.profile(u).curve(np.array([0.0, 1.0]))
        radii = float(tip.real), float((waist * np.exp(-1j * math.pi / self.n)).real)
        lambda1, lambda2 = self._multipliers(u)
        observed = {
            "lambda1": lambda1,
            "lambda2": lambda2,
            "v": float(u[-1]),
            "E": float(d.gauss_weights @ (kappa / 2 - self.c0) ** 2),
            "amplitude": (max(radii) - min(radii)) / 2,
            "r_min": min(radii),
            "r_max": max(radii),
            "c0": self.c0,
            "L": self.length,
            "M": math.pi * self.length,
            "gap": self.gap(u),
        }
        return self.completed(observed)

    def gap(self, u: Array) -> float:
        """Width of the narrowest place between the two sides of a lobe; see ``theory.elastica.ElasticRing.gap``.

        It is twice the height of a side over the lobe's axis, where it runs parallel to that beyond its inflexion; at the
        inflexion where it turns back nowhere, and at the waist where there is neither.
        """
        d, profile = self.discretization, self.profile(u)
        points = all_points(d.mesh, d.scheme)
        psi, kappa, _ = d.values(u).T

        def crossing(column: int, level: float, last: int) -> float:
            """Where a state falls below a level, in the stretch that ends at a point."""

            def excess(t: float) -> float:
                return float(profile.states(np.array([t]))[0, column]) - level

            return root(excess, float(points[last - 1]), float(points[last]), 1e-15)

        place = 1.0
        if self.n > 2:  # for n = 2 the narrowest place is the waist, where psi is pi/2
            last = int(psi.argmax())
            back = np.flatnonzero(psi[last:] < math.pi / 2)
            if psi[last] > math.pi / 2 and len(back):
                place = crossing(0, math.pi / 2, last + int(back[0]))
            elif kappa[0] > 0 > kappa[-1]:
                place = crossing(1, 0.0, int(np.flatnonzero(kappa < 0)[0]))
        return 2 * float(profile.curve(np.array([place]))[0].imag)

    def remesh(self, u: Array, *others: Array) -> tuple[RingProblem, list[Array]] | None:
        """The problem on a mesh fitted to ``u``, with tangents moved there; None if the mesh will do."""
        d = self.discretization
        polynomial = d.polynomial(u)
        if float(error_estimate(polynomial).max()) <= self.tolerance:
            return None
        intervals = max(intervals_for(polynomial, self.tolerance / 10), len(d.h))
        mesh = equidistribute(polynomial, min(intervals, 2 * len(d.h) + 4))
        discretization, moved = d.on_mesh(mesh, u, *others)
        return replace(self, discretization=discretization), moved

    def transfer(self, other: RingProblem, u: Array) -> Array:
        """An unknown that lives on another problem's mesh, moved onto this one's."""
        if np.array_equal(other.discretization.mesh, self.discretization.mesh):
            return u
        _, (moved,) = other.discretization.on_mesh(self.discretization.mesh, u)
        return moved

    @property
    def trivial_block(self) -> PlanarBlock:
        """Perturbations that keep all symmetries of the ring."""
        return PlanarBlock(0, 0, self.n, "even")

    def spectrum(self, u: Array) -> Spectrum:
        """Growth rates of all perturbations that fit the tube."""
        return planar_spectrum(self.profile(u), self.length, held=self.held)

    def block_rates(self, u: Array, block: PlanarBlock, like: Spectrum) -> Array:
        """Growth rates in one block, largest first, without its exact kernels, on as many points as ``like``."""
        return planar_rates(self.profile(u), self.length, block, like.points, self.held)

    def outline(self, u: Array, points: int = 361) -> NDArray[np.complex128]:
        """The section as a closed curve in the complex plane about its centre, first point repeated at the end."""
        return self.profile(u).curve(np.linspace(0, 2 * self.n, points))

    def section(self, u: Array, x: float, points: int = 181) -> tuple[Array, Array]:
        """The cross-section at ``x`` (they are all alike) as a closed curve in the plane: ``y`` and ``z``."""
        curve = self.outline(u, points)
        return curve.real, curve.imag

    def largest_wave(self, u: Array) -> float:
        """``2 A`` of the largest wave (``projection``): the first of the lobes."""
        profile, points = self.profile(u), 256 * self.n
        sigma = (np.arange(points) + 0.5) * 2 * self.n / points  # a waist that touches the centre is none of them
        step = 1j * np.exp(1j * profile.at(sigma)[:, 0]) * 2 * math.pi / points
        return of_section(profile.curve(sigma), step).wave(0.0, (0, 4), fold=self.n)

    def to_draw(self, u: Array) -> Grid:
        """The cylinder over the section."""
        return self.profile(u).surface(self.length, along=max(2, round(4 * self.length)) + 1, around=97)

    def parametrized(self, u: Array) -> Surface:
        """Points by ``x`` and arclength around."""
        return of_sections(lambda x: self.section(u, x, AROUND + 1))

    def curve(self, u: Array, samples: int) -> dict[str, Array]:
        """The section, closed: ``y, z, psi`` (the tangent's angle), ``H``."""
        section, sigma = self.profile(u), np.linspace(0, 2 * self.n, samples + 1)
        points, (psi, kappa, _) = section.curve(sigma), section.at(sigma).T
        return {"y": points.real, "z": points.imag, "psi": psi, "H": kappa / 2}

    def clearance(self, u: Array) -> float:
        """The gap between the two sides of a lobe."""
        return self.gap(u)

    def limit(self, observed: Mapping[str, float], spectrum: Spectrum) -> str | None:
        """A spectrum that is not resolved."""
        if spectrum.residual > RESOLVED:
            text = "its spectrum is known to {rate:.0e} only; take a smaller tolerance"
            raise SpectrumError(Sentence(text, rate=spectrum.residual))
        return None

    def lift(self, block: PlanarBlock, centre: str, *vectors: Array) -> tuple[TubeProblem, list[Array]]:
        """Rings and their tangents in reduced modes, in the space of a block: of waves along the tube on the wrinkles.

        Args:
            block: of the ring's.
            centre: not used; blocks leave no choice.
            vectors: a ring, then its tangent.

        Raises:
            InputError: the ring's section is not star-shaped about its centre.
        """
        u, tangent = vectors
        problem, *moved = self.in_modes(u, tangent)
        number = problem.symmetry.block(block.j, block.c, ODD_PHI if block.parity == "odd" else 0)
        return problem.lift(number, centre, *moved)

    def in_modes(self, u: Array, tangent: Array) -> tuple[TubeProblem, Array, Array]:
        """A ring in reduced modes: problem, unknown and unit tangent of the branch of rings.

        Raises:
            InputError: its section is not star-shaped about its centre.
            LiftError: Newton's method finds none there.
        """

        def shape(step: float, count: int) -> tuple[dict[Mode, float], dict[str, float]]:
            moved = u + step * tangent
            (lambda1, lambda2), cosines = self._multipliers(moved), self.radius_cosines(moved, count)
            known = {Mode("sigma", 0, "cos", self.n * i): float(a) for i, a in enumerate(cosines)}
            return known, {"lambda1": lambda1, "lambda2": lambda2, "v": float(moved[-1])}

        try:
            return in_modes(TubeProblem(ring_symmetry(self.n), self.c0, self.length, (0, 8), held=self.held), shape)
        except ValueError as error:
            if isinstance(error, LiftError):
                raise
            raise InputError(
                "switch", f"at v = {u[-1]:.4f} the ring is not star-shaped about its centre, as tubes need it"
            ) from None

    def radius_cosines(self, u: Array, count: int) -> Array:
        """Fourier coefficients of the radius over the polar angle: ``r = sum of coefficient[b] cos(b n phi)``.

        Args:
            u: a solution.
            count: how many, shape (count,); at least 2.

        Raises:
            ValueError: the section is not star-shaped about its centre, where the radius is no function of the angle.
        """
        profile = self.profile(u)
        points = all_points(self.discretization.mesh, self.discretization.scheme)
        # The polar angle grows along the curve at the rate (kappa^2/2 - a)/(p r^2).
        if not (profile.at(points)[:, 1] ** 2 / 2 > profile.a).all():
            raise ValueError("section: it is not star-shaped about its centre; take a ring of larger volume")
        sums = 4 * max(count, 16)
        polar = math.pi / self.n * (np.arange(sums) + 0.5) / sums
        sigma = np.interp(polar, np.unwrap(np.angle(profile.curve(points))), points)
        for _ in range(30):
            z = profile.curve(sigma)
            rate = math.pi / self.n * (profile.at(sigma)[:, 1] ** 2 / 2 - profile.a) / (2 * profile.lambda2)
            step = (np.angle(z) - polar) * np.abs(z) ** 2 / rate
            sigma = np.clip(sigma - step, 0.0, 1.0)
            if np.abs(step).max() < 1e-14:
                break
        radius = np.abs(profile.curve(sigma))
        cosines = np.cos(self.n * np.outer(np.arange(count), polar))
        coefficients = 2 * cosines @ radius / sums
        coefficients[0] /= 2
        return np.asarray(coefficients)

    def to_tree(self) -> dict[str, Any]:
        """Everything as arrays, numbers and words, to be saved."""
        d = self.discretization
        return {
            "mesh": d.mesh, "degree": d.scheme.m, "n": self.n, "c0": self.c0, "length": self.length,
            "tolerance": self.tolerance, "held": str(self.held),
        }  # fmt: skip

    @classmethod
    def from_tree(cls, tree: Mapping[str, Any]) -> RingProblem:
        """The inverse of ``to_tree``.

        Raises:
            ValueError: the tree describes no rings.
        """
        tube, n = Tube(float(tree["c0"]), float(tree["length"])), lobes(tree["n"])
        discretization = _discretization(n, tree["mesh"], int(tree["degree"]))
        return cls(discretization, n, tube.c0, tube.length, float(tree["tolerance"]), known_held(tree["held"]))


def _discretization(n: int, mesh: Array, degree: int) -> Discretization:
    """Rings of ``n`` lobes on a mesh; the free parameters are those of the circle where they branch off."""
    pressure = n**2 - 1.0
    circle = np.array([n, (0.5 - pressure) * 4 / n**2, pressure * 8 / n**3, 1.0])
    return Discretization(HALF_LOBE, gauss_scheme(degree), mesh, circle, FREE)


def ring_onset(
    tube: Tube,
    n: int,
    *,
    intervals: int = 8,
    degree: int = 6,
    tolerance: float = 1e-10,
    held: Held = AREA_AND_VOLUME,
) -> tuple[RingProblem, Array, Array]:
    """The straight cylinder where rings of ``n`` lobes branch off, at ``lambda2 = (n^2 - 1)/2``, and the direction.

    Args:
        tube: the straight tube.
        n: number of lobes, from 2 on.
        intervals: of the first mesh on the half lobe.
        degree: Gauss points an interval.
        tolerance: of the profile, for remeshing.
        held: what is held while stability is judged.

    Returns:
        The problem, the unknown at onset and the unit tangent of the rings, with a tip at the first point.

    Raises:
        InputError: ``n`` is no whole number from 2 on.
    """
    n = lobes(n)
    d = _discretization(n, np.linspace(0.0, 1.0, intervals + 1), degree)
    t = all_points(d.mesh, d.scheme)
    one = np.ones_like(t)
    u = d.pack(np.column_stack((math.pi / n * t, 2 / n * one, 0 * t)), d.parameters)
    # In the unit 2/n the wave cos(n s) of the curvature is cos(2 s), s = pi t/2.
    wave = np.column_stack((np.sin(math.pi * t) / 2, np.cos(math.pi * t), -2 * np.sin(math.pi * t)))
    tangent = d.pack(wave, np.zeros(4))
    tangent /= math.sqrt(d.inner(tangent, tangent))
    return RingProblem(d, n, tube.c0, tube.length, tolerance, held), u, tangent


def ring_start(tube: Tube, mode: WaveNumbers, held: Held, tolerance: float | None) -> Start:
    """The straight tube where rings of a mode leave it.

    Raises:
        InputError: there are no such rings.
    """
    m, n = mode
    if m != 0:
        raise InputError("mode", f"rings do not depend on x, so {m},{n} is none of them", f"give 0,{max(n, 2)}")
    return ring_onset(tube, n, tolerance=checked_tolerance(tolerance, 1e-10), held=held)


FAMILIES = (Family("ring", (0, 2), "0,n", ring_start, RingProblem, accurate=True),)
