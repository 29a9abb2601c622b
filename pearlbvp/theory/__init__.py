"""Closed forms: dispersion relation of the straight cylinder."""
