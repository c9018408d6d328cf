"""Eigenvalues of small symmetric matrices by Jacobi's rotations, on the stack.

Cyclic sweeps, each rotation zeroing one pair of elements (Golub and Van Loan, Matrix Computations,
section 8.5). Nothing is allocated, and nothing is called that could raise in the middle of a frame.
"""

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.compiler.decorators import kernel, stack_matrix, stack_reals
from standoff.kernels.tolerances import JACOBI_REST, JACOBI_SWEEPS


@kernel
def all_finite(numbers, n):
    total = 0.0
    for k in range(n):
        total += 0.0 * numbers[k]  # NaN from an infinite or no number
    return total == 0.0


@kernel
def outside_diagonal(W, n):
    """(sum of squares of the elements above the diagonal, of all those on it)."""
    off, on = 0.0, 0.0
    for i in range(n):
        on += W[n * i + i] * W[n * i + i]
        for j in range(i + 1, n):
            off += W[n * i + j] * W[n * i + j]
    return off, on


@kernel
def rotate_pair(W, V, n, p, q):
    """The rotation that zeroes W[p, q], on both sides of W, and on the vectors, rows of V."""
    between = W[n * p + q]
    theta = 0.5 * (W[n * q + q] - W[n * p + p]) / between
    t = 1.0 / (abs(theta) + sqrt(theta * theta + 1.0))
    t = -t if theta < 0.0 else t
    c = 1.0 / sqrt(t * t + 1.0)
    s = t * c
    W[n * p + p] -= t * between
    W[n * q + q] += t * between
    W[n * p + q], W[n * q + p] = 0.0, 0.0
    for k in range(n):
        if k != p and k != q:
            x, y = W[n * k + p], W[n * k + q]
            W[n * k + p], W[n * k + q] = c * x - s * y, s * x + c * y
            W[n * p + k], W[n * q + k] = W[n * k + p], W[n * k + q]
        x, y = V[n * p + k], V[n * q + k]
        V[n * p + k], V[n * q + k] = c * x - s * y, s * x + c * y


@kernel
def sort_ascending(values, V, n):
    for i in range(1, n):
        k = i
        while k > 0 and values[k] < values[k - 1]:
            values[k], values[k - 1] = values[k - 1], values[k]
            for j in range(n):
                V[n * k + j], V[n * k - n + j] = V[n * k - n + j], V[n * k + j]
            k -= 1


@kernel
def symmetric_eigen(A, values, n):
    """Ascending eigenvalues of a symmetric n x n matrix A, n <= 8; its rows become the unit
    eigenvectors. False, and no result, if A is not finite.
    """
    if not all_finite(A, n * n):
        return False
    W = stack_matrix()
    for i in range(n):
        for j in range(n):
            W[n * i + j] = A[n * i + j]
            A[n * i + j] = 1.0 if i == j else 0.0
    for _ in range(JACOBI_SWEEPS):
        off, on = outside_diagonal(W, n)
        if off <= JACOBI_REST * on:
            break
        for p in range(n):
            for q in range(p + 1, n):
                if W[n * p + q] != 0.0:
                    rotate_pair(W, A, n, p, q)
    for i in range(n):
        values[i] = W[n * i + i]
    sort_ascending(values, A, n)
    return True


@kernel
def least_norm_solve(A, b, n, cutoff):
    """b becomes the x of least norm that minimises |A x - b|; A, symmetric, n x n with n <= 8, is
    lost.

    Eigenvalues below `cutoff` times the greatest count as 0. False, and no result, if a number is
    not finite.
    """
    values = stack_reals()
    if not (all_finite(b, n) and symmetric_eigen(A, values, n)):
        return False
    top = max(abs(values[0]), abs(values[n - 1]))
    x = stack_reals()
    for j in range(n):
        x[j] = 0.0
    for i in range(n):
        if abs(values[i]) > cutoff * top:
            along = 0.0
            for j in range(n):
                along += A[n * i + j] * b[j]
            for j in range(n):
                x[j] += A[n * i + j] * along / values[i]
    for j in range(n):
        b[j] = x[j]
    return True
