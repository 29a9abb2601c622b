"""Wrinkled tubes in closed form: closed elasticae under pressure of ``n`` equal lobes, in Jacobi's elliptic functions.

A cylinder over a plane curve has ``H = kappa/2, K = 0``, and ``G = 0`` becomes, by arclength,

    kappa'' + kappa^3/2 - a kappa - p = 0,    a = 2(c0^2 + lambda1),  p = 2 lambda2

(M. Levy, J. Math. Pures Appl. 10 (1884) 5): its shapes do not know ``c0``. Multiplied by ``kappa'`` and integrated,

    4 kappa'^2 = (beta - kappa)(kappa - alpha)((kappa + m)^2 + eta^2),    m = (alpha + beta)/2,

for the real roots ``alpha < beta`` and the complex pair ``-m +- i eta``. With the distances ``A, B`` of ``beta, alpha`` from
that pair, ``rho^2 = A B`` and ``u = rho s/2``, from the tip of a lobe on (I. Tadjbakhsh, F. Odeh, J. Math. Anal. Appl. 18
(1967) 59; V. Vassilev, P. Djondjorov, I. Mladenov, J. Phys. A 41 (2008) 435201; P. Byrd, M. Friedman, Handbook of Elliptic
Integrals (Springer 1971), 259.00),

    kappa = (beta B + alpha A + (beta B - alpha A) cn u) / (A + B - (A - B) cn u).

Two numbers say everything but the size: the modulus ``k`` and an angle ``theta``, with ``sinh t = k tan theta`` and

    A, B = rho e^{+-t},  m = (rho/2) sin theta cosh t,
    (beta - alpha)/2 = rho k / cos theta,  eta = rho k' cos theta.

``n`` periods on the perimeter ``2 pi`` give ``rho = 4 n K(k)/pi``, and one turn in all gives ``k`` for each ``theta``. Rings
run from the circle (``sin theta = 1/n``, ``k = 0``) to self-contact, ``theta`` growing all along, while ``k`` turns beyond.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ellipj, ellipk, ellipkinc, elliprj

from pearlbvp.arrays import Array
from pearlbvp.errors import InputError
from pearlbvp.helfrich import finite
from pearlbvp.representation import brief
from pearlbvp.roots import root

POINTS = 512
"""Equidistant points of a lobe for the mean of ``kappa^2``: the sum converges geometrically."""


def lobes(n: int) -> int:
    """A number of lobes, checked.

    Raises:
        InputError: it is no whole number from 2 on.
    """
    if finite("mode", n) != int(n) or n < 2:
        raise InputError("mode", f"rings have a whole number of lobes from 2 on, not {n}", "give 0,2 for instance")
    if n > MOST_LOBES:
        raise InputError("mode", f"rings of {int(n)} lobes are too fine to be computed", f"give {MOST_LOBES} at most")
    return int(n)


MOST_LOBES = 10_000
"""Lobes of a ring, up to which its waves are counted in seconds."""


@dataclass(frozen=True)
class ElasticRing:
    """A closed elastica of perimeter ``2 pi`` with ``n`` lobes, the first one's tip on the positive real axis.

    The curve runs counterclockwise, its tangent is ``i e^{i angle}`` and its outer normal ``e^{i angle}``.

    Attributes:
        n: number of lobes.
        theta: the angle that says which of the rings it is; from ``arcsin(1/n)`` (the circle) up.
        k: modulus of the elliptic functions.
    """

    __repr__ = brief

    n: int
    theta: float
    k: float

    @cached_property
    def quarter(self) -> float:
        """The complete elliptic integral ``K(k)``; half a lobe has ``2 K`` in ``u``."""
        return float(ellipk(self.k**2))

    @property
    def rho(self) -> float:
        """``2 du/ds``."""
        return 4 * self.n * self.quarter / math.pi

    @property
    def _sinh(self) -> float:
        return self.k * math.tan(self.theta)

    @property
    def _cosh(self) -> float:
        return math.hypot(1.0, self._sinh)

    @property
    def m(self) -> float:
        """Mean of the two real roots."""
        return self.rho / 2 * math.sin(self.theta) * self._cosh

    @property
    def d(self) -> float:
        """Half their difference."""
        return self.rho * self.k / math.cos(self.theta)

    @property
    def eta(self) -> float:
        """Imaginary part of the other roots."""
        return self.rho * math.sqrt(1 - self.k**2) * math.cos(self.theta)

    @property
    def _products(self) -> tuple[float, float]:
        """Of the real roots, and of the complex ones."""
        return self.m**2 - self.d**2, self.m**2 + self.eta**2

    @property
    def a(self) -> float:
        """``2(c0^2 + lambda1)``."""
        real, other = self._products
        return self.m**2 - (real + other) / 4

    @property
    def p(self) -> float:
        """``2 lambda2``."""
        real, other = self._products
        return self.m * (other - real) / 4

    @property
    def constant(self) -> float:
        """The first integral ``C = kappa'^2 + kappa^4/4 - a kappa^2 - 2 p kappa``."""
        real, other = self._products
        return -real * other / 4

    @property
    def lambda2(self) -> float:
        """The pressure difference."""
        return self.p / 2

    def lambda1(self, c0: float) -> float:
        """The surface tension at a spontaneous curvature."""
        return self.a / 2 - c0**2

    def energy(self, c0: float) -> float:
        """``E/A``, the mean of ``(kappa/2 - c0)^2``; the mean of ``kappa`` is 1."""
        return self._mean_square / 4 - c0 + c0**2

    @cached_property
    def _mean_square(self) -> float:
        return float(np.mean(self.curvature(2 * math.pi / self.n * np.arange(POINTS) / POINTS) ** 2))

    @property
    def v(self) -> float:
        """Enclosed area by ``pi``: the mean of ``kappa^2/2 - a`` by ``p``, from the closed form of the position."""
        return (self._mean_square / 2 - self.a) / self.p

    @property
    def turning(self) -> float:
        """Mean curvature around the perimeter; 1 on a closed ring.

        ``m - (d/3K) sinh t cosh t R_J(0, k'^2, 1, cosh^2 t)``: a complete integral of the third kind.
        """
        return self.m - self.d * self._sinh * self._cosh * self._lag / (3 * self.quarter)

    @cached_property
    def _lag(self) -> float:
        return float(elliprj(0.0, 1 - self.k**2, 1.0, self._cosh**2))

    def curvature(self, s: ArrayLike) -> Array:
        """``kappa`` at arclength ``s``, any shape."""
        _, cn, _ = self._jacobi(s)
        mu, m, d = self._sinh / self._cosh, self.m, self.d
        return np.asarray((m - d * mu + (d - m * mu) * cn) / (1 - mu * cn))

    def slope(self, s: ArrayLike) -> Array:
        """``dkappa/ds`` at arclength ``s``, any shape."""
        sn, cn, dn = self._jacobi(s)
        mu = self._sinh / self._cosh
        return np.asarray(-self.rho / 2 * self.d * (1 - mu**2) * sn * dn / (1 - mu * cn) ** 2)

    def angle(self, s: ArrayLike) -> Array:
        """Angle of the outer normal at arclength ``s``, any shape: the integral of ``kappa`` from 0.

        ``m s + 2 arctan(d sd(u)/rho) - (2 d/3 rho) sinh t cosh t J(u)``, ``J`` the incomplete integral of the third kind
        ``sn^3 R_J(cn^2, dn^2, 1, 1 + sinh^2 t sn^2)`` continued over all ``u`` (B. C. Carlson, Numer. Algorithms 10 (1995) 13).
        """
        s = np.asarray(s, dtype=float)
        sn, cn, dn = self._jacobi(s)
        half_turns = np.round(self.rho * s / 4 / self.quarter)
        sign = np.where(half_turns % 2, -1.0, 1.0)
        third = sign * sn**3 * elliprj(cn**2, dn**2, 1.0, 1 + (self._sinh * sn) ** 2) + 2 * half_turns * self._lag
        lag = 2 * self.d / (3 * self.rho) * self._sinh * self._cosh * third
        return np.asarray(self.m * s + 2 * np.arctan(self.d / self.rho * sn / dn) - lag)

    def _jacobi(self, s: ArrayLike) -> tuple[Array, Array, Array]:
        sn, cn, dn, _ = ellipj(self.rho / 2 * np.asarray(s, dtype=float), self.k**2)
        return sn, cn, dn

    def position(self, s: ArrayLike) -> NDArray[np.complex128]:
        """The curve in the complex plane about its centre, any shape: ``e^{i angle} (kappa^2/2 - a + i kappa')/p``."""
        return np.asarray(
            np.exp(1j * self.angle(s)) * (self.curvature(s) ** 2 / 2 - self.a + 1j * self.slope(s)) / self.p
        )

    def states(self, sigma: Array) -> Array:
        """``psi, kappa, kappa'`` on half a lobe, ``sigma`` from 0 (the tip) to 1, shape (K,): shape (K, 3)."""
        s = math.pi / self.n * sigma
        return np.column_stack((self.angle(s), self.curvature(s), self.slope(s)))

    @property
    def inflexion(self) -> float:
        """Arclength from the tip to where ``kappa = 0`` first; to the waist, half a lobe on, where it vanishes nowhere."""
        mu = self._sinh / self._cosh
        over, under = self.d * mu - self.m, self.d - self.m * mu
        if over <= -under:
            return math.pi / self.n
        return 2 / self.rho * float(ellipkinc(math.acos(over / under), self.k**2))

    @property
    def gap(self) -> float:
        """Width of the narrowest place between the two sides of a lobe: 0 where the ring touches itself.

        Beyond the inflexion a side turns back towards the axis of its lobe, and is nearest to it where it runs parallel to
        it: for ``n = 2`` at the waist. Where a side turns back nowhere, the width at its inflexion is taken.
        """
        start, waist = self.inflexion, math.pi / self.n
        if self.n == 2 or float(self.angle(start)) <= math.pi / 2:
            return 2 * float(self.position(waist if self.n == 2 else start).imag)
        parallel = root(lambda s: float(self.angle(s)) - math.pi / 2, start, waist, 1e-14)
        return 2 * float(self.position(parallel).imag)


