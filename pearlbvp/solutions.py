"""Points of branches with the verbs of an ordinary analysis, which needs no other import then.

The rooms below do the work; nothing is computed here.
"""

from __future__ import annotations

import os
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from pearlbvp.continuation import solution as solutions
from pearlbvp.units import RADII, Units

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from pearlbvp.arrays import Array
    from pearlbvp.held import Held
    from pearlbvp.mesh.functional import Kind
    from pearlbvp.mesh.periodic import PeriodicMesh


class Solution(solutions.Solution[Any]):
    """A point of a branch: ``observables``, ``spectrum``, ``slopes``, ``problem`` and ``u``, and the shape itself."""

    @classmethod
    def of(cls, found: solutions.Solution[Any]) -> Solution:
        """A solution of the rooms below; growth rates that its branch has computed are not computed again."""
        carried = {field.name: getattr(found, field.name) for field in fields(found)}
        return cls(**carried | {"known": vars(found).get("spectrum", found.known)})

    def profile(self, samples: int = 400) -> pd.DataFrame:
        """The curve that the shape is made of, in radii: ``x, r, psi, H`` of pearls, sections of rings and coils.

        Raises:
            InputError: the shape is made of no single curve.
        """
        from pearlbvp.studies.export import profile_table

        return profile_table(self, samples)

    def surface(self, nodes: int = 3000) -> PeriodicMesh:
        """The shape as triangles on one period of the tube, with about so many vertices."""
        from pearlbvp.studies.mesh import shape_mesh

        return shape_mesh(self, nodes)

    def meshed(
        self, nodes: int | PeriodicMesh = 3000, discretization: Kind = "subdivision", *, fix: str | Held | None = None
    ) -> Solution:
        """The same shape solved for again on a triangulated tube, by Newton's method at its reduced volume.

        Args:
            nodes: vertices of the mesh, about, or a mesh of the straight tube (``pearlbvp.meshes``), mapped onto the shape.
            discretization: ``subdivision`` or ``cotangent``.
            fix: what is held while stability is judged, as ``pearlbvp.branch`` takes it; by default as here.

        Returns:
            A solution with all that others have; a shape on a mesh itself.

        Raises:
            InputError: the mesh is too coarse for the shape, or that is the straight tube.

        Examples:
            >>> import pearlbvp as pb
            >>> coil = pb.branch(pb.Tube(c0=0, L=10), "coil", until={"v": 0.97})[-1]
            >>> again = coil.meshed(300)
            >>> abs(again.observables["E"] / coil.observables["E"] - 1) < 1e-3
            True
        """
        from pearlbvp.studies.mesh import on_mesh

        return Solution.of(on_mesh(self, nodes, kind=discretization, fix=fix))

    def growth_rates(self, n: int = 0, theta: float = 0.0) -> Array:
        """Growth rates of the perturbations ``e^{i n phi} e^{i theta x/period}`` of pearls, those of a rigid motion among them.

        ``spectrum`` has those that fit the tube; here ``theta`` is any.

        Args:
            n: waves around the tube.
            theta: phase a period, in radians; ``2 pi j/N`` fits ``N`` periods.

        Returns:
            The rates, largest first.

        Raises:
            InputError: an argument that cannot be used, or shapes that are no pearls.

        Examples:
            >>> import pearlbvp as pb
            >>> pearl = pb.branch(pb.Tube(c0=0.48, L=7.5), "pearl", until={"v": 1.008111})[-1]
            >>> rates = [pearl.growth_rates(theta=2 * 3.141592653589793 / pearls)[0] for pearls in (2, 4)]
            >>> bool(abs(rates[0]) < 1e-5), bool(rates[1] > 1e-3)  # on two periods they are at their limit, on four beyond
            (True, True)
        """
        from pearlbvp.studies.waves import growth_rates

        return growth_rates(self, n, theta)

    def export(self, path: str | os.PathLike[str], nodes: int = 3000, units: Units = RADII) -> None:
        """Write the surface for another program: ``.vtu`` (ParaView), ``.ply``, ``.obj`` (Blender), ``.fe`` (Surface Evolver).

        Args:
            path: whose ending names the format.
            nodes: vertices, about.
            units: of the vertices.

        Raises:
            InputError: another ending, or a place that cannot be written to.
        """
        from pearlbvp.mesh.files import writable_mesh, write_mesh

        writable_mesh("path", path)
        c0 = units.to_user("H", self.observables["c0"])
        write_mesh(units.surface(self.surface(nodes)), path, c0=c0, name="path")

    def plot(self, title: str = "") -> Figure:
        """A picture of the surface; of one on a mesh with its triangles, coloured by the distance from the axis.

        Args:
            title: by default its volume and its number of unstable directions.
        """
        from pearlbvp.figures.mesh import draw_mesh
        from pearlbvp.figures.surface import draw_surfaces, title_of

        own = self.problem.shapes.own_mesh(self.u)
        title = title or title_of(self)
        return draw_surfaces([self], [title], columns=1) if own is None else draw_mesh(own, title=title)
