"""Localized pearls of all tubes of 0.26 <= c0 <= 0.49, looked up instead of computed.

The functions that ``studies.pearl_series`` resolves in the period and the amplitude are analytic in ``c0``, too: one series in
three variables, which comes with the package (``python -m pearlbvp.atlas`` computes it anew).
"""

from pearlbvp.atlas.lookup import holds, localized

__all__ = ["holds", "localized"]
