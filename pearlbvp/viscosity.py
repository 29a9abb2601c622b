"""Units of motions in fluids: a viscosity makes the rates of a physical tube rates in 1/s."""

from __future__ import annotations

from pearlbvp.dimensions import FLUIDS, VISCOSITY
from pearlbvp.errors import InputError
from pearlbvp.helfrich import positive
from pearlbvp.quantities import has_unit
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
        raise InputError(f"viscosity: {viscosity} has no unit; give one like 1mPa.s")
    if units.scale is None or units.scale.energy is None:
        raise InputError(f"viscosity: {viscosity} needs the radius, like 50nm, and kappa, like 20kT; give those, too")
    pascal_seconds = positive("viscosity", units.scale.number("viscosity", viscosity, VISCOSITY, "Pa*s"))
    return units.in_time(pascal_seconds / units.to_user("pressure", 1.0))