def ring_at_angle(n: int, theta: float) -> ElasticRing:
    """The ring of ``n`` lobes at an angle ``theta`` from ``arcsin(1/n)`` (the circle) to below ``pi/2``.

    Raises:
        InputError: an angle or a number of lobes that there is not.
    """
    n = lobes(n)
    least = math.asin(1 / n)
    if not least <= theta < math.pi / 2:
        raise InputError("theta", f"{theta:g} is not between arcsin(1/n) = {least:.6g} (the circle) and pi/2")

    def excess(k: float) -> float:
        return ElasticRing(n, theta, k).turning - 1

    if excess(0.0) <= 0:  # the circle
        return ElasticRing(n, theta, 0.0)
    return ElasticRing(n, theta, root(excess, 0.0, 1 - 1e-12, 1e-16, 1e-15))


def touching_ring(n: int) -> ElasticRing:
    """The ring of ``n`` lobes that just touches itself: at its waist for ``n = 2``, else between the sides of each lobe.

    J. E. Flaherty, J. B. Keller, S. I. Rubinow, SIAM J. Appl. Math. 23 (1972) 446 have its pressure, ``2 lambda2`` in units
    of ``E I / R^3``.

    Raises:
        InputError: see ``lobes``.

    Examples:
        >>> ring = touching_ring(2)
        >>> round(ring.v, 6), round(ring.lambda2, 6), round(abs(ring.gap), 9)
        (0.270948, 2.623443, 0.0)
    """
    least = math.asin(1 / lobes(n))
    most = least + 0.999 * (math.pi / 2 - least)
    theta = root(lambda angle: ring_at_angle(n, angle).gap, least, most, 1e-15)
    return ring_at_angle(n, float(theta))


