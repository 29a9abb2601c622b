"""Factors of sparse symmetric matrices by each library that is installed, against dense algebra."""

from importlib.util import find_spec

import numpy as np
import pytest
from scipy import sparse

from pearlbvp.factorization import by_pardiso, by_superlu, factorized
from pearlbvp.mesh.families import tube_mesh
from pearlbvp.mesh.functional import Functional

LIBRARIES = [by_superlu, *([by_pardiso] if find_spec("pymklpardiso") else [])]
"""PARDISO is an extra."""


def graph(nodes: int) -> sparse.csr_matrix:
    """Of the edges and of pairs of edges of a triangulated tube: as the Hessians of bending have it."""
    mesh = tube_mesh(10.0, nodes)
    edges = sparse.csr_matrix((np.ones(len(mesh.tail)), (mesh.tail, mesh.head)), shape=(mesh.count, mesh.count))
    return sparse.csr_matrix(edges + edges @ edges)


def matrix(shift: float, seed: int = 3) -> sparse.csc_matrix:
    """Random entries; the smaller the shift, the more eigenvalues are negative."""
    rng = np.random.default_rng(seed)
    pattern = graph(400)
    entries = pattern.tocoo()
    upper = entries.row < entries.col
    half = sparse.coo_matrix(
        (rng.standard_normal(int(upper.sum())), (entries.row[upper], entries.col[upper])), shape=pattern.shape
    )
    diagonal = sparse.diags(shift + rng.standard_normal(pattern.shape[0]))
    return sparse.csc_matrix(half + half.T + diagonal)


@pytest.mark.parametrize("factorize", LIBRARIES)
@pytest.mark.parametrize("shift", [50.0, 6.0, 0.0], ids=["definite", "few negative", "half negative"])
def test_solutions_and_inertia_are_those_of_dense_algebra(factorize, shift):
    whole = matrix(shift)
    dense = whole.toarray()
    values = np.linalg.eigvalsh(dense)
    factors = factorize(whole)
    assert factors.negative == (values < 0).sum()
    assert (shift > 10) == (factors.negative == 0)
    load = np.random.default_rng(1).standard_normal((len(dense), 3))
    found = factors.solve(load)
    # Pivots that leave the diagonal or the block but seldom let the rounding grow, the more the less definite.
    assert np.abs(found - np.linalg.solve(dense, load)).max() < (1e-10 if shift else 1e-6) * np.abs(found).max()
    np.testing.assert_allclose(factors.solve(load[:, 1]), found[:, 1], rtol=1e-8)


@pytest.mark.parametrize("factorize", LIBRARIES)
def test_the_second_variation_of_a_tube_as_by_dense_algebra(factorize):
    functional = Functional(tube_mesh(10.0, 400))
    vertices = functional.vertices_near(functional.mesh.vertices)
    second = functional.hessian(vertices, functional.directions, 0.0, 30.0, -30.0)  # past the first branch points
    free = np.setdiff1d(np.arange(functional.mesh.count), functional.pins)
    held = second[free][:, free].tocsc()
    dense, load = held.toarray(), np.sin(np.arange(len(free), dtype=float))
    factors = factorize(held)
    assert factors.negative == (np.linalg.eigvalsh(dense) < 0).sum() > 2
    expected = np.linalg.solve(dense, load)
    assert np.abs(factors.solve(load) - expected).max() < 1e-10 * np.abs(expected).max()


@pytest.mark.parametrize("factorize", LIBRARIES)
def test_factors_that_are_still_held_keep_their_matrix(factorize):
    first, second = matrix(50.0), matrix(60.0, seed=4)
    load = np.ones(first.shape[0])
    of_first = factorize(first)
    of_second = factorize(second)
    for whole, factors in ((first, of_first), (second, of_second)):
        assert np.abs(whole @ factors.solve(load) - load).max() < 1e-12
    del of_first, of_second, factors
    again = factorize(first)  # on the ordering of those that went
    assert np.abs(first @ again.solve(load) - load).max() < 1e-12
    assert again.negative == 0


@pytest.mark.parametrize("factorize", [*LIBRARIES, factorized])
def test_a_diagonal_is_solved_and_counted(factorize):
    factors = factorize(sparse.diags(np.arange(-499.5, 500.5), format="csc"))
    assert factors.negative == 500
    assert np.abs(factors.solve(np.ones(1000)) * np.arange(-499.5, 500.5) - 1).max() < 1e-14


@pytest.mark.parametrize("factorize", LIBRARIES)
def test_singular_matrices_are_refused_and_the_next_one_is_not(factorize):
    singular = sparse.kron(sparse.eye(150), [[1.0, -1.0], [-1.0, 1.0]], format="csc")
    regular = sparse.csc_matrix(singular + sparse.eye(300))
    load = np.sin(np.arange(300.0))
    for _ in range(2):
        with pytest.raises(np.linalg.LinAlgError):
            factorize(singular)
        assert np.abs(regular @ factorize(regular).solve(load) - load).max() < 1e-12


@pytest.mark.parametrize("entry", [0.0, np.nan])
def test_what_is_singular_or_not_finite_is_refused(entry):
    broken = sparse.diags(np.append(entry, np.ones(299)), format="csc")
    with pytest.raises(np.linalg.LinAlgError):
        factorized(broken)
