"""LAPACK's eigenvalues and least squares on numbers of the stack.

The C functions that `np.linalg` calls under Numba, without its copies and its exceptions: nothing
is raised in the middle of a frame, and nothing but the call is compiled. Matrices are by columns.
"""

import numpy as np
from numba import config, types

from standoff.kernels.compiler.decorators import BOUNDS_CHECK, kernel, stack_reals

REALS = types.CPointer(types.float64)
# kind, job, triangle, n, matrix, leading dimension, eigenvalues
_EIGEN = types.ExternalFunction(
    "numba_ez_xxxevd",
    types.intc(types.char, types.char, types.char, types.intp, REALS, types.intp, REALS),
)
# kind, m, n, right sides, matrix, leading dimension, right sides, theirs, singular values, rcond,
# rank
_LEAST_SQUARES = types.ExternalFunction(
    "numba_ez_gelsd",
    types.intc(
        types.char,
        types.intp,
        types.intp,
        types.intp,
        REALS,
        types.intp,
        REALS,
        types.intp,
        REALS,
        types.float64,
        REALS,
    ),
)
DOUBLE, VECTORS, LOWER = ord("d"), ord("V"), ord("L")


@kernel
def all_finite(numbers, n):
    total = 0.0
    for k in range(n):
        total += 0.0 * numbers[k]  # NaN from an infinite or no number
    return total == 0.0


if config.DISABLE_JIT or BOUNDS_CHECK:

    @kernel
    def symmetric_eigen(A, values, n):
        if not all_finite(A, n * n):
            return False
        matrix = np.empty((n, n))
        for i in range(n):
            for j in range(n):
                matrix[i, j] = A[i + n * j]
        found, vectors = np.linalg.eigh(matrix)
        for i in range(n):
            values[i] = found[i]
            for j in range(n):
                A[i + n * j] = vectors[i, j]
        return True

    @kernel
    def least_squares(A, b, n, cutoff):
        if not (all_finite(A, n * n) and all_finite(b, n)):
            return False
        matrix, right = np.empty((n, n)), np.empty(n)
        for i in range(n):
            right[i] = b[i]
            for j in range(n):
                matrix[i, j] = A[i + n * j]
        x = np.linalg.lstsq(matrix, right, cutoff)[0]
        for i in range(n):
            b[i] = x[i]
        return True

else:

    @kernel
    def symmetric_eigen(A, values, n):
        """Ascending eigenvalues of a symmetric n x n matrix A; its columns become the unit
        eigenvectors. False, with nothing of use, where A is not finite or LAPACK gives up.
        """
        if not all_finite(A, n * n):
            return False
        return _EIGEN(DOUBLE, VECTORS, LOWER, n, A, n, values) == 0

    @kernel
    def least_squares(A, b, n, cutoff):
        """b becomes the x of least norm that minimises |A x - b|; A, n x n with n <= 8, is lost.

        Singular values below `cutoff` times the greatest count as 0. False, with nothing of use,
        where a number is not finite or LAPACK gives up.
        """
        if not (all_finite(A, n * n) and all_finite(b, n)):
            return False
        singular, rank = stack_reals(), stack_reals()
        return _LEAST_SQUARES(DOUBLE, n, n, 1, A, n, b, n, singular, cutoff, rank) == 0
