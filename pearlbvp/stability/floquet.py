"""Neutral perturbations over one period: Floquet multipliers at growth rate zero.

The equation ``mu w = D'' + ...`` (``docs/theory/stability.md``) for normal perturbations ``w(s) e^{i n phi}``, ``D = delta H``,
is at ``mu = 0`` a linear system for ``(w, w', D, D')``. A multiplier ``e^{i theta}`` is a neutral Bloch wave. It is solved
with the collocation and on the mesh of the profile itself. Independent of ``bloch``, which uses the energy's second
variation in another coordinate and another discretization.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pearlbvp.arrays import Array
from pearlbvp.collocation.elimination import transfer_pencil
from pearlbvp.stability.profile import Profile, curvatures

SHIFT = 0.31 + 0.53j
"""A number inside the unit circle, beside the axes, where no multiplier lies but by chance."""


def jacobi_matrices(profile: Profile, n: ArrayLike, mu: float = 0.0) -> Array:
    """Matrices ``M`` of ``y' = M y``, ``y = (w, w', D, D')``, ``'`` by sigma, at the Gauss points: (..., N*m, 4, 4).

    The first axes are those of ``n``, a number or several.
    """
    states, scheme = profile.states, profile.states.scheme
    at_gauss: Array = (scheme.values @ states.local()).reshape(-1, 4)
    g = curvatures(at_gauss, profile)
    azimuthal = (np.asarray(n)[..., None] / g.r) ** 2
    tension = profile.c0**2 + profile.lambda1
    coupling = 2 * profile.c0 - 2 * g.h
    matrices = np.zeros((*azimuthal.shape, 4, 4))
    # w'' = -2D - b w' + n^2/r^2 w - (4H^2 - 2K) w
    w2_w = azimuthal - (4 * g.h**2 - 2 * g.gauss)
    matrices[..., 0, 1] = 1
    matrices[..., 1, 0], matrices[..., 1, 1], matrices[..., 1, 2] = w2_w, -g.b, -2
    # delta K = -(kappa_phi w'' + kappa_s (b w' - n^2/r^2 w)) - 2HK w, with w'' from above
    dk_w = -(g.around * w2_w - g.along * azimuthal) - 2 * g.h * g.gauss
    dk_w1 = g.b * (g.around - g.along)
    dk_d = 2 * g.around
    # D'' = mu w - b D' + n^2/r^2 D - (terms in H', H'') - (6H^2 - 2K - 2(c0^2 + lambda1)) D - (2c0 - 2H) delta K
    matrices[..., 2, 3] = 1
    matrices[..., 3, 0] = mu + 2 * (g.along * g.h2 + g.around * g.b * g.h1) + 2 * g.h1**2 - coupling * dk_w
    matrices[..., 3, 1] = 2 * (g.along - g.h) * g.h1 - coupling * dk_w1
    matrices[..., 3, 2] = azimuthal - (6 * g.h**2 - 2 * g.gauss - 2 * tension) - coupling * dk_d
    matrices[..., 3, 3] = -g.b
    return matrices * profile.arclength


def multipliers(profile: Profile, n: ArrayLike, mu: float = 0.0) -> NDArray[np.complex128]:
    """The four Floquet multipliers over one period at growth rate ``mu``, sorted by modulus, shape (..., 4), as ``n`` has it.

    At ``mu = 0`` translation along the axis gives a double multiplier 1 at ``n = 0``, translations across it at
    ``n = 1``. A double multiplier is found to the square root of rounding only; ``neutral_cosines`` has no such loss.
    Those on the unit circle stay accurate where others grow like ``e^{n S}``: they are eigenvalues of the pencil, not of a
    product, and shift and inversion makes of them the middling ones, ``1 / (rho - SHIFT)``, of an ordinary matrix.
    """
    scheme, h, matrices = profile.states.scheme, np.diff(profile.states.mesh), jacobi_matrices(profile, n, mu)
    pencils = [transfer_pencil(scheme, h, each) for each in matrices.reshape(-1, *matrices.shape[-3:])]
    a0, a1 = np.moveaxis(np.reshape(pencils, (*np.shape(n), 2, 4, 4)), -3, 0)
    if profile.half:
        a0, a1 = _unfolded(a0, a1)
    with np.errstate(divide="ignore", invalid="ignore"):  # by an infinite multiplier's zero, which may be complex
        rho = np.asarray(SHIFT + 1 / np.linalg.eigvals(np.linalg.solve(-a0 - SHIFT * a1, a1)))
    return np.take_along_axis(rho, np.argsort(np.abs(rho)), -1)


def _unfolded(a0: Array, a1: Array) -> tuple[Array, Array]:
    """The pencils of the whole period, shape (..., 4, 4), from those of its first half.

    The second half is the first seen backwards: ``A_0 y(0) + A_1 y(1/2) = 0`` and ``A_0 R y(1) + A_1 R y(1/2) = 0`` with
    ``R = diag(1, -1, 1, -1)``. Orthogonal rows that annihilate the factors of ``y(1/2)`` eliminate it without a division.
    """
    mirror = np.array([1.0, -1.0, 1.0, -1.0])
    orthogonal, _ = np.linalg.qr(np.concatenate((a1, a1 * mirror), axis=-2), mode="complete")
    rows = orthogonal[..., 4:].swapaxes(-1, -2)
    return rows[..., :4] @ a0, rows[..., 4:] @ (a0 * mirror)


def _half_period_maps(profile: Profile, n: int, mu: float) -> tuple[Array, Array]:
    """The ``(w, D)`` blocks ``A`` of the half-period map and ``P`` of its inverse, each of shape (2, 2).

    Raises:
        ValueError: the profile is not given as a half period.
    """
    if not profile.half:
        raise ValueError("profile: it must be half a period between planes of reflection; use multipliers for others")
    scheme, mesh = profile.states.scheme, profile.states.mesh
    a0, a1 = transfer_pencil(scheme, np.diff(mesh), jacobi_matrices(profile, n, mu))
    even = [0, 2]
    forward, backward = np.linalg.solve(a1, -a0[:, even]), np.linalg.solve(a0, -a1[:, even])
    return np.asarray(forward[even]), np.asarray(backward[even])


def neutral_cosines(profile: Profile, n: int, mu: float = 0.0) -> NDArray[np.complex128]:
    """The two values of ``2 cos(theta) = rho + 1/rho`` of a profile with reflection symmetry, shape (2,).

    With the half-period map ``Phi`` and the reflection ``R = diag(1, -1, 1, -1)`` the monodromy matrix is
    ``R Phi^{-1} R Phi``, and ``M + M^{-1}`` commutes with ``R``: its block on ``(w, D)``, which is ``4 P A - 2`` with
    the ``(w, D)`` blocks ``A`` of ``Phi`` and ``P`` of ``Phi^{-1}``, has both values as simple eigenvalues. (For Hill's
    equation this is ``cos theta = 2 A D - 1``; W. Magnus, S. Winkler, Hill's Equation (1966), §1.3.)

    At ``n = 0`` and ``n = 1`` the value nearest to 2 is that of the translations; it comes first. A real value between
    -2 and 2 is a pair of neutral Bloch waves (of waves with growth rate ``mu``, where one is given); a value that is
    not real belongs to four multipliers off the unit circle.

    Raises:
        ValueError: the profile is not given as a half period.
    """
    forward, backward = _half_period_maps(profile, n, mu)
    cosines: NDArray[np.complex128] = np.asarray(4 * np.linalg.eigvals(backward @ forward) - 2, dtype=complex)
    return cosines[np.argsort(np.abs(cosines - 2))]


def alternating_determinants(a0: Array, a1: Array) -> tuple[float, float]:
    """Two functions of a pearl whose zeros are its neutral axisymmetric waves that change sign from cell to cell.

    Args:
        a0, a1: the pencil, ``A_0 y(0) + A_1 y(1) = 0``, of perturbations of the states ``r, psi, h, w`` of half a period at
            fixed parameters (``Discretization.transfer_pencil``). At the planes of reflection ``psi = w = 0``, so that there
            ``delta r`` is the normal displacement ``w`` and ``delta h`` is ``D``.

    Returns:
        ``det A`` and ``det P`` of the ``(r, h)`` blocks of the half-period map and of its inverse (``neutral_cosines``). The
        first belongs to waves even about the belly: such a wave begins with ``delta psi = delta w = 0`` and ends half a
        period on with ``delta r = delta h = 0``; the second to those even about the neck. Their product gives the
        cosine of the wave that is no translation, ``2 cos(theta) = 4 det A det P - 2``: where ``theta`` passes pi, each
        factor changes its sign for itself, while their product may do no more than touch -2.
    """
    even = np.array([True, False, True, False])
    mixed = np.stack((np.where(even, a0, a1), a1, np.where(even, a1, a0), a0))
    forward, over, backward, under = np.linalg.det(mixed).tolist()
    return forward / over, backward / under
