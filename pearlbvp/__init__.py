"""pearlbvp: bifurcations of Helfrich cylinders, by collocation, continuation and Bloch/Floquet stability.

An analysis needs no other import: ``Tube``, ``branch`` and what its branches can do, ``load``, ``diagram``, ``phases``,
``flow``, ``flow_shape``, ``dispersion``, ``growth``, ``amplitude``, ``localized_pearls``, ``pearl_periods``,
``stability_region``, ``equilibria``, ``atlas``, ``scan``; ``Units`` for physical tubes; ``solve_bvp`` and ``continue_bvp`` for
one's own equations.
Each name is imported when it is first asked for.
"""

import os
from typing import TYPE_CHECKING

from pearlbvp._version import __version__
from pearlbvp.public import offered

if TYPE_CHECKING:
    from pearlbvp import atlas, meshes, theory
    from pearlbvp.branch_diagram import diagram
    from pearlbvp.branches import Branch
    from pearlbvp.bvp import continue_bvp, solve_bvp
    from pearlbvp.errors import InputError
    from pearlbvp.front import amplitude, branch, dispersion, load, plot_shapes, predicted_branch
    from pearlbvp.helfrich import Tube
    from pearlbvp.instabilities import amplitude_map
    from pearlbvp.phase_diagram import phases
    from pearlbvp.scans.scan import scan
    from pearlbvp.shape_flow import Flow, flow, flow_shape
    from pearlbvp.solutions import Solution
    from pearlbvp.studies.equilibria import equilibria
    from pearlbvp.studies.families import register
    from pearlbvp.studies.growth import growth
    from pearlbvp.studies.localized import PeriodicPearls, localized_pearls
    from pearlbvp.studies.period import pearl_periods
    from pearlbvp.studies.region import stability_region
    from pearlbvp.studies.ring_onsets import ring_onsets
    from pearlbvp.units import Units

for _threads in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"):
    os.environ.setdefault(
        _threads, "1"
    )  # read when numpy is loaded: of small matrices several threads wait for each other

_HOMES = {
    "Branch": "branches:Branch",
    "Flow": "shape_flow:Flow",
    "InputError": "errors:InputError",
    "PeriodicPearls": "studies.localized:PeriodicPearls",
    "Solution": "solutions:Solution",
    "Tube": "helfrich:Tube",
    "Units": "units:Units",
    "amplitude": "front:amplitude",
    "amplitude_map": "instabilities:amplitude_map",
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
    "meshes": "meshes:",
    "pearl_periods": "studies.period:pearl_periods",
    "phases": "phase_diagram:phases",
    "plot_shapes": "front:plot_shapes",
    "predicted_branch": "front:predicted_branch",
    "register": "studies.families:register",
    "ring_onsets": "studies.ring_onsets:ring_onsets",
    "scan": "scans.scan:scan",
    "solve_bvp": "bvp:solve_bvp",
    "stability_region": "studies.region:stability_region",
    "theory": "theory:",
}

__all__ = [
    "Branch",
    "Flow",
    "InputError",
    "PeriodicPearls",
    "Solution",
    "Tube",
    "Units",
    "__version__",
    "amplitude",
    "amplitude_map",
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
    "meshes",
    "pearl_periods",
    "phases",
    "plot_shapes",
    "predicted_branch",
    "register",
    "ring_onsets",
    "scan",
    "solve_bvp",
    "stability_region",
    "theory",
]


__getattr__, __dir__ = offered(__name__, _HOMES, "__version__")
