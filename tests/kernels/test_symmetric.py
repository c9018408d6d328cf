"""Eigenvalues by Jacobi's rotations against LAPACK's, of matrices with all kinds of spectra."""

import numpy as np
import pytest

from draws import draws
from standoff.kernels.algebra.symmetric import least_norm_solve, symmetric_eigen

SPECTRA = {
    "spread": [1e-12, 1e-6, 1.0, 3.0, -2.0, -1e-3, 0.5, 1e-9],
    "double": [1.0, 1.0, 2.0, 2.0, -1.0, -1.0, 0.5, 0.5],
    "one": [2.0] * 8,
    "singular": [0.0, 0.0, 1.0, -3.0, 0.0, 2.0, 0.7, 0.0],
    "great": [1e150, 1e149, -1e150, 3e150, 1e148, 2e150, 1e150, 5e149],
}


def matrix_of(spectrum, n, rng):
    vectors = np.linalg.qr(rng.normal(size=(n, n)))[0]
    found = vectors @ np.diag(spectrum[:n]) @ vectors.T
    return 0.5 * (found + found.T)


@pytest.mark.parametrize("n", [2, 4, 8])
@pytest.mark.parametrize("kind", SPECTRA)
@pytest.mark.parametrize("number", range(draws(3)))
def test_they_are_those_of_lapack(kind, n, number, rng):
    A = matrix_of(SPECTRA[kind], n, rng)
    vectors, values = A.ravel().copy(), np.zeros(n)
    assert symmetric_eigen(vectors, values, n)
    scale = np.abs(A).max()
    np.testing.assert_allclose(values, np.linalg.eigvalsh(A), rtol=0.0, atol=4e-15 * n * scale)
    V = vectors.reshape(n, n)
    np.testing.assert_allclose(V @ V.T, np.eye(n), atol=4e-15 * n)
    np.testing.assert_allclose(A @ V.T, V.T * values, rtol=0.0, atol=4e-15 * n * scale)


def test_a_diagonal_matrix_and_none_at_all():
    values = np.zeros(4)
    vectors = np.diag([3.0, -1.0, 0.0, 2.0]).ravel()
    assert symmetric_eigen(vectors, values, 4)
    np.testing.assert_array_equal(values, [-1.0, 0.0, 2.0, 3.0])
    np.testing.assert_array_equal(np.abs(vectors.reshape(4, 4)), np.eye(4)[[1, 2, 3, 0]])
    zero = np.zeros(16)
    assert symmetric_eigen(zero, values, 4)
    np.testing.assert_array_equal(values, 0.0)


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_what_is_not_finite_is_refused(wrong):
    A, b = np.eye(4).ravel(), np.ones(4)
    A[5] = wrong
    assert not symmetric_eigen(A.copy(), np.zeros(4), 4)
    assert not least_norm_solve(A, b, 4, 1e-12)
    b[2] = wrong
    assert not least_norm_solve(np.eye(4).ravel(), b, 4, 1e-12)


@pytest.mark.parametrize("kind", ["spread", "double", "one", "singular"])
@pytest.mark.parametrize("number", range(draws(3)))
def test_the_solution_of_least_norm(kind, number, rng):
    A = matrix_of(SPECTRA[kind], 8, rng)
    right = rng.normal(size=8)
    x = right.copy()
    assert least_norm_solve(A.ravel().copy(), x, 8, 1e-5)
    expected = np.linalg.lstsq(A, right, rcond=1e-5)[0]
    np.testing.assert_allclose(x, expected, rtol=0.0, atol=1e-10 * np.abs(expected).max())
