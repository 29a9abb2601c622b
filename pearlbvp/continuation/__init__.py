"""Path following through the ``Problem`` protocol. Knows nothing of membranes or of collocation."""

from pearlbvp.continuation.path import Path, PathOptions, follow
from pearlbvp.continuation.problem import Problem
from pearlbvp.continuation.solution import Solution

__all__ = ["Path", "PathOptions", "Problem", "Solution", "follow"]
