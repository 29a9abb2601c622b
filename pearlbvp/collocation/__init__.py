"""Gauss collocation for boundary-value problems of ordinary differential equations, with an adaptive mesh.

Knows nothing of membranes or of continuation.
"""

from pearlbvp.collocation.discretization import Collocated, Discretization
from pearlbvp.collocation.mesh import equidistribute, error_estimate, intervals_for
from pearlbvp.collocation.polynomial import PiecewisePolynomial
from pearlbvp.collocation.problem import BoundaryValueProblem
from pearlbvp.collocation.scheme import Scheme, gauss_scheme
from pearlbvp.collocation.solve import BoundaryValueSolution, solve_bvp

__all__ = [
    "BoundaryValueProblem",
    "BoundaryValueSolution",
    "Collocated",
    "Discretization",
    "PiecewisePolynomial",
    "Scheme",
    "equidistribute",
    "error_estimate",
    "gauss_scheme",
    "intervals_for",
    "solve_bvp",
]
