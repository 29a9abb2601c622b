"""pearlbvp: bifurcations of Helfrich cylinders, by collocation, continuation and Bloch/Floquet stability."""

from pearlbvp._version import __version__

__all__ = ["__version__"]
