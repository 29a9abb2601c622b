"""The second variation of a tube summed point by point: no waves, no blocks, every mode at every point."""

import numpy as np

from pearlbvp.tube.density import gradients, hessians


def second_variation(basis, fields, c0, lambda1, lambda2):
    """Matrices of the second variation and of the normal displacement's mean square, and gradients of area and volume."""
    hessian = hessians(fields, c0, lambda1)
    hessian[:, 3, 3] += lambda2
    count = fields.shape[1]
    second = np.einsum("kin,kij,kjm->nm", basis.fields, hessian, basis.fields, optimize=True) / count
    a0, a1, b0, b1 = fields[:4]
    moved = basis.displacement()
    normal = -moved[:, 0] * b1[:, None] + moved[:, 1] * b0[:, None]
    root = np.sqrt(b0**2 + b1**2 + (a0 * b1 - a1 * b0) ** 2)
    mass = normal.T @ (normal / root[:, None]) / count
    area = np.einsum("jk,kjn->n", gradients(fields, c0)[1][1], basis.fields) / count
    return second, mass, np.array([area, fields[3] @ basis.fields[:, 3] / count])