def ring_at(n: int, name: str, value: float) -> ElasticRing:
    """The ring of ``n`` lobes with a given ``v`` or ``lambda2``, before it touches itself.

    Args:
        n: number of lobes.
        name: ``v`` or ``lambda2``: both are monotone along the rings.
        value: what it is to be.

    Raises:
        InputError: another name, or a value that no ring has before it touches itself.

    Examples:
        >>> ring = ring_at(2, "v", 0.8)
        >>> curve = ring.position(np.linspace(0, 2 * np.pi, 400))  # its section in the complex plane
        >>> round(ring.v, 9), round(ring.lambda2, 4)
        (0.8, 1.6925)
    """
    if name not in ("v", "lambda2"):
        raise InputError("name", f"rings are not found by {name!r}", "choose v or lambda2")
    value = finite(name, value)
    least, contact = math.asin(1 / lobes(n)), touching_ring(n)
    first, last = (getattr(ring, name) for ring in (ring_at_angle(n, least), contact))
    if not min(first, last) <= value <= max(first, last):
        raise InputError(
            name, f"rings of {n} lobes have it from {first:.6g} to {last:.6g} (self-contact), not {value:g}"
        )
    if value == first:
        return ring_at_angle(n, least)
    theta = root(lambda angle: getattr(ring_at_angle(n, angle), name) - value, least, contact.theta, 1e-15)
    return ring_at_angle(n, float(theta))
