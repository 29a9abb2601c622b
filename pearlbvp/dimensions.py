"""The dimension of every quantity that columns, options, sentences and axes name, and what axes say of it."""

from __future__ import annotations

from collections.abc import Mapping

from pearlbvp.quantities import AREA, CURVATURE, ENERGY, FORCE, LENGTH, NUMBER, PRESSURE, TENSION, VOLUME, Dimension

VISCOSITY = Dimension(-3, 1, 1)
SPONTANEOUS = Dimension(-1, spontaneous=1)
TIME, RATE, VELOCITY = Dimension(time=1), Dimension(time=-1), Dimension(1, -1)
"""Of the gradient flow, whose velocity is a pressure times a mobility."""

QUANTITIES: Mapping[str, Dimension] = {
    **dict.fromkeys(("L", "length", "lengths", "period", "periods", "x", "r", "y", "z", "r_min", "r_max", "amplitude", "wave",
                     "gap", "delta", "centre", "shape", "edge", "M", "M0"), LENGTH),
    **dict.fromkeys(("k", "H"), CURVATURE), "c0": SPONTANEOUS, "force": FORCE, "torque": ENERGY,
    **dict.fromkeys(("lambda1", "E", "E_least_energy", "E_other", "excess"), TENSION),
    **dict.fromkeys(("lambda2", "lambda2_pearl", "lambda2_upper", "lower_lambda2", "upper_lambda2", "lambda2_other",
                     "pressure", "osmolarity"), PRESSURE),
    **dict.fromkeys(("lambda1_predicted", "E_predicted"), TENSION), "lambda2_predicted": PRESSURE,
    **dict.fromkeys(("A", "wave_predicted"), LENGTH), "a": Dimension(3, -1, -1), "alpha2": Dimension(-4, energy=1),
    **dict.fromkeys(("b", "b1", "b2"), Dimension(-2, -1)),
    "area": AREA, "volume": VOLUME, "volume_by_length": AREA, "xi": Dimension(-2),
    "t": TIME, "velocity": VELOCITY, **dict.fromkeys(("mu_crit", "mu_error", "rate"), RATE),
    "wavelength": LENGTH, "wave_numbers": CURVATURE, **dict.fromkeys(("lambda1_lower", "lambda1_pearl", "tension"), TENSION),
    "mu": Dimension(-4, energy=1), "mu_diffusion": Dimension(-6, energy=1),  # of two flows beside each other, mobilities 1
    "viscosity": VISCOSITY, "membrane_viscosity": Dimension(-2, 1, 1),
    **dict.fromkeys(("v", "v_localized", "v_reduced", "area_error", "volume_error", "quality_worst", "quality_mean",
                     "m", "n", "point", "pearls", "pearls_least_energy", "kernel", "n_unstable", "nodes", "triangles",
                     *(f"{name}_{what}" for name in ("lambda1", "lambda2", "E", "wave") for what in ("error", "order")),
                     "viscosity_ratio", "rank", "branches", "depth", "starts", "rest_here", "multiplicity",
                     *(f"{name}_{end}" for name in ("v", "n", "theta") for end in ("from", "to")),
                     "slope", "phi", "psi", "vertex", "i", "j"), NUMBER),
}  # fmt: skip
"""Dimensions by the names that columns, options and the numbers of sentences have."""

AXES: Mapping[str, str] = {
    "L": "length L", "x": "axial position x", "k": "wave number k", "c0": "spontaneous curvature c0",
    "v": "reduced volume v", "E": "energy by area E/A", "lambda1": "tension lambda1", "lambda2": "pressure lambda2",
    "force": "axial force", "torque": "torque", "M": "integrated mean curvature M",
    "osmolarity": "osmotic pressure outside", "M0": "preferred integrated mean curvature M0",
    "t": "time t", "velocity": "largest velocity", "r": "distance from the axis",
}  # fmt: skip
"""What the axes of pictures say of quantities, before their units."""

LAW = "area and volume"
FLUIDS = "fluids"
TIME_POWERS: Mapping[str, int] = {LAW: 4, "area": 4, "diffusion": 6, FLUIDS: 3}
"""Powers of length in the time of each flow: velocities are ``-dF``, or its Laplacian for diffusion; of fluids it is their
viscosity by an energy by volume, so that a viscosity of the membrane is a length."""
