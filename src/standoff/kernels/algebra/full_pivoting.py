"""Gauss's elimination with full pivoting: one factor for many right-hand sides, and its rank."""

from standoff.kernels.compiler.decorators import kernel


@kernel
def exchange(J, first, second, step, count):
    """Swap two rows or columns of `count` numbers, `step` apart."""
    for k in range(count):
        a, b = first + step * k, second + step * k
        J[a], J[b] = J[b], J[a]


@kernel
def greatest_entry(J, k, n):
    """(row, column, magnitude) of the greatest entry of what is left from row and column k on."""
    row, column, most = k, k, -1.0
    for i in range(k, n):
        for j in range(k, n):
            if abs(J[n * i + j]) > most:
                row, column, most = i, j, abs(J[n * i + j])
    return row, column, most


@kernel
def factor_fully(J, order, n):
    """Factor the n x n matrix J (by rows) in place; `order`, 2 n integers, keeps its rows, then its
    columns. Returns the least pivot over the greatest: 0 where J is singular or not finite.
    """
    for k in range(n):
        order[k] = order[n + k] = k
    greatest = least = 0.0
    for k in range(n):
        i, j, most = greatest_entry(J, k, n)
        if not most > 0.0:
            return 0.0
        exchange(J, n * k, n * i, 1, n)
        exchange(J, k, j, n, n)
        order[k], order[i] = order[i], order[k]
        order[n + k], order[n + j] = order[n + j], order[n + k]
        greatest = max(greatest, most)
        least = most if k == 0 else min(least, most)
        for i in range(k + 1, n):
            factor = J[n * i + k] / J[n * k + k]
            J[n * i + k] = factor
            if factor != 0.0:
                for j in range(k + 1, n):
                    J[n * i + j] -= factor * J[n * k + j]
    return least / greatest


@kernel
def solve_factored(J, order, x, y, n):
    """Solve J x = b with the factor; x holds b and becomes the solution. y: scratch, n numbers."""
    for i in range(n):
        y[i] = x[order[i]]
        for j in range(i):
            y[i] -= J[n * i + j] * y[j]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            y[i] -= J[n * i + j] * y[j]
        y[i] /= J[n * i + i]
    for i in range(n):
        x[order[n + i]] = y[i]
