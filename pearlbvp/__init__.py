"""pearlbvp: bifurcations of Helfrich cylinders, by collocation, continuation and Bloch/Floquet stability.

An analysis needs no other import: ``Tube``, ``branch`` and what its branches can do, ``load``, ``diagram``, ``phases``,
``flow``, ``flow_shape``, ``dispersion``, ``growth``, ``amplitude``, ``localized_pearls``, ``pearl_periods``,
``stability_region``, ``equilibria``, ``atlas``, ``scan``; ``Units`` for physical tubes; ``solve_bvp`` and ``continue_bvp`` for
one's own equations.
Each name is imported when it is first asked for.
"""

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

from pearlbvp._version import __version__

if TYPE_CHECKING:
    from pearlbvp import atlas
    from pearlbvp.branch_diagram import diagram
    from pearlbvp.branches import Branch, Solution
    from pearlbvp.bvp import continue_bvp, solve_bvp
    from pearlbvp.errors import InputError
    from pearlbvp.front import amplitude, branch, dispersion, load
    from pearlbvp.helfrich import Tube
    from pearlbvp.phase_diagram import phases
    from pearlbvp.scans.scan import scan
    from pearlbvp.shape_flow import Flow, flow, flow_shape
    from pearlbvp.studies.equilibria import equilibria
    from pearlbvp.studies.families import register
    from pearlbvp.studies.growth import growth
    from pearlbvp.studies.localized import localized_pearls
    from pearlbvp.studies.period import pearl_periods
    from pearlbvp.studies.region import stability_region
    from pearlbvp.units import Units

for _threads in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"):
    os.environ.setdefault(
        _threads, "1"
    )  # read when numpy is loaded: of small matrices several threads wait for each other

_HOMES = {
    "Branch": "branches:Branch",
    "Flow": "shape_flow:Flow",
    "InputError": "errors:InputError",
    "Solution": "branches:Solution",
    "Tube": "helfrich:Tube",
    "Units": "units:Units",
    "amplitude": "front:amplitude",
    "atlas": "atlas:",
    "branch": "front:branch",
    "continue_bvp": "bvp:continue_bvp",
    "diagram": "branch_diagram:diagram",
    "dispersion": "front:dispersion",
    "equilibria": "studies.equilibria:equilibria",
    "flow": "shape_flow:flow",
    "flow_shape": "shape_flow:flow_shape",
    "growth": "studies.growth:growth",
    "load": "front:load",
    "localized_pearls": "studies.localized:localized_pearls",
    "pearl_periods": "studies.period:pearl_periods",
    "phases": "phase_diagram:phases",
    "register": "studies.families:register",
    "scan": "scans.scan:scan",
    "solve_bvp": "bvp:solve_bvp",
    "stability_region": "studies.region:stability_region",
}

__all__ = [
    "Branch",
    "Flow",
    "InputError",
    "Solution",
    "Tube",
    "Units",
    "__version__",
    "amplitude",
    "atlas",
    "branch",
    "continue_bvp",
    "diagram",
    "dispersion",
    "equilibria",
    "flow",
    "flow_shape",
    "growth",
    "load",
    "localized_pearls",
    "pearl_periods",
    "phases",
    "register",
    "scan",
    "solve_bvp",
    "stability_region",
]


def __getattr__(name: str) -> Any:
    """A public name, from the room in which it lives."""
    if name not in _HOMES:
        raise AttributeError(f"module 'pearlbvp' has no attribute {name!r}; see dir(pearlbvp)")
    room, _, found = _HOMES[name].partition(":")
    module = import_module(f"pearlbvp.{room}")
    return getattr(module, found) if found else module


def __dir__() -> list[str]:
    return __all__
