"""Reservoirs in physical units: solute by its concentration, area-difference elasticity by its modulus.

Solute of the concentration ``c`` at the volume ``pi R^2 L`` of the straight tube is ``N = c RT pi R^2 L/(2 kappa)`` of the law
``lambda2 = C - N/V`` (``docs/theory/model.md``). The modulus ``kbar`` of ``pi kbar/(2 A D^2) (Delta A - Delta A0)^2`` (L. Miao,
U. Seifert, M. Wortis, H.-G. Doebereiner, Phys. Rev. E 49 (1994) 5389) is ``alpha = kbar/kappa`` of ``(pi alpha/A)(M - M0)^2``
by ``2 kappa``, for ``Delta A = 2 D M``. Both ``kappa`` are that of ``kappa/2 (2H - C0)^2``, in either convention.
"""

from __future__ import annotations

import math

from pearlbvp.errors import InputError
from pearlbvp.quantities import ENERGY, PRESSURE, Dimension, has_unit, read
from pearlbvp.scale import Scale


def in_radii(fix: str, scale: Scale | None, pressure: float, length: float) -> str:
    """What is held, in pure numbers; what has no unit stays, for ``held.known_held`` to read.

    Args:
        fix: ``tension,osmotic=300mM``.
        scale: of the tube, None without one.
        pressure: ``2 kappa/R^3`` of the tube in Pa, if the scale has a rigidity.
        length: of the whole tube, in radii.

    Raises:
        InputError: a unit of another dimension, or the radius or the rigidity is missing.
    """
    return ",".join(_in_radii(part, scale, pressure, length) for part in fix.split(","))


def _in_radii(part: str, scale: Scale | None, pressure: float, length: float) -> str:
    """One of the things that are held."""
    name, _, value = (piece.strip() for piece in part.partition("="))
    if name not in ("osmotic", "ade") or not has_unit(value):
        return part
    if scale is None or scale.energy is None:
        raise InputError(
            "fix",
            f"{name}={value} takes the tube's radius and rigidity",
            "give radius=50nm or the like, and give kappa=20kT",
        )
    if name == "ade":
        modulus = _si(value, ENERGY, (f"ade={value} is no energy", "give one like 60kT"), scale)
        return f"ade={2 * modulus / scale.energy!r}"  # which is 2 kappa
    wrong = f"osmotic={value} is no concentration", "give one like 300mM"
    osmotic = _si(f"{value}*kT/particle", PRESSURE, wrong, scale)
    return f"osmotic={osmotic / pressure * math.pi * length!r}"


def _si(text: str, dimension: Dimension, wrong: tuple[str, str], scale: Scale) -> float:
    """A quantity in SI units.

    Raises:
        InputError: it is of another dimension.
    """
    try:
        amount = read("fix", text, scale.temperature)
    except InputError:
        raise InputError("fix", *wrong) from None
    if amount.dimension != dimension:
        raise InputError("fix", *wrong)
    return amount.value
