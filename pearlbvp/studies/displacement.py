"""How a surface moves along its branch: the normal displacement by which the paper colours its samples."""

from __future__ import annotations

from typing import Any

import numpy as np

from pearlbvp.arrays import Array
from pearlbvp.continuation.solution import DIFFERENCE, Solution
from pearlbvp.errors import InputError
from pearlbvp.mesh.periodic import PeriodicMesh


def normal_displacement(point: Solution[Any]) -> Array:
    """Displacement along the inner normal by unit length of the branch, at the points of the surface that is drawn.

    By a central difference along the tangent; what moves within the surface does not count. Where it is negative, the surface
    moves outwards. (The paper's ``u``, of its Figs. c00f to c1f1, up to a positive factor.)

    Args:
        point: of a branch whose surfaces are grids.

    Returns:
        Shape (rows, columns) of ``problem.to_draw(u)``.

    Raises:
        InputError: a shape on a mesh, whose references differ along the branch.
    """
    shapes = point.problem.shapes
    here, ahead, behind = (shapes.to_draw(point.u + s * point.tangent) for s in (0.0, DIFFERENCE, -DIFFERENCE))
    if isinstance(here, PeriodicMesh):
        raise InputError("point", "a shape on a mesh has no grid", "take one that was computed without a mesh")
    X, moved = np.stack(here, axis=-1), (np.stack(ahead, axis=-1) - np.stack(behind, axis=-1)) / (2 * DIFFERENCE)
    normal = np.cross(np.gradient(X, axis=0), _around(X))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    inwards = X.mean(axis=1, keepdims=True) - X
    sense = np.sign(np.sum(normal * inwards))
    return np.asarray(sense * np.sum(moved * normal, axis=-1))


def _around(X: Array) -> Array:
    """Differences around a tube whose last column repeats the first."""
    ring = X[:, :-1]
    slopes = (np.roll(ring, -1, axis=1) - np.roll(ring, 1, axis=1)) / 2
    return np.concatenate((slopes, slopes[:, :1]), axis=1)
