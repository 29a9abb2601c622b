"""Units of motions in fluids: a viscosity makes the rates of a physical tube rates in 1/s."""

from __future__ import annotations

from pearlbvp.dimensions import FLUIDS, QUANTITIES, VISCOSITY
from pearlbvp.errors import InputError
from pearlbvp.quantities import has_unit, read
from pearlbvp.units import Units


def in_fluids(units: Units, viscosity: str | float | None = None) -> Units:
    """The same units, times being those of motions in fluids, which count in the viscosity by the pressure ``2 kappa/R^3``.

    Args:
        units: of the tube.
        viscosity: of the fluid outside, ``"1mPa.s"``: then times are in seconds. Without it rates are viscosity times rate.

    Raises:
        InputError: it is no viscosity, or the radius or the rigidity is missing that it needs.

    Examples:
        >>> units = in_fluids(Units.of("0.7um", "20kT"), "1mPa.s")
        >>> round(units.to_user("rate", 0.01), 3), units.unit("rate")
        (4.992, '1/s')
    """
    units = units.of_flow(FLUIDS)
    if viscosity is None:
        return units
    if not isinstance(viscosity, str) or not has_unit(viscosity):
        raise InputError("viscosity", f"{viscosity} has no unit", "give one like 1mPa.s")
    if units.scale is None or units.scale.energy is None:
        raise InputError(
            "viscosity", f"{viscosity} needs the radius, like 50nm, and kappa, like 20kT", "give those, too"
        )
    pascal_seconds = units.scale.number("viscosity", viscosity, VISCOSITY, "Pa*s")
    if not pascal_seconds > 0:
        raise InputError("viscosity", f"{viscosity} is not above 0", "give one like 1mPa.s")
    return units.in_time(pascal_seconds / units.to_user("pressure", 1.0))


def membrane_viscosity_of(units: Units, text: str | float) -> float:
    """A membrane's surface viscosity by the viscosity of the fluid outside and the radius.

    Args:
        units: of ``in_fluids``.
        text: a surface viscosity, ``"5e-9Pa.s.m"``, or that by the fluid's, a length.

    Raises:
        InputError: it is neither, or the fluid's viscosity is missing that a surface viscosity is measured by.
    """
    quantity = units.unit("rate") != "1/s" and isinstance(text, str) and has_unit(text)
    if quantity and read("membrane_viscosity", str(text)).dimension == QUANTITIES["membrane_viscosity"]:
        raise InputError(
            "membrane_viscosity",
            f"{text} needs the viscosity of the fluid, like 1mPa.s",
            "give that, too, or a length, their ratio",
        )
    return units.from_user("membrane_viscosity", units.number("membrane_viscosity", text, "membrane_viscosity"))
