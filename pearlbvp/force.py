"""The force along the axis of a tube of any shape, from what every shape observes."""

from __future__ import annotations

import math
from collections.abc import Mapping


def axial_force(observed: Mapping[str, float]) -> float:
    """The force along the axis, ``f = dE/dL`` at fixed area, volume and ``c0`` (of turning shapes also at a fixed twist).

    The energy of similar surfaces is the same if ``c0`` is scaled, too; ``dE/dc0 = 2 (c0 A - M)``, ``dE/dA = -lambda1`` and
    ``dE/dV = -lambda2`` (Euler's theorem on homogeneous functions; ``docs/theory/model.md``)::

        f L = 2 lambda1 A + 3 lambda2 V + 2 c0 (c0 A - M)

    Args:
        observed: ``lambda1, lambda2, v, M, c0, L``, and ``area`` by that of the straight tube, where it is not 1.
    """
    area = 2 * math.pi * observed.get("area", 1.0)  # by length, like all that follows
    volume, curvature, c0 = math.pi * observed["v"], observed["M"] / observed["L"], observed["c0"]
    return 2 * observed["lambda1"] * area + 3 * observed["lambda2"] * volume + 2 * c0 * (c0 * area - curvature)


def with_force(observed: dict[str, float]) -> dict[str, float]:
    """Observables and their ``force``, the axial one."""
    return observed | {"force": axial_force(observed)}
