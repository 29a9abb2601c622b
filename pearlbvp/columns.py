"""What the columns of all tables mean, as files of tables say it; ``docs/conventions.md`` says the same with formulas."""

from __future__ import annotations

from collections.abc import Mapping

from pearlbvp.tables import name_of

MEANINGS: Mapping[str, str] = {
    "c0": "spontaneous curvature of (H - c0)^2; in units, C0 is that of (2H - C0)^2",
    "L": "axial period of the tube",
    "period": "axial period of the pearls",
    "pearls": "how many pearls on the tube",
    "length": "length of the tube",
    "m": "waves along the tube",
    "n": "waves around the tube",
    "k": "wave number along the tube, 2 pi m/L",
    "type": "what branches off: pearl, ring, coil or buckle",
    "kernel": "dimension of the space of neutral modes",
    "role": "of the mode: lower or upper end of the straight tube's stable interval, or the fastest that grows",
    "lambda1": "surface tension, multiplier of the area",
    "lambda2": "pressure difference, multiplier of the volume",
    "v": "reduced volume, V/(pi L) at the area 2 pi L",
    "E": "energy by area, of the integral of (H - c0)^2",
    "M": "integrated mean curvature, the integral of H",
    "force": "axial force that the tube pulls its ends together with",
    "torque": "dE/d(twist) at fixed area, volume and length",
    "osmolarity": "osmotic pressure outside",
    "M0": "integrated mean curvature that area differences pull towards",
    "amplitude": "half of r_max - r_min",
    "r_min": "smallest radius, from the centres of the sections",
    "r_max": "largest radius, from the centres of the sections",
    "wave": "2A of the amplitude equations, of the largest wave",
    "n_unstable": "how many perturbations grow, of all that fit the tube",
    "mu_crit": "largest growth rate, rigid motions left out",
    "mu_error": "error of growth rates, as rigid motions show it",
    "critical": "symmetry block of the perturbation of the largest growth rate",
    "point": "number of the point on its branch",
    "special": "start, bp (branch point), fold:NAME, cmc, stop (what was wanted), end",
    "branch": "name of the branch",
    "family": "family of shapes",
    "symmetry": "symmetry of the shape",
    "rank": "place by energy among the stable shapes of that volume, 1 the least",
    "excess": "how far it is above: E above the least energy of that volume, or measured/bead - 1",
    "branches": "how many branches were followed",
    "depth": "switches of branch from the straight tube on",
    "starts": "random shapes that were relaxed",
    "rest_here": "how many of these came to rest on this shape",
    "origin": "how the shape was found",
    "multiplicity": "how many shapes of the branch lie at that volume",
    "event": "what happens there to the shapes that a tube takes",
    "other": "the other branch, or the other mode",
    "falls_to": "branch on which the flow ends from there",
    "status": "found, or why there is no answer; failed where it could not be computed",
    "localized_status": "as status, of the localized pearl",
    "message": "why, in words",
    "wavelength": "2 pi/k",
    "rate": "growth rate in the fluids",
    "mu": "growth rate in the L2 flow, at fixed area and volume",
    "mu_diffusion": "growth rate in the H^-1 flow (diffusion)",
    "lambda1_lower": "tension below which waves grow that are no pearls",
    "lambda1_pearl": "tension above which pearls grow",
    "a": "linear coefficient of the amplitude equation",
    "b": "cubic coefficient of the amplitude equation",
    "b1": "cubic coefficient of a wave by itself",
    "b2": "cubic coefficient of a wave by the other one",
    "alpha2": "change of lambda1 by the amplitude's square",
    "stable": "which family is stable at its onset at fixed area and volume",
    "criticality": "supercritical: the branch is on the straight tube's unstable side; or subcritical",
    "mode": "waves along and around, m:n",
    "end": "which end of the straight tube's stable interval",
    "lambda2_pearl": "pressure at which the straight tube loses stability to pearls",
    "lambda2_upper": "the other end of the straight tube's stable interval",
    "upper_mode": "mode at that other end, m:n",
    "v_from": "reduced volume from which on they are stable",
    "from_limit": "what begins there: a wave, a fold, the unduloid, the straight tube or a thin neck",
    "n_from": "waves around the tube of the perturbation that is neutral there",
    "theta_from": "phase by which it changes from pearl to pearl",
    "v_to": "reduced volume up to which they are stable",
    "to_limit": "what ends there: a wave, a fold, the unduloid, the straight tube or a thin neck",
    "n_to": "waves around the tube of the perturbation that is neutral there",
    "theta_to": "phase by which it changes from pearl to pearl",
    "v_localized": "reduced volume at which the localized pearl takes over",
    "pearls_least_energy": "number of equal pearls of least energy",
    "t": "time",
    "area_error": "relative change of the area since the start",
    "volume_error": "relative change of the volume since the start",
    "velocity": "largest velocity along the normal",
    "area": "surface area; of a flow by that of the straight tube",
    "volume": "enclosed volume; in tables of tubes by that of the straight tube",
    "v_reduced": "reduced volume of the similar shape of area 1, v/area^2",
    "nodes": "vertices of the mesh",
    "triangles": "triangles of the mesh",
    "quality_worst": "largest of the longest edge times perimeter by twice the area, at best 3.46",
    "quality_mean": "mean of the longest edge times perimeter by twice the area",
    "x": "position along the axis",
    "y": "position across the axis",
    "z": "position across the axis",
    "r": "distance from the axis",
    "psi": "angle of the tangent, in radians",
    "H": "mean curvature, half the sum of the principal curvatures; +1/2 on the unit cylinder",
    "i": "number along the tube",
    "j": "number around the tube",
    "A": "amplitude of the amplitude equations",
    "figure": "figure or table of the paper",
    "label": "which sample, branch or row of it",
    "quantity": "what is compared",
    "printed": "as the paper prints it",
    "computed": "as computed here",
    "difference": "computed minus printed",
    "verdict": "agrees, erratum or otherwise",
    "right": "whose number is right",
    "why": "the reason, in words",
    "equilibria": "how many shapes are in equilibrium at that spacing",
    "bead": "largest diameter",
    "neck": "smallest diameter",
    "pressure": "pressure inside minus outside",
    "energy": "bending, tension times area and osmotic work by length, above those of the straight tube",
    "straight": "diameter of the straight tube with its pressure",
    "straight_unstable": "how many waves grow on the straight tube",
    "stable_spacings": "spacings that fit the tube at which pearls are stable",
    "best_spacing": "the one of lowest energy among these",
    "best_bead": "bead diameter at the best spacing",
    "radius": "radius of the straight tube without a pressure",
    "kappa": "bending rigidity",
    "tension": "tension of the membrane",
    "solute": "concentration of solute inside",
    "dilution": "factor by which the osmotic pressure is divided",
    "spacing": "axial period of the pearls",
    "measured": "measured diameter of the beads",
    "temperature": "temperature",
}
"""By name."""

PREFIXES: Mapping[str, str] = {
    "lower_": "at the lower end of the stable interval: ",
    "upper_": "at the upper end of the stable interval: ",
}
"""Before the name of what it is."""

SUFFIXES: Mapping[str, str] = {
    "_predicted": "predicted by the amplitude equation: ",
    "_error": "difference of the prediction by the change since the onset: ",
    "_order": "order in A at which that error falls: ",
    "_other": "of the other branch: ",
    "_least_energy": "of the equal pearls of least energy: ",
}
"""Behind the name of what it is."""


def meaning(heading: str) -> str:
    """What a column is, in words; empty for one that is not known, such as a user's own.

    Examples:
        >>> meaning("r_min[nm]")
        'smallest radius, from the centres of the sections'
    """
    name = name_of(heading)
    name = "c0" if name == "C0" else name
    if name in MEANINGS:
        return MEANINGS[name]
    for prefix, words in PREFIXES.items():
        if name.startswith(prefix) and (rest := name.removeprefix(prefix)) in MEANINGS:
            return words + MEANINGS[rest]
    for suffix, words in SUFFIXES.items():
        if name.endswith(suffix) and (rest := name.removesuffix(suffix)) in MEANINGS:
            return words + MEANINGS[rest]
    return ""
