"""A user's own boundary-value problem: solved by ``collocation``, followed by ``continuation``. Knows nothing of membranes."""

from pearlbvp.bvp.branch import BvpBranch, continue_bvp
from pearlbvp.bvp.solve import BvpSolution, solve_bvp

__all__ = ["BvpBranch", "BvpSolution", "continue_bvp", "solve_bvp"]
