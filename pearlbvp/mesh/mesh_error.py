"""What is wrong with a mesh, said by the numbers of its vertices and triangles, or by those of the file that it is from."""

from __future__ import annotations

from pearlbvp.arrays import Integers
from pearlbvp.errors import InputError


class MeshError(InputError):
    """A mesh that is none, said by its vertices and triangles; who made it from a file can say it by those of the file.

    Attributes:
        template: the error's three texts, with ``{0}``, ``{1}``, ``{2}`` for vertices and ``{triangle}`` for the first one's
            triangle.
        corners: those vertices as corners: ``3 t + a`` is corner ``a`` of triangle ``t``.
    """

    template: tuple[str, str, str] = ("", "", "")
    corners: tuple[int, ...] = ()

    @classmethod
    def at(
        cls,
        template: tuple[str, str, str],
        triangles: Integers,
        *corners: int,
        first: int = 0,
        faces: Integers | None = None,
    ) -> MeshError:
        """The error with the numbers of ``triangles``, shape (T, 3), whose counting begins with ``first``.

        ``faces`` are the numbers of the triangles themselves, by default their places.
        """
        corners = tuple(int(corner) for corner in corners)
        numbers = triangles.ravel()[list(corners)] + first
        triangle = corners[0] // 3 if faces is None else faces[corners[0] // 3]
        error = cls(*(text.format(*numbers, triangle=triangle + first) for text in template))
        error.template, error.corners = template, corners
        return error

    def renumbered(self, triangles: Integers, first: int = 0, faces: Integers | None = None) -> MeshError:
        """The same with other numbers of the same triangles' corners; says where they begin."""
        if not self.corners:
            return self
        argument, what, remedy = self.template
        remedy += f" (numbers are the file's, from {first} on)"
        return MeshError.at((argument, what, remedy), triangles, *self.corners, first=first, faces=faces)
