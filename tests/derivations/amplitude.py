"""The amplitude equations of Helfrich tubes, derived from the energy to fourth order by computer algebra.

A tube near the cylinder of radius 1 is the graph ``r = 1 + u(x, phi)``. Its energy ``F = E + lambda1 A + lambda2 V`` by unit
area of the cylinder is expanded for

    u = sum of A_j e^{i(k_j x + n_j phi)} + complex conjugate,

critical modes of order 1 and modes that their products excite of order 2. Amplitudes are real, which loses nothing: the
symmetries fix the phases (paper, Theorem bifthm). The averaged energy is the potential of the reduced equations: the gradient
flow of a mode is ``dA/dt = -(dF/dA)/2``, because ``u = 2 A cos(...)`` has the mean square ``2 A^2``.

Run as a program it prints what ``pearlbvp/theory/amplitude.py`` holds; ``tests/test_amplitude.py`` compares the two.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import sympy

kappa, n, c0, lambda2, alpha2, beta2 = sympy.symbols("kappa n c0 lambda2 alpha2 beta2")
lambda1 = sympy.Rational(1, 4) - lambda2 - c0**2  # the straight cylinder's, paper eq. (socon)
K, N = sympy.symbols("K N")  # i k and i n; only their squares -kappa and -n^2 survive the mean

Wave = tuple[int, int]
Field = dict[tuple[int, int, int], Any]
"""Coefficients of ``e^{i(a k x + b n phi)}`` of order ``w``, by ``(a, b, w)``."""

ORDER = 4


def add(*fields: Field) -> Field:
    total: Field = {}
    for field in fields:
        for key, value in field.items():
            total[key] = total.get(key, 0) + value
    return total


def times(factor: Any, field: Field) -> Field:
    return {key: factor * value for key, value in field.items()}


def product(first: Field, second: Field) -> Field:
    total: Field = {}
    for (a, b, w), one in first.items():
        for (c, d, v), other in second.items():
            if w + v <= ORDER:
                total[a + c, b + d, w + v] = total.get((a + c, b + d, w + v), 0) + one * other
    return total


def power(delta: Field, exponent: Any, ring: Any) -> Field:
    """``(1 + delta)^exponent`` as a series, ``delta`` of order 1 at least."""
    total: Field = {(0, 0, 0): ring(1)}
    term = total
    for j in range(1, ORDER + 1):
        term = times((exponent - j + 1) / j, product(term, delta))
        total = add(total, term)
    return total


def mean_by_order(waves: dict[str, tuple[Wave, int]]) -> dict[str, dict[int, Any]]:
    """Averages over the cylinder of the energy, area and volume of a sum of waves, each by order.

    Args:
        waves: by the name of the amplitude: ``(a, b)`` of the wave ``e^{i(a k x + b n phi)}`` and its order. A wave
            ``(0, 0)`` is the amplitude itself, not twice.

    Returns:
        ``energy``, ``area``, ``volume``, each a polynomial by order; energy without ``lambda1, lambda2``.
    """
    ring, *generators = sympy.ring([*sympy.symbols(list(waves)), K, N, c0], sympy.QQ)
    amplitude = dict(zip(waves, generators, strict=False))
    k_, n_, c = generators[-3:]
    u: Field = {}
    for name, ((a, b), w) in waves.items():
        for sign in (1, -1) if (a, b) != (0, 0) else (1,):
            u = add(u, {(sign * a, sign * b, w): amplitude[name]})

    def by_x(field: Field) -> Field:
        return {(a, b, w): a * k_ * value for (a, b, w), value in field.items()}

    def by_phi(field: Field) -> Field:
        return {(a, b, w): b * n_ * value for (a, b, w), value in field.items()}

    one: Field = {(0, 0, 0): ring(1)}
    r, rx, rp = add(one, u), by_x(u), by_phi(u)
    rxx, rxp, rpp = by_x(rx), by_phi(rx), by_phi(rp)
    rx2, rp2, r2 = product(rx, rx), product(rp, rp), product(r, r)
    g = add(r2, product(r2, rx2), rp2)
    # sqrt(g) times the second fundamental form: -r r_xx, -(r r_xphi - r_x r_phi), r^2 + 2 r_phi^2 - r r_phiphi.
    m = add(
        times(-1, product(add(r2, rp2), product(r, rxx))),
        times(2, product(product(rx, rp), add(product(r, rxp), times(-1, product(rx, rp))))),
        product(add(one, rx2), add(r2, times(2, rp2), times(-1, product(r, rpp)))),
    )
    delta = add(g, times(-1, one))
    delta = {key: value for key, value in delta.items() if value != 0}
    half = sympy.QQ(1, 2)
    root = power(delta, half, ring)
    # H = m / (2 g^(3/2)): (H - c0)^2 sqrt(g) = m^2 / (4 g^(5/2)) - c0 m / g + c0^2 sqrt(g).
    energy = add(
        times(half / 2, product(product(m, m), power(delta, -5 * half, ring))),
        times(-c, product(m, power(delta, sympy.QQ(-1), ring))),
        times(c**2, root),
    )
    found = {}
    for name, density in (("energy", energy), ("area", root), ("volume", times(half, r2))):
        found[name] = {
            order: sympy.expand(
                ring(density.get((0, 0, order), 0)).as_expr().subs({K: sympy.sqrt(-kappa), N: sympy.I * n})
            )
            for order in range(ORDER + 1)
        }
    return found


def coefficient(expression: Any, **powers: int) -> Any:
    """The coefficient of a monomial in the amplitudes of a polynomial."""
    names = sorted(
        {s for s in expression.free_symbols if s.name in AMPLITUDES} | set(sympy.symbols(list(powers))), key=str
    )
    monomial = [powers.get(symbol.name, 0) for symbol in names]
    return sympy.Poly(expression, *names).coeff_monomial(monomial)


WAVES: dict[str, tuple[Wave, int]] = {
    "A": ((1, 1), 1), "B": ((1, -1), 1), "A00": ((0, 0), 2), "A22": ((2, 2), 2), "B22": ((2, -2), 2),
    "A20": ((2, 0), 2), "A02": ((0, 2), 2),
}  # fmt: skip
"""Coiling waves ``(k, n)`` and ``(k, -n)`` with all that their products excite. Pearls have ``n = 0``, wrinkles ``k = 0``,
and one of the two waves."""

AMPLITUDES = {"A", "B", "C", "A00", "A22", "B22", "A20", "A02", "A3", "B3", "C4"}


@cache
def reduced() -> dict[str, Any]:
    """The coefficients of the reduced equations at fixed area and given ``lambda2 = lambda2_c + beta2 eps^2``.

        dA/dt = A (a beta2 + b1 A^2 + b2 B^2),      lambda1 = lambda1_c - beta2 eps^2 + alpha2 (A^2 + B^2) eps^2

    A slaved wave ``s`` that the product ``p`` of critical amplitudes excites obeys ``0 = force_s p + rate_s s``; its work
    on ``A`` has the same factor, because both derive from one potential.

    Returns:
        Polynomials in ``kappa = k^2, n, c0`` and ``lambda2``, which stands for its critical value: ``neutral`` (zero there),
        ``a``, ``alpha2``, ``mean`` (the amplitude ``A00`` over ``A^2 + B^2``), ``direct1, direct2`` (``b1, b2`` without
        slaved waves), ``force22, force20, force02`` and ``rate22, rate20, rate02``.
    """
    mean = mean_by_order(WAVES)
    A, B, A00 = sympy.symbols("A B A00")
    second = mean["energy"][2] + lambda1 * mean["area"][2] + lambda2 * mean["volume"][2]
    fourth = mean["energy"][4] + lambda1 * mean["area"][4] + lambda2 * mean["volume"][4]
    potential = sympy.expand(fourth + alpha2 * mean["area"][2] + beta2 * mean["volume"][2])
    found = {"neutral": -coefficient(sympy.expand(second), A=2)}
    radius = sympy.solve(mean["area"][2], A00)[0]
    found["mean"] = sympy.expand(sympy.cancel(radius / (A**2 + B**2)))
    tension = sympy.solve(sympy.diff(potential, A00).subs(A00, radius), alpha2)[0]
    found["alpha2"] = coefficient(sympy.expand(tension), A=2)
    flow = sympy.expand((-sympy.diff(potential, A) / 2).subs(A00, radius).subs(alpha2, tension))
    found["a"] = coefficient(flow, A=1).coeff(beta2)
    found["direct1"], found["direct2"] = coefficient(flow, A=3), coefficient(flow, A=1, B=2)
    # The gradient by a slaved amplitude is twice its equation, as that by A is.
    found["force22"] = -coefficient(potential, A=2, A22=1) / 2
    found["rate22"] = -coefficient(potential, A22=2)
    for name in ("20", "02"):
        found[f"force{name}"] = -coefficient(potential, A=1, B=1, **{f"A{name}": 1}) / 2
        found[f"rate{name}"] = -coefficient(potential, **{f"A{name}": 2})
    return {name: sympy.collect(sympy.expand(value), kappa) for name, value in found.items()}


RESONANT: dict[str, tuple[Wave, int]] = {
    "A": ((1, 0), 1), "C": ((2, 0), 1), "A00": ((0, 0), 2), "A3": ((3, 0), 2), "C4": ((4, 0), 2),
}  # fmt: skip
"""Pearls of ``m`` and of ``2m`` waves with all that their products excite."""


@cache
def resonant() -> dict[str, Any]:
    """The coefficients of the two-mode equations of pearls with ``k`` and ``2k``, real amplitudes, fixed area.

        dA/dt = rate_A A + 2 force A C + A (aa A^2 + ac C^2),    dC/dt = rate_C C + force A^2 + C (ac A^2 + cc C^2)

    Returns:
        Polynomials in ``kappa, c0, lambda2``: ``force``; ``cross``, that is ``ac`` without the wave ``3k``; ``force3``, what
        ``A C`` does to that wave; ``aa``; and ``cc_direct, force4``, which are ``direct1`` and ``force22`` of ``2k``.
    """
    mean = mean_by_order(RESONANT)
    A, C, A00 = sympy.symbols("A C A00")
    third, fourth = (mean["energy"][i] + lambda1 * mean["area"][i] + lambda2 * mean["volume"][i] for i in (3, 4))
    potential = sympy.expand(fourth + alpha2 * mean["area"][2])
    radius = sympy.solve(mean["area"][2], A00)[0]
    change = sympy.solve(sympy.diff(potential, A00).subs(A00, radius), alpha2)[0]
    flow_a, flow_c = (
        sympy.expand((-sympy.diff(potential, s) / 2).subs(A00, radius).subs(alpha2, change).subs({"A3": 0, "C4": 0}))
        for s in (A, C)
    )
    found = {
        "force": -coefficient(sympy.expand(third), A=2, C=1) / 2,
        "aa": coefficient(flow_a, A=3),
        "cross": coefficient(flow_a, A=1, C=2),
        "cross_c": coefficient(flow_c, A=2, C=1),
        "cc_direct": coefficient(flow_c, C=3),
        "force3": -coefficient(potential, A=1, C=1, A3=1) / 2,
        "force4": -coefficient(potential, C=2, C4=1) / 2,
    }
    return {name: sympy.collect(sympy.expand(value.subs(n, 0)), kappa) for name, value in found.items()}


MEETING: dict[str, tuple[Wave, int]] = {
    "A": ((1, 1), 1), "B": ((1, -1), 1), "C": ((0, 2), 1), "A00": ((0, 0), 2), "A22": ((2, 2), 2), "B22": ((2, -2), 2),
    "A20": ((2, 0), 2), "A3": ((1, 3), 2), "B3": ((1, -3), 2), "C4": ((0, 4), 2),
}  # fmt: skip
"""Coiling waves ``(k, 1)`` and ``(k, -1)`` and wrinkles ``(0, 2)`` with all that their products excite."""


@cache
def meeting() -> dict[str, Any]:
    """The coefficients of the three equations of coiling waves and wrinkles, real amplitudes, fixed area.

        dA/dt = rate_A A + force B C + A (aa A^2 + ab B^2 + cross C^2),
        dC/dt = rate_C C + force A B + C (cross A^2 + cross B^2 + cc C^2)

    Returns:
        Polynomials in ``kappa, c0, lambda2``: ``force``; ``aa, ab, cross`` of the first and ``cross_c, cc`` of the second
        equation, without slaved waves; ``force13``, what ``A C`` does to the wave ``(k, 3)``.
    """
    mean = mean_by_order(MEETING)
    A, C, A00 = sympy.symbols("A C A00")
    third, fourth = (mean["energy"][i] + lambda1 * mean["area"][i] + lambda2 * mean["volume"][i] for i in (3, 4))
    potential = sympy.expand(fourth + alpha2 * mean["area"][2])
    radius = sympy.solve(mean["area"][2], A00)[0]
    change = sympy.solve(sympy.diff(potential, A00).subs(A00, radius), alpha2)[0]
    slaved = dict.fromkeys(("A22", "B22", "A20", "A3", "B3", "C4"), 0)
    flow_a, flow_c = (
        sympy.expand((-sympy.diff(potential, s) / 2).subs(A00, radius).subs(alpha2, change).subs(slaved))
        for s in (A, C)
    )
    found = {
        "force": -coefficient(sympy.expand(third), A=1, B=1, C=1) / 2,
        "aa": coefficient(flow_a, A=3),
        "ab": coefficient(flow_a, A=1, B=2),
        "cross": coefficient(flow_a, A=1, C=2),
        "cross_c": coefficient(flow_c, A=2, C=1),
        "cc": coefficient(flow_c, C=3),
        "force13": -coefficient(potential, A=1, C=1, A3=1) / 2,
    }
    return {name: sympy.collect(sympy.expand(value.subs(n, 1)), kappa) for name, value in found.items()}


def b1_and_b2() -> tuple[Any, Any]:
    """``b1`` and ``b2`` with the slaved waves eliminated, at the critical ``lambda2``."""
    f = reduced()
    b1 = f["direct1"] - 2 * f["force22"] ** 2 / f["rate22"]
    b2 = f["direct2"] - f["force20"] ** 2 / f["rate20"] - f["force02"] ** 2 / f["rate02"]
    critical = sympy.solve(f["neutral"], lambda2)[0]
    return sympy.factor(b1.subs(lambda2, critical)), sympy.factor(b2.subs(lambda2, critical))


if __name__ == "__main__":
    for equations in (reduced(), resonant(), meeting()):
        for name, value in equations.items():
            print(f"{name} = {value}")
