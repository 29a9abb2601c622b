"""Closed forms: dispersion of the straight tube, amplitude equations, resonances, elastic rings, unduloids.

``pb.theory.NAME``, or ``from pearlbvp.theory import NAME``; each name is imported when it is first asked for.

Examples:
    >>> import pearlbvp as pb
    >>> equation = pb.theory.amplitude_equation(pb.Tube(c0=0, L=10), (1, 0))
    >>> equation.supercritical("pearl"), round(equation.cubic("pearl"), 3)  # dA/dt = A (a p + b A^2)
    (True, -2.955)
    >>> round(pb.theory.touching_ring(2).v, 6)  # where a ring of two lobes touches itself
    0.270948
"""

from typing import TYPE_CHECKING

from pearlbvp.public import offered

if TYPE_CHECKING:
    from pearlbvp.theory.amplitude import AmplitudeEquation, amplitude_equation
    from pearlbvp.theory.codimension_two import exchange_lengths, meeting_c0
    from pearlbvp.theory.dispersion import (
        StableInterval,
        critical_lambda2,
        critical_wave_number,
        growth_rate,
        long_tube_interval,
        stable_interval,
        stable_wave_numbers,
    )
    from pearlbvp.theory.elastica import ElasticRing, ring_at, touching_ring
    from pearlbvp.theory.meeting import WrinklesAndCoils
    from pearlbvp.theory.modulation import loss_of_stability, marginal_c0
    from pearlbvp.theory.osmotic import onset_sizes
    from pearlbvp.theory.resonance import Resonance, resonant_lengths
    from pearlbvp.theory.unduloid import Unduloid, unduloid_of

_HOMES = {
    "AmplitudeEquation": "amplitude:AmplitudeEquation",
    "ElasticRing": "elastica:ElasticRing",
    "Resonance": "resonance:Resonance",
    "StableInterval": "dispersion:StableInterval",
    "Unduloid": "unduloid:Unduloid",
    "WrinklesAndCoils": "meeting:WrinklesAndCoils",
    "amplitude_equation": "amplitude:amplitude_equation",
    "critical_lambda2": "dispersion:critical_lambda2",
    "critical_wave_number": "dispersion:critical_wave_number",
    "exchange_lengths": "codimension_two:exchange_lengths",
    "growth_rate": "dispersion:growth_rate",
    "long_tube_interval": "dispersion:long_tube_interval",
    "loss_of_stability": "modulation:loss_of_stability",
    "marginal_c0": "modulation:marginal_c0",
    "meeting_c0": "codimension_two:meeting_c0",
    "onset_sizes": "osmotic:onset_sizes",
    "resonant_lengths": "resonance:resonant_lengths",
    "ring_at": "elastica:ring_at",
    "stable_interval": "dispersion:stable_interval",
    "stable_wave_numbers": "dispersion:stable_wave_numbers",
    "touching_ring": "elastica:touching_ring",
    "unduloid_of": "unduloid:unduloid_of",
}

__all__ = [
    "AmplitudeEquation",
    "ElasticRing",
    "Resonance",
    "StableInterval",
    "Unduloid",
    "WrinklesAndCoils",
    "amplitude_equation",
    "critical_lambda2",
    "critical_wave_number",
    "exchange_lengths",
    "growth_rate",
    "long_tube_interval",
    "loss_of_stability",
    "marginal_c0",
    "meeting_c0",
    "onset_sizes",
    "resonant_lengths",
    "ring_at",
    "stable_interval",
    "stable_wave_numbers",
    "touching_ring",
    "unduloid_of",
]

__getattr__, __dir__ = offered(__name__, _HOMES)
