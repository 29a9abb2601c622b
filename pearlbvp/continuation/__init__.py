"""Path following through the ``Problem`` protocol. Knows nothing of membranes or of collocation."""

from pearlbvp.continuation.path import Path, PathOptions, Point, follow
from pearlbvp.continuation.problem import Problem

__all__ = ["Path", "PathOptions", "Point", "Problem", "follow"]
