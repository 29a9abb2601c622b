"""Growth rates of a tube in fluids by Chebyshev collocation of all equations: no Bessel function, no friction, no dissipation."""

import numpy as np
from numpy.polynomial import chebyshev


def differentiation(count):
    """Chebyshev points on [-1, 1] from 1 down, and the matrix of the derivative (Trefethen, Spectral Methods in MATLAB, ch. 6)."""
    x = np.cos(np.pi * np.arange(count) / (count - 1))
    basis = chebyshev.chebvander(x, count - 1)
    slopes = np.column_stack([chebyshev.chebval(x, chebyshev.chebder(row)) for row in np.eye(count)])
    return x, np.linalg.solve(basis.T, slopes.T).T


class Fluid:
    """The equations of one fluid at its points, for unknowns ``v_r, v_phi, v_x, p`` there; the wall is point ``wall``."""

    def __init__(self, k, n, viscosity, r, d, wall):
        self.r, self.d, self.wall, self.viscosity, self.k, self.n = r, d, wall, viscosity, k, n
        self.count = len(r)

    def rows(self):
        """Momentum by ``r^2`` and the divergence by ``r``, where they are finite."""
        r, k, n = np.diag(self.r), self.k, self.n
        one, zero = np.eye(self.count), np.zeros((self.count, self.count))
        lap = r @ self.d @ r @ self.d - n**2 * one - k**2 * r @ r
        turn = 2j * n * one
        mu = self.viscosity
        return np.block(
            [
                [mu * (lap - one), -mu * turn, zero, -r @ r @ self.d],
                [mu * turn, mu * (lap - one), zero, -1j * n * r],
                [zero, zero, mu * lap, -1j * k * r @ r],
                [one + r @ self.d, 1j * n * one, 1j * k * r, zero],
            ]
        )

    def at_wall(self, field):
        """The row that gives a field at the wall."""
        row = np.zeros(4 * self.count, complex)
        row[field * self.count + self.wall] = 1
        return row

    def slope_at_wall(self, field):
        row = np.zeros(4 * self.count, complex)
        row[field * self.count : (field + 1) * self.count] = self.d[self.wall]
        return row

    def traction(self):
        """``sigma_rr, sigma_r phi, sigma_rx`` at the wall ``r = 1``."""
        value, slope, mu = self.at_wall, self.slope_at_wall, self.viscosity
        return np.array(
            [
                2 * mu * slope(0) - value(3),
                mu * (slope(1) - value(1) + 1j * self.n * value(0)),
                mu * (slope(2) + 1j * self.k * value(0)),
            ]
        )


def on_axis(fluid, at):
    """Rows that hold for smooth fields at ``r = 0``, each zero."""
    count, n = fluid.count, abs(fluid.n)
    value, slope = np.zeros((3, 4 * count), complex), np.zeros((3, 4 * count), complex)
    for field in range(3):
        value[field, field * count + at] = 1
        slope[field, field * count : (field + 1) * count] = fluid.d[at]
    if n == 0:
        return [value[0], value[1], slope[2]]
    if n == 1:
        return [value[0] + 1j * value[1], slope[0] - 1j * slope[1], value[2]]
    return list(value)


def growth_rate(k, n, normal_force, viscosity_ratio=1.0, membrane_viscosity=0.0, count=36):
    """The rate ``s`` of ``u e^{i(kx + n phi) + st}``, and the largest residual of the equations.

    Unknowns are both fluids' fields at their points, the tension, and the rate for ``u = 1``.

    Args:
        k, n: wave numbers.
        normal_force: of the membrane by displacement ``u``, outwards, at uniform tension.
        viscosity_ratio, membrane_viscosity: in that of the fluid outside.
        count: of points in each fluid.
    """
    x, d = differentiation(count)
    inner = Fluid(k, n, viscosity_ratio, (1 + x) / 2, 2 * d, wall=0)
    scale = 2 / max(k, 0.5)
    y, far = x[1:], slice(1, None)  # r = 1 + scale (1 + x)/(1 - x); infinity, x = 1, is left out: fields are zero there
    outer = Fluid(
        k, n, 1.0, 1 + scale * (1 + y) / (1 - y), (((1 - x) ** 2 / (2 * scale))[:, None] * d)[far, far], count - 2
    )
    a, b = 4 * inner.count, 4 * outer.count
    rows, right = [], []

    def add(left, middle=0, tension=0, rate=0, value=0, weight=1.0):
        row = np.zeros(a + b + 2, complex)
        row[:a], row[a : a + b], row[-2], row[-1] = left, middle, tension, rate
        rows.append(weight * row)
        right.append(weight * value)

    for row in inner.rows():
        add(row)
    for row, radius in zip(outer.rows(), np.tile(outer.r, 4), strict=True):
        add(0, row / radius**2)
    for row in on_axis(inner, count - 1):
        add(row)
    for field in range(3):
        add(inner.at_wall(field), -outer.at_wall(field))
    v_r, v_phi, v_x = (inner.at_wall(field) for field in range(3))
    add(v_r, rate=-1)
    add(v_r + 1j * n * v_phi + 1j * k * v_x)
    # Rates of strain of the membrane, and the forces of its viscous stress: minus its normal part, and its divergence.
    e_phi, e_x, e_shear = 1j * n * v_phi + v_r, 1j * k * v_x, (1j * k * v_phi + 1j * n * v_x) / 2
    viscous = (
        2 * membrane_viscosity * np.array([-e_phi, 1j * n * e_phi + 1j * k * e_shear, 1j * n * e_shear + 1j * k * e_x])
    )
    inside, outside = inner.traction(), outer.traction()
    add(viscous[0] - inside[0], outside[0], tension=-1, value=-normal_force)
    add(viscous[1] - inside[1], outside[1], tension=1j * n)
    add(viscous[2] - inside[2], outside[2], tension=1j * k)
    matrix, values = np.array(rows), np.array(right, complex)
    solution = np.linalg.lstsq(matrix, values, rcond=1e-14)[0]
    return solution[-1], np.abs(matrix @ solution - values).max()
