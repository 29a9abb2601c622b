"""Products of a function along a tube and one around it, on a product grid: their fields, adjoints and quadratic forms.

Functions along: ``1, cos p k x, sin p k x``. Around: the waves of ``sigma`` but the first, then the centre's ``y`` and ``z``.
A *field* of the surface is named by its order of differentiation along ``x`` and by what it is around; see ``tube.modes``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.tube.modes import Mode


class Field(NamedTuple):
    """A field: order of the derivative along ``x``, and which of the functions around."""

    order: int
    around: str


FIELDS = (
    Field(1, "re"), Field(1, "im"), Field(0, "slope"), Field(0, "sigma"), Field(2, "re"), Field(2, "im"),
    Field(1, "slope"), Field(1, "sigma"), Field(0, "bend"), Field(0, "twice"),
)  # fmt: skip
"""``a = P_x, b = P_phi, p = P_xx, q = P_xphi, s = P_phiphi``, real and imaginary parts, turned by ``e^{-i phi}``."""

DISPLACEMENT = (Field(0, "re"), Field(0, "im"))
"""What a mode moves points by in the plane, turned likewise."""


@dataclass(frozen=True)
class Tensor:
    """The functions on a product grid.

    Attributes:
        size: largest wave numbers along and around.
        k: unit of the wave numbers along.
        x, phi: the grid's points, shape (K,), ``phi`` running fastest.
        functions_x: the functions along and two derivatives, shape (3, points, functions).
        functions_phi: what each field is around, each of shape (points, functions).
    """

    size: tuple[int, int]
    k: float
    x: Array
    phi: Array
    functions_x: Array
    functions_phi: dict[str, Array]

    @classmethod
    def of(cls, size: tuple[int, int], length: float) -> Tensor:
        """On a grid that integrates products of three functions, and some more."""
        along, around = (4 * s + 8 for s in size)
        x = (np.arange(along) / along - 0.5) * length
        return cls.at(size, length, x, np.arange(around) / around * 2 * np.pi)

    @classmethod
    def at(cls, size: tuple[int, int], length: float, x: Array, phi: Array) -> Tensor:
        """On any product grid."""
        k = 2 * np.pi / length
        p = np.arange(1, size[0] + 1)
        cosine, sine = np.cos(np.outer(x, p * k)), np.sin(np.outer(x, p * k))
        one, zero, pk = np.ones((len(x), 1)), np.zeros((len(x), 1)), p * k
        functions_x = np.array([
            np.hstack((one, cosine, sine)),
            np.hstack((zero, -pk * sine, pk * cosine)),
            np.hstack((zero, -(pk**2) * cosine, -(pk**2) * sine)),
        ])  # fmt: skip
        b = np.arange(2, size[1] + 1)
        cosine, sine = np.cos(np.outer(phi, b)), np.sin(np.outer(phi, b))
        one, zero, none = np.ones((len(phi), 1)), np.zeros((len(phi), 1)), np.zeros((len(phi), 2))
        c, s = np.cos(phi)[:, None], np.sin(phi)[:, None]
        sigma = np.hstack((one, cosine, sine))
        slope = np.hstack((zero, -b * sine, b * cosine))
        bend = np.hstack((-one, -(1 + b**2) * cosine, -(1 + b**2) * sine))
        functions_phi = {
            "re": np.hstack((sigma, c, s)),
            "im": np.hstack((0 * sigma, -s, c)),
            "sigma": np.hstack((sigma, none)),
            "slope": np.hstack((slope, none)),
            "bend": np.hstack((bend, none)),
            "twice": np.hstack((2 * slope, none)),
        }
        xs, phis = (t.ravel() for t in np.meshgrid(x, phi, indexing="ij"))
        return cls(size, k, xs, phis, functions_x, functions_phi)

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of functions along and around."""
        return 2 * self.size[0] + 1, 2 * self.size[1] + 1

    @property
    def modes(self) -> tuple[Mode, ...]:
        """The functions as modes, in the order of their coefficients: along, then around."""
        p, b = range(1, self.size[0] + 1), range(2, self.size[1] + 1)
        along = [(0, "cos"), *((i, "cos") for i in p), *((i, "sin") for i in p)]
        sections = [(0, "cos"), *((i, "cos") for i in b), *((i, "sin") for i in b)]
        around: list[Mode] = [Mode("sigma", 0, "cos", i, f) for i, f in sections] + [Mode("y", 0), Mode("z", 0)]
        return tuple(mode._replace(p=i, along=f) for i, f in along for mode in around)

    @property
    def waves(self) -> tuple[Array, Array]:
        """Wave numbers of the functions along, and around (0 for the centre)."""
        p, b = np.arange(1, self.size[0] + 1), np.arange(2, self.size[1] + 1)
        return np.concatenate(([0], p, p)), np.concatenate(([0], b, b, [0, 0]))

    def row(self, p: int, along: str) -> int | None:
        """Place of a function along; None if it is zero or not among them."""
        if p > self.size[0] or (p == 0 and along == "sin"):
            return None
        return p if along == "cos" else p + self.size[0]

    def column(self, part: str, b: int, around: str) -> int | None:
        """Place of a function around; None if it is zero or not among them."""
        count = self.size[1] - 1
        if part != "sigma":
            return 1 + 2 * count + (part == "z")
        if b > self.size[1] or b == 1 or (b == 0 and around == "sin"):
            return None
        return 0 if b == 0 else b - 1 + (count if around == "sin" else 0)

    def values(self, matrix: Array, fields: Sequence[Field]) -> Array:
        """Fields of a sum with given coefficients, shape (fields, K)."""
        along = self.functions_x @ matrix
        return np.array([(along[f.order] @ self.functions_phi[f.around].T).ravel() for f in fields])

    def adjoint(self, slopes: Array, fields: Sequence[Field]) -> Array:
        """Mean over the grid of ``slopes`` times the fields of each function, in the shape of the coefficients."""
        points, around = self.functions_x.shape[1], len(self.functions_phi["re"])
        parts = np.zeros((3, points, self.shape[1]))
        for slope, f in zip(slopes, fields, strict=True):
            parts[f.order] += slope.reshape(points, around) @ self.functions_phi[f.around]
        along = self.functions_x.reshape(3 * points, -1)
        return np.asarray(along.T @ parts.reshape(3 * points, -1) / (points * around))

    def sandwich(self, coefficients: Array, left: Sequence[Field], right: Sequence[Field]) -> Array:
        """Mean over the grid of ``left^T coefficients right`` for each pair of functions, shape (N, N).

        Args:
            coefficients: shape (K, len(left), len(right)).
            left, right: fields.
        """
        points, around = self.functions_x.shape[1], len(self.functions_phi["re"])
        at = coefficients.reshape(points, around, len(left), len(right))
        pairs: list[Array] = []
        parts: list[Array] = []
        for i in sorted({f.order for f in left}):
            rows = [n for n, f in enumerate(left) if f.order == i]
            before = np.concatenate([self.functions_phi[left[n].around] for n in rows])  # (rows * around, functions)
            for j in sorted({f.order for f in right}):
                columns = [n for n, f in enumerate(right) if f.order == j]
                after = np.stack(
                    [self.functions_phi[right[n].around] for n in columns], axis=1
                )  # (around, columns, ...)
                block = at[:, :, rows][:, :, :, columns]  # (points, around, rows, columns)
                inner = np.matmul(np.moveaxis(block, 0, 2).reshape(around, -1, len(columns)), after)
                inner = inner.reshape(around, len(rows), points, -1).transpose(2, 1, 0, 3)
                parts.append(before.T @ inner.reshape(points, len(before), -1))
                pairs.append(self.functions_x[i][:, :, None] * self.functions_x[j][:, None, :])
        along, across = self.shape
        stacked = np.concatenate(pairs).reshape(-1, along**2)
        result = stacked.T @ np.concatenate(parts).reshape(-1, across**2)
        result = result.reshape(along, along, across, across).transpose(0, 2, 1, 3)
        return result.reshape(along * across, -1) / (points * around)

    def along(self, matrix: Array) -> Array:
        """Coefficients of the derivative by ``x``."""
        p = self.k * np.arange(1, self.size[0] + 1)[:, None]
        cosine, sine = matrix[1 : self.size[0] + 1], matrix[self.size[0] + 1 :]
        return np.vstack((0 * matrix[:1], p * sine, -p * cosine))

    def around(self, matrix: Array) -> Array:
        """Coefficients of ``sigma_phi``; zero for the centre."""
        count = self.size[1] - 1
        b = np.arange(2, self.size[1] + 1)
        cosine, sine = matrix[:, 1 : count + 1], matrix[:, count + 1 : 2 * count + 1]
        return np.hstack((0 * matrix[:, :1], b * sine, -b * cosine, 0 * matrix[:, -2:]))
