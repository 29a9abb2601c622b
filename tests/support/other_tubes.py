"""The equilibrium of a branch's kind on a tube that is slightly another: by Newton's method on the same mesh, or modes."""

from dataclasses import replace

from pearlbvp.continuation.path import correct_at
from pearlbvp.newton import NewtonOptions
from pearlbvp.shapes.pearl import PearlProblem


def on_tube(problem, u, c0, length, v):
    """Observables of the equilibrium near ``u`` on a tube of another ``c0``, length and reduced volume."""
    if isinstance(problem, PearlProblem):
        d = problem.discretization
        values = {"c0": c0, "length": length / problem.cells / (2 if problem.half else 1)}
        parameters = d.all_parameters(u)
        for name, value in values.items():
            parameters[d.problem.parameters.index(name)] = value
        problem = replace(problem, discretization=replace(d, parameters=parameters))
    else:
        problem = replace(problem, c0=c0, length=length)
    guess = u.copy()
    guess[-1] = v
    found, _ = correct_at(problem, guess, NewtonOptions(max_iterations=20))
    assert found.converged, found.message
    return problem.observables(found.u)


def stretched(problem, u, factor):
    """Observables, and the whole bending energy, where the same area and volume are on another length.

    A radius is area by length, ``1/factor``: in radii of its own tube the length is ``factor^2`` times as large.
    """
    known = problem.observables(u)
    observed = on_tube(problem, u, known["c0"] / factor, known["L"] * factor**2, known["v"] * factor)
    return observed, 2 * 3.141592653589793 * observed["L"] * observed["E"]


def derivative(function, at, step):
    """By central differences of fourth order."""
    near = function(at + step) - function(at - step)
    far = function(at + 2 * step) - function(at - 2 * step)
    return (8 * near - far) / (12 * step)
