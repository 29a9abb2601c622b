"""Flows of a viscous fluid inside and outside of a tube's wall: derived, checked in the equations, and their tractions.

With velocities ``(v_r, v_phi, v_x) e^{i(kx + n phi)}`` and viscosity 1, Stokes's equations ``Lap v = grad p, div v = 0`` have a harmonic
pressure: ``p = f_n(kr)``, a modified Bessel function. In the plane, ``v_y + i v_z = (v_r + i v_phi) e^{i phi}`` is a scalar, so

    v_r + i v_phi  satisfies Bessel's equation of order n + 1,  v_r - i v_phi  that of order n - 1,  v_x  that of order n,

each up to a particular solution. One is ``x_perp p/2`` in the plane, as ``Lap(x_perp p) = 2 grad_perp p`` of a harmonic ``p``, with
``v_x = i (r p' + 2 p)/(2k)``: ``Lap(r p') = 2 k^2 p`` and ``div(x_perp p/2) = p + r p'/2``. Solutions without a pressure have
``(a + b)/2 + i c = 0`` for ``v_r + i v_phi = a f_{n+1}``, ``v_r - i v_phi = b f_{n-1}``, ``v_x = c f_n``, where ``f_m' = f_{m+1} + (m/x) f_m``
and ``f_m' = f_{m-1} - (m/x) f_m``: so do ``I_m`` and ``(-1)^m K_m``.
"""

from functools import cache

import sympy

r, k, n = sympy.symbols("r k n", positive=True)


def bessel(kind, order):
    """``I_m(kr)``, or ``(-1)^m K_m(kr)`` without the sign of ``m = n``."""
    sign = sympy.Integer(-1) ** (order - n)
    return sympy.besseli(order, k * r) if kind == "inside" else sign * sympy.besselk(order, k * r)


def flows(kind):
    """Three flows ``(v_r, v_phi, v_x, p)``: a vortex, one along the axis, one with a pressure, as derived above."""
    f, above, below = (bessel(kind, n + i) for i in (0, 1, -1))
    # v_r + i v_phi, v_r - i v_phi, v_x, p
    pairs = (
        (-above, below, sympy.S.Zero, sympy.S.Zero),  # a = -1, b = 1, c = 0
        (2 * above, sympy.S.Zero, sympy.I * f, sympy.S.Zero),  # a = 2, b = 0, c = i
        (r * f / 2, r * f / 2, sympy.I * (r * sympy.diff(f, r) + 2 * f) / (2 * k), f),
    )
    return [((plus + minus) / 2, (plus - minus) / (2 * sympy.I), axial, p) for plus, minus, axial, p in pairs]


def residuals(flow):
    """Stokes's equations in cylindrical coordinates (Batchelor, appendix 2), and the divergence: zero for a flow."""
    radial, around, axial, pressure = flow

    def laplacian(f):
        return sympy.diff(r * sympy.diff(f, r), r) / r - (n**2 / r**2 + k**2) * f

    return (
        laplacian(radial) - radial / r**2 - 2 * sympy.I * n * around / r**2 - sympy.diff(pressure, r),
        laplacian(around) - around / r**2 + 2 * sympy.I * n * radial / r**2 - sympy.I * n * pressure / r,
        laplacian(axial) - sympy.I * k * pressure,
        sympy.diff(r * radial, r) / r + sympy.I * n * around / r + sympy.I * k * axial,
    )


def traction(flow):
    """``sigma_rr, sigma_r phi, sigma_rx``."""
    radial, around, axial, pressure = flow
    return (
        -pressure + 2 * sympy.diff(radial, r),
        r * sympy.diff(around / r, r) + sympy.I * n * radial / r,
        sympy.diff(axial, r) + sympy.I * k * radial,
    )


@cache
def evaluator(what, kind):
    """A function of ``r, k, n`` to thirty digits and more: residuals, or velocities and tractions, of the three flows."""
    if what == "residuals":
        rows = [residuals(flow) for flow in flows(kind)]
    else:
        rows = [(*flow[:3], *traction(flow)) for flow in flows(kind)]
    return sympy.lambdify((r, k, n), rows, "mpmath")
